//! Smallest eigenpairs of a symmetric pencil, A x = lambda M x, in three ways.
//!
//! # What
//! The pairs of smallest lambda = x'Ax / x'Mx, with A and M positive semidefinite. Without M it is the identity.
//!
//! | way | for | how |
//! |---|---|---|
//! | [`Solver::Dense`] | small or dense matrices | all eigenpairs of M in a basis that makes A + tau M the identity |
//! | [`Solver::ShiftInvert`] | sparse matrices in the plane, moderate ones in space | block iteration with the sparse Cholesky factor of A + tau M |
//! | [`Solver::Lobpcg`] | sparse matrices whose factor would not fit | the same iteration; systems solved roughly by conjugate gradients |
//!
//! # How
//! All three ask for the largest theta = 1 / (lambda + tau) in M x = theta (A + tau M) x. There the kernel of M is harmless (theta = 0), and
//! a singular A is no obstacle. The value itself is then taken from the vector, x'Ax / x'Mx, whose error is the square of the
//! vector's.
//!
//! # Guaranteed
//! Equal bits on any number of threads.
//!
//! # Source
//! The shift and the block method: A. V. Knyazev, SIAM J. Sci. Comput. 23, 2001; see [`lobpcg`].

mod dense;
pub(crate) mod lobpcg;
mod matrix;
mod sparse;

#[cfg(test)]
mod tests;

pub(crate) use matrix::{Factor, Matrix, MatrixBuilder};

use crate::monitor::{Cancelled, Monitor};

/// How eigenpairs are computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Solver {
    /// Dense up to 400 unknowns and for dense matrices; then by a sparse factor, and beyond 1,000,000 unknowns in the plane or 200,000 in
    /// space by LOBPCG.
    #[default]
    Auto,
    /// All eigenpairs of dense matrices: exact, cubic in the unknowns, of which there may be 10,000.
    Dense,
    /// Block iteration with a sparse Cholesky factor.
    ShiftInvert,
    /// Block iteration with conjugate gradients: no factor is stored. Slow with smoothness of order 2, whose systems converge slowly.
    Lobpcg,
}

/// Unknowns up to which [`Solver::Auto`] takes the dense way.
const DENSE: usize = 400;
/// Unknowns from which [`Solver::Auto`] stores no factor, in the plane and in space, where factors fill in. A few gigabytes are then
/// needed for it: 3.7 kB for each quadratic function in the plane with smoothness of order 2.
const NO_FACTOR: [usize; 2] = [1_000_000, 200_000];
/// Most unknowns of a dense matrix: it then takes 800 MB, and the solver several times as much.
pub(crate) const MOST_DENSE: usize = 10_000;

/// A x = lambda M x.
#[derive(Clone, Copy)]
pub(crate) struct Pencil<'a> {
    /// A.
    pub(crate) energy: &'a Matrix,
    /// M; `None` is the identity.
    pub(crate) mass: Option<&'a Matrix>,
    /// 2 or 3: tells how much the factor of a sparse matrix fills in.
    pub(crate) dimension: usize,
}

/// The low end of a spectrum.
#[derive(Debug, Clone)]
pub(crate) struct Spectrum {
    /// Ascending. Fewer than asked for if M bears no more.
    pub(crate) values: Vec<f64>,
    /// With x'Mx = 1.
    pub(crate) vectors: Vec<Vec<f64>>,
    /// Whether the iteration came to rest, and its values are those of the vectors.
    pub(crate) at_rest: bool,
}

/// Eigenpairs that were not found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum EigenError {
    /// The monitor asked to stop.
    Cancelled(Cancelled),
    /// The dense matrix would be too large.
    TooLarge {
        /// Its unknowns.
        unknowns: usize,
    },
    /// An entry is not finite, or a dense iteration failed.
    NotFinite,
}

impl From<Cancelled> for EigenError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl Pencil<'_> {
    /// The `count` pairs of smallest value.
    ///
    /// # Errors
    /// If an entry is not finite, a dense matrix would be too large, or the monitor asks to stop.
    pub(crate) fn smallest(&self, count: usize, solver: Solver, monitor: &dyn Monitor) -> Result<Spectrum, EigenError> {
        if !self.energy.is_finite() || !self.mass.is_none_or(Matrix::is_finite) {
            return Err(EigenError::NotFinite);
        }
        let unknowns = self.energy.len();
        let (vectors, at_rest) = match self.resolved(solver) {
            Solver::Dense if unknowns > MOST_DENSE => return Err(EigenError::TooLarge { unknowns }),
            Solver::Dense => (dense::smallest(self, count).ok_or(EigenError::NotFinite)?, true),
            Solver::Lobpcg => sparse::smallest(self, count, sparse::Preconditioner::Rough, monitor)?,
            _ => sparse::smallest(self, count, sparse::Preconditioner::Exact, monitor)?,
        };
        let mut pairs: Vec<(f64, Vec<f64>)> = vectors.into_iter().filter_map(|x| self.normalized(x)).collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (values, vectors) = pairs.into_iter().unzip();
        Ok(Spectrum { values, vectors, at_rest })
    }

    fn resolved(&self, solver: Solver) -> Solver {
        let n = self.energy.len();
        match solver {
            Solver::Auto if n <= DENSE || self.energy.is_dense() => Solver::Dense,
            Solver::Auto if n > NO_FACTOR[usize::from(self.dimension > 2)] => Solver::Lobpcg,
            Solver::Auto => Solver::ShiftInvert,
            chosen => chosen,
        }
    }

    /// M x.
    fn mass_times(&self, x: &[f64], y: &mut [f64]) {
        match self.mass {
            Some(mass) => mass.multiply(x, y),
            None => y.copy_from_slice(x),
        }
    }

    /// The value of a vector, and the vector at x'Mx = 1. `None` if x'Mx is zero.
    fn normalized(&self, mut x: Vec<f64>) -> Option<(f64, Vec<f64>)> {
        let mut y = vec![0.0; x.len()];
        self.mass_times(&x, &mut y);
        let mass = dot(&x, &y);
        if mass <= 0.0 || !mass.is_finite() {
            return None;
        }
        let scale = 1.0 / mass.sqrt();
        x.iter_mut().for_each(|x| *x *= scale);
        self.energy.multiply(&x, &mut y);
        let value = dot(&x, &y);
        value.is_finite().then_some((value.max(0.0), x))
    }

    /// The weight of M that makes it `share` of A by the traces.
    pub(crate) fn shift(&self, share: f64) -> f64 {
        let trace = |m: &Matrix| m.diagonal().iter().sum::<f64>();
        let mass = self.mass.map_or(self.energy.len() as f64, trace);
        let energy = trace(self.energy);
        if mass > 0.0 && energy > 0.0 { share * energy / mass } else { 1.0 }
    }

    /// A + tau M.
    fn shifted(&self, tau: f64) -> Matrix {
        match self.mass {
            Some(mass) => self.energy.plus(tau, mass),
            None => self.energy.plus_diagonal(tau),
        }
    }
}

/// Eight partial sums, so that the processor need not wait for each addition; their order is fixed.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (a, rest_a) = a.as_chunks::<8>();
    let (b, rest_b) = b.as_chunks::<8>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            lanes[k] += a[k] * b[k];
        }
    }
    lanes.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}
