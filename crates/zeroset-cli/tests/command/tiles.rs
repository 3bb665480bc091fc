//! Tiles in a folder.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::mesh::{CompareParams, Mesh, compare, topology};
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{Globe, WriteOptions, read_mesh, read_model, write_cloud};

use crate::common::{folder, line};

/// A city around the origin in two files, so that four tiles meet in its midst.
fn city(place: &Path) {
    line(place, "sample airborne-city -o city.xyz --points 24000").ok();
    let text = std::fs::read_to_string(place.join("city.xyz")).unwrap();
    let moved = |line: &str| {
        let c: Vec<f64> = line.split(' ').map(|c| c.parse().unwrap()).collect();
        format!("{} {} {}\n", c[0] - 0.45, c[1] - 0.45, c[2])
    };
    let lines: Vec<String> = text.lines().map(moved).collect();
    std::fs::write(place.join("a.xyz"), lines[..10_000].concat()).unwrap();
    std::fs::write(place.join("b.xyz"), lines[10_000..].concat()).unwrap();
}

const RUN: &str = "reconstruct a.xyz b.xyz --tile 1.1 --resolution 0.008 --quality draft --scene airborne -q";

/// All files below a folder, by their names.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut all = BTreeMap::new();
    let mut open = vec![folder.to_path_buf()];
    while let Some(place) = open.pop() {
        for entry in std::fs::read_dir(place).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else {
                let name = path.strip_prefix(folder).unwrap().to_string_lossy().into_owned();
                all.insert(name, std::fs::read(&path).unwrap());
            }
        }
    }
    all
}

/// The mesh of a GLB as its numbers say: positions about the translation of its node, without the turn that puts y up.
fn as_stored(glb: &[u8]) -> Mesh {
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap());
    let length = word(12) as usize;
    let json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let view = |accessor: &Value| -> &[u8] {
        let view = &json["bufferViews"]
            [json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap() as usize];
        let at = 28 + length + view["byteOffset"].as_u64().unwrap() as usize;
        &glb[at..at + view["byteLength"].as_u64().unwrap() as usize]
    };
    let primitive = &json["meshes"][0]["primitives"][0];
    let position = |c: &[u8]| -> [f64; 3] {
        std::array::from_fn(|a| f64::from(f32::from_le_bytes(c[4 * a..4 * a + 4].try_into().unwrap())))
    };
    let corners =
        |c: &[u8]| -> [u32; 3] { std::array::from_fn(|a| u32::from_le_bytes(c[4 * a..4 * a + 4].try_into().unwrap())) };
    Mesh {
        vertices: view(&primitive["attributes"]["POSITION"]).chunks_exact(12).map(position).collect(),
        triangles: view(&primitive["indices"]).chunks_exact(12).map(corners).collect(),
        world_from_local: std::array::from_fn(|a| json["nodes"][1]["translation"][a].as_f64().unwrap()),
        ..Mesh::default()
    }
}

