//! `features` and `compare --features`: names, options and files, whatever is found.

use std::path::Path;

use crate::common::{CLOUDS, entries, folder, line, with_input, write};
use serde_json::Value;
use zeroset::feature::{Corner, Edge, FeatureKind, Features, Plane};
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{FeatureOutput, WriteOptions, write_features};

/// The box of 1 x 0.8 x 0.6 that `sample` makes, by hand.
fn brick() -> Features {
    let sides = [1.0, 0.8, 0.6];
    let mut found = Features::default();
    for axis in 0..3 {
        for end in [0.0, 1.0] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let mut ring: Vec<[f64; 3]> = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
                .map(|(a, b)| {
                    let mut p = [0.0; 3];
                    (p[axis], p[u], p[v]) = (end * sides[axis], a * sides[u], b * sides[v]);
                    p
                })
                .to_vec();
            let mut normal = [0.0; 3];
            normal[axis] = 2.0 * end - 1.0;
            if end == 0.0 {
                ring.reverse();
            }
            let (area, offset) = (sides[u] * sides[v], end * sides[axis]);
            found.planes.push(Plane { normal, offset, oriented: true, points: 9, rms: None, area, rings: vec![ring] });
        }
        for (a, b) in [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)] {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            let polyline = [0.0, 1.0].map(|t| {
                let mut p = [0.0; 3];
                (p[axis], p[u], p[v]) = (t * sides[axis], a * sides[u], b * sides[v]);
                p
            });
            let (planes, polyline) = (vec![], polyline.to_vec());
            found.edges.push(Edge { kind: FeatureKind::Convex, planes, polyline, angle: 1.5 });
        }
    }
    for i in 0..8 {
        let position = [0, 1, 2].map(|a| f64::from(i >> a & 1) * sides[a]);
        found.corners.push(Corner { kind: FeatureKind::Convex, position, planes: vec![], edges: vec![] });
    }
    found
}

fn save(path: &Path, features: &Features) {
    let (parameters, options) = (Value::Null, WriteOptions::default());
    let output = FeatureOutput { features, cloud: None, parameters: &parameters, options: &options };
    write_features(path, output).expect("sound features can be written");
}

/// A folder with the features of a box, and its truth.
fn with_brick() -> tempfile::TempDir {
    let folder = folder();
    save(&folder.path().join("found.json"), &brick());
    line(folder.path(), "sample box -o points.xyz --points 20000 --noise 0 --truth truth.ply").ok();
    folder
}

fn compared(folder: &Path, words: &str) -> Value {
    let outcome = line(folder, &format!("compare --features {words} --json")).ok();
    serde_json::from_str(&outcome.stdout).expect("JSON")
}

#[test]
fn exact_features_agree_with_the_truth() {
    let folder = with_brick();
    for words in ["found.json truth.ply", "found.json truth.ply --cloud points.xyz"] {
        let report = compared(folder.path(), words);
        for figure in
            ["/planes/all/by_count", "/planes/precision", "/planes/orientation", "/edges/recall", "/edges/kind"]
        {
            assert_eq!(report.pointer(figure), Some(&1.0.into()), "{words} {figure}");
        }
        for figure in ["/edges/precision", "/corners/recall", "/corners/precision", "/corners/kind"] {
            assert_eq!(report.pointer(figure), Some(&1.0.into()), "{words} {figure}");
        }
        assert_eq!((&report["planes"]["walls"]["faces"], &report["corners"]["counted"]), (&4.into(), &8.into()));
        assert_eq!(report["spacing"].is_null(), !words.contains("--cloud"));
    }
    let table = line(folder.path(), "compare --features found.json truth.ply").ok().stdout;
    for part in ["true faces", "walls", "recall by area", "precision", "corners", "angle, degrees", "diagonal"] {
        assert!(table.contains(part), "{part} in {table}");
    }
}

