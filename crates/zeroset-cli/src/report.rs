//! The JSON report of a reconstruction.
//!
//! Its names do not change within a `schema_version`; new ones may come. Lengths are in the unit of the input,
//! positions in its reference system.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use zeroset::cloud::Cloud;
use zeroset::contour::ContourReport;
use zeroset::fit::cascade::FitReport;
use zeroset::mesh::{DroppedComponents, Mesh, drop_small_components};
use zeroset::reconstruct::{PlanReport, ReconstructParams, ReconstructReport};
use zeroset_io::{IoError, MeshFormat, ReadReport, WriteReport, shown, write_atomically};

use crate::args::ReconstructArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::memory;

/// Version of the report's shape.
const SCHEMA_VERSION: u32 = 1;

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

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, Default, Serialize)]
pub(crate) struct Seconds {
    /// Reading and decoding.
    pub(crate) read: f64,
    /// Leaving out points.
    pub(crate) select: f64,
    /// See `StageSeconds`.
    pub(crate) plan: f64,
    /// See `StageSeconds`.
    pub(crate) fit: f64,
    /// See `StageSeconds`.
    pub(crate) contour: f64,
    /// See `StageSeconds`.
    pub(crate) attributes: f64,
    /// Writing the mesh.
    pub(crate) write: f64,
    /// From the start to the end of writing.
    pub(crate) total: f64,
}

impl Seconds {
    /// With the total up to now.
    pub(crate) fn until(self, start: std::time::Instant) -> Self {
        Self { total: start.elapsed().as_secs_f64(), ..self }
    }
}

/// What became of the smallest pieces of the mesh.
#[derive(Debug, Clone, Copy, Serialize)]
pub(crate) struct ComponentsReport {
    /// The fewest triangles of a piece that stays; null if all stay.
    pub(crate) least_triangles: Option<usize>,
    /// What was left out.
    pub(crate) dropped: DroppedComponents,
}

impl ComponentsReport {
    /// Drops the pieces of fewer triangles, if there is a limit.
    pub(crate) fn new(least_triangles: Option<usize>, mesh: &mut Mesh) -> Self {
        let dropped = least_triangles.map(|least| drop_small_components(mesh, least)).unwrap_or_default();
        Self { least_triangles, dropped }
    }
}

/// The mesh file.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct OutputReport {
    pub(crate) path: String,
    format: &'static str,
    bytes: u64,
    /// What to add to the coordinates in the file, where they are local.
    pub(crate) local_offset: Option<[f64; 3]>,
    pub(crate) attributes_left_out: Vec<&'static str>,
}

impl OutputReport {
    pub(crate) fn new(path: &Path, report: WriteReport) -> Result<Self, IoError> {
        Ok(Self {
            path: shown(path),
            format: MeshFormat::from_path(path)?.name(),
            bytes: report.bytes,
            local_offset: report.local_offset,
            attributes_left_out: report.attributes_left_out,
        })
    }
}

/// One input file.
#[derive(Debug, Serialize)]
struct Source {
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

#[derive(Debug, Serialize)]
struct Counts {
    vertices: usize,
    triangles: usize,
}

/// The whole report.
#[derive(Debug, Serialize)]
pub(crate) struct Report<'a> {
    schema_version: u32,
    zeroset_version: &'static str,
    inputs: Vec<Source>,
    points: Points,
    filters: &'a Filters,
    notes: Vec<&'a str>,
    crs: Option<&'a str>,
    unit: Option<&'static str>,
    unit_metres: Option<f64>,
    world_from_local: [f64; 3],
    plan: &'a PlanReport,
    /// Null if nothing but the plan was made.
    fit: Option<&'a FitReport>,
    contour: Option<&'a ContourReport>,
    mesh: Option<Counts>,
    components: Option<ComponentsReport>,
    output: Option<OutputReport>,
    seconds: Seconds,
    threads: usize,
    memory_limit_bytes: u64,
    memory_peak_bytes: Option<u64>,
    #[serde(skip)]
    path: Option<PathBuf>,
}

impl<'a> Report<'a> {
    /// The report of a plan that is not run.
    pub(crate) fn planned(
        input: &'a Input,
        plan: &'a PlanReport,
        args: &ReconstructArgs,
        params: &ReconstructParams,
        seconds: Seconds,
    ) -> Self {
        let read = &input.read;
        let source = |source: &zeroset_io::Source| Source {
            path: shown(&source.path),
            format: source.format.name(),
            points: source.points,
            non_finite: source.non_finite,
            withheld: source.withheld,
            attributes: source.attributes.clone(),
        };
        Self {
            schema_version: SCHEMA_VERSION,
            zeroset_version: env!("CARGO_PKG_VERSION"),
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
            plan,
            fit: None,
            contour: None,
            mesh: None,
            components: None,
            output: None,
            seconds,
            threads: rayon::current_num_threads(),
            memory_limit_bytes: params.memory,
            memory_peak_bytes: memory::peak(),
            path: args.report.clone(),
        }
    }

    /// The report of a finished reconstruction.
    pub(crate) fn done(
        input: &'a Input,
        done: &'a ReconstructReport,
        components: ComponentsReport,
        args: &ReconstructArgs,
        params: &ReconstructParams,
        output: Option<OutputReport>,
        seconds: Seconds,
    ) -> Self {
        let stages = done.seconds;
        let seconds = Seconds {
            plan: stages.plan,
            fit: stages.fit,
            contour: stages.contour,
            attributes: stages.attributes,
            ..seconds
        };
        Self {
            fit: Some(&done.fit),
            contour: Some(&done.contour),
            mesh: Some(Counts { vertices: done.vertices, triangles: done.triangles }),
            components: Some(components),
            output,
            ..Self::planned(input, &done.plan, args, params, seconds)
        }
    }

    /// Whether the report is what standard output is for.
    pub(crate) fn goes_to_stdout(&self) -> bool {
        self.path.as_deref() == Some(Path::new("-"))
    }

    /// Writes the report where it was asked for, if it was.
    pub(crate) fn write(&self) -> Result<(), CliError> {
        let Some(path) = &self.path else { return Ok(()) };
        let text = to_json(self);
        if self.goes_to_stdout() {
            return Console::print(&text);
        }
        let fill = |out: &mut std::io::BufWriter<std::fs::File>| {
            out.write_all(text.as_bytes()).map_err(|source| IoError::from_system(path, source))
        };
        write_atomically::<IoError>(path, fill)?;
        Ok(())
    }
}

/// JSON for people and programs, with a line end.
pub(crate) fn to_json(value: &impl Serialize) -> String {
    // Plain structures with names for keys always serialise.
    let mut text = serde_json::to_string_pretty(value).unwrap_or_default();
    text.push('\n');
    text
}

/// The same on one line, for lists of values.
pub(crate) fn to_json_line(value: &impl Serialize) -> String {
    let mut text = serde_json::to_string(value).unwrap_or_default();
    text.push('\n');
    text
}
