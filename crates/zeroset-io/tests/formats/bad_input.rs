//! Everything that can be wrong with a file: one line that names it and says what to do, and no panic.

use std::path::Path;

use crate::common::{folder, sound_cloud, sound_mesh};
use zeroset_io::{
    CloudFormat, IoError, MeshFormat, WriteOptions, read_cloud, read_cloud_bytes, read_mesh, read_mesh_bytes,
    write_cloud, write_mesh,
};

/// One line, which starts with the name and has a remedy after the last semicolon.
#[track_caller]
fn assert_message(error: &IoError, name: &str) -> String {
    let text = error.to_string();
    assert_eq!(text.lines().count(), 1, "{text}");
    assert!(text.contains(name), "{text} does not name {name}");
    let remedy = text.rsplit_once("; ").map_or("", |(_, remedy)| remedy);
    assert!(remedy.len() >= 8, "{text} has no remedy");
    text
}

fn cloud(suffix: &str, bytes: &[u8]) -> Result<zeroset_io::CloudFile, IoError> {
    let name = format!("bad.{suffix}");
    let path = Path::new(&name);
    read_cloud_bytes(path, CloudFormat::from_path(path)?, bytes.to_vec())
}

fn mesh(suffix: &str, bytes: &[u8]) -> Result<zeroset::mesh::Mesh, IoError> {
    let name = format!("bad.{suffix}");
    let path = Path::new(&name);
    read_mesh_bytes(path, MeshFormat::from_path(path)?, bytes)
}

/// A sound file with some bytes replaced.
fn patched(mut bytes: Vec<u8>, at: usize, patch: &[u8]) -> Vec<u8> {
    bytes[at..at + patch.len()].copy_from_slice(patch);
    bytes
}

fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let at = bytes.windows(from.len()).position(|w| w == from.as_bytes()).expect("the file has the text");
    [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat()
}

const PLY: &str =
    "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
const LITTLE: &str = "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";

fn pcd(data: &str, body: &str) -> Vec<u8> {
    let fields = "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\nHEIGHT 1\nPOINTS 2\n";
    format!("{fields}DATA {data}\n{body}").into_bytes()
}

