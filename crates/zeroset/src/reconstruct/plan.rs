//! Every default resolved against the cloud.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::scene::SceneEvidence;
use super::{Quality, ReconstructError, Up};
use crate::cloud::{Cloud, Spacing, noise};
use crate::constraint::{ConstraintPlan, Constraints, Local};
use crate::fit::Frame;
use crate::fit::cascade::{FitError, FitParams, PolishParams, Prepared, Scene};
use crate::mesh::SimplifyParams;
use crate::model::{AttributeChoice, SAMPLES_REL};
use crate::monitor::{Monitor, check};
use crate::spatial::PointTree;

/// How fine the lattice is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Resolution {
    /// From the spacing of the points, made coarser where memory asks for it.
    #[default]
    Auto,
    /// A multiple of the spacing of the points, made coarser where memory asks for it.
    Spacings {
        /// For terrain and airborne scenes.
        terrain: f64,
        /// For objects and free scenes.
        body: f64,
    },
    /// A length in the unit of the cloud.
    Length(f64),
    /// The longest side of the padded box is cut into 2^depth cells.
    Depth(u32),
}

/// Which surface is dropped because it lies far from the data.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Trim {
    /// Terrain and airborne scenes: a multiple of the spacing. Objects: off.
    #[default]
    Auto,
    /// Nothing is dropped.
    Off,
    /// Surface farther than this from the data. In terrain and airborne scenes distance is measured in the ground plane and the
    /// surface also ends at the outline of the data.
    Length(f64),
}

/// Which pieces of the mesh are dropped because they are small; see [`drop_small_components`](crate::mesh::drop_small_components).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum MinComponent {
    /// None.
    #[default]
    Off,
    /// Terrain and airborne scenes: those of fewer than 100 triangles, which are about two cells across. Objects keep all: what is
    /// small there may be meant.
    Auto,
    /// Those of fewer triangles, but never the largest.
    Triangles(usize),
}

/// What to reconstruct, and how.
#[derive(Debug, Clone, PartialEq)]
pub struct ReconstructParams {
    /// The scene; `None` decides from the shape of the cloud.
    pub scene: Option<Scene>,
    /// Which way is up.
    pub up: Up,
    /// How fine.
    pub resolution: Resolution,
    /// How much is done for the surface after the fit.
    pub quality: Quality,
    /// Weight of the data term, see [`FitParams`]; `None` takes it from the noise of the points.
    pub screening: Option<f64>,
    /// Weight of smoothness in the polish, without unit; `None` takes the usual one.
    pub smoothness: Option<f64>,
    /// What is dropped far from the data.
    pub trim: Trim,
    /// Which small pieces are dropped.
    pub min_component: MinComponent,
    /// How far the mesh is simplified; `None`: not at all.
    pub simplify: Option<SimplifyParams>,
    /// Values for the vertices.
    pub attributes: AttributeChoice,
    /// Lines and polygons that the surface is to pass through, in the world coordinates of the cloud.
    pub constraints: Constraints,
    /// Most bytes to use; the automatic resolution keeps within it and a given one is refused beyond it.
    pub memory: u64,
}

impl Default for ReconstructParams {
    fn default() -> Self {
        Self {
            scene: None,
            up: Up::default(),
            resolution: Resolution::default(),
            quality: Quality::default(),
            screening: None,
            smoothness: None,
            trim: Trim::default(),
            min_component: MinComponent::default(),
            simplify: None,
            attributes: AttributeChoice::default(),
            constraints: Constraints::default(),
            memory: 16 << 30,
        }
    }
}

/// The automatic resolution over the spacing of the points.
///
/// So a cell of the surface holds about two points. Finer cells would mostly be empty, and the surface be drawn between the points.
const RESOLUTION_REL: f64 = 1.5;
/// The automatic trim of open scenes over the spacing of the points: bridges the shadows of buildings, and canals. On a real tile
/// with eight points a square metre a canal needs 49.5.
const TRIM_REL: f64 = 60.0;
/// The automatic least number of triangles of a piece of an open scene.
const LEAST_TRIANGLES: usize = 100;
/// Noise, over the cell, that [`FitParams::SCREENING`] suits.
const NOISE_REL: f64 = 0.25;
/// The least and the most automatic weight of the data term.
const SCREENING: [f64; 2] = [1.0, 16.0];
/// Fewer points never make a surface.
pub(crate) const LEAST_POINTS: usize = 8;
/// Peak bytes of a whole run for each cell of the finest level that the surface crosses, in a draft and else, and for each point.
///
/// Measured is the peak resident set of `zeroset reconstruct` on two threads. The points alone (3 M, cells of 5 spacings) take
/// 102 bytes each, with the few cells that they then fill. In a draft cells beyond that take 550 (torus), 700 (city) and 745 bytes
/// (airborne city, 1 M points); much noise fills more cells than there is surface, and each takes less. With polish and sharp
/// edges they take 2,400 to 3,200 (bodies), 4,900 (Delft), 5,400 (city) and 6,700 bytes (airborne city).
const BYTES_A_DRAFT_CELL: f64 = 750.0;
const BYTES_A_CELL: f64 = 6700.0;
const BYTES_A_POINT: f64 = 110.0;
/// A box wider than this many spacings holds stray points: 10^9 points would not fill its diagonal plane.
const ASTRAY: f64 = 1e6;

