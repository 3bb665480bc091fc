//! The gradient of F at the samples, as linear functions of the coefficients.

use crate::basis::{Basis, Derivatives, Terms};
use crate::domain::SimplicialMesh;
use crate::fit::Gradient;

use super::data::Sample;

/// For one sample the functions that its gradient depends on, and the gradient's derivative by each coefficient.
#[derive(Debug, Clone, Default)]
pub(super) struct GradientRow<const D: usize> {
    pub(super) indices: Vec<u32>,
    pub(super) gradients: Vec<[f64; D]>,
}

impl<const D: usize> GradientRow<D> {
    /// The gradient of F.
    pub(super) fn of(&self, coefficients: &[f64]) -> [f64; D] {
        let mut gradient = [0.0; D];
        for (&j, g) in self.indices.iter().zip(&self.gradients) {
            for a in 0..D {
                gradient[a] += coefficients[j as usize] * g[a];
            }
        }
        gradient
    }
}

impl<const D: usize> GradientRow<D> {
    /// Adds weight * g to the gradient's derivative by coefficient `j`.
    fn add(&mut self, j: u32, weight: f64, g: &[f64; D]) {
        let at = self.indices.iter().position(|&i| i == j).unwrap_or_else(|| {
            self.indices.push(j);
            self.gradients.push([0.0; D]);
            self.indices.len() - 1
        });
        self.gradients[at].iter_mut().zip(g).for_each(|(sum, g)| *sum += weight * g);
    }
}

/// The rows of all samples.
pub(super) fn rows<const D: usize>(
    basis: &dyn Basis<D>,
    samples: &[Sample<D>],
    gradient: Gradient,
) -> Vec<GradientRow<D>> {
    let mut terms = Terms::new();
    let recovery = (gradient == Gradient::Recovered && basis.degree() == Some(1)).then(|| Recovery::new(basis));
    samples
        .iter()
        .map(|sample| match &recovery {
            Some(recovery) => recovery.at(sample, basis.domain()),
            None => {
                basis.evaluate(&sample.place, Derivatives::First, &mut terms);
                GradientRow { indices: terms.indices.clone(), gradients: terms.gradients.clone() }
            }
        })
        .collect()
}

/// For each vertex of a mesh the gradient that linear F has there, by least squares over the edges that leave it.
///
/// An edge weighs as much as the entry of the stiffness matrix that belongs to it, so that on a regular lattice, where only edges along the
/// axes have any, central differences come out. Linear functions are reproduced on any mesh.
struct Recovery<const D: usize> {
    rows: Vec<GradientRow<D>>,
}

impl<const D: usize> Recovery<D> {
    fn new(basis: &dyn Basis<D>) -> Self {
        let domain = basis.domain();
        let stiffness = edge_stiffness(domain);
        let mut around: Vec<Vec<(u32, f64)>> = vec![Vec::new(); domain.vertices().len()];
        for (&[a, b], &weight) in domain.edges().iter().zip(&stiffness) {
            around[a as usize].push((b, weight.abs()));
            around[b as usize].push((a, weight.abs()));
        }
        let rows = around.iter().enumerate().map(|(v, around)| vertex_row(domain, v as u32, around)).collect();
        Self { rows }
    }

    /// The gradients of the corners, interpolated to the sample.
    fn at(&self, sample: &Sample<D>, domain: &SimplicialMesh<D>) -> GradientRow<D> {
        let mut row = GradientRow { indices: Vec::new(), gradients: Vec::<[f64; D]>::new() };
        for (&corner, weight) in domain.simplex(sample.place.simplex).iter().zip(sample.place.barycentric) {
            let vertex = &self.rows[corner as usize];
            for (&j, g) in vertex.indices.iter().zip(&vertex.gradients) {
                row.add(j, weight, g);
            }
        }
        row
    }
}

