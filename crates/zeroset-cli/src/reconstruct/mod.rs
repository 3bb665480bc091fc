//! `zeroset reconstruct`.

pub(crate) mod known;
mod text;
mod tiles;

use std::path::Path;
use std::time::Instant;

use zeroset::cloud::Cloud;
use zeroset::constraint::Constraints;
use zeroset::mesh::Mesh;
use zeroset::reconstruct::{
    AttributeChoice, MinComponent, Plan, PlanReport, Quality, ReconstructError, ReconstructParams, Resolution, Trim,
    plan,
};
use zeroset_io::{CloudFormat, WriteOptions, shown, write_mesh};

use crate::args::{
    AttributesChoice, FitOptions, InputArgs, OrAuto, OrOff, QualityChoice, ReconstructArgs, RunArgs, SceneChoice,
};
use crate::console::{Console, Lines};
use crate::error::{CliError, in_words};
use crate::input::{Input, SURVEYED, announced, check_inputs, check_output_and_report, refuse_mesh_stream, scene, up};
use crate::progress::{Progress, with_progress};
use crate::report::{OutputReport, Report, Seconds};
use crate::{memory, threads};

pub(crate) fn run(args: &ReconstructArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let console = Console::of(&args.run);
    let formats = check(args)?;
    let mut params = ReconstructParams {
        simplify: args.simplify.params(),
        attributes: attributes(args.attributes),
        ..params(&args.fit, &args.run, &formats)
    };
    let known = known::read(&args.fit)?;
    threads::start(args.run.threads)?;
    let mut of_tiles = params.clone();
    known.iter().for_each(|file| of_tiles.constraints.append(file.constraints.clone()));
    if tiles::are_asked_for(args) || tiles::are_needed(args, &params) {
        return tiles::reconstruct(args, &of_tiles, console);
    }

    let (mut input, reading) = Input::read(&args.input, console)?;
    let mut seconds = Seconds { read: reading.read, select: reading.select, ..Seconds::default() };
    if let Some(warning) = missing_attribute(args, &input.cloud) {
        input.warnings.insert(0, warning);
    }
    let mut lines = Lines::new(console);
    input.describe(console, &mut lines);
    params.constraints = known::place(known, &args.fit.constraints, &input.cloud, &mut lines)?;

    let planning = Instant::now();
    let plan = planned(&input.cloud, &params, &args.input, &args.fit, console, &mut lines);
    if tiles::are_called_for(args, &plan, &params) {
        let refused = plan.err();
        drop(input);
        return match (tiles::reconstruct(args, &of_tiles, console), refused) {
            // What is no ground has to fit into memory, and so has a tile.
            (Err(error), Some(refused)) if tiles::are_none(&error) => Err(refused),
            (made, _) => made,
        };
    }
    let plan = plan?;
    say_capped(&plan.report, &mut lines);
    seconds.plan = planning.elapsed().as_secs_f64();

    if args.dry_run {
        lines.release();
        let report = Report::planned(&input, &plan.report, args, &params, seconds.until(start));
        if !report.goes_to_stdout() {
            Console::print(&text::plan(&plan.report, &input, params.memory))?;
        }
        return report.write();
    }
    let done = with_progress(console, |progress| plan.run(progress))?;
    let (mesh, done) = done.map_err(|source| failed(&args.input, source))?;
    let output = write(args, &mesh, &done.plan, &input, console, &mut seconds)?;
    let seconds = seconds.until(start);
    lines.release();
    if let Some(output) = &output {
        console.say(&text::summary(&done, output, seconds.total, &input));
    }
    if console == Console::Verbose {
        Console::complain(text::tables(&done, &seconds, &mesh).trim_end());
    }
    Report::done(&input, &done, args, &params, output, seconds).write()
}