#[test]
fn bad_clouds() {
    let (las, laz) = (sound_cloud(CloudFormat::Las), sound_cloud(CloudFormat::Laz));
    let (e57, pcd_sound) = (sound_cloud(CloudFormat::E57), crate::common::pcd_binary());
    let nan = f32::NAN.to_le_bytes().repeat(6);
    let laz_points = u32::from_le_bytes(laz[96..100].try_into().unwrap()) as usize;
    let cases: Vec<(&str, &str, Vec<u8>, &str)> = vec![
        // What is wrong, suffix, content, a part of the message.
        ("empty", "las", vec![], "empty"),
        ("empty", "laz", vec![], "empty"),
        ("empty", "ply", vec![], "empty"),
        ("empty", "xyz", vec![], "empty"),
        ("empty", "pts", vec![], "empty"),
        ("empty", "pcd", vec![], "empty"),
        ("empty", "e57", vec![], "empty"),
        ("wrong magic", "las", b"not a las file at all, only words".to_vec(), "not a LAS file"),
        ("wrong magic", "laz", PLY.into(), "looks like PLY"),
        ("wrong magic", "ply", las.clone(), "looks like LAS"),
        ("wrong magic", "xyz", las.clone(), "looks like LAS"),
        ("wrong magic", "xyz", b"<html><body>Not found</body></html>\n".to_vec(), "no line with x y z"),
        ("wrong magic", "pcd", las.clone(), "not a PCD file"),
        ("wrong magic", "e57", las.clone(), "not a E57 file"),
        ("wrong magic", "xyz", "1 2 3\n".encode_utf16().flat_map(u16::to_le_bytes).collect(), "not a XYZ text"),
        (
            "UTF-16 with its mark",
            "csv",
            "\u{FEFF}1 2 3\n".encode_utf16().flat_map(u16::to_le_bytes).collect(),
            "save it as UTF-8",
        ),
        ("more values than fields", "pcd", pcd("ascii", "1 2 3 9\n4 5 6 9\n"), "more values than 2 points of 3"),
        (
            "more values than properties",
            "ply",
            format!("{PLY}1 2 3 9\n4 5 6 9\n").into(),
            "more values than its header",
        ),
        ("decimal commas", "csv", b"x;y;z\n1,5;2,5;3,5\n".to_vec(), "decimal point"),
        ("decimal commas and whole numbers", "txt", b"100 200,25 3\n".to_vec(), "decimal point"),
        ("fewer values than names", "csv", b"name,x,y,z\na,1,2\n".to_vec(), "no points"),
        ("only blank lines", "xyz", b"\n\n  \n".to_vec(), "no points"),
        ("header only", "las", patched(las[..375].to_vec(), 96, &375_u32.to_le_bytes()), "promises 4 points"),
        (
            "header only, honest",
            "las",
            patched(patched(las[..375].to_vec(), 96, &375_u32.to_le_bytes()), 247, &[0; 8]),
            "",
        ),
        ("header only", "laz", laz[..laz_points].to_vec(), "cut short"),
        ("header only", "ply", PLY.into(), "promises 2 points"),
        ("header only", "ply", PLY.replace("vertex 2", "vertex 0").into(), "no points"),
        ("header only", "xyz", b"x y z\n".to_vec(), "no points"),
        ("header only", "xyz", b"# a comment\n".to_vec(), "no points"),
        ("header only", "pts", b"12\n".to_vec(), "promises 12 points"),
        ("header only", "pcd", pcd("ascii", ""), "promises 2 points"),
        ("header only", "pcd", pcd("binary_compressed", ""), "cut short"),
        ("header only", "e57", e57[..48].to_vec(), "cut short"),
        ("truncated header", "las", las[..100].to_vec(), "cut short in its header"),
        ("truncated header", "las", las[..300].to_vec(), "cut short in its header"),
        ("truncated header", "ply", PLY[..40].into(), "no end"),
        ("truncated header", "pcd", b"# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n".to_vec(), "no end"),
        ("truncated header", "e57", e57[..30].to_vec(), "cut short in its header"),
        ("truncated body", "las", las[..las.len() - 1].to_vec(), "the file has 3"),
        ("truncated body", "laz", laz[..laz.len() - 20].to_vec(), ""),
        ("truncated body", "ply", format!("{PLY}1 2 3\n4 5").into(), "promises 2 points but the file has 1"),
        ("truncated body", "ply", [LITTLE.as_bytes(), &[0; 23]].concat(), "promises 2 points but the file has 1"),
        ("truncated body", "xyz", b"1 2 3\n4 5".to_vec(), "line 2 has 2 columns"),
        ("truncated body", "pts", b"3\n1 2 3\n4 5 6\n".to_vec(), "promises 3 points but the file has 2"),
        ("truncated body", "pcd", pcd("ascii", "1 2 3\n4 5"), "promises 2 points but the file has 1"),
        ("truncated body", "pcd", pcd_sound[..pcd_sound.len() - 1].to_vec(), "promises 4 points but the file has 3"),
        ("truncated body", "e57", e57[..1024].to_vec(), "cut short"),
        ("all NaN", "ply", [LITTLE.as_bytes(), &nan].concat(), "finite"),
        ("all NaN", "xyz", b"nan nan nan\ninf 0 0\n".to_vec(), "none of the 2 points"),
        ("all NaN", "pcd", pcd("ascii", "nan nan nan\nnan nan nan\n"), "finite"),
        ("all NaN", "pcd", [pcd("binary", ""), nan.clone()].concat(), "finite"),
        ("NaN scale", "las", patched(las.clone(), 131, &f64::NAN.to_le_bytes()), "scale"),
        ("count 2^32", "ply", PLY.replace("vertex 2", "vertex 4294967296").into(), "promises 4294967296 points"),
        (
            "count 2^32",
            "ply",
            [LITTLE.replace("vertex 2", "vertex 4294967296").as_bytes(), &[0; 24]].concat(),
            "promises",
        ),
        (
            "count 2^64 - 1",
            "ply",
            [LITTLE.replace("vertex 2", "vertex 18446744073709551615").as_bytes(), &[0; 24]].concat(),
            "promises",
        ),
        ("count -1", "ply", PLY.replace("vertex 2", "vertex -1").into(), "valid count"),
        ("count 2^32", "las", patched(las.clone(), 247, &(1_u64 << 32).to_le_bytes()), "promises 4294967296 points"),
        ("count -1", "las", patched(las.clone(), 247, &u64::MAX.to_le_bytes()), "promises"),
        ("count 2^32", "laz", patched(laz.clone(), 247, &(1_u64 << 32).to_le_bytes()), "promises 4294967296 points"),
        ("count -1", "laz", patched(laz.clone(), 247, &u64::MAX.to_le_bytes()), "promises"),
        ("count 2^32", "pts", b"4294967296\n1 2 3\n".to_vec(), "promises 4294967296 points"),
        ("count -1", "pts", b"-1\n1 2 3\n".to_vec(), "promises"),
        (
            "count 2^32",
            "pcd",
            replaced(&pcd("ascii", "1 2 3\n"), "POINTS 2", "POINTS 4294967296"),
            "promises 4294967296",
        ),
        ("count 2^32", "pcd", replaced(&pcd_sound, "POINTS 4", "POINTS 4294967296"), "promises 4294967296"),
        ("count -1", "pcd", replaced(&pcd_sound, "POINTS 4", "POINTS -1"), "valid count"),
        ("large coordinate", "xyz", b"1 2 3\n1e12 0 0\n".to_vec(), "too large"),
        ("large coordinate", "ply", format!("{PLY}1 2 3\n0 0 -1e12\n").into(), "too large"),
        ("large coordinate", "las", patched(las.clone(), 155, &1e12_f64.to_le_bytes()), "too large"),
        ("large coordinate", "pcd", pcd("ascii", "1 2 3\n1e12 0 0\n"), "too large"),
        ("decimal comma", "csv", b"1,5;2,5;3,5\n".to_vec(), "decimal comma"),
        ("decimal comma", "xyz", b"1,5 2,5 3,5\n4,5 5,5 6,5\n".to_vec(), "decimal comma"),
        ("a word for a number", "xyz", b"1 2 3\n4 five 6\n".to_vec(), "line 2, column 2: `five`"),
        ("a word for a number", "ply", format!("{PLY}1 2 3\n4 five 6\n").into(), "`five`"),
        ("a word for a number", "pcd", pcd("ascii", "1 2 3\n4 five 6\n"), "`five`"),
        ("two columns", "xyz", b"1 2\n3 4\n".to_vec(), "2 columns"),
        ("no coordinates", "ply", PLY.replace("float z", "float w").into(), "x, y and z"),
        ("no vertices", "ply", PLY.replace("element vertex", "element edge").replace("vertex 2", "edge 0").into(), ""),
        ("no coordinates", "pcd", replaced(&pcd("ascii", ""), "FIELDS x y z", "FIELDS x y w"), "x, y and z"),
        ("field sizes", "pcd", replaced(&pcd("ascii", ""), "SIZE 4 4 4", "SIZE 4 4 3"), "inconsistently"),
        ("record length", "las", patched(las.clone(), 105, &3_u16.to_le_bytes()), "too short"),
        ("point format", "las", patched(las.clone(), 104, &[11]), "not supported"),
        ("version", "las", patched(las.clone(), 24, &[2]), "not supported"),
        ("offset to points", "las", patched(las.clone(), 96, &u32::MAX.to_le_bytes()), "cut short"),
        ("chunk table", "laz", patched(laz.clone(), laz_points, &i64::MAX.to_le_bytes()), ""),
        (
            "chunk count",
            "laz",
            {
                let table = i64::from_le_bytes(laz[laz_points..laz_points + 8].try_into().unwrap()) as usize;
                patched(laz.clone(), table + 4, &u32::MAX.to_le_bytes())
            },
            "4294967295 chunks",
        ),
        ("xml length", "e57", patched(e57.clone(), 32, &(1_u64 << 40).to_le_bytes()), "cut short"),
        ("a flipped bit", "e57", patched(e57.clone(), 100, &[e57[100] ^ 1]), "E57 data cannot be decoded"),
    ];
    for (what, suffix, bytes, part) in cases {
        match cloud(suffix, &bytes) {
            Ok(file) => panic!("{what} {suffix}: read {} points", file.cloud.len()),
            Err(error) => {
                let text = assert_message(&error, "bad.");
                println!("{what:18} {text}");
                assert!(text.contains(part), "{what} {suffix}: {text}");
            }
        }
    }
}

