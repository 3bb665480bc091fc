//! Files of real scanners and of other programs, where they are at hand.

use crate::common::shared_data;
use zeroset_io::{CloudFormat, read_cloud, read_mesh};

#[test]
fn airborne_tile() {
    let Some(path) = shared_data("delft_ahn3.laz") else { return };
    let file = read_cloud(&path).unwrap();
    assert_eq!((file.cloud.len(), file.report.points_declared), (848_942, Some(848_942)));
    assert_eq!(file.report.format, CloudFormat::Laz);
    let mut classes = file.cloud.attributes.classes.unwrap();
    classes.sort_unstable();
    classes.dedup();
    assert_eq!(classes, [1, 2, 6, 9, 26]);
    // The same points by the `las` crate, to the last bit.
    let all = las::Reader::from_path(&path).unwrap().read_all().unwrap();
    let offset = file.cloud.world_from_local;
    for (i, ((x, y), z)) in all.x().zip(all.y()).zip(all.z()).enumerate() {
        let expected = [x - offset[0], y - offset[1], z - offset[2]];
        assert_eq!(file.cloud.points[i], expected, "point {i}");
    }
}

#[test]
fn coloured_tile_in_feet() {
    let Some(path) = shared_data("autzen_footbridge.laz") else { return };
    let file = read_cloud(&path).unwrap();
    assert_eq!(file.cloud.len(), 224_041);
    let colors = file.cloud.attributes.colors.unwrap();
    assert!(colors.iter().flatten().any(|c| *c > 128), "colours are stretched to 8 bits");
    println!("{:?} {:?}", file.report.unit, file.report.crs);
}

#[test]
fn a_scan_in_text() {
    let Some(path) = shared_data("distcap.xyz") else { return };
    let file = read_cloud(&path).unwrap();
    assert_eq!(file.cloud.len(), 12_745);
    assert_eq!(file.cloud.points[0], [0.426_964, 0.1, 0.140_009]);
    assert_eq!(file.cloud.world_from_local, [0.0; 3]);
}

#[test]
fn meshes_of_other_programs() {
    for (name, faces) in [
        ("fandisk.obj", None),
        ("block.obj", Some(17_550)),
        ("anchor.off", Some(98_412)),
        ("fertility.off", Some(9000)),
        ("featuretype.stl", Some(3476)),
    ] {
        let Some(path) = shared_data(name) else { continue };
        let mesh = read_mesh(&path).unwrap();
        if let Some(faces) = faces {
            assert_eq!(mesh.triangles.len(), faces, "{name}");
        }
        // Closed surfaces: every edge is passed once in each direction, also where STL had to be joined.
        let mut edges = std::collections::HashMap::new();
        for [a, b, c] in &mesh.triangles {
            for edge in [(a, b), (b, c), (c, a)] {
                *edges.entry(edge).or_insert(0) += 1;
            }
        }
        let open = edges.iter().filter(|((a, b), count)| edges.get(&(*b, *a)) != Some(*count)).count();
        println!("{name}: {} vertices, {} triangles, {open} open edges", mesh.vertices.len(), mesh.triangles.len());
        assert_eq!(open, 0, "{name}");
    }
}