#[test]
fn options_of_the_comparison_reach_it() {
    let folder = with_brick();
    let mut lifted = brick();
    lifted.planes[5].offset += 0.01;
    lifted.planes[5].rings[0].iter_mut().for_each(|p| p[2] += 0.01);
    lifted.corners[0].position[0] -= 0.02;
    lifted.edges[0].polyline.iter_mut().for_each(|p| p[1] -= 0.02);
    save(&folder.path().join("lifted.json"), &lifted);
    let usual = compared(folder.path(), "lifted.json truth.ply");
    assert_eq!((&usual["planes"]["matched"], &usual["corners"]["recall"]), (&5.into(), &0.875.into()));
    assert!(usual["edges"]["recall"].as_f64() < Some(0.95));
    let wide = "--tau 0.02 --edge-tolerance 0.03 --corner-tolerance 0.03";
    let wide = compared(folder.path(), &format!("lifted.json truth.ply {wide}"));
    assert_eq!((&wide["planes"]["matched"], &wide["corners"]["recall"]), (&6.into(), &1.0.into()));
    assert_eq!((&wide["edges"]["recall"], &wide["offset_tolerance"]), (&1.0.into(), &0.02.into()));
    let large = compared(folder.path(), "found.json truth.ply --min-area 0.5 --max-angle 1");
    assert_eq!((&large["planes"]["all"]["faces"], &large["max_angle_deg"]), (&4.into(), &1.0.into()));
    let blunt = compared(folder.path(), "found.json truth.ply --sharp-angle 120");
    assert_eq!((&blunt["edges"]["true_length"], &blunt["edges"]["recall"]), (&0.0.into(), &Value::Null));
    let few = compared(folder.path(), "found.json truth.ply --cloud points.xyz --min-points 5000");
    assert_eq!(few["planes"]["all"]["faces"], 0);
}

#[test]
fn what_cannot_be_compared_is_named() {
    let folder = with_brick();
    let path = |name: &str| folder.path().join(name);
    let sound = std::fs::read_to_string(path("found.json")).unwrap();
    std::fs::write(path("cut.json"), &sound[..500]).unwrap();
    std::fs::write(path("old.json"), sound.replace("\"schema_version\":1", "\"schema_version\":9")).unwrap();
    std::fs::write(path("planar.json"), r#"{"points": [[1, 2]]}"#).unwrap();
    std::fs::write(path("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    std::fs::write(path("dot.xyz"), "1 1 1\n1 1 1\n").unwrap();
    let said = |words: &str, name: &str| line(folder.path(), &format!("compare --features {words}")).failed(name);
    assert!(said("none.json truth.ply", "none.json").contains("no such file"));
    assert!(said("cut.json truth.ply", "cut.json").contains("cut short"));
    assert!(said("old.json truth.ply", "old.json").contains("not supported"));
    assert!(said("planar.json truth.ply", "planar.json").contains("schema_version"));
    assert!(said("found.json none.ply", "none.ply").contains("no such file"));
    assert!(said("found.json flat.obj", "flat.obj").contains("no surface"));
    assert!(said("found.json truth.ply --cloud none.xyz", "none.xyz").contains("no such file"));
    assert!(said("found.json truth.ply --cloud dot.xyz", "dot.xyz").contains("two different places"));
    said("found.dxf truth.ply", "found.dxf");
}

#[test]
fn bad_outputs_are_told_before_any_work() {
    let folder = folder();
    write(&folder.path().join("in.ply"), &Scene::new(SceneKind::Box, 0).points(200, 0.0, 1).points);
    let before = entries(folder.path());
    let said = |words: &str, name: &str| line(folder.path(), &format!("features in.ply {words}")).failed(name);
    assert!(said("-o out.shp", "out.shp").contains("json, geojson, obj, ply, dxf"));
    assert!(said("-o out.json -o out", "out").contains("json, geojson, obj, ply, dxf"));
    assert!(said("-o none/out.json", "none").contains("create it first"));
    assert!(said("-o in.ply", "in.ply").contains("both an input and an output"));
    assert!(said("-o out.json -o ./out.json", "out.json").contains("both an output and an output"));
    assert!(said("-o out.json --report out.json", "out.json").contains("both an output and the report"));
    assert!(said("-o - --report -", "standard output").contains("both an output and the report"));
    assert_eq!(entries(folder.path()), before, "litter");
}

#[test]
fn bad_inputs_are_named() {
    let folder = folder();
    std::fs::create_dir(folder.path().join("folder.ply")).unwrap();
    line(folder.path(), "features none.ply -o out.json").failed("none.ply");
    line(folder.path(), "features folder.ply -o out.json").failed("folder.ply");
    line(folder.path(), "features - - -o out.json").failed("standard input");
    for suffix in CLOUDS {
        std::fs::write(folder.path().join(format!("empty.{suffix}")), "").unwrap();
        line(folder.path(), &format!("features empty.{suffix} -o out.json")).failed(&format!("empty.{suffix}"));
    }
    assert!(!folder.path().join("out.json").exists());
}

#[test]
fn points_are_chosen_as_for_a_mesh() {
    let folder = folder();
    let points = b"0 0 0\n1 0 0\n0 1 0\n5 5 5\n";
    let failed = |words: &str| {
        let outcome = with_input(folder.path(), &format!("features - -o out.json {words}"), points);
        outcome.failed("standard input")
    };
    assert!(failed("--bounds 9,9,10,10").contains("--bounds left out 4 of 4"));
    assert!(failed("--classes 6").contains("leave out --classes"));
}
