//! Models in files: what comes back, and what is refused.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::Arc;

use crate::common::{Parts, every_solid, folder, model, model_bytes, read_bad, small_fitted, sound_model, wrapped};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Value, json};
use zeroset::cloud::{Attributes, Cloud};
use zeroset::field::LatticeField;
use zeroset::fit::cascade::Scene;
use zeroset::model::{AttributeChoice, Fitted, FittedParts, MeshParams, Model, Solid, mesh};
use zeroset::reconstruct::{Quality, ReconstructParams, Resolution, plan};
use zeroset::sample::{self, SceneKind};
use zeroset_io::{IoError, is_model, read_model, write_model};

/// The Dutch grid.
const WORLD: [f64; 3] = [84_810.25, 447_412.5, 3.0];

/// A scene elsewhere, with values beside its points.
fn cloud(kind: SceneKind) -> Cloud {
    let mut cloud = sample::Scene::new(kind, 2).points(20_000, 0.001, 2);
    cloud.world_from_local = std::array::from_fn(|a| cloud.world_from_local[a] + WORLD[a]);
    let numbers = || 0..cloud.len();
    cloud.attributes = Attributes {
        colors: Some(numbers().map(|i| [i as u8, (i >> 8) as u8, 7]).collect()),
        intensities: Some(numbers().map(|i| i as f32 * 0.1).collect()),
        classes: Some(numbers().map(|i| (i % 7) as u8).collect()),
    };
    cloud
}

fn fit(kind: SceneKind, quality: Quality) -> Fitted {
    let resolution = Resolution::Length(0.02);
    let params = ReconstructParams { quality, resolution, ..ReconstructParams::default() };
    plan(&cloud(kind), &params, &()).unwrap().fit(&()).unwrap().0
}

/// A fit that has lines and polygons, too.
fn with_constraints(fitted: &Fitted) -> Fitted {
    let p = fitted.parts().points[0].map(f64::from);
    let q: [f64; 3] = std::array::from_fn(|a| p[a] + [0.1, 0.05, 0.0][a]);
    let r: [f64; 3] = std::array::from_fn(|a| p[a] + [0.0, 0.1, 0.0][a]);
    let parts = FittedParts {
        lines: vec![vec![[p, q], [q, r]], vec![[r, p]]],
        polygons: vec![[p, q, r]],
        ..fitted.parts().clone()
    };
    Fitted::kept(fitted.lattice().clone(), parts).unwrap()
}

fn read(bytes: &[u8]) -> Model {
    read_bad(bytes).unwrap()
}

#[track_caller]
fn refused(bytes: &[u8]) -> String {
    message(&read_bad(bytes).expect_err("it is not sound"))
}

/// One line that names the file and has a remedy.
#[track_caller]
fn message(error: &IoError) -> String {
    let text = error.to_string();
    assert!(text.lines().count() == 1 && text.contains("bad.zset"), "{text}");
    assert!(text.rsplit_once("; ").is_some_and(|(_, remedy)| remedy.len() >= 8), "{text} has no remedy");
    text
}

/// All of a solid as text, F and all numbers with it.
fn told(solid: &Solid) -> String {
    let mut text = format!("{solid:?}");
    let mut visit = vec![solid];
    while let Some(solid) = visit.pop() {
        match solid {
            Solid::Fitted(fitted) => {
                let field = fitted.lattice();
                text += &format!("{:?} {:?} {:?}", field.blocks.keys, field.known, field.values);
            }
            Solid::Union(of) | Solid::Intersection(of) => visit.extend(of),
            Solid::Difference(of) | Solid::SmoothUnion { of, .. } => visit.extend(&**of),
            Solid::Complement(of) | Solid::Offset { of, .. } | Solid::Shell { of, .. } | Solid::Placed { of, .. } => {
                visit.push(of);
            }
            _ => {}
        }
    }
    text
}

#[test]
fn every_solid_comes_back() {
    let model = model(every_solid());
    let bytes = model_bytes(&model);
    let again = read(&bytes);
    assert_eq!(told(&again.solid), told(&model.solid));
    assert_eq!((&again.crs, &again.provenance), (&model.crs, &model.provenance));
    assert_eq!(model_bytes(&again), bytes);
    assert_eq!(model_bytes(&model), bytes);
    // What operands share is written once, and shared again.
    let arrays = Parts::of(&bytes).arrays;
    assert_eq!(arrays.keys().filter(|name| name.starts_with("meshes/") || name.starts_with("heights/")).count(), 3);
    let Solid::Union(of) = &again.solid else { panic!("{:?}", again.solid) };
    let (Solid::SmoothUnion { of: pair, .. }, Solid::Placed { of: placed, .. }) = (&of[3], &of[6]) else {
        panic!("{of:?}")
    };
    let (Solid::Fitted(a), Solid::Fitted(b)) = (&pair[0], &**placed) else { panic!("{of:?}") };
    assert!(Arc::ptr_eq(a, b));
}

