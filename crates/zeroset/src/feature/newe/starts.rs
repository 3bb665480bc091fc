//! Where the search starts: flats of small neighbourhoods, and what they would explain.

use super::moments::Moments;
use super::polish::{LIMIT, Residuals, nearest};
use super::{Flat, Normalization};
use crate::sample::Chance;

/// Neighbourhoods that are tried, at least and at most. With 24 of them, three notches in a hundred with 600 points and as many outliers as a
/// quarter of these lack a good flat for a small face; with 48 none in two hundred does.
const SEEDS: [usize; 2] = [24, 48];
/// One neighbourhood for so many points, between these ends.
const SEEDS_SHARE: usize = 8;
/// One point in so many belongs to a neighbourhood, if these are enough: wide against the noise where points are dense, small against the flats.
const SHARE: usize = 20;
/// The wider surroundings, in neighbourhoods.
const WIDER: usize = 3;
/// The share of a neighbourhood that its flat is fitted to: the rest may lie beyond an edge or anywhere.
const TRIM: f64 = 0.7;
/// How often it is fitted anew.
const TRIMMED_FITS: usize = 2;
/// Variance of the seven tenths of normal numbers that are smallest in size.
const TRIMMED_VARIANCE: f64 = 0.309;
/// The rank, among all neighbourhoods, of the one whose variance tells the noise: many hold an edge.
const NOISE_RANK: f64 = 0.3;
/// Where the noise starts to settle, over what the neighbourhoods tell. From below it can rest where several narrow flats lie beside one
/// another (at 0.7, one flat of 100 points in five), from far above where one wide flat swallows four (at 2, one roof in ten).
const NOISE_FROM: f64 = 1.15;
/// Rounds in which it settles.
const NOISE_ROUNDS: usize = 6;
/// Most flats that it is measured from.
const NOISE_FLATS: usize = 6;
/// The share of the points that a flat must explain to be among them: noise alone makes smaller ones.
const NOISE_GAIN: f64 = 0.12;
/// Deviation over median size of normal numbers that are at most three deviations large.
const MEDIAN_TO_DEVIATION: f64 = 1.49;

fn by_value(a: &(f64, u32), b: &(f64, u32)) -> std::cmp::Ordering {
    a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))
}

/// Flats of small neighbourhoods.
#[derive(Debug)]
pub(super) struct Pool<const D: usize> {
    pub(super) flats: Vec<Flat<D>>,
    variances: Vec<f64>,
    near: Vec<(f64, u32)>,
    /// For each flat the truncated squared distances of all points.
    costs: Vec<f64>,
    current: Vec<f64>,
    gains: Vec<f64>,
    totals: Vec<(f64, u32)>,
    kept: Vec<u32>,
}

impl<const D: usize> Default for Pool<D> {
    fn default() -> Self {
        Self {
            flats: Vec::new(),
            variances: Vec::new(),
            near: Vec::new(),
            costs: Vec::new(),
            current: Vec::new(),
            gains: Vec::new(),
            totals: Vec::new(),
            kept: Vec::new(),
        }
    }
}

