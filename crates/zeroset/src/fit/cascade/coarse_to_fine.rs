//! The cascade: from the seed on the coarsest lattice to the finest.

use std::borrow::Cow;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::eigen_seed::eigenvectors;
use super::free::{is_clear, potentials, turn_outward};
use super::gradient::{gradient_lengths, linearise, thin_share};
use super::level::{FixedFaces, Level, LevelParams, Nodes};
use super::operator::{apply, energy};
use super::prolong::{Solved, band, complete, prolong};
use super::region::Region;
use super::seed::boundary_potential;
use super::solve::{SolveParams, conjugate_gradients};
use crate::domain::{Cells, Lattice, LatticeError, LatticePoints, bounds};
use crate::field::LatticeField;
use crate::fit::Gradient;
use crate::monitor::{Cancelled, Monitor, check};

/// What is known about the scene before it is fitted. It decides how the sign of F is seeded.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Scene {
    /// A body seen from all sides: everything at the faces of the box is outside.
    Object,
    /// Ground and what stands on it: the top of the box is sky, the bottom is solid.
    Terrain,
    /// Terrain scanned from above, so that walls hold few points: adds the column prior.
    Airborne,
    /// Nothing is known; the sign comes from the smallest eigenvector of the order-2 problem.
    Free,
}

impl Scene {
    fn faces(self) -> FixedFaces {
        match self {
            Self::Object => FixedFaces::All,
            Self::Terrain | Self::Airborne => FixedFaces::TopBottom,
            Self::Free => FixedFaces::None,
        }
    }
}

/// How to fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FitParams {
    /// How the sign is seeded.
    pub scene: Scene,
    /// Spacing of the finest lattice, in the unit of the points.
    pub resolution: f64,
    /// Screening: the weight alpha of the data term. 4 suits noise of a quarter of a cell.
    pub screening: f64,
    /// How far the box around the points reaches beyond them, relative to their longest side.
    pub padding_rel: f64,
}

impl FitParams {
    /// Usual screening, for noise of a quarter of a cell. `reconstruct` sets it from the noise that it measures.
    pub const SCREENING: f64 = 4.0;
    /// Usual padding: room for the field lines of the seed.
    pub const PADDING_REL: f64 = 0.1;

    /// The defaults for a scene at a resolution.
    #[must_use]
    pub fn new(scene: Scene, resolution: f64) -> Self {
        Self { scene, resolution, screening: Self::SCREENING, padding_rel: Self::PADDING_REL }
    }
}

/// A fit that could not be made.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// The lattice cannot be made.
    #[error(transparent)]
    Lattice(#[from] LatticeError),
    /// The screening weight is not a positive number.
    #[error("a screening of {0} is not possible: give a positive number")]
    Screening(f64),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// One step of a level.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Iteration {
    /// The gradient in N. R never rises from step to step with the same one; from one gradient to the other it is not comparable.
    pub gradient: Gradient,
    /// R(F) per occupied cell before the step.
    pub rayleigh_quotient: f64,
    /// Steps of conjugate gradients.
    pub solver_steps: usize,
}

/// What happened on a level.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LevelReport {
    /// Level; 0 is the coarsest.
    pub level: u32,
    /// Spacing of the lattice.
    pub spacing: f64,
    /// Cells that hold points.
    pub occupied_cells: usize,
    /// Nodes whose value was sought.
    pub free_nodes: u64,
    /// Bytes of the level and its solver.
    pub bytes: usize,
    /// Wall time.
    pub seconds: f64,
    /// Whether a new seed on this level beat the one continued from the level before.
    pub seeded: bool,
    /// The lowest R(F) of the rejected starts, where several were compared.
    pub other_rayleigh_quotient: Option<f64>,
    /// Free scenes, on dense levels: share of the nodes on the faces of the box that are outside. A body has 1; near 1/2 the surface cuts
    /// the box, and its upper side was taken for outside.
    pub outside_share: Option<f64>,
    /// Share of the samples that have a second sheet within about a cell; `None` on the first levels.
    pub thin_share: Option<f64>,
    /// Whether the body was taken for thin-walled on this level.
    pub thin_walled: bool,
    /// Step by step.
    pub iterations: Vec<Iteration>,
    /// R(F) per occupied cell at the end.
    pub rayleigh_quotient: f64,
    /// |grad F| at the data, 5, 50 and 95 %.
    pub gradient_quantiles: [f64; 3],
}

