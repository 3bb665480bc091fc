//! `features` on scenes whose planes, edges and corners are known.

use std::path::Path;

use crate::common::{entries, folder, line, run, torus, with_input, write};
use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{WriteOptions, read_features, write_cloud};

/// A folder with a box of 40,000 points and its truth.
fn with_box() -> tempfile::TempDir {
    let folder = folder();
    line(folder.path(), "sample box -o in.ply --points 40000 --truth truth.ply").ok();
    folder
}

fn json(path: &Path) -> Value {
    serde_json::from_str(&std::fs::read_to_string(path).expect("it was written")).expect("JSON")
}

#[test]
fn a_box_is_found_in_every_format() {
    let folder = with_box();
    let names = ["out.json", "out.geojson", "out.obj", "out.ply", "out.dxf"];
    let outputs = names.map(|name| format!("-o {name}")).join(" ");
    let outcome = line(folder.path(), &format!("features in.ply {outputs} --scene object")).ok();
    assert_eq!(outcome.stdout, "");
    let [said] = outcome.stderr.lines().collect::<Vec<_>>()[..] else { panic!("{}", outcome.stderr) };
    assert!(
        said.starts_with(
            "out.json, out.geojson, out.obj, out.ply, out.dxf: 6 planes, 12 edges, 8 corners from 40,000 points"
        ),
        "{said}"
    );
    assert!(said.ends_with(" s"), "{said}");
    assert!(names.iter().all(|name| folder.path().join(name).metadata().unwrap().len() > 500));
    let found = read_features(&folder.path().join("out.json")).unwrap();
    assert_eq!(found.features.planes.iter().filter(|plane| plane.oriented).count(), 6);
    assert_eq!(found.parameters["scene"], "object");
    let words = "compare --features out.json truth.ply --cloud in.ply --json";
    let report: Value = serde_json::from_str(&line(folder.path(), words).ok().stdout).unwrap();
    for figure in
        ["/planes/all/by_count", "/planes/precision", "/planes/orientation", "/corners/recall", "/corners/precision"]
    {
        assert_eq!(report.pointer(figure), Some(&1.0.into()), "{figure}");
    }
}

#[test]
fn standard_output_takes_json_or_the_report() {
    let folder = with_box();
    let outcome = line(folder.path(), "features in.ply -o - --scene object --quiet").ok();
    assert_eq!(outcome.stderr, "");
    let found: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!((&found["schema_version"], found["planes"].as_array().map(Vec::len)), (&1.into(), Some(6)));
    let outcome = line(folder.path(), "features in.ply -o out.json --scene object --quiet --report -").ok();
    let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!((&report["counts"]["planes"], &report["points"]["used"]), (&6.into(), &40_000.into()));
    line(folder.path(), "sample box -o in.xyz --points 40000").ok();
    let text = std::fs::read(folder.path().join("in.xyz")).unwrap();
    with_input(folder.path(), "features - -o piped.json --scene object", &text).ok();
    assert_eq!(json(&folder.path().join("piped.json"))["planes"].as_array().map(Vec::len), Some(6));
}

#[test]
fn the_report_tells_counts_residuals_and_defaults() {
    let folder = with_box();
    let words = "features in.ply -o out.json -o out.dxf --scene object --report report.json --bounds 0,0,1,1 --verbose";
    let outcome = line(folder.path(), words).ok();
    for part in ["stage", "detect", "smallest plane", "points on planes", "convex", "slope"] {
        assert!(outcome.stderr.contains(part), "{part} in {}", outcome.stderr);
    }
    let report = json(&folder.path().join("report.json"));
    assert_eq!(report["filters"]["bounds"][0], serde_json::json!([0.0, 1.0]));
    assert_eq!((&report["outputs"][1]["path"], &report["outputs"][1]["format"]), (&"out.dxf".into(), &"DXF".into()));
    let detection = &report["detection"];
    for name in
        ["spacing", "noise", "min_area", "max_distance", "max_angle_deg", "plane_area", "plane_rms", "edge_length"]
    {
        assert!(detection[name].as_f64() > Some(0.0), "{name}: {detection}");
    }
    // Radians there and back.
    assert!((detection["sharp_angle_deg"].as_f64().unwrap() - 30.0).abs() < 1e-9);
    assert_eq!(detection["scene"], "object");
    assert!(report["seconds"]["detect"].as_f64() > Some(0.0));
    let own = &json(&folder.path().join("out.json"))["parameters"];
    assert_eq!((&own["min_area"], &own["noise"]), (&detection["min_area"], &detection["noise"]));
}

