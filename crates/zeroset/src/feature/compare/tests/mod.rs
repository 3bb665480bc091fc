//! Features made from the truth itself, and spoiled in known ways.

mod cloud;
mod edges;
mod planes;

use super::truth::Truth;
use super::*;
use crate::feature::{Corner, Edge, Plane};
use crate::sample::{Scene, SceneKind};
use crate::vec3::Vec3;

pub(super) fn truth_of(kind: SceneKind) -> Mesh {
    Scene::new(kind, 0).truth
}

pub(super) fn run(found: &Features, truth: &Mesh) -> CompareFeaturesReport {
    compare_features(found, truth, None, &CompareFeaturesParams::default(), &()).expect("a sound truth")
}

pub(super) fn assert_near(value: Option<f64>, expected: f64, tolerance: f64) {
    let value = value.expect("a value");
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} to {tolerance}");
}

/// The features of a mesh with nothing wrong: one oriented plane a face, one edge a crease, one corner a true corner.
pub(super) fn exact(mesh: &Mesh) -> Features {
    let truth = Truth::new(mesh, &CompareFeaturesParams::default()).expect("a sound truth");
    let planes = truth.faces.iter().map(|face| Plane {
        normal: face.normal,
        offset: vec3::dot(face.normal, face.centre),
        oriented: true,
        points: 100,
        rms: Some(0.0),
        area: face.area,
        rings: outline(&truth.mesh, &face.triangles),
    });
    let edges = truth.sharp.edges.iter().zip(&truth.sharp.segments).map(|(crease, ends)| Edge {
        kind: crease.kind(),
        planes: vec![],
        polyline: ends.to_vec(),
        angle: 1.0,
    });
    let corners = truth.sharp.corners.iter().map(|corner| Corner {
        kind: corner.kind,
        position: corner.position,
        planes: vec![],
        edges: vec![],
    });
    Features {
        world_from_local: mesh.world_from_local,
        planes: planes.collect(),
        edges: edges.collect(),
        corners: corners.collect(),
        ..Features::default()
    }
}

/// The closed chains of sides that only one of the triangles has.
fn outline(mesh: &Mesh, triangles: &[usize]) -> Vec<Vec<Vec3>> {
    let sides = |t: &usize| {
        let [a, b, c] = mesh.triangles[*t];
        [(a, b), (b, c), (c, a)]
    };
    let all: Vec<(u32, u32)> = triangles.iter().flat_map(sides).collect();
    let mut open: Vec<(u32, u32)> = all.iter().copied().filter(|&(a, b)| !all.contains(&(b, a))).collect();
    let mut rings = Vec::new();
    while let Some((first, mut at)) = open.pop() {
        let mut ring = vec![mesh.vertices[first as usize]];
        while at != first {
            ring.push(mesh.vertices[at as usize]);
            let next = open.iter().position(|side| side.0 == at).expect("a closed outline");
            at = open.swap_remove(next).1;
        }
        rings.push(ring);
    }
    rings
}

/// The number of the plane whose normal is this axis.
pub(super) fn facing(found: &Features, normal: Vec3) -> usize {
    found.planes.iter().position(|plane| vec3::distance(plane.normal, normal) < 1e-9).expect("such a plane")
}

#[test]
fn what_is_exact_is_all_right() {
    // Faces, corners, corners where edges of both kinds meet, and length of the creases, by hand.
    let plate = 4.0 * (1.0 + 0.7 + 0.15);
    let expected = [
        (SceneKind::Box, 6, 8, 0, 4.0 * (1.0 + 0.8 + 0.6)),
        (SceneKind::LBlock, 8, 12, 2, 2.0 * 2.0 * (1.0 + 0.8) + 6.0 * 0.5),
        (SceneKind::Stairs, 14, 24, 8, 2.0 * 3.0 + 12.0 * 0.6),
    ];
    for (kind, faces, corners, mixed, length) in expected {
        let truth = truth_of(kind);
        let found = exact(&truth);
        let count = found.corners.iter().filter(|corner| corner.kind == super::super::FeatureKind::Mixed).count();
        assert_eq!((found.planes.len(), found.corners.len(), count), (faces, corners, mixed), "{kind}");
        let report = run(&found, &truth);
        assert_all_right(&report);
        assert_eq!((report.planes.all.faces, report.corners.counted), (faces, corners), "{kind}");
        assert_near(Some(report.edges.true_length), length, 1e-12);
        assert_near(Some(report.edges.found_length), length, 1e-12);
    }
    // Polygons with holes.
    let truth = truth_of(SceneKind::PocketPlate);
    let found = exact(&truth);
    assert!(found.planes.iter().any(|plane| plane.rings.len() > 2));
    let report = run(&found, &truth);
    assert_all_right(&report);
    assert!(report.edges.true_length > plate);
}

