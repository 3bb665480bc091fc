//! The main job, from points to a file.

use std::path::Path;

use crate::common::{MESHES, entries, folder, line, torus, with_input, write};
use serde_json::Value;
use zeroset::cloud::{Attributes, Cloud};
use zeroset::mesh::topology;
use zeroset_io::{WriteOptions, read_mesh, write_cloud};

fn json(path: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(path).unwrap()).expect("JSON")
}

fn names(value: &Value) -> Vec<&str> {
    value.as_object().expect("an object").keys().map(String::as_str).collect()
}

#[test]
fn a_sample_piped_in_comes_out_as_a_closed_mesh() {
    let folder = folder();
    let sample = line(folder.path(), "sample torus -o - --points 5000 --truth truth.ply").ok();
    assert_eq!(sample.stdout.lines().count(), 5000);
    assert_eq!(sample.stderr, "");
    let outcome = with_input(folder.path(), "reconstruct - -o torus.ply", sample.stdout.as_bytes()).ok();
    assert_eq!(outcome.stdout, "");
    let said: Vec<&str> = outcome.stderr.lines().collect();
    assert!(said[0].starts_with("scene: object, as ") && said[0].contains("--scene"), "{said:?}");
    assert!(said[1].starts_with("torus.ply: ") && said[1].contains("5,000 points"), "{said:?}");
    let topology = topology(&read_mesh(&folder.path().join("torus.ply")).unwrap()).unwrap();
    assert_eq!((topology.closed, topology.genus, topology.components.len()), (true, Some(1), 1));
    assert!(topology.volume.is_some_and(|v| (v - 0.155).abs() < 0.005), "{:?}", topology.volume);
}

#[test]
fn a_free_scene_says_when_neither_side_is_clearly_outside() {
    let folder = folder();
    for (kind, clear) in [("sphere", true), ("city", false)] {
        line(folder.path(), &format!("sample {kind} -o {kind}.xyz --points 3000")).ok();
        let said = line(folder.path(), &format!("reconstruct {kind}.xyz -o out.ply --scene free")).ok().stderr;
        assert_eq!(!said.contains("neither side is clearly outside"), clear, "{kind}: {said}");
    }
}

#[test]
fn equal_bytes_on_any_number_of_threads() {
    let folder = folder();
    line(folder.path(), "sample airborne-city -o city.las --points 20000").ok();
    line(folder.path(), "sample torus -o torus.xyz --points 5000").ok();
    for (input, suffix) in [("city.las", "ply"), ("torus.xyz", "ply"), ("torus.xyz", "glb"), ("torus.xyz", "obj")] {
        let run = |threads: &str, name: &str| {
            let name = format!("{name}.{suffix}");
            line(folder.path(), &format!("reconstruct {input} -o {name} --threads {threads} -q --memory 2GB")).ok();
            std::fs::read(folder.path().join(name)).unwrap()
        };
        let one = run("1", "a");
        assert!(one == run("2", "b"), "{input} to {suffix} differs on two threads");
        assert!(one == run("2", "c"), "{input} to {suffix} differs from run to run");
        assert!(one == run("5", "d"), "{input} to {suffix} differs on five threads");
    }
}

