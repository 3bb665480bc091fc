#![no_main]

use std::path::Path;

use zeroset::model::Solid;
use zeroset_io::{Footprint, IoError, Operands, SolidError, parse_solid_tree};

/// No file is there.
struct Nowhere;

fn missing<T>(path: &Path) -> Result<T, SolidError> {
    Err(IoError::NotFound { path: path.to_path_buf() }.into())
}

impl Operands for Nowhere {
    fn file(&mut self, path: &Path, _: usize) -> Result<Solid, SolidError> {
        missing(path)
    }

    fn footprints(&mut self, path: &Path) -> Result<Vec<Footprint>, SolidError> {
        missing(path)
    }
}

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Err(error) = parse_solid_tree(Path::new("fuzz.toml"), text, &mut Nowhere, 0) {
        assert_eq!(error.to_string().lines().count(), 1);
    }
});