impl<const D: usize> Pool<D> {
    /// Takes neighbourhoods of points evenly from the mean outwards: the flat of trimmed least squares of each, and a flat through D
    /// random points of its wider surroundings. Returns a rough measure of the noise across the former.
    pub(super) fn fill(&mut self, points: &[[f64; D]], chance: &mut Chance) -> Option<f64> {
        self.flats.clear();
        self.variances.clear();
        let seeds = (points.len() / SEEDS_SHARE).clamp(SEEDS[0], SEEDS[1]).min(points.len());
        let size = (points.len() / SHARE).max(2 * D + 2).min(points.len());
        let wide = (WIDER * size).min(points.len());
        for seed in 0..seeds {
            let centre = &points[(2 * seed + 1) * points.len() / (2 * seeds)];
            self.near.clear();
            self.near.extend(points.iter().zip(0..).map(|(p, i)| {
                let squared: f64 = (0..D).map(|a| (p[a] - centre[a]).powi(2)).sum();
                (squared, i)
            }));
            if wide < points.len() {
                self.near.select_nth_unstable_by(wide - 1, by_value);
            }
            // In an order of their own, so that sums do not depend on how the selection went about.
            self.near[..wide].sort_unstable_by(by_value);
            let mut tuple = Moments::ZERO;
            for _ in 0..D {
                tuple.add(&points[self.near[(chance.uniform() * wide as f64) as usize].1 as usize], 1.0);
            }
            if let Some((flat, variance)) = self.trimmed(points, size) {
                self.flats.push(flat);
                self.variances.push(variance);
            }
            self.flats.extend(tuple.affine().map(|(flat, _)| flat));
        }
        self.variances.sort_unstable_by(f64::total_cmp);
        let rank = (NOISE_RANK * self.variances.len() as f64) as usize;
        self.variances.get(rank).map(|variance| variance.sqrt())
    }

    /// The flat of least squares of the `size` nearest points, and again of those that lie closest to it; with a rough variance.
    fn trimmed(&mut self, points: &[[f64; D]], size: usize) -> Option<(Flat<D>, f64)> {
        let near = &mut self.near[..size];
        let kept = (D + 1).max((TRIM * size as f64).ceil() as usize).min(size);
        let (mut flat, _) = Moments::of(near.iter().map(|n| &points[n.1 as usize])).affine()?;
        let mut variance = 0.0;
        for _ in 0..TRIMMED_FITS {
            for n in near.iter_mut() {
                n.0 = flat.signed_distance(&points[n.1 as usize]).powi(2);
            }
            near.sort_unstable_by(by_value);
            (flat, variance) = Moments::of(near[..kept].iter().map(|n| &points[n.1 as usize])).affine()?;
        }
        Some((flat, variance * kept as f64 / (kept.saturating_sub(D).max(1) as f64 * TRIMMED_VARIANCE)))
    }

    /// The noise that the points themselves show: from a rough one, by the median distance from the flats that explain most, until it
    /// rests. Flats are refined on the way.
    pub(super) fn settle_noise(
        &mut self,
        points: &[[f64; D]],
        rough: f64,
        least: f64,
        normalization: Normalization,
    ) -> f64 {
        let mut noise = (NOISE_FROM * rough).max(least);
        for _ in 0..NOISE_ROUNDS {
            self.refine(points, Residuals { noise, normalization });
            let mut flats = Vec::new();
            let limit = (LIMIT * noise).powi(2);
            while flats.len() < NOISE_FLATS {
                self.measure_gains(points, LIMIT * noise, flats.iter().copied());
                let pick = first_largest(&self.gains);
                if self.gains.get(pick).is_none_or(|gain| *gain < NOISE_GAIN * limit * points.len() as f64) {
                    break;
                }
                flats.push(self.flats[pick]);
            }
            self.variances.clear();
            self.variances.extend(points.iter().map(|p| nearest(&flats, p).1).filter(|squared| *squared < limit));
            let middle = self.variances.len() / 2;
            if self.variances.is_empty() {
                break;
            }
            let (_, median, _) = self.variances.select_nth_unstable_by(middle, f64::total_cmp);
            let now = (median.sqrt() * MEDIAN_TO_DEVIATION).max(least);
            let rests = (now / noise - 1.0).abs() < 0.05;
            noise = now;
            if rests {
                break;
            }
        }
        noise
    }

