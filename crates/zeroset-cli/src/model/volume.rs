//! `zeroset volume`.

use serde::Serialize;
use zeroset::model::{CutAndFill, Volume, VolumeParams, cut_and_fill, volume};

use super::open::open;
use super::{start, work};
use crate::args::{Bounds, Plane, VolumeArgs};
use crate::console::Console;
use crate::error::CliError;
use crate::input::{check_output_and_report, is_stream};
use crate::report::write_report;
use crate::table::{columns, significant};

pub(crate) fn run(args: &VolumeArgs) -> Result<(), CliError> {
    check_output_and_report(&[], None, args.run.report.as_deref())?;
    start(&args.run)?;
    let before = open(&args.model)?;
    let params = VolumeParams {
        bounds: args.bounds.map(Bounds::corners),
        above: args.above.map(|Plane { point, normal }| [point, normal]),
        step: args.step,
    };
    let content = match &args.after {
        None => {
            let found = work(&args.run, &args.model, |progress| volume(&before.solid, &params, progress))?;
            Content { volume: Some(found), change: None }
        }
        Some(after) => {
            let after = open(after)?;
            let found =
                work(&args.run, &args.model, |progress| cut_and_fill(&before.solid, &after.solid, &params, progress))?;
            Content { volume: None, change: Some(found) }
        }
    };
    if !args.run.report.as_deref().is_some_and(is_stream) {
        Console::print(&content.text())?;
    }
    write_report(args.run.report.as_deref(), content)
}

#[derive(Debug, Serialize)]
struct Content {
    #[serde(skip_serializing_if = "Option::is_none")]
    volume: Option<Volume>,
    #[serde(skip_serializing_if = "Option::is_none")]
    change: Option<CutAndFill>,
}

impl Content {
    fn text(&self) -> String {
        let rows = match (self.volume, self.change) {
            (Some(volume), _) => vec![("volume", volume)],
            (_, Some(change)) => vec![("cut", change.cut), ("fill", change.fill), ("net", change.net)],
            _ => Vec::new(),
        };
        let row = |(name, found): (&str, Volume)| {
            // No more digits than the error leaves.
            let digits = if found.error > 0.0 && found.volume != 0.0 {
                (found.volume.abs() / found.error).log10().floor().clamp(0.0, 12.0) as usize + 2
            } else {
                12
            };
            vec![name.to_owned(), significant(found.volume, digits), "+-".to_owned(), significant(found.error, 2)]
        };
        columns(&rows.into_iter().map(row).collect::<Vec<_>>())
    }
}
