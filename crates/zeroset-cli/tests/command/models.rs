//! `fit`, `mesh`, `edit`, `eval`, `volume`, `slice` and `raster`.

use std::f64::consts::PI;
use std::path::Path;

use crate::common::{entries, folder, line, run, torus, write};
use serde_json::Value;
use zeroset::mesh::{Topology, topology};
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::read_mesh;

const AT: [f64; 3] = [84_810.0, 447_412.0, 3.0];

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

fn examined(path: &Path) -> Topology {
    topology(&read_mesh(path).unwrap()).unwrap()
}

/// A torus far from the origin, fitted.
fn fitted(folder: &Path) {
    write(&folder.join("torus.ply"), &world(&torus(20_000, AT)));
    let said = line(folder, "fit torus.ply -o torus.zset --resolution 0.02 --report fit.json").ok();
    assert!(said.stdout.is_empty() && said.stderr.contains("20,000 points"), "{said:?}");
}

fn world(cloud: &zeroset::cloud::Cloud) -> Vec<[f64; 3]> {
    (0..cloud.len()).map(|i| cloud.world(i)).collect()
}

/// A ball fitted to points, radius and centre known from its truth.
fn ball(folder: &Path) -> f64 {
    let scene = Scene::new(SceneKind::Sphere, 1);
    write(&folder.join("ball.ply"), &world(&scene.points(30_000, 0.0005, 1)));
    line(folder, "fit ball.ply -o ball.zset --resolution 0.02").ok();
    topology(&scene.truth).unwrap().volume.unwrap()
}

#[test]
fn a_model_becomes_the_mesh_of_a_reconstruction() {
    let folder = folder();
    fitted(folder.path());
    line(folder.path(), "mesh torus.zset -o kept.ply --report mesh.json").ok();
    line(folder.path(), "reconstruct torus.ply -o direct.ply --resolution 0.02").ok();
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("kept.ply"), read("direct.ply"));
    assert_eq!(json(&folder.path().join("fit.json"))["plan"]["resolution"], 0.02);
    assert!(json(&folder.path().join("mesh.json"))["mesh"]["triangles"].as_u64().unwrap() > 1000);
    // The same again, on one thread.
    line(folder.path(), "fit torus.ply -o again.zset --resolution 0.02 --threads 1").ok();
    assert_eq!(read("torus.zset"), read("again.zset"));
}

#[test]
fn a_part_of_shapes_alone_is_exact() {
    let folder = folder();
    let part = "subtract(box(0,0,0; 4,2,1); cylinder(2,1,-1; 2,1,2; 0.5)) rotate(z, 30deg) at(84810,447412,2)";
    run(folder.path(), ["mesh", part, "-o", "part.ply", "--cell", "0.05"]).ok();
    let found = examined(&folder.path().join("part.ply"));
    let exact = 8.0 - 0.25 * PI;
    assert_eq!((found.closed, found.genus), (true, Some(1)));
    assert!((found.volume.unwrap() / exact - 1.0).abs() < 0.001);
    std::fs::write(
        folder.path().join("part.toml"),
        "[solid]\nop = \"subtract\"\nof = [{ expr = \"box(0,0,0; 4,2,1)\" }, { expr = \"cylinder(2,1,-1; 2,1,2; 0.5)\" }]\n",
    )
    .unwrap();
    let said = line(folder.path(), "volume part.toml").ok();
    let volume: f64 = said.stdout.split_whitespace().nth(1).unwrap().parse().unwrap();
    assert!((volume / exact - 1.0).abs() < 0.001, "{said:?}");
}

#[test]
fn chains_of_edits_keep_models_and_make_meshes() {
    let folder = folder();
    fitted(folder.path());
    let cut = format!("halfspace({},{},{}; 0,0,1)", AT[0], AT[1], AT[2] + 0.15);
    let block = format!("box({},{},{}; {},{},{})", AT[0], AT[1], AT[2], AT[0] + 1.0, AT[1] + 1.0, AT[2] + 0.1);
    let words = ["edit", "torus.zset", "intersect", &cut, "union", &block, "-o", "edited.zset", "--report", "-"];
    let said = run(folder.path(), words).ok();
    assert!(serde_json::from_str::<Value>(&said.stdout).unwrap()["output"]["bytes"].as_u64().unwrap() > 10_000);
    run(folder.path(), ["edit", "torus.zset", "intersect", &cut, "union", &block, "-o", "edited.ply"]).ok();
    line(folder.path(), "mesh edited.zset -o kept.ply").ok();
    let read = |name: &str| std::fs::read(folder.path().join(name)).unwrap();
    assert_eq!(read("kept.ply"), read("edited.ply"));
    assert!(examined(&folder.path().join("edited.ply")).closed);
    // An edit of an edit, and of a mesh.
    line(folder.path(), "edit edited.zset subtract kept.ply -o nothing.zset").ok();
    let said = line(folder.path(), "info edited.zset").ok();
    assert!(said.stdout.contains("torus.ply") && said.stdout.contains("union"), "{}", said.stdout);
}

