//! NEWE: several flats at once, by error-weighted eigenvectors.
//!
//! # What
//! Fits k flats (lines in the plane, planes in space, hyperplanes in any dimension D) to unordered, noisy points without normals: the corner
//! of a building and its three walls and roofs from one handful of points. k is given, or chosen.
//!
//! # Formula
//! The Nonlinear Error Weighted Eigen method: with e_m(i) the distance of point i from flat m, flat j is fitted anew to the weights
//!
//! ```text
//! w_j(i) = product over m != j of |e_m(i)|^P
//! ```
//!
//! that is to the points which the other flats leave unexplained: its coefficients are the smallest eigenvector of the weighted Gram matrix.
//! The flats take turns, and P falls from iteration to iteration: P_i = 2^(n+1-i), so 32, 16, 8, 4, 2 for n = 5
//! ([`halving_schedule`]). [`fit_as_printed`] does this and no more, from one start.
//!
//! That start often fails: of corners of three planes it finds 65 in 100, and none with outliers. [`fit`] is made of more:
//! 1. *Starts*: flats of small neighbourhoods by trimmed least squares and flats through D random points nearby, combined so that each
//!    explains most of what the others leave; the best k - 1 flats and one more; the method as printed; random combinations.
//! 2. *Iterations* with the last two exponents of the schedule; each start is also tried without them, since outliers carry them away.
//! 3. *Polish*: every point within three deviations goes to its nearest flat, and each flat is fitted to its points, until the objective
//!    sum_i min((r_i / sigma)^2, 9) rests. r_i is the distance from the nearest flat.
//! 4. The start of least objective is kept, and each of its flats is tried against the one that explains most in its place.
//!
//! The noise sigma, if it is not given, starts from the neighbourhoods, and settles at 1.49 times the median distance from the flats that
//! explain most.
//!
//! The number of flats is the one of least
//!
//! ```text
//! S(k) = sum_i min((r_i / sigma)^2, 9)  +  2 (n ln n - sum_j n_j ln n_j)  +  k D ln N
//! ```
//!
//! with n_j points on flat j, n on all, and N points at all: the residuals, the price of the labels that say which flat a point lies on, and the
//! price of the flats' own D numbers. Numbers are tried upwards, until one more does not pay.
//!
//! # Normalisation
//! [`Normalization::Affine`] holds the normal at length 1: total least squares, and the flats move with the points.
//! [`Normalization::Homogeneous`] holds all D + 1 coefficients at length 1, as the paper prints it: then the result depends on where the origin is and
//! on the unit of length, and leans towards flats that are far from the origin. Its rate of success is the same. So affine is the default.
//!
//! # Cost
//! Linear in the points; the search runs on 1024 of them at most. With known noise and up to four flats, on one thread
//! of a small machine: 13 microseconds for 100 points of one plane, 0.3 to 1.4 ms for 100 points of two to four; 2 ms for three planes of 600
//! points. [`NeweFitter`] keeps its memory from fit to fit.
//!
//! # Guaranteed
//! Equal bits from run to run, and in whatever order the points come. In affine mode the flats move, turn and grow with the points, up
//! to rounding, unless points lie equally far from their mean, where rounding may choose other starts. No input makes it panic.
//!
//! # Not guaranteed
//! That the least objective is found; the page `docs/methods/newe.md` tells how often it is. That it is what one wants: flats are infinite, so a
//! point may be given to the continuation of a flat far away.
//!
//! # Failure cases
//! - A flat with less than about a tenth of the points does not pay for its labels, and is left out.
//! - Two planes that turn by less than 10 to 12 degrees are taken for one, where the noise is a hundredth of their common width; half of that where
//!   it is half as large.
//! - Curved surfaces are cut into as many flats as are allowed: an upper end of the range is not a count.
//! - Fewer than some 20 points for each flat leave the measured noise uncertain by a half, and with it k: give the noise if it is known.
//! - Noise as wide as the neighbourhoods that tell it, a twentieth of the points, is measured too small.
//!
//! # Source
//! G. M. Nielson, Techniques for extracting and modeling geometric features from point cloud data sets with application to urban terrain
//! modeling, 3AI 2013. The print of the exponents is damaged there; this reading is the one that works. Ours: the affine normalisation, the
//! starts, the truncated objective in place of the sum of products, the polish, the exchange, and the choice of k.
//!
//! # Example
//! ```
//! use zeroset::feature::newe::{FlatCount, NeweParams, corner, fit};
//!
//! // Two lines that meet in (2, 1), every point a little off.
//! let points: Vec<[f64; 2]> = (0..80)
//!     .map(|i| (f64::from(i / 2) / 40.0, 0.01 * f64::from(i * 7 % 11 - 5) / 5.0, i % 2))
//!     .map(|(t, off, arm)| if arm == 0 { [2.0 + t, 1.0 + off] } else { [2.0 + off, 1.0 + t] })
//!     .collect();
//! let params = NeweParams { flats: FlatCount::Between { least: 1, most: 3 }, ..NeweParams::default() };
//! let found = fit(&points, &params)?;
//! assert_eq!(found.flats.len(), 2);
//! let corner = corner(&found.flats, [0.0, 0.0]).position;
//! assert!((corner[0] - 2.0).abs() < 0.01 && (corner[1] - 1.0).abs() < 0.01);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod criterion;
mod eigen;
mod fitter;
mod flat;
mod frame;
mod moments;
mod params;
mod polish;
mod search;
mod starts;
mod weighted;

