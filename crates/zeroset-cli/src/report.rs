//! JSON reports: how all are written, and that of a reconstruction.
//!
//! Their names do not change within a `schema_version`; new ones may come. Lengths are in the unit of the input,
//! positions in its reference system.

use std::io::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use zeroset::constraint::ConstraintReport;
use zeroset::contour::{ContourReport, SharpReport};
use zeroset::fit::cascade::{FitReport, PolishReport};
use zeroset::mesh::{DroppedComponents, SimplifyReport};
use zeroset::reconstruct::{PlanReport, ReconstructParams, ReconstructReport, StructureReport};
use zeroset_io::{IoError, MeshFormat, WriteReport, shown, write_atomically};

use crate::args::ReconstructArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::input::{Input, Origin, is_stream};
use crate::memory;
use crate::table::position;

/// Version of the shape of reports.
const SCHEMA_VERSION: u32 = 1;

/// A report with the version of its shape.
#[derive(Debug, Serialize)]
struct Versioned<T> {
    schema_version: u32,
    zeroset_version: &'static str,
    #[serde(flatten)]
    content: T,
}

/// Writes a report, if one was asked for.
pub(crate) fn write_report(path: Option<&Path>, content: impl Serialize) -> Result<(), CliError> {
    let Some(path) = path else { return Ok(()) };
    let zeroset_version = env!("CARGO_PKG_VERSION");
    write_text(path, &to_json(&Versioned { schema_version: SCHEMA_VERSION, zeroset_version, content }))
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
    pub(crate) structure: f64,
    /// See `StageSeconds`.
    pub(crate) polish: f64,
    /// See `StageSeconds`.
    pub(crate) contour: f64,
    /// See `StageSeconds`.
    pub(crate) sharpen: f64,
    /// See `StageSeconds`.
    pub(crate) simplify: f64,
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
    pub(crate) fn new(done: &ReconstructReport) -> Self {
        Self { least_triangles: done.plan.min_component, dropped: done.dropped }
    }
}

/// The mesh file.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct OutputReport {
    pub(crate) path: String,
    format: &'static str,
    bytes: u64,
    /// What to add to the coordinates in the file, where they are local.
    local_offset: Option<[f64; 3]>,
    attributes_left_out: Vec<&'static str>,
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

    /// A line end and what to add to local coordinates; nothing where they are those of the input.
    pub(crate) fn offset_line(&self) -> String {
        self.local_offset.filter(|offset| *offset != [0.0; 3]).map_or_else(String::new, |offset| {
            format!("\nits coordinates are local: add {} for those of the input", position(offset, 0))
        })
    }

    /// A line end and the attributes that the format has no place for; nothing without any.
    pub(crate) fn left_out_line(&self) -> String {
        if self.attributes_left_out.is_empty() {
            return String::new();
        }
        format!("\nthe format has no place for {}", self.attributes_left_out.join(", "))
    }
}

#[derive(Debug, Serialize)]
struct Counts {
    vertices: usize,
    triangles: usize,
}

/// The whole report.
#[derive(Debug, Serialize)]
pub(crate) struct Report<'a> {
    #[serde(flatten)]
    origin: Origin<'a>,
    plan: &'a PlanReport,
    /// Null if nothing but the plan was made.
    fit: Option<&'a FitReport>,
    /// Null in a draft, as are the polish and the sharpening.
    structure: Option<&'a StructureReport>,
    polish: Option<&'a PolishReport>,
    contour: Option<&'a ContourReport>,
    sharp: Option<&'a SharpReport>,
    /// Null without any.
    constraints: Option<&'a ConstraintReport>,
    mesh: Option<Counts>,
    components: Option<ComponentsReport>,
    /// Null if the mesh was not to be simplified.
    simplify: Option<&'a SimplifyReport>,
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
        Self {
            origin: Origin::of(input),
            plan,
            fit: None,
            structure: None,
            polish: None,
            contour: None,
            sharp: None,
            constraints: None,
            mesh: None,
            components: None,
            simplify: None,
            output: None,
            seconds,
            threads: rayon::current_num_threads(),
            memory_limit_bytes: params.memory,
            memory_peak_bytes: memory::peak(),
            path: args.run.report.clone(),
        }
    }

    /// The report of a finished reconstruction.
    pub(crate) fn done(
        input: &'a Input,
        done: &'a ReconstructReport,
        args: &ReconstructArgs,
        params: &ReconstructParams,
        output: Option<OutputReport>,
        seconds: Seconds,
    ) -> Self {
        let stages = done.seconds;
        let seconds = Seconds {
            plan: stages.plan,
            fit: stages.fit,
            structure: stages.structure,
            polish: stages.polish,
            contour: stages.contour,
            sharpen: stages.sharpen,
            simplify: stages.simplify,
            attributes: stages.attributes,
            ..seconds
        };
        Self {
            fit: Some(&done.fit),
            structure: done.structure.as_ref(),
            polish: done.polish.as_ref(),
            contour: Some(&done.contour),
            sharp: done.sharp.as_ref(),
            constraints: done.constraints.as_ref(),
            mesh: Some(Counts { vertices: done.vertices, triangles: done.triangles }),
            components: Some(ComponentsReport::new(done)),
            simplify: done.simplify.as_ref(),
            output,
            ..Self::planned(input, &done.plan, args, params, seconds)
        }
    }

    /// Whether the report is what standard output is for.
    pub(crate) fn goes_to_stdout(&self) -> bool {
        self.path.as_deref().is_some_and(is_stream)
    }

    /// Writes the report where it was asked for, if it was.
    pub(crate) fn write(&self) -> Result<(), CliError> {
        write_report(self.path.as_deref(), self)
    }
}

/// Writes text to a file, or to standard output for `-`.
pub(crate) fn write_text(path: &Path, text: &str) -> Result<(), CliError> {
    if is_stream(path) {
        return Console::print(text);
    }
    let fill = |out: &mut std::io::BufWriter<std::fs::File>| {
        out.write_all(text.as_bytes()).map_err(|source| IoError::from_system(path, source))
    };
    write_atomically::<IoError>(path, fill)?;
    Ok(())
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