/// What a reconstruction will do, before it is done.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlanReport {
    /// Points used.
    pub points: usize,
    /// Box of the points in world coordinates: lowest and highest corner.
    pub bounds: [[f64; 3]; 2],
    /// Measured spacing of the points.
    pub spacing: f64,
    /// Measured noise: standard deviation of the points across their surface.
    pub noise: f64,
    /// The scene.
    pub scene: Scene,
    /// Why this scene.
    pub scene_reason: String,
    /// Which way is up.
    pub up: Up,
    /// Spacing of the finest lattice.
    pub resolution: f64,
    /// What the resolution would have been without the limit of memory; `None` if that changed nothing.
    pub wanted_resolution: Option<f64>,
    /// Number of levels.
    pub levels: u32,
    /// Cells of the finest level that hold points.
    pub occupied_cells: usize,
    /// Nodes of the finest level to be solved for, expected.
    pub expected_nodes: u64,
    /// Peak memory in bytes, expected.
    pub expected_bytes: u64,
    /// Length beyond which surface is dropped.
    pub trim: Option<f64>,
    /// Weight of the data term.
    pub screening: f64,
    /// How much is done for the surface after the fit.
    pub quality: Quality,
    /// How F is polished; `None` in a draft.
    pub polish: Option<PolishParams>,
    /// The fewest triangles that a piece of the mesh must have; `None`: all pieces stay.
    pub min_component: Option<usize>,
    /// How far the mesh is simplified; `None`: not at all.
    pub simplify: Option<SimplifyParams>,
    /// Values for the vertices.
    pub attributes: AttributeChoice,
    /// The user's lines and polygons; `None` without any.
    pub constraints: Option<ConstraintPlan>,
}

/// A resolved plan, ready to run.
#[derive(Debug)]
pub struct Plan<'a> {
    /// What it will do.
    pub report: PlanReport,
    pub(super) cloud: &'a Cloud,
    pub(crate) prepared: Prepared,
    /// The user's lines and polygons, in the frame of the fit.
    pub(super) known: Local,
    /// Seconds spent on planning.
    pub(super) seconds: f64,
}

/// What is known of points before anything is decided.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Measured {
    /// How many there are.
    pub(crate) points: usize,
    /// Lowest and highest corner of their box, in local coordinates.
    pub(crate) bounds: [[f64; 3]; 2],
    /// What to add to local coordinates.
    pub(crate) world_from_local: [f64; 3],
    pub(crate) spacing: f64,
    /// Standard deviation across the surface.
    pub(crate) noise: f64,
    pub(crate) scene: Scene,
    /// Why this scene.
    pub(crate) scene_reason: String,
}

impl Measured {
    /// Measures all points of a cloud. They must be finite.
    pub(crate) fn of(cloud: &Cloud, params: &ReconstructParams) -> Result<Self, ReconstructError> {
        if cloud.len() < LEAST_POINTS {
            return Err(ReconstructError::TooFewPoints { found: cloud.len(), needed: LEAST_POINTS });
        }
        let upright: Vec<[f64; 3]> = cloud.points.iter().map(|&p| params.up.upright(p)).collect();
        let tree = PointTree::new(&cloud.points);
        let spacing =
            Spacing::with_tree(cloud, &tree).ok_or(ReconstructError::Degenerate { shape: "in one place" })?.median;
        let noise = noise(cloud, &tree).unwrap_or(0.0);
        drop(tree);
        let bounds: [[f64; 3]; 2] = crate::domain::bounds(cloud.points.iter().copied()).into();
        let is_free = matches!(params.resolution, Resolution::Auto | Resolution::Spacings { .. });
        if is_free && extent(bounds) > ASTRAY * spacing {
            return Err(ReconstructError::Astray { extent: extent(bounds), spacing });
        }
        if on_one_line(&upright) {
            return Err(ReconstructError::Degenerate { shape: "on one line" });
        }
        let (scene, scene_reason) = params
            .scene
            .map_or_else(|| SceneEvidence::of(&upright, spacing).verdict(), |scene| (scene, "asked for".to_owned()));
        let world_from_local = cloud.world_from_local;
        Ok(Self { points: cloud.len(), bounds, world_from_local, spacing, noise, scene, scene_reason })
    }

