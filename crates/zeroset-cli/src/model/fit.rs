//! `zeroset fit`.

use std::sync::Arc;
use std::time::Instant;

use serde::Serialize;
use zeroset::model::{Model, Solid};
use zeroset::reconstruct::{FittedReport, PlanReport};
use zeroset_io::{check_model_suffix, shown, write_model};

use super::open::{own_name, provenance};
use crate::args::FitArgs;
use crate::console::{Console, Lines};
use crate::error::CliError;
use crate::input::{Input, Origin};
use crate::progress::with_progress;
use crate::reconstruct::{check_files, failed, known, params, planned, say_capped};
use crate::report::write_report;
use crate::table::{bytes, count, length, name, significant};
use crate::threads;

pub(crate) fn run(args: &FitArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let console = Console::of(&args.run);
    let formats = check(args)?;
    let mut params = params(&args.fit, &args.run, &formats);
    let lines_and_polygons = known::read(&args.fit)?;
    threads::start(args.run.threads)?;
    let (input, _) = Input::read(&args.input, console)?;
    let mut lines = Lines::new(console);
    input.describe(console, &mut lines);
    params.constraints = known::place(lines_and_polygons, &args.fit.constraints, &input.cloud, &mut lines)?;

    let plan = planned(&input.cloud, &params, &args.input, &args.fit, console, &mut lines)?;
    say_capped(&plan.report, &mut lines);
    let done = with_progress(console, |progress| plan.fit(progress))?;
    let (fitted, report) = done.map_err(|source| failed(&args.input, source))?;
    let names = args.input.inputs.iter().map(|path| own_name(path)).collect();
    let model = Model {
        solid: Solid::Fitted(Arc::new(fitted)),
        crs: input.cloud.crs.clone(),
        provenance: provenance(names, parameters(&report.plan)),
    };
    let written = write_model(&args.output, &model)?;
    lines.release();
    let unit = input.read.unit;
    console.say(&format!(
        "{}: {} from {}{} points ({}, resolution {}) in {} s",
        shown(&args.output),
        bytes(written),
        count(report.plan.points),
        input.of_all(report.plan.points),
        name(report.plan.scene),
        length(report.plan.resolution, unit),
        significant(start.elapsed().as_secs_f64(), 3),
    ));
    let content = Content { origin: Origin::of(&input), fitted: report, bytes: written };
    write_report(args.run.report.as_deref(), content)
}

#[derive(Debug, Serialize)]
struct Content<'a> {
    #[serde(flatten)]
    origin: Origin<'a>,
    #[serde(flatten)]
    fitted: FittedReport,
    /// Size of the model.
    bytes: u64,
}

/// What can be told to be wrong before anything is read.
fn check(args: &FitArgs) -> Result<Vec<zeroset_io::CloudFormat>, CliError> {
    check_model_suffix(&args.output)?;
    check_files(&args.input, &args.fit, Some(&args.output), &args.run)
}

/// What was decided, for whoever finds the model.
fn parameters(plan: &PlanReport) -> Vec<(String, String)> {
    [
        ("points", plan.points.to_string()),
        ("scene", name(plan.scene)),
        ("up", name(plan.up)),
        ("resolution", plan.resolution.to_string()),
        ("quality", name(plan.quality)),
        ("screening", plan.screening.to_string()),
        ("smoothness", plan.polish.map_or_else(|| "off".to_owned(), |polish| polish.smoothness.to_string())),
        ("trim", plan.trim.map_or_else(|| "off".to_owned(), |trim| trim.to_string())),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}
