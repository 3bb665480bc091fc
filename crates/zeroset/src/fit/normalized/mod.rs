//! The normalised implicit fit: F = sum_j F_j B_j that vanishes on the data, with no normals given.
//!
//! # What
//! Minimises
//!
//! ```text
//! E(F) / N(F),   E(F) = sum_i w_i F(P_i)^2 + integrals of F^2 over lines and facets + smoothness
//! ```
//!
//! over all F of a [basis](crate::basis). N keeps F from being zero. Data are [`Data`]; smoothness is [`Order0`], [`Order1`] or [`Order2`]; N is
//! [`Coefficients`], [`SquaredGradient`] or [`MeanGradient`]. Their pages have the formulas, and `docs/methods/normalized-fit.md` tells which
//! to take when.
//!
//! # Example
//! Thirteen points around a bowl, and four triangles (the paper's first example):
//!
//! ```
//! use zeroset::basis::P1;
//! use zeroset::domain::SimplicialMesh;
//! use zeroset::fit::normalized::{Data, NormalizedFit};
//!
//! let points = [
//!     [0.44, 0.13], [0.24, 0.15], [0.22, 0.35], [0.31, 0.49], [0.35, 0.60], [0.43, 0.70], [0.51, 0.77],
//!     [0.57, 0.70], [0.70, 0.55], [0.85, 0.30], [0.88, 0.23], [0.80, 0.10], [0.60, 0.10],
//! ];
//! let mut data = Data::new();
//! data.points(&points, 1.0)?;
//! let basis = P1::new(SimplicialMesh::four_triangles([0.0, 0.0], [1.0, 1.0])?);
//! let fitted = NormalizedFit::new(&basis, &data).run()?;
//! assert!((fitted.rayleigh_quotient - 0.0433972).abs() < 1e-7);
//! let inside = fitted.function(&basis).value([0.5, 0.4]).expect("the point lies in the domain");
//! assert!(inside < 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Cost
//! Linear in the samples and the simplices, plus the solver: cubic in the unknowns where dense, about M^1.5 in the plane and M^2 in space with
//! a sparse factor. [`Solver`] tells more.
//!
//! # Guaranteed
//! F vanishes on the data as well as the basis allows, in the sense above. The sign is that of the library: F is negative inside, which here
//! means that its mean over the vertices on the rim of the domain is positive. Equal bits on any number of threads.
//!
//! # Not guaranteed
//! That the least E / N is what one wants. It can sit on a few nodes that data hardly touch (localisation), and it need not be unique. The
//! [`Diagnosis`] tells, and names the remedy.
//!
//! # Source
//! G. M. Nielson, 3AI 2013, for [`Coefficients`] on simplices; Computing 86, 2009, for radial functions. G. Taubin, PAMI 13, 1991, for
//! [`SquaredGradient`]. [`MeanGradient`] is this project's, after M. Hein and T. Buehler, NIPS 2010.

mod data;
mod diagnosis;
mod energy;
mod gradient;
mod normalization;

#[cfg(test)]
mod tests;

pub use crate::fit::eigen::Solver;
pub use data::{Data, DataError, PolygonError, Sample};
pub(crate) use data::{Triangulated, triangulate_polygon};
pub use diagnosis::{Diagnosis, Warning};
pub use energy::{Order0, Order1, Order2, Smoothness, Squares};
pub use normalization::{Coefficients, MeanGradient, Minimum, Normalization, SquaredGradient};

use crate::basis::{Basis, Derivatives, Expansion, Terms};
use crate::fit::eigen::{EigenError, MOST_DENSE, Matrix, MatrixBuilder};
use crate::monitor::{Cancelled, Monitor, check};

