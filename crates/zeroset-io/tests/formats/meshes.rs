//! Meshes: every writer read back, and readers on what other programs write.

use std::path::Path;

use crate::common::{GEOREFERENCED, SWISS, assert_near, attributes, folder, mesh, world};
use zeroset::mesh::Mesh;
use zeroset_io::{IoError, LinearUnit, MeshFormat, WriteOptions, read_mesh, read_mesh_bytes, write_mesh};

fn read(name: &str, content: impl AsRef<[u8]>) -> Result<Mesh, IoError> {
    let path = Path::new(name);
    read_mesh_bytes(path, MeshFormat::from_path(path)?, content.as_ref())
}

#[track_caller]
fn world_of(mesh: &Mesh) -> Vec<[f64; 3]> {
    world(mesh.world_from_local, &mesh.vertices)
}

#[test]
fn world_coordinates_survive_to_the_millimetre() {
    let folder = folder();
    for sample in [GEOREFERENCED, SWISS] {
        let sent = mesh(sample);
        for suffix in ["ply", "obj", "off", "glb"] {
            let path = folder.path().join(format!("mesh.{suffix}"));
            let report = write_mesh(&path, &sent, &WriteOptions::default()).unwrap();
            assert_eq!(report.bytes, std::fs::metadata(&path).unwrap().len());
            let back = read_mesh(&path).unwrap();
            assert_near(&world_of(&back), &sample, 0.000_501);
            assert_eq!(back.triangles, sent.triangles, "{suffix}");
            assert_eq!(back.crs, sent.crs, "{suffix}");
            assert_eq!(back.attributes.colors, attributes().colors, "{suffix}");
            let all = matches!(suffix, "ply" | "glb");
            assert_eq!(back.attributes.classes, attributes().classes.filter(|_| all), "{suffix}");
            assert_eq!(back.attributes.intensities, attributes().intensities.filter(|_| all), "{suffix}");
            assert_eq!(report.attributes_left_out.is_empty(), all, "{suffix}");
            assert_eq!(report.local_offset, (suffix == "glb").then_some(sent.world_from_local), "{suffix}");
        }
    }
}

#[test]
fn stl_is_local_and_says_so() {
    let folder = folder();
    let path = folder.path().join("mesh.stl");
    let sent = mesh(SWISS);
    let report = write_mesh(&path, &sent, &WriteOptions::default()).unwrap();
    assert_eq!(report.local_offset, Some(sent.world_from_local));
    assert_eq!(report.attributes_left_out, ["colors", "intensities", "classes"]);
    assert_eq!(report.bytes, 84 + 50 * 4);
    let back = read_mesh(&path).unwrap();
    assert_eq!((back.vertices.len(), back.triangles.len()), (4, 4));
    // Vertices come in the order of their first use: 0 2 1 3.
    let order = [0, 2, 1, 3];
    let expected: Vec<_> = order.iter().map(|i| sent.vertices[*i]).collect();
    assert_near(&world_of(&back), &expected, 1e-4);
}

#[test]
fn ply_is_single_precision_where_that_is_enough() {
    let folder = folder();
    let path = folder.path().join("mesh.ply");
    let kind = |sent: &Mesh, resolution: Option<f64>| {
        write_mesh(&path, sent, &WriteOptions { resolution, ..WriteOptions::default() }).unwrap();
        let bytes = std::fs::read(&path).unwrap();
        let text = String::from_utf8_lossy(&bytes).into_owned();
        if text.contains("property double x") { "double" } else { "float" }
    };
    let unit = Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2]],
        ..Mesh::default()
    };
    assert_eq!(kind(&unit, None), "float");
    assert_eq!(kind(&unit, Some(0.01)), "float");
    assert_eq!(kind(&unit, Some(1e-5)), "double");
    assert_eq!(kind(&mesh(GEOREFERENCED), None), "double");
    assert_eq!(kind(&mesh(SWISS), Some(1000.0)), "double");
}

#[test]
fn ply_comments_carry_generator_system_and_unit() {
    let folder = folder();
    let path = folder.path().join("mesh.ply");
    let options = WriteOptions {
        unit: Some(LinearUnit::Metre),
        generator: "a program".into(),
        comments: vec!["two\nlines".into()],
        ..WriteOptions::default()
    };
    let sent = Mesh { crs: Some("PROJCS[\n  \"a\"]".into()), ..mesh(SWISS) };
    write_mesh(&path, &sent, &options).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    let text = String::from_utf8_lossy(&bytes);
    for line in ["comment generator a program", "comment crs PROJCS[ \"a\"]", "comment unit metre", "comment two lines"]
    {
        assert!(text.lines().any(|l| l == line), "{line}\n{}", &text[..400]);
    }
    assert_eq!(read_mesh(&path).unwrap().crs.as_deref(), Some("PROJCS[ \"a\"]"));
}