#[cfg(test)]
mod tests;

pub use fitter::NeweFitter;
pub use flat::{Flat, Line, Meeting, corner, edge_line};
pub use params::{FlatCount, NeweError, NeweParams, Normalization, halving_schedule};

/// What a fit found.
#[derive(Debug, Clone, PartialEq)]
pub struct Newe<const D: usize> {
    /// The flats, by falling number of points.
    pub flats: Vec<Flat<D>>,
    /// For each point, in the order given, the flat it lies on; `None` for an outlier.
    pub assignment: Vec<Option<usize>>,
    /// Standard deviation of the points across their flats: as given, or as measured. Rounding sets a least value.
    pub noise: f64,
    /// Sum over the points of the squared distance from the nearest flat over the squared noise, each at most 9.
    pub objective: f64,
    /// What the number of flats was chosen by.
    pub criterion: f64,
    /// The numbers of flats that were tried, in order.
    pub candidates: Vec<Candidate>,
    /// How the flats came about, if this was asked for: from the start that won to the end of the polish.
    pub iterates: Vec<Iterate<D>>,
}

/// A number of flats that was tried.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Candidate {
    /// How many.
    pub flats: usize,
    /// The objective.
    pub objective: f64,
    /// The criterion: the least wins.
    pub criterion: f64,
}

/// The flats after one step.
#[derive(Debug, Clone, PartialEq)]
pub struct Iterate<const D: usize> {
    /// The step.
    pub stage: Stage,
    /// The flats, in an order that stays the same from step to step.
    pub flats: Vec<Flat<D>>,
}

/// A step on the way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stage {
    /// Where it began.
    Start,
    /// A weighted iteration.
    Weighted {
        /// The exponent of the weights.
        exponent: f64,
    },
    /// A flat gave way to a better one.
    Exchange,
    /// Assignment and refit.
    Polish,
}

/// Fits flats to points, dependably.
///
/// # Errors
/// [`NeweError`] if the parameters make no sense, a point is not finite, coordinates are too large, or there are fewer points than D for
/// each flat.
pub fn fit<const D: usize>(points: &[[f64; D]], params: &NeweParams) -> Result<Newe<D>, NeweError> {
    NeweFitter::new(params.clone())?.fit(points)
}

/// The method as the paper prints it, from one start: the first flat is that of all points, and each other one is weighted by those before
/// it.
///
/// Returns that start, and one iterate for each exponent. The last one is the result. Flats are left out as long as those before them
/// pass through all points.
///
/// # Errors
/// As [`fit`].
pub fn fit_as_printed<const D: usize>(
    points: &[[f64; D]],
    flats: usize,
    schedule: &[f64],
    normalization: Normalization,
) -> Result<Vec<Iterate<D>>, NeweError> {
    params::check_count(flats)?;
    params::check_schedule(schedule)?;
    params::check_points(points, flats)?;
    let mut framed = frame::Framed::default();
    framed.take(points, normalization);
    let mut iterates =
        weighted::as_printed(&framed.points, flats, schedule, normalization, &mut weighted::Weighted::default());
    if iterates.is_empty() {
        return Err(NeweError::Extreme);
    }
    for iterate in &mut iterates {
        iterate.flats.iter_mut().for_each(|flat| *flat = framed.flat_outward(flat));
    }
    Ok(iterates)
}
