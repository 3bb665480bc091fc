//! The best flats of one number: starts, weighted iterations, polish, exchanges.

use super::params::NeweParams;
use super::polish::{Effort, Polish, Residuals};
use super::starts::Pool;
use super::weighted::{Weighted, as_printed};
use super::{Flat, Iterate, Stage};
use crate::sample::Chance;

/// Points among which starts are searched; of more, evenly chosen ones.
const SEARCHED: usize = 1024;
/// Exponents of the schedule, counted from its end, that refine a start: the first ones would forget it.
const REFINING: usize = 2;
/// Objectives that differ by less than this share are those of the same flats.
const SAME: f64 = 0.003;
/// Ways that lead to the same best flats before the rest are left out. A start has two, so that two starts agree at least.
const AGREE: usize = 3;
/// Keeps the random numbers apart from those of other rooms.
const PURPOSE: u64 = 60;

/// From a start to its polish. Iterations mend starts that miss a flat; but outliers carry them away: with these alone, and no exchanges
/// after them, a corner in space is found in one to five cases of a hundred.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Way {
    Straight,
    Weighted,
}

/// Flats, how good they are, and how they came about.
#[derive(Debug, Clone)]
pub(super) struct Found<const D: usize> {
    pub(super) flats: Vec<Flat<D>>,
    pub(super) objective: f64,
    pub(super) iterates: Vec<Iterate<D>>,
}

/// A search in one set of points, on memory that is kept.
pub(super) struct Search<const D: usize> {
    points: Vec<[f64; D]>,
    pool: Pool<D>,
    weighted: Weighted,
    polish: Polish<D>,
    chance: Chance,
}

impl<const D: usize> Default for Search<D> {
    fn default() -> Self {
        Self {
            points: Vec::new(),
            pool: Pool::default(),
            weighted: Weighted::default(),
            polish: Polish::default(),
            chance: Chance::new(0, PURPOSE, 0),
        }
    }
}

impl<const D: usize> Search<D> {
    /// Makes ready for points, whose noise is measured if it is not given. Returns the noise, which is `least` at least.
    pub(super) fn prepare(
        &mut self,
        points: &[[f64; D]],
        noise: Option<f64>,
        least: f64,
        params: &NeweParams,
    ) -> Residuals {
        let chosen = points.len().min(SEARCHED);
        self.points.clear();
        self.points.extend((0..chosen).map(|i| points[i * points.len() / chosen]));
        self.chance = Chance::new(params.seed, PURPOSE, 0);
        let rough = self.pool.fill(&self.points, &mut self.chance).unwrap_or(0.0);
        let normalization = params.normalization;
        let noise =
            noise.unwrap_or_else(|| self.pool.settle_noise(&self.points, rough, least, normalization)).max(least);
        let residuals = Residuals { noise, normalization };
        self.pool.refine(&self.points, residuals);
        residuals
    }