#[test]
fn small_clouds_are_fine() {
    for text in
        ["1 2 3\n", "1 2 3\n4 5 6\n", "0 0 0\n1 1 1\n2 2 2\n", "0 0 0\n1 0 0\n0 1 0\n1 1 0\n", "5 5 5\n5 5 5\n5 5 5\n"]
    {
        let file = cloud("xyz", text.as_bytes()).unwrap();
        assert_eq!(file.cloud.len(), text.lines().count());
        let folder = folder();
        for suffix in ["las", "laz", "ply", "pts"] {
            let path = folder.path().join(format!("small.{suffix}"));
            write_cloud(&path, &file.cloud, &WriteOptions::default()).unwrap();
            assert_eq!(read_cloud(&path).unwrap().cloud.points, file.cloud.points, "{suffix}");
        }
    }
}

#[test]
fn one_point_repeated_a_million_times_is_fine() {
    let folder = folder();
    let path = folder.path().join("equal.laz");
    let sent = zeroset::cloud::Cloud { points: vec![[1.0, 2.0, 3.0]; 1_000_000], ..Default::default() };
    write_cloud(&path, &sent, &WriteOptions::default()).unwrap();
    assert_eq!(read_cloud(&path).unwrap().cloud.len(), 1_000_000);
}

#[test]
fn bad_meshes() {
    let (stl, glb) = (sound_mesh(MeshFormat::Stl), sound_mesh(MeshFormat::Glb));
    let facets = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\n";
    let faces = PLY.replace("end_header", "element face 1\nproperty list uchar int vertex_indices\nend_header");
    let cases: Vec<(&str, &str, Vec<u8>, &str)> = vec![
        ("empty", "ply", vec![], "empty"),
        ("empty", "obj", vec![], "empty"),
        ("empty", "stl", vec![], "empty"),
        ("empty", "off", vec![], "empty"),
        ("empty", "glb", vec![], "empty"),
        ("wrong magic", "ply", glb.clone(), "looks like GLB"),
        ("wrong magic", "obj", glb.clone(), "looks like GLB"),
        ("wrong magic", "obj", b"these are words\nand no model\n".to_vec(), "not a OBJ file"),
        ("wrong magic", "stl", b"these are words\n".to_vec(), "not a STL file"),
        ("wrong magic", "stl", glb.clone(), "looks like GLB"),
        ("wrong magic", "off", glb.clone(), "looks like GLB"),
        ("wrong magic", "glb", b"{\"asset\":{}}".to_vec(), "looks like JSON"),
        ("header only", "ply", faces.clone().into(), "promises 2 points"),
        ("header only", "obj", b"# a comment\no thing\n".to_vec(), "no vertices"),
        ("header only", "stl", stl[..84].to_vec(), "promises 4 triangles"),
        ("header only", "stl", b"solid nothing\nendsolid nothing\n".to_vec(), "no vertices"),
        ("header only", "off", b"OFF\n3 1 0\n".to_vec(), "promises 3 vertices"),
        ("header only", "off", b"OFF\n".to_vec(), "cut short"),
        ("header only", "glb", glb[..20].to_vec(), "cut short"),
        ("truncated header", "stl", stl[..50].to_vec(), "cut short"),
        ("truncated header", "glb", glb[..10].to_vec(), "cut short"),
        ("truncated body", "ply", format!("{faces}0 0 0\n1 1 1\n3 0 1").into(), "promises 1 faces but the file has 0"),
        ("truncated body", "obj", b"v 1 2 3\nv 4 5\n".to_vec(), "line 2 ends"),
        ("truncated body", "stl", stl[..stl.len() - 1].to_vec(), "promises 4 triangles but the file has 3"),
        ("truncated body", "stl", facets.into(), "within a facet"),
        ("truncated body", "off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n".to_vec(), "promises 3 vertices but the file has 2"),
        ("truncated body", "off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1".to_vec(), "line 6 ends"),
        ("truncated body", "off", b"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n".to_vec(), "promises 1 faces"),
        ("truncated body", "glb", glb[..glb.len() - 4].to_vec(), "cut short"),
        ("NaN", "obj", b"v nan 0 0\n".to_vec(), "NaN"),
        ("NaN", "off", b"OFF\n1 0 0\n0 inf 0\n".to_vec(), "NaN or infinite"),
        ("NaN", "stl", patched(stl.clone(), 96, &f32::NAN.to_le_bytes()), "NaN"),
        ("NaN", "ply", format!("{faces}0 0 0\n1 1 nan\n3 0 1 0\n").into(), "NaN"),
        (
            "count 2^32",
            "ply",
            faces.replace("face 1", "face 4294967296").replace("end_header\n", "end_header\n0 0 0\n1 1 1\n").into(),
            "promises 4294967296 faces",
        ),
        ("count -1", "ply", faces.replace("face 1", "face -1").into(), "valid count"),
        ("count 2^32", "off", b"OFF\n4294967296 1 0\n0 0 0\n".to_vec(), "promises 4294967296 vertices"),
        ("count 2^32", "off", b"OFF\n1 4294967296 0\n0 0 0\n".to_vec(), "promises 4294967296 faces"),
        ("count -1", "off", b"OFF\n-1 1 0\n0 0 0\n".to_vec(), "count of -1"),
        ("count 2^32 - 1", "stl", patched(stl.clone(), 80, &u32::MAX.to_le_bytes()), "promises 4294967295 triangles"),
        ("length 2^32 - 1", "glb", patched(glb.clone(), 8, &u32::MAX.to_le_bytes()), "cut short"),
        ("length 2^32 - 1", "glb", patched(glb.clone(), 12, &u32::MAX.to_le_bytes()), "cut short"),
        ("count -1", "glb", replaced(&glb, "\"count\":12", "\"count\":-1"), ""),
        ("count 99", "glb", replaced(&glb, "\"count\":12", "\"count\":99"), "beyond the data"),
        ("face beyond", "ply", format!("{faces}0 0 0\n1 1 1\n3 0 1 2\n").into(), "vertex 2 of 2"),
        ("face beyond", "obj", b"v 0 0 0\nv 1 0 0\nf 1 2 3\n".to_vec(), "vertex 2 of 2"),
        ("face beyond", "obj", b"v 0 0 0\nv 1 0 0\nf -9 1 2\n".to_vec(), "vertex -7 of 2"),
        ("face beyond", "off", b"OFF\n1 1 0\n0 0 0\n3 0 0 4294967296\n".to_vec(), "vertex 4294967296 of 1"),
        ("face zero", "obj", b"v 0 0 0\nv 1 0 0\nf 0 1 2\n".to_vec(), "vertex -1 of 2"),
        ("large coordinate", "obj", b"v 1e12 0 0\n".to_vec(), "too large"),
        ("large coordinate", "stl", patched(stl.clone(), 96, &1e12_f32.to_le_bytes()), "too large"),
        ("a word for a number", "obj", b"v 0 zero 0\n".to_vec(), "`zero`"),
        ("a word for a number", "off", b"OFF\n1 0 0\n0 zero 0\n".to_vec(), "`zero`"),
        ("binary OFF", "off", b"OFF BINARY\n\0\0\0\x01".to_vec(), "not supported"),
        ("four dimensions", "off", b"4OFF\n1 0 0\n0 0 0 0\n".to_vec(), "not supported"),
        ("version 1", "glb", patched(glb.clone(), 4, &1_u32.to_le_bytes()), "not supported"),
    ];
    for (what, suffix, bytes, part) in cases {
        match mesh(suffix, &bytes) {
            Ok(mesh) => panic!("{what} {suffix}: read {} vertices", mesh.vertices.len()),
            Err(error) => {
                let text = assert_message(&error, "bad.");
                println!("{what:18} {text}");
                assert!(text.contains(part), "{what} {suffix}: {text}");
            }
        }
    }
}