/// What happened in a fit.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct FitReport {
    /// Level by level, coarsest first.
    pub levels: Vec<LevelReport>,
    /// Largest number of bytes held at once by the levels and the solver.
    pub peak_bytes: usize,
}

impl FitReport {
    /// Free scenes: whether one side of the surface is clearly outside. `None` for other scenes.
    #[must_use]
    pub fn outside_is_clear(&self) -> Option<bool> {
        self.levels.iter().rev().find_map(|level| level.outside_share).map(is_clear)
    }
}

/// Most steps on each level; the last entry serves all further levels.
///
/// On a fine level the second step does most of what can be done, and later ones begin to follow the noise: a city of 10^6 points
/// with noise of half a cell lies 0.00027 from the truth after four steps, 0.00025 after two.
const STEPS: [usize; 4] = [30, 15, 6, 2];
/// How well each step is solved. With a tolerance of 1e-3 the fit takes half as long again, and no share or distance measured
/// changes by more than a hundredth.
const SOLVE: SolveParams = SolveParams { tolerance: 1e-2, max_steps: 200 };
/// A body is thin-walled if at least this share of the samples of the last dense level has a second sheet within about a cell.
///
/// Measured in the turned frame: plates and trays with walls of half a cell 0.33 to 0.77, bodies without thin walls up to 0.065 (a
/// part with ribs).
const THIN_SHARE: f64 = 0.15;
/// Steps with the recovered gradient at the end of a thin-walled body. They fill the walls: of a plate with pockets 0.60 of the
/// volume is shared with the truth before, 0.73 after one step, 0.78 after four; but a tray fifteen times as deep as its walls
/// are thick then begins to flood (0.52, 0.52, 0.47).
const FINISH: usize = 2;
/// A new seed is tried on a thin-walled body while a level has at most this many nodes across: it can hardly be won back later.
const MAX_THIN_SEED_NODES: u32 = 192;
/// The share of a whole reconstruction that the fit takes, for the monitor.
pub(crate) const SHARE: f64 = 0.9;
/// A level is at rest when a step lowers R by less than this share.
const AT_REST: f64 = 3e-4;
/// A new seed is tried while a level has at most this many nodes across.
const MAX_SEED_NODES: u32 = 96;
/// A new seed replaces the continued F if its R is lower by more than this share.
const SEED_MARGIN: f64 = 0.015;

/// F on a level, and how it came about.
struct Fitted {
    solved: Solved,
    report: LevelReport,
}

/// Points placed on their lattices and sorted, ready to be fitted.
#[derive(Debug)]
pub struct Prepared {
    lattice: Lattice,
    points: LatticePoints,
    params: FitParams,
    occupied_cells: usize,
}

impl Prepared {
    /// Places and sorts finite points.
    ///
    /// # Errors
    /// If the lattice cannot be made.
    pub fn new(points: &[[f64; 3]], params: &FitParams) -> Result<Self, LatticeError> {
        Self::with_samples(points, &[], params)
    }

    /// The same with further positions on which F is to vanish, within the padding of the box around the points, which is the same with
    /// them and without.
    pub(crate) fn with_samples(
        points: &[[f64; 3]],
        samples: &[[f64; 3]],
        params: &FitParams,
    ) -> Result<Self, LatticeError> {
        let (low, high) = bounds(points.iter().copied());
        let lattice = Lattice::around(low, high, params.resolution, params.padding_rel)?;
        Ok(Self::on(lattice, points, samples, params))
    }

