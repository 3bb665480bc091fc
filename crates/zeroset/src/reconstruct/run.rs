//! Fit, extract, trim, finish.

use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::attributes::transfer;
use super::frame::Frame;
use super::{Plan, PlanReport, ReconstructError};
use crate::cloud::Cloud;
use crate::contour::{ColumnOutline, ContourReport, contour};
use crate::fit::{FitReport, Scene};
use crate::mesh::Mesh;
use crate::monitor::{Monitor, check};
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
        let (mut mesh, contour) = match Keep::new(cloud, &plan, frame) {
            None => contour(&field, |_| true),
            Some(keep) => contour(&field, |p| keep.contains(p)),
        };
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
        monitor.share(0.97);
        let start = Instant::now();
        transfer(cloud, &mut mesh, plan.attributes);
        seconds.attributes = start.elapsed().as_secs_f64();
        monitor.share(1.0);

        let (vertices, triangles) = (mesh.vertices.len(), mesh.triangles.len());
        Ok((mesh, ReconstructReport { plan, fit, contour, vertices, triangles, seconds }))
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
