//! Ground that is larger than memory, tile by tile.

mod size;

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Instant, UNIX_EPOCH};

use serde::Serialize;
use serde_json::json;
use zeroset::monitor::Monitor;
use zeroset::reconstruct::{Plan, ReconstructError, ReconstructParams};
use zeroset::tile::TilePlan;
use zeroset_io::{MeshFormat, WriteOptions, shown, write_mesh};
use zeroset_tiles::{Crew, Folder, RunParams, Sorted, TileFormat, TileSeconds, TilesError, Written, run, write_tiles};

use super::failed;
use crate::args::{OrOff, ReconstructArgs, TileFormatChoice};
use crate::console::Console;

use crate::error::{CliError, in_words};
use crate::input::{filter, is_stream};
use crate::memory;
use crate::progress::with_progress;
use crate::report::write_report;
use crate::table::{count, significant};

/// Whether tiles are asked for.
pub(super) fn are_asked_for(args: &ReconstructArgs) -> bool {
    args.tiles.tile.is_some() || args.output.as_deref().is_some_and(is_folder)
}

/// Whether an output is a folder: it ends like one, or is one and does not have the name of a mesh.
pub(super) fn is_folder(output: &Path) -> bool {
    let ends_like_one = output.as_os_str().as_encoded_bytes().last().is_some_and(|c| matches!(c, b'/' | b'\\'));
    ends_like_one || output.is_dir() && MeshFormat::from_path(output).is_err()
}

/// What a folder is of: another run into it must say the same.
fn described(args: &ReconstructArgs) -> serde_json::Value {
    let facts = |path: &PathBuf| {
        let facts = std::fs::metadata(path).ok();
        let changed = facts.as_ref().and_then(|facts| facts.modified().ok()?.duration_since(UNIX_EPOCH).ok());
        json!({
            "path": shown(path),
            "bytes": facts.as_ref().map(std::fs::Metadata::len),
            "changed": changed.map(|t| t.as_nanos().to_string()),
        })
    };
    let files = |paths: &[PathBuf]| paths.iter().map(facts).collect::<Vec<_>>();
    json!({
        "zeroset_version": env!("CARGO_PKG_VERSION"),
        "inputs": files(&args.input.inputs),
        "constraints": files(&args.fit.constraints),
        "options": format!("{:?}", (&args.input, &args.fit, args.attributes, args.tiles.tile, args.simplify.max_error)),
        "format": format(args).suffix(),
    })
}

#[derive(Serialize)]
struct TilesReport<'a> {
    plan: &'a TilePlan,
    points: u64,
    #[serde(flatten)]
    written: &'a Written,
    triangles: u64,
    jobs: usize,
    seconds: TileSeconds,
    sort_seconds: f64,
    total_seconds: f64,
    memory_limit_bytes: u64,
    memory_peak_bytes: Option<u64>,
}

/// Whether tiles can do what was asked for, where the whole does not fit into memory.
pub(super) fn are_possible(args: &ReconstructArgs) -> bool {
    args.output.is_some() && refuse(args).is_ok() && !matches!(args.fit.trim, Some(OrOff::Off))
}

/// Whether a plan of the whole asks for more memory than there is, and tiles do not.
pub(super) fn are_called_for(
    args: &ReconstructArgs,
    plan: &Result<Plan<'_>, CliError>,
    params: &ReconstructParams,
) -> bool {
    are_possible(args)
        && match plan {
            Ok(plan) => size::are_enough(&plan.report, params),
            Err(error) => matches!(error, CliError::Reconstruct { source: ReconstructError::Memory { .. }, .. }),
        }
}

/// Whether the points alone take more memory than there is, so that only tiles are left.
pub(super) fn are_needed(args: &ReconstructArgs, params: &ReconstructParams) -> bool {
    are_possible(args) && size::points_exceed(args, params.memory)
}

/// Whether tiles were not possible, after all.
pub(super) fn are_none(error: &CliError) -> bool {
    match error {
        CliError::TilesTooLarge { .. } => true,
        CliError::Reconstruct { source, .. } => {
            matches!(source, ReconstructError::TilesOfBody | ReconstructError::NarrowTiles { .. })
        }
        _ => false,
    }
}

