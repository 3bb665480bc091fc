//! The smallest eigenpairs of a sparse pencil, by block iteration.

use super::lobpcg::{self, Accuracy};
use super::{Factor, Matrix, Pencil, dot};
use crate::monitor::{Cancelled, Monitor};
use crate::sample::Chance;

/// Vectors iterated beyond those asked for. They quicken the last ones asked for.
const GUARDS: usize = 3;
/// How far the vectors are driven. A step cuts the error of the values to less than a hundredth, so the first is good to rounding, and the
/// others have ten digits. At 1e-15 the steps go on with corrections that are rounding, and can drive a vector that was right away again.
const ACCURACY: Accuracy =
    Accuracy { steps: 300, at_rest: 1e-13, others_at_rest: 1e-11, inner: 1e-2, inner_steps: 400 };

/// How systems with A + tau M are solved.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Preconditioner {
    /// By its Cholesky factor.
    Exact,
    /// Roughly, by conjugate gradients.
    Rough,
}

struct Shifted<'a> {
    pencil: &'a Pencil<'a>,
    tau: f64,
    matrix: Matrix,
    factor: Option<Factor>,
    diagonal: Vec<f64>,
}

impl<'a> Shifted<'a> {
    /// A + tau M, and its factor if asked for. Where it is not positive definite, by rounding or as M is singular where A is, a little of
    /// the diagonal goes with it.
    fn new(pencil: &'a Pencil<'a>, tau: f64, preconditioner: Preconditioner) -> Self {
        let bare = pencil.shifted(tau);
        let mean = bare.diagonal().iter().sum::<f64>() / bare.len().max(1) as f64;
        let (mut matrix, mut factor) = (bare, None);
        if preconditioner == Preconditioner::Exact {
            for share in [0.0, 1e-14, 1e-13, 1e-11] {
                matrix = matrix.plus_diagonal(share * mean);
                factor = matrix.factor();
                if factor.is_some() {
                    break;
                }
            }
        } else if pencil.mass.is_some() {
            matrix = matrix.plus_diagonal(1e-13 * mean);
        }
        let diagonal = matrix.diagonal();
        Self { pencil, tau, matrix, factor, diagonal }
    }

    /// M x.
    fn mass_image(&self, x: &[f64]) -> Vec<f64> {
        let mut image = vec![0.0; x.len()];
        self.pencil.mass_times(x, &mut image);
        image
    }
}

impl lobpcg::Pencil for Shifted<'_> {
    fn stiffness(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.multiply(x, y);
    }

    fn mass(&self, x: &[f64], y: &mut [f64]) {
        self.pencil.mass_times(x, y);
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    fn corrections(&self, residuals: Vec<Vec<f64>>, accuracy: &Accuracy) -> Vec<Vec<f64>> {
        match &self.factor {
            Some(factor) => factor.solve_all(residuals),
            None => lobpcg::rough_solutions(self, residuals, accuracy),
        }
    }
}

/// The first look, which tells how small the values are.
const FIRST_LOOK: Accuracy = Accuracy { steps: 30, at_rest: 1e-6, others_at_rest: 1e-4, ..ACCURACY };
/// The shift of the first look, as a share of A over M by their traces.
const FIRST_SHIFT: f64 = 1e-6;
/// Least shift, as such a share: less is lost in the rounding of A.
const LEAST_SHIFT: f64 = 1e-13;
/// The shift is no less than this share of the last value asked for, so that the values of theta are not too different in size.
const OF_THE_LAST: f64 = 1e-3;
/// Values may differ by this share from the quotients of their vectors.
const AGREE: f64 = 1e-6;

/// The vectors of the `count` smallest values, and whether the iteration came to rest.
///
/// Values are told apart well where the shift is not far above them. So a first look with a coarse shift finds their size, and where they
/// are much smaller the iteration goes on with a shift of about that size.
pub(super) fn smallest(
    pencil: &Pencil<'_>,
    count: usize,
    preconditioner: Preconditioner,
    monitor: &dyn Monitor,
) -> Result<(Vec<Vec<f64>>, bool), Cancelled> {
    let n = pencil.energy.len();
    let wanted = count.min(n);
    let coarse = Shifted::new(pencil, pencil.shift(FIRST_SHIFT), preconditioner);
    let images = (0..(wanted + GUARDS).min(n)).map(|k| {
        let mut chance = Chance::new(7, 302, k);
        let random: Vec<f64> = (0..n).map(|_| chance.normal()).collect();
        coarse.mass_image(&random)
    });
    let mut start = lobpcg::Pencil::corrections(&coarse, images.collect(), &ACCURACY);
    start.retain(|x| dot(x, x) > 0.0);
    let look = lobpcg::smallest(&coarse, start, wanted, &FIRST_LOOK, monitor)?;
    let mut values = look.vectors.iter().take(wanted).filter_map(|x| pencil.normalized(x.clone())).map(|pair| pair.0);
    let first = values.next().unwrap_or(0.0);
    let fine = values.fold(first, |fine, value| fine.max(OF_THE_LAST * value)).max(pencil.shift(LEAST_SHIFT));
    let shifted = if fine < 0.1 * coarse.tau { Shifted::new(pencil, fine, preconditioner) } else { coarse };
    let found = lobpcg::smallest(&shifted, look.vectors, wanted, &ACCURACY, monitor)?;
    let at_rest = found.at_rest;
    // Theta does not see the roughest vectors, but x'Ax does: one step of inverse iteration takes the last of them out.
    let smoothed = match &shifted.factor {
        Some(factor) => factor.solve_all(found.vectors.iter().map(|x| shifted.mass_image(x)).collect()),
        None => found.vectors,
    };
    let last = lobpcg::smallest(&shifted, smoothed, wanted, &Accuracy { steps: 0, ..ACCURACY }, monitor)?;
    let agrees = |x: &Vec<f64>, value: f64| {
        let quotient = pencil.normalized(x.clone()).map(|(quotient, _)| quotient + shifted.tau);
        quotient.is_none_or(|quotient| (quotient - value).abs() <= AGREE * value.abs())
    };
    let agree = last.vectors.first().zip(last.values.first()).is_none_or(|(x, &value)| agrees(x, value));
    Ok((last.vectors.into_iter().take(wanted).collect(), at_rest && agree))
}