#[test]
fn a_fitted_model_gives_the_same_mesh() {
    for (kind, quality) in [
        (SceneKind::Torus, Quality::Draft),
        (SceneKind::Box, Quality::Normal),
        (SceneKind::AirborneCity, Quality::Normal),
    ] {
        let fitted = with_constraints(&fit(kind, quality));
        assert_eq!(fitted.parts().structure.is_some(), quality == Quality::Normal);
        let before = model(Solid::Fitted(Arc::new(fitted)));
        let bytes = model_bytes(&before);
        let after = read(&bytes);
        assert_eq!(model_bytes(&after), bytes, "{kind:?}");
        assert_eq!(told(&after.solid), told(&before.solid), "{kind:?}");
        let params = MeshParams { attributes: AttributeChoice::Rgb, ..MeshParams::default() };
        let of = |model: &Model| mesh(&model.solid, &params, &()).unwrap();
        let ((a, from_a), (b, from_b)) = (of(&before), of(&after));
        assert!(
            a.vertices.as_flattened().iter().zip(b.vertices.as_flattened()).all(|(a, b)| a.to_bits() == b.to_bits())
        );
        assert_eq!(a, b, "{kind:?}");
        assert_eq!((from_a.sharp, from_a.constraints), (from_b.sharp, from_b.constraints));
        // And as an operand.
        let cut = Solid::Ball { center: WORLD.map(|c| c + 0.5), radius: 0.3 };
        let of = |model: &Model| {
            mesh(&Solid::Difference(Box::new([model.solid.clone(), cut.clone()])), &MeshParams::default(), &())
                .unwrap()
                .0
        };
        assert_eq!(of(&before), of(&after), "{kind:?}");
    }
}

#[test]
fn every_truncation_is_an_error() {
    for bytes in [sound_model(), model_bytes(&model(every_solid()))] {
        read(&bytes);
        for length in 0..bytes.len() {
            refused(&bytes[..length]);
        }
        for more in [1, 64, 100] {
            let longer = [bytes.as_slice(), &vec![0; more]].concat();
            assert!(refused(&longer).contains(&format!("{more} bytes follow")));
        }
    }
}

#[test]
fn every_flipped_bit_is_an_error_but_in_padding() {
    let mut bytes = sound_model();
    let parts = Parts::of(&bytes);
    let first = bytes.len() - parts.arrays.values().map(|own| own.len().next_multiple_of(64)).sum::<usize>();
    let mut is_content = vec![true; first];
    for own in parts.arrays.values() {
        is_content.extend((0..own.len().next_multiple_of(64)).map(|i| i < own.len()));
    }
    for at in 0..bytes.len() {
        for bit in (0..8).filter(|bit| at < first || (at + bit) % 3 == 0) {
            bytes[at] ^= 1 << bit;
            if is_content[at] {
                refused(&bytes);
            } else {
                read(&bytes);
            }
            bytes[at] ^= 1 << bit;
        }
    }
}

#[test]
fn other_files_and_versions_are_refused() {
    let sound = sound_model();
    let mut newer = sound.clone();
    newer[8] = 2;
    assert!(refused(&newer).contains("version 2 of the format is not supported"));
    assert!(
        refused(b"ply\nformat ascii 1.0\nelement vertex 0\nend_header\n")
            .contains("not a ZSET file (it looks like PLY)")
    );
    assert!(refused(&[]).contains("cut short"));
    // A transfer as text.
    let text: Vec<u8> = sound.iter().copied().filter(|&byte| byte != b'\r').collect();
    assert!(refused(&text).contains("not a ZSET file"));
    let mut long = sound.clone();
    long[16..24].copy_from_slice(&u64::MAX.to_le_bytes());
    assert!(refused(&long).contains("cut short in its header"));
    for (name, is_one) in [("a.zset", true), ("a.ZSet", true), ("a.zset.ply", false), ("zset", false)] {
        assert_eq!(is_model(Path::new(name)), is_one);
    }
    let error = write_model(Path::new("bad.zset.ply"), &model(every_solid())).unwrap_err();
    assert!(message(&error).contains("unknown model format `.ply`"));
    let folder = folder();
    let error = read_model(&folder.path().join("bad.zset")).unwrap_err();
    assert!(message(&error).contains("no such file"));
}

