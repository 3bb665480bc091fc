use super::{mapped, mesh, sheet, together};
use crate::cloud::Attributes;
use crate::mesh::{Clustered, CompareParams, Mesh, SimplifyError, cluster, compare, topology};
use crate::sample::{Scene, SceneKind};
use crate::vec3::{self, Vec3};

/// Clusters, and holds the result to what every clustering must keep.
fn clustered(mesh: &Mesh, held: &[u32], side: f64) -> Clustered {
    let done = cluster(mesh, held, side).expect("a sound mesh");
    assert!(done.moved <= 3.0_f64.sqrt() * side, "{}", done.moved);
    let found = topology(&done.mesh).unwrap();
    assert_eq!((found.unused_vertices, found.inconsistent_edges), (0, 0));
    for (&old, new) in held.iter().zip(&done.held) {
        let new = new.expect("a triangle is left") as usize;
        assert_eq!(done.mesh.vertices[new].map(f64::to_bits), mesh.vertices[old as usize].map(f64::to_bits));
    }
    done
}

/// A square sheet, turned and far from the origin.
fn turned(p: Vec3) -> Vec3 {
    [300.0 + 0.8 * p[0] - 0.6 * p[2], 200.0 + p[1], 0.6 * p[0] + 0.8 * p[2]]
}

#[test]
fn a_plane_stays_plane_and_keeps_its_outline() {
    let plane = mapped(&sheet(64), turned);
    let Clustered { mesh: light, moved, .. } = clustered(&plane, &[], 0.11);
    assert!(light.triangles.len() < plane.triangles.len() / 20, "{}", light.triangles.len());
    assert!(moved > 0.05);
    let off = |p: &Vec3| 0.6 * (p[0] - 300.0) - 0.8 * p[2];
    // A few roundings of numbers of some hundreds.
    assert!(light.vertices.iter().all(|p| off(p).abs() < 1e-12));
    // The outline is that of the sheet: all its sides and corners are where they were.
    let found = topology(&light).unwrap();
    assert!((found.area - 1.0).abs() < 1e-9, "{}", found.area);
    assert_eq!((found.boundary_loops, found.nonmanifold_edges), (1, 0));
}

#[test]
fn edges_and_corners_stay_sharp() {
    // Five sides of a cube, each cut fine, joined at the edges.
    let n = 40_u32;
    let half = 0.5;
    let square = mapped(&sheet(n), |[x, y, _]| [x - half, y - half, half]);
    let sides = [
        square.clone(),
        mapped(&square, |[x, y, z]| [z, x, y]),
        mapped(&square, |[x, y, z]| [y, z, x]),
        mapped(&square, |[x, y, z]| [-z, y, x]),
        mapped(&square, |[x, y, z]| [x, -z, y]),
    ];
    let cube = welded(&together(&sides));
    assert_eq!(topology(&cube).unwrap().boundary_loops, 1);
    let Clustered { mesh: light, .. } = clustered(&cube, &[], 0.1375);
    assert!(light.triangles.len() < cube.triangles.len() / 15);
    let off = |p: &Vec3| (p.iter().fold(0.0_f64, |m, c| m.max(c.abs())) - half).abs();
    assert!(light.vertices.iter().all(|p| off(p) < 1e-12));
    for corner in [[0.5, 0.5, 0.5], [-0.5, 0.5, 0.5], [0.5, -0.5, 0.5], [-0.5, -0.5, 0.5]] {
        assert!(light.vertices.iter().any(|p| vec3::distance(*p, corner) < 1e-9), "{corner:?}");
    }
}

/// Vertices at one place as one.
fn welded(mesh: &Mesh) -> Mesh {
    let mut numbers = rustc_hash::FxHashMap::default();
    let mut welded = Mesh::default();
    let of = |p: &Vec3| p.map(|c| (c * 1e6).round() as i64);
    let number: Vec<u32> = mesh
        .vertices
        .iter()
        .map(|p| {
            *numbers.entry(of(p)).or_insert_with(|| {
                welded.vertices.push(*p);
                welded.vertices.len() as u32 - 1
            })
        })
        .collect();
    welded.triangles = mesh.triangles.iter().map(|t| t.map(|v| number[v as usize])).collect();
    welded
}