    /// The best of all starts, after exchanges, polished on all points. `fewer` are the best flats of one number less.
    pub(super) fn solve(
        &mut self,
        points: &[[f64; D]],
        count: usize,
        fewer: Option<&[Flat<D>]>,
        residuals: Residuals,
        params: &NeweParams,
    ) -> Found<D> {
        let mut best: Option<Found<D>> = None;
        let mut agreed = 0;
        'starts: for start in 0..params.starts {
            let flats = self.start(start, count, fewer, residuals, params);
            for way in [Way::Straight, Way::Weighted] {
                // One flat has no others to be weighted by.
                if way == Way::Weighted && flats.len() < 2 {
                    continue;
                }
                let found = self.refine(flats.clone(), way, residuals, params);
                let so_far = best.as_ref().map_or(f64::INFINITY, |b| b.objective);
                if (found.objective - so_far).abs() <= SAME * so_far {
                    agreed += 1;
                } else if found.objective < so_far {
                    agreed = 1;
                }
                if best.is_none() || found.objective < so_far {
                    best = Some(found);
                }
                if agreed >= AGREE {
                    break 'starts;
                }
            }
        }
        let empty = Found { flats: Vec::new(), objective: f64::INFINITY, iterates: Vec::new() };
        let mut best = best.unwrap_or(empty);
        self.exchange(&mut best, residuals, params);
        self.settle(points, best, residuals, params)
    }

    /// Polishes on all points until the flats rest.
    pub(super) fn settle(
        &mut self,
        points: &[[f64; D]],
        mut found: Found<D>,
        residuals: Residuals,
        params: &NeweParams,
    ) -> Found<D> {
        let mut steps = Vec::new();
        found.objective = self.polish.run(points, &mut found.flats, residuals, Effort::Full, |flats| {
            if params.keep_iterates {
                steps.push(Iterate { stage: Stage::Polish, flats: flats.to_vec() });
            }
        });
        // The last refit need not be the best.
        while steps.last().is_some_and(|step| step.flats != found.flats) {
            steps.pop();
        }
        found.iterates.append(&mut steps);
        found
    }

    /// Where start number `start` begins: the flats that explain most, one more beside those of one number less, those of the method as
    /// printed; all others are drawn.
    fn start(
        &mut self,
        start: usize,
        count: usize,
        fewer: Option<&[Flat<D>]>,
        residuals: Residuals,
        params: &NeweParams,
    ) -> Vec<Flat<D>> {
        let mut flats = Vec::with_capacity(count);
        let drawn = match (start, fewer) {
            (0, _) => None,
            (1, Some(fewer)) => {
                flats.extend_from_slice(fewer);
                None
            }
            (2, _) => {
                let (schedule, normalization) = (&params.schedule, params.normalization);
                let mut printed = as_printed(&self.points, count, schedule, normalization, &mut self.weighted);
                flats.extend(printed.pop().map_or(Vec::new(), |last| last.flats));
                None
            }
            _ => Some(&mut self.chance),
        };
        self.pool.complete(&self.points, residuals, &mut flats, count, drawn);
        flats
    }

    /// Weighted iterations, if that is the way, then a rough polish.
    fn refine(&mut self, mut flats: Vec<Flat<D>>, way: Way, residuals: Residuals, params: &NeweParams) -> Found<D> {
        let mut iterates = Vec::new();
        let mut note = |stage, flats: &[Flat<D>]| {
            if params.keep_iterates {
                iterates.push(Iterate { stage, flats: flats.to_vec() });
            }
        };
        note(Stage::Start, &flats);
        let count = flats.len();
        if way == Way::Weighted {
            self.weighted.start(&self.points, &flats);
            for &exponent in &params.schedule[params.schedule.len().saturating_sub(REFINING)..] {
                self.weighted.round(&self.points, &mut flats, count, exponent, residuals.normalization);
                note(Stage::Weighted { exponent }, &flats);
            }
        }
        let polished = |flats: &[Flat<D>]| note(Stage::Polish, flats);
        let objective = self.polish.run(&self.points, &mut flats, residuals, Effort::Rough, polished);
        Found { flats, objective, iterates }
    }

    /// Each flat in turn gives way to the one of the pool that explains most without it, if that is better.
    fn exchange(&mut self, best: &mut Found<D>, residuals: Residuals, params: &NeweParams) {
        for dropped in 0..best.flats.len() {
            let Some(flat) = self.pool.replacement(&self.points, residuals, &best.flats, dropped) else { return };
            let mut flats = best.flats.clone();
            flats[dropped] = flat;
            let start = flats.clone();
            let objective = self.polish.run(&self.points, &mut flats, residuals, Effort::Rough, |_| ());
            if objective < best.objective {
                (best.objective, best.flats) = (objective, flats);
                if params.keep_iterates {
                    best.iterates.push(Iterate { stage: Stage::Exchange, flats: start });
                    best.iterates.push(Iterate { stage: Stage::Polish, flats: best.flats.clone() });
                }
            }
        }
    }
}
