//! Energies of smoothness: what F may not do where data say nothing.
//!
//! | type | integral over the domain | leaves free |
//! |---|---|---|
//! | [`Order0`] | none (the paper) | everything |
//! | [`Order1`] | \|grad F\|^2 | constants |
//! | [`Order2`] | \|Hess F\|^2 | linear functions |
//!
//! # Order 2 on simplices
//! Polynomials on simplices have kinks across faces, where second derivatives are infinite. A kink counts by the square of the jump of the
//! normal derivative: a face adds the integral of jump^2 over it, divided by the mean height of the two simplices over it (the penalty of the
//! C0 interior penalty methods, with the factor at which second derivatives along the axes of a regular lattice count exactly for linear F). So linear functions, and only these, are free on any mesh whose simplices are joined through faces. On P1 the
//! integral inside simplices is zero and the kinks are all there is: equivalent to the integral of |Hess F|^2 up to factors that
//! depend on the shapes of the simplices, not equal to it. Flat triangles count many times: on a Delaunay mesh with flat ones at its rim, x^2 had 23
//! times its integral. On P2 a function that is quadratic over the whole domain has exactly its integral.
//!
//! # Source
//! S. C. Brenner and L.-Y. Sung, C0 interior penalty methods for fourth order elliptic boundary value problems, J. Sci. Comput. 22,
//! 2005, for the penalty; the scaling is ours.

use crate::basis::quadrature::{Node, rule};
use crate::basis::{Basis, Derivatives, Terms};
use crate::domain::Place;

/// Takes squares of linear functions of the coefficients: the weight, not negative, then the coefficients' indices, all different, and their factors.
pub type Squares<'a> = dyn FnMut(f64, &[u32], &[f64]) + 'a;

/// An energy of smoothness, with its weight.
pub trait Smoothness<const D: usize>: Sync {
    /// Gives `add` each square that the energy is a sum of.
    fn squares(&self, basis: &dyn Basis<D>, add: &mut Squares<'_>);

    /// The weight in front of the integral.
    fn weight(&self) -> f64;
}

/// No smoothness: the paper.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Order0;

/// Integral of |grad F|^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order1 {
    /// In front of the integral.
    pub weight: f64,
}

/// Integral of |Hess F|^2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Order2 {
    /// In front of the integral.
    pub weight: f64,
}

impl<const D: usize> Smoothness<D> for Order0 {
    fn squares(&self, _basis: &dyn Basis<D>, _add: &mut Squares<'_>) {}

    fn weight(&self) -> f64 {
        0.0
    }
}

impl<const D: usize> Smoothness<D> for Order1 {
    fn squares(&self, basis: &dyn Basis<D>, add: &mut Squares<'_>) {
        // The gradient of a polynomial has one degree less.
        let degree = basis.degree().map_or(SMOOTHNESS_DEGREE, |d| 2 * d.saturating_sub(1));
        let mut values = Vec::new();
        for_each_place(basis, degree, Derivatives::First, |volume, terms| {
            for a in 0..D {
                values.clear();
                values.extend(terms.gradients.iter().map(|g| g[a]));
                add(self.weight * volume, &terms.indices, &values);
            }
        });
    }

    fn weight(&self) -> f64 {
        self.weight
    }
}

impl<const D: usize> Smoothness<D> for Order2 {
    fn squares(&self, basis: &dyn Basis<D>, add: &mut Squares<'_>) {
        let degree = basis.degree().map_or(SMOOTHNESS_DEGREE, |d| 2 * d.saturating_sub(2));
        let mut values = Vec::new();
        if basis.degree() != Some(1) {
            for_each_place(basis, degree, Derivatives::Second, |volume, terms| {
                for a in 0..D {
                    for b in 0..=a {
                        values.clear();
                        values.extend(terms.hessians.iter().map(|h| h[a][b]));
                        // Mixed derivatives are there twice.
                        add(self.weight * volume * if a == b { 1.0 } else { 2.0 }, &terms.indices, &values);
                    }
                }
            });
        }
        if let Some(degree) = basis.degree() {
            kinks(basis, 2 * degree.saturating_sub(1), &mut |weight, indices, values| {
                add(self.weight * weight, indices, values)
            });
        }
    }

