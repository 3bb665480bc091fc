//! `zeroset slice`.

use serde::Serialize;
use zeroset::mesh::PlaneCurve;
use zeroset::model::{Cuts, MeshParams, Slices, slices};
use zeroset_io::{Section, SectionFormat, SectionLevel, SectionLine, SectionPlane, WriteOptions, shown, write_section};

use super::open::{files, open};
use super::{Written, console, start, work};
use crate::args::{Bounds, SliceArgs};
use crate::error::CliError;
use crate::input::check_output_and_report;
use crate::report::write_report;
use crate::table::count;

pub(crate) fn run(args: &SliceArgs) -> Result<(), CliError> {
    SectionFormat::from_path(&args.output)?;
    check_output_and_report(&files([args.model.as_str()]), Some(&args.output), args.run.report.as_deref())?;
    start(&args.run)?;
    let opened = open(&args.model)?;
    let cuts = match args.every {
        Some(step) => Cuts::Every(step),
        None => Cuts::Planes(args.plane.iter().map(|plane| [plane.point, plane.normal]).collect()),
    };
    let params = MeshParams { cell: args.cell, bounds: args.bounds.map(Bounds::corners), ..MeshParams::default() };
    let found = work(&args.run, &args.model, |progress| slices(&opened.solid, &cuts, &params, progress))?;
    let section = section(found, args.every.is_some(), opened.crs);
    let lines = || section.levels.iter().flat_map(|level| &level.lines);
    let (all, closed) = (lines().count(), lines().filter(|line| line.closed).count());
    if all == 0 {
        return Err(CliError::NothingCut { what: args.model.clone() });
    }
    let written = write_section(&args.output, &section, &WriteOptions::default())?;
    console(&args.run).say(&format!(
        "{}: {} curves, {} of them closed, in {} planes",
        shown(&args.output),
        count(all),
        count(closed),
        count(section.levels.len())
    ));
    let content =
        Content { planes: section.levels.len(), curves: all, closed, output: Written::new(&args.output, &written) };
    write_report(args.run.report.as_deref(), content)
}

#[derive(Debug, Serialize)]
struct Content {
    planes: usize,
    curves: usize,
    closed: usize,
    output: Written,
}

/// Curves as they are written. Contour lines know their height.
fn section(found: Slices, are_contours: bool, crs: Option<String>) -> Section {
    let line = |PlaneCurve { positions, closed }: PlaneCurve| SectionLine { positions, closed };
    let up = found.world_from_local[2];
    let level = |([point, normal], curves): ([[f64; 3]; 2], Vec<PlaneCurve>)| SectionLevel {
        plane: SectionPlane { point, normal },
        height: are_contours.then_some(point[2] + up),
        lines: curves.into_iter().map(line).collect(),
    };
    Section { world_from_local: found.world_from_local, crs, levels: found.levels.into_iter().map(level).collect() }
}
