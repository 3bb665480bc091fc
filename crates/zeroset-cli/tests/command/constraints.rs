//! `--constraints`: what the user knows reaches the mesh, and what cannot be used is one line.

use std::path::Path;

use crate::common::{folder, line};
use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{WriteOptions, write_cloud};

/// A box far from the origin whose upper edge at y = 0.8 lost its points.
fn chipped(folder: &Path) {
    let mut cloud = Scene::new(SceneKind::Box, 0).points(12_000, 0.001, 1);
    cloud.points.retain(|p| (p[1] - 0.8).hypot(p[2] - 0.6) > 0.12);
    let cloud = Cloud { world_from_local: [84_800.0, 447_400.0, 8.0], crs: Some("EPSG:28992".into()), ..cloud };
    write_cloud(&folder.join("box.las"), &cloud, &WriteOptions::default()).unwrap();
}

const EDGE: &str = "v 84800 447400.8 8.6\nv 84801 447400.8 8.6\nl 1 2\n";

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

#[test]
fn a_line_in_world_coordinates_reaches_the_mesh() {
    let folder = folder();
    chipped(folder.path());
    std::fs::write(folder.path().join("edge.obj"), EDGE).unwrap();
    let faces =
        "v 84800 447400.8 8.6\nv 84801 447400.8 8.6\nv 84801 447400.67 8.6\nv 84800 447400.67 8.6\nf 1 2 3 4\np 1\n";
    std::fs::write(folder.path().join("face.obj"), format!("# crs EPSG:7415\n{faces}")).unwrap();
    let words = "reconstruct box.las -o box.ply --scene object --quality normal --constraints edge.obj --constraints face.obj \
        --report r.json";
    let done = line(folder.path(), words).ok();
    for part in [
        "constraints: the mesh lies",
        "passed over, as neither line nor polygon with an extent: 1",
        "face.obj is in EPSG:7415, the points are in EPSG:28992",
    ] {
        assert!(done.stderr.contains(part), "{} does not say {part}", done.stderr);
    }
    let report = json(&folder.path().join("r.json"));
    assert_eq!(
        (&report["plan"]["constraints"]["lines_used"], &report["plan"]["constraints"]["polygons_used"]),
        (&1.into(), &1.into())
    );
    let cell = report["plan"]["resolution"].as_f64().unwrap();
    let mean = report["constraints"]["mean_distance"].as_f64().unwrap();
    assert!(mean < 0.05 * cell, "{mean} of {cell}");
    assert!(report["constraints"]["on_lines"].as_u64().unwrap() > 10);
    let outlines = format!("{words} --constraint-polygons outlines --dry-run");
    let done = line(folder.path(), &outlines).ok();
    assert!(done.stdout.contains("2 lines, ") && done.stdout.contains("; 0 polygons"), "{}", done.stdout);
}

#[test]
fn features_of_one_run_hold_the_next() {
    let folder = folder();
    chipped(folder.path());
    for suffix in ["json", "obj", "geojson", "dxf"] {
        line(folder.path(), &format!("features box.las --scene object -o f.{suffix}")).ok();
        let words = format!("reconstruct box.las -o box.ply --scene object --constraints f.{suffix} --report r.json");
        line(folder.path(), &words).ok();
        let report = json(&folder.path().join("r.json"));
        let (mean, cell) = (&report["constraints"]["mean_distance"], &report["plan"]["resolution"]);
        assert!(mean.as_f64().unwrap() < 0.5 * cell.as_f64().unwrap(), "{suffix}: {mean} of {cell}");
    }
}

#[test]
fn what_cannot_be_used_is_one_line() {
    let folder = folder();
    chipped(folder.path());
    let refused = |name: &str, text: &str, part: &str| {
        std::fs::write(folder.path().join(name), text).unwrap();
        let said = line(folder.path(), &format!("reconstruct box.las -o box.ply --constraints {name}")).failed(name);
        assert!(said.contains(part), "{said} does not say {part}");
        assert!(!folder.path().join("box.ply").exists());
    };
    refused("far.obj", &EDGE.replace("447400", "10"), "none of its lines and polygons lies in the box of the points");
    refused(
        "flat.geojson",
        r#"{"type":"LineString","coordinates":[[84800,447400],[84801,447400]]}"#,
        "without heights",
    );
    refused("empty.dxf", "", "empty");
    refused("nan.obj", &EDGE.replace("8.6", "nan"), "not finite");
    refused("edge.shp", EDGE, "unknown constraint format");
    let missing = line(folder.path(), "reconstruct box.las -o box.ply --constraints none.obj").failed("none.obj");
    assert!(missing.contains("no such file"), "{missing}");
    std::fs::write(folder.path().join("edge.obj"), EDGE).unwrap();
    let same = line(folder.path(), "reconstruct box.las -o edge.obj --constraints edge.obj").failed("edge.obj");
    assert!(same.contains("an input"), "{same}");
    assert_eq!(line(folder.path(), "reconstruct box.las -o box.ply --constraint-polygons faces").code, Some(2));
}