#[test]
fn bad_headers_are_refused() {
    let cases = [
        ("/models/0/lattice/finest", json!(4_000_000_000_u32), "lattice of model 0"),
        ("/models/0/lattice/finest", json!(5_000_000_000_u64), "its header"),
        ("/models/0/lattice/finest", json!(37), "lattice of model 0"),
        ("/models/0/lattice/blocks", json!([1 << 17, 1 << 17, 1]), "lattice of model 0"),
        ("/models/0/lattice/blocks", json!([u32::MAX, 1, 1]), "lattice of model 0"),
        ("/models/0/lattice/blocks", json!([100, 100, 1]), "number of model 0"),
        ("/models/0/lattice/blocks", json!([0, 1, 1]), "lattice of model 0"),
        ("/models/0/lattice/spacing", json!(0.0), "lattice of model 0"),
        ("/models/0/lattice/spacing", json!(-1.0), "lattice of model 0"),
        ("/models/0/lattice/spacing", json!(1e300), "number of model 0"),
        ("/models/0/lattice/spacing", Value::Null, "its header"),
        ("/models/0/lattice/origin", json!([0.0, 1e12, 0.0]), "number of model 0"),
        ("/models/0/world_from_local", json!([0.0, 1e12, 0.0]), "number of model 0"),
        ("/models/0/bounds", json!([[0.0, 0.0, 0.0], [1e300, 0.0, 0.0]]), "number of model 0"),
        ("/models/0/bounds", json!([[0.0, 0.0, 0.0]]), "its header"),
        ("/models/0/frame", json!([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.1, 1.0]]), "no rotation"),
        ("/models/0/frame", json!([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]), "no rotation"),
        ("/models/0/frame", json!([[0, 0, 0], [0, 0, 0], [0, 0, 0]]), "no rotation"),
        ("/models/0/noise", json!(-0.1), "number of model 0"),
        ("/models/0/trim", json!(0.0), "trim is not positive"),
        ("/models/0/trim", json!(1e300), "number of model 0"),
        ("/models/0/min_component", json!(-1), "its header"),
        ("/models/0/curved_creases", json!(3), "its header"),
        ("/models/0/scene", json!("cave"), "unknown variant `cave`"),
        ("/models/0/metric", json!("furlong"), "unknown variant `furlong`"),
        ("/models", json!([]), "it has no model 0"),
        ("/models", json!(0), "its header"),
        ("/solid", json!([]), "it has no operand"),
        ("/solid", json!([{ "teapot": {} }]), "unknown variant `teapot`"),
        ("/solid", json!([{ "fitted": { "model": 1 } }]), "it has no model 1"),
        ("/solid", json!([{ "fitted": { "model": -1 } }]), "its header"),
        ("/solid", json!([{ "mesh": { "mesh": 0 } }]), "it has no mesh 0"),
        ("/solid", json!([{ "ball": { "center": [0, 0, 0] } }]), "missing field `radius`"),
        ("/arrays/models~10~1keys/shape", json!([1_u64 << 62]), "size or place of its array models/0/keys"),
        ("/arrays/models~10~1keys/shape", json!([1_u64 << 40]), "overlap"),
        ("/arrays/models~10~1known/shape", json!([8, 4]), "shape [8, 4]"),
        ("/arrays/models~10~1known/shape", json!([32]), "shape [32]"),
        ("/arrays/models~10~1known/shape", json!([]), "checksum of its array models/0/known"),
        ("/arrays/models~10~1keys/dtype", json!("<i8"), "the type"),
        ("/arrays/models~10~1keys/dtype", json!("<f8"), "type <f8"),
        ("/arrays/models~10~1keys/offset", json!(u64::MAX), "size or place"),
        ("/arrays/models~10~1keys/offset", json!(1_u64 << 62), "cut short"),
        ("/arrays/models~10~1keys/offset", json!(1), "size or place"),
        ("/arrays/models~10~1keys/offset", json!(-64), "its header"),
        ("/arrays/models~10~1keys/crc32", json!(1), "checksum of its array models/0/keys"),
    ];
    for (pointer, value, expected) in cases {
        let mut parts = Parts { is_kept: true, ..Parts::of(&sound_model()) };
        *parts.header.pointer_mut(pointer).expect(pointer) = value.clone();
        let text = refused(&parts.bytes());
        assert!(text.contains(expected), "{pointer} {value}: {text}");
    }
    let sound = Parts::of(&sound_model());
    for array in sound.arrays.keys() {
        let mut parts = sound.clone();
        parts.arrays.remove(array);
        parts.header["arrays"].as_object_mut().unwrap().remove(array);
        let is_optional = ["colors", "intensities", "classes", "polygons"].iter().any(|name| array.ends_with(name));
        if is_optional {
            read(&parts.bytes());
        } else {
            let text = refused(&parts.bytes());
            assert!(text.contains(&format!("no array {array}")) || text.contains("lengths of its lines"), "{text}");
        }
    }
    // JSON has no numbers beyond those of f64.
    let text = serde_json::to_string(&sound.header).unwrap();
    for number in ["1e999", "NaN", "Infinity", "-1e400"] {
        let text = text.replacen("\"noise\":0.01", &format!("\"noise\":{number}"), 1);
        assert!(refused(&wrapped(text.as_bytes(), &[])).contains("its header"), "{number}");
    }
    for text in ["", "{}", "[]", "null", "{\"solid\":[", "\u{1}"] {
        assert!(refused(&wrapped(text.as_bytes(), &[])).contains("its header"));
    }
    let deep = format!("{{\"solid\":{}", "[".repeat(200_000));
    assert!(refused(&wrapped(deep.as_bytes(), &[])).contains("its header"));
    let unknown = format!("{{\"later\":{}1{},\"solid\":[]}}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(refused(&wrapped(unknown.as_bytes(), &[])).contains("no operand"));
}

