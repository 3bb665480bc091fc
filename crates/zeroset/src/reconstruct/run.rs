//! Fit, and make a mesh of what was fitted.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::structure::{Found, StructureReport};
use super::{Plan, PlanReport, Quality, ReconstructError};
use crate::cloud::Cloud;
use crate::constraint::{ConstraintReport, Local};
use crate::contour::{ContourReport, SharpReport};
use crate::field::{LatticeField, Metric};
use crate::fit::Frame;
use crate::fit::cascade::{self, FitReport, PolishReport};
use crate::mesh::{DroppedComponents, Mesh, SimplifyReport};
use crate::model::{Fitted, FittedParts, MeshParams, Solid, mesh};
use crate::monitor::{Monitor, Part};

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

/// What a fit did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FittedReport {
    /// The plan it followed.
    pub plan: PlanReport,
    /// Level by level.
    pub fit: FitReport,
    /// The planes; `None` in a draft.
    pub structure: Option<StructureReport>,
    /// The polish; `None` in a draft.
    pub polish: Option<PolishReport>,
    /// Wall seconds; those of a mesh are zero.
    pub seconds: StageSeconds,
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
    /// Does what was planned: fits, and makes a mesh.
    ///
    /// # Errors
    /// If no surface is found, or the monitor asks to stop.
    pub fn run(self, monitor: &dyn Monitor) -> Result<(Mesh, ReconstructReport), ReconstructError> {
        let crs = self.cloud.crs.clone();
        let of_fit =
            if self.report.simplify.is_some() { BEFORE_SIMPLIFY } else { 1.0 } * fit_share(self.report.quality);
        let (fitted, report) = self.fit(&Part::new(monitor, 0.0..of_fit))?;
        let FittedReport { plan, fit, structure, polish, mut seconds } = report;
        let params =
            MeshParams { simplify: plan.simplify.clone(), attributes: plan.attributes, ..MeshParams::default() };
        let solid = Solid::Fitted(Arc::new(fitted));
        let (mut mesh, done) = mesh(&solid, &params, &Part::new(monitor, of_fit..1.0))?;
        mesh.crs = crs;
        seconds.contour = done.seconds.contour;
        seconds.sharpen = done.seconds.sharpen;
        seconds.simplify = done.seconds.simplify;
        seconds.attributes = done.seconds.attributes;
        let report = ReconstructReport {
            plan,
            fit,
            structure,
            polish,
            contour: done.contour,
            sharp: done.sharp,
            constraints: done.constraints,
            dropped: done.dropped,
            simplify: done.simplify,
            vertices: done.vertices,
            triangles: done.triangles,
            seconds,
        };
        Ok((mesh, report))
    }

    /// Does the first part of what was planned: the fit, which can be kept and made into a mesh later.
    ///
    /// # Errors
    /// If the monitor asks to stop.
    pub fn fit(self, monitor: &dyn Monitor) -> Result<(Fitted, FittedReport), ReconstructError> {
        let Self { report: plan, cloud, prepared, known, seconds } = self;
        let mut seconds = StageSeconds { plan: seconds, ..StageSeconds::default() };
        let start = Instant::now();
        let after_fit = if plan.quality == Quality::Draft { 1.0 } else { CASCADE_SHARE };
        let (field, fit) = prepared.fit(&Part::new(monitor, 0.0..after_fit / cascade::SHARE))?;
        seconds.fit = start.elapsed().as_secs_f64();
        let bounds = crate::domain::bounds(cloud.points.iter().copied());
        let beyond = Beyond { bounds: bounds.into(), reach: None, max_distance: None };
        let shaped = shape(field, cloud, &plan, &known, beyond, &Part::new(monitor, after_fit..1.0))?;
        let Shaped { fitted, structure, polish, seconds: own } = shaped;
        (seconds.structure, seconds.polish) = own;
        monitor.share(1.0);
        Ok((fitted, FittedReport { plan, fit, structure, polish, seconds }))
    }
}