#[test]
fn points_get_values_gradients_and_sides() {
    let folder = folder();
    let exact = "sphere(84810,447412,3; 2)";
    let points = "84810 447412 3\n84813 447412 3\n84810 447412 6.5\n";
    let said = with_input_words(folder.path(), &["eval", exact, "--points", "-", "-o", "-"], points);
    let rows: Vec<Vec<f64>> =
        said.lines().skip(1).map(|line| line.split(',').map(|word| word.parse().unwrap()).collect()).collect();
    let values: Vec<f64> = rows.iter().map(|row| row[3]).collect();
    assert_eq!(values, [-2.0, 1.0, 1.5]);
    assert_eq!(rows[1][4..8], [1.0, 0.0, 0.0, 0.0]);
    assert_eq!(rows[0][7], 1.0);

    fitted(folder.path());
    line(folder.path(), "eval torus.zset --points torus.ply -o values.npy --report eval.json").ok();
    assert_eq!(json(&folder.path().join("eval.json"))["points"], 20_000);
    line(folder.path(), "eval torus.zset --points torus.ply -o values.csv").ok();
    let text = std::fs::read_to_string(folder.path().join("values.csv")).unwrap();
    let worst = text.lines().skip(1).map(|line| line.split(',').nth(3).unwrap().parse::<f64>().unwrap().abs());
    assert!(worst.fold(0.0, f64::max) < 0.02);
}

fn with_input_words(folder: &Path, words: &[&str], input: &str) -> String {
    use std::io::Write;
    use std::process::Stdio;
    let mut command = crate::common::zeroset(folder);
    command.args(words).stdin(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    let out = child.wait_with_output().unwrap();
    assert!(out.status.success());
    String::from_utf8(out.stdout).unwrap()
}

#[test]
fn volumes_of_fits_are_near_the_truth() {
    let folder = folder();
    let exact = ball(folder.path());
    let said = line(folder.path(), "volume ball.zset --report volume.json").ok();
    assert!(said.stdout.starts_with("volume"), "{said:?}");
    let found = &json(&folder.path().join("volume.json"))["volume"];
    let [volume, error] = ["volume", "error"].map(|name| found[name].as_f64().unwrap());
    assert!((volume / exact - 1.0).abs() < 0.005, "{volume} {exact}");
    assert!(error < 0.001 * exact);

    // A city stands on its ground: what lies above a level plane under it.
    let scene = Scene::new(SceneKind::City, 2);
    write(&folder.path().join("city.ply"), &world(&scene.points(60_000, 0.001, 2)));
    line(folder.path(), "fit city.ply -o city.zset --scene terrain --resolution 0.006").ok();
    let truth = Scene::new(SceneKind::City, 2).truth;
    let low = truth.vertices.iter().fold([f64::INFINITY; 3], |low, v| std::array::from_fn(|a| low[a].min(v[a])));
    let under = low[2] - 0.1;
    // The prisms between the triangles, seen from above, and the plane.
    let exact: f64 = truth
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|v| truth.vertices[v as usize]);
            let area = 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
            area * ((a[2] + b[2] + c[2]) / 3.0 - under)
        })
        .sum();
    let said = line(folder.path(), &format!("volume city.zset --bounds 0,0,1,1 --above {under} --report -")).ok();
    let found: Value = serde_json::from_str(&said.stdout).unwrap();
    let volume = found["volume"]["volume"].as_f64().unwrap();
    assert!((volume / exact - 1.0).abs() < 0.005, "{volume} {exact}");

    let open = line(folder.path(), "volume city.zset");
    assert!(open.stderr.contains("--above"), "{open:?}");
}

#[test]
fn what_is_cut_and_filled_is_told() {
    let folder = folder();
    let before = "box(0,0,0; 10,10,1)";
    let after = "subtract(union(box(0,0,0; 10,10,1); box(2,2,1; 4,4,3)); cylinder(7,7,0.5; 7,7,2; 1))";
    let said = run(folder.path(), ["volume", before, after, "--step", "0.01", "--report", "-"]).ok();
    let found: Value = serde_json::from_str(&said.stdout).unwrap();
    let of = |name: &str| found["change"][name]["volume"].as_f64().unwrap();
    assert!((of("fill") - 8.0).abs() < 0.08, "{found}");
    assert!((of("cut") - 0.5 * PI).abs() < 0.016, "{found}");
    assert!((of("net") - (of("fill") - of("cut"))).abs() < 1e-9);
}