#[test]
fn bad_trees_are_refused() {
    let ball = json!({ "ball": { "center": [0, 0, 0], "radius": 1 } });
    let complement = |of: usize| json!({ "complement": { "of": of } });
    let deep: Vec<Value> =
        std::iter::once(ball.clone()).chain((0..100_000).map(|i| json!({ "complement": { "of": i } }))).collect();
    let rotation = json!([[1, 0, 0], [0, 1, 0], [0, 0, 2]]);
    let identity = json!([[1, 0, 0], [0, 1, 0], [0, 0, 1]]);
    let cases = [
        (json!([complement(0)]), "a cycle"),
        (json!([complement(1), ball]), "a cycle"),
        (json!([ball, { "union": { "of": [0, usize::MAX] } }]), "a cycle"),
        (json!([ball, { "union": { "of": [0, 0] } }]), "operand 0 is used twice"),
        (json!([ball, complement(0), { "difference": { "of": [1, 0] } }]), "operand 0 is used twice"),
        (json!([ball, ball]), "operand 0 is used by none"),
        (json!([ball, { "difference": { "of": [0] } }]), "its header"),
        (json!(deep), "more than 200 deep"),
        (json!([ball, { "placed": { "of": 0, "rotation": rotation, "scale": 1, "shift": [0, 0, 0] } }]), "operand 1"),
        (json!([ball, { "placed": { "of": 0, "rotation": identity, "scale": 0, "shift": [0, 0, 0] } }]), "operand 1"),
        (json!([{ "ball": { "center": [0, 0, 1e12], "radius": 1 } }]), "number of operand 0"),
        (json!([{ "prism": { "rings": [[[0, 0], [1e12, 0], [0, 1]]], "heights": [0, 1] } }]), "number of operand 0"),
        (
            json!([{ "height_field": { "origin": [0, 0], "step": [1, 1], "count": [2, 2], "heights": 0 } }]),
            "no array heights/0",
        ),
    ];
    for (tree, expected) in cases {
        let text = refused(&wrapped(&serde_json::to_vec(&json!({ "solid": tree })).unwrap(), &[]));
        assert!(text.contains(expected), "{text}");
    }
}