#[test]
fn every_length_of_every_format() {
    for (suffix, format) in CloudFormat::KNOWN {
        let sound = sound_cloud(*format);
        for length in 0..sound.len() {
            if let Err(error) = cloud(suffix, &sound[..length]) {
                assert_message(&error, "bad.");
            }
        }
        assert_eq!(cloud(suffix, &sound).unwrap().cloud.len(), 4);
    }
    for bytes in [crate::common::pcd_ascii(), crate::common::pcd_compressed()] {
        for length in 0..bytes.len() {
            if let Err(error) = cloud("pcd", &bytes[..length]) {
                assert_message(&error, "bad.");
            }
        }
    }
    for (suffix, format) in MeshFormat::KNOWN {
        let sound = sound_mesh(*format);
        for length in 0..sound.len() {
            if let Err(error) = mesh(suffix, &sound[..length]) {
                assert_message(&error, "bad.");
            }
        }
        assert_eq!(mesh(suffix, &sound).unwrap().vertices.len(), 4);
    }
}

/// Every byte of the small files set to values that counts and lengths are worst at.
#[test]
fn every_byte_damaged() {
    for (suffix, format) in CloudFormat::KNOWN {
        let sound = sound_cloud(*format);
        for at in 0..sound.len() {
            for value in [0, 1, 0x7F, 0x80, 0xFF] {
                if let Err(error) = cloud(suffix, &patched(sound.clone(), at, &[value])) {
                    assert_message(&error, "bad.");
                }
            }
        }
    }
    for (suffix, format) in MeshFormat::KNOWN {
        let sound = sound_mesh(*format);
        for at in 0..sound.len() {
            for value in [0, 1, 0x7F, 0x80, 0xFF, b'9', b'-'] {
                if let Err(error) = mesh(suffix, &patched(sound.clone(), at, &[value])) {
                    assert_message(&error, "bad.");
                }
            }
        }
    }
}

