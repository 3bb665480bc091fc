//! Meshes of solids.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::attributes::transfer;
use super::domain::Local;
use super::fitted::{Evidence, SAMPLES_REL};
use super::keep::{Keep, Watch};
use super::solid::Leaf;
use super::{AttributeChoice, Fitted, ModelError, Solid};
use crate::constraint::{ConstraintReport, imprint};
use crate::contour::{
    ColumnOutline, ContourReport, FieldContourError, Known, OwnNodes, Raster, SNAP, Seam, SharpReport, clip_at_box,
    contour, contour_part, lattice_around, sampled, sharpen, sharpen_field,
};
use crate::field::{Field, LatticeField};
use crate::mesh::{DroppedComponents, Mesh, SimplifyParams, SimplifyReport, drop_small_components, simplify};
use crate::monitor::{Monitor, Part, check};
use crate::vec3::{self, Vec3};

/// How a solid is made into a mesh.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct MeshParams {
    /// Side of the cells in which the surface is looked for; `None`: as fine as the first fitted model in it, else a 128th of the longest side of its box.
    pub cell: Option<f64>,
    /// The box of world coordinates to look in; the surface is cut there and left open. `None`: all of it, but open ground ends where its points do.
    pub bounds: Option<[[f64; 3]; 2]>,
    /// How far the mesh is simplified; `None`: not at all.
    pub simplify: Option<SimplifyParams>,
    /// Values of the nearest points of the first fitted model for the vertices.
    pub attributes: AttributeChoice,
}

/// What was made of a solid.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct MeshReport {
    /// Side of the cells.
    pub cell: f64,
    /// The extraction.
    pub contour: ContourReport,
    /// What was made sharp; `None` if nothing is known to be.
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
    pub seconds: MeshSeconds,
}

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct MeshSeconds {
    /// Extraction with trim.
    pub contour: f64,
    /// Vertices on planes, edges and corners.
    pub sharpen: f64,
    /// Dropping of small pieces and simplification.
    pub simplify: f64,
    /// Values for the vertices.
    pub attributes: f64,
}

/// What the steps up to the simplification are of the whole where there is one.
const BEFORE_SIMPLIFY: f64 = 0.5;
/// The share of the whole that is done after the extraction, after the sharpening, and before the values.
const AFTER: [f64; 3] = [0.25, 0.9, 0.97];

/// Makes a mesh of a solid. Positions are world positions less an offset that the mesh tells.
///
/// A fitted model alone gives what [`reconstruct`](crate::reconstruct) gives, to the last bit. Of what is made of several operands, fitted ones keep their sharp
/// edges, and new ones lie where surfaces of operands meet.
///
/// # Errors
/// If an operand cannot be, the surface has no end that is known, there is none, or the monitor stops.
pub fn mesh(solid: &Solid, params: &MeshParams, monitor: &dyn Monitor) -> Result<(Mesh, MeshReport), ModelError> {
    let whole = monitor;
    let unsimplified = if params.simplify.is_some() { BEFORE_SIMPLIFY } else { 1.0 };
    let monitor = &Part::new(whole, 0.0..unsimplified);
    let Surface { mut mesh, mut report, base } = match solid {
        Solid::Fitted(fitted) if params.cell.is_none() && params.bounds.is_none() => of_fitted(fitted, monitor)?,
        _ => of_solid(solid, params, monitor)?,
    };
    check(monitor)?;
    monitor.share(AFTER[1]);
    let start = Instant::now();
    if let Some(least) = base.as_ref().and_then(|base| base.parts().min_component) {
        report.dropped = drop_small_components(&mut mesh, least);
    }
    if let Some(params) = &params.simplify {
        let part = Part::new(whole, unsimplified * AFTER[1]..AFTER[2]);
        let (lighter, done) = simplify(&mesh, params, &part)?;
        (mesh, report.simplify) = (lighter, Some(done));
    }
    report.seconds.simplify = start.elapsed().as_secs_f64();
    let start = Instant::now();
    if let Some(base) = base {
        whole.stage("carrying values over");
        transfer(&base, &mut mesh, params.attributes, whole, AFTER[2]..1.0)?;
    }
    report.seconds.attributes = start.elapsed().as_secs_f64();
    (report.vertices, report.triangles) = (mesh.vertices.len(), mesh.triangles.len());
    whole.share(1.0);
    Ok((mesh, report))
}