#[test]
fn bad_arrays_are_refused() {
    let (nan, infinite) = (f32::NAN.to_le_bytes(), f64::INFINITY.to_le_bytes());
    let cases: &[(&str, usize, &[u8], &str)] = &[
        ("keys", 0, &1_u64.to_le_bytes(), "do not ascend"),
        ("keys", 0, &5_u64.to_le_bytes(), "do not ascend"),
        ("keys", 24, &8_u64.to_le_bytes(), "outside of its lattice"),
        ("keys", 24, &u64::MAX.to_le_bytes(), "outside of its lattice"),
        ("known", 0, &[0xFF; 8], "one value for each node"),
        ("values", 4, &nan, "value is not finite"),
        ("values", 4, &f32::INFINITY.to_le_bytes(), "value is not finite"),
        ("points", 4, &nan, "number of model 0"),
        ("points", 4, &1e30_f32.to_le_bytes(), "number of model 0"),
        ("planes", 0, &0.5_f64.to_le_bytes(), "a plane"),
        ("planes", 0, &infinite, "a plane"),
        ("planes", 24, &infinite, "number of model 0"),
        ("facets", 24, &infinite, "number of model 0"),
        ("plane_of_facet", 0, &2_u32.to_le_bytes(), "a plane is missing"),
        ("plane_of_facet", 0, &u32::MAX.to_le_bytes(), "a plane is missing"),
        ("plane_of_point", 4, &2_i32.to_le_bytes(), "a plane is missing"),
        ("plane_of_point", 4, &(-2_i32).to_le_bytes(), "plane of a point"),
        ("line_segments", 8, &infinite, "number of model 0"),
        ("line_lengths", 0, &3_u32.to_le_bytes(), "lengths of its lines"),
        ("line_lengths", 0, &u32::MAX.to_le_bytes(), "lengths of its lines"),
        ("polygons", 8, &infinite, "number of model 0"),
    ];
    let sound = Parts::of(&sound_model());
    for &(array, at, bytes, expected) in cases {
        let mut parts = sound.clone();
        parts.patch(&format!("models/0/{array}"), at, bytes);
        let text = refused(&parts.bytes());
        assert!(text.contains(expected), "{array}: {text}");
    }
    // Lists that are too short.
    for (array, row, expected) in [
        ("values", 4, "one value for each node"),
        ("inside", 64, "one set of nodes for each block"),
        ("known", 64, "one set of nodes for each block"),
        ("keys", 8, "one set of nodes for each block"),
        ("colors", 3, "one entry for each point"),
        ("intensities", 4, "one entry for each point"),
        ("classes", 1, "one entry for each point"),
        ("plane_of_point", 4, "one entry for each point"),
        ("points", 12, "one entry for each point"),
        ("plane_of_facet", 4, "differ in number"),
        ("facets", 72, "differ in number"),
    ] {
        let (mut parts, name) = (sound.clone(), format!("models/0/{array}"));
        let own = parts.arrays.get_mut(&name).unwrap();
        own.truncate(own.len() - row);
        let count = parts.header["arrays"][&name]["shape"][0].as_u64().unwrap();
        parts.header["arrays"][&name]["shape"][0] = json!(count - 1);
        let text = refused(&parts.bytes());
        assert!(text.contains(expected), "{array}: {text}");
    }
    let sound = Parts::of(&model_bytes(&model(every_solid())));
    for (array, bytes, expected) in [
        ("meshes/0/vertices", f64::NAN.to_le_bytes().to_vec(), "coordinate of mesh 0"),
        ("meshes/0/triangles", 4_u32.to_le_bytes().to_vec(), "triangle of mesh 0"),
        ("heights/0", infinite.to_vec(), "number of operand"),
    ] {
        let mut parts = sound.clone();
        parts.patch(array, 0, &bytes);
        let text = refused(&parts.bytes());
        assert!(text.contains(expected), "{array}: {text}");
    }
    // Two arrays that are the same bytes.
    let mut parts = Parts { is_kept: true, ..sound };
    parts.header["arrays"]["heights/1"] = parts.header["arrays"]["heights/0"].clone();
    assert!(refused(&parts.bytes()).contains("overlap"));
}

#[test]
fn what_could_not_be_read_is_not_written() {
    let folder = folder();
    let path = folder.path().join("bad.zset");
    let ball = |radius: f64| Solid::Ball { center: WORLD, radius };
    let mut deep = ball(1.0);
    for _ in 0..200 {
        deep = Solid::Complement(Box::new(deep));
    }
    let parts = FittedParts { bounds: [[0.0; 3], [1e15; 3]], ..small_fitted().parts().clone() };
    let far = Fitted::kept(small_fitted().lattice().clone(), parts).unwrap();
    for solid in [
        ball(f64::NAN),
        ball(f64::INFINITY),
        Solid::Offset { of: Box::new(ball(1.0)), distance: f64::NAN },
        Solid::Prism { rings: vec![vec![[0.0, f64::NAN]]], heights: [0.0, 1.0] },
        Solid::Fitted(Arc::new(far)),
        deep,
    ] {
        message(&write_model(&path, &model(solid)).unwrap_err());
        assert!(!path.exists());
    }
}