#[test]
fn a_georeference_survives_to_the_millimetre() {
    for at in [[84_810.3, 447_412.8, 12.5], [2_600_000.123, 1_200_000.456, 431.25]] {
        let folder = folder();
        let cloud = torus(4000, at);
        write_cloud(
            &folder.path().join("in.laz"),
            &cloud,
            &WriteOptions { resolution: Some(1e-3), ..Default::default() },
        )
        .unwrap();
        let mut meshes = Vec::new();
        for suffix in MESHES {
            let words = format!("reconstruct in.laz -o out.{suffix} --scene object --report {suffix}.json");
            let outcome = line(folder.path(), &words).ok();
            let report = json(&folder.path().join(format!("{suffix}.json")));
            let offset: [f64; 3] = serde_json::from_value(report["world_from_local"].clone()).unwrap();
            let mesh = read_mesh(&folder.path().join(format!("out.{suffix}"))).unwrap();
            // A file of STL holds local coordinates only; GLB has the offset inside.
            let add = if suffix == "stl" { offset } else { [0.0; 3] };
            let local = matches!(suffix, "stl" | "glb");
            assert_eq!(report["output"]["local_offset"].is_array(), local, "{suffix}");
            assert_eq!(outcome.stderr.contains("add "), local, "{suffix}: {}", outcome.stderr);
            let world = |p: &[f64; 3]| std::array::from_fn(|a| p[a] + mesh.world_from_local[a] + add[a]);
            meshes.push((suffix, mesh.vertices.iter().map(world).collect::<Vec<[f64; 3]>>()));
        }
        // The middle of the torus, which noise moves by much less than this.
        for (suffix, vertices) in &meshes {
            for axis in 0..3 {
                let (low, high) =
                    vertices.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(v[axis]), h.max(v[axis])));
                assert!((0.5 * (low + high) - at[axis]).abs() < 0.005, "{suffix} axis {axis}: {low} to {high}");
            }
        }
        // Formats that keep the order of vertices agree to the millimetre, vertex by vertex.
        let (_, reference) = &meshes[0];
        for (suffix, vertices) in meshes.iter().filter(|(suffix, _)| *suffix != "stl") {
            let off = reference.iter().zip(vertices).flat_map(|(a, b)| (0..3).map(|i| (a[i] - b[i]).abs()));
            assert_eq!(vertices.len(), reference.len(), "{suffix}");
            assert!(off.fold(0.0, f64::max) < 0.001, "{suffix}");
        }
    }
}

/// The steps of a level after which the gradient in R did not change any more.
fn stretch(level: &Value) -> Vec<&Value> {
    let steps = level["iterations"].as_array().unwrap();
    let last = &steps.last().unwrap()["gradient"];
    steps.iter().filter(|i| i["gradient"] == *last).collect()
}

#[test]
fn the_report_has_its_fields() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(3000, [0.0; 3]).points);
    std::fs::write(folder.path().join("more.xyz"), "nan 0 0\n0.3 0 0.1\n0.31 0 0.1\n").unwrap();
    line(folder.path(), "reconstruct in.xyz more.xyz -o out.stl --report r.json --threads 2 --bounds -1,-1,1,1,-1,1")
        .ok();
    let report = json(&folder.path().join("r.json"));
    assert_eq!(
        names(&report),
        [
            "components",
            "constraints",
            "contour",
            "crs",
            "filters",
            "fit",
            "inputs",
            "memory_limit_bytes",
            "memory_peak_bytes",
            "mesh",
            "notes",
            "output",
            "plan",
            "points",
            "polish",
            "schema_version",
            "seconds",
            "sharp",
            "simplify",
            "structure",
            "threads",
            "unit",
            "unit_metres",
            "world_from_local",
            "zeroset_version"
        ]
    );
    assert_eq!(report["schema_version"], 1);
    assert_eq!(report["zeroset_version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(names(&report["inputs"][0]), ["attributes", "format", "non_finite", "path", "points", "withheld"]);
    assert_eq!(report["inputs"][0]["path"], "in.xyz");
    assert_eq!((&report["inputs"][1]["points"], &report["inputs"][1]["non_finite"]), (&2.into(), &1.into()));
    assert_eq!(report["points"]["used"], 3002);
    assert_eq!(names(&report["points"]["dropped"]), ["by_bounds", "by_class", "isolated", "non_finite", "withheld"]);
    assert_eq!(report["points"]["dropped"]["non_finite"], 1);
    assert_eq!(report["plan"]["scene"], "object");
    assert_eq!(report["threads"], 2);
    let stages = [
        "attributes",
        "contour",
        "fit",
        "plan",
        "polish",
        "read",
        "select",
        "sharpen",
        "simplify",
        "structure",
        "total",
        "write",
    ];
    assert_eq!(names(&report["seconds"]), stages);
    assert!(stages.iter().all(|stage| report["seconds"][stage].as_f64().is_some_and(|s| s >= 0.0)));
    assert_eq!(names(&report["output"]), ["attributes_left_out", "bytes", "format", "local_offset", "path"]);
    assert_eq!(report["output"]["bytes"], std::fs::metadata(folder.path().join("out.stl")).unwrap().len());
    assert!(report["mesh"]["triangles"].as_u64().is_some_and(|n| n > 1000));
    let levels = report["fit"]["levels"].as_array().unwrap();
    assert_eq!(report["plan"]["levels"], levels.len());
    for level in levels {
        let mut r: Vec<f64> = stretch(level).iter().map(|i| i["rayleigh_quotient"].as_f64().unwrap()).collect();
        r.extend(level["rayleigh_quotient"].as_f64());
        // In single precision the last steps at rest may differ in the sixth digit.
        assert!(r.windows(2).all(|w| w[1] <= w[0] * (1.0 + 1e-5)), "{r:?}");
    }
    if cfg!(target_os = "linux") {
        assert!(report["memory_peak_bytes"].as_u64().is_some_and(|b| b > 1_000_000));
    }
}

#[test]
fn the_report_goes_to_standard_output() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    let outcome = line(folder.path(), "reconstruct in.xyz -o out.ply --report - --quiet").ok();
    assert_eq!(outcome.stderr, "");
    let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert_eq!(report["output"]["path"], "out.ply");
}

