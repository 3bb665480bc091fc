//! Outputs that cannot be written are told before any work, and nothing is left of those that fail later.

use std::process::Command;

use crate::common::{Outcome, entries, folder, line, torus, write};

fn with_cloud() -> tempfile::TempDir {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    folder
}

#[test]
fn an_unknown_suffix_lists_the_known_ones_before_any_work() {
    // The input is not even there: its absence would be the first thing that work finds.
    let folder = folder();
    for name in ["out.dwg", "out", "-"] {
        let outcome = line(folder.path(), &format!("reconstruct missing.xyz -o {name}"));
        let said = outcome.failed(if name == "-" { "standard output" } else { name });
        assert!(said.contains("ply, obj, stl, off, glb"), "{said}");
    }
    let said = line(folder.path(), "sample torus -o out.glb").failed("out.glb");
    assert!(said.contains("las, laz, ply, xyz"), "{said}");
    line(folder.path(), "sample torus -o out.pcd --truth out.xyz").failed("out.xyz");
    assert!(entries(folder.path()).is_empty());
}

#[test]
fn a_missing_folder_is_told_before_any_work() {
    let folder = with_cloud();
    std::fs::write(folder.path().join("broken.xyz"), "words\n").unwrap();
    for words in ["-o no/out.ply", "-o out.ply --report no/report.json"] {
        let said = line(folder.path(), &format!("reconstruct broken.xyz {words}")).failed("no/");
        assert!(said.contains("create it first"), "{said}");
    }
    line(folder.path(), "sample torus -o no/out.xyz").failed("no/out.xyz");
    line(folder.path(), "sample torus -o out.xyz --truth no/out.ply").failed("no/out.ply");
    assert_eq!(entries(folder.path()), ["broken.xyz", "in.xyz"]);
}

#[test]
fn a_folder_is_no_output() {
    let folder = with_cloud();
    std::fs::create_dir(folder.path().join("out.ply")).unwrap();
    let said = line(folder.path(), "reconstruct in.xyz -o out.ply").failed("out.ply");
    assert!(said.contains("directory"), "{said}");
}

#[test]
fn no_file_is_read_and_written() {
    let folder = folder();
    write(&folder.path().join("in.ply"), &torus(2000, [0.0; 3]).points);
    std::fs::create_dir(folder.path().join("sub")).unwrap();
    let before = std::fs::read(folder.path().join("in.ply")).unwrap();
    for words in
        ["-o in.ply", "-o ./in.ply", "-o sub/../in.ply", "-o out.ply --report in.ply", "-o out.ply --report out.ply"]
    {
        let said = line(folder.path(), &format!("reconstruct in.ply {words}")).failed(".ply");
        assert!(said.contains("named as both"), "{said}");
    }
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.ply", folder.path().join("link.ply")).unwrap();
        line(folder.path(), "reconstruct in.ply -o link.ply").failed("link.ply");
    }
    line(folder.path(), "reconstruct - - -o out.ply").failed("standard input");
    line(folder.path(), "sample torus -o both.ply --truth both.ply").failed("both.ply");
    assert_eq!(std::fs::read(folder.path().join("in.ply")).unwrap(), before);
    assert!(!folder.path().join("out.ply").exists());
}

#[cfg(unix)]
#[test]
fn a_protected_output_is_told_before_any_work() {
    use std::os::unix::fs::PermissionsExt;
    let folder = with_cloud();
    let path = folder.path().join("old.ply");
    std::fs::write(&path, "old").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).unwrap();
    let said = line(folder.path(), "reconstruct in.xyz -o old.ply").failed("old.ply");
    assert!(said.contains("permission denied"), "{said}");
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
}

/// A limit on the size of files stands for a full disk: writing fails in the same place, with an error of the same kind.
#[cfg(unix)]
#[test]
fn a_full_disk_leaves_the_old_file() {
    let folder = with_cloud();
    for suffix in crate::common::MESHES {
        let name = format!("old.{suffix}");
        std::fs::write(folder.path().join(&name), "old").unwrap();
        let before = entries(folder.path());
        // Without the trap the system would end the process before it can tell.
        let script = format!(
            "trap '' XFSZ; ulimit -f 8; exec '{}' reconstruct in.xyz -o {name} --quiet",
            env!("CARGO_BIN_EXE_zeroset")
        );
        let output = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().unwrap();
        let said = Outcome::from(output).failed(&name);
        assert!(said.contains("disk is full"), "{said}");
        assert_eq!(std::fs::read(folder.path().join(&name)).unwrap(), b"old");
        assert_eq!(entries(folder.path()), before, "litter");
    }
}