#[test]
fn bad_places() {
    let folder = folder();
    for suffix in ["las", "ply", "xyz", "pcd", "e57", "obj", "stl", "off", "glb"] {
        let is_mesh = MeshFormat::KNOWN.iter().any(|(s, _)| *s == suffix) && suffix != "ply";
        let read = |path: &Path| {
            if is_mesh { read_mesh(path).err() } else { read_cloud(path).err() }.expect("this cannot be read")
        };
        let missing = folder.path().join(format!("missing.{suffix}"));
        assert!(assert_message(&read(&missing), "missing.").contains("no such file"));
        let directory = folder.path().join(format!("folder.{suffix}"));
        std::fs::create_dir(&directory).unwrap();
        assert!(assert_message(&read(&directory), "folder.").contains("directory"));
    }
    for name in ["a.dwg", "a", "a.tar.gz"] {
        let text = assert_message(&read_cloud(Path::new(name)).unwrap_err(), name);
        assert!(text.contains("las, laz, ply, xyz, txt, csv, asc, pts, pcd, e57"), "{text}");
        let text = assert_message(&read_mesh(Path::new(name)).unwrap_err(), name);
        assert!(text.contains("ply, obj, stl, off, glb"), "{text}");
    }
    let sample = crate::common::cloud(crate::common::GEOREFERENCED);
    for suffix in ["pcd", "e57"] {
        let path = folder.path().join(format!("out.{suffix}"));
        let error = write_cloud(&path, &sample, &WriteOptions::default()).unwrap_err();
        assert!(assert_message(&error, "out.").contains("cannot be written"));
    }
}

