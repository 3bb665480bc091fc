//! Fit, extract, trim, finish.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::attributes::transfer;
use super::frame::Frame;
use super::{Plan, PlanReport, ReconstructError};
use crate::cloud::Cloud;
use crate::contour::{ColumnOutline, ContourReport, contour};
use crate::fit::cascade::{self, FitReport, Scene};
use crate::mesh::Mesh;
use crate::monitor::{Monitor, Steps, check};
use crate::spatial::PointTree;

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Default)]
pub struct StageSeconds {
    /// Spacing, scene, placing and sorting of the points.
    pub plan: f64,
    /// The cascade.
    pub fit: f64,
    /// Extraction with trim.
    pub contour: f64,
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
    /// The extraction.
    pub contour: ContourReport,
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
        let Self { report: plan, cloud, prepared, seconds } = self;
        let mut seconds = StageSeconds { plan: seconds, ..StageSeconds::default() };

        let start = Instant::now();
        let (field, fit) = prepared.fit(monitor)?;
        seconds.fit = start.elapsed().as_secs_f64();

        let frame = Frame::new(plan.up, plan.scene);
        monitor.stage("extracting the surface");
        let start = Instant::now();
        let keep = Keep::new(cloud, &plan, frame);
        check(monitor)?;
        let watch = Watch::new(monitor, plan.occupied_cells);
        let (mut mesh, contour) =
            contour(&field, |p| watch.goes_on() && keep.as_ref().is_none_or(|keep| keep.contains(p)));
        drop(field);
        check(monitor)?;
        if mesh.triangles.is_empty() {
            return Err(ReconstructError::NoSurface);
        }
        mesh.vertices.par_iter_mut().for_each(|v| *v = frame.leave(*v));
        mesh.world_from_local = cloud.world_from_local;
        mesh.crs.clone_from(&cloud.crs);
        seconds.contour = start.elapsed().as_secs_f64();

        monitor.stage("carrying values over");
        let start = Instant::now();
        transfer(cloud, &mut mesh, plan.attributes, monitor, AFTER_CONTOUR..1.0)?;
        seconds.attributes = start.elapsed().as_secs_f64();
        monitor.share(1.0);

        let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
        Ok((mesh, ReconstructReport { plan, fit, contour, vertices, triangles, seconds }))
    }
}

/// The share of the whole that is done after the extraction.
const AFTER_CONTOUR: f64 = 0.97;

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

    fn new(monitor: &'a dyn Monitor, occupied_cells: usize) -> Self {
        let steps = Steps::new(monitor, cascade::SHARE..AFTER_CONTOUR, Self::POLYGONS_A_CELL * occupied_cells);
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
    fn new(cloud: &Cloud, plan: &PlanReport, frame: Frame) -> Option<Self> {
        let radius = plan.trim?;
        let points: Vec<[f64; 3]> = cloud.points.par_iter().map(|&p| frame.enter(p)).collect();
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