#[test]
fn a_dry_run_writes_nothing() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    for words in ["", "-o out.ply"] {
        let outcome = line(folder.path(), &format!("reconstruct in.xyz --dry-run {words}")).ok();
        for name in ["points", "box from", "scene", "resolution", "levels", "nodes", "memory", "trim"] {
            assert!(outcome.stdout.lines().any(|l| l.starts_with(name)), "{name} in {}", outcome.stdout);
        }
    }
    let outcome = line(folder.path(), "reconstruct in.xyz --dry-run --report -").ok();
    let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
    assert!(report["mesh"].is_null() && report["plan"]["levels"].as_u64().is_some());
    assert_eq!(entries(folder.path()), ["in.xyz"]);
}

/// A torus with classes 2 and, in every tenth point, 7.
fn classified(folder: &Path) {
    let cloud = torus(4000, [0.0; 3]);
    let classes = (0..4000).map(|i| if i % 10 == 0 { 7 } else { 2 }).collect();
    let cloud = Cloud { attributes: Attributes { classes: Some(classes), ..Attributes::default() }, ..cloud };
    write_cloud(&folder.join("in.las"), &cloud, &WriteOptions::default()).unwrap();
}

#[test]
fn classes_are_chosen() {
    let folder = folder();
    classified(folder.path());
    for (words, used) in [
        ("", 3600),
        ("--exclude none", 4000),
        ("--exclude 2", 400),
        ("--classes 7", 400),
        ("--classes 2,7", 4000),
        ("--classes 2,7 --exclude 7", 3600),
    ] {
        let outcome = line(folder.path(), &format!("reconstruct in.las --dry-run --report - {words}")).ok();
        let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
        assert_eq!(report["points"]["used"], used, "{words}");
        assert_eq!(report["points"]["dropped"]["by_class"], 4000 - used, "{words}");
    }
    let outcome = line(folder.path(), "reconstruct in.las -o out.ply -v --scene object").ok();
    assert!(outcome.stderr.contains("left out 400 by class"), "{}", outcome.stderr);
    assert!(outcome.stderr.contains("3,600 of 4,000 points"), "{}", outcome.stderr);
}

#[test]
fn inputs_without_classes_count_as_never_classified() {
    let folder = folder();
    classified(folder.path());
    write(&folder.path().join("bare.xyz"), &torus(1000, [0.0; 3]).points);
    for (words, used, whole) in [
        ("", 4600, false),
        ("--exclude none", 5000, false),
        ("--exclude 2,7", 1000, false),
        ("--exclude 0,7", 3600, true),
        ("--classes 2", 3600, true),
        ("--classes 0,2", 4600, false),
    ] {
        for inputs in ["in.las bare.xyz", "bare.xyz in.las"] {
            let outcome = line(folder.path(), &format!("reconstruct {inputs} --dry-run --report - {words}")).ok();
            let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
            assert_eq!(report["points"]["used"], used, "{inputs} {words}");
            let said =
                outcome.stderr.contains("bare.xyz has no classes, so") && outcome.stderr.contains("all its 1,000");
            assert_eq!(said, whole, "{inputs} {words}: {}", outcome.stderr);
            let note = report["notes"].as_array().unwrap().iter().any(|n| n.as_str().unwrap().contains("class 0"));
            assert!(note, "{}", report["notes"]);
        }
    }
}

