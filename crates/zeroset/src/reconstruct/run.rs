//! Fit, extract, trim, finish.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::attributes::transfer;
use super::frame::Frame;
use super::plan::SAMPLES_REL;
use super::structure::{Structure, StructureReport};
use super::{Plan, PlanReport, Quality, ReconstructError};
use crate::cloud::Cloud;
use crate::constraint::{ConstraintReport, Local, imprint};
use crate::contour::{ColumnOutline, ContourReport, HalfSpace, SharpReport, clip, contour};
use crate::fit::cascade::{self, FitReport, PolishReport, Scene};
use crate::mesh::{DroppedComponents, Mesh, SimplifyReport, drop_small_components, simplify};
use crate::monitor::{Monitor, Part, Steps, check};
use crate::spatial::PointTree;

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Default)]
pub struct StageSeconds {
    /// Spacing, scene, placing and sorting of the points.
    pub plan: f64,
    /// The cascade.
    pub fit: f64,
    /// Planes, where the surface is to be sharp.
    pub structure: f64,
    /// The polish of F.
    pub polish: f64,
    /// Extraction with trim.
    pub contour: f64,
    /// Vertices on planes, edges and corners.
    pub sharpen: f64,
    /// Dropping of small pieces and simplification.
    pub simplify: f64,
    /// Values for the vertices.
    pub attributes: f64,
}

/// What a reconstruction did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ReconstructReport {
    /// The plan it followed.
    pub plan: PlanReport,
    /// Level by level.
    pub fit: FitReport,
    /// The planes; `None` in a draft.
    pub structure: Option<StructureReport>,
    /// The polish; `None` in a draft.
    pub polish: Option<PolishReport>,
    /// The extraction.
    pub contour: ContourReport,
    /// What was made sharp; `None` in a draft.
    pub sharp: Option<SharpReport>,
    /// How near the mesh comes to the user's lines and polygons, before it is simplified; `None` without any.
    pub constraints: Option<ConstraintReport>,
    /// What became of small pieces.
    pub dropped: DroppedComponents,
    /// The simplification; `None` if none was asked for.
    pub simplify: Option<SimplifyReport>,
    /// Vertices of the mesh.
    pub vertices: usize,
    /// Triangles of the mesh.
    pub triangles: usize,
    /// Wall seconds.
    pub seconds: StageSeconds,
}

impl Plan<'_> {
    /// Does what was planned.
    ///
    /// # Errors
    /// If no surface is found, or the monitor asks to stop.
    pub fn run(self, monitor: &dyn Monitor) -> Result<(Mesh, ReconstructReport), ReconstructError> {
        let Self { report: plan, cloud, prepared, known, seconds } = self;
        let mut seconds = StageSeconds { plan: seconds, ..StageSeconds::default() };

        let whole = monitor;
        let unsimplified = if plan.simplify.is_some() { BEFORE_SIMPLIFY } else { 1.0 };
        let monitor = &Part::new(whole, 0.0..unsimplified);
        let start = Instant::now();
        let shares = Shares::of(plan.quality);
        let (field, fit) = prepared.fit(&Part::new(monitor, 0.0..shares.fit / cascade::SHARE))?;
        seconds.fit = start.elapsed().as_secs_f64();

        let frame = Frame::new(plan.up, plan.scene);
        let left = known.moved(|p| frame.leave(p));
        let start = Instant::now();
        let structure = match plan.polish {
            Some(_) => {
                let part = Part::new(monitor, shares.fit..shares.structure);
                Some(Structure::find(cloud, &plan, &field, &left, &part)?)
            }
            None => None,
        };
        seconds.structure = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let (field, polish) = match (&structure, plan.polish) {
            (Some(structure), Some(params)) => {
                monitor.stage("polishing");
                let (field, report) = structure.polish(&field, cloud, &known, (frame, params), monitor)?;
                monitor.share(shares.polish);
                (field, Some(report))
            }
            _ => (field, None),
        };
        seconds.polish = start.elapsed().as_secs_f64();
        monitor.stage("extracting the surface");
        let start = Instant::now();
        let keep = Keep::new(cloud, &plan, &known, frame);
        check(monitor)?;
        let watch = Watch::new(monitor, shares.polish..shares.contour, plan.occupied_cells);
        let (mut mesh, contour) =
            contour(&field, |p| watch.goes_on() && keep.as_ref().is_none_or(|keep| keep.contains(p)));
        drop(field);
        check(monitor)?;
        if plan.trim.is_some() && matches!(plan.scene, Scene::Terrain | Scene::Airborne) {
            cut_at_box(&mut mesh, cloud, frame, plan.resolution);
        }
        if mesh.triangles.is_empty() {
            return Err(ReconstructError::NoSurface);
        }
        mesh.vertices.par_iter_mut().for_each(|v| *v = frame.leave(*v));
        mesh.world_from_local = cloud.world_from_local;
        mesh.crs.clone_from(&cloud.crs);
        seconds.contour = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let sharp = structure.as_ref().map(|structure| {
            monitor.stage("making edges sharp");
            structure.sharpen(&mut mesh, cloud, &plan)
        });
        let on_lines = if sharp.is_some() { imprint(&mut mesh, &left.lines, plan.resolution) } else { 0 };
        check(monitor)?;
        monitor.share(AFTER_CONTOUR);
        seconds.sharpen = start.elapsed().as_secs_f64();

        let start = Instant::now();
        let constraints = left.measure(&mesh, SAMPLES_REL * plan.resolution, on_lines);
        let dropped = plan.min_component.map(|least| drop_small_components(&mut mesh, least)).unwrap_or_default();
        let mut simplified = None;
        if let Some(params) = &plan.simplify {
            let part = Part::new(whole, unsimplified * AFTER_CONTOUR..AFTER_CONTOUR);
            let (lighter, report) = simplify(&mesh, params, &part)?;
            (mesh, simplified) = (lighter, Some(report));
        }
        seconds.simplify = start.elapsed().as_secs_f64();

        whole.stage("carrying values over");
        let start = Instant::now();
        transfer(cloud, &mut mesh, plan.attributes, whole, AFTER_CONTOUR..1.0)?;
        seconds.attributes = start.elapsed().as_secs_f64();
        whole.share(1.0);

        let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
        let simplify = simplified;
        let structure = structure.map(|structure| structure.report);
        let report = ReconstructReport {
            plan,
            fit,
            structure,
            polish,
            contour,
            sharp,
            constraints,
            dropped,
            simplify,
            vertices,
            triangles,
            seconds,
        };
        Ok((mesh, report))
    }
}

