//! What keeps F from being zero.
//!
//! | type | N(F) | the minimiser of E / N | for |
//! |---|---|---|---|
//! | [`Coefficients`] | sum_j F_j^2 | smallest eigenvector of the matrix of E (the paper) | few cells, well filled with data |
//! | [`SquaredGradient`] | sum_i w_i \|grad F(P_i)\|^2 | a generalised eigenvector (Taubin 1991) | up to some thousand cells, with smoothness of order 2 |
//! | [`MeanGradient`] | (sum_i w_i \|grad F(P_i)\|)^2 | a fixed point, by inverse power steps | any size |

use super::gradient::{GradientRow, rows};
use super::{FitError, Problem};
use crate::fit::Gradient;
use crate::fit::eigen::{Matrix, MatrixBuilder, Pencil};
use crate::monitor::check;

/// The least E / N, and where it is taken.
#[derive(Debug, Clone)]
pub struct Minimum {
    /// One coefficient for each unknown.
    pub(in crate::fit) coefficients: Vec<f64>,
    /// The smallest values of E / N at its stationary points, ascending, where the normalisation has a spectrum.
    pub(super) spectrum: Vec<f64>,
    /// The size of E over that of N, by the traces of their matrices.
    pub(super) scale: f64,
    /// E / N before each step and at the end, where the normalisation takes steps.
    pub(super) steps: Vec<f64>,
    /// Whether the steps came to rest.
    pub(super) at_rest: bool,
    pub(super) rayleigh_quotient: f64,
}

/// A normalisation: N(F). The three types of this module are all there are: what a [`Problem`] holds is not public.
pub trait Normalization<const D: usize>: Sync {
    /// Finds F with the least E(F) / N(F).
    ///
    /// # Errors
    /// If N vanishes on all functions, the energy is not positive definite where it must be, or the monitor asks to stop.
    fn minimise(&self, problem: &Problem<'_, D>) -> Result<Minimum, FitError>;
}

/// Values of the spectrum that are computed.
const PAIRS: usize = 3;

/// N = sum_j F_j^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Coefficients;

impl<const D: usize> Normalization<D> for Coefficients {
    fn minimise(&self, problem: &Problem<'_, D>) -> Result<Minimum, FitError> {
        eigenvector(problem, None)
    }
}

/// N = sum_i w_i |grad F(P_i)|^2.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct SquaredGradient {
    /// The gradient of linear F. Functions of higher degree have only their own.
    pub gradient: Gradient,
}

impl Default for SquaredGradient {
    fn default() -> Self {
        Self { gradient: Gradient::Element }
    }
}

impl<const D: usize> Normalization<D> for SquaredGradient {
    fn minimise(&self, problem: &Problem<'_, D>) -> Result<Minimum, FitError> {
        let rows = problem.gradient_rows(self.gradient);
        eigenvector(problem, Some(&mass(problem, &rows)))
    }
}

/// N = (sum_i w_i |grad F(P_i)|)^2.
///
/// One step freezes the directions n_i = grad F(P_i) / |grad F(P_i)| and solves for the F of least E(F)/2 - sum_i w_i n_i . grad F(P_i). The
/// sum lies below N^(1/2) and touches it at the present F, so E / N never rises.
#[derive(Debug, Clone, PartialEq)]
pub struct MeanGradient {
    /// The gradient of linear F. Functions of higher degree have only their own.
    pub gradient: Gradient,
    /// Coefficients to start from, one for each function; by default the minimiser with [`SquaredGradient`].
    pub start: Option<Vec<f64>>,
    /// The end: no coefficient moved by more than this share of the largest.
    pub tolerance: f64,
    /// Most steps.
    pub max_steps: usize,
}

impl Default for MeanGradient {
    fn default() -> Self {
        Self { gradient: Gradient::Element, start: None, tolerance: 1e-10, max_steps: 500 }
    }
}