#[test]
fn vertices_near_points_with_values_get_them() {
    let folder = folder();
    // Two tori, two units apart, of which one has colours.
    let (left, right) = (torus(3000, [0.0; 3]), torus(3000, [2.0, 0.0, 0.0]));
    let attributes = Attributes { colors: Some(vec![[10, 20, 30]; 3000]), ..Attributes::default() };
    write_cloud(&folder.path().join("a.ply"), &Cloud { attributes, ..left }, &WriteOptions::default()).unwrap();
    write(&folder.path().join("b.xyz"), &right.points);
    let outcome = line(folder.path(), "reconstruct b.xyz a.ply -o out.ply --scene object").ok();
    assert!(outcome.stderr.contains("note: b.xyz has no colors; its points get white"), "{}", outcome.stderr);
    let mesh = read_mesh(&folder.path().join("out.ply")).unwrap();
    for (vertex, color) in mesh.vertices.iter().zip(mesh.attributes.colors.as_ref().unwrap()) {
        let expected = if vertex[0] < 1.0 { [10, 20, 30] } else { [255; 3] };
        assert_eq!(*color, expected, "{vertex:?}");
    }
}

#[test]
fn an_empty_choice_names_the_option_that_made_it() {
    let folder = folder();
    classified(folder.path());
    for (words, option) in [
        ("--classes 9", "--classes and --exclude left out 4,000 of 4,000"),
        ("--exclude 2,7", "--exclude left out 4,000"),
        ("--bounds 10,10,11,11", "--bounds left out 3,600"),
        ("--bounds -9,-9,-8,-8,0,1", "which lie from -0.5, -0.5, -0.2"),
    ] {
        let said = line(folder.path(), &format!("reconstruct in.las -o out.ply {words}")).failed("in.las");
        assert!(said.contains(option), "{said}");
    }
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    let said = line(folder.path(), "reconstruct in.xyz -o out.ply --classes 2").failed("in.xyz");
    assert!(said.contains("no classes"), "{said}");
    assert!(!folder.path().join("out.ply").exists());
}

#[test]
fn strays_are_dropped_when_asked() {
    let folder = folder();
    let mut points = torus(4000, [0.0; 3]).points;
    points.extend([[5.0, 0.0, 0.0], [0.0, 6.0, 0.0]]);
    write(&folder.path().join("in.xyz"), &points);
    let dropped = |words: &str| {
        let outcome = line(folder.path(), &format!("reconstruct in.xyz --dry-run --report - {words}")).ok();
        serde_json::from_str::<Value>(&outcome.stdout).unwrap()["points"]["dropped"]["isolated"].clone()
    };
    assert_eq!(dropped(""), 0);
    assert_eq!(dropped("--outliers off"), 0);
    assert_eq!(dropped("--outliers 8"), 2);
}

#[test]
fn options_reach_the_plan() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    let plan = |words: &str| {
        let outcome = line(folder.path(), &format!("reconstruct in.xyz --dry-run --report - {words}")).ok();
        serde_json::from_str::<Value>(&outcome.stdout).unwrap()["plan"].clone()
    };
    assert_eq!(plan("--scene terrain")["scene"], "terrain");
    assert_eq!(plan("--scene terrain")["scene_reason"], "asked for");
    assert_eq!(plan("--scene free")["scene"], "free");
    assert_eq!(plan("--up -y")["up"], "minus_y");
    assert_eq!(plan("--resolution 0.1")["resolution"], 0.1);
    let side = plan("--depth 5")["resolution"].as_f64().unwrap() * 32.0;
    assert!((1.15..1.25).contains(&side), "the torus with its padding is {side}");
    assert_eq!(plan("--screening 2.5")["screening"], 2.5);
    assert_eq!(plan("--trim 0.25")["trim"], 0.25);
    assert!(plan("--trim off --scene terrain")["trim"].is_null());
    assert_eq!(plan("--attributes class")["attributes"], "class");
}

