//! `zeroset render`.

mod paint;

use std::path::Path;
use std::time::Instant;

use serde::Serialize;
use zeroset_io::{PictureFormat, shown, write_picture};
use zeroset_view::render::{Projection, RenderError, View, render};
use zeroset_view::scene::{Layer, Scene, Shape};

use crate::args::RenderArgs;
use crate::console::Console;
use crate::content::{Content, is_possible};
use crate::error::{CliError, in_words};
use crate::input::{check_is_file, check_output_and_report, is_stream, up_axis};
use crate::progress::with_progress;
use crate::report::write_report;
use crate::table::{count, significant};
use crate::threads;

pub(crate) fn run(args: &RenderArgs) -> Result<(), CliError> {
    let console = Console::unless(args.run.quiet);
    check(args)?;
    threads::start(args.run.threads)?;
    let mut seconds = Seconds::default();
    let begin = Instant::now();
    let scene = with_progress(console, |progress| -> Result<Scene, CliError> {
        let content = Content::read(&args.files, progress)?;
        seconds.read = begin.elapsed().as_secs_f64();
        let start = Instant::now();
        let scene = paint::scene(content, args, progress)?;
        seconds.color = start.elapsed().as_secs_f64();
        Ok(scene)
    })??;
    let start = Instant::now();
    let picture = render(&scene, &view(args)).map_err(|source| refused(source, args))?;
    seconds.draw = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let written = write_picture(&args.output, picture.size, &picture.pixels)?;
    seconds.write = start.elapsed().as_secs_f64();
    seconds.total = begin.elapsed().as_secs_f64();
    let drawn = Drawn::of(&scene);
    console.say(&summary(args, &drawn, seconds.total));
    let output = Output { path: shown(&args.output), bytes: written.bytes, size: picture.size };
    write_report(
        args.run.report.as_deref(),
        Report { inputs: args.files.iter().map(|f| shown(f)).collect(), drawn, output, seconds },
    )
}

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, Default, Serialize)]
struct Seconds {
    /// Reading, and making surfaces of models.
    read: f64,
    /// Values and their colours.
    color: f64,
    /// Drawing.
    draw: f64,
    /// Writing the picture.
    write: f64,
    /// All of it.
    total: f64,
}

/// How much was drawn.
#[derive(Debug, Clone, Copy, Default, Serialize)]
struct Drawn {
    points: usize,
    triangles: usize,
    lines: usize,
}

impl Drawn {
    fn of(scene: &Scene) -> Self {
        let mut drawn = Self::default();
        for layer in &scene.layers {
            let sum = match layer.shape {
                Shape::Points { .. } => &mut drawn.points,
                Shape::Surface { .. } => &mut drawn.triangles,
                Shape::Lines { .. } => &mut drawn.lines,
            };
            *sum += Layer::count(layer);
        }
        drawn
    }
}

#[derive(Debug, Serialize)]
struct Output {
    path: String,
    bytes: u64,
    /// Pixels across and down.
    size: [u32; 2],
}

#[derive(Debug, Serialize)]
struct Report {
    inputs: Vec<String>,
    drawn: Drawn,
    output: Output,
    seconds: Seconds,
}

/// What can be told to be wrong before anything is read.
fn check(args: &RenderArgs) -> Result<(), CliError> {
    if is_stream(&args.output) {
        return Err(CliError::Usage("pictures are not written to standard output; name a png file".into()));
    }
    PictureFormat::from_path(&args.output)?;
    let inputs: Vec<_> = args.files.iter().chain(&args.distance_to).cloned().collect();
    for input in inputs.iter().filter(|input| !is_stream(input)) {
        check_is_file(input)?;
        is_possible(input)?;
    }
    check_output_and_report(&inputs, Some(&args.output), args.run.report.as_deref())
}

/// What was typed, as the view crate understands it.
fn view(args: &RenderArgs) -> View {
    let projection = if args.parallel {
        Projection::Parallel
    } else {
        Projection::Perspective { field_of_view: args.field_of_view.to_radians() }
    };
    View {
        direction: args.camera.0,
        up: up_axis(args.up),
        projection,
        zoom: args.zoom,
        size: args.size,
        antialias: args.antialias,
        background: args.background.0,
    }
}

/// What the view crate refuses: options, or the files.
fn refused(error: RenderError, args: &RenderArgs) -> CliError {
    match error {
        RenderError::Size { .. }
        | RenderError::Antialias(_)
        | RenderError::Zoom(_)
        | RenderError::FieldOfView(_)
        | RenderError::CameraInTarget => CliError::Usage(error.to_string()),
        RenderError::Empty | RenderError::TooMany(_) | RenderError::Broken(_) => {
            CliError::Render { inputs: in_words(&args.files), source: error }
        }
    }
}

/// What was drawn, in a line.
fn summary(args: &RenderArgs, drawn: &Drawn, seconds: f64) -> String {
    let parts = [(drawn.triangles, "triangles"), (drawn.points, "points"), (drawn.lines, "lines")];
    let parts: Vec<String> =
        parts.iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!("{} {what}", count(*n))).collect();
    let [width, height] = args.size;
    let path: &Path = &args.output;
    format!("{}: {width} x {height} pixels, {}, in {} s", shown(path), parts.join(", "), significant(seconds, 3))
}