/// Does what was asked for, tile by tile.
pub(super) fn reconstruct(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    console: Console,
) -> Result<(), CliError> {
    refuse(args)?;
    let side = size::asked_for(args)?;
    let output = args.output.as_deref().unwrap_or(Path::new(""));
    let place = if is_folder(output) { output.to_path_buf() } else { beside(output) };
    let folder = Folder::open(&place, &described(args))?;
    make(args, params, &folder, (output, side), console).map_err(|error| {
        // Nothing that is worth going on from: the next run may ask for something else.
        if folder.plan().is_ok_and(|plan| plan.is_none()) {
            folder.abandon();
        }
        match error {
            CliError::Tiles(TilesError::Reconstruct(source)) => failed(&args.input, source),
            CliError::Tiles(TilesError::NoPoints) => {
                CliError::NoPointsForTiles { inputs: in_words(&args.input.inputs) }
            }
            other => other,
        }
    })
}

fn make(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    folder: &Folder,
    (output, side): (&Path, Option<f64>),
    console: Console,
) -> Result<(), CliError> {
    let start = Instant::now();
    let threads = rayon::current_num_threads();
    let finished = folder.finished()?;
    let (sorted, plan) = match (folder.sorted()?, folder.plan()?) {
        (Some(sorted), Some(plan)) => (sorted, plan),
        _ => with_progress(console, |progress| planned(args, params, (folder, side), threads, progress))??,
    };
    let sort_seconds = start.elapsed().as_secs_f64();
    let jobs = match finished {
        Some(_) => 1,
        None => size::jobs(args, params, (plan.side, size::memory(&sorted, &plan, params)), threads)?,
    };
    let was_finished = finished.is_some();
    let (seconds, written) = match finished {
        Some(written) => (TileSeconds::default(), written),
        None => with_progress(console, |progress| {
            let run_params = RunParams { reconstruct: params.clone(), jobs, threads };
            surfaces(args, folder, (&sorted, &plan), &run_params, output, progress)
        })??,
    };
    let is_merged = !is_folder(output);
    if is_merged {
        folder.remove()?;
    } else if !args.tiles.keep_work {
        folder.remove_work()?;
    }
    if !is_merged && format(args) == TileFormat::Glb {
        console.say(&match Folder::off_the_globe(&sorted, &plan) {
            None => "tileset.json stands on the globe; heights are taken as above the ellipsoid".to_owned(),
            Some(why) => format!("note: tileset.json stands in coordinates of its own: {why}"),
        });
    }
    let triangles = written.tiles.iter().map(|entry| entry.triangles).sum();
    let total_seconds = start.elapsed().as_secs_f64();
    let what = format!(
        "{}{} tiles of {} from {} points (resolution {})",
        if is_merged { String::new() } else { format!("{} triangles in ", count(triangles as usize)) },
        count(plan.tiles.len()),
        significant(plan.side, 4),
        count(sorted.points as usize),
        significant(plan.report.resolution, 4),
    );
    let output = shown(output);
    if !are_asked_for(args) {
        console.say("note: the whole takes more memory than there is, so it was made in tiles");
    }
    console.say(&if was_finished {
        format!("{output}: {what} are there already; remove the folder to make them anew")
    } else {
        format!("{output}: {what} in {} s", significant(total_seconds, 3))
    });
    write_report(
        args.run.report.as_deref(),
        TilesReport {
            plan: &plan,
            points: sorted.points,
            written: &written,
            triangles,
            jobs,
            seconds,
            sort_seconds,
            total_seconds,
            memory_limit_bytes: params.memory,
            memory_peak_bytes: memory::peak(),
        },
    )
}

