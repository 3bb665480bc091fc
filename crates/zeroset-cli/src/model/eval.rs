//! `zeroset eval`.

use std::time::Instant;

use serde::Serialize;
use zeroset::model::evaluate;
use zeroset_io::{EvaluatedPoints, PositionFormat, TableFormat, read_positions, write_evaluated};

use super::open::{files, open};
use super::{Written, console, start, work};
use crate::args::EvalArgs;
use crate::error::CliError;
use crate::input::{check_output_and_report, is_stream};
use crate::report::write_report;
use crate::table::{count, significant};

pub(crate) fn run(args: &EvalArgs) -> Result<(), CliError> {
    PositionFormat::from_path(&args.points)?;
    TableFormat::from_path(&args.output)?;
    let mut inputs = files([args.model.as_str()]);
    inputs.extend((!is_stream(&args.points)).then(|| args.points.clone()));
    check_output_and_report(&inputs, Some(&args.output), args.run.report.as_deref())?;
    start(&args.run)?;
    let opened = open(&args.model)?;
    let points = read_positions(&args.points)?;
    let begin = Instant::now();
    let found = work(&args.run, &args.model, |progress| evaluate(&opened.solid, &points.positions, progress))?;
    let seconds = begin.elapsed().as_secs_f64();
    let table = EvaluatedPoints {
        inside: found.values.iter().map(|value| *value < 0.0).collect(),
        positions: points.positions,
        values: found.values,
        gradients: found.gradients,
        crs: opened.crs,
    };
    let written = write_evaluated(&args.output, &table)?;
    let inside = table.inside.iter().filter(|is_inside| **is_inside).count();
    let rate = table.positions.len() as f64 / seconds.max(1e-9);
    if !is_stream(&args.output) {
        console(&args.run).say(&format!(
            "{}: {} points, {} of them inside, {} million a second",
            zeroset_io::shown(&args.output),
            count(table.positions.len()),
            count(inside),
            significant(rate / 1e6, 3),
        ));
    }
    for note in &points.notes {
        console(&args.run).say(note);
    }
    let content = Content {
        points: table.positions.len(),
        left_out: points.left_out,
        inside,
        seconds,
        output: Written::new(&args.output, &written),
    };
    write_report(args.run.report.as_deref(), content)
}

#[derive(Debug, Serialize)]
struct Content {
    points: usize,
    /// Points that were not finite.
    left_out: u64,
    inside: usize,
    /// Wall seconds of the evaluation alone.
    seconds: f64,
    output: Written,
}