impl<const D: usize> Normalization<D> for MeanGradient {
    fn minimise(&self, problem: &Problem<'_, D>) -> Result<Minimum, FitError> {
        if !(self.tolerance.is_finite() && self.tolerance >= 0.0) {
            return Err(FitError::Tolerance(self.tolerance));
        }
        let rows = problem.gradient_rows(self.gradient);
        let factor = problem.energy.factor().ok_or(FitError::NotPositiveDefinite)?;
        let mut f = match &self.start {
            Some(start) => problem.restricted(start)?,
            None => eigenvector(problem, Some(&mass(problem, &rows)))?.coefficients,
        };
        let mut steps = Vec::new();
        let mut at_rest = false;
        let mut frozen = Frozen::at(problem, &rows, &f);
        loop {
            if frozen.length.is_nan() || frozen.length <= 0.0 {
                return Err(FitError::NoGradient);
            }
            f.iter_mut().for_each(|f| *f /= frozen.length);
            steps.push(problem.energy_of(&f));
            if at_rest || steps.len() > self.max_steps {
                break;
            }
            check(problem.monitor)?;
            let mut next = frozen.sum;
            factor.solve(&mut next);
            frozen = Frozen::at(problem, &rows, &next);
            let largest = f.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
            let moved = f.iter().zip(&next).fold(0.0_f64, |m, (f, n)| m.max((n / frozen.length - f).abs()));
            at_rest = moved <= self.tolerance * largest;
            f = next;
        }
        let rayleigh_quotient = *steps.last().expect("the quotient at the end is listed");
        Ok(Minimum { coefficients: f, spectrum: Vec::new(), scale: 1.0, steps, at_rest, rayleigh_quotient })
    }
}

/// The directions of the gradients at some F.
struct Frozen {
    /// sum_i w_i G_i' n_i.
    sum: Vec<f64>,
    /// sum_i w_i |g_i|.
    length: f64,
}

impl Frozen {
    fn at<const D: usize>(problem: &Problem<'_, D>, rows: &[GradientRow<D>], f: &[f64]) -> Self {
        let mut frozen = Self { sum: vec![0.0; f.len()], length: 0.0 };
        for (row, sample) in rows.iter().zip(&problem.samples) {
            let g = row.of(f);
            let length = g.iter().map(|c| c * c).sum::<f64>().sqrt();
            if length <= 0.0 {
                continue;
            }
            frozen.length += sample.weight * length;
            for (&j, d) in row.indices.iter().zip(&row.gradients) {
                let along: f64 = (0..D).map(|a| d[a] * g[a]).sum();
                frozen.sum[j as usize] += sample.weight * along / length;
            }
        }
        frozen
    }
}

/// The matrix of sum_i w_i |grad F(P_i)|^2.
fn mass<const D: usize>(problem: &Problem<'_, D>, rows: &[GradientRow<D>]) -> Matrix {
    let mut mass = MatrixBuilder::new(problem.energy.len(), problem.energy.is_dense());
    let mut values = Vec::new();
    for (row, sample) in rows.iter().zip(&problem.samples) {
        for a in 0..D {
            values.clear();
            values.extend(row.gradients.iter().map(|g| g[a]));
            mass.add_outer(sample.weight, &row.indices, &values);
        }
    }
    mass.finish()
}

fn eigenvector<const D: usize>(problem: &Problem<'_, D>, mass: Option<&Matrix>) -> Result<Minimum, FitError> {
    let pencil = Pencil { energy: &problem.energy, mass, dimension: D };
    let found = pencil.smallest(PAIRS, problem.solver, problem.monitor)?;
    let at_rest = found.at_rest;
    let coefficients = found.vectors.into_iter().next().ok_or(FitError::NoGradient)?;
    let rayleigh_quotient = found.values[0];
    let scale = pencil.shift(1.0);
    Ok(Minimum { coefficients, spectrum: found.values, scale, steps: Vec::new(), at_rest, rayleigh_quotient })
}

impl<const D: usize> Problem<'_, D> {
    /// The gradients at the samples by the unknowns.
    fn gradient_rows(&self, gradient: Gradient) -> Vec<GradientRow<D>> {
        let mut rows = rows(self.basis, &self.samples, gradient);
        for row in &mut rows {
            let known = row.indices.iter().zip(&row.gradients);
            let (indices, gradients) =
                known.filter_map(|(&j, &g)| self.unknown[j as usize].map(|unknown| (unknown, g))).unzip();
            *row = GradientRow { indices, gradients };
        }
        rows
    }
}