/// Sorts the points and decides about everything. Tiles that turn out too wide or too narrow, where the user left their side open, are made anew once.
fn planned(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    (folder, side): (&Folder, Option<f64>),
    threads: usize,
    progress: &dyn Monitor,
) -> Result<(Sorted, TilePlan), CliError> {
    let once = |side: f64| -> Result<(Sorted, TilePlan), CliError> {
        let sorted = match folder.sorted()? {
            Some(sorted) => sorted,
            None => sort(args, params, folder, side, progress)?,
        };
        progress.stage("measuring the points");
        let plan = folder.make_plan(&sorted, params)?;
        Ok((sorted, plan))
    };
    let first = match side {
        Some(side) => side,
        None => size::estimated(args, params, threads)?,
    };
    let (sorted, plan) = match once(first) {
        Err(CliError::Tiles(TilesError::Reconstruct(ReconstructError::NarrowTiles { least, .. })))
            if side.is_none() =>
        {
            folder.forget_points()?;
            return once(1.25 * least);
        }
        made => made?,
    };
    if side.is_some() {
        return Ok((sorted, plan));
    }
    let widest = size::widest(args, params, size::memory(&sorted, &plan, params), threads)?;
    if plan.side <= widest {
        return Ok((sorted, plan));
    }
    folder.forget_points()?;
    once(widest)
}

/// Makes the surfaces of all tiles, and writes them.
fn surfaces(
    args: &ReconstructArgs,
    folder: &Folder,
    (sorted, plan): (&Sorted, &TilePlan),
    params: &RunParams,
    output: &Path,
    progress: &dyn Monitor,
) -> Result<(TileSeconds, Written), CliError> {
    let mut seconds = run(folder, sorted, plan, params, progress)?;
    if is_folder(output) {
        let crew = Crew { jobs: params.jobs, threads: params.threads, monitor: progress };
        let written = write_tiles(folder, sorted, plan, format(args), &crew, &mut seconds)?;
        return Ok((seconds, written));
    }
    let begun = Instant::now();
    progress.stage(&format!("writing {}", shown(output)));
    let mesh = folder.merged(sorted, plan)?;
    let options = WriteOptions { resolution: Some(plan.report.resolution), ..WriteOptions::default() };
    write_mesh(output, &mesh, &options)?;
    seconds.write = begun.elapsed().as_secs_f64();
    Ok((seconds, Written::default()))
}

fn format(args: &ReconstructArgs) -> TileFormat {
    match args.tiles.tile_format {
        Some(TileFormatChoice::Ply) => TileFormat::Ply,
        Some(TileFormatChoice::Zset) => TileFormat::Zset,
        Some(TileFormatChoice::Glb) | None => TileFormat::Glb,
    }
}

/// Options that need the whole.
fn refuse(args: &ReconstructArgs) -> Result<(), CliError> {
    let refused = |option, remedy| Err(CliError::NotWithTiles { option, remedy });
    if matches!(args.input.outliers, OrOff::Value(_)) {
        return refused("--outliers", "leave it out, or use --exclude");
    }
    if args.simplify.triangles.is_some() {
        return refused("--triangles", "give --max-error, or use zeroset simplify on one mesh of all tiles");
    }
    if args.input.inputs.iter().any(|path| is_stream(path)) {
        return refused("standard input", "give files");
    }
    if args.dry_run {
        return refused("--dry-run", "leave out --tile to see the plan of the whole");
    }
    Ok(())
}

/// The folder in which a merged mesh is made.
fn beside(file: &Path) -> PathBuf {
    let mut name: OsString = file.as_os_str().to_owned();
    name.push(".tiles");
    PathBuf::from(name)
}

/// Sorts the inputs that are not sorted yet into tiles.
fn sort(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    folder: &Folder,
    side: f64,
    progress: &dyn Monitor,
) -> Result<Sorted, CliError> {
    let filter = filter(&args.input);
    for (input, path) in args.input.inputs.iter().enumerate() {
        progress.stage(&format!("sorting {}", shown(path)));
        folder.sort_file(input, path, &filter, (side, params.up), progress)?;
    }
    Ok(folder.finish_sort(args.input.inputs.len(), side)?)
}

/// Whether a mesh of all tiles can be written.
pub(super) fn check_format(output: &Path) -> Result<(), CliError> {
    if !is_folder(output) {
        MeshFormat::from_path(output)?;
    }
    Ok(())
}
