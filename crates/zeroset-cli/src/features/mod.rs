//! `zeroset features`.

mod report;
mod text;

use std::path::Path;
use std::time::Instant;

use serde_json::Value;
use zeroset::feature::{FeatureError, FeatureParams, FeatureReport, Features, Posture, detect};
use zeroset::monitor::Monitor;
use zeroset_io::{CloudFormat, FeatureFormat, FeatureOutput, WriteOptions, write_features};

use crate::args::{FeaturesArgs, PostureChoice, SceneChoice};
use crate::console::{Console, Lines};
use crate::error::{CliError, in_words};
use crate::input::{Input, SURVEYED, announced, check_inputs, check_outputs, scene, shown_output, up};
use crate::progress::{Progress, with_progress};
use crate::report::write_report;
use crate::table::name;
use crate::{memory, threads};
use report::{OutputReport, Report, Seconds};

pub(crate) fn run(args: &FeaturesArgs) -> Result<(), CliError> {
    let start = Instant::now();
    let console = Console::of(&args.run);
    let formats = check(args)?;
    let params = params(args, &formats);
    threads::start(args.run.threads)?;

    let (input, reading) = Input::read(&args.input, console)?;
    let mut lines = Lines::new(console);
    input.describe(console, &mut lines);

    let failed = |source: FeatureError| CliError::Features { inputs: in_words(&args.input.inputs), source };
    let detecting = Instant::now();
    let found = with_progress(console, |progress| detect(&input.cloud, &params, progress))?;
    let (features, mut done) = found.map_err(failed)?;
    let detected = detecting.elapsed().as_secs_f64();
    if args.scene.scene == SceneChoice::Auto {
        if params.scene.is_some() {
            done.scene_reason = SURVEYED.to_owned();
        }
        lines.say(announced(done.scene, &done.scene_reason));
    }

    if features.planes.is_empty() {
        lines.say(text::no_planes(&done));
    }

    let writing = Instant::now();
    let outputs = write(args, &params, &features, &done, &input, console)?;
    let seconds = Seconds {
        read: reading.read,
        select: reading.select,
        detect: detected,
        write: writing.elapsed().as_secs_f64(),
        total: start.elapsed().as_secs_f64(),
    };
    lines.release();
    console.say(&text::summary(&features, &done, &outputs, seconds.total, &input));
    if console == Console::Verbose {
        Console::complain(text::tables(&features, &done, &seconds, &input).trim_end());
    }
    let report = Report::new(&input, &features, &done, args, &params, outputs, seconds);
    write_report(args.run.report.as_deref(), report)
}

/// What can be told to be wrong before anything is read. Returns the formats of the inputs.
fn check(args: &FeaturesArgs) -> Result<Vec<CloudFormat>, CliError> {
    for output in &args.outputs {
        FeatureFormat::from_path(output)?;
    }
    let formats = check_inputs(&args.input.inputs)?;
    let outputs = args.outputs.iter().map(|path| (path.as_path(), "an output"));
    let report = args.run.report.iter().map(|path| (path.as_path(), "the report"));
    check_outputs(&args.input.inputs, &outputs.chain(report).collect::<Vec<_>>())?;
    Ok(formats)
}

/// What was typed, as the core understands it.
fn params(args: &FeaturesArgs, formats: &[CloudFormat]) -> FeatureParams {
    FeatureParams {
        scene: scene(&args.scene, formats),
        up: up(&args.scene),
        min_area: args.min_area,
        max_distance: args.max_distance,
        max_angle: args.max_angle.map(f64::to_radians),
        sharp_angle: args.sharp_angle.to_radians(),
        posture: match args.posture {
            PostureChoice::Upright => Posture::Upright,
            PostureChoice::Free => Posture::Free,
        },
        memory: args.run.memory.unwrap_or_else(memory::default_limit),
    }
}

fn write(
    args: &FeaturesArgs,
    params: &FeatureParams,
    features: &Features,
    done: &FeatureReport,
    input: &Input,
    console: Console,
) -> Result<Vec<OutputReport>, CliError> {
    let progress = Progress::new(console);
    // What lies closer together than a tenth of the points' distance is not told apart.
    let options =
        WriteOptions { resolution: Some(0.1 * done.spacing), unit: input.read.unit, ..WriteOptions::default() };
    let parameters = parameters(args, params, done);
    let output = FeatureOutput { features, cloud: Some(&input.cloud), parameters: &parameters, options: &options };
    let write = |path: &Path| {
        let shown = shown_output(path);
        progress.stage(&format!("writing {shown}"));
        let report = write_features(path, output)?;
        Ok(OutputReport { path: shown, format: FeatureFormat::from_path(path)?.name(), bytes: report.bytes })
    };
    args.outputs.iter().map(|path| write(path)).collect()
}

/// How the features were found, for their own file. No times: equal input gives equal bytes.
fn parameters(args: &FeaturesArgs, params: &FeatureParams, done: &FeatureReport) -> Value {
    serde_json::json!({
        "points": done.points,
        "spacing": done.spacing,
        "noise": done.noise,
        "scene": done.scene,
        "scene_reason": done.scene_reason,
        "up": name(up(&args.scene)),
        "min_area": done.min_area,
        "max_distance": done.max_distance,
        "max_angle_deg": done.max_angle_deg,
        "sharp_angle_deg": done.sharp_angle_deg,
        "posture": name(params.posture),
    })
}
