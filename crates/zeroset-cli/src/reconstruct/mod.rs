//! `zeroset reconstruct`.

mod check;
mod select;
mod text;

pub(crate) use check::refuse_same;

use std::time::Instant;

use zeroset::fit::cascade::Scene;
use zeroset::mesh::Mesh;
use zeroset::reconstruct::{
    AttributeChoice, Plan, PlanReport, ReconstructError, ReconstructParams, ReconstructReport, Resolution, Trim, Up,
    plan,
};
use zeroset_io::{CloudFile, CloudFormat, WriteOptions, read_clouds, shown, write_mesh};

use crate::args::{AttributesChoice, OrOff, ReconstructArgs, SceneChoice, UpChoice};
use crate::console::{Console, Lines};
use crate::error::{CliError, in_words};
use crate::progress::Progress;
use crate::report::{ComponentsReport, Input, OutputReport, Report, Seconds};
use crate::{interrupt, memory};

pub(crate) fn run(args: &ReconstructArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let console = match (args.quiet, args.verbose) {
        (true, _) => Console::Quiet,
        (_, true) => Console::Verbose,
        _ => Console::Normal,
    };
    let formats = check::check(args)?;
    let params = params(args, &formats);
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global()?;
    }

    let progress = Progress::new(console);
    let mut seconds = Seconds::default();
    let input = read(args, &progress, &mut seconds)?;
    progress.finish();
    let mut lines = Lines::new(console);
    input.describe(console, &mut lines);

    let progress = Progress::new(console);
    let failed = |source: ReconstructError| CliError::Reconstruct { inputs: in_words(&args.inputs), source };
    let planning = Instant::now();
    let mut plan = interrupt::watched(|| plan(&input.cloud, &params, &progress))?.map_err(failed)?;
    seconds.plan = planning.elapsed().as_secs_f64();
    progress.finish();
    if args.scene == SceneChoice::Auto && params.scene.is_some() {
        plan.report.scene_reason = "every input is las or laz".to_owned();
    }
    announce(&plan.report, args, &mut lines);

    if args.dry_run {
        lines.release();
        let report = Report::planned(&input, &plan.report, args, &params, seconds.until(start));
        if !report.goes_to_stdout() {
            Console::print(&text::plan(&plan.report, &input, params.memory))?;
        }
        return report.write();
    }
    let (mut mesh, mut done) = fit(plan, console, failed)?;
    let components = ComponentsReport::new(least_triangles(args, done.plan.scene), &mut mesh);
    (done.vertices, done.triangles) = (mesh.vertices.len(), mesh.triangles.len());
    let output = write(args, &mesh, &done.plan, &input, console, &mut seconds)?;
    let seconds = seconds.until(start);
    lines.release();
    if let Some(output) = &output {
        console.say(&text::summary(&done, output, seconds.total, &input));
    }
    if console == Console::Verbose {
        Console::complain(text::tables(&done, &components, &seconds, &mesh).trim_end());
    }
    Report::done(&input, &done, components, args, &params, output, seconds).write()
}

/// What was typed, as the core understands it.
fn params(args: &ReconstructArgs, formats: &[CloudFormat]) -> ReconstructParams {
    let surveyed = formats.iter().all(|f| matches!(f, CloudFormat::Las | CloudFormat::Laz));
    ReconstructParams {
        scene: match args.scene {
            SceneChoice::Auto => surveyed.then_some(Scene::Airborne),
            SceneChoice::Object => Some(Scene::Object),
            SceneChoice::Terrain => Some(Scene::Terrain),
            SceneChoice::Airborne => Some(Scene::Airborne),
            SceneChoice::Free => Some(Scene::Free),
        },
        up: match args.up {
            UpChoice::X => Up::X,
            UpChoice::Y => Up::Y,
            UpChoice::Z => Up::Z,
            UpChoice::MinusX => Up::MinusX,
            UpChoice::MinusY => Up::MinusY,
            UpChoice::MinusZ => Up::MinusZ,
        },
        resolution: match (args.resolution, args.depth) {
            (Some(length), _) => Resolution::Length(length),
            (None, Some(depth)) => Resolution::Depth(depth),
            (None, None) => Resolution::Auto,
        },
        screening: args.screening,
        trim: match args.trim {
            None => Trim::Auto,
            Some(OrOff::Off) => Trim::Off,
            Some(OrOff::Value(length)) => Trim::Length(length),
        },
        attributes: match args.attributes {
            Some(AttributesChoice::Off) => AttributeChoice::Off,
            Some(AttributesChoice::Rgb) | None => AttributeChoice::Rgb,
            Some(AttributesChoice::Intensity) => AttributeChoice::Intensity,
            Some(AttributesChoice::Class) => AttributeChoice::Class,
        },
        memory: args.memory.unwrap_or_else(memory::default_limit),
    }
}

/// Reads all inputs and leaves out what the options leave out.
fn read(args: &ReconstructArgs, progress: &Progress, seconds: &mut Seconds) -> Result<Input, CliError> {
    use zeroset::monitor::Monitor;
    let start = Instant::now();
    progress.stage(&format!("reading {}", in_words(&args.inputs)));
    let CloudFile { cloud, report } = read_clouds(&args.inputs)?;
    seconds.read = start.elapsed().as_secs_f64();

    let start = Instant::now();
    progress.stage("choosing points");
    let input = select::select(cloud, report, args, progress)?;
    seconds.select = start.elapsed().as_secs_f64();
    Ok(input)
}

/// Says what was decided for the user.
fn announce(plan: &PlanReport, args: &ReconstructArgs, lines: &mut Lines) {
    if args.scene == SceneChoice::Auto {
        lines.say(text::scene(plan));
    }
    if let Some(wanted) = plan.wanted_resolution {
        lines.say(text::capped(plan, wanted));
    }
}

/// Pieces of open scenes with fewer triangles than this are about two cells across or less; see
/// [`drop_small_components`](zeroset::mesh::drop_small_components).
const LEAST_TRIANGLES: usize = 100;

/// The fewest triangles that a piece of the mesh must have. Objects keep all: what is small there may be meant.
fn least_triangles(args: &ReconstructArgs, scene: Scene) -> Option<usize> {
    match (args.min_component, scene) {
        (Some(OrOff::Off), _) | (None, Scene::Object | Scene::Free) => None,
        (Some(OrOff::Value(least)), _) => Some(least.get()),
        (None, Scene::Terrain | Scene::Airborne) => Some(LEAST_TRIANGLES),
    }
}

fn fit(
    plan: Plan<'_>,
    console: Console,
    failed: impl Fn(ReconstructError) -> CliError,
) -> Result<(Mesh, ReconstructReport), CliError> {
    let progress = Progress::new(console);
    let result = interrupt::watched(|| plan.run(&progress))?.map_err(failed);
    progress.finish();
    result
}

fn write(
    args: &ReconstructArgs,
    mesh: &Mesh,
    plan: &PlanReport,
    input: &Input,
    console: Console,
    seconds: &mut Seconds,
) -> Result<Option<OutputReport>, CliError> {
    use zeroset::monitor::Monitor;
    let Some(path) = &args.output else { return Ok(None) };
    let progress = Progress::new(console);
    progress.stage(&format!("writing {}", shown(path)));
    let start = Instant::now();
    let options = WriteOptions { resolution: Some(plan.resolution), unit: input.read.unit, ..WriteOptions::default() };
    let report = write_mesh(path, mesh, &options)?;
    seconds.write = start.elapsed().as_secs_f64();
    progress.finish();
    Ok(Some(OutputReport::new(path, report)?))
}