#[test]
fn a_sphere_stays_closed_and_within_the_bound() {
    let sphere = Scene::new(SceneKind::Sphere, 0).truth;
    for side in [0.03, 0.08, 0.21] {
        let Clustered { mesh: light, moved, .. } = clustered(&sphere, &[], side);
        let found = topology(&light).unwrap();
        assert_eq!((found.boundary_edges, found.nonmanifold_edges, found.genus), (0, 0, Some(0)), "{side}");
        let report = compare(&light, &sphere, &CompareParams::default(), &()).unwrap();
        assert!(report.overall.distances.combined.max <= moved, "{side}");
    }
}

#[test]
fn held_vertices_stay_with_the_edges_between_them() {
    let plane = sheet(32);
    // Two sides of the square.
    let held: Vec<u32> = (0..33 * 33).filter(|&v| v < 33 || v % 33 == 32).collect();
    let done = clustered(&plane, &held, 0.2);
    let new = |v: u32| done.held[held.binary_search(&v).unwrap()].unwrap();
    let has = |a: u32, b: u32| done.mesh.triangles.iter().any(|t| t.contains(&a) && t.contains(&b));
    for v in 0..32 {
        assert!(has(new(v), new(v + 1)), "{v}");
        assert!(has(new(33 * v + 32), new(33 * (v + 1) + 32)), "{v}");
    }
    assert!((topology(&done.mesh).unwrap().area - 1.0).abs() < 1e-9);
}

#[test]
fn sheets_in_one_cell_stay_apart_and_meet_where_they_are_joined() {
    // A bridge and the ground, a fifth of a cell below it.
    let ground = mapped(&sheet(40), |[x, y, _]| [x, y, 0.03]);
    let both = together(&[ground, mapped(&sheet(40), |[x, y, _]| [x, y, 0.05])]);
    let Clustered { mesh: light, .. } = clustered(&both, &[], 0.1);
    let found = topology(&light).unwrap();
    assert_eq!((found.components.len(), found.nonmanifold_edges), (2, 0));
    assert!(light.triangles.len() < both.triangles.len() / 8);
    assert!(light.vertices.iter().all(|p| (p[2] - 0.03).abs() < 1e-12 || (p[2] - 0.05).abs() < 1e-12));
    // A wall thinner than a cell, closed at its top: both sides are still there.
    let wall = mapped(&sheet(80), |[x, y, _]| {
        let along = (x - 0.5).abs();
        [if x < 0.5 { 0.03 } else { 0.05 }, y, 1.0 - along]
    });
    let Clustered { mesh: light, .. } = clustered(&wall, &[], 0.1);
    let area = topology(&light).unwrap().area;
    assert!((area / topology(&wall).unwrap().area - 1.0).abs() < 0.05, "{area}");
}

