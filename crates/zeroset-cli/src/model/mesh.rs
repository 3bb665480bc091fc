//! `zeroset mesh`.

use std::path::Path;

use serde::Serialize;
use zeroset::mesh::Mesh;
use zeroset::model::{MeshParams, MeshReport, Solid, mesh};
use zeroset_io::{MeshFormat, WriteOptions, write_mesh};

use super::open::{Opened, files, open};
use super::{console, start, work};
use crate::args::{Bounds, BriefRunArgs, MeshArgs, SurfaceArgs};
use crate::error::CliError;
use crate::input::{check_output_and_report, refuse_mesh_stream};
use crate::reconstruct::attributes;
use crate::report::{OutputReport, write_report};
use crate::simplify::outcome;
use crate::table::{count, significant};

pub(crate) fn run(args: &MeshArgs) -> Result<(), CliError> {
    check(&args.output, &args.run, [args.model.as_str()])?;
    start(&args.run)?;
    make(open(&args.model)?, &args.model, &args.surface, &args.output, &args.run)
}

/// Looks at the names of files before anything is read.
pub(super) fn check<'a>(
    output: &Path,
    run: &BriefRunArgs,
    named: impl IntoIterator<Item = &'a str>,
) -> Result<(), CliError> {
    refuse_mesh_stream(output)?;
    MeshFormat::from_path(output)?;
    check_output_and_report(&files(named), Some(output), run.report.as_deref())
}

/// Makes a mesh and writes it. `what` names the solid in messages.
pub(super) fn make(
    opened: Opened,
    what: &str,
    surface: &SurfaceArgs,
    output: &Path,
    run: &BriefRunArgs,
) -> Result<(), CliError> {
    let begin = std::time::Instant::now();
    let (mut mesh, report) = surface_of(&opened.solid, what, surface, run)?;
    mesh.crs = opened.crs;
    let options = WriteOptions { resolution: Some(report.cell), ..WriteOptions::default() };
    let output = OutputReport::new(output, write_mesh(output, &mesh, &options)?)?;
    console(run).say(&summary(&report, &output, begin.elapsed().as_secs_f64()));
    write_report(run.report.as_deref(), Content { inputs: opened.inputs, mesh: report, output })
}

#[derive(Debug, Serialize)]
struct Content {
    inputs: Vec<String>,
    mesh: MeshReport,
    output: OutputReport,
}

fn surface_of(
    solid: &Solid,
    what: &str,
    args: &SurfaceArgs,
    run: &BriefRunArgs,
) -> Result<(Mesh, MeshReport), CliError> {
    let params = MeshParams {
        cell: args.cell,
        bounds: args.bounds.map(Bounds::corners),
        simplify: args.simplify.params(),
        attributes: attributes(args.attributes),
    };
    work(run, what, |progress| mesh(solid, &params, progress))
}

/// What was made, in a line, and what a user must know about the file.
fn summary(done: &MeshReport, output: &OutputReport, seconds: f64) -> String {
    let mut text = format!(
        "{}: {} vertices, {} triangles (cells of {}) in {} s",
        output.path,
        count(done.vertices),
        count(done.triangles),
        significant(done.cell, 4),
        significant(seconds, 3),
    );
    text += &output.offset_line();
    if let Some(left) = done.sharp.map(|sharp| sharp.intersections).filter(|left| *left > 0) {
        text += &format!("\n{} pairs of triangles cut through each other; smaller --cell may help", count(left));
    }
    if let Some(report) = &done.simplify {
        text += &format!("\nsimplified: {}", outcome(report));
    }
    text + &output.left_out_line()
}
