//! Interrupted writes. A program of its own: abandoning strikes every write that is under way in the process.

use zeroset_io::{IoError, abandon_writes, write_atomically};

#[test]
fn an_abandoned_write_leaves_no_litter() {
    let folder = crate::common::folder();
    let entries = || std::fs::read_dir(folder.path()).unwrap().count();
    let path = folder.path().join("report.json");
    std::fs::write(&path, "old").unwrap();
    let result = write_atomically::<IoError>(&path, |_| {
        assert_eq!(entries(), 2);
        abandon_writes();
        assert_eq!(entries(), 1);
        Ok(())
    });
    assert!(result.is_err());
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
}