pub(super) fn assert_all_right(report: &CompareFeaturesReport) {
    let (planes, edges, corners) = (&report.planes, &report.edges, &report.corners);
    assert_eq!((planes.matched, planes.all.found), (planes.found, planes.all.faces), "{report:?}");
    for recall in [planes.all, planes.walls, planes.roofs_and_ground] {
        assert_eq!(recall.by_count, Some(1.0), "{report:?}");
        assert_near(recall.by_area, 1.0, 1e-12);
    }
    assert_eq!((planes.precision, planes.orientation), (Some(1.0), Some(1.0)));
    assert!(planes.angle_error_deg.expect("matches").max < 1e-9);
    assert!(planes.offset_error.expect("matches").max < 1e-9);
    assert_eq!((edges.recall, edges.precision, edges.kind), (Some(1.0), Some(1.0), Some(1.0)), "{report:?}");
    assert_eq!((corners.recall, corners.precision, corners.kind), (Some(1.0), Some(1.0), Some(1.0)), "{report:?}");
    assert_near(corners.mean_distance, 0.0, 1e-9);
}

#[test]
fn world_offsets_of_features_and_truth_may_differ() {
    let mut truth = truth_of(SceneKind::LBlock);
    truth.world_from_local = [500_000.0, 5_400_000.0, 100.0];
    let mut found = moved(&exact(&truth), [64.0, -32.0, 8.0]);
    found.world_from_local = vec3::sub(truth.world_from_local, [64.0, -32.0, 8.0]);
    assert_all_right(&run(&found, &truth));
    found.world_from_local[2] += 1.0;
    let report = run(&found, &truth);
    assert_eq!((report.edges.recall, report.corners.recall), (Some(0.0), Some(0.0)));
}

#[test]
fn a_truth_need_not_be_welded() {
    let truth = truth_of(SceneKind::Stairs);
    let mut loose = Mesh::default();
    for triangle in &truth.triangles {
        let first = loose.vertices.len() as u32;
        loose.vertices.extend(triangle.map(|v| truth.vertices[v as usize]));
        loose.triangles.push([first, first + 1, first + 2]);
    }
    assert_eq!(run(&exact(&truth), &loose), run(&exact(&truth), &truth));
}

#[test]
fn what_makes_no_sense_is_an_error() {
    let truth = truth_of(SceneKind::Box);
    let compare = |truth: &Mesh, cloud: Option<&Cloud>, params: &CompareFeaturesParams| {
        compare_features(&Features::default(), truth, cloud, params, &()).expect_err("an error")
    };
    let usual = CompareFeaturesParams::default();
    assert_eq!(compare(&Mesh::default(), None, &usual), CompareFeaturesError::NoSurface { faces: 0 });
    let mut flat = truth.clone();
    flat.vertices.iter_mut().for_each(|v| *v = [v[0], 0.0, 0.0]);
    assert_eq!(compare(&flat, None, &usual), CompareFeaturesError::NoSurface { faces: 12 });
    let mut broken = truth.clone();
    broken.triangles[3][1] = 99;
    assert!(matches!(compare(&broken, None, &usual), CompareFeaturesError::Broken(_)));
    let cloud = Cloud { points: vec![[0.5; 3]; 7], ..Cloud::default() };
    assert_eq!(compare(&truth, Some(&cloud), &usual), CompareFeaturesError::NoPoints { points: 7 });
    for (name, value) in [("edge_tolerance", 0.0), ("edge_tolerance", -1.0), ("edge_tolerance", f64::INFINITY)] {
        let params = CompareFeaturesParams { edge_tolerance: Some(value), ..usual.clone() };
        assert_eq!(compare(&truth, None, &params), CompareFeaturesError::Parameter { name, value });
    }
    let params = CompareFeaturesParams { edge_samples: 0, ..usual };
    let error = compare(&truth, None, &params).to_string();
    assert_eq!(error, "edge_samples is 0; it must be positive");
}

#[test]
fn features_that_are_not_finite_match_nothing() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    found.planes[0].normal = [f64::NAN; 3];
    found.planes[1].rings[0][2] = [f64::INFINITY; 3];
    found.planes[2].offset = f64::NAN;
    found.planes[3].rings.clear();
    found.planes[4].rings[0].truncate(2);
    found.corners[0].position = [f64::NAN; 3];
    let report = run(&found, &truth);
    assert_eq!(report.planes.matched, 1);
    assert_near(report.corners.recall, 7.0 / 8.0, 1e-12);
}
