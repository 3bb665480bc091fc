//! Rates of success on random corners, and properties of every fit.

mod count;
mod planar;
mod properties;
mod refusals;
mod scenes;
mod spatial;
mod survey;

use super::{Flat, FlatCount, Newe, NeweParams, Normalization, fit, fit_as_printed};
use crate::sample::Chance;
use scenes::Truth;

/// Standard deviation of the points in all random scenes, whose flats have size 1.
const NOISE: f64 = 0.01;

fn exactly(flats: usize) -> NeweParams {
    NeweParams { flats: FlatCount::Exactly(flats), ..NeweParams::default() }
}

fn up_to(most: usize) -> NeweParams {
    NeweParams { flats: FlatCount::Between { least: 1, most }, ..NeweParams::default() }
}

/// Shares of random scenes, from 0 to 1.
#[derive(Debug, Default)]
struct Rates {
    /// All flats within the angle.
    fit: f64,
    /// The right number of flats.
    count: f64,
    /// The corner within twice the noise.
    corner: f64,
    /// The method as printed, from its one start, within the angle: affine and homogeneous.
    printed: [f64; 2],
}

/// Fits `runs` scenes, and prints what came out.
fn rates<const D: usize>(
    name: &str,
    runs: usize,
    within_deg: f64,
    params: &NeweParams,
    make: impl Fn(&mut Chance, usize) -> Truth<D>,
) -> Rates {
    let mut rates = Rates::default();
    let one = 1.0 / runs as f64;
    for run in 0..runs {
        let truth = make(&mut Chance::new(run as u64, 77, 0), run);
        let good = |flats: &[Flat<D>]| f64::from(truth.angle_deg(flats) < within_deg);
        let Newe { flats, .. } = fit(&truth.points, params).expect("points and parameters are sound");
        rates.fit += one * good(&flats);
        rates.count += one * f64::from(flats.len() == truth.flats.len());
        let at = super::corner(&flats, truth.corner).position;
        let off = (0..D).map(|a| (at[a] - truth.corner[a]).powi(2)).sum::<f64>().sqrt();
        rates.corner += one * f64::from(off < 2.0 * NOISE);
        for (i, normalization) in [Normalization::Affine, Normalization::Homogeneous].into_iter().enumerate() {
            let iterates = fit_as_printed(&truth.points, truth.flats.len(), &params.schedule, normalization);
            let iterates = iterates.expect("points and parameters are sound");
            rates.printed[i] += one * good(&iterates.last().expect("there is the start").flats);
        }
    }
    println!("{name}: {rates:.3?}");
    rates
}