    /// The same on a lattice that is there.
    pub(crate) fn on(lattice: Lattice, points: &[[f64; 3]], samples: &[[f64; 3]], params: &FitParams) -> Self {
        let points = if samples.is_empty() {
            LatticePoints::new(&lattice, points)
        } else {
            LatticePoints::new(&lattice, &[points, samples].concat())
        };
        let occupied_cells = Cells::new(&lattice, &points, lattice.finest).len();
        Self { lattice, points, params: params.clone(), occupied_cells }
    }

    /// Cells of the finest level that hold points. Cost of the fit and size of the mesh are proportional to it.
    #[must_use]
    pub fn occupied_cells(&self) -> usize {
        self.occupied_cells
    }

    /// Number of levels.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.lattice.finest + 1
    }

    /// Fits F.
    ///
    /// # Errors
    /// If the screening is not positive, or the monitor asks to stop.
    pub fn fit(self, monitor: &dyn Monitor) -> Result<(LatticeField, FitReport), FitError> {
        let last = self.lattice.finest;
        self.cascade(None, monitor)?.run(last)
    }

    /// Fits F on the levels from the coarsest to this one only: what [`Self::refine`] starts from.
    ///
    /// # Errors
    /// As for [`Self::fit`].
    pub(crate) fn coarse(self, last: u32, monitor: &dyn Monitor) -> Result<(LatticeField, FitReport), FitError> {
        self.cascade(None, monitor)?.run(last)
    }

    /// Fits F on the levels after a coarse one, in a region. The points are those of the region on each level, and may be fewer far from its midst.
    ///
    /// # Errors
    /// As for [`Self::fit`].
    pub(crate) fn refine(
        self,
        coarse: &LatticeField,
        region: &Region,
        monitor: &dyn Monitor,
    ) -> Result<(LatticeField, FitReport), FitError> {
        let start = region.of_coarse(coarse);
        self.cascade(Some(region), monitor)?.go_on(start)
    }

    fn cascade<'a>(self, region: Option<&'a Region>, monitor: &'a dyn Monitor) -> Result<Cascade<'a>, FitError> {
        let Self { lattice, points, params, .. } = self;
        if !(params.screening.is_finite() && params.screening > 0.0) {
            return Err(FitError::Screening(params.screening));
        }
        Ok(Cascade { lattice, points, params, region, monitor })
    }
}

/// Fits F to finite points: [`Prepared::new`] and [`Prepared::fit`] in one.
///
/// # Errors
/// If the lattice cannot be made, the screening is not positive, or the monitor asks to stop.
pub fn fit(
    points: &[[f64; 3]],
    params: &FitParams,
    monitor: &dyn Monitor,
) -> Result<(LatticeField, FitReport), FitError> {
    Prepared::new(points, params)?.fit(monitor)
}

struct Cascade<'a> {
    lattice: Lattice,
    points: LatticePoints,
    params: FitParams,
    /// Where F is looked for on levels that are refined; `None`: everywhere.
    region: Option<&'a Region>,
    monitor: &'a dyn Monitor,
}