/// What was typed, as the core understands it, but for the constraints.
pub(crate) fn params(args: &FitOptions, run: &RunArgs, formats: &[CloudFormat]) -> ReconstructParams {
    ReconstructParams {
        scene: scene(&args.scene, formats),
        up: up(&args.scene),
        resolution: match (args.resolution, args.depth) {
            (Some(length), _) => Resolution::Length(length),
            (None, Some(depth)) => Resolution::Depth(depth),
            (None, None) => Resolution::Auto,
        },
        quality: match args.quality {
            Some(QualityChoice::Draft) => Quality::Draft,
            Some(QualityChoice::Normal) | None => Quality::Normal,
            Some(QualityChoice::Fine) => Quality::Fine,
        },
        screening: args.screening,
        smoothness: args.smooth.and_then(OrAuto::value),
        trim: match args.trim {
            None => Trim::Auto,
            Some(OrOff::Off) => Trim::Off,
            Some(OrOff::Value(length)) => Trim::Length(length),
        },
        min_component: match args.min_component {
            None => MinComponent::Auto,
            Some(OrOff::Off) => MinComponent::Off,
            Some(OrOff::Value(least)) => MinComponent::Triangles(least.get()),
        },
        constraints: Constraints::default(),
        memory: run.memory.unwrap_or_else(memory::default_limit),
        ..ReconstructParams::default()
    }
}

/// Which values of the points are asked for.
pub(crate) fn attributes(choice: Option<AttributesChoice>) -> AttributeChoice {
    match choice {
        Some(AttributesChoice::Off) => AttributeChoice::Off,
        Some(AttributesChoice::Rgb) | None => AttributeChoice::Rgb,
        Some(AttributesChoice::Intensity) => AttributeChoice::Intensity,
        Some(AttributesChoice::Class) => AttributeChoice::Class,
    }
}

/// What can be told to be wrong before anything is read. Returns the formats of the inputs.
fn check(args: &ReconstructArgs) -> Result<Vec<CloudFormat>, CliError> {
    if let Some(output) = &args.output {
        refuse_mesh_stream(output)?;
        tiles::check_format(output)?;
    }
    let file = args.output.as_deref().filter(|output| !tiles::is_folder(output));
    check_files(&args.input, &args.fit, file, &args.run)
}

/// Looks at the names of the files that are read and written. Returns the formats of the inputs.
pub(crate) fn check_files(
    input: &InputArgs,
    fit: &FitOptions,
    output: Option<&Path>,
    run: &RunArgs,
) -> Result<Vec<CloudFormat>, CliError> {
    let formats = check_inputs(&input.inputs)?;
    let read = [&input.inputs[..], &fit.constraints[..]].concat();
    check_output_and_report(&read, output, run.report.as_deref())?;
    known::check(&fit.constraints)?;
    Ok(formats)
}

/// A warning if values are asked for that the points do not have.
fn missing_attribute(args: &ReconstructArgs, cloud: &Cloud) -> Option<String> {
    let from = &cloud.attributes;
    let (there, name) = match args.attributes? {
        AttributesChoice::Off => return None,
        AttributesChoice::Rgb => (from.colors.is_some(), "colours"),
        AttributesChoice::Intensity => (from.intensities.is_some(), "intensities"),
        AttributesChoice::Class => (from.classes.is_some(), "classes"),
    };
    (!there).then(|| format!("the points have no {name}, so the mesh will have none"))
}

/// Plans, and says what was decided for the user.
pub(crate) fn planned<'a>(
    cloud: &'a Cloud,
    params: &ReconstructParams,
    input: &InputArgs,
    fit: &FitOptions,
    console: Console,
    lines: &mut Lines,
) -> Result<Plan<'a>, CliError> {
    let plan = with_progress(console, |progress| plan(cloud, params, progress))?;
    let mut plan = plan.map_err(|source| failed(input, source))?;
    let report = &mut plan.report;
    if fit.scene.scene == SceneChoice::Auto {
        if params.scene.is_some() {
            report.scene_reason = SURVEYED.to_owned();
        }
        lines.say(announced(report.scene, &report.scene_reason));
    }
    Ok(plan)
}

/// Says if memory made cells larger.
pub(crate) fn say_capped(report: &PlanReport, lines: &mut Lines) {
    if let Some(wanted) = report.wanted_resolution {
        lines.say(text::capped(report, wanted));
    }
}

/// The error with the names of the files that it is about.
pub(crate) fn failed(input: &InputArgs, source: ReconstructError) -> CliError {
    CliError::Reconstruct { inputs: in_words(&input.inputs), source }
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