#[test]
fn meshes_without_triangles_can_be_written() {
    let folder = folder();
    let points = Mesh { vertices: vec![[1.0, 2.0, 3.0]], ..Mesh::default() };
    for (suffix, _) in MeshFormat::KNOWN {
        let path = folder.path().join(format!("points.{suffix}"));
        write_mesh(&path, &points, &WriteOptions::default()).unwrap();
        write_mesh(&path, &Mesh::default(), &WriteOptions::default()).unwrap();
    }
}

#[test]
fn unsound_meshes_are_refused_and_the_old_file_stays() {
    let folder = folder();
    for (suffix, _) in MeshFormat::KNOWN {
        let path = folder.path().join(format!("mesh.{suffix}"));
        std::fs::write(&path, "old").unwrap();
        let nan = Mesh { vertices: vec![[0.0, f64::NAN, 0.0]], ..Mesh::default() };
        let index = Mesh { vertices: vec![[0.0; 3]; 3], triangles: vec![[0, 1, 3]], ..Mesh::default() };
        let mut length = mesh(GEOREFERENCED);
        length.attributes.classes = Some(vec![1]);
        for bad in [nan, index, length] {
            let error = write_mesh(&path, &bad, &WriteOptions::default()).unwrap_err().to_string();
            assert!(error.contains("mesh.") && error.lines().count() == 1, "{error}");
            assert_eq!(std::fs::read(&path).unwrap(), b"old");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), MeshFormat::KNOWN.len());
}

const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.5], [0.0, 1.0, 0.0]];

#[test]
fn obj_of_other_programs() {
    let vertices = "v 0 0 0\nv 1 0 0\nv 1 1 0.5\nv 0 1 0\n";
    for faces in [
        "f 1 2 3 4",
        "f 1/1 2/2 3/3 4/4",
        "f 1//1 2//1 3//1 4//1",
        "f -4 -3 -2 -1",
        "f 1 2 \\\n 3 4",
        "f 1/2/3 2 3 4\r",
    ] {
        let text = format!("# note\nmtllib a.mtl\no thing\n{vertices}vn 0 0 1\nvt 0 0\ns off\ng a b\n{faces}\nl 1 2\n");
        let mesh = read("a.obj", &text).unwrap();
        assert_eq!(mesh.vertices, SQUARE, "{faces}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{faces}");
    }
    let first = read("a.obj", format!("f 1 2 3\n{vertices}")).unwrap();
    assert_eq!(first.triangles, [[0, 1, 2]]);
    let colors = read("a.obj", "v 0 0 0 1 0 0\nv 1 0 0 1.0 0 1 0\nv 0 1 0 0 0 0.5\nf 1 2 3\n").unwrap();
    assert_eq!(colors.attributes.colors, Some(vec![[255, 0, 0], [0, 255, 0], [0, 0, 128]]));
    let weights = read("a.obj", "v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\nf 1 2 3\n").unwrap();
    assert_eq!(weights.attributes.colors, None);
}

#[test]
fn off_of_other_programs() {
    let body = "0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n4 0 1 2 3";
    for text in [
        format!("OFF\n4 1 0\n{body}"),
        format!("OFF 4 1 5\n{body}\n"),
        format!("# first\nOFF # here\n\n# note\n4 1 # vertices, faces\n\n{body} 255 0 0 # red\n\n"),
        format!("OFF\r\n4 1 0\r\n{}\r\n", body.replace('\n', "\r\n")),
        "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0.5 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n".into(),
    ] {
        let mesh = read("a.off", &text).unwrap();
        assert_eq!(mesh.vertices, SQUARE, "{text}");
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]], "{text}");
    }
    let colors =
        read("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255\n0 1 0 0 0 128 255\n3 0 1 2\n").unwrap();
    assert_eq!(colors.attributes.colors, Some(vec![[255, 0, 0], [0, 255, 0], [0, 0, 128]]));
    let shares =
        read("a.off", "CNOFF\n3 1 0\n0 0 0 0 0 1 1 0 0\n1 0 0 0 0 1 0 1 0\n0 1 0 0 0 1 0 0 .5\n3 0 1 2").unwrap();
    assert_eq!(shares.attributes.colors, Some(vec![[255, 0, 0], [0, 255, 0], [0, 0, 128]]));
}

#[test]
fn stl_in_text_is_joined() {
    let facet = |corners: [&str; 3]| {
        let vertices: String = corners.iter().map(|c| format!("      vertex {c}\n")).collect();
        format!("  facet normal 0 0 1\n    outer loop\n{vertices}    endloop\n  endfacet\n")
    };
    let text = format!(
        "solid thing\n{}{}{}endsolid thing\n",
        facet(["0 0 0", "1 0 0", "1 1 0.5"]),
        facet(["-0 0.0 0e0", "1 1 5e-1", "0 1 0"]),
        facet(["0 0 0", "0 0 0", "1 1 0.5"])
    );
    let mesh = read("a.stl", &text).unwrap();
    assert_eq!(mesh.vertices, SQUARE);
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
}