    /// The resolution that is asked for.
    pub(crate) fn wanted(&self, params: &ReconstructParams) -> Result<f64, ReconstructError> {
        Ok(match params.resolution {
            Resolution::Auto => params.quality.resolution_rel() * RESOLUTION_REL * self.spacing,
            Resolution::Spacings { terrain, body } => {
                let value = if matches!(self.scene, Scene::Terrain | Scene::Airborne) { terrain } else { body };
                if !(value.is_finite() && value > 0.0) {
                    return Err(ReconstructError::Length { name: "resolution in spacings", value });
                }
                value * self.spacing
            }
            Resolution::Length(length) if length.is_finite() && length > 0.0 => length,
            Resolution::Length(value) => return Err(ReconstructError::Length { name: "resolution", value }),
            Resolution::Depth(depth) => {
                let cells = 2.0_f64.powi(i32::try_from(depth).unwrap_or(i32::MAX));
                (1.0 + 2.0 * FitParams::PADDING_REL) * extent(self.bounds) / cells
            }
        })
    }

    /// How to fit at a resolution.
    pub(crate) fn fit_params(&self, params: &ReconstructParams, resolution: f64) -> FitParams {
        let screening = params.screening.unwrap_or_else(|| screening_for(self.noise, resolution));
        FitParams { screening, ..FitParams::new(self.scene, resolution) }
    }

    /// Cells that the surface crosses at a resolution, from the area that the points stand for.
    pub(crate) fn surface_cells(&self, resolution: f64) -> usize {
        (1.5 * self.points as f64 * (self.spacing / resolution).powi(2)).min(1e15) as usize
    }

    /// Everything resolved, for lattices of so many levels and points in so many cells of the finest.
    pub(crate) fn report(
        &self,
        params: &ReconstructParams,
        (resolution, wanted): (f64, f64),
        levels: u32,
        occupied_cells: usize,
        known: &Local,
    ) -> PlanReport {
        let cells = occupied_cells.max(self.surface_cells(resolution));
        let placed = self.points.saturating_add(known.count(SAMPLES_REL * resolution));
        let screening = self.fit_params(params, resolution).screening;
        PlanReport {
            points: self.points,
            bounds: self.bounds.map(|corner| std::array::from_fn(|a| corner[a] + self.world_from_local[a])),
            spacing: self.spacing,
            noise: self.noise,
            scene: self.scene,
            scene_reason: self.scene_reason.clone(),
            up: params.up,
            resolution,
            wanted_resolution: (resolution > wanted).then_some(wanted),
            levels,
            occupied_cells,
            expected_nodes: 14 * cells as u64,
            expected_bytes: expected_bytes(params.quality, cells, placed) as u64,
            trim: match (params.trim, self.scene) {
                (Trim::Off, _) | (Trim::Auto, Scene::Object | Scene::Free) => None,
                (Trim::Auto, Scene::Terrain | Scene::Airborne) => Some((TRIM_REL * self.spacing).max(8.0 * resolution)),
                (Trim::Length(length), _) => Some(length),
            },
            screening,
            quality: params.quality,
            polish: params.quality.polish(screening, params.smoothness),
            min_component: match (params.min_component, self.scene) {
                (MinComponent::Off, _) | (MinComponent::Auto, Scene::Object | Scene::Free) => None,
                (MinComponent::Auto, Scene::Terrain | Scene::Airborne) => Some(LEAST_TRIANGLES),
                (MinComponent::Triangles(least), _) => Some(least),
            },
            simplify: params.simplify.clone(),
            attributes: params.attributes,
            constraints: (!known.is_empty()).then_some(known.plan),
        }
    }
}

impl ReconstructParams {
    /// What can be told to be impossible without any point.
    pub(crate) fn check(&self) -> Result<(), ReconstructError> {
        match self.trim {
            Trim::Length(value) if !(value.is_finite() && value > 0.0) => {
                return Err(ReconstructError::Length { name: "trim", value });
            }
            Trim::Length(_) | Trim::Auto | Trim::Off => (),
        }
        Ok(self.simplify.as_ref().map_or(Ok(()), SimplifyParams::check)?)
    }
}

/// The longest side of a box.
fn extent([low, high]: [[f64; 3]; 2]) -> f64 {
    (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max)
}