#[cfg(unix)]
#[test]
fn no_permission() {
    use std::os::unix::fs::PermissionsExt;
    let folder = folder();
    let path = folder.path().join("secret.xyz");
    std::fs::write(&path, "1 2 3\n").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o000)).unwrap();
    if std::fs::read(&path).is_ok() {
        println!("skipped reading: this user may read everything");
    } else {
        assert!(assert_message(&read_cloud(&path).unwrap_err(), "secret.xyz").contains("permission denied"));
    }
    // A protected file is not replaced, although the folder would allow it.
    let sample = crate::common::mesh(crate::common::GEOREFERENCED);
    let path = folder.path().join("protected.ply");
    std::fs::write(&path, "old").unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o444)).unwrap();
    let error = write_mesh(&path, &sample, &WriteOptions::default()).unwrap_err();
    assert!(assert_message(&error, "protected.ply").contains("permission denied"));
    assert_eq!(std::fs::read(&path).unwrap(), b"old");
}

#[test]
fn bad_outputs() {
    let folder = folder();
    let sample = crate::common::mesh(crate::common::GEOREFERENCED);
    let write = |path: &Path| write_mesh(path, &sample, &WriteOptions::default()).unwrap_err();
    let text = assert_message(&write(&folder.path().join("no/such/folder/a.ply")), "a.ply");
    assert!(text.contains("does not exist; create it first"), "{text}");
    let directory = folder.path().join("a.ply");
    std::fs::create_dir(&directory).unwrap();
    assert!(assert_message(&write(&directory), "a.ply").contains("directory"));
    let full = Path::new("/dev/full");
    if full.exists() {
        // A link with a suffix: the device itself has none.
        let link = folder.path().join("full.ply");
        #[cfg(unix)]
        std::os::unix::fs::symlink(full, &link).unwrap();
        assert!(assert_message(&write(&link), "full.ply").contains("disk is full"));
    }
}