/// Sound by every rule, and of no use: there is a mesh or an error, but no panic.
#[test]
fn odd_models_make_no_panic() {
    let first = [2.6_f32, 0.5, 2.0];
    let place = first.map(f64::from);
    type Change = fn(&mut LatticeField, &mut FittedParts);
    let changes: [Change; 11] = [
        |_, _| {},
        |_, parts| parts.points.clear(),
        |_, parts| parts.trim = Some(1e-300),
        |_, parts| parts.trim = Some(1e11),
        |_, parts| (parts.scene, parts.trim) = (Scene::Airborne, Some(1e11)),
        |field, _| field.values.fill(0.0),
        |field, _| field.known.fill([0; 8]),
        |_, parts| parts.scene = Scene::Airborne,
        |_, parts| parts.noise = 0.0,
        |_, parts| parts.noise = 1e11,
        |_, parts| parts.min_component = Some(usize::MAX),
    ];
    for change in changes {
        let (mut field, mut parts) = (small_fitted().lattice().clone(), small_fitted().parts().clone());
        change(&mut field, &mut parts);
        let points = parts.points.len();
        parts.points = vec![first; points];
        parts.attributes = Attributes::default();
        parts.lines = vec![vec![], vec![[place; 2]; 2]];
        parts.polygons = vec![[place; 3]];
        let structure = parts.structure.as_mut().unwrap();
        structure.triangles = vec![[place; 3]];
        structure.plane_of_point = vec![Some(0); points];
        structure.planes[1].1 = 1e11;
        let fitted = Fitted::kept(field, parts).unwrap();
        let model = read(&model_bytes(&model(Solid::Fitted(Arc::new(fitted)))));
        let _ = mesh(&model.solid, &MeshParams::default(), &());
        let ball = Solid::Ball { center: [84_812.0, 447_413.0, 2.0], radius: 1.0 };
        let _ = mesh(&Solid::Union(vec![model.solid, ball]), &MeshParams::default(), &());
    }
}

/// Runs the example of the description of the format on some positions, if Python has NumPy.
fn example(path: &Path, positions: &[[f64; 3]]) -> Option<Vec<f64>> {
    let python = std::env::var("ZEROSET_PYTHON").unwrap_or_else(|_| "python3".into());
    let there = Command::new(&python).args(["-c", "import numpy"]).output();
    if !there.is_ok_and(|output| output.status.success()) {
        eprintln!("skipped: {python} has no NumPy; ZEROSET_PYTHON names another");
        return None;
    }
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs/format_example.py");
    let mut command = Command::new(&python);
    let command = command.arg(script).arg(path).stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let text: String = positions.iter().map(|[x, y, z]| format!("{x} {y} {z}\n")).collect();
    child.stdin.take().unwrap().write_all(text.as_bytes()).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8(output.stdout).unwrap();
    Some(text.lines().map(|line| line.parse().unwrap()).collect())
}

#[test]
fn the_example_of_the_format_evaluates_models() {
    let folder = folder();
    for kind in [SceneKind::Torus, SceneKind::AirborneCity] {
        let fitted = fit(kind, Quality::Draft);
        let (cell, parts) = (fitted.cell(), fitted.parts());
        let mut rng = Pcg64Mcg::seed_from_u64(3);
        let near = |rng: &mut Pcg64Mcg| {
            let p = parts.points[rng.random_range(0..parts.points.len())].map(f64::from);
            std::array::from_fn(|a| parts.world_from_local[a] + p[a] + 12.0 * cell * (rng.random::<f64>() - 0.5))
        };
        let mut positions: Vec<[f64; 3]> = (0..1998).map(|_| near(&mut rng)).collect();
        // Far beyond the lattice, where F is as on the nearest face.
        positions.extend([[-1e6; 3], [1e6; 3]]);
        let path = folder.path().join("a.zset");
        let solid = Solid::Fitted(Arc::new(fitted));
        write_model(&path, &model(solid.clone())).unwrap();
        let Some(found) = example(&path, &positions) else { return };
        let expected = solid.field([0.0; 3]).unwrap().values(&positions);
        assert_eq!(found.len(), expected.len());
        let is_stored: Vec<bool> = found.iter().map(|value| !value.is_nan()).collect();
        assert!(is_stored.iter().filter(|&&is| is).count() > 1500);
        for ((found, expected), _) in found.iter().zip(&expected).zip(is_stored).filter(|(_, is)| *is) {
            assert!((found - expected).abs() < 1e-6 * cell, "{kind:?}: {found} {expected}");
        }
    }
}
