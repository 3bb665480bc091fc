//! `render`.

use std::path::Path;

use zeroset::cloud::{Attributes, Cloud};
use zeroset::mesh::Mesh;
use zeroset::sample::{Scene, SceneKind};
use zeroset_io::{WriteOptions, write_cloud, write_mesh};

use crate::common::{CLOUDS, MESHES, entries, folder, line, sound, torus, write};

const SIZE: &str = "--size 160x120";

/// The size of a picture, and what its pixels hold: bytes for each.
fn header(path: &Path) -> ([u32; 2], u8) {
    let bytes = std::fs::read(path).unwrap();
    assert_eq!(&bytes[..8], b"\x89PNG\r\n\x1a\n");
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    ([number(16), number(20)], bytes[25])
}

fn sphere(path: &Path) {
    let mesh = Mesh { world_from_local: [84_810.0, 447_412.0, 0.0], ..Scene::new(SceneKind::Sphere, 0).truth };
    write_mesh(path, &mesh, &WriteOptions::default()).unwrap();
}

#[test]
fn every_format_is_drawn() {
    let folder = folder();
    for suffix in CLOUDS {
        std::fs::write(folder.path().join(format!("in.{suffix}")), sound(suffix)).unwrap();
        let said = line(folder.path(), &format!("render in.{suffix} -o cloud.png {SIZE}")).ok();
        assert!(said.stderr.contains("60 points") && said.stdout.is_empty(), "{said:?}");
        assert_eq!(header(&folder.path().join("cloud.png")), ([160, 120], 2), "{suffix}");
    }
    for suffix in MESHES {
        sphere(&folder.path().join(format!("mesh.{suffix}")));
        let said = line(folder.path(), &format!("render mesh.{suffix} -o mesh.png {SIZE}")).ok();
        assert!(said.stderr.contains("81,920 triangles"), "{said:?}");
    }
}

#[test]
fn equal_files_give_equal_pictures() {
    let folder = folder();
    write(&folder.path().join("points.las"), &torus(5_000, [84_810.0, 447_412.0, 2.0]).points);
    sphere(&folder.path().join("mesh.ply"));
    let mut pictures = Vec::new();
    for (i, threads) in [1, 2, 1].into_iter().enumerate() {
        line(
            folder.path(),
            &format!("render points.las mesh.ply -o {i}.png --color height --threads {threads} --quiet {SIZE}"),
        )
        .ok();
        pictures.push(std::fs::read(folder.path().join(format!("{i}.png"))).unwrap());
    }
    assert!(pictures[0] == pictures[1] && pictures[0] == pictures[2]);
}

#[test]
fn colours_tell_what_is_asked_for() {
    let folder = folder();
    let cloud = Cloud {
        attributes: Attributes {
            classes: Some((0..4_000).map(|i| if i % 2 == 0 { 2 } else { 6 }).collect()),
            colors: Some(vec![[200, 30, 30]; 4_000]),
            ..Attributes::default()
        },
        ..Scene::new(SceneKind::Box, 1).points(4_000, 0.002, 1)
    };
    write_cloud(&folder.path().join("box.laz"), &cloud, &WriteOptions::default()).unwrap();
    write_mesh(&folder.path().join("box.ply"), &Scene::new(SceneKind::Box, 1).truth, &WriteOptions::default()).unwrap();
    line(folder.path(), "features box.laz -o box.json --scene object --quiet").ok();
    line(folder.path(), "fit box.laz -o box.zset --scene object --quality draft --quiet").ok();
    let mut pictures = Vec::new();
    for words in [
        "box.laz",
        "box.laz --color plain",
        "box.laz --color height",
        "box.laz --color height --up y",
        "box.laz --color class",
        "box.laz box.json --color plane",
        "box.laz box.zset --color residual",
        "box.laz box.zset --color residual --range=-0.1,0.1",
        "box.laz --color curvature",
        "box.ply --color curvature",
        "box.ply --distance-to box.laz",
        "box.ply --distance-to box.zset --color-map magma",
        "box.laz --distance-to box.ply --no-legend",
        "box.json",
        "box.ply box.json",
        "box.ply --camera 30,20 --background transparent",
        "box.ply --camera 3,3,3,0,0,0 --field-of-view 50",
        "box.ply --parallel --zoom 0.5",
        "box.laz --point-size 9",
    ] {
        line(folder.path(), &format!("render {words} -o out.png --quiet {SIZE}")).ok();
        pictures.push((words, std::fs::read(folder.path().join("out.png")).unwrap()));
    }
    for (i, (words, picture)) in pictures.iter().enumerate() {
        for (others, other) in &pictures[..i] {
            assert!(picture != other, "`{words}` shows the same as `{others}`");
        }
    }
}

#[test]
fn the_report_tells_what_was_drawn() {
    let folder = folder();
    sphere(&folder.path().join("mesh.ply"));
    line(folder.path(), &format!("render mesh.ply -o out.png --report report.json --quiet {SIZE}")).ok();
    let report: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("report.json")).unwrap()).unwrap();
    assert_eq!(report["drawn"]["triangles"], 81_920);
    assert_eq!(report["output"]["size"], serde_json::json!([160, 120]));
    assert!(report["seconds"]["draw"].as_f64().unwrap() > 0.0);
}

#[test]
fn what_is_not_there_cannot_be_shown() {
    let folder = folder();
    write(&folder.path().join("a.xyz"), &torus(100, [0.0; 3]).points);
    sphere(&folder.path().join("a.obj"));
    std::fs::write(folder.path().join("out.png"), "old").unwrap();
    for words in ["a.xyz --color rgb", "a.xyz --color class", "a.obj --color rgb"] {
        line(folder.path(), &format!("render {words} -o out.png")).failed("a.");
    }
    for words in ["missing.laz", "a.xyz missing.json", "a.xyz --distance-to missing.ply"] {
        line(folder.path(), &format!("render {words} -o out.png")).failed("missing.");
    }
    line(folder.path(), "render out.png -o other.png").failed("out.png");
    line(folder.path(), "render a.xyz -o out.jpg").failed("out.jpg");
    line(folder.path(), "render a.xyz -o none/out.png").failed("none");
    std::fs::write(folder.path().join("empty.ply"), "").unwrap();
    line(folder.path(), "render a.xyz empty.ply -o out.png").failed("empty.ply");
    for words in [
        "a.xyz --color plane",
        "a.xyz --color residual",
        "a.xyz --color distance",
        "a.xyz --color height --distance-to a.obj",
        "a.xyz --size 5x5",
        "a.xyz --size big",
        "a.xyz --camera sideways",
        "a.xyz --camera 1,2,3",
        "a.xyz --camera 0,95",
        "a.xyz --camera 1,1,1,1,1,1",
        "a.xyz --background reddish",
        "a.xyz --range 2,1 --color height",
        "a.xyz --zoom 0",
    ] {
        let said = line(folder.path(), &format!("render {words} -o out.png"));
        assert_eq!(said.code, Some(2), "{words}: {said:?}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("out.png")).unwrap(), "old");
    assert_eq!(entries(folder.path()), ["a.obj", "a.xyz", "empty.ply", "out.png"]);
}