#[test]
fn a_sheet_of_two_sides_keeps_both_and_copies_go() {
    // A flat lens: its middles fall to the first corner.
    let corners = [[0.1, 0.1, 0.1], [5.1, 0.1, 0.1], [0.1, 5.1, 0.1], [0.3, 0.3, 0.2], [0.3, 0.3, 0.0]];
    let up = [[0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let down = [[1, 0, 4], [2, 1, 4], [0, 2, 4]];
    let lens = mesh(&corners, &[up, down].concat());
    let light = clustered(&lens, &[], 1.0).mesh;
    assert_eq!(light.triangles, [[0, 1, 2], [0, 2, 1]]);
    assert!(topology(&light).unwrap().closed);
    // Twice the same way round.
    let twice = mesh(&corners, &[up, up].concat());
    assert_eq!(cluster(&twice, &[], 1.0).unwrap().mesh.triangles, [[0, 1, 2]]);
}

#[test]
fn a_flap_is_folded_onto_the_edge_that_it_hangs_from() {
    // A vertex in a cell of its own, with nothing but two clusters around it: their vertices are 0 and 4, and 1.
    let corners =
        [[0.9, 0.5, 0.5], [2.1, 0.6, 0.5], [1.2, 3.5, 0.5], [1.2, -3.5, 0.5], [0.8, 0.4, 0.5], [1.5, 0.4, 0.6]];
    let around = [[0, 5, 1], [5, 4, 1], [4, 5, 0], [0, 1, 2], [1, 4, 3], [4, 0, 2], [0, 4, 3]];
    let mesh = mesh(&corners, &around);
    let light = clustered(&mesh, &[], 1.0);
    assert_eq!(light.mesh.vertices.len(), 4);
    assert_eq!(light.mesh.triangles, [[0, 1, 2], [0, 3, 1]]);
    // It was 0.14 off the edge at the least, and its foot is no farther than the diagonal.
    assert!((0.1..1.0).contains(&light.moved), "{}", light.moved);
    // A flap that is held stays.
    assert_eq!(clustered(&mesh, &[5], 1.0).mesh.triangles.len(), 4);
}

#[test]
fn values_are_those_of_the_cell() {
    let mut plane = mapped(&sheet(2), |[x, y, z]| [0.8 * x, 4.0 * y + 0.1, z]);
    plane.attributes = Attributes {
        colors: Some((0..9).map(|i| [10 * i, 0, 255]).collect()),
        intensities: Some((0_u8..9).map(f32::from).collect()),
        classes: Some(vec![2, 6, 1, 2, 6, 1, 5, 6, 1]),
    };
    // Columns of three in x make one each, but for the one that is held.
    let done = clustered(&plane, &[4], 1.0);
    let at = |y: f64| done.mesh.vertices.iter().position(|p| (p[1] - y).abs() < 1e-9).unwrap();
    let Attributes { colors, intensities, classes } = &done.mesh.attributes;
    let (colors, intensities, classes) =
        (colors.as_ref().unwrap(), intensities.as_ref().unwrap(), classes.as_ref().unwrap());
    // Vertices 0, 3 and 6: of two and five, two come twice.
    assert_eq!((colors[at(0.1)], intensities[at(0.1)], classes[at(0.1)]), ([30, 0, 255], 3.0, 2));
    let held = done.held[0].unwrap() as usize;
    assert_eq!((colors[held], intensities[held], classes[held]), ([40, 0, 255], 4.0, 6));
    // Of equals the lowest.
    let pair = Mesh {
        vertices: vec![[0.1, 0.1, 0.1], [0.2, 0.1, 0.1], [5.0, 0.0, 0.0], [0.0, 5.0, 0.0]],
        triangles: vec![[0, 1, 3], [1, 2, 3]],
        attributes: Attributes { classes: Some(vec![9, 4, 0, 0]), ..Attributes::default() },
        ..Mesh::default()
    };
    assert_eq!(clustered(&pair, &[], 1.0).mesh.attributes.classes, Some(vec![4, 0, 0]));
}

#[test]
fn equal_on_any_number_of_threads() {
    let torus = Scene::new(SceneKind::Torus, 0).truth;
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| cluster(&torus, &[5, 77, 1234], 0.05).unwrap())
    };
    let one = run(1);
    assert!(one == run(2) && one == run(5));
}

#[test]
fn nonsense_is_refused() {
    let plane = sheet(2);
    for side in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(cluster(&plane, &[], side), Err(SimplifyError::Parameter { .. })), "{side}");
    }
    let broken = mesh(&[[0.0; 3]], &[[0, 1, 2]]);
    assert!(matches!(cluster(&broken, &[], 1.0), Err(SimplifyError::Broken(_))));
    // A vertex that is not there is held in vain.
    assert_eq!(cluster(&plane, &[900], 0.1).unwrap().held, [None]);
    assert_eq!(cluster(&Mesh::default(), &[], 1.0).unwrap().mesh, Mesh::default());
}
