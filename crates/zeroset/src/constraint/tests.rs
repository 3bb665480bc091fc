//! Constraints by themselves: what is refused, what is cut off, samples, and mesh edges along lines.

use super::*;
use crate::mesh::{Mesh, topology};
use crate::sample::{Scene, SceneKind};
use crate::spatial::TriangleTree;

const HIGH: f64 = 4.0;

fn wall() -> Vec<Vec3> {
    vec![[0.0, 1.0, 0.0], [10.0, 1.0, 0.0], [10.0, 1.0, HIGH], [0.0, 1.0, HIGH]]
}

fn around(constraints: &Constraints, high: Vec3) -> Local {
    Local::new(constraints, [0.0; 3], |p| p, ([0.0; 3], high))
}

#[test]
fn what_bears_nothing_is_refused() {
    let mut known = Constraints::default();
    assert_eq!(known.line(&[[1.0; 3], [1.0; 3]]), Err(ConstraintError::NoExtent));
    assert_eq!(known.line(&[[1.0; 3], [1.0, f64::NAN, 1.0]]), Err(ConstraintError::NotFinite));
    assert_eq!(known.polygon(&[vec![[0.0; 3], [1.0; 3], [2.0; 3]]]), Err(ConstraintError::NoExtent));
    let mut bent = wall();
    bent[2][1] += 0.2;
    let error = known.polygon(&[bent.clone()]).expect_err("it is not plane");
    assert!(matches!(error, ConstraintError::Polygon(PolygonError::NotPlane { .. })));
    assert!(error.to_string().ends_with("; cut it into triangles"), "{error}");
    // Files round to centimetres.
    bent[2][1] = 1.01;
    assert_eq!(known.polygon(&[bent]), Ok(()));
    assert_eq!((known.lines(), known.polygons()), (0, 1));
    let outlines = known.into_outlines();
    assert_eq!((outlines.lines(), outlines.polygons()), (1, 0));
    assert_eq!(outlines.lines[0].len(), 5);
}

#[test]
fn what_lies_beyond_the_box_is_cut_off() {
    let mut known = Constraints::default();
    known.line(&[[-100.0, 2.0, 1.0], [100.0, 2.0, 1.0]]).unwrap();
    known.line(&[[-100.0, 2.0, 1.0], [-90.0, 2.0, 1.0]]).unwrap();
    known.polygon(&[wall()]).unwrap();
    // The margin is a twentieth of the longest side.
    let local = around(&known, [8.0, 4.0, 4.0]);
    let plan = local.plan;
    assert_eq!((plan.lines, plan.lines_used, plan.polygons_used), (2, 1, 1));
    assert!((plan.length - 8.8).abs() < 1e-12 && (plan.area - 8.4 * HIGH).abs() < 1e-12, "{plan:?}");
    assert!(around(&known, [8.0, 0.1, 0.1]).is_empty());
}

#[test]
fn samples_leave_no_gap_and_are_counted_before() {
    let mut known = Constraints::default();
    known.line(&[[0.0, 0.0, 0.0], [7.3, 2.0, 1.0]]).unwrap();
    known.polygon(&[wall()]).unwrap();
    known.polygon(&[vec![[0.0, 0.0, 0.0], [9.0, 0.0, 0.001], [9.0, 0.01, 0.0]]]).unwrap();
    let local = around(&known, [10.0, 4.0, HIGH]);
    let step = 0.25;
    let samples = local.samples(step);
    assert!(samples.len() <= local.count(step), "{} of {}", samples.len(), local.count(step));
    assert!(local.count(step) < 2 * samples.len());
    for i in 0..=40 {
        for k in 0..=16 {
            let p = [0.25 * f64::from(i), 1.0, 0.25 * f64::from(k)];
            let nearest = samples.iter().map(|&q| vec3::distance(p, q)).fold(f64::INFINITY, f64::min);
            assert!(nearest < step, "{p:?} {nearest}");
        }
    }
}

/// A roof of two slopes over the ridge x = 0, z = -|x| / 2, in triangles of side `h`.
fn roof(h: f64, n: i32) -> Mesh {
    // Rows do not meet the ridge.
    let z = |x: f64| -0.5 * x.abs();
    let place = |i: i32, k: i32| [(f64::from(i) - 0.37) * h, (f64::from(k) + 0.1 * f64::from(i)) * h];
    let vertices = (-n..=n).flat_map(|i| (-n..=n).map(move |k| place(i, k))).map(|[x, y]| [x, y, z(x)]).collect();
    let at = |i: i32, k: i32| ((i + n) * (2 * n + 1) + k + n) as u32;
    let squares = (-n..n).flat_map(|i| (-n..n).map(move |k| (i, k)));
    let triangles = squares
        .flat_map(|(i, k)| [[at(i, k), at(i + 1, k), at(i + 1, k + 1)], [at(i, k), at(i + 1, k + 1), at(i, k + 1)]])
        .collect();
    Mesh { vertices, triangles, ..Mesh::default() }
}

#[test]
fn mesh_edges_run_along_lines() {
    let mut mesh = roof(0.5, 12);
    let before = topology(&mesh).unwrap();
    let line = [vec![[[0.0, -4.0, 0.0], [0.0, 4.0, 0.0]]], vec![[[-3.0, -3.0, -1.5], [-3.0, 3.0, -1.5]]]];
    let on_lines = imprint(&mut mesh, &line, 1.0, |_| false);
    let after = topology(&mesh).unwrap();
    assert!(on_lines > 30, "{on_lines}");
    assert_eq!((after.nonmanifold_edges, after.inconsistent_edges, after.degenerate_triangles), (0, 0, 0));
    assert_eq!((after.boundary_loops, after.components.len()), (before.boundary_loops, before.components.len()));
    let tree = TriangleTree::new(&mesh);
    for i in 0..=100 {
        let y = -3.5 + 0.07 * f64::from(i);
        let far = tree.closest([0.0, y, 0.0]).unwrap().distance_squared.sqrt();
        assert!(far < 1e-12, "{y} {far}");
    }
    assert!(mesh.triangles.iter().all(|t| {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        vec3::cross(vec3::sub(b, a), vec3::sub(c, a))[2] > 0.0
    }));
}

#[test]
fn lines_far_from_the_mesh_leave_it_alone() {
    let mut mesh = Scene::new(SceneKind::Box, 0).truth;
    let before = mesh.clone();
    assert_eq!(imprint(&mut mesh, &[vec![[[0.1, 0.1, 3.0], [0.9, 0.1, 3.0]]]], 0.1, |_| false), 0);
    assert_eq!(mesh, before);
}