/// A mesh on the way.
struct Surface {
    mesh: Mesh,
    report: MeshReport,
    /// The first fitted model.
    base: Option<Arc<Fitted>>,
}

fn report(cell: f64) -> MeshReport {
    MeshReport {
        cell,
        contour: ContourReport::default(),
        sharp: None,
        constraints: None,
        dropped: DroppedComponents::default(),
        simplify: None,
        vertices: 0,
        triangles: 0,
        seconds: MeshSeconds::default(),
    }
}

/// The surface of a fitted model as it is.
fn of_fitted(fitted: &Arc<Fitted>, monitor: &dyn Monitor) -> Result<Surface, ModelError> {
    let mut report = report(fitted.cell());
    monitor.stage("extracting the surface");
    let start = Instant::now();
    let keep = Keep::new(fitted);
    check(monitor)?;
    let watch = Watch::of(fitted, monitor, 0.0..AFTER[0]);
    let (mut mesh, contour) =
        contour(fitted.lattice(), |p| watch.goes_on() && keep.as_ref().is_none_or(|keep| keep.contains(p)));
    drop(keep);
    check(monitor)?;
    report.contour = contour;
    end(&mut mesh, fitted, None);
    if mesh.triangles.is_empty() {
        return Err(FieldContourError::NoSurface.into());
    }
    report.seconds.contour = start.elapsed().as_secs_f64();
    let start = Instant::now();
    if let Some(evidence) = fitted.evidence([0.0; 3], &Default::default(), false) {
        monitor.stage("making edges sharp");
        report.sharp = Some(sharpen(&mut mesh, &evidence.known(fitted.cell()), None));
    }
    let is_sharp = report.sharp.is_some();
    report.constraints = on_constraints(&mut mesh, fitted, is_sharp, |_| false);
    check(monitor)?;
    report.seconds.sharpen = start.elapsed().as_secs_f64();
    Ok(Surface { mesh, report, base: Some(Arc::clone(fitted)) })
}

/// Which part of a fitted surface is extracted, of one that is fitted in parts.
pub(crate) struct Piece<'a> {
    /// What is the part's own.
    pub(crate) own: OwnNodes<'a>,
    /// Where the surface is kept, in the frame of the fit; `None`: everywhere.
    pub(crate) outline: Option<&'a ColumnOutline>,
    /// The raster of all parts.
    pub(crate) raster: Raster,
}

/// A part of the surface of a fitted model, of which F is `field`, with values, and the vertices that it shares with its neighbours. It may be empty.
pub(crate) fn piece(
    fitted: &Fitted,
    field: &LatticeField,
    piece: &Piece<'_>,
    attributes: AttributeChoice,
    monitor: &dyn Monitor,
) -> Result<(Mesh, Seam, MeshReport), ModelError> {
    let mut report = report(fitted.cell());
    monitor.stage("extracting the surface");
    let start = Instant::now();
    let watch = Watch::of(fitted, monitor, 0.0..AFTER[0]);
    let keep = |p: Vec3| watch.goes_on() && piece.outline.is_none_or(|outline| outline.contains(p[0], p[1]));
    let (mut mesh, mut seam, contour) = contour_part(field, piece.own, keep);
    check(monitor)?;
    report.contour = contour;
    end(&mut mesh, fitted, Some(&mut seam));
    report.seconds.contour = start.elapsed().as_secs_f64();
    let start = Instant::now();
    match fitted.evidence([0.0; 3], &Default::default(), false) {
        Some(evidence) if !mesh.triangles.is_empty() => {
            monitor.stage("making edges sharp");
            let known = evidence.known(fitted.cell());
            report.sharp = Some(sharpen(&mut mesh, &known, Some((&mut seam, piece.raster))));
        }
        _ => mesh.vertices.par_iter_mut().for_each(|v| *v = piece.raster.nearest(*v)),
    }
    check(monitor)?;
    seam.keep_own(&mut mesh);
    if !mesh.triangles.is_empty() {
        let is_sharp = report.sharp.is_some();
        report.constraints = on_constraints(&mut mesh, fitted, is_sharp, |v| seam.keys.contains_key(&v));
    }
    report.seconds.sharpen = start.elapsed().as_secs_f64();
    let start = Instant::now();
    transfer(fitted, &mut mesh, attributes, monitor, AFTER[2]..1.0)?;
    report.seconds.attributes = start.elapsed().as_secs_f64();
    (report.vertices, report.triangles) = (mesh.vertices.len(), mesh.triangles.len());
    Ok((mesh, seam, report))
}