/// A fit that could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The data serve no fit.
    #[error(transparent)]
    Data(#[from] DataError),
    /// The weight of the smoothness is negative or not finite.
    #[error("a smoothness of {0} is not possible: give a number of 0 or more")]
    Smoothness(f64),
    /// The steps of the mean gradient need a regular energy.
    #[error(
        "the energy is not positive definite: the data leave some function free; add smoothness of order 1 or 2, or take fewer cells"
    )]
    NotPositiveDefinite,
    /// The normalisation is zero for every F.
    #[error(
        "the gradient vanishes at all data: nothing keeps F from zero; take finer cells, another start or another normalisation"
    )]
    NoGradient,
    /// Numbers are too large, or vanish.
    #[error(
        "the energy of the fit is not finite, or zero throughout: weights, smoothness, widths or coordinates are too extreme; bring them near 1"
    )]
    Extreme,
    /// A dense matrix would be too large.
    #[error(
        "{unknowns} unknowns are too many for a dense matrix, which holds {most} at most; take another solver, fewer cells or fewer centres"
    )]
    TooLarge {
        /// Number of unknowns.
        unknowns: usize,
        /// Most that a dense matrix holds.
        most: usize,
    },
    /// The tolerance of the steps is negative or not finite.
    #[error("a tolerance of {0} is not possible: give a number of 0 or more")]
    Tolerance(f64),
    /// A coefficient of the start is infinite or not a number.
    #[error("coefficient {0} of the start is not finite; correct it")]
    StartNotFinite(usize),
    /// The start has the wrong length.
    #[error("the start has {given} coefficients, but the basis has {needed} functions; give one for each")]
    Start {
        /// How many were given.
        given: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// A fit about to be made: what to fit, on what, and how. By default as in the paper: [`Coefficients`] and [`Order0`].
#[derive(Clone, Copy)]
pub struct NormalizedFit<'a, const D: usize> {
    basis: &'a dyn Basis<D>,
    data: &'a Data<D>,
    smoothness: &'a dyn Smoothness<D>,
    normalization: &'a dyn Normalization<D>,
    solver: Solver,
    monitor: &'a dyn Monitor,
}

/// The energy of a fit, ready to be minimised.
pub struct Problem<'a, const D: usize> {
    pub(super) basis: &'a dyn Basis<D>,
    pub(super) samples: Vec<Sample<D>>,
    /// The matrix of E, by the unknowns.
    pub(super) energy: Matrix,
    /// For each function its place among the unknowns; `None` if nothing constrains it.
    pub(super) unknown: Vec<Option<u32>>,
    pub(super) solver: Solver,
    pub(super) monitor: &'a dyn Monitor,
}

impl From<EigenError> for FitError {
    fn from(error: EigenError) -> Self {
        match error {
            EigenError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            EigenError::TooLarge { unknowns } => Self::TooLarge { unknowns, most: MOST_DENSE },
            EigenError::NotFinite => Self::Extreme,
        }
    }
}

/// F, and how it came about.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// F_j, one for each function; 0 for functions that nothing constrains.
    pub coefficients: Vec<f64>,
    /// E(F) / N(F), the least there is.
    pub rayleigh_quotient: f64,
    /// The smallest values of E / N at its stationary points, ascending; empty for [`MeanGradient`], which has no spectrum.
    pub spectrum: Vec<f64>,
    /// E / N before each step and at the end, for [`MeanGradient`]; else empty.
    pub steps: Vec<f64>,
    /// For each datum the root of its mean F^2.
    pub residuals: Vec<f64>,
    /// The root of the weighted mean of F^2 over all data.
    pub residual_rms: f64,
    /// The same over |grad F|: to first order, the distance of the data from the zero set.
    pub distance_rms: f64,
    /// For each function whether nothing constrains it, so that F is not known where it does not vanish.
    pub unconstrained: Vec<bool>,
    /// Whether F can be trusted.
    pub diagnosis: Diagnosis,
}

impl Fitted {
    /// F as a function of position, with the basis of the fit.
    ///
    /// # Panics
    /// If the basis has another number of functions.
    #[must_use]
    pub fn function<'a, const D: usize>(&'a self, basis: &'a dyn Basis<D>) -> Expansion<'a, D> {
        Expansion::new(basis, &self.coefficients).without(&self.unconstrained)
    }

