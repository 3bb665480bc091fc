//! Which number of flats: what the points cost, and what the flats cost.
//!
//! In units of twice the natural logarithm of a probability, as for the criteria of Akaike and Schwarz:
//!
//! ```text
//! S(k) = sum_i min( (r_i / sigma)^2, 9 )  +  2 ( n ln n - sum_j n_j ln n_j )  +  k D ln N
//! ```
//!
//! r_i is the distance from the nearest flat, n_j the number of points of flat j, n their sum, N the number of all points.

use super::polish::{LIMIT, Residuals, nearest};
use super::{Flat, NeweParams};

/// n ln n, and 0 for 0.
fn entropy(n: usize) -> f64 {
    n as f64 * (n.max(1) as f64).ln()
}

/// The price of one flat: half a logarithm of N for each of its D numbers, twice.
fn price<const D: usize>(points: usize) -> f64 {
    D as f64 * (points.max(1) as f64).ln()
}

/// S(k) for flats with so many points each.
pub(super) fn criterion<const D: usize>(objective: f64, counts: &[usize], points: usize) -> f64 {
    let labels = entropy(counts.iter().sum()) - counts.iter().map(|&n| entropy(n)).sum::<f64>();
    objective + 2.0 * labels + price::<D>(points) * counts.len() as f64
}

/// Whether one more flat could pay if it took the worst points, up to half of all, and left them no cost but that of their labels.
///
/// It leaves out that the other flats fit better without these points: where the points of one flat have the noise they are said to have,
/// that is no more than they saved.
pub(super) fn could_pay<const D: usize>(
    points: &[[f64; D]],
    flats: &[Flat<D>],
    residuals: Residuals,
    costs: &mut Vec<f64>,
) -> bool {
    let squared_noise = residuals.noise * residuals.noise;
    costs.clear();
    costs.extend(points.iter().map(|p| (nearest(flats, p).1 / squared_noise).min(LIMIT * LIMIT)));
    costs.sort_unstable_by(|a, b| b.total_cmp(a));
    let mut saved = 0.0;
    costs[..points.len() / 2].iter().zip(1..).any(|(cost, taken)| {
        saved += cost;
        let labels = entropy(points.len()) - entropy(taken) - entropy(points.len() - taken);
        saved > 2.0 * labels + price::<D>(points.len())
    })
}

/// The largest number of flats that is worth trying.
pub(super) fn most_flats<const D: usize>(params: &NeweParams, points: usize) -> usize {
    let (least, most) = params.flats.ends();
    most.min(points / (D + 1)).max(least)
}
