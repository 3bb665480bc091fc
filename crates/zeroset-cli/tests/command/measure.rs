//! `sample`, `compare` and `info`.

use crate::common::{CLOUDS, MESHES, folder, line, shared_data, torus, with_input, write};
use serde_json::Value;
use zeroset_io::{WriteOptions, write_mesh};

#[test]
fn samples_are_the_same_for_the_same_seed() {
    let folder = folder();
    let sample = |words: &str| line(folder.path(), &format!("sample {words} -o - --points 300")).ok().stdout;
    assert_eq!(sample("city --seed 3"), sample("city --seed 3"));
    assert_ne!(sample("city --seed 3"), sample("city --seed 4"));
    assert_ne!(sample("box"), sample("box --noise 0.01"));
    let bare = sample("box --noise 0");
    for point in bare.lines() {
        let p: Vec<f64> = point.split(' ').map(|c| c.parse().unwrap()).collect();
        let on_face = p
            .iter()
            .zip([1.0, 0.8, 0.6])
            .any(|(c, side)| (c.abs() - 0.5 * side).abs() < 1e-4 || c.abs() < 1e-4 || (c - side).abs() < 1e-4);
        assert!(on_face, "{point}");
    }
}

#[test]
fn every_kind_has_points_and_a_truth() {
    let folder = folder();
    for kind in ["city", "airborne-city", "sphere", "torus", "box", "l-block", "stairs", "pocket-plate"] {
        line(folder.path(), &format!("sample {kind} -o {kind}.xyz --points 500 --truth {kind}.ply")).ok();
        let info: Value =
            serde_json::from_str(&line(folder.path(), &format!("info {kind}.xyz --json")).ok().stdout).unwrap();
        assert_eq!((&info["kind"], &info["points"]), (&"cloud".into(), &500.into()), "{kind}");
        let info: Value =
            serde_json::from_str(&line(folder.path(), &format!("info {kind}.ply --json")).ok().stdout).unwrap();
        assert_eq!(info["topology"]["closed"], !kind.ends_with("city"), "{kind}");
    }
}

#[test]
fn a_mesh_agrees_with_itself() {
    let folder = folder();
    line(folder.path(), "sample l-block -o c.xyz --points 10 --truth truth.ply").ok();
    let outcome = line(folder.path(), "compare truth.ply truth.ply --samples 2000 --tau 0.01 --json").ok();
    let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(report["tau"], 0.01);
    assert_eq!(report["overall"]["f_score"], 1.0);
    assert_eq!(report["overall"]["mesh_samples"], 2000);
    assert!(report["near_edges"].is_object());
    assert_eq!(report["mesh_self_intersections"]["pairs"], 0);
    let table =
        line(folder.path(), "compare truth.ply truth.ply --samples 2000 --sharp-angle 100 --seed 1").ok().stdout;
    for part in ["mesh to truth", "F-score", "right orientation", "genus", "volume", "self-intersections", "tau "] {
        assert!(table.contains(part), "{part} in {table}");
    }
    assert!(!table.contains("creases"), "no edge of the block turns by 100 degrees: {table}");
}

#[test]
fn a_shifted_box_is_as_far_as_it_was_shifted() {
    let folder = folder();
    let truth = zeroset::sample::Scene::new(zeroset::sample::SceneKind::Box, 0).truth;
    let mut shifted = truth.clone();
    shifted.vertices.iter_mut().for_each(|v| v[2] += 0.01);
    for (name, mesh) in [("truth.off", &truth), ("mesh.off", &shifted)] {
        write_mesh(&folder.path().join(name), mesh, &WriteOptions::default()).unwrap();
    }
    let outcome = line(folder.path(), "compare mesh.off truth.off --samples 5000 --json").ok();
    let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
    let max = report["overall"]["distances"]["combined"]["max"].as_f64().unwrap();
    assert!((max - 0.01).abs() < 1e-6, "{max}");
}

#[test]
fn info_tells_clouds_of_all_formats() {
    let folder = folder();
    let at = [84_810.3, 447_412.8, 1.0];
    let points: Vec<[f64; 3]> =
        torus(500, [0.0; 3]).points.iter().map(|p| std::array::from_fn(|a| p[a] + at[a])).collect();
    for suffix in CLOUDS {
        write(&folder.path().join(format!("c.{suffix}")), &points);
        let text = line(folder.path(), &format!("info c.{suffix}")).ok().stdout;
        assert!(text.contains("a cloud"), "{text}");
        let info: Value =
            serde_json::from_str(&line(folder.path(), &format!("info c.{suffix} --json")).ok().stdout).unwrap();
        assert_eq!((&info["kind"], &info["points"]), (&"cloud".into(), &500.into()), "{suffix}");
        let middle = |a: usize| 0.5 * (info["bounds"][0][a].as_f64().unwrap() + info["bounds"][1][a].as_f64().unwrap());
        assert!((middle(0) - at[0]).abs() < 0.02 && (middle(1) - at[1]).abs() < 0.02, "{suffix}: {}", info["bounds"]);
        assert!(info["spacing"]["median"].as_f64().is_some_and(|s| s > 0.01 && s < 0.2), "{suffix}");
    }
}

#[test]
fn info_tells_clouds_from_meshes() {
    let folder = folder();
    let mesh = zeroset::sample::Scene::new(zeroset::sample::SceneKind::Box, 0).truth;
    for suffix in MESHES {
        write_mesh(&folder.path().join(format!("m.{suffix}")), &mesh, &WriteOptions::default()).unwrap();
        let text = line(folder.path(), &format!("info m.{suffix}")).ok().stdout;
        assert!(text.contains("a mesh") && text.contains("closed"), "{suffix}: {text}");
    }
    std::fs::write(folder.path().join("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    let outcome = line(folder.path(), "info m.ply points.obj --json").ok();
    let kinds: Vec<Value> =
        outcome.stdout.lines().map(|l| serde_json::from_str::<Value>(l).unwrap()["kind"].clone()).collect();
    assert_eq!(kinds, ["mesh", "cloud"]);
    let text = with_input(folder.path(), "info -", b"1 2 3\n1 2 4\n").ok().stdout;
    assert!(text.contains("standard input"), "{text}");
}

#[test]
fn info_names_classes() {
    let Some(tile) = shared_data("delft_ahn3.laz") else { return };
    let folder = folder();
    let text = crate::common::run(folder.path(), ["info".as_ref(), tile.as_os_str()]).ok().stdout;
    for part in ["848,942", "84808.3", "2 ground", "6 building", "283,118"] {
        assert!(text.contains(part), "{part} in {text}");
    }
}