    /// The distance from the least value of the spectrum to the next one. Small means that another F is nearly as good.
    #[must_use]
    pub fn gap(&self) -> Option<f64> {
        Some(self.spectrum.get(1)? - self.spectrum.first()?)
    }
}

/// A function whose square is summed over the data to less than this share of the largest such sum counts as unconstrained: its values at
/// the data are rounding.
const UNCONSTRAINED: f64 = 1e-24;

impl<'a, const D: usize> NormalizedFit<'a, D> {
    /// A fit as in the paper, with [`Coefficients`] and [`Order0`].
    #[must_use]
    pub fn new(basis: &'a dyn Basis<D>, data: &'a Data<D>) -> Self {
        Self { basis, data, smoothness: &Order0, normalization: &Coefficients, solver: Solver::Auto, monitor: &() }
    }

    /// With an energy of smoothness.
    #[must_use]
    pub fn smoothness(self, smoothness: &'a dyn Smoothness<D>) -> Self {
        Self { smoothness, ..self }
    }

    /// With a normalisation.
    #[must_use]
    pub fn normalization(self, normalization: &'a dyn Normalization<D>) -> Self {
        Self { normalization, ..self }
    }

    /// With a solver of one's choice.
    #[must_use]
    pub fn solver(self, solver: Solver) -> Self {
        Self { solver, ..self }
    }

    /// With a monitor, which can stop the fit.
    #[must_use]
    pub fn monitor(self, monitor: &'a dyn Monitor) -> Self {
        Self { monitor, ..self }
    }

    /// The matrix of E: the entries (row, column, value) of its lower triangle that can differ from zero, column by column. With
    /// [`Order0`] it is the Gram matrix of the data.
    ///
    /// # Errors
    /// If data lie outside the domain.
    pub fn energy_matrix(&self) -> Result<Vec<(usize, usize, f64)>, FitError> {
        let mut entries = Vec::new();
        self.energy(&self.data.samples(self.basis)?).for_each(|i, j, value| entries.push((i, j, value)));
        Ok(entries)
    }

    /// Makes the fit.
    ///
    /// # Errors
    /// If data lie outside the domain, a weight is out of range, or the problem has no solution; the error names the remedy.
    pub fn run(&self) -> Result<Fitted, FitError> {
        check(self.monitor)?;
        let problem = self.problem()?;
        check(self.monitor)?;
        let minimum = self.normalization.minimise(&problem)?;
        Ok(problem.fitted(minimum, self.data.len()))
    }

    pub(super) fn problem(&self) -> Result<Problem<'a, D>, FitError> {
        let weight = self.smoothness.weight();
        if !(weight.is_finite() && weight >= 0.0) {
            return Err(FitError::Smoothness(weight));
        }
        let unknowns = self.basis.len();
        if !self.basis.is_local() && unknowns > MOST_DENSE {
            return Err(FitError::TooLarge { unknowns, most: MOST_DENSE });
        }
        let samples = self.data.samples(self.basis)?;
        let energy = self.energy(&samples);
        if !energy.is_finite() {
            return Err(FitError::Extreme);
        }
        let diagonal = energy.diagonal();
        let most = diagonal.iter().fold(0.0_f64, |m, &d| m.max(d));
        let kept: Vec<usize> = (0..diagonal.len()).filter(|&j| diagonal[j] > UNCONSTRAINED * most).collect();
        if kept.is_empty() {
            return Err(FitError::Extreme);
        }
        let mut unknown = vec![None; diagonal.len()];
        for (place, &j) in kept.iter().enumerate() {
            unknown[j] = Some(place as u32);
        }
        let energy = if kept.len() < diagonal.len() { energy.restricted(&kept) } else { energy };
        Ok(Problem { basis: self.basis, samples, energy, unknown, solver: self.solver, monitor: self.monitor })
    }

    /// The matrix of E over all functions.
    fn energy(&self, samples: &[Sample<D>]) -> Matrix {
        let mut energy = MatrixBuilder::new(self.basis.len(), !self.basis.is_local());
        let mut terms = Terms::new();
        for sample in samples {
            self.basis.evaluate(&sample.place, Derivatives::None, &mut terms);
            energy.add_outer(sample.weight, &terms.indices, &terms.values);
        }
        if self.smoothness.weight() > 0.0 {
            self.smoothness.squares(self.basis, &mut |weight, indices, values| {
                energy.add_outer(weight, indices, values);
            });
        }
        energy.finish()
    }
}