/// What comes after the cascade.
pub(crate) struct Shaped {
    pub(crate) fitted: Fitted,
    pub(crate) structure: Option<StructureReport>,
    pub(crate) polish: Option<PolishReport>,
    /// Of the planes and of the polish.
    pub(crate) seconds: (f64, f64),
}

/// What is known of a surface beyond the points at hand.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Beyond {
    /// The box in which it ends.
    pub(crate) bounds: [[f64; 3]; 2],
    /// A box in the frame of the fit in which F is polished even where there are no points.
    pub(crate) reach: Option<[[f64; 3]; 2]>,
    /// How far a point lies from its plane at most, where that was measured elsewhere.
    pub(crate) max_distance: Option<f64>,
}

/// Finds planes in the points and polishes F, or only makes it a length. `known` is in the frame of the fit.
pub(crate) fn shape(
    field: LatticeField,
    cloud: &Cloud,
    plan: &PlanReport,
    known: &Local,
    beyond: Beyond,
    monitor: &dyn Monitor,
) -> Result<Shaped, ReconstructError> {
    let frame = Frame::new(plan.up, plan.scene);
    let left = known.moved(|p| frame.leave(p));
    let start = Instant::now();
    let structure = match plan.polish {
        Some(_) => Some(Found::find(
            cloud,
            plan,
            &field,
            &left,
            beyond.max_distance,
            &Part::new(monitor, 0.0..STRUCTURE_SHARE),
        )?),
        None => None,
    };
    let of_structure = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let (field, polish) = match (&structure, plan.polish) {
        (Some(structure), Some(params)) => {
            monitor.stage("polishing");
            let (field, report) = structure.polish(&field, cloud, known, beyond.reach, (frame, params), monitor)?;
            (field, Some(report))
        }
        _ => (as_length(field, cloud, frame), None),
    };
    let seconds = (of_structure, start.elapsed().as_secs_f64());
    let (structure, found) = structure.map(Found::keep).unzip();
    let parts = FittedParts {
        world_from_local: cloud.world_from_local,
        scene: plan.scene,
        frame: frame.rows(),
        metric: Metric::Near,
        bounds: beyond.bounds,
        noise: plan.noise,
        trim: plan.trim,
        min_component: plan.min_component,
        points: cloud.points.par_iter().map(|p| p.map(|c| c as f32)).collect(),
        attributes: cloud.attributes.clone(),
        structure,
        polygons: left.triangles().collect(),
        lines: left.lines,
    };
    Ok(Shaped { fitted: Fitted::new(field, parts)?, structure: found, polish, seconds })
}

/// What the steps up to the extraction are of the whole where the mesh is simplified after them.
const BEFORE_SIMPLIFY: f64 = 0.7;
/// What of a fit with planes and polish is done after the cascade; and what of the rest after the planes.
const CASCADE_SHARE: f64 = 0.4;
const STRUCTURE_SHARE: f64 = 0.5;

/// What the fit is of the whole.
fn fit_share(quality: Quality) -> f64 {
    if quality == Quality::Draft { 0.9 } else { 0.75 }
}

/// The most points at which the gradient of a draft is asked for.
const ASKED: usize = 1 << 14;

/// Scales the F of a draft, which is like a blurred step, to about a distance at its points.
fn as_length(mut field: LatticeField, cloud: &Cloud, frame: Frame) -> LatticeField {
    let stride = cloud.len().div_ceil(ASKED).max(1);
    let asked = cloud.points.iter().step_by(stride);
    let mut slopes: Vec<f64> =
        asked.filter_map(|&p| Some(crate::vec3::norm(field.gradient(frame.enter(p))?))).collect();
    slopes.sort_unstable_by(f64::total_cmp);
    let median = slopes.get(slopes.len() / 2).copied().unwrap_or(1.0);
    if median > 0.0 {
        let scale = (1.0 / median) as f32;
        field.values.par_iter_mut().for_each(|value| *value *= scale);
    }
    field
}