#[test]
fn stl_corners_that_differ_by_rounding_are_joined() {
    let facet =
        |corners: [&str; 3]| format!("facet\nouter loop\nvertex {}\nendloop\nendfacet\n", corners.join("\nvertex "));
    let text = format!(
        "solid\n{}{}endsolid\n",
        facet(["0 0 -2.7e-16", "1 0 0.5", "1 1 0.001"]),
        facet(["0 2.7e-16 0", "1 1 0.0010001", "0 1 0"])
    );
    let mesh = read("a.stl", &text).unwrap();
    // The third corner of the first is apart from the second of the second, if only by a ten-millionth.
    assert_eq!(mesh.triangles, [[0, 1, 2], [0, 3, 4]]);
    assert_eq!(mesh.vertices[0], [0.0, 0.0, -2.7e-16]);
}

#[test]
fn a_binary_stl_may_start_with_solid() {
    let mut bytes = crate::common::sound_mesh(MeshFormat::Stl);
    bytes[..6].copy_from_slice(b"solid ");
    assert_eq!(read("a.stl", &bytes).unwrap().triangles.len(), 4);
}

#[test]
fn ply_polygons_are_fans() {
    for list in ["vertex_indices", "vertex_index"] {
        let text = format!(
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n\
             element face 2\nproperty uchar flags\nproperty list uchar int {list}\nproperty list uchar float texcoord\n\
             end_header\n0 0 0\n1 0 0\n1 1 0.5\n0 1 0\n7 4 0 1 2 3 2 0.5 0.5\n7 2 0 1 0\n"
        );
        let mesh = read("a.ply", &text).unwrap();
        assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3]]);
    }
}

/// The JSON chunk and the length of the binary chunk.
fn glb_parts(bytes: &[u8]) -> (serde_json::Value, usize) {
    let word = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
    assert_eq!((&bytes[..4], word(4), word(8)), (&b"glTF"[..], 2, bytes.len()));
    let json = word(12);
    assert_eq!((json % 4, &bytes[16..20]), (0, &b"JSON"[..]));
    let binary = word(20 + json);
    assert_eq!((binary % 4, &bytes[24 + json..28 + json], 28 + json + binary), (0, &b"BIN\0"[..], bytes.len()));
    (serde_json::from_slice(&bytes[20..20 + json]).unwrap(), binary)
}

/// The rules of the format that a validator checks first.
#[test]
fn glb_keeps_the_rules() {
    let bytes = crate::common::sound_mesh(MeshFormat::Glb);
    let (json, binary) = glb_parts(&bytes);
    assert_eq!(json["asset"]["version"], "2.0");
    assert_eq!(json["buffers"][0]["byteLength"], binary);
    let (mut end, views) = (0, json["bufferViews"].as_array().unwrap());
    for view in views {
        assert_eq!(view["byteOffset"], end);
        assert_eq!(end % 4, 0);
        end += view["byteLength"].as_u64().unwrap();
    }
    assert_eq!(end as usize, binary);
    for accessor in json["accessors"].as_array().unwrap() {
        let component = match accessor["componentType"].as_u64().unwrap() {
            5126 | 5125 => 4,
            5123 => 2,
            other => panic!("component {other}"),
        };
        let width = match accessor["type"].as_str().unwrap() {
            "SCALAR" => 1,
            "VEC3" => 3,
            "VEC4" => 4,
            other => panic!("type {other}"),
        };
        let view = &views[accessor["bufferView"].as_u64().unwrap() as usize];
        assert_eq!(view["byteLength"], accessor["count"].as_u64().unwrap() * component * width);
    }
    let sent = mesh(GEOREFERENCED);
    let position =
        &json["accessors"][json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize];
    for axis in 0..3 {
        let values = sent.vertices.iter().map(|v| v[axis] as f32);
        let (low, high) = (values.clone().fold(f32::INFINITY, f32::min), values.fold(f32::NEG_INFINITY, f32::max));
        assert_eq!(position["min"][axis].as_f64(), Some(f64::from(low)));
        assert_eq!(position["max"][axis].as_f64(), Some(f64::from(high)));
    }
    assert_eq!(json["nodes"][1]["translation"][0], sent.world_from_local[0]);
    assert_eq!(json["nodes"][0]["rotation"][0], -std::f64::consts::FRAC_1_SQRT_2);
}

