//! Whatever is wrong with an input: exit 1, one line that names it and says what to do, the old output as it was, and
//! nothing new beside it.

use std::path::Path;

use crate::common::{CLOUDS, Outcome, entries, folder, line, sound, torus, with_input, write, zeroset};

/// Runs on a bad file with an old output in the folder, and looks at what is left.
#[track_caller]
fn refused(suffix: &str, what: &str, prepare: impl FnOnce(&Path)) -> String {
    let folder = folder();
    let name = format!("bad.{suffix}");
    prepare(&folder.path().join(&name));
    std::fs::write(folder.path().join("old.ply"), "old").unwrap();
    let before = entries(folder.path());
    let outcome = line(folder.path(), &format!("reconstruct {name} -o old.ply --scene object"));
    println!("{what:16} {suffix:4} {}", outcome.stderr.trim());
    let said = outcome.failed(&name);
    assert_eq!(std::fs::read(folder.path().join("old.ply")).unwrap(), b"old");
    assert_eq!(entries(folder.path()), before, "litter");
    said
}

#[track_caller]
fn refused_bytes(suffix: &str, what: &str, bytes: &[u8]) -> String {
    refused(suffix, what, |path| std::fs::write(path, bytes).unwrap())
}

#[track_caller]
fn refused_points(suffix: &str, what: &str, points: &[[f64; 3]]) -> String {
    refused(suffix, what, |path| write(path, points))
}

fn find(bytes: &[u8], part: &[u8]) -> usize {
    bytes.windows(part.len()).position(|w| w == part).expect("the file has the text")
}

/// How many bytes of a sound file are its header.
fn header_length(suffix: &str, bytes: &[u8]) -> Option<usize> {
    match suffix {
        "las" | "laz" => Some(u32::from_le_bytes(bytes[96..100].try_into().unwrap()) as usize),
        "ply" => Some(find(bytes, b"end_header\n") + 11),
        "pcd" => Some(find(bytes, b"DATA binary\n") + 12),
        "e57" => Some(48),
        "pts" | "csv" => Some(find(bytes, b"\n") + 1),
        _ => None,
    }
}

#[test]
fn empty_files() {
    for suffix in CLOUDS {
        assert!(refused_bytes(suffix, "empty", b"").contains("empty"));
    }
}

#[test]
fn header_only_and_truncated() {
    for suffix in CLOUDS {
        let bytes = sound(suffix);
        let Some(header) = header_length(suffix, &bytes) else { continue };
        refused_bytes(suffix, "header only", &bytes[..header]);
        // Lines of text have no half a header; a CSV that ends early is as good as a short one.
        if !matches!(suffix, "pts" | "csv") {
            refused_bytes(suffix, "half a header", &bytes[..header / 2]);
        }
        if suffix != "csv" {
            refused_bytes(suffix, "half a body", &bytes[..(header + bytes.len()) / 2]);
        }
    }
    refused_bytes("xyz", "half a body", b"1 2 3\n4 5");
    refused_bytes("csv", "half a body", b"x,y,z\n1,2,3\n4,5");
    refused_bytes("xyz", "header only", b"x y z\n");
}

#[test]
fn wrong_magic() {
    for suffix in CLOUDS {
        refused_bytes(suffix, "words", b"these are words, and no points\nat all\n");
        refused_bytes(suffix, "zeros", &[0; 4096]);
        let other = if matches!(suffix, "las" | "laz") { "ply" } else { "las" };
        refused_bytes(suffix, "another format", &sound(other));
    }
}

#[test]
fn not_finite() {
    for suffix in ["ply", "pcd", "e57", "las", "laz", "xyz", "csv", "pts"] {
        let bytes: Vec<u8> = match suffix {
            "xyz" | "csv" => b"nan nan nan\ninf 0 0\n0 -inf 0\n".to_vec(),
            "pts" => b"2\nnan nan nan\ninf 0 0\n".to_vec(),
            // The scale of x.
            "las" | "laz" => {
                let mut bytes = sound(suffix);
                bytes[131..139].copy_from_slice(&f64::NAN.to_le_bytes());
                bytes
            }
            "e57" => {
                refused_points(suffix, "not finite", &[[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]]);
                continue;
            }
            "ply" => b"ply\nformat ascii 1.0\nelement vertex 2\nproperty double x\nproperty double y\nproperty double z\nend_header\nnan nan nan\ninf 0 0\n".to_vec(),
            _ => {
                let mut bytes = sound(suffix);
                let body = header_length(suffix, &bytes).unwrap();
                for value in bytes[body..].chunks_exact_mut(8) {
                    value.copy_from_slice(&f64::INFINITY.to_le_bytes());
                }
                bytes
            }
        };
        refused_bytes(suffix, "not finite", &bytes);
    }
}

#[test]
fn counts_that_lie() {
    for count in ["4294967296", "18446744073709551615", "-1"] {
        let text = |bytes: &[u8], before: &str| {
            let at = find(bytes, before.as_bytes()) + before.len();
            let end = at + find(&bytes[at..], b"\n");
            [&bytes[..at], count.as_bytes(), &bytes[end..]].concat()
        };
        refused_bytes("ply", count, &text(&sound("ply"), "element vertex "));
        refused_bytes("pcd", count, &text(&sound("pcd"), "POINTS "));
        let pts = sound("pts");
        refused_bytes("pts", count, &[count.as_bytes(), &pts[find(&pts, b"\n")..]].concat());
        let number = count.parse::<u64>().unwrap_or(u64::MAX);
        for suffix in ["las", "laz"] {
            let mut bytes = sound(suffix);
            let at = if bytes[25] >= 4 { 247..255 } else { 107..111 };
            let width = at.len();
            bytes[at].copy_from_slice(&number.to_le_bytes()[..width]);
            // In four bytes 2^32 is an honest 0, which is refused, too.
            refused_bytes(suffix, count, &bytes);
        }
    }
    let e57 = sound("e57");
    let at = find(&e57, b"recordCount=\"60\"") + 13;
    let mut bytes = e57.clone();
    bytes[at..at + 2].copy_from_slice(b"99");
    refused_bytes("e57", "count 99", &bytes);
}

