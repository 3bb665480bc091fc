//! Where vertices go in their tetrahedra.

use super::{Function, coincident, field_of, replaced, sound, sphere, torus};
use crate::contour::{Candidates, ContourParams, LeastCurvature, Placement, contour, contour_with};
use crate::domain::tetrahedron_of;
use crate::field::LatticeField;
use crate::mesh::Mesh;
use crate::sample::Chance;
use crate::vec3;
use std::collections::BTreeSet;

fn params(least: LeastCurvature) -> ContourParams {
    ContourParams { placement: Placement::LeastCurvature(least) }
}

/// Only the signs of F.
fn marks_of(cells: f64, f: Function) -> LatticeField {
    let mut field = field_of(cells, f);
    field.values.iter_mut().for_each(|v| *v = v.signum());
    field
}

/// The number of different tetrahedra of the lattice that hold vertices.
fn tetrahedra_used(field: &LatticeField, mesh: &Mesh) -> usize {
    let used: BTreeSet<([i64; 3], usize)> = mesh
        .vertices
        .iter()
        .map(|v| {
            let node: [f64; 3] = std::array::from_fn(|a| (v[a] - field.lattice.origin[a]) / field.lattice.spacing);
            let cell = node.map(f64::floor);
            (cell.map(|c| c as i64), tetrahedron_of(std::array::from_fn(|a| (node[a] - cell[a]) as f32)))
        })
        .collect();
    used.len()
}

/// The root of the mean square of the angle between triangles and the gradient of f, by area.
fn normal_error(mesh: &Mesh, f: Function) -> f64 {
    let (mut sum, mut area) = (0.0, 0.0);
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
        let n = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
        let middle = vec3::scale(vec3::add(a, vec3::add(b, c)), 1.0 / 3.0);
        let gradient: [f64; 3] = std::array::from_fn(|axis| {
            let mut ends = [middle; 2];
            ends[0][axis] -= 1e-5;
            ends[1][axis] += 1e-5;
            f(ends[1]) - f(ends[0])
        });
        let angle = vec3::norm(vec3::cross(n, gradient)).atan2(vec3::dot(n, gradient));
        sum += vec3::norm(n) * angle * angle;
        area += vec3::norm(n);
    }
    (sum / area).sqrt()
}

#[test]
fn marks_make_smoother_surfaces_that_are_no_farther_from_the_truth() {
    for (what, f) in [("sphere", sphere as Function), ("torus", torus)] {
        let field = marks_of(20.0, f);
        let (terraces, _) = contour(&field, |_| true);
        // Halvings make marks smoother still, but only with more cells than these no farther from the truth.
        let least = LeastCurvature { halvings: 0, ..LeastCurvature::default() };
        let (smooth, report) = contour_with(&field, &params(least), |_| true);
        assert!(sound(&smooth, what).closed);
        assert_eq!(tetrahedra_used(&field, &smooth), report.active_tetrahedra, "one vertex in each tetrahedron");
        // The terraces of marks tilt triangles by some 31 degrees.
        let (before, after) = (normal_error(&terraces, f), normal_error(&smooth, f));
        assert!(after < 0.8 * before, "{what}: {before} to {after}");
        let distance =
            |mesh: &Mesh| mesh.vertices.iter().map(|&v| f(v).abs()).sum::<f64>() / mesh.vertices.len() as f64;
        assert!(distance(&smooth) < distance(&terraces), "{what}");
    }
}

#[test]
fn the_same_on_any_number_of_threads() {
    let field = marks_of(16.0, torus);
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let least = LeastCurvature { halvings: 2, ..LeastCurvature::default() };
        pool.install(|| contour_with(&field, &params(least), |_| true))
    };
    let (one, three) = (run(1), run(3));
    assert_eq!(one.0.vertices, three.0.vertices);
    assert_eq!(one, three);
}

#[test]
fn random_values_stay_a_manifold_wherever_vertices_go() {
    let mut field = field_of(12.0, sphere);
    for (seed, candidates) in [(0, Candidates::Tetrahedron), (1, Candidates::ZeroSet)] {
        let mut chance = Chance::new(seed, 107, 0);
        replaced(&mut field, || (chance.normal() * 10.0_f64.powf(6.0 * chance.normal())) as f32);
        let least = LeastCurvature { candidates, divisions: 5, ..LeastCurvature::default() };
        let (mesh, report) = contour_with(&field, &params(least), |_| true);
        assert!(sound(&mesh, "random").closed);
        assert_eq!(coincident(&mesh), 0);
        assert_eq!(tetrahedra_used(&field, &mesh), report.active_tetrahedra);
    }
}

#[test]
fn a_plane_is_met_by_candidates_on_the_zero_set() {
    let normal = vec3::normalized([0.31, -0.52, 0.8]).unwrap();
    let field = field_of(16.0, |p| vec3::dot(normal, p) - 0.0123);
    let least = LeastCurvature { candidates: Candidates::ZeroSet, ..LeastCurvature::default() };
    let (mesh, _) = contour_with(&field, &params(least), |_| true);
    // Crossings are kept a hundredth of an edge (at most sqrt 3 cells) from its ends.
    let far = mesh.vertices.iter().map(|&v| (vec3::dot(normal, v) - 0.0123).abs()).fold(0.0, f64::max);
    assert!(far <= 0.018 * field.lattice.spacing, "{far}");
}

#[test]
fn sweeps_are_limited_and_halvings_end_movement() {
    let field = marks_of(12.0, sphere);
    let least = LeastCurvature { most_sweeps: 2, halvings: 6, ..LeastCurvature::default() };
    let (_, report) = contour_with(&field, &params(least), |_| true);
    let placement = report.placement.unwrap();
    assert_eq!((placement.movable, placement.sweeps.len()), (report.active_tetrahedra, 8));
    for (k, sweep) in placement.sweeps[2..].iter().enumerate() {
        // Three steps between neighbouring candidates, each a part of an edge.
        assert!(sweep.largest_rel <= 3.0 / 9.0 * 0.5_f64.powi(k as i32 + 1) + 1e-12, "{sweep:?}");
    }
    // What cannot be is clamped.
    let least = LeastCurvature { divisions: 0, most_sweeps: 0, halvings: u32::MAX, ..LeastCurvature::default() };
    let (mesh, report) = contour_with(&field, &params(least), |_| true);
    assert!(sound(&mesh, "clamped").closed);
    assert_eq!(report.placement.unwrap().sweeps.len(), 25);
}