/// Checksum of E57 pages (CRC-32C), bit by bit.
fn crc32c(bytes: &[u8]) -> u32 {
    let step = |crc: u32| if crc & 1 == 1 { crc >> 1 ^ 0x82F6_3B78 } else { crc >> 1 };
    !bytes.iter().fold(u32::MAX, |crc, byte| (0..8).fold(crc ^ u32::from(*byte), |crc, _| step(crc)))
}

/// An E57 file of a header, XML and sound checksums.
fn e57_of_xml(xml: &str) -> Vec<u8> {
    const PAGE: usize = 1020;
    let pages = (48 + xml.len()).div_ceil(PAGE) as u64;
    let mut plain = b"ASTM-E57".to_vec();
    plain.extend([1_u32, 0].iter().flat_map(|v| v.to_le_bytes()));
    plain.extend([pages * 1024, 48, xml.len() as u64, 1024].iter().flat_map(|v| v.to_le_bytes()));
    plain.extend(xml.bytes());
    plain.resize(pages as usize * PAGE, 0);
    plain.chunks(PAGE).flat_map(|page| [page, &crc32c(page).to_be_bytes()].concat()).collect()
}

#[test]
fn e57_with_hostile_xml() {
    let depth = 200_000;
    let nested = format!("<e57Root>{}{}</e57Root>", "<a>".repeat(depth), "</a>".repeat(depth));
    let entities = "<!DOCTYPE r [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;&a;&a;\">\
        <!ENTITY c \"&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;\"><!ENTITY d \"&c;&c;&c;&c;&c;&c;&c;&c;&c;&c;\">\
        <!ENTITY e \"&d;&d;&d;&d;&d;&d;&d;&d;&d;&d;\">]><e57Root>&e;&e;&e;&e;</e57Root>";
    let root = |prototype: &str, records: &str| {
        format!(
            "<?xml version=\"1.0\"?><e57Root type=\"Structure\" xmlns=\"http://www.astm.org/COMMIT/E57/2010-e57-v1.0\">\
             <formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName><guid type=\"String\">a</guid>\
             <versionMajor type=\"Integer\">1</versionMajor><versionMinor type=\"Integer\">0</versionMinor>\
             <data3D type=\"Vector\"><vectorChild type=\"Structure\"><guid type=\"String\">b</guid>\
             <points type=\"CompressedVector\" fileOffset=\"48\" recordCount=\"{records}\">\
             <prototype type=\"Structure\">{prototype}</prototype><codecs type=\"Vector\"/></points>\
             </vectorChild></data3D></e57Root>"
        )
    };
    let constant =
        ["X", "Y", "Z"].map(|axis| format!("<cartesian{axis} type=\"Integer\" minimum=\"1\" maximum=\"1\"/>")).concat();
    let float = ["X", "Y", "Z"].map(|axis| format!("<cartesian{axis} type=\"Float\"/>")).concat();
    let wide = ["X", "Y", "Z"].map(|axis| format!("<cartesian{axis} type=\"Integer\"/>")).concat();
    for (what, xml, part) in [
        ("nested elements", nested, ""),
        ("entities", entities.to_string(), ""),
        ("no scans", "<e57Root/>".into(), ""),
        ("constant fields", root(&constant, "1000"), "only constant fields"),
        ("count 2^32", root(&float, "4294967296"), "promises 4294967296 points"),
        ("count -1", root(&float, "-1"), ""),
        ("no data", root(&float, "3"), "E57 data cannot be decoded"),
        ("widest integers", root(&wide, "3"), ""),
        ("no coordinates", root("<intensity type=\"Float\"/>", "3"), "neither Cartesian nor spherical"),
    ] {
        let error = cloud("e57", &e57_of_xml(&xml)).map(|file| file.report).unwrap_err();
        let text = assert_message(&error, "bad.e57");
        println!("{what:18} {text}");
        assert!(text.contains(part), "{what}: {text}");
    }
}