#[test]
fn typed_limits_are_kept() {
    let folder = with_box();
    // The faces have 0.8, 0.6 and 0.48 square units.
    let words = "features in.ply -o out.json --scene object --report report.json --min-area 0.55 --max-distance 0.01 --max-angle 20";
    line(folder.path(), words).ok();
    assert_eq!(json(&folder.path().join("out.json"))["planes"].as_array().map(Vec::len), Some(4));
    let detection = &json(&folder.path().join("report.json"))["detection"];
    assert_eq!((&detection["min_area"], &detection["max_distance"]), (&0.55.into(), &0.01.into()));
    assert!((detection["max_angle_deg"].as_f64().unwrap() - 20.0).abs() < 1e-9);
}

#[test]
fn the_output_does_not_depend_on_threads() {
    let folder = with_box();
    let names = ["json", "geojson", "obj", "ply", "dxf"];
    for threads in [1, 3] {
        let outputs = names.map(|suffix| format!("-o {threads}.{suffix}")).join(" ");
        line(folder.path(), &format!("features in.ply {outputs} --scene object --threads {threads}")).ok();
    }
    let read = |name: String| std::fs::read(folder.path().join(name)).unwrap();
    for suffix in names {
        assert!(read(format!("1.{suffix}")) == read(format!("3.{suffix}")), "{suffix}");
    }
}

#[test]
fn the_reference_system_and_world_coordinates_pass_through() {
    let folder = folder();
    let local = Scene::new(SceneKind::Box, 0).points(40_000, 0.001, 1).points;
    let world = local.iter().map(|p| [p[0] + 84_810.0, p[1] + 447_412.0, p[2]]).collect();
    let cloud = Cloud { crs: Some("EPSG:28992".to_owned()), ..Cloud::from_world(world) };
    write_cloud(&folder.path().join("in.ply"), &cloud, &WriteOptions::default()).unwrap();
    line(folder.path(), "features in.ply -o out.json -o out.geojson --scene object").ok();
    let found = json(&folder.path().join("out.json"));
    let corners = found["corners"].as_array().unwrap();
    assert!(!corners.is_empty());
    for corner in corners {
        let x = corner["position"][0].as_f64().unwrap();
        assert!((84_809.9..84_811.1).contains(&x), "{corner}");
    }
    assert_eq!(found["crs"], "EPSG:28992");
    let map = json(&folder.path().join("out.geojson"));
    assert_eq!(map["crs"]["properties"]["name"], "urn:ogc:def:crs:EPSG::28992");
}

#[test]
fn a_torus_has_no_planes_and_that_is_no_error() {
    let folder = folder();
    write(&folder.path().join("in.ply"), &torus(30_000, [0.0; 3]).points);
    let outcome = run(folder.path(), ["features", "in.ply", "-o", "out.json", "--scene", "object"]).ok();
    assert!(outcome.stderr.contains(" 0 planes"), "{}", outcome.stderr);
    assert_eq!(json(&folder.path().join("out.json"))["planes"], Value::Array(vec![]));
}

#[test]
fn points_that_bear_no_surface_are_named() {
    let folder = folder();
    std::fs::write(folder.path().join("dot.xyz"), "1 1 1\n".repeat(100)).unwrap();
    std::fs::write(folder.path().join("few.xyz"), "0 0 0\n1 0 0\n0 1 0\n").unwrap();
    let before = entries(folder.path());
    line(folder.path(), "features dot.xyz -o out.json").failed("dot.xyz");
    line(folder.path(), "features few.xyz -o out.json").failed("few.xyz");
    assert_eq!(entries(folder.path()), before);
}
