//! `zeroset simplify`.

use std::path::Path;

use serde::Serialize;
use zeroset::mesh::{Mesh, SimplifyError, SimplifyParams, SimplifyReport, simplify};
use zeroset_io::{MeshFormat, WriteOptions, read_mesh, shown, write_mesh};

use crate::args::SimplifyArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::input::{check_output_and_report, refuse_mesh_stream};
use crate::progress::with_progress;
use crate::report::{OutputReport, write_report};
use crate::table::{count, significant};
use crate::{interrupt, threads};

pub(crate) fn run(args: &SimplifyArgs) -> Result<(), CliError> {
    let console = Console::unless(args.run.quiet);
    check(args)?;
    threads::start(args.run.threads)?;
    let mesh = interrupt::watched(|| read_mesh(&args.input))??;
    // One of the two is always given.
    let target = args.target.params().unwrap_or_default();
    let params = SimplifyParams { sharp_angle: args.sharp_angle.to_radians(), ..target };
    let result = with_progress(console, |progress| simplify(&mesh, &params, progress))?;
    let (simplified, report) = result.map_err(|error| named(error, &args.input))?;
    let output = write(args, &simplified)?;
    console.say(&summary(&report, &output));
    write_report(args.run.report.as_deref(), Report { input: shown(&args.input), simplify: report, output })
}

/// The whole report.
#[derive(Debug, Serialize)]
struct Report {
    input: String,
    simplify: SimplifyReport,
    output: OutputReport,
}

/// What can be told to be wrong before anything is read.
fn check(args: &SimplifyArgs) -> Result<(), CliError> {
    MeshFormat::from_path(&args.input)?;
    refuse_mesh_stream(&args.output)?;
    MeshFormat::from_path(&args.output)?;
    check_output_and_report(std::slice::from_ref(&args.input), Some(&args.output), args.run.report.as_deref())
}

fn write(args: &SimplifyArgs, mesh: &Mesh) -> Result<OutputReport, CliError> {
    let options = WriteOptions { resolution: args.target.max_error, ..WriteOptions::default() };
    Ok(OutputReport::new(&args.output, write_mesh(&args.output, mesh, &options)?)?)
}

/// The error with the name of the file that it is about.
fn named(error: SimplifyError, path: &Path) -> CliError {
    let path = path.to_path_buf();
    match error {
        SimplifyError::NoSurface { faces } => CliError::NoSurface { path, faces },
        SimplifyError::Broken(source) => CliError::Mesh { path, source },
        SimplifyError::Cancelled(_) => CliError::Interrupted,
        other @ (SimplifyError::NoTarget | SimplifyError::Parameter { .. }) => CliError::Usage(other.to_string()),
    }
}

fn summary(report: &SimplifyReport, output: &OutputReport) -> String {
    let mut text = format!(
        "{}: {} vertices, {}, in {} s",
        output.path,
        count(report.vertices_after),
        outcome(report),
        significant(report.seconds, 3),
    );
    text += &output.offset_line();
    text + &output.left_out_line()
}

/// What a simplification made of how much, and how far that is off.
pub(crate) fn outcome(report: &SimplifyReport) -> String {
    let [forth, back] = [report.deviation.original_to_simplified, report.deviation.simplified_to_original];
    format!(
        "{} triangles of {}, at most {} and on average {} off",
        count(report.triangles_after),
        count(report.triangles_before),
        significant(report.deviation.max(), 3),
        significant(0.5 * (forth.mean + back.mean), 3),
    )
}