#[test]
fn tiles_meet_bit_for_bit_and_their_lists_tell_of_them() {
    let folder = folder();
    city(folder.path());
    line(folder.path(), &format!("{RUN} -o out/ --jobs 2")).ok();
    let made = files(&folder.path().join("out"));
    let names: Vec<&str> = made.keys().map(String::as_str).collect();
    let tiles = ["tiles/-1_-1.glb", "tiles/-1_0.glb", "tiles/0_-1.glb", "tiles/0_0.glb"];
    let lists = ["levels/1/-1_-1.glb", "plan.json", "run.json", "sorted.json"];
    assert_eq!(names, [&["done.json"], &lists[..], &["tiles.json"], &tiles[..], &["tileset.json"]].concat());
    let tileset: Value = serde_json::from_slice(&made["tileset.json"]).unwrap();
    let root = &tileset["root"];
    assert_eq!((tileset["asset"]["version"].as_str(), root["refine"].as_str()), (Some("1.1"), Some("REPLACE")));
    assert_eq!((root["content"]["uri"].as_str(), root["children"].as_array().unwrap().len()), (Some(lists[0]), 4));
    let count = |name: &str| as_stored(&made[name]).triangles.len();
    assert!(count(lists[0]) < tiles.iter().map(|name| count(name)).sum::<usize>() / 10);
    assert!((0.001..0.06).contains(&root["geometricError"].as_f64().unwrap()));
    let outlines: Value = serde_json::from_slice(&made["tiles.json"]).unwrap();
    let points: u64 =
        outlines["features"].as_array().unwrap().iter().map(|f| f["properties"]["points"].as_u64().unwrap()).sum();
    assert_eq!(points, 24_000);

    // Vertices of rims beside a face, in world coordinates: those of one side are those of the other.
    let rim = |name: &str, axis: usize| -> BTreeSet<[u64; 3]> {
        let mesh = as_stored(&made[name]);
        let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
        for t in &mesh.triangles {
            for i in 0..3 {
                let (a, b) = (t[i], t[(i + 1) % 3]);
                *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
            }
        }
        let ends = sides.into_iter().filter(|(_, count)| *count == 1).flat_map(|(ends, _)| ends);
        let world = ends
            .map(|v| -> [f64; 3] { std::array::from_fn(|a| mesh.vertices[v as usize][a] + mesh.world_from_local[a]) });
        // Not beside the corner, where other tiles come in.
        let near = world.filter(|p| p[axis].abs() < 0.016 && p[1 - axis].abs() > 0.05 && p[1 - axis].abs() < 0.4);
        near.map(|p| p.map(|c| (c + 0.0).to_bits())).collect()
    };
    for (one, other, axis) in [(0, 2, 0), (1, 3, 0), (0, 1, 1), (2, 3, 1)] {
        let (one, other) = (rim(tiles[one], axis), rim(tiles[other], axis));
        assert!(one.len() > 50, "{}", one.len());
        assert!(
            one == other,
            "{} of {} and {} differ",
            one.symmetric_difference(&other).count(),
            one.len(),
            other.len()
        );
    }

    // One mesh of all has no seam, whatever the number of tiles at a time.
    line(folder.path(), &format!("{RUN} -o one.ply --jobs 1 --threads 1")).ok();
    line(folder.path(), &format!("{RUN} -o two.ply --jobs 2")).ok();
    let [one, two] = ["one.ply", "two.ply"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(one == two && !folder.path().join("one.ply.tiles").exists());
    let found = topology(&read_mesh(&folder.path().join("one.ply")).unwrap()).unwrap();
    assert_eq!((found.nonmanifold_edges, found.duplicate_triangles), (0, 0));
}

/// Middles of edges with one triangle.
fn open_edges(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for t in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let middle = |ends: [u32; 2]| -> [f64; 3] {
        let [p, q] = ends.map(|v| mesh.vertices[v as usize]);
        std::array::from_fn(|a| 0.5 * (p[a] + q[a]) + mesh.world_from_local[a])
    };
    sides.into_iter().filter(|(_, count)| *count == 1).map(|(ends, _)| middle(ends)).collect()
}

#[test]
fn simplified_tiles_keep_the_error_and_meet() {
    let folder = folder();
    city(folder.path());
    let part = format!("{RUN} --bounds=-0.2,-0.15,0.2,0.15");
    line(folder.path(), &format!("{part} -o full.ply")).ok();
    line(folder.path(), &format!("{part} -o simple.ply --max-error 0.003")).ok();
    line(folder.path(), &format!("{part} -o simple/ --max-error 0.003")).ok();
    let [full, simple] = ["full.ply", "simple.ply"].map(|name| read_mesh(&folder.path().join(name)).unwrap());
    assert!(simple.triangles.len() < full.triangles.len() / 4, "{}", simple.triangles.len());
    let made = files(&folder.path().join("simple"));
    let in_tiles = |(name, glb): (&String, &Vec<u8>)| {
        if name.starts_with("tiles/") { as_stored(glb).triangles.len() } else { 0 }
    };
    assert_eq!(made.iter().map(in_tiles).sum::<usize>(), simple.triangles.len());
    assert!(made.contains_key("levels/1/-1_-1.glb"));
    let params = CompareParams { samples: 50_000, ..CompareParams::default() };
    let apart = compare(&simple, &full, &params, &()).unwrap().overall.distances.combined;
    // Beside the places that were measured, too.
    assert!(apart.max < 1.1 * 0.003 && apart.max > 0.0003, "{apart:?}");
    let found = topology(&simple).unwrap();
    assert_eq!((found.nonmanifold_edges, found.inconsistent_edges), (0, 0));
    // Along the faces there are no open edges but where the whole has some.
    let (all, open) = (open_edges(&full), open_edges(&simple));
    assert!(!all.is_empty());
    for p in open.iter().filter(|p| p[0].abs() < 0.016 || p[1].abs() < 0.016) {
        let near = |q: &[f64; 3]| (0..3).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt() < 0.03;
        assert!(all.iter().any(near), "{p:?}");
    }
}

#[test]
fn a_run_that_is_killed_goes_on_and_ends_with_the_same_bits() {
    let folder = folder();
    city(folder.path());
    line(folder.path(), &format!("{RUN} -o whole/ --keep-work")).ok();
    let whole = files(&folder.path().join("whole"));
    let words: Vec<String> = format!("{RUN} -o killed/ --keep-work").split(' ').map(str::to_owned).collect();
    let mut kills = 0;
    for attempt in 0.. {
        let mut child = Command::new(env!("CARGO_BIN_EXE_zeroset"))
            .args(&words)
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Later each time, so that every step is hit sooner or later, and the last run ends.
        std::thread::sleep(Duration::from_millis(40 + 350 * attempt));
        if let Some(status) = child.try_wait().unwrap() {
            assert!(status.success());
            break;
        }
        child.kill().unwrap();
        child.wait().unwrap();
        kills += 1;
    }
    assert!(kills >= 3, "{kills}");
    let mut killed = files(&folder.path().join("killed"));
    // What an interrupted write leaves behind is no result.
    killed.retain(|name, _| !name.rsplit('/').next().unwrap().starts_with(".zeroset-"));
    assert_eq!(killed.keys().collect::<Vec<_>>(), whole.keys().collect::<Vec<_>>());
    for (name, bytes) in &whole {
        assert!(killed[name] == *bytes, "{name}");
    }
}

#[test]
fn folders_and_options_that_do_not_fit_are_refused_in_one_line() {
    let folder = folder();
    city(folder.path());
    std::fs::create_dir(folder.path().join("full")).unwrap();
    std::fs::write(folder.path().join("full/mine.txt"), "mine").unwrap();
    let refused = |options: &str, words: &[&str]| {
        let said = line(folder.path(), &format!("reconstruct a.xyz {options} -q")).failed(words[0]);
        assert!(words.iter().all(|word| said.contains(word)), "{said}");
    };
    refused("-o full/ --tile 1.1 --resolution 0.008", &["full", "is not empty", "new folder"]);
    assert_eq!(std::fs::read(folder.path().join("full/mine.txt")).unwrap(), b"mine");
    refused("-o out/ --tile 0.1 --resolution 0.008", &["a.xyz", "narrow", "--tile 1.0"]);
    assert!(!folder.path().join("out").exists());
    refused("-o other/ --tile 1.1 --resolution 0.008 --scene object", &["a.xyz", "--scene terrain"]);
    refused("-o feet/ --tile 1.1ft --resolution 0.008", &["a.xyz", "unit", "--tile"]);
    refused("-o some/ --tile 1.1 --outliers 8", &["--outliers"]);
    refused("-o some/ --tile 1.1 --triangles 800", &["--triangles", "--max-error"]);
    refused("-o none/ --tile 1.1 --bounds 7,7,8,8", &["a.xyz", "no points"]);
    line(
        folder.path(),
        "reconstruct a.xyz -o begun/ --tile 1.1 --resolution 0.008 --quality draft --scene airborne -q",
    )
    .ok();
    refused("-o begun/ --tile 1.1 --resolution 0.01", &["begun", "other inputs or options"]);
}

#[test]
fn a_folder_that_is_finished_says_so_and_stays_as_it_is() {
    let folder = folder();
    city(folder.path());
    let run = RUN.replace(" -q", " -o out/ --report out.json");
    line(folder.path(), &run).ok();
    let made = files(&folder.path().join("out"));
    let first = std::fs::read(folder.path().join("out.json")).unwrap();
    let said = line(folder.path(), &run).ok().stderr;
    assert!(said.contains("out/: ") && said.contains("4 tiles") && said.contains("are there already"), "{said}");
    assert!(files(&folder.path().join("out")) == made);
    let [first, again]: [Value; 2] =
        [first, std::fs::read(folder.path().join("out.json")).unwrap()].map(|b| serde_json::from_slice(&b).unwrap());
    assert_eq!((&again["tiles"], &again["plan"]), (&first["tiles"], &first["plan"]));
}

#[test]
fn constraints_are_held_against_the_points_of_tiles_whatever_else_is_given() {
    let folder = folder();
    city(folder.path());
    std::fs::write(folder.path().join("far.obj"), "v 900 900 0\nv 901 900 0\nv 901 901 0\nf 1 2 3\n").unwrap();
    std::fs::write(folder.path().join("near.obj"), "v 0 0 .05\nv .1 0 .05\nv .1 .1 .05\nf 1 2 3\n").unwrap();
    for (name, resolution) in [("free", ""), ("given", "--resolution 0.008")] {
        let run = format!("reconstruct a.xyz b.xyz --tile 1.6 {resolution} --quality draft --scene airborne -q");
        let said = line(folder.path(), &format!("{run} -o far/ --constraints far.obj")).failed("a.xyz");
        assert!(said.contains("constraint"), "{said}");
        line(folder.path(), &format!("{run} -o {name}/ --constraints near.obj")).ok();
        let plan: Value =
            serde_json::from_slice(&std::fs::read(folder.path().join(name).join("plan.json")).unwrap()).unwrap();
        assert_eq!(plan["report"]["constraints"]["polygons"], 1, "{plan}");
    }
}

#[test]
fn ground_that_does_not_fit_into_memory_is_made_in_tiles() {
    let folder = folder();
    city(folder.path());
    let run = "reconstruct a.xyz b.xyz --resolution 0.0025 --quality draft --scene airborne";
    let said = line(folder.path(), &format!("{run} -o small.ply --memory 90MB --report small.json")).ok().stderr;
    assert!(said.contains("more memory than there is") && said.contains(" tiles of 0.5 "), "{said}");
    let report: Value = serde_json::from_slice(&std::fs::read(folder.path().join("small.json")).unwrap()).unwrap();
    assert!(report["plan"]["tiles"].as_array().unwrap().len() > 1, "{report}");
    assert!(!folder.path().join("small.ply.tiles").exists());
    // No body is cut up.
    let said = line(folder.path(), &format!("{} -o body.ply --memory 90MB", run.replace("airborne", "object")));
    assert!(said.failed("a.xyz").contains("a resolution of 0.0025 needs about"));
    assert!(!folder.path().join("body.ply.tiles").exists());
}

/// Without a side, tiles are as wide as memory allows for, and no input needs to be larger than a tile.
#[test]
fn tiles_are_as_wide_as_memory_allows() {
    let folder = folder();
    line(folder.path(), "sample airborne-city -o city.las --points 120000").ok();
    let sides: Vec<f64> = ["10GB", "100MB"]
        .into_iter()
        .map(|memory| {
            let run = format!("reconstruct city.las -o {memory}/ --memory {memory} --quality draft --report - -q");
            let outcome = line(folder.path(), &run).ok();
            serde_json::from_str::<Value>(&outcome.stdout).unwrap()["plan"]["side"].as_f64().unwrap()
        })
        .collect();
    assert!(sides[0] > 1.0 && sides[1] < 1.0, "{sides:?}");
    let said = line(folder.path(), "reconstruct city.las -o none/ --memory 1MB -q").failed("GB");
    assert!(said.contains("--memory"), "{said}");
    assert!(!folder.path().join("none").exists());
}

/// The city of the README, as it stands there: surveyed in metres on a national grid, in two files.
#[test]
fn the_command_of_the_readme_makes_a_city() {
    let folder = folder();
    let scene = Scene::new(SceneKind::AirborneCity, 0);
    let points = scene.points(100_000, 0.0003, 1).points;
    std::fs::create_dir(folder.path().join("city")).unwrap();
    for (name, range) in [("east.laz", 0..50_000), ("west.laz", 50_000..100_000)] {
        let world = |p: &[f64; 3]| [84_800.0 + 300.0 * p[0], 447_400.0 + 300.0 * p[1], 300.0 * p[2]];
        let own = points[range].iter().map(world).collect();
        let cloud = Cloud { crs: Some("EPSG:28992+5709".into()), ..Cloud::from_world(own) };
        write_cloud(&folder.path().join("city").join(name), &cloud, &WriteOptions::default()).unwrap();
    }
    let readme = include_str!("../../../../README.md");
    let command = readme.lines().find_map(|line| line.strip_prefix("zeroset reconstruct city/")).unwrap();
    let command = format!("reconstruct city/{command}").replace("city/*.laz", "city/east.laz city/west.laz");
    let said = line(folder.path(), &command).ok().stderr;
    assert!(said.contains(" tiles of 250 from 100,000 points"), "{said}");
    let made = files(&folder.path().join("city/tiles"));
    let tileset: Value = serde_json::from_slice(&made["tileset.json"]).unwrap();
    assert!(said.contains("stands on the globe"), "{said}");
    assert!(made.keys().filter(|name| name.starts_with("tiles/")).count() >= 4, "{:?}", made.keys());

    // Every vertex, through the transforms of the file and of the tileset, lies where the reference system says that a point of the surface is: within
    // 1 mm of where the same vertex of the PLY is placed.
    let transform: Vec<f64> =
        tileset["root"]["transform"].as_array().unwrap().iter().map(|v| v.as_f64().unwrap()).collect();
    let earth = |p: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|a| (0..3).map(|c| transform[4 * c + a] * p[c]).sum::<f64>() + transform[12 + a])
    };
    let plain = command.replace("-o city/tiles/", "-o plain/ --tile-format ply");
    line(folder.path(), &plain).ok();
    let globe = Globe::of("EPSG:28992").unwrap();
    let mut checked = 0;
    for name in made.keys().filter_map(|name| name.strip_prefix("tiles/")?.strip_suffix(".glb")) {
        let glb = as_stored(&made[&format!("tiles/{name}.glb")]);
        let ply = read_mesh(&folder.path().join(format!("plain/tiles/{name}.ply"))).unwrap();
        assert_eq!(glb.triangles, ply.triangles);
        for (v, w) in glb.vertices.iter().zip(&ply.vertices) {
            let found = earth(std::array::from_fn(|a| v[a] + glb.world_from_local[a]));
            let truth = globe.geocentric(std::array::from_fn(|a| w[a] + ply.world_from_local[a])).unwrap();
            let off = (0..3).map(|a| (found[a] - truth[a]).powi(2)).sum::<f64>().sqrt();
            assert!(off < 1e-3, "{name}: {off}");
            checked += 1;
        }
    }
    assert!(checked > 10_000, "{checked}");
}

