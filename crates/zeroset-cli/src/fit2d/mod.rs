//! `zeroset fit2d`.

mod check;
mod measure;
mod picture;
mod plan;
mod report;

use zeroset::basis::RadialError;
use zeroset::contour::{Branches, Polyline, zero_lines};
use zeroset::domain::{DomainError, Place};
use zeroset::fit::Gradient;
use zeroset::fit::normalized::{
    Coefficients, Data, DataError, FitError, Fitted, MeanGradient, Normalization, NormalizedFit, Order0, Order1,
    Order2, Smoothness, Solver, SquaredGradient,
};
use zeroset::monitor::Monitor;
use zeroset_io::{PlanarData, planar_json, read_planar};

use crate::args::{BranchesChoice, Fit2dArgs, NormalizationChoice, SolverChoice};
use crate::console::Console;
use crate::error::CliError;
use crate::input::shown_output;
use crate::interrupt;
use crate::progress::Progress;
use crate::report::write_text;
use check::Output;
use plan::Plan;

/// Why a fit in the plane is not possible.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Fit2dError {
    /// A datum serves no fit.
    #[error("{name}: {source}")]
    Datum {
        /// Its name by its kind and its number, as in the file.
        name: String,
        /// Why.
        source: DataError,
    },
    /// The data have no box.
    #[error("all data lie in one place; give --bounds")]
    OnePlace,
    /// An option would change the domain that the file gives.
    #[error("the file has a domain of its own; leave out {option}, or give --domain to make another")]
    DomainGiven {
        /// The option.
        option: &'static str,
    },
    /// The domain is not possible.
    #[error(transparent)]
    Domain(#[from] DomainError),
    /// The radial functions are not possible.
    #[error(transparent)]
    Radial(#[from] RadialError),
    /// The fit failed.
    #[error(transparent)]
    Fit(#[from] FitError),
}

/// A fit that was made.
struct Done<'a> {
    input: &'a PlanarData,
    plan: &'a Plan,
    fitted: Fitted,
    contour: Vec<Polyline>,
}

pub(crate) fn run(args: &Fit2dArgs) -> Result<(), CliError> {
    let output = check::check(args)?;
    let console = Console::unless(args.quiet);
    let input = read_planar(&args.input)?;
    let progress = Progress::new(console);
    progress.stage("fitting");
    let failed = |source| CliError::Fit2d { input: args.input.clone(), source };
    let data = data(&input, args.line_weight).map_err(failed)?;
    let plan = plan::resolve(args, &input, &data).map_err(failed)?;
    let fitted = interrupt::watched(|| fit(args, &input, &data, &plan, &progress))?.map_err(failed)?;
    let contour = contour(args, &data, &plan, &fitted).map_err(|source| failed(named(&input, source)))?;
    progress.finish();
    let done = Done { input: &input, plan: &plan, fitted, contour };
    write(args, output, &done)?;
    for warning in &done.fitted.diagnosis.warnings {
        console.say(&format!("warning: {warning}"));
    }
    if let Some(note) = plan.note {
        console.say(&format!("note: {note}"));
    }
    console.say(&report::summary(&done, &shown_output(&args.output)));
    Ok(())
}

/// What was read, as the core understands it: points, then segments, then polygons.
fn data(input: &PlanarData, line_weight: f64) -> Result<Data<2>, Fit2dError> {
    let mut data = Data::new();
    let added = input
        .points
        .iter()
        .try_for_each(|p| data.point(p.position, p.weight))
        .and_then(|()| input.segments.iter().try_for_each(|&ends| data.segment(ends, line_weight)))
        .and_then(|()| input.polygons.iter().try_for_each(|ring| data.polygon(ring, line_weight)));
    added.map_err(|source| named(input, source))?;
    Ok(data)
}

/// An error about a datum, with the name that the user knows it by.
fn named(input: &PlanarData, source: DataError) -> Fit2dError {
    let datum = match &source {
        DataError::Empty => return Fit2dError::Fit(source.into()),
        DataError::Weight { datum, .. }
        | DataError::NotFinite { datum }
        | DataError::NoExtent { datum }
        | DataError::Outside { datum, .. }
        | DataError::Polygon { datum, .. } => *datum,
    };
    let (points, segments) = (input.points.len(), input.segments.len());
    let name = if datum < points {
        format!("point {datum}")
    } else if datum < points + segments {
        format!("segment {}", datum - points)
    } else {
        format!("polygon {}", datum - points - segments)
    };
    Fit2dError::Datum { name, source }
}

fn fit(
    args: &Fit2dArgs,
    input: &PlanarData,
    data: &Data<2>,
    plan: &Plan,
    progress: &Progress,
) -> Result<Fitted, Fit2dError> {
    let smoothness: &dyn Smoothness<2> = match args.order {
        0 => &Order0,
        1 => &Order1 { weight: plan.smoothness },
        _ => &Order2 { weight: plan.smoothness },
    };
    let mean = MeanGradient { gradient: Gradient::Element, ..MeanGradient::default() };
    let normalization: &dyn Normalization<2> = match args.normalization {
        NormalizationChoice::Coefficients => &Coefficients,
        NormalizationChoice::SquaredGradient => &SquaredGradient { gradient: Gradient::Element },
        NormalizationChoice::MeanGradient => &mean,
    };
    let solver = match args.solver {
        SolverChoice::Auto => Solver::Auto,
        SolverChoice::Dense => Solver::Dense,
        SolverChoice::ShiftInvert => Solver::ShiftInvert,
        SolverChoice::Lobpcg => Solver::Lobpcg,
    };
    let fit = NormalizedFit::new(plan.basis.as_ref(), data)
        .smoothness(smoothness)
        .normalization(normalization)
        .solver(solver)
        .monitor(progress);
    fit.run().map_err(|error| match error {
        FitError::Data(source) => named(input, source),
        other => other.into(),
    })
}

fn contour(args: &Fit2dArgs, data: &Data<2>, plan: &Plan, fitted: &Fitted) -> Result<Vec<Polyline>, DataError> {
    let f = fitted.function(plan.basis.as_ref());
    Ok(match args.branches {
        BranchesChoice::All => zero_lines(&f, plan.tolerance, Branches::All),
        BranchesChoice::Data => {
            let places: Vec<Place<2>> = data.samples(plan.basis.as_ref())?.iter().map(|s| s.place).collect();
            zero_lines(&f, plan.tolerance, Branches::WithData(&places))
        }
    })
}

fn write(args: &Fit2dArgs, output: Output, done: &Done<'_>) -> Result<(), CliError> {
    let text = match output {
        Output::Stream | Output::Json => planar_json(&report::result(args, done)),
        Output::Svg => picture::draw(args, done),
    };
    write_text(&args.output, &text)
}