#[test]
fn surveyed_formats_are_airborne() {
    let folder = folder();
    let points = torus(2000, [0.0; 3]).points;
    for name in ["a.las", "b.laz", "c.xyz"] {
        write(&folder.path().join(name), &points);
    }
    let scene = |words: &str| {
        let outcome = line(folder.path(), &format!("reconstruct {words} --dry-run --report -")).ok();
        let report: Value = serde_json::from_str(&outcome.stdout).unwrap();
        (report["plan"]["scene"].clone(), outcome.stderr)
    };
    let (found, said) = scene("a.las b.laz");
    assert_eq!(found, "airborne");
    assert!(said.contains("every input is las or laz"), "{said}");
    assert_eq!(scene("a.las c.xyz").0, "object");
    let (found, said) = scene("a.las --scene object");
    assert_eq!((found, said.as_str()), ("object".into(), ""));
}

#[test]
fn memory_is_kept_or_refused() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(20_000, [0.0; 3]).points);
    let plan = |words: &str| {
        let outcome = line(folder.path(), &format!("reconstruct in.xyz --dry-run --report - {words}")).ok();
        (serde_json::from_str::<Value>(&outcome.stdout).unwrap()["plan"].clone(), outcome.stderr)
    };
    let (free, said) = plan("--memory 2GB");
    assert!(free["wanted_resolution"].is_null() && !said.contains("memory"), "{free} {said}");
    let (capped, said) = plan("--memory 10MB");
    assert_eq!(capped["wanted_resolution"], free["resolution"]);
    assert!(capped["resolution"].as_f64() > free["resolution"].as_f64(), "{capped}");
    assert!(said.contains("warning: memory allows") && said.contains("the points bear 0.0"), "{said}");
    let said = line(folder.path(), "reconstruct in.xyz -o out.ply --memory 10MB --resolution 0.01").failed("in.xyz");
    assert!(said.contains("a resolution of 0.01 needs about"), "{said}");
}

#[test]
fn a_late_error_is_one_line() {
    let folder = folder();
    let mut text = String::from("x y z class\n");
    for [x, y, z] in torus(3000, [0.0; 3]).points {
        text += &format!("{x} {y} {z} 2\n");
    }
    std::fs::write(folder.path().join("a.csv"), text).unwrap();
    write(&folder.path().join("b.xyz"), &torus(1000, [0.0; 3]).points);
    // The files differ in what they hold and the scene is chosen, so there is much to say; but nothing is left of the
    // mesh.
    let words = "reconstruct a.csv b.xyz -o out.ply --trim 1e-9";
    let said = line(folder.path(), words).failed("a.csv");
    assert!(said.contains("no surface was found"), "{said}");
    let all = line(folder.path(), &format!("{words} --verbose"));
    assert_eq!(all.code, Some(1));
    assert!(all.stderr.contains("scene: object") && all.stderr.contains("note: b.xyz"), "{}", all.stderr);
}

#[test]
fn small_pieces_of_open_scenes_are_dropped_and_counted() {
    let folder = folder();
    line(folder.path(), "sample city -o city.xyz --points 30000").ok();
    // Balls smaller than a cell, high above the roofs.
    let mut balls = Vec::new();
    for ball in 1..9 {
        for i in 0..40 {
            let (z, angle) = (1.0 - (2.0 * f64::from(i) + 1.0) / 40.0, 2.4 * f64::from(i));
            let (across, radius) = ((1.0 - z * z).sqrt(), 0.004);
            let middle = [f64::from(ball) / 9.0, 0.5, 0.25];
            let direction = [across * angle.cos(), across * angle.sin(), z];
            balls.push(std::array::from_fn(|a| middle[a] + radius * direction[a]));
        }
    }
    write(&folder.path().join("balls.xyz"), &balls);
    let mesh = |words: &str| {
        line(folder.path(), &format!("reconstruct city.xyz balls.xyz -o out.ply --report r.json -q {words}")).ok();
        let mesh = topology(&read_mesh(&folder.path().join("out.ply")).unwrap()).unwrap();
        let report = json(&folder.path().join("r.json"));
        assert_eq!(report["mesh"]["triangles"], mesh.faces);
        (mesh, report["components"].clone())
    };
    let (all, off) = mesh("--scene terrain --min-component off");
    assert!(off["least_triangles"].is_null() && off["dropped"]["components"] == 0, "{off}");
    let small = all.components.iter().filter(|c| c.faces < 100);
    let (pieces, triangles) = small.fold((0, 0), |(n, t), c| (n + 1, t + c.faces));
    assert!(pieces > 0, "the scene has no small piece to drop");
    let (kept, usual) = mesh("--scene terrain");
    assert_eq!(usual["least_triangles"], 100);
    assert_eq!(usual["dropped"], serde_json::json!({ "components": pieces, "triangles": triangles }));
    assert_eq!((kept.components.len(), kept.faces), (all.components.len() - pieces, all.faces - triangles));
    assert!(mesh("--scene object").1["least_triangles"].is_null());
    // Whatever the limit, the largest piece stays.
    let (one, most) = mesh("--scene terrain --min-component 1000000000");
    assert_eq!((one.components.len(), one.faces), (1, all.components[0].faces));
    assert_eq!(most["dropped"]["components"], all.components.len() - 1);
}