impl<const D: usize> Problem<'_, D> {
    /// F'AF.
    fn energy_of(&self, f: &[f64]) -> f64 {
        let mut image = vec![0.0; f.len()];
        self.energy.multiply(f, &mut image);
        f.iter().zip(&image).map(|(f, a)| f * a).sum()
    }

    /// The coefficients of the unknowns among those of all functions.
    fn restricted(&self, all: &[f64]) -> Result<Vec<f64>, FitError> {
        if all.len() != self.unknown.len() {
            return Err(FitError::Start { given: all.len(), needed: self.unknown.len() });
        }
        if let Some(j) = all.iter().position(|f| !f.is_finite()) {
            return Err(FitError::StartNotFinite(j));
        }
        Ok(all.iter().zip(&self.unknown).filter(|(_, unknown)| unknown.is_some()).map(|(&f, _)| f).collect())
    }

    /// Turns F the right way round, and measures it at the data.
    fn fitted(&self, minimum: Minimum, data: usize) -> Fitted {
        let coefficient = |place: &Option<u32>| place.map_or(0.0, |at| minimum.coefficients[at as usize]);
        let mut all: Vec<f64> = self.unknown.iter().map(coefficient).collect();
        let unconstrained: Vec<bool> = self.unknown.iter().map(Option::is_none).collect();
        if self.is_inside_out(&all, &unconstrained) {
            all.iter_mut().for_each(|f| *f = -*f);
        }
        let f = Expansion::new(self.basis, &all);
        let (mut sums, mut total) = (vec![[0.0; 2]; data], [0.0; 3]);
        let mut lengths = Vec::with_capacity(self.samples.len());
        for sample in &self.samples {
            let square = f.value_at(&sample.place).powi(2);
            let length = f.gradient_at(&sample.place).iter().map(|c| c * c).sum::<f64>();
            let sum = &mut sums[sample.datum as usize];
            *sum = [sum[0] + sample.weight, sum[1] + sample.weight * square];
            total[0] += sample.weight;
            total[1] += sample.weight * square;
            total[2] += sample.weight * length;
            lengths.push((sample.weight, length.sqrt()));
        }
        let root = |sum: f64, weight: f64| if weight > 0.0 { (sum / weight).sqrt() } else { 0.0 };
        let diagnosis = Diagnosis::of(&minimum, &unconstrained, &lengths);
        let Minimum { spectrum, steps, rayleigh_quotient, .. } = minimum;
        Fitted {
            rayleigh_quotient,
            spectrum,
            steps,
            residuals: sums.iter().map(|s| root(s[1], s[0])).collect(),
            residual_rms: root(total[1], total[0]),
            distance_rms: root(total[1], total[2]),
            coefficients: all,
            unconstrained,
            diagnosis,
        }
    }

    /// Whether the mean of F over the vertices on the rim of the domain is negative; where it is zero, whether the largest coefficient is.
    fn is_inside_out(&self, coefficients: &[f64], unconstrained: &[bool]) -> bool {
        let f = Expansion::new(self.basis, coefficients).without(unconstrained);
        let domain = self.basis.domain();
        let largest = coefficients.iter().fold(0.0_f64, |m, &f| if f.abs() > m.abs() { f } else { m });
        let values: Vec<f64> = domain.rim().iter().filter_map(|&v| f.value(domain.vertices()[v as usize])).collect();
        let sum: f64 = values.iter().sum();
        let size: f64 = values.iter().map(|v| v.abs()).sum();
        if sum.abs() > 1e-9 * size { sum < 0.0 } else { largest < 0.0 }
    }
}
