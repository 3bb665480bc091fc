//! Meshes that are made or given, checked against brute force and against what is known of boxes.

mod check;
mod clip;
mod delaunay;
mod locate;
mod made;
mod predicates;

use super::SimplicialMesh;
use crate::sample::Chance;

/// Random positions in the unit box.
fn random<const D: usize>(seed: u64, count: usize) -> Vec<[f64; D]> {
    let mut chance = Chance::new(seed, 91, 0);
    (0..count).map(|_| std::array::from_fn(|_| chance.uniform())).collect()
}

/// The corners of the unit box, and random positions in it.
fn filled_box<const D: usize>(seed: u64, count: usize) -> Vec<[f64; D]> {
    let corner = |bits: usize| std::array::from_fn(|a| (bits >> a & 1) as f64);
    (0..1 << D).map(corner).chain(random(seed, count)).collect()
}

/// Points of a cubic grid, each coordinate a multiple of `side` as rounding has it.
fn grid<const D: usize>(points: usize, side: f64) -> Vec<[f64; D]> {
    let count = points.pow(D as u32);
    (0..count).map(|i| std::array::from_fn(|a| (i / points.pow(a as u32) % points) as f64 * side)).collect()
}

/// A position turned away from the axes.
fn turned([x, y, z]: [f64; 3]) -> [f64; 3] {
    let (sin, cos) = 0.3_f64.sin_cos();
    let [x, y] = [x * cos - y * sin, x * sin + y * cos];
    [x, y * cos - z * sin, y * sin + z * cos]
}

fn volume<const D: usize>(mesh: &SimplicialMesh<D>) -> f64 {
    (0..mesh.len()).map(|s| mesh.volume(s)).sum()
}

/// Asserts that a mesh is positively oriented and conforming.
fn assert_valid<const D: usize>(mesh: &SimplicialMesh<D>) {
    let mut corners = mesh.corners.clone();
    assert_eq!(super::check::orient(&mesh.vertices, &mut corners), Ok(()));
    assert_eq!(corners, mesh.corners, "simplices are positively oriented");
    assert_eq!(super::check::conforming(mesh), Ok(()));
}