impl Cascade<'_> {
    /// From the seed to a level.
    fn run(&self, last: u32) -> Result<(LatticeField, FitReport), FitError> {
        let mut report = FitReport::default();
        let levels = self.lattice.finest + 1;
        self.monitor.stage(&format!("fitting level 1 of {levels}"));
        let mut current = self.seeded(0)?;
        for index in 1..=last {
            self.monitor.share(self.share_before(index));
            self.monitor.stage(&format!("fitting level {} of {levels}", index + 1));
            report.levels.push(current.report.clone());
            let thin = current.report.thin_walled;
            let most = if thin { MAX_THIN_SEED_NODES } else { MAX_SEED_NODES };
            current = if self.is_dense(index, most) {
                self.climb(current, index)?
            } else {
                let LevelReport { thin_share, thin_walled, .. } = current.report;
                self.refined(&current.solved, index, (thin_share, thin_walled))?
            };
        }
        self.monitor.share(self.share_before(last + 1));
        report.levels.push(current.report);
        Ok(self.finished_at(current.solved, report))
    }

    /// From the level after one that is solved to the finest.
    fn go_on(&self, mut solved: Solved) -> Result<(LatticeField, FitReport), FitError> {
        let mut report = FitReport::default();
        for index in solved.index + 1..=self.lattice.finest {
            self.monitor.share(self.share_before(index));
            self.monitor.stage(&format!("fitting level {} of {}", index + 1, self.lattice.finest + 1));
            let fitted = self.refined(&solved, index, (None, false))?;
            solved = fitted.solved;
            report.levels.push(fitted.report);
        }
        Ok(self.finished_at(solved, report))
    }

    /// F on a level as a lattice of its own.
    fn finished_at(&self, solved: Solved, mut report: FitReport) -> (LatticeField, FitReport) {
        report.peak_bytes = report.levels.iter().map(|l| l.bytes).max().unwrap_or(0);
        let Solved { index, blocks, known, f } = solved;
        (LatticeField::new(self.lattice.up_to(index), blocks, known, f), report)
    }

    /// The share of the whole work that is done before a level. A level costs about four times as much as the one before.
    fn share_before(&self, index: u32) -> f64 {
        SHARE * 4.0_f64.powi(index as i32 - self.lattice.finest as i32 - 1)
    }

    fn level_params(&self) -> LevelParams {
        LevelParams {
            alpha: self.params.screening as f32,
            faces: self.params.scene.faces(),
            column_prior: self.params.scene == Scene::Airborne,
        }
    }

    fn dense_level(&self, index: u32) -> Level {
        let cells = Cells::new(&self.lattice, &self.points, index);
        let params = self.level_params();
        let nodes = Nodes::dense(&self.lattice, cells, index, &params);
        let mut level = Level::new(&self.lattice, &self.points, index, nodes, &params);
        if self.is_open() {
            level.gradient = Gradient::Recovered;
        }
        level
    }

    /// Seeds anew on a dense level and iterates to rest.
    fn seeded(&self, index: u32) -> Result<Fitted, FitError> {
        let start = Instant::now();
        let mut level = self.dense_level(index);
        let (f, report) = self.seed_on(&mut level, None, start)?;
        self.settled(level, f, report, start)
    }

    /// Iterates from every start that the scene knows of, and keeps the lowest R. `continued` is F from the level before.
    fn seed_on(
        &self,
        level: &mut Level,
        continued: Option<&[f32]>,
        start: Instant,
    ) -> Result<(Vec<f32>, LevelReport), FitError> {
        let starts = match (self.params.scene, continued) {
            (Scene::Free, None) => eigenvectors(level, self.params.screening, self.monitor)?,
            (Scene::Free, Some(continued)) => potentials(level, continued),
            (scene, _) => vec![boundary_potential(level, scene.faces())],
        };
        let mut tried = Vec::with_capacity(starts.len());
        for f in starts {
            tried.push(self.iterate(level, f, STEPS[0], start)?);
        }
        tried.sort_by(|a, b| a.1.rayleigh_quotient.total_cmp(&b.1.rayleigh_quotient));
        let other_rayleigh_quotient = tried.get(1).map(|other| other.1.rayleigh_quotient);
        let (f, report) = tried.swap_remove(0);
        Ok((f, LevelReport { seeded: true, other_rayleigh_quotient, ..report }))
    }

    /// Both continues and seeds anew on a dense level, and keeps the lower R.
    fn climb(&self, coarse: Fitted, index: u32) -> Result<Fitted, FitError> {
        let start = Instant::now();
        let mut level = self.dense_level(index);
        let f = prolong(&coarse.solved, &level.blocks, &level.known);
        drop(coarse);
        let (continued, old) = self.iterate(&level, f, STEPS[0], start)?;
        let (seeded, new) = self.seed_on(&mut level, Some(&continued), start)?;
        let seconds = start.elapsed().as_secs_f64();
        let wins = new.rayleigh_quotient < (1.0 - SEED_MARGIN) * old.rayleigh_quotient;
        let (f, kept, other) = if wins { (seeded, new, old) } else { (continued, old, new) };
        let report = LevelReport { other_rayleigh_quotient: Some(other.rayleigh_quotient), seconds, ..kept };
        self.settled(level, f, report, start)
    }

    /// Ends a dense level. Where the first seeds end it is decided whether walls are thin: if so, F stays as it is; else it goes
    /// on to rest with the recovered gradient.
    fn settled(
        &self,
        mut level: Level,
        mut f: Vec<f32>,
        report: LevelReport,
        start: Instant,
    ) -> Result<Fitted, FitError> {
        let outside_share = (self.params.scene == Scene::Free).then(|| turn_outward(&level, &mut f));
        let report = LevelReport { outside_share, ..report };
        if self.is_open() || self.is_dense(level.index + 1, MAX_SEED_NODES) {
            return Ok(Fitted { solved: level.into_solved(f), report });
        }
        let thin = thin_share(&level, &f);
        let report = LevelReport { thin_share: Some(thin), thin_walled: thin >= THIN_SHARE, ..report };
        let (f, report) = if report.thin_walled {
            self.finished(&mut level, f, report, start)?
        } else {
            self.smoothed(&mut level, f, report, STEPS[1], start)?
        };
        Ok(Fitted { solved: level.into_solved(f), report })
    }

    /// On the finest level, F of a thin-walled body gets a few steps with the recovered gradient.
    fn finished(
        &self,
        level: &mut Level,
        f: Vec<f32>,
        report: LevelReport,
        start: Instant,
    ) -> Result<(Vec<f32>, LevelReport), FitError> {
        if level.index < self.lattice.finest { Ok((f, report)) } else { self.smoothed(level, f, report, FINISH, start) }
    }

    /// Goes on with the recovered gradient; the report tells of both.
    fn smoothed(
        &self,
        level: &mut Level,
        f: Vec<f32>,
        before: LevelReport,
        steps: usize,
        start: Instant,
    ) -> Result<(Vec<f32>, LevelReport), FitError> {
        level.gradient = Gradient::Recovered;
        let (f, last) = self.iterate(level, f, steps, start)?;
        let mut iterations = before.iterations;
        iterations.extend(last.iterations);
        let LevelReport { rayleigh_quotient, gradient_quantiles, seconds, .. } = last;
        Ok((f, LevelReport { iterations, rayleigh_quotient, gradient_quantiles, seconds, ..before }))
    }

    /// Ground has one sheet nearly everywhere; what thin share it has comes from trees, which are no walls.
    fn is_open(&self) -> bool {
        matches!(self.params.scene, Scene::Terrain | Scene::Airborne)
    }

    /// Whether a level is there and has at most so many nodes across.
    fn is_dense(&self, index: u32, most: u32) -> bool {
        index <= self.lattice.finest && self.lattice.nodes_at(index).into_iter().all(|n| n <= most)
    }

    /// The points that take part on a level that is refined.
    fn points_at(&self, index: u32) -> Cow<'_, LatticePoints> {
        self.region
            .map_or(Cow::Borrowed(&self.points), |region| Cow::Owned(region.points(&self.lattice, &self.points, index)))
    }

    /// Continues on the band of the next level. It is told whether walls are thin, and how many of them.
    fn refined(
        &self,
        coarse: &Solved,
        index: u32,
        (thin_share, thin_walled): (Option<f64>, bool),
    ) -> Result<Fitted, FitError> {
        let start = Instant::now();
        let points = &*self.points_at(index);
        let cells = Cells::new(&self.lattice, points, index);
        let params = self.level_params();
        let nodes = band(&self.lattice, points, cells, coarse, &params, self.region);
        let mut level = Level::new(&self.lattice, points, index, nodes, &params);
        if !thin_walled {
            level.gradient = Gradient::Recovered;
        }
        let f = prolong(coarse, &level.blocks, &level.known);
        let steps = STEPS[(index as usize).min(STEPS.len() - 1)];
        let (f, report) = self.iterate(&level, f, steps, start)?;
        let report = LevelReport { thin_share, thin_walled, ..report };
        let (f, report) = if thin_walled { self.finished(&mut level, f, report, start)? } else { (f, report) };
        let solved = complete(level.into_solved(f), coarse, self.region);
        Ok(Fitted { solved, report: LevelReport { seconds: start.elapsed().as_secs_f64(), ..report } })
    }

    /// Inverse power steps on a level until R rests.
    fn iterate(
        &self,
        level: &Level,
        mut f: Vec<f32>,
        steps: usize,
        start: Instant,
    ) -> Result<(Vec<f32>, LevelReport), FitError> {
        let n = level.len();
        let (mut r, mut p, mut q, mut s) = (vec![0.0_f32; n], vec![0.0_f32; n], vec![0.0_f32; n], vec![0.0_f32; n]);
        let occupied = level.cells.len() as f64;
        let mut iterations: Vec<Iteration> = Vec::with_capacity(steps);
        let mut last = f64::INFINITY;
        let mut quotient = f64::INFINITY;
        for step in 0..=steps {
            check(self.monitor)?;
            // A dense level may be iterated on several times, and its share must not fall.
            if !self.is_dense(level.index, MAX_THIN_SEED_NODES) {
                let (before, after) = (self.share_before(level.index), self.share_before(level.index + 1));
                self.monitor.share(before + (after - before) * step as f64 / (steps + 1) as f64);
            }
            let norm = linearise(level, &f, [&mut p, &mut q, &mut s], &mut r);
            let energy = energy(level, &f);
            quotient = energy * occupied / (norm * norm);
            if step == steps || last - quotient < AT_REST * quotient {
                break;
            }
            last = quotient;
            let scale = rescale_and_residual(level, &mut f, &mut r, &mut q, norm / energy);
            let solver_steps = conjugate_gradients(level, &mut f, &mut r, [&mut p, &mut q, &mut s], scale, SOLVE);
            iterations.push(Iteration { gradient: level.gradient, rayleigh_quotient: quotient, solver_steps });
        }
        let report = LevelReport {
            level: level.index,
            spacing: self.lattice.spacing_at(level.index),
            occupied_cells: level.cells.len(),
            free_nodes: level.free_nodes(),
            bytes: level.bytes() + 5 * 4 * n,
            seconds: start.elapsed().as_secs_f64(),
            seeded: false,
            other_rayleigh_quotient: None,
            outside_share: None,
            thin_share: None,
            thin_walled: false,
            iterations,
            rayleigh_quotient: quotient,
            gradient_quantiles: gradient_lengths(level, &f),
        };
        Ok((f, report))
    }
}

/// Scales F by its best multiple and turns the right-hand side in `r` into the residual; returns the norm of the former.
fn rescale_and_residual(level: &Level, f: &mut [f32], r: &mut [f32], q: &mut [f32], best: f64) -> f64 {
    use rayon::prelude::*;
    apply(level, f, q);
    let best = best as f32;
    let partial: Vec<f64> = f
        .par_chunks_exact_mut(512)
        .zip(r.par_chunks_exact_mut(512).zip(q.par_chunks_exact(512)))
        .with_min_len(32)
        .map(|(f, (r, q))| {
            let mut square = 0.0_f32;
            for k in 0..512 {
                square += r[k] * r[k];
                f[k] *= best;
                r[k] -= best * q[k];
            }
            f64::from(square)
        })
        .collect();
    partial.into_iter().sum::<f64>().sqrt()
}
