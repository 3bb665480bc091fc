//! Real data, which lie outside the repository. The tests of the command use this file, too.

use std::path::{Path, PathBuf};

/// A file of the shared test data, if that is there.
pub fn shared_data(name: &str) -> Option<PathBuf> {
    let places = ["../../../shared/data", "../../../../shared/data"];
    let found = places.iter().map(|place| Path::new(env!("CARGO_MANIFEST_DIR")).join(place).join(name));
    let found = found.into_iter().find(|path| path.exists());
    if found.is_none() {
        println!("skipped: the shared test data has no {name}");
    }
    found
}
