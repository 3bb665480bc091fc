//! The weighted iteration, as the paper prints it.

use super::flat::Flat;
use super::moments::Moments;
use super::{Iterate, Normalization, Stage};

/// One round after the other, on memory that is kept.
#[derive(Debug, Default)]
pub(super) struct Weighted {
    /// For each flat, the distances of all points over the largest of them.
    errors: Vec<f64>,
    products: Vec<f64>,
}

impl Weighted {
    /// Makes the errors of these flats current.
    pub(super) fn start<const D: usize>(&mut self, points: &[[f64; D]], flats: &[Flat<D>]) {
        self.errors.clear();
        self.errors.resize(points.len() * flats.len(), 0.0);
        self.products.resize(points.len(), 0.0);
        for (j, flat) in flats.iter().enumerate() {
            self.measure(points, j, flat);
        }
    }

    fn measure<const D: usize>(&mut self, points: &[[f64; D]], j: usize, flat: &Flat<D>) {
        let errors = &mut self.errors[j * points.len()..(j + 1) * points.len()];
        let mut largest = 0.0_f64;
        for (error, point) in errors.iter_mut().zip(points) {
            *error = flat.signed_distance(point).abs();
            largest = largest.max(*error);
        }
        if largest > 0.0 {
            errors.iter_mut().for_each(|error| *error /= largest);
        }
    }

    /// The flat of least squares, weighted by the product of the errors of all flats but the one at `skipped`, to a power.
    ///
    /// The product is taken first and divided by its largest value, the power after that: the largest weight is 1, and nothing
    /// vanishes that matters. `None` if the other flats pass through all points.
    fn fit<const D: usize>(
        &mut self,
        points: &[[f64; D]],
        skipped: usize,
        power: f64,
        normalization: Normalization,
    ) -> Option<Flat<D>> {
        self.products[..points.len()].fill(1.0);
        for (_, errors) in self.errors.chunks_exact(points.len()).enumerate().filter(|(m, _)| *m != skipped) {
            for (product, error) in self.products.iter_mut().zip(errors) {
                *product *= error;
            }
        }
        let largest = self.products.iter().fold(0.0_f64, |largest, p| largest.max(*p));
        if largest == 0.0 {
            return None;
        }
        let mut sums = Moments::ZERO;
        for (product, point) in self.products.iter().zip(points) {
            sums.add(point, raised(product / largest, power));
        }
        sums.flat(normalization)
    }

    /// One iteration: the second flat and all after it, then the first. A flat that is not there yet is made from the flats that are.
    pub(super) fn round<const D: usize>(
        &mut self,
        points: &[[f64; D]],
        flats: &mut Vec<Flat<D>>,
        count: usize,
        power: f64,
        normalization: Normalization,
    ) {
        for j in (1..count).chain([0]) {
            let Some(flat) = self.fit(points, j, power, normalization) else { continue };
            if j < flats.len() {
                flats[j] = flat;
            } else {
                flats.push(flat);
                self.errors.resize(points.len() * flats.len(), 0.0);
            }
            self.measure(points, flats.len().min(j + 1) - 1, &flat);
        }
    }
}

/// The whole method as printed, from one start: the flat of all points.
pub(super) fn as_printed<const D: usize>(
    points: &[[f64; D]],
    count: usize,
    schedule: &[f64],
    normalization: Normalization,
    weighted: &mut Weighted,
) -> Vec<Iterate<D>> {
    let Some(first) = Moments::of(points).flat(normalization) else { return Vec::new() };
    let mut flats = vec![first];
    weighted.start(points, &flats);
    let mut iterates = vec![Iterate { stage: Stage::Start, flats: flats.clone() }];
    for &exponent in schedule {
        weighted.round(points, &mut flats, count, exponent, normalization);
        iterates.push(Iterate { stage: Stage::Weighted { exponent }, flats: flats.clone() });
    }
    iterates
}

#[inline]
fn raised(base: f64, power: f64) -> f64 {
    // The schedules of use have small whole exponents, for which multiplying is several times as fast.
    if power.fract() == 0.0 && power <= 64.0 { base.powi(power as i32) } else { base.powf(power) }
}
