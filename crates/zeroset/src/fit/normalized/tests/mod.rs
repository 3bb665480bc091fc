//! The paper's examples, and what the mathematics promises.

mod convergence;
mod corner;
mod data;
mod diagnosis;
mod energy;
mod equivariance;
mod errors;
mod normalization;
mod paper;
mod radial;

use std::collections::BTreeMap;

use crate::basis::{Basis, P1, P2};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Data, NormalizedFit};
use crate::sample::Chance;

/// Random positions in the cube between two numbers.
fn random<const D: usize>(seed: u64, count: usize, low: f64, high: f64) -> Vec<[f64; D]> {
    let mut chance = Chance::new(seed, 306, D);
    (0..count).map(|_| std::array::from_fn(|_| chance.between(low, high))).collect()
}

/// The corners of the unit cube, and random sites in it, so few that no simplex is very flat.
fn sites<const D: usize>(seed: u64, count: usize) -> Vec<[f64; D]> {
    let corner = |bits: usize| std::array::from_fn(|a| (bits >> a & 1) as f64);
    (0..1 << D).map(corner).chain(random(seed, count, 0.05, 0.95)).collect()
}

/// Linear and quadratic functions on the unit cube.
fn bases<const D: usize>(mesh: &SimplicialMesh<D>) -> [(usize, Box<dyn Basis<D>>); 2] {
    [(1, Box::new(P1::new(mesh.clone()))), (2, Box::new(P2::new(mesh.clone())))]
}

/// Regular and irregular meshes of the unit square.
fn meshes_2d() -> Vec<SimplicialMesh<2>> {
    vec![
        SimplicialMesh::lattice([0.0; 2], [1.0; 2], [5, 4]).unwrap(),
        SimplicialMesh::<2>::delaunay(&sites(1, 30)).unwrap(),
    ]
}

/// Regular and irregular meshes of the unit cube.
fn meshes_3d() -> Vec<SimplicialMesh<3>> {
    vec![
        SimplicialMesh::lattice([0.0; 3], [1.0; 3], [3, 4, 3]).unwrap(),
        SimplicialMesh::<3>::delaunay(&sites(2, 20)).unwrap(),
    ]
}

/// The coefficients of a function that the basis interpolates.
fn interpolated<const D: usize>(basis: &dyn Basis<D>, f: impl Fn([f64; D]) -> f64) -> Vec<f64> {
    (0..basis.len()).map(|j| f(basis.node(j).expect("the function has a node"))).collect()
}

/// The matrix of E, by row and column of the lower triangle.
fn energy<const D: usize>(fit: NormalizedFit<'_, D>) -> BTreeMap<(usize, usize), f64> {
    fit.energy_matrix().unwrap().into_iter().map(|(i, j, value)| ((i, j), value)).collect()
}

/// The Gram matrix of data.
fn gram<const D: usize>(basis: &dyn Basis<D>, data: &Data<D>) -> BTreeMap<(usize, usize), f64> {
    energy(NormalizedFit::new(basis, data))
}

/// F'AF, A by its lower triangle.
fn quadratic_form(matrix: &BTreeMap<(usize, usize), f64>, f: &[f64]) -> f64 {
    matrix.iter().map(|(&(i, j), value)| value * f[i] * f[j] * if i == j { 1.0 } else { 2.0 }).sum()
}

/// The largest difference of two matrices, relative to the largest entry.
fn difference(a: &BTreeMap<(usize, usize), f64>, b: &BTreeMap<(usize, usize), f64>) -> f64 {
    let at = |m: &BTreeMap<(usize, usize), f64>, k| m.get(k).copied().unwrap_or(0.0);
    let largest = a.values().fold(0.0_f64, |m, v| m.max(v.abs()));
    a.keys().chain(b.keys()).map(|k| (at(a, k) - at(b, k)).abs()).fold(0.0, f64::max) / largest
}

/// Points near an ellipse in the unit square.
fn curve(count: usize) -> Vec<[f64; 2]> {
    let mut chance = Chance::new(7, 306, 2);
    let on = |angle: f64| [0.5 + 0.35 * angle.cos(), 0.48 + 0.27 * angle.sin()];
    (0..count).map(|_| on(chance.between(0.0, std::f64::consts::TAU)).map(|c| c + 0.005 * chance.normal())).collect()
}

/// Points near an ellipsoid in the unit cube.
fn surface(count: usize) -> Vec<[f64; 3]> {
    let mut chance = Chance::new(8, 306, 3);
    (0..count)
        .map(|_| {
            let [x, y, z] = chance.direction();
            [0.5 + 0.36 * x, 0.48 + 0.28 * y, 0.52 + 0.3 * z].map(|c| c + 0.005 * chance.normal())
        })
        .collect()
}