/// Resolves every default against the cloud. Points must be finite.
///
/// # Errors
/// If the points bear no surface, or the resolution asked for is impossible or needs too much memory.
pub fn plan<'a>(
    cloud: &'a Cloud,
    params: &ReconstructParams,
    monitor: &dyn Monitor,
) -> Result<Plan<'a>, ReconstructError> {
    let start = std::time::Instant::now();
    monitor.stage("measuring the points");
    params.check()?;
    let measured = Measured::of(cloud, params)?;
    check(monitor)?;
    let frame = Frame::new(params.up, measured.scene);
    let points: Vec<[f64; 3]> = cloud.points.par_iter().map(|&p| frame.enter(p)).collect();
    let known = Local::new(
        &params.constraints,
        cloud.world_from_local,
        |p| frame.enter(p),
        crate::domain::bounds(points.iter().copied()),
    );
    if known.is_empty() && !params.constraints.is_empty() {
        return Err(ReconstructError::ConstraintsAstray);
    }
    let wanted = measured.wanted(params)?;
    monitor.stage("sorting the points");
    let over_budget = |resolution: f64, bytes: f64| ReconstructError::Memory {
        resolution,
        needed_gb: bytes / 1e9,
        allowed_gb: params.memory as f64 / 1e9,
        possible: resolution * (bytes / params.memory as f64).sqrt(),
    };
    let is_free = matches!(params.resolution, Resolution::Auto | Resolution::Spacings { .. });
    let mut resolution = wanted;
    let prepared = loop {
        // Before anything is sorted: the surface between the points is there however few cells hold one.
        let placed = cloud.len().saturating_add(known.count(SAMPLES_REL * resolution));
        let least = expected_bytes(params.quality, measured.surface_cells(resolution), placed);
        let needed = if least > params.memory as f64 {
            least
        } else {
            let samples = known.samples(SAMPLES_REL * resolution);
            let fit = measured.fit_params(params, resolution);
            let prepared = Prepared::with_samples(&points, &samples, &fit).map_err(FitError::from)?;
            check(monitor)?;
            let cells = prepared.occupied_cells().max(measured.surface_cells(resolution));
            let needed = expected_bytes(params.quality, cells, placed);
            if needed <= params.memory as f64 {
                break prepared;
            }
            needed
        };
        let coarser = resolution * (needed / params.memory as f64).sqrt().max(1.05);
        if !is_free || coarser > extent(measured.bounds) {
            return Err(over_budget(resolution, needed));
        }
        resolution = coarser;
    };
    let report = measured.report(params, (resolution, wanted), prepared.levels(), prepared.occupied_cells(), &known);
    Ok(Plan { report, cloud, prepared, known, seconds: start.elapsed().as_secs_f64() })
}

/// Peak bytes of a run.
pub(crate) fn expected_bytes(quality: Quality, cells: usize, points: usize) -> f64 {
    let a_cell = if quality == Quality::Draft { BYTES_A_DRAFT_CELL } else { BYTES_A_CELL };
    a_cell * cells as f64 + BYTES_A_POINT * points as f64
}

/// The weight of the data term for points whose noise is this, on cells of this size.
fn screening_for(noise: f64, resolution: f64) -> f64 {
    let [least, most] = SCREENING;
    (FitParams::SCREENING * (NOISE_REL * resolution / noise).powi(2)).clamp(least, most)
}

/// Whether all points lie on one line, but for rounding: the second eigenvalue of their covariance is nothing against the first.
fn on_one_line(points: &[[f64; 3]]) -> bool {
    let n = points.len() as f64;
    let mean: [f64; 3] = std::array::from_fn(|a| points.iter().map(|p| p[a]).sum::<f64>() / n);
    let mut covariance = nalgebra::Matrix3::<f64>::zeros();
    for p in points {
        let d = nalgebra::Vector3::from_fn(|a, _| p[a] - mean[a]);
        covariance += d * d.transpose();
    }
    let mut eigenvalues: Vec<f64> = covariance.symmetric_eigenvalues().iter().copied().collect();
    eigenvalues.sort_by(f64::total_cmp);
    eigenvalues[1] <= 1e-12 * eigenvalues[2]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Scene as Sample, SceneKind};

    #[test]
    fn a_limit_of_memory_makes_the_resolution_coarser_and_says_what_it_would_have_been() {
        let cloud = Sample::new(SceneKind::Torus, 1).points(20_000, 0.001, 1);
        let planned =
            |memory| plan(&cloud, &ReconstructParams { memory, ..ReconstructParams::default() }, &()).unwrap().report;
        let (free, capped) = (planned(16 << 30), planned(10_000_000));
        assert_eq!(free.wanted_resolution, None);
        assert_eq!(capped.wanted_resolution, Some(free.resolution));
        assert!(capped.resolution > free.resolution && capped.expected_bytes <= 10_000_000);
    }

    #[test]
    fn screening_falls_with_the_square_of_the_noise_between_its_bounds() {
        assert_eq!(screening_for(0.25, 1.0), FitParams::SCREENING);
        assert_eq!(screening_for(0.5, 2.0), FitParams::SCREENING);
        assert!((screening_for(0.2, 1.0) - 6.25).abs() < 1e-12);
        assert_eq!((screening_for(0.0, 1.0), screening_for(3.0, 1.0)), (16.0, 1.0));
    }
}