#[test]
fn points_that_bear_no_surface() {
    let line: Vec<[f64; 3]> = (0..60).map(|i| [f64::from(i), 2.0 * f64::from(i), 3.0]).collect();
    for suffix in CLOUDS {
        for few in 1..=3 {
            let said = refused_points(suffix, "few points", &line[..few]);
            assert!(said.contains("too few"), "{said}");
        }
        let said = refused_points(suffix, "one line", &line);
        assert!(said.contains("on one line"), "{said}");
        let said = refused_points(suffix, "all equal", &[[1.5, 2.5, 3.5]; 60]);
        assert!(said.contains("in one place"), "{said}");
    }
}

#[test]
fn coordinates_beyond_all_grids() {
    let far = "1e12 0 0\n0 1e12 0\n0 0 1e12\n1 1 1\n";
    refused_bytes("xyz", "1e12", far.as_bytes());
    refused_bytes("csv", "1e12", far.replace(' ', ",").as_bytes());
    refused_bytes("pts", "1e12", format!("4\n{far}").as_bytes());
    let (ply, pcd) = (
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\nend_header\n",
        "VERSION .7\nFIELDS x y z\nSIZE 8 8 8\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 4\nHEIGHT 1\nPOINTS 4\nDATA ascii\n",
    );
    refused_bytes("ply", "1e12", format!("{ply}{far}").as_bytes());
    refused_bytes("pcd", "1e12", format!("{pcd}{far}").as_bytes());
    refused_points("e57", "1e12", &[[1e12, 0.0, 0.0], [0.0; 3]]);
    for suffix in ["las", "laz"] {
        let mut bytes = sound(suffix);
        bytes[155..163].copy_from_slice(&1e12_f64.to_le_bytes());
        refused_bytes(suffix, "1e12", &bytes);
    }
}

#[test]
fn a_plane_is_a_surface() {
    let plane: Vec<[f64; 3]> = (0..400).map(|i| [f64::from(i % 20), f64::from(i / 20), 1.0]).collect();
    for suffix in CLOUDS {
        let folder = folder();
        write(&folder.path().join(format!("plane.{suffix}")), &plane);
        line(folder.path(), &format!("reconstruct plane.{suffix} -o out.ply --scene terrain")).ok();
    }
}

#[test]
fn files_that_cannot_be_opened() {
    for suffix in CLOUDS {
        assert!(refused(suffix, "missing", |_| {}).contains("no such file"));
        assert!(refused(suffix, "a folder", |path| std::fs::create_dir(path).unwrap()).contains("directory"));
    }
}

#[cfg(unix)]
#[test]
fn a_file_without_permission() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("secret.xyz");
    std::fs::write(&path, "1 2 3\n").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::read(&path).is_ok() {
        println!("skipped: this user may read everything");
        return;
    }
    let said = line(folder.path(), "reconstruct secret.xyz -o out.ply").failed("secret.xyz");
    assert!(said.contains("permission denied"), "{said}");
}

#[test]
fn bad_standard_input() {
    for (input, remedy) in [
        (b"".as_slice(), "check the command in front of the pipe"),
        (b"words\n", "one point a line"),
        (b"1 2 3\n", "give at least"),
        (b"1 2\n", "copy it again"),
        (b"\0\0\0\0", "pipe in lines of x y z"),
        (b"LASF\0\0\0\0", "it looks like LAS or LAZ); pipe in lines of x y z"),
    ] {
        let folder = folder();
        let said = with_input(folder.path(), "reconstruct - -o out.ply", input).failed("standard input");
        assert!(said.starts_with("error: standard input: ") && said.contains(remedy), "{said}");
        assert!(entries(folder.path()).is_empty());
    }
}

#[test]
fn one_bad_file_among_good_ones() {
    let folder = folder();
    write(&folder.path().join("good.xyz"), &torus(500, [0.0; 3]).points);
    std::fs::write(folder.path().join("bad.xyz"), "1 2\n").unwrap();
    line(folder.path(), "reconstruct good.xyz bad.xyz -o out.ply").failed("bad.xyz");
    line(folder.path(), "reconstruct good.xyz missing.xyz -o out.ply").failed("missing.xyz");
    line(folder.path(), "reconstruct good.xyz good.dwg -o out.ply").failed("good.dwg");
    assert_eq!(entries(folder.path()), ["bad.xyz", "good.xyz"]);
}

#[cfg(unix)]
#[test]
fn a_name_with_a_line_end_makes_one_line() {
    let folder = folder();
    let outcome = zeroset(folder.path()).args(["info", "a\nb.xyz"]).output().unwrap();
    Outcome::from(outcome).failed("b.xyz");
}

#[test]
fn bad_files_for_the_other_commands() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.ply"), "ply\nnonsense\n").unwrap();
    write(&folder.path().join("cloud.ply"), &torus(60, [0.0; 3]).points);
    line(folder.path(), "info bad.ply").failed("bad.ply");
    line(folder.path(), "info missing.stl").failed("missing.stl");
    let said = line(folder.path(), "info a.dwg").failed("a.dwg");
    assert!(said.contains("laz") && said.contains("glb"), "{said}");
    line(folder.path(), "compare bad.ply cloud.ply").failed("bad.ply");
    let said = line(folder.path(), "compare cloud.ply cloud.ply").failed("cloud.ply");
    assert!(said.contains("no surface"), "{said}");
}
