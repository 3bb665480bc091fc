//! Hard assignment and refit, with truncated residuals.

use super::moments::Moments;
use super::{Flat, Normalization};

/// Residuals beyond this many times the noise cost no more than this many: such a point is an outlier. At 3, one good point in 370 is
/// called one; at 2 one in 22 is, and flats of few points lose accuracy; at 4 the refits lean towards outliers.
pub(super) const LIMIT: f64 = 3.0;

/// How far the first refits reach, over the last: a rough start is off by more than the noise.
const REACHES: [f64; 3] = [4.0, 2.0, 1.0];

/// Rounds of a rough polish: those of falling reach, and two more.
const ROUGH_ROUNDS: usize = 5;
/// Most rounds of a full one. Hard assignments come to rest after three or four.
const FULL_ROUNDS: usize = 30;
/// The share by which the objective falls at least while it does not rest.
const SETTLED: f64 = 1e-9;

/// The flat nearest to a point, and its squared distance.
#[inline]
pub(super) fn nearest<const D: usize>(flats: &[Flat<D>], point: &[f64; D]) -> (usize, f64) {
    let mut best = (0, f64::INFINITY);
    for (j, flat) in flats.iter().enumerate() {
        let squared = flat.signed_distance(point).powi(2);
        if squared < best.1 {
            best = (j, squared);
        }
    }
    best
}

/// Refits, on memory that is kept.
#[derive(Debug)]
pub(super) struct Polish<const D: usize> {
    sums: Vec<Moments<D>>,
    before: Vec<Flat<D>>,
    best: Vec<Flat<D>>,
}

impl<const D: usize> Default for Polish<D> {
    fn default() -> Self {
        Self { sums: Vec::new(), before: Vec::new(), best: Vec::new() }
    }
}

impl<const D: usize> Polish<D> {
    /// Gives every point within `reach` to its nearest flat, and fits each flat to its points anew. Returns the sum of the squared
    /// distances, each at most `limit` squared, before the refit.
    fn round(
        &mut self,
        points: &[[f64; D]],
        flats: &mut [Flat<D>],
        [reach, limit]: [f64; 2],
        normalization: Normalization,
    ) -> f64 {
        self.sums.clear();
        self.sums.resize(flats.len(), Moments::ZERO);
        let (reach, limit) = (reach * reach, limit * limit);
        let mut cost = 0.0;
        for point in points {
            let (j, squared) = nearest(flats, point);
            cost += squared.min(limit);
            if squared <= reach {
                self.sums[j].add(point, 1.0);
            }
        }
        for (flat, sums) in flats.iter_mut().zip(&self.sums) {
            // Fewer points than dimensions do not determine a flat: it stays where it is.
            if sums.weight() >= D as f64
                && let Some(refitted) = sums.flat(normalization)
            {
                *flat = refitted;
            }
        }
        cost
    }

    /// Rounds of falling reach, then until the objective rests. Calls `each` after every refit, and leaves the best flats of all. Returns
    /// their objective: the sum of the squared residuals over the noise, truncated.
    pub(super) fn run(
        &mut self,
        points: &[[f64; D]],
        flats: &mut [Flat<D>],
        residuals: Residuals,
        effort: Effort,
        mut each: impl FnMut(&[Flat<D>]),
    ) -> f64 {
        let (reaches, rounds) = match effort {
            Effort::Rough => (&REACHES[..], ROUGH_ROUNDS),
            Effort::Full => (&REACHES[REACHES.len() - 1..], FULL_ROUNDS),
        };
        let limit = LIMIT * residuals.noise;
        let mut best = f64::INFINITY;
        for round in 0..=rounds {
            self.before.clear();
            self.before.extend_from_slice(flats);
            let reach = limit * reaches.get(round).unwrap_or(&1.0);
            let cost = self.round(points, flats, [reach, limit], residuals.normalization);
            let improved = cost < best * (1.0 - SETTLED);
            if cost < best {
                best = cost;
                std::mem::swap(&mut self.before, &mut self.best);
            }
            if round == rounds || (!improved && round >= reaches.len()) {
                break;
            }
            each(flats);
        }
        flats.copy_from_slice(&self.best);
        best / (residuals.noise * residuals.noise)
    }
}

/// How residuals are measured and made small.
#[derive(Debug, Clone, Copy)]
pub(super) struct Residuals {
    /// Standard deviation, in the unit of the frame.
    pub(super) noise: f64,
    pub(super) normalization: Normalization,
}

/// How long to polish.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Effort {
    /// From afar, a few rounds.
    Rough,
    /// From nearby, until it rests.
    Full,
}