/// What the steps up to the extraction are of the whole where the mesh is simplified after them.
const BEFORE_SIMPLIFY: f64 = 0.7;
/// The share of the whole that is done after the extraction, or after the simplification if there is one.
const AFTER_CONTOUR: f64 = 0.97;

/// The shares of the whole that are done after each stage up to the extraction.
struct Shares {
    fit: f64,
    structure: f64,
    polish: f64,
    contour: f64,
}

impl Shares {
    fn of(quality: Quality) -> Self {
        match quality {
            Quality::Draft => Self { fit: 0.9, structure: 0.9, polish: 0.9, contour: AFTER_CONTOUR },
            Quality::Normal => Self { fit: 0.3, structure: 0.55, polish: 0.75, contour: 0.8 },
            Quality::Fine => Self { fit: 0.25, structure: 0.4, polish: 0.75, contour: 0.8 },
        }
    }
}

/// Vertices this near to the box, in cells, are moved onto it.
const SNAP: f64 = 0.05;

/// Cuts open ground where the points end: the surface goes no farther than their box, seen from above.
fn cut_at_box(mesh: &mut Mesh, cloud: &Cloud, frame: Frame, cell: f64) {
    let (low, high) = crate::domain::bounds(cloud.points.iter().map(|&p| frame.enter(p)));
    for axis in 0..2 {
        for (sign, offset) in [(1.0, high[axis]), (-1.0, -low[axis])] {
            let mut normal = [0.0; 3];
            normal[axis] = sign;
            clip(mesh, HalfSpace { normal, offset }, SNAP * cell);
        }
    }
}

/// Counts the polygons of the extraction for a monitor.
struct Watch<'a> {
    steps: Steps<'a>,
    polygons: AtomicUsize,
    cancelled: AtomicBool,
}

impl<'a> Watch<'a> {
    /// Polygons between two looks at the monitor.
    const STRIDE: usize = 1 << 14;
    /// Polygons for each occupied cell, about: one for each lattice edge that the surface crosses.
    const POLYGONS_A_CELL: usize = 5;

    fn new(monitor: &'a dyn Monitor, shares: Range<f64>, occupied_cells: usize) -> Self {
        let steps = Steps::new(monitor, shares, Self::POLYGONS_A_CELL * occupied_cells);
        Self { steps, polygons: AtomicUsize::new(0), cancelled: AtomicBool::new(false) }
    }

    /// Counts a polygon. Once this is `false` the mesh is not wanted any more, and emptying it ends the work soonest.
    fn goes_on(&self) -> bool {
        if self.polygons.fetch_add(1, Ordering::Relaxed) % Self::STRIDE == Self::STRIDE - 1
            && self.steps.advance(Self::STRIDE).is_err()
        {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        !self.cancelled.load(Ordering::Relaxed)
    }
}

/// Where surface is kept, in the frame of the fit.
enum Keep {
    /// Within the outline seen from above.
    Outline(ColumnOutline),
    /// Within a distance of the points.
    Near { tree: PointTree, radius: f64 },
}

impl Keep {
    /// What is known counts like points.
    fn new(cloud: &Cloud, plan: &PlanReport, known: &Local, frame: Frame) -> Option<Self> {
        let radius = plan.trim?;
        let mut points: Vec<[f64; 3]> = cloud.points.par_iter().map(|&p| frame.enter(p)).collect();
        points.extend(known.samples(plan.resolution));
        Some(match plan.scene {
            Scene::Terrain | Scene::Airborne => Self::Outline(ColumnOutline::new(&points, plan.resolution, radius)),
            Scene::Object | Scene::Free => Self::Near { tree: PointTree::new(&points), radius },
        })
    }

    fn contains(&self, p: [f64; 3]) -> bool {
        match self {
            Self::Outline(outline) => outline.contains(p[0], p[1]),
            Self::Near { tree, radius } => tree.nearest_within(p, *radius).is_some(),
        }
    }
}