    /// Fits every flat anew to the points near it, twice, and notes what each would explain.
    pub(super) fn refine(&mut self, points: &[[f64; D]], residuals: Residuals) {
        let limit = (LIMIT * residuals.noise).powi(2);
        for flat in &mut self.flats {
            for reach in [4.0 * limit, limit] {
                let near = points.iter().filter(|p| flat.signed_distance(p).powi(2) <= reach);
                let sums = Moments::of(near);
                if sums.weight() > D as f64
                    && let Some(refitted) = sums.flat(residuals.normalization)
                {
                    *flat = refitted;
                }
            }
        }
        self.costs.clear();
        for flat in &self.flats {
            self.costs.extend(points.iter().map(|p| flat.signed_distance(p).powi(2).min(limit)));
        }
        self.drop_doubles(points.len(), residuals.noise);
        self.current.resize(points.len(), limit);
    }

    /// Keeps of flats that nearly agree the one that costs least.
    fn drop_doubles(&mut self, points: usize, noise: f64) {
        self.totals.clear();
        self.totals.extend(self.costs.chunks_exact(points).map(|costs| costs.iter().sum::<f64>()).zip(0..));
        self.totals.sort_unstable_by(by_value);
        self.kept.clear();
        for &(_, index) in &self.totals {
            let flat = self.flats[index as usize];
            if self.kept.iter().all(|&other| !flat.agrees(&self.flats[other as usize], noise)) {
                self.kept.push(index);
            }
        }
        // In the order in which they were found, so that rows only move forward.
        self.kept.sort_unstable();
        for (new, &old) in self.kept.iter().enumerate() {
            let old = old as usize;
            self.flats[new] = self.flats[old];
            self.costs.copy_within(old * points..(old + 1) * points, new * points);
        }
        self.flats.truncate(self.kept.len());
        self.costs.truncate(self.kept.len() * points);
    }

    /// What each flat of the pool would take off the cost that these flats leave.
    fn measure_gains(&mut self, points: &[[f64; D]], limit: f64, flats: impl Iterator<Item = Flat<D>>) {
        self.current.fill(limit * limit);
        for flat in flats {
            for (cost, point) in self.current.iter_mut().zip(points) {
                *cost = cost.min(flat.signed_distance(point).powi(2));
            }
        }
        self.gains.clear();
        for costs in self.costs.chunks_exact(points.len()) {
            let gain = costs.iter().zip(&self.current).map(|(cost, now)| (now - cost).max(0.0)).sum();
            self.gains.push(gain);
        }
    }

    /// Adds flats of the pool until there are `count`: each the one that explains most of what is left, or one drawn with a chance that
    /// grows with the square of that.
    pub(super) fn complete(
        &mut self,
        points: &[[f64; D]],
        residuals: Residuals,
        flats: &mut Vec<Flat<D>>,
        count: usize,
        mut drawn: Option<&mut Chance>,
    ) {
        while flats.len() < count && !self.flats.is_empty() {
            self.measure_gains(points, LIMIT * residuals.noise, flats.iter().copied());
            let total: f64 = self.gains.iter().map(|g| g * g).sum();
            let pick = match &mut drawn {
                Some(chance) if total > 0.0 => {
                    let mut left = chance.uniform() * total;
                    let taken = |gain: &f64| {
                        left -= gain * gain;
                        left < 0.0
                    };
                    self.gains.iter().position(taken).unwrap_or(0)
                }
                _ => first_largest(&self.gains),
            };
            flats.push(self.flats[pick]);
        }
    }

    /// The flat of the pool that explains most of what these leave without the one at `dropped`.
    pub(super) fn replacement(
        &mut self,
        points: &[[f64; D]],
        residuals: Residuals,
        flats: &[Flat<D>],
        dropped: usize,
    ) -> Option<Flat<D>> {
        let others = flats.iter().enumerate().filter(|(m, _)| *m != dropped).map(|(_, flat)| *flat);
        self.measure_gains(points, LIMIT * residuals.noise, others);
        self.flats.get(first_largest(&self.gains)).copied()
    }
}

fn first_largest(values: &[f64]) -> usize {
    let mut best = 0;
    for (i, value) in values.iter().enumerate() {
        if *value > values[best] {
            best = i;
        }
    }
    best
}
