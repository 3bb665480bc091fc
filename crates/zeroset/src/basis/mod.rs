//! What F is made of: functions B_j over a domain, with F = sum_j F_j B_j.
//!
//! # What
//! [`P1`] and [`P2`] are polynomial on each simplex of a mesh and continuous over it; [`Radial`] are functions of the
//! distance to centres. All give values, gradients and second derivatives through one trait, [`Basis`]; a sum of them is an
//! [`Expansion`].

pub mod quadrature;
mod radial;
mod simplicial;

#[cfg(test)]
mod tests;

pub use radial::{Kernel, Radial, RadialError, Tail, farthest_points};
pub use simplicial::{P1, P2};

use crate::domain::{Place, SimplicialMesh};

/// How many derivatives are asked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Derivatives {
    /// Values only.
    None,
    /// Values and gradients.
    First,
    /// Values, gradients and second derivatives.
    Second,
}

/// The functions that do not vanish at a place, with what was asked for. All lists are parallel; those not asked for are empty.
#[derive(Debug, Clone, Default)]
pub struct Terms<const D: usize> {
    /// Which functions.
    pub indices: Vec<u32>,
    /// B_j.
    pub values: Vec<f64>,
    /// grad B_j.
    pub gradients: Vec<[f64; D]>,
    /// The matrix of second derivatives of B_j.
    pub hessians: Vec<[[f64; D]; D]>,
}

impl<const D: usize> Terms<D> {
    /// No terms.
    #[must_use]
    pub fn new() -> Self {
        Self { indices: Vec::new(), values: Vec::new(), gradients: Vec::new(), hessians: Vec::new() }
    }

    fn clear(&mut self) {
        self.indices.clear();
        self.values.clear();
        self.gradients.clear();
        self.hessians.clear();
    }
}

/// Functions over a domain.
pub trait Basis<const D: usize>: Sync {
    /// Where the functions are known. It also gives the cells of all integrals.
    fn domain(&self) -> &SimplicialMesh<D>;

    /// Number of functions.
    fn len(&self) -> usize;

    /// Whether there are none.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Where function `j` sits: its node or centre. `None` for functions that sit nowhere, such as constants.
    fn node(&self, j: usize) -> Option<[f64; D]>;

    /// The degree of the functions where they are polynomials on each simplex.
    fn degree(&self) -> Option<usize>;

    /// Whether each function vanishes but on a few simplices, so that matrices are sparse.
    fn is_local(&self) -> bool;

    /// The functions at a place. `terms` is emptied first.
    fn evaluate(&self, place: &Place<D>, derivatives: Derivatives, terms: &mut Terms<D>);

    /// Where F of given coefficients lies on a simplex.
    fn span(&self, simplex: usize, coefficients: &[f64]) -> Span;
}

/// Where F lies on a part of the domain. Sound but for rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Span {
    /// F is not less than this.
    pub low: f64,
    /// F is not greater than this.
    pub high: f64,
    /// The gradient of F is not longer than this.
    pub slope: f64,
}

impl Span {
    /// That of no part.
    pub const EMPTY: Self = Self { low: f64::INFINITY, high: f64::NEG_INFINITY, slope: 0.0 };

    /// That of two parts.
    #[must_use]
    pub fn hull(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), slope: self.slope.max(other.slope) }
    }

    fn with_value(self, value: f64) -> Self {
        Self { low: self.low.min(value), high: self.high.max(value), ..self }
    }
}

/// The length of a vector.
fn length<const D: usize>(v: [f64; D]) -> f64 {
    v.iter().map(|c| c * c).sum::<f64>().sqrt()
}

/// A function with a smaller value in the middle of a simplex counts as zero there.
const VANISHED: f64 = 1e-6;

/// F = sum_j F_j B_j.
#[derive(Clone, Copy)]
pub struct Expansion<'a, const D: usize> {
    basis: &'a dyn Basis<D>,
    coefficients: &'a [f64],
    undefined: &'a [bool],
}

impl<'a, const D: usize> Expansion<'a, D> {
    /// F of given coefficients, one for each function.
    ///
    /// # Panics
    /// If their number differs from that of the functions.
    #[must_use]
    pub fn new(basis: &'a dyn Basis<D>, coefficients: &'a [f64]) -> Self {
        assert_eq!(basis.len(), coefficients.len(), "one coefficient is needed for each function");
        Self { basis, coefficients, undefined: &[] }
    }

    /// The same F, known only on simplices none of whose functions are marked.
    ///
    /// # Panics
    /// If the number of marks differs from that of the functions.
    #[must_use]
    pub fn without(self, undefined: &'a [bool]) -> Self {
        assert_eq!(self.basis.len(), undefined.len(), "one mark is needed for each function");
        Self { undefined, ..self }
    }

    /// The basis.
    #[must_use]
    pub fn basis(&self) -> &'a dyn Basis<D> {
        self.basis
    }

    /// Where F is known.
    #[must_use]
    pub fn domain(&self) -> &'a SimplicialMesh<D> {
        self.basis.domain()
    }

    /// Whether F is known on a simplex.
    #[must_use]
    pub fn is_defined(&self, simplex: usize) -> bool {
        if self.undefined.is_empty() {
            return true;
        }
        let mut terms = Terms::new();
        let middle = 1.0 / (D + 1) as f64;
        let barycentric = std::array::from_fn(|c| if c <= D { middle } else { 0.0 });
        let position = self.domain().position(simplex, &barycentric);
        self.basis.evaluate(&Place { simplex, barycentric, position }, Derivatives::None, &mut terms);
        // Functions that have all but vanished, such as radial ones far away, make nothing unknown.
        !terms.indices.iter().zip(&terms.values).any(|(&j, value)| self.undefined[j as usize] && value.abs() > VANISHED)
    }

    /// F at a position; `None` outside the domain and where F is not known.
    #[must_use]
    pub fn value(&self, position: [f64; D]) -> Option<f64> {
        let place = self.domain().locate(position)?;
        self.is_defined(place.simplex).then(|| self.value_at(&place))
    }

    /// The gradient of F at a position; `None` outside the domain and where F is not known. On a face it is that of the simplex of lowest
    /// index.
    #[must_use]
    pub fn gradient(&self, position: [f64; D]) -> Option<[f64; D]> {
        let place = self.domain().locate(position)?;
        self.is_defined(place.simplex).then(|| self.gradient_at(&place))
    }

    /// F at a place.
    #[must_use]
    pub fn value_at(&self, place: &Place<D>) -> f64 {
        let mut terms = Terms::new();
        self.basis.evaluate(place, Derivatives::None, &mut terms);
        terms.indices.iter().zip(&terms.values).map(|(&j, b)| self.coefficients[j as usize] * b).sum()
    }

    /// The gradient of F at a place.
    #[must_use]
    pub fn gradient_at(&self, place: &Place<D>) -> [f64; D] {
        let mut terms = Terms::new();
        self.basis.evaluate(place, Derivatives::First, &mut terms);
        let mut gradient = [0.0; D];
        for (&j, g) in terms.indices.iter().zip(&terms.gradients) {
            for a in 0..D {
                gradient[a] += self.coefficients[j as usize] * g[a];
            }
        }
        gradient
    }
}
