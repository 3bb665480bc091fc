//! Files are written completely or not at all.

use std::io::Write;

use crate::common::folder;
use zeroset_io::{IoError, check_writable, write_atomically};

fn entries(folder: &tempfile::TempDir) -> usize {
    std::fs::read_dir(folder.path()).unwrap().count()
}

#[test]
fn a_write_replaces_the_old_file() {
    let folder = folder();
    let path = folder.path().join("report.json");
    for content in ["first", "second, longer"] {
        let bytes = write_atomically(&path, |out| {
            out.write_all(content.as_bytes()).map_err(|e| IoError::from_system(&path, e))
        });
        assert_eq!(bytes.unwrap(), content.len() as u64);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), content);
        assert_eq!(entries(&folder), 1);
    }
}

#[test]
fn a_failed_write_leaves_the_old_file_and_nothing_else() {
    let folder = folder();
    let path = folder.path().join("report.json");
    for old in [None, Some("old")] {
        if let Some(old) = old {
            std::fs::write(&path, old).unwrap();
        }
        let failed = write_atomically(&path, |out| {
            out.write_all(&[b'x'; 1 << 20]).map_err(|e| IoError::from_system(&path, e))?;
            Err(IoError::from_system(&path, std::io::ErrorKind::StorageFull.into()))
        });
        assert!(matches!(failed, Err(IoError::DiskFull { .. })));
        assert_eq!(std::fs::read_to_string(&path).ok().as_deref(), old);
        assert_eq!(entries(&folder), usize::from(old.is_some()));
    }
}

#[test]
fn a_panic_leaves_no_litter() {
    let folder = folder();
    let path = folder.path().join("report.json");
    let caught = std::panic::catch_unwind(|| write_atomically::<IoError>(&path, |_| panic!("in the middle")));
    assert!(caught.is_err());
    assert_eq!(entries(&folder), 0);
}

#[cfg(unix)]
#[test]
fn permissions_are_ordinary() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = folder();
    let mode = |path: &std::path::Path| std::fs::metadata(path).unwrap().mode() & 0o777;
    let plain = folder.path().join("plain");
    std::fs::write(&plain, "").unwrap();
    let path = folder.path().join("new.json");
    write_atomically::<IoError>(&path, |_| Ok(())).unwrap();
    assert_eq!(mode(&path), mode(&plain), "as any new file");
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o640)).unwrap();
    write_atomically::<IoError>(&path, |_| Ok(())).unwrap();
    assert_eq!(mode(&path), 0o640, "as the file before");
}

#[cfg(unix)]
#[test]
fn links_are_followed() {
    let folder = folder();
    let (target, link) = (folder.path().join("target.json"), folder.path().join("link.json"));
    std::fs::write(&target, "old").unwrap();
    std::os::unix::fs::symlink(&target, &link).unwrap();
    write_atomically(&link, |out| out.write_all(b"new").map_err(|e| IoError::from_system(&link, e))).unwrap();
    assert!(std::fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(std::fs::read_to_string(&target).unwrap(), "new");
}

#[test]
fn what_can_be_written_is_known_before() {
    let folder = folder();
    let path = folder.path().join("report.json");
    check_writable(&path).unwrap();
    assert_eq!(entries(&folder), 0);
    std::fs::write(&path, "old").unwrap();
    check_writable(&path).unwrap();
    assert_eq!((entries(&folder), std::fs::read_to_string(&path).unwrap()), (1, "old".into()));
    let missing = check_writable(&folder.path().join("no/report.json"));
    assert!(matches!(missing, Err(IoError::FolderMissing { .. })));
    assert!(matches!(check_writable(folder.path()), Err(IoError::IsDirectory { .. })));
    let mut permissions = std::fs::metadata(&path).unwrap().permissions();
    permissions.set_readonly(true);
    std::fs::set_permissions(&path, permissions).unwrap();
    assert!(matches!(check_writable(&path), Err(IoError::PermissionDenied { .. })));
}