/// The off-diagonal entry of the stiffness matrix of P1 for each edge.
fn edge_stiffness<const D: usize>(domain: &SimplicialMesh<D>) -> Vec<f64> {
    let mut stiffness = vec![0.0; domain.edges().len()];
    for simplex in 0..domain.len() {
        let gradients = domain.barycentric_gradients(simplex);
        let mut edges = domain.edges_of(simplex).iter();
        for i in 0..=D {
            for j in i + 1..=D {
                let product: f64 = (0..D).map(|a| gradients[i][a] * gradients[j][a]).sum();
                let edge = *edges.next().expect("a simplex has an edge for each pair of corners");
                stiffness[edge as usize] += domain.volume(simplex) * product;
            }
        }
    }
    stiffness
}

/// Weights of edges below this share of the largest count as zero.
const NO_WEIGHT: f64 = 1e-9;
/// Edges span space if no diagonal entry of the Cholesky factor of their matrix, at trace 1, is smaller.
const SPANS: f64 = 1e-4;

/// The least-squares gradient at a vertex. Where the weighted edges do not span space well, all edges weigh the same; where these do
/// not, either, as in very flat simplices, the mean of the simplices' gradients by volume serves.
fn vertex_row<const D: usize>(domain: &SimplicialMesh<D>, vertex: u32, around: &[(u32, f64)]) -> GradientRow<D> {
    let most = around.iter().fold(0.0_f64, |m, e| m.max(e.1));
    let weighted: Vec<(u32, f64)> = around.iter().copied().filter(|e| e.1 > NO_WEIGHT * most).collect();
    let even: Vec<(u32, f64)> = around.iter().map(|e| (e.0, 1.0)).collect();
    least_squares(domain, vertex, &weighted)
        .or_else(|| least_squares(domain, vertex, &even))
        .unwrap_or_else(|| mean_of_simplices(domain, vertex))
}

/// The mean of the gradients of the simplices around a vertex, by volume. Walks over all simplices: a last resort.
fn mean_of_simplices<const D: usize>(domain: &SimplicialMesh<D>, vertex: u32) -> GradientRow<D> {
    let around: Vec<usize> = (0..domain.len()).filter(|&s| domain.simplex(s).contains(&vertex)).collect();
    let volume: f64 = around.iter().map(|&s| domain.volume(s)).sum();
    let mut row = GradientRow { indices: Vec::new(), gradients: Vec::<[f64; D]>::new() };
    for simplex in around {
        let share = domain.volume(simplex) / volume;
        for (&corner, g) in domain.simplex(simplex).iter().zip(domain.barycentric_gradients(simplex)) {
            row.add(corner, share, g);
        }
    }
    row
}

fn least_squares<const D: usize>(
    domain: &SimplicialMesh<D>,
    vertex: u32,
    edges: &[(u32, f64)],
) -> Option<GradientRow<D>> {
    let position = |v: u32| domain.vertices()[v as usize];
    let offset = |v: u32| -> [f64; D] { std::array::from_fn(|a| position(v)[a] - position(vertex)[a]) };
    let mut normal = nalgebra::SMatrix::<f64, D, D>::zeros();
    for &(other, weight) in edges {
        let d = nalgebra::SVector::<f64, D>::from(offset(other));
        normal += weight * d * d.transpose();
    }
    let scale = normal.trace();
    let factor = (normal / scale).cholesky()?;
    if (0..D).any(|a| factor.l_dirty()[(a, a)] < SPANS) {
        return None;
    }
    let mut row = GradientRow { indices: vec![vertex], gradients: vec![[0.0; D]] };
    for &(other, weight) in edges {
        let d = nalgebra::SVector::<f64, D>::from(offset(other));
        let g: [f64; D] = (factor.solve(&d) * (weight / scale)).into();
        row.indices.push(other);
        row.gradients.push(g);
        row.gradients[0].iter_mut().zip(g).for_each(|(own, g)| *own -= g);
    }
    Some(row)
}