/// The models of two tiles are one where they meet, and each makes its surface by itself.
#[test]
fn tiles_as_models_agree_where_they_meet() {
    let folder = folder();
    city(folder.path());
    line(folder.path(), &format!("{RUN} -o out/ --tile-format zset")).ok();
    let made = files(&folder.path().join("out"));
    assert!(!made.contains_key("tileset.json") && made.keys().all(|name| !name.starts_with("levels")));
    let model = |name: &str| read_model(&folder.path().join("out/tiles").join(name)).unwrap();
    let [west, east] = ["-1_0.zset", "0_0.zset"].map(|name| model(name).solid.field([0.0; 3]).unwrap());
    let (mut known, mut most) = (0, 0.0_f64);
    for i in 0..4000 {
        // Beside the face at x = 0, a node at most to either side.
        let p = [f64::from(i % 17) * 0.001 - 0.008, 0.05 + f64::from(i / 17) * 0.0015, 0.01 + f64::from(i % 7) * 0.004];
        let values = [west.value(p), east.value(p)];
        if values.iter().all(|v| v.abs() < 0.02) {
            known += 1;
            most = most.max((values[0] - values[1]).abs());
        }
    }
    assert!(known > 500 && most < 1e-6, "{known} {most}");
    line(folder.path(), "mesh out/tiles/0_0.zset -o east.ply -q").ok();
    assert_eq!(topology(&read_mesh(&folder.path().join("east.ply")).unwrap()).unwrap().nonmanifold_edges, 0);
}
