//! The dependable fit: the number of flats, and the result in the coordinates of the input.

use super::criterion::{could_pay, criterion, most_flats};
use super::frame::Framed;
use super::moments::Moments;
use super::params::{self, NeweError, NeweParams};
use super::polish::{LIMIT, Residuals, nearest};
use super::search::{Found, Search};
use super::{Candidate, Flat, Iterate, Newe, Stage};

/// The noise is taken to be this share of the spread of the points at least: rounding has no smaller scale.
const LEAST_NOISE_REL: f64 = 1e-9;

/// Fits flats to one set of points after another, and keeps its memory: for many small neighbourhoods.
///
/// ```
/// use zeroset::feature::newe::{NeweFitter, NeweParams};
///
/// let mut fitter = NeweFitter::new(NeweParams::default())?;
/// for slope in [0.5, 1.0] {
///     let ridge: Vec<[f64; 3]> = (0..60)
///         .map(|i| [f64::from(i % 10) - 4.5, f64::from(i / 10)])
///         .map(|[x, y]| [x, y, -slope * x.abs()])
///         .collect();
///     assert_eq!(fitter.fit_with_noise(&ridge, 0.02)?.flats.len(), 2);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct NeweFitter<const D: usize> {
    params: NeweParams,
    framed: Framed<D>,
    search: Search<D>,
    labels: Vec<Option<usize>>,
    costs: Vec<f64>,
}

impl<const D: usize> NeweFitter<D> {
    /// A fitter with these parameters.
    ///
    /// # Errors
    /// [`NeweError`] if they make no sense.
    pub fn new(params: NeweParams) -> Result<Self, NeweError> {
        params.check()?;
        Ok(Self { params, framed: Framed::default(), search: Search::default(), labels: Vec::new(), costs: Vec::new() })
    }

    /// Fits flats to points, in any order.
    ///
    /// # Errors
    /// [`NeweError`] if a point is not finite, coordinates are too large, or there are fewer points than D for each flat.
    pub fn fit(&mut self, points: &[[f64; D]]) -> Result<Newe<D>, NeweError> {
        self.run(points, self.params.noise)
    }

    /// The same, with a noise that is known for these points, in place of that of the parameters.
    ///
    /// # Errors
    /// As [`fit`](Self::fit), and if the noise is negative or not finite.
    pub fn fit_with_noise(&mut self, points: &[[f64; D]], noise: f64) -> Result<Newe<D>, NeweError> {
        params::check_noise(noise)?;
        self.run(points, Some(noise))
    }

    fn run(&mut self, points: &[[f64; D]], noise: Option<f64>) -> Result<Newe<D>, NeweError> {
        let (least, _) = self.params.flats.ends();
        params::check_points(points, least)?;
        self.framed.take(points, self.params.normalization);
        let noise = noise.map(|noise| self.framed.inward(noise));
        let least_noise = LEAST_NOISE_REL * self.framed.spread();
        if !least_noise.is_finite() {
            return Err(NeweError::Extreme);
        }
        let least_noise = least_noise.max(f64::MIN_POSITIVE.sqrt());
        if let Some(noise) = noise
            && least == 1
            && let Some(newe) = self.one_flat(noise.max(least_noise))
        {
            return Ok(newe);
        }
        let residuals = self.search.prepare(&self.framed.points, noise, least_noise, &self.params);
        let most = most_flats::<D>(&self.params, points.len());
        let mut candidates = Vec::new();
        let mut best: Option<(Found<D>, f64)> = None;
        for count in least..=most {
            let fewer = best.as_ref().map(|(found, _)| &found.flats[..]);
            let found = self.search.solve(&self.framed.points, count, fewer, residuals, &self.params);
            if found.flats.len() < count {
                return Err(NeweError::Extreme);
            }
            let score = self.criterion(&found, residuals);
            candidates.push(Candidate { flats: count, objective: found.objective, criterion: score });
            if best.as_ref().is_some_and(|(_, least)| score >= *least) {
                break;
            }
            let more = count < most && could_pay(&self.framed.points, &found.flats, residuals, &mut self.costs);
            best = Some((found, score));
            if !more {
                break;
            }
        }
        let (found, score) = best.ok_or(NeweError::Extreme)?;
        Ok(self.outward(found, score, residuals, candidates))
    }

    /// The flat of all points, if nothing more could pay: most neighbourhoods of a city are flat, and need no search.
    fn one_flat(&mut self, noise: f64) -> Option<Newe<D>> {
        let residuals = Residuals { noise, normalization: self.params.normalization };
        let points = &self.framed.points;
        let flats = vec![Moments::of(points).flat(residuals.normalization)?];
        let mut iterates = Vec::new();
        if self.params.keep_iterates {
            iterates.push(Iterate { stage: Stage::Start, flats: flats.clone() });
        }
        let start = Found { flats, objective: f64::INFINITY, iterates };
        let found = self.search.settle(points, start, residuals, &self.params);
        if could_pay(points, &found.flats, residuals, &mut self.costs) {
            return None;
        }
        let score = self.criterion(&found, residuals);
        let candidate = Candidate { flats: 1, objective: found.objective, criterion: score };
        Some(self.outward(found, score, residuals, vec![candidate]))
    }

    fn criterion(&mut self, found: &Found<D>, residuals: Residuals) -> f64 {
        let counts = self.assign(&found.flats, residuals);
        criterion::<D>(found.objective, &counts, self.framed.points.len())
    }

    /// Assigns all points. Returns how many each flat has.
    fn assign(&mut self, flats: &[Flat<D>], residuals: Residuals) -> Vec<usize> {
        let limit = (LIMIT * residuals.noise).powi(2);
        let mut counts = vec![0; flats.len()];
        self.labels.clear();
        for point in &self.framed.points {
            let (j, squared) = nearest(flats, point);
            let label = (squared <= limit).then_some(j);
            if label.is_some() {
                counts[j] += 1;
            }
            self.labels.push(label);
        }
        counts
    }

    /// The result in the coordinates and the order of the input.
    fn outward(
        &mut self,
        found: Found<D>,
        criterion: f64,
        residuals: Residuals,
        candidates: Vec<Candidate>,
    ) -> Newe<D> {
        let counts = self.assign(&found.flats, residuals);
        let mut order: Vec<usize> = (0..found.flats.len()).collect();
        order.sort_by_key(|&j| std::cmp::Reverse(counts[j]));
        let mut rank = vec![0; order.len()];
        for (new, &old) in order.iter().enumerate() {
            rank[old] = new;
        }
        let mut assignment = vec![None; self.labels.len()];
        for (label, &given) in self.labels.iter().zip(&self.framed.given) {
            assignment[given as usize] = label.map(|j| rank[j]);
        }
        let ordered = |flats: &[Flat<D>]| order.iter().map(|&j| self.framed.flat_outward(&flats[j])).collect();
        let iterate = |i: &Iterate<D>| Iterate { stage: i.stage, flats: ordered(&i.flats) };
        Newe {
            flats: ordered(&found.flats),
            assignment,
            noise: self.framed.outward(residuals.noise),
            objective: found.objective,
            criterion,
            candidates,
            iterates: found.iterates.iter().map(iterate).collect(),
        }
    }
}