#[test]
fn slices_of_closed_solids_are_closed() {
    let folder = folder();
    fitted(folder.path());
    let middle: Vec<f64> = read_mesh_middle(folder.path());
    let height = middle[2].to_string();
    for (plane, suffix) in
        [(height.clone(), "svg"), (format!("{},{},{}; 1,0.3,0", middle[0], middle[1], height), "dxf")]
    {
        let out = format!("cut.{suffix}");
        let words = ["slice", "torus.zset", "--plane", &plane, "-o", &out, "--report", "slice.json"];
        run(folder.path(), words).ok();
        let found = json(&folder.path().join("slice.json"));
        assert_eq!((found["curves"].as_u64(), found["closed"].as_u64()), (Some(2), Some(2)), "{plane}");
    }
    line(folder.path(), "slice torus.zset --every 0.05 -o contours.geojson --report slice.json").ok();
    let found = json(&folder.path().join("slice.json"));
    assert!(found["planes"].as_u64().unwrap() >= 4 && found["curves"] == found["closed"], "{found}");
    let contours = json(&folder.path().join("contours.geojson"));
    for line in contours["features"].as_array().unwrap() {
        let height = line["properties"]["height"].as_f64().unwrap();
        assert!((height / 0.05 - (height / 0.05).round()).abs() < 1e-6);
        let positions = line["geometry"]["coordinates"].as_array().unwrap();
        assert!(positions.iter().all(|p| (p[2].as_f64().unwrap() - height).abs() < 1e-6));
        assert!((positions[0][0].as_f64().unwrap() - AT[0]).abs() < 2.0);
    }
    let missed = line(folder.path(), "slice torus.zset --plane 999 -o none.svg");
    assert_eq!(missed.code, Some(1));
    assert!(missed.stderr.contains("torus.zset") && !folder.path().join("none.svg").exists());
}

fn read_mesh_middle(folder: &Path) -> Vec<f64> {
    line(folder, "mesh torus.zset -o middle.ply").ok();
    let mesh = read_mesh(&folder.join("middle.ply")).unwrap();
    let n = mesh.vertices.len() as f64;
    (0..3).map(|a| mesh.vertices.iter().map(|v| v[a]).sum::<f64>() / n + mesh.world_from_local[a]).collect()
}

#[test]
fn rasters_hold_heights() {
    let folder = folder();
    let solid = "union(box(84810,447412,0; 84820,447420,2); box(84812,447414,1; 84814,447416,5))";
    run(folder.path(), ["raster", solid, "-o", "dsm.tif", "--cell", "0.5", "--report", "raster.json"]).ok();
    let found = json(&folder.path().join("raster.json"));
    assert_eq!(found["size"], serde_json::json!([20, 16]));
    assert_eq!(found["with_height"], 320);
    assert!(std::fs::metadata(folder.path().join("dsm.tif")).unwrap().len() > 100);
}

#[test]
fn what_is_wrong_is_told_in_a_line() {
    let folder = folder();
    std::fs::write(folder.path().join("bad.zset"), b"nothing").unwrap();
    write(&folder.path().join("points.ply"), &torus(100, [0.0; 3]).points);
    let bad: [(&[&str], &str); 12] = [
        (&["mesh", "bad.zset", "-o", "a.ply"], "bad.zset"),
        (&["mesh", "missing.zset", "-o", "a.ply"], "missing.zset"),
        (&["mesh", "box(0,0;1,1,1)", "-o", "a.ply"], "character 8"),
        (&["mesh", "halfspace(0,0,0;0,0,1)", "-o", "a.ply"], "--bounds"),
        (&["mesh", "intersect(sphere(0,0,0;1); sphere(9,9,9;1))", "-o", "a.ply"], "no surface"),
        (&["mesh", "sphere(0,0,0;1)", "-o", "a.ply", "--cell", "1e-9"], "--cell"),
        (&["mesh", "sphere(0,0,0;1)", "-o", "a.txt"], "a.txt"),
        (&["volume", "halfspace(0,0,0;0,0,1)"], "--bounds"),
        (&["edit", "sphere(0,0,0;1)", "union", "missing.ply", "-o", "a.zset"], "missing.ply"),
        (&["slice", "sphere(0,0,0;1)", "--plane", "0", "-o", "a.png"], "a.png"),
        (&["raster", "sphere(0,0,0;1)", "-o", "a.png"], "a.png"),
        (&["fit", "points.ply", "-o", "a.ply"], "zset"),
    ];
    for (words, told) in bad {
        let said = run(folder.path(), words);
        assert_eq!(said.code, Some(1), "{words:?} {said:?}");
        assert_eq!((said.stdout.as_str(), said.stderr.lines().count()), ("", 1), "{words:?} {said:?}");
        assert!(said.stderr.starts_with("error: ") && said.stderr.contains(told), "{words:?} {}", said.stderr);
    }
    let usage = run(folder.path(), ["edit", "sphere(0,0,0;1)", "glue", "sphere(0,0,0;1)", "-o", "a.zset"]);
    assert_eq!(usage.code, Some(2), "{usage:?}");
    let usage = run(folder.path(), ["edit", "a", "union", "b", "subtract", "-o", "a.zset"]);
    assert_eq!(usage.code, Some(2), "{usage:?}");
    // Nothing is replaced by what is read.
    let said = run(folder.path(), ["mesh", "points.ply", "-o", "points.ply"]);
    assert_eq!(said.code, Some(1), "{said:?}");
    assert_eq!(entries(folder.path()), ["bad.zset", "points.ply"]);
}