#[test]
fn values_are_carried_over() {
    let folder = folder();
    let cloud = torus(3000, [0.0; 3]);
    let n = cloud.len();
    let attributes =
        Attributes { colors: Some(vec![[10, 20, 30]; n]), intensities: Some(vec![77.0; n]), classes: Some(vec![6; n]) };
    write_cloud(&folder.path().join("in.ply"), &Cloud { attributes, ..cloud }, &WriteOptions::default()).unwrap();
    let attributes = |words: &str| {
        line(folder.path(), &format!("reconstruct in.ply -o out.ply --quiet {words}")).ok();
        read_mesh(&folder.path().join("out.ply")).unwrap().attributes
    };
    let present = |a: &Attributes| (a.colors.is_some(), a.intensities.is_some(), a.classes.is_some());
    let rgb = attributes("");
    assert_eq!(present(&rgb), (true, false, false));
    assert!(rgb.colors.unwrap().iter().all(|c| *c == [10, 20, 30]));
    assert_eq!(present(&attributes("--attributes off")), (false, false, false));
    assert_eq!(present(&attributes("--attributes intensity")), (false, true, false));
    assert_eq!(present(&attributes("--attributes class")), (false, false, true));
    write(&folder.path().join("bare.xyz"), &torus(2000, [0.0; 3]).points);
    let outcome = line(folder.path(), "reconstruct bare.xyz -o out.ply --attributes class").ok();
    assert!(outcome.stderr.contains("warning: the points have no classes"), "{}", outcome.stderr);
    let outcome = line(folder.path(), "reconstruct in.ply -o out.stl").ok();
    assert!(outcome.stderr.contains("no place for colors"), "{}", outcome.stderr);
}

#[test]
fn verbose_shows_stages_and_levels_and_quiet_nothing() {
    let folder = folder();
    write(&folder.path().join("in.xyz"), &torus(2000, [0.0; 3]).points);
    let said = line(folder.path(), "reconstruct in.xyz -o out.ply --verbose").ok().stderr;
    for part in ["stage", "read", "contour", "write", "total", "R after", "1 component", "closed"] {
        assert!(said.contains(part), "{part} in {said}");
    }
    let quiet = line(folder.path(), "reconstruct in.xyz -o out.ply --quiet").ok();
    assert_eq!((quiet.stdout, quiet.stderr), (String::new(), String::new()));
}

#[test]
fn a_real_tile_becomes_a_mesh() {
    let Some(tile) = crate::common::shared_data("delft_ahn3.laz") else { return };
    let folder = folder();
    let words = ["reconstruct", tile.to_str().unwrap(), "-o", "out.ply", "--bounds", "84850,447450,84900,447500"];
    let outcome = crate::common::run(folder.path(), words).ok();
    assert!(outcome.stderr.contains("scene: airborne"), "{}", outcome.stderr);
    let mesh = read_mesh(&folder.path().join("out.ply")).unwrap();
    assert_eq!(topology(&mesh).unwrap().nonmanifold_edges, 0);
}