/// A GLB file out of JSON and binary data, as another program might write it.
fn glb(json: serde_json::Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = b"glTF".to_vec();
    for word in [2, (28 + text.len() + binary.len()) as u32, text.len() as u32] {
        out.extend(word.to_le_bytes());
    }
    out.extend(b"JSON");
    out.extend(text);
    out.extend((binary.len() as u32).to_le_bytes());
    out.extend(b"BIN\0");
    out.extend(binary);
    out
}

#[test]
fn glb_of_other_programs() {
    let mut binary: Vec<u8> =
        [0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0].iter().flat_map(|v| v.to_le_bytes()).collect();
    binary.extend([0_u16, 1, 2, 0].iter().flat_map(|v| v.to_le_bytes()));
    let json = serde_json::json!({
        "asset": { "version": "2.0" },
        "scenes": [{ "nodes": [0, 1] }],
        "nodes": [
            { "mesh": 0, "scale": [2.0, 2.0, 2.0], "translation": [10.0, 0.0, 0.0] },
            { "children": [2], "matrix": [1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,5,0,1] },
            { "mesh": 0 }
        ],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3 },
            { "bufferView": 1, "componentType": 5123, "type": "SCALAR", "count": 3 }
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 36 },
            { "buffer": 0, "byteOffset": 36, "byteLength": 6 }
        ],
        "buffers": [{ "byteLength": 44 }]
    });
    let mesh = read("a.glb", glb(json, &binary)).unwrap();
    // y up became z up; the second copy is mirrored, so its corners change order.
    let expected =
        [[10.0, 0.0, 0.0], [12.0, 0.0, 0.0], [10.0, 0.0, 2.0], [0.0, 0.0, 5.0], [1.0, 0.0, 5.0], [0.0, 0.0, 6.0]];
    assert_near(&world_of(&mesh), &expected, 1e-12);
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 5, 4]]);
}

#[test]
fn glb_scenes_that_multiply_are_refused() {
    let bytes = crate::common::sound_mesh(MeshFormat::Glb);
    let (mut json, length) = glb_parts(&bytes);
    let binary = &bytes[bytes.len() - length..];
    json["nodes"][0]["children"] = serde_json::json!([0]);
    let cycle = read("a.glb", glb(json.clone(), binary)).unwrap_err().to_string();
    assert!(cycle.contains("tree"), "{cycle}");
    json["nodes"][0]["children"] = serde_json::json!([1, 1]);
    assert!(read("a.glb", glb(json.clone(), binary)).is_err());
    json["nodes"][0]["children"] = serde_json::json!([1]);
    let primitive = json["meshes"][0]["primitives"][0].clone();
    json["meshes"][0]["primitives"] = vec![primitive; 1000].into();
    let copies = read("a.glb", glb(json.clone(), binary));
    // A thousand copies cost a thousand descriptions: that is in proportion. The data of a large mesh is not.
    assert!(copies.is_ok());
    json["accessors"][0]["count"] = 5_000_000_000_u64.into();
    assert!(read("a.glb", glb(json, binary)).is_err());
}

#[test]
fn ply_faces_of_every_index_type_and_byte_order() {
    for (kind, size, signed) in [("int", 4, true), ("uint", 4, false), ("short", 2, true), ("uchar", 1, false)] {
        for big in [false, true] {
            let order = if big { "big" } else { "little" };
            let head = |faces: usize| {
                format!(
                    "ply\nformat binary_{order}_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
                     property float z\nelement face {faces}\nproperty list uchar {kind} vertex_indices\nend_header\n"
                )
            };
            let number = |value: i32| {
                let mut bytes = value.to_le_bytes()[..size].to_vec();
                if big {
                    bytes.reverse();
                }
                bytes
            };
            let mut body = Vec::new();
            for c in SQUARE.iter().flatten() {
                let c = *c as f32;
                body.extend(if big { c.to_be_bytes() } else { c.to_le_bytes() });
            }
            let vertices = body.clone();
            for list in [&[0, 1, 2, 3][..], &[], &[0, 1], &[3, 2, 1]] {
                body.push(list.len() as u8);
                body.extend(list.iter().flat_map(|i| number(*i)));
            }
            let mesh = read("a.ply", [head(4).as_bytes(), &body].concat()).unwrap();
            assert_eq!(mesh.vertices, SQUARE);
            assert_eq!(mesh.triangles, [[0, 1, 2], [0, 2, 3], [3, 2, 1]]);
            let short = read("a.ply", [head(4).as_bytes(), &body[..body.len() - 1]].concat()).unwrap_err();
            assert!(matches!(short, IoError::CountMismatch { declared: 4, found: 3, .. }), "{short}");
            let negative = [&vertices[..], &[3], &number(0), &number(1), &number(-1)].concat();
            let error = read("a.ply", [head(1).as_bytes(), &negative].concat()).unwrap_err();
            assert!(matches!(error, IoError::BadIndex { vertex, .. } if (vertex == -1) == signed), "{error}");
        }
    }
}
