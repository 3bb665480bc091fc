//! `simplify`, and `reconstruct` with `--triangles` or `--max-error`.

use std::path::Path;

use crate::common::{MESHES, entries, folder, line, torus, write};
use serde_json::Value;
use zeroset::mesh::{Mesh, topology};
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{WriteOptions, read_mesh, write_mesh};

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).unwrap()
}

/// Writes a fine sphere at a place in the world, and gives its number of triangles.
fn sphere(path: &Path, at: [f64; 3]) -> usize {
    let mesh = Mesh { world_from_local: at, ..Scene::new(SceneKind::Sphere, 0).truth };
    write_mesh(path, &mesh, &WriteOptions::default()).unwrap();
    mesh.triangles.len()
}

#[test]
fn every_format_is_read_and_written() {
    let folder = folder();
    for (i, suffix) in MESHES.into_iter().enumerate() {
        sphere(&folder.path().join(format!("in.{suffix}")), [84_810.0, 447_412.0, 0.0]);
        let other = MESHES[(i + 1) % MESHES.len()];
        let said = line(folder.path(), &format!("simplify in.{suffix} -o out.{other} --triangles 500")).ok();
        assert!(said.stderr.contains("500 triangles of 81,920") && said.stdout.is_empty(), "{said:?}");
        let light = read_mesh(&folder.path().join(format!("out.{other}"))).unwrap();
        let found = topology(&light).unwrap();
        assert_eq!((found.faces, found.closed, found.genus), (500, true, Some(0)), "{suffix} to {other}");
        // STL has no place for an offset.
        let is_local = suffix == "stl" || other == "stl";
        assert_eq!(light.world_from_local[1] == 0.0, is_local, "{suffix} to {other}");
    }
}

#[test]
fn the_report_tells_the_error_and_keeps_its_names() {
    let folder = folder();
    let before = sphere(&folder.path().join("in.ply"), [0.0; 3]);
    let words = "simplify in.ply -o out.ply --max-error 0.01 --triangles 100 --threads 1 --report report.json --quiet";
    assert_eq!(line(folder.path(), words).ok().stderr, "");
    let report = json(&folder.path().join("report.json"));
    let names = |value: &Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&report), ["input", "output", "schema_version", "simplify", "zeroset_version"]);
    let done = &report["simplify"];
    assert_eq!(
        names(done),
        [
            "attempts",
            "deviation",
            "max_error",
            "seconds",
            "triangles_after",
            "triangles_before",
            "vertices_after",
            "vertices_before",
            "wanted_triangles"
        ]
    );
    assert_eq!((&done["triangles_before"], &done["max_error"]), (&before.into(), &0.01.into()));
    for way in ["original_to_simplified", "simplified_to_original"] {
        assert!(done["deviation"][way]["max"].as_f64().is_some_and(|max| max > 1e-4 && max <= 0.01), "{way}");
    }
    // The error is reached first.
    assert!(done["triangles_after"].as_u64().is_some_and(|n| n > 100));
}

#[test]
fn whatever_is_wrong_is_one_line_and_the_old_file_stays() {
    let folder = folder();
    sphere(&folder.path().join("sound.ply"), [0.0; 3]);
    let sound = std::fs::read(folder.path().join("sound.ply")).unwrap();
    std::fs::write(folder.path().join("cut.ply"), &sound[..sound.len() / 2]).unwrap();
    std::fs::write(folder.path().join("empty.ply"), "").unwrap();
    std::fs::write(folder.path().join("points.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\n").unwrap();
    std::fs::write(folder.path().join("index.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n").unwrap();
    std::fs::write(folder.path().join("old.ply"), "old").unwrap();
    let before = entries(folder.path());
    for name in ["cut.ply", "empty.ply", "points.obj", "index.off", "missing.ply", "sound.dwg"] {
        line(folder.path(), &format!("simplify {name} -o old.ply --triangles 100")).failed(name);
    }
    for name in ["out.dwg", "no/out.ply", "sound.ply"] {
        line(folder.path(), &format!("simplify sound.ply -o {name} --triangles 100")).failed(name);
    }
    line(folder.path(), "simplify - -o old.ply --triangles 100").failed("standard input");
    line(folder.path(), "simplify sound.ply -o - --triangles 100").failed("standard output");
    line(folder.path(), "simplify sound.ply -o out.ply --report out.ply --triangles 100").failed("out.ply");
    assert_eq!(std::fs::read(folder.path().join("old.ply")).unwrap(), b"old");
    assert_eq!(std::fs::read(folder.path().join("sound.ply")).unwrap(), sound);
    assert_eq!(entries(folder.path()), before);
}

#[test]
fn a_reconstruction_is_simplified_before_it_is_written() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(3000, [0.0; 3]).points);
    let plan = line(folder.path(), "reconstruct in.xyz --dry-run --triangles 1000 --max-error 0.5").ok().stdout;
    assert!(plan.contains("to 1,000 triangles, within 0.5"), "{plan}");
    let words = "reconstruct in.xyz -o out.ply --scene object --triangles 1000 --report report.json";
    let said = line(folder.path(), words).ok().stderr;
    assert!(said.contains("simplified: 1,000 triangles of "), "{said}");
    let report = json(&folder.path().join("report.json"));
    assert_eq!(report["mesh"]["triangles"], 1000);
    assert_eq!(report["simplify"]["triangles_after"], 1000);
    assert_eq!(report["plan"]["simplify"]["triangles"], 1000);
    let found = topology(&read_mesh(&folder.path().join("out.ply")).unwrap()).unwrap();
    assert_eq!((found.faces, found.closed, found.genus), (1000, true, Some(1)));
}