/// Ends a mesh of a fitted model where its ground ends, and leads it out of the frame of the fit.
fn end(mesh: &mut Mesh, fitted: &Fitted, seam: Option<&mut Seam>) {
    let frame = fitted.frame();
    if fitted.parts().trim.is_some() && fitted.is_ground() {
        let bounds = crate::domain::bounds(fitted.parts().bounds.into_iter().map(|corner| frame.enter(corner)));
        clip_at_box(mesh, bounds.into(), 0..2, SNAP * fitted.cell(), seam);
    }
    mesh.vertices.par_iter_mut().for_each(|v| *v = frame.leave(*v));
    mesh.world_from_local = fitted.parts().world_from_local;
}

/// Lays edges along the user's lines where the mesh is sharp, and measures how near it comes to all that the user knows.
fn on_constraints(
    mesh: &mut Mesh,
    fitted: &Fitted,
    is_sharp: bool,
    is_held: impl Fn(u32) -> bool + Sync,
) -> Option<ConstraintReport> {
    let (held, cell) = (fitted.held(), fitted.cell());
    let on_lines = if is_sharp { imprint(mesh, &held.lines, cell, is_held) } else { 0 };
    held.measure(mesh, SAMPLES_REL * cell, on_lines)
}

/// The surface of what is made of operands.
fn of_solid(solid: &Solid, params: &MeshParams, monitor: &dyn Monitor) -> Result<Surface, ModelError> {
    let local = Local::new(solid)?;
    let bounds = local.bounds(params.bounds)?;
    let cell = params.cell.unwrap_or_else(|| local.cell(bounds));
    let mut report = report(cell);

    let start = Instant::now();
    monitor.stage("looking for the surface");
    let lattice = match local.fitted() {
        Some(fitted) if params.cell.is_none() => {
            let (low, high) = (bounds[0].map(|c| c - 2.0 * cell), bounds[1].map(|c| c + 2.0 * cell));
            fitted.lattice().lattice.over(low, high)
        }
        _ => lattice_around(bounds, cell),
    };
    let (values, _) = sampled(&local.turned(), lattice.map_err(FieldContourError::from)?, monitor)?;
    check(monitor)?;
    monitor.stage("extracting the surface");
    let keep = local.keep();
    let (mut mesh, contour) = contour(&values, |p| keep.as_ref().is_none_or(|keep| keep.contains(p)));
    drop((values, keep));
    if let Some(ground) = local.ground() {
        clip_at_box(&mut mesh, ground, 0..2, SNAP * cell, None);
    }
    if mesh.triangles.is_empty() {
        return Err(FieldContourError::NoSurface.into());
    }
    mesh.vertices.par_iter_mut().for_each(|v| *v = local.leave(*v));
    report.contour = contour;
    report.seconds.contour = start.elapsed().as_secs_f64();
    check(monitor)?;
    monitor.share(AFTER[0]);

    monitor.stage("making edges sharp");
    let start = Instant::now();
    let evidence: Vec<Option<Evidence>> = evidence(&*local.field, &local.leaves);
    let known: Vec<Option<Known>> =
        evidence.iter().map(|evidence| evidence.as_ref().map(|evidence| evidence.known(cell))).collect();
    report.sharp = Some(sharpen_field(&mut mesh, &*local.field, &known, cell));
    if let Some(bounds) = params.bounds {
        clip_at_box(&mut mesh, bounds.map(|corner| vec3::sub(corner, local.origin)), 0..3, SNAP * cell, None);
        if mesh.triangles.is_empty() {
            return Err(FieldContourError::NoSurface.into());
        }
    }
    report.seconds.sharpen = start.elapsed().as_secs_f64();
    mesh.world_from_local = local.origin;
    Ok(Surface { mesh, report, base: local.fitted().cloned() })
}

/// What points show of each fitted operand, where it is.
fn evidence(field: &dyn Field, leaves: &[Leaf]) -> Vec<Option<Evidence>> {
    let of = |(tag, leaf): (usize, &Leaf)| {
        let operand = (0..field.sheets()).map(|sheet| field.operand(sheet)).find(|own| own.tag == Some(tag))?;
        leaf.fitted.evidence(leaf.shift, &operand.placement, operand.is_reversed)
    };
    leaves.iter().enumerate().map(of).collect()
}