    fn weight(&self) -> f64 {
        self.weight
    }
}

/// The degree of the rules for functions that are no polynomials. Their cells should be no longer than half a width.
const SMOOTHNESS_DEGREE: usize = 2;

/// Calls `visit` with the share of the volume and the terms at each place of a rule of a degree, over all simplices.
fn for_each_place<const D: usize>(
    basis: &dyn Basis<D>,
    degree: usize,
    derivatives: Derivatives,
    mut visit: impl FnMut(f64, &Terms<D>),
) {
    let domain = basis.domain();
    let rule: Vec<Node<D>> = rule(degree);
    let mut terms = Terms::new();
    for simplex in 0..domain.len() {
        for node in &rule {
            let mut barycentric = [0.0; 4];
            barycentric[0] = 1.0 - node.coordinates.iter().sum::<f64>();
            barycentric[1..=D].copy_from_slice(&node.coordinates);
            let position = domain.position(simplex, &barycentric);
            basis.evaluate(&Place { simplex, barycentric, position }, derivatives, &mut terms);
            visit(node.weight * domain.volume(simplex), &terms);
        }
    }
}

/// The squares of the jumps of the normal derivative across all faces.
fn kinks<const D: usize>(basis: &dyn Basis<D>, degree: usize, add: &mut Squares<'_>) {
    let domain = basis.domain();
    let rule = face_rule::<D>(degree);
    let (mut own, mut other) = (Terms::new(), Terms::new());
    let (mut indices, mut values) = (Vec::new(), Vec::new());
    for simplex in 0..domain.len() {
        for opposite in 0..=D {
            let Some(neighbor) = domain.neighbor(simplex, opposite).filter(|&n| n > simplex) else { continue };
            // The barycentric coordinate of the opposite corner rises by one over the height, along the inner normal.
            let steepest = domain.barycentric_gradients(simplex)[opposite];
            let slope = steepest.iter().map(|c| c * c).sum::<f64>().sqrt();
            let normal = steepest.map(|c| c / slope);
            let face = D as f64 * domain.volume(simplex) * slope;
            let mean_height = D as f64 * 0.5 * (domain.volume(simplex) + domain.volume(neighbor)) / face;
            let weight = face / mean_height;
            for (on_face, share) in &rule {
                let mut barycentric = [0.0; 4];
                for (c, &b) in (0..=D).filter(|&c| c != opposite).zip(on_face) {
                    barycentric[c] = b;
                }
                let position = domain.position(simplex, &barycentric);
                basis.evaluate(&Place { simplex, barycentric, position }, Derivatives::First, &mut own);
                let across = domain.barycentric(neighbor, position);
                let place = Place { simplex: neighbor, barycentric: across, position };
                basis.evaluate(&place, Derivatives::First, &mut other);
                let along = |g: &[f64; D]| (0..D).map(|a| g[a] * normal[a]).sum::<f64>();
                indices.clear();
                values.clear();
                indices.extend_from_slice(&own.indices);
                values.extend(own.gradients.iter().map(along));
                for (&j, g) in other.indices.iter().zip(&other.gradients) {
                    match indices.iter().position(|&i| i == j) {
                        Some(at) => values[at] -= along(g),
                        None => {
                            indices.push(j);
                            values.push(-along(g));
                        }
                    }
                }
                add(weight * share, &indices, &values);
            }
        }
    }
}

/// A rule on a face of a D-simplex: barycentric coordinates of its D corners, and shares of its measure.
fn face_rule<const D: usize>(degree: usize) -> Vec<([f64; 3], f64)> {
    let barycentric = |coordinates: &[f64]| {
        let mut all = [0.0; 3];
        all[0] = 1.0 - coordinates.iter().sum::<f64>();
        all[1..=coordinates.len()].copy_from_slice(coordinates);
        all
    };
    if D == 2 {
        rule::<1>(degree).iter().map(|n| (barycentric(&n.coordinates), n.weight)).collect()
    } else {
        rule::<2>(degree).iter().map(|n| (barycentric(&n.coordinates), n.weight)).collect()
    }
}
