//! `zeroset raster`.

use serde::Serialize;
use zeroset::model::heights;
use zeroset_io::{Raster, RasterFormat, shown, write_raster};

use super::open::{files, open};
use super::{Written, console, start, work};
use crate::args::{Bounds, RasterArgs};
use crate::error::CliError;
use crate::input::check_output_and_report;
use crate::report::write_report;
use crate::table::{count, significant};

pub(crate) fn run(args: &RasterArgs) -> Result<(), CliError> {
    RasterFormat::from_path(&args.output)?;
    check_output_and_report(&files([args.model.as_str()]), Some(&args.output), args.run.report.as_deref())?;
    start(&args.run)?;
    let opened = open(&args.model)?;
    let bounds = args.bounds.map(Bounds::corners);
    let found = work(&args.run, &args.model, |progress| heights(&opened.solid, args.cell, bounds, progress))?;
    let raster =
        Raster { origin: found.corner, cell: found.cell, size: found.size, values: found.values, crs: opened.crs };
    let with_height = raster.values.iter().filter(|value| !value.is_nan()).count();
    let written = write_raster(&args.output, &raster)?;
    console(&args.run).say(&format!(
        "{}: {} by {} pixels of {}, {} of them with a height",
        shown(&args.output),
        count(raster.size[0]),
        count(raster.size[1]),
        significant(raster.cell, 4),
        count(with_height),
    ));
    let content =
        Content { size: raster.size, cell: raster.cell, with_height, output: Written::new(&args.output, &written) };
    write_report(args.run.report.as_deref(), content)
}

#[derive(Debug, Serialize)]
struct Content {
    size: [usize; 2],
    cell: f64,
    with_height: usize,
    output: Written,
}
