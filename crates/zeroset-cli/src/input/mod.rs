//! The points that are used, and where they come from.

mod kind;
mod names;
mod scene;
mod select;

pub(crate) use kind::{CloudOrMesh, cloud_or_mesh, read_cloud_or_mesh};
pub(crate) use names::{
    check_inputs, check_is_file, check_output_and_report, check_outputs, is_stream, refuse_mesh_stream, refuse_same,
    shown_output,
};
pub(crate) use scene::{SURVEYED, announced, scene, up, up_axis, up_name};
pub(crate) use select::filter;

use std::time::Instant;

use serde::Serialize;
use zeroset::cloud::Cloud;
use zeroset::monitor::Monitor;
use zeroset_io::{CloudFile, ReadReport, read_clouds, shown};

use crate::args::InputArgs;
use crate::console::{Console, Lines};
use crate::error::{CliError, in_words};
use crate::progress::Progress;
use crate::table::count;

/// The points that are used, and where they come from.
#[derive(Debug)]
pub(crate) struct Input {
    /// The points used.
    pub(crate) cloud: Cloud,
    /// What reading found out.
    pub(crate) read: ReadReport,
    /// What was to be left out.
    pub(crate) filters: Filters,
    /// What was left out.
    pub(crate) dropped: Dropped,
    /// Sentences that every user should read.
    pub(crate) warnings: Vec<String>,
}

/// Which points were to be used.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Filters {
    /// Only these classes.
    pub(crate) classes: Option<Vec<u8>>,
    /// None of these classes.
    pub(crate) exclude: Vec<u8>,
    /// Lowest and highest value on each axis; null where open.
    pub(crate) bounds: Option<[[Option<f64>; 2]; 3]>,
    /// Size of the groups of strays.
    pub(crate) outliers: Option<usize>,
}

/// How many points were left out, and why.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct Dropped {
    /// A coordinate was not finite.
    pub(crate) non_finite: u64,
    /// The file marks them as deleted.
    pub(crate) withheld: u64,
    /// By `--classes` and `--exclude`.
    pub(crate) by_class: u64,
    /// By `--bounds`.
    pub(crate) by_bounds: u64,
    /// By `--outliers`.
    pub(crate) isolated: u64,
}

impl Dropped {
    /// All of them.
    pub(crate) fn total(&self) -> u64 {
        self.non_finite + self.withheld + self.by_class + self.by_bounds + self.isolated
    }
}

/// Wall seconds of reading.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ReadSeconds {
    /// Reading and decoding.
    pub(crate) read: f64,
    /// Leaving out points.
    pub(crate) select: f64,
}

impl Input {
    /// Reads all inputs and leaves out what the options leave out.
    pub(crate) fn read(args: &InputArgs, console: Console) -> Result<(Self, ReadSeconds), CliError> {
        let progress = Progress::new(console);
        let start = Instant::now();
        progress.stage(&format!("reading {}", in_words(&args.inputs)));
        let CloudFile { cloud, report } = read_clouds(&args.inputs)?;
        let read = start.elapsed().as_secs_f64();

        let start = Instant::now();
        progress.stage("choosing points");
        let input = select::select(cloud, report, args, &progress)?;
        Ok((input, ReadSeconds { read, select: start.elapsed().as_secs_f64() }))
    }
}

impl Input {
    /// Says what was read and left out.
    pub(crate) fn describe(&self, console: Console, lines: &mut Lines) {
        for warning in &self.warnings {
            lines.say(format!("warning: {warning}"));
        }
        for note in &self.read.notes {
            lines.say(format!("note: {note}"));
        }
        console.detail(&format!("points: {}", self.points_in_words()));
    }

    pub(crate) fn points_in_words(&self) -> String {
        let dropped = [
            (self.dropped.non_finite, "not finite"),
            (self.dropped.withheld, "withheld"),
            (self.dropped.by_class, "by class"),
            (self.dropped.by_bounds, "by bounds"),
            (self.dropped.isolated, "isolated"),
        ];
        let said: Vec<String> =
            dropped.iter().filter(|(n, _)| *n > 0).map(|(n, why)| format!("{} {why}", count(*n))).collect();
        let used = count(self.cloud.len());
        if said.is_empty() { format!("{used}, all of them") } else { format!("{used}, left out {}", said.join(", ")) }
    }

    /// " of " and the number of all points, if some of them are not used.
    pub(crate) fn of_all(&self, used: usize) -> String {
        match self.dropped.total() {
            0 => String::new(),
            dropped => format!(" of {}", count(used as u64 + dropped)),
        }
    }
}

/// One input file.
#[derive(Debug, Serialize)]
struct SourceReport {
    path: String,
    format: &'static str,
    points: u64,
    non_finite: u64,
    withheld: u64,
    /// What the file holds beside positions.
    attributes: Vec<&'static str>,
}

#[derive(Debug, Serialize)]
struct Points {
    declared: Option<u64>,
    read: u64,
    dropped: Dropped,
    used: usize,
}

/// The part of a report that tells of the points.
#[derive(Debug, Serialize)]
pub(crate) struct Origin<'a> {
    inputs: Vec<SourceReport>,
    points: Points,
    filters: &'a Filters,
    notes: Vec<&'a str>,
    crs: Option<&'a str>,
    unit: Option<&'static str>,
    unit_metres: Option<f64>,
    world_from_local: [f64; 3],
}

impl<'a> Origin<'a> {
    pub(crate) fn of(input: &'a Input) -> Self {
        let read = &input.read;
        let source = |source: &zeroset_io::Source| SourceReport {
            path: shown(&source.path),
            format: source.format.name(),
            points: source.points,
            non_finite: source.non_finite,
            withheld: source.withheld,
            attributes: source.attributes.clone(),
        };
        Self {
            inputs: read.sources.iter().map(source).collect(),
            points: Points {
                declared: read.points_declared,
                read: read.points_read,
                dropped: input.dropped,
                used: input.cloud.len(),
            },
            filters: &input.filters,
            notes: input.warnings.iter().chain(&read.notes).map(String::as_str).collect(),
            crs: input.cloud.crs.as_deref(),
            unit: read.unit.map(zeroset_io::LinearUnit::name),
            unit_metres: read.unit.map(zeroset_io::LinearUnit::metres),
            world_from_local: input.cloud.world_from_local,
        }
    }
}
