//! Ground that is larger than memory, tile by tile.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::{Instant, UNIX_EPOCH};

use serde::Serialize;
use serde_json::json;
use zeroset::constraint::Constraints;
use zeroset::monitor::Monitor;
use zeroset::reconstruct::{Quality, ReconstructParams, Resolution};
use zeroset::tile::TilePlan;
use zeroset_io::{LinearUnit, MeshFormat, WriteOptions, read_cloud, shown, write_mesh};
use zeroset_tiles::{Crew, Folder, RunParams, Sorted, TileFormat, TileSeconds, TilesError, Written, run, write_tiles};

use super::failed;
use crate::args::{OrOff, ReconstructArgs, TileFormatChoice};
use crate::console::Console;

use crate::error::{CliError, in_words};
use crate::input::filter;
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

/// Does what was asked for, tile by tile.
pub(super) fn reconstruct(
    args: &ReconstructArgs,
    params: ReconstructParams,
    constraints: Constraints,
    console: Console,
) -> Result<(), CliError> {
    refuse(args)?;
    let output = args.output.clone().unwrap_or_default();
    let merged = (!is_folder(&output)).then_some(&*output);
    let place = merged.map_or_else(|| output.clone(), beside);
    let unit = unit(args)?;
    let folder = Folder::open(&place, &described(args))?;
    make(args, (params, constraints), &folder, (&output, merged), unit, console).map_err(|error| {
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
    (params, constraints): (ReconstructParams, Constraints),
    folder: &Folder,
    (output, merged): (&Path, Option<&Path>),
    unit: Option<LinearUnit>,
    console: Console,
) -> Result<(), CliError> {
    let start = Instant::now();
    let threads = rayon::current_num_threads();
    let sorted = match folder.sorted()? {
        Some(sorted) => sorted,
        None => {
            let measure = || measured(args, &params, threads);
            let side = side(args, unit, measure)?;
            with_progress(console, |progress| sort(args, &params, folder, side, progress))??
        }
    };
    let sort_seconds = start.elapsed().as_secs_f64();
    let resolution = match params.resolution {
        Resolution::Length(length) => length,
        _ => folder.make_plan(&sorted, &params)?.report.resolution,
    };
    let jobs = jobs(args, &params, &sorted, resolution, threads)?;
    let format = match args.tiles.tile_format {
        Some(TileFormatChoice::Ply) => TileFormat::Ply,
        Some(TileFormatChoice::Glb) | None => TileFormat::Glb,
    };
    let memory_limit_bytes = params.memory;
    let params = ReconstructParams { constraints, ..params };
    let run_params = RunParams { reconstruct: params, jobs, threads };
    let (plan, seconds, written) = with_progress(console, |progress| -> Result<_, CliError> {
        let (plan, mut seconds) = run(folder, &sorted, &run_params, progress)?;
        let begun = Instant::now();
        let written = match merged {
            Some(file) => {
                progress.stage(&format!("writing {}", shown(file)));
                let mesh = folder.merged(&sorted, &plan)?;
                let options = WriteOptions { resolution: Some(plan.report.resolution), ..WriteOptions::default() };
                write_mesh(file, &mesh, &options)?;
                Written::default()
            }
            None => {
                let crew = Crew { jobs, threads, monitor: progress };
                write_tiles(folder, &sorted, &plan, format, &crew)?
            }
        };
        seconds.levels = written.level_seconds;
        seconds.write = begun.elapsed().as_secs_f64() - seconds.levels;
        Ok((plan, seconds, written))
    })??;
    if merged.is_some() {
        folder.remove()?;
    } else if !args.tiles.keep_work {
        folder.remove_work()?;
    }
    let triangles = written.tiles.iter().map(|entry| entry.triangles).sum();
    let total_seconds = start.elapsed().as_secs_f64();
    console.say(&format!(
        "{}: {}{} tiles of {} from {} points (resolution {}) in {} s",
        shown(output),
        if merged.is_some() { String::new() } else { format!("{} triangles in ", count(triangles as usize)) },
        count(plan.tiles.len()),
        significant(plan.side, 4),
        count(sorted.points as usize),
        significant(plan.report.resolution, 4),
        significant(total_seconds, 3),
    ));
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
            memory_limit_bytes,
            memory_peak_bytes: memory::peak(),
        },
    )
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

/// The unit of the input, where the length of tiles has one.
fn unit(args: &ReconstructArgs) -> Result<Option<LinearUnit>, CliError> {
    if args.tiles.tile.is_none_or(|length| length.unit.is_none()) {
        return Ok(None);
    }
    let first = &args.input.inputs[0];
    let unit = read_cloud(first)?.report.unit;
    unit.ok_or_else(|| CliError::NoUnit { input: shown(first), option: "--tile" }).map(Some)
}

/// The side of tiles, in the unit of the input, which is known where it is needed.
fn side(
    args: &ReconstructArgs,
    own: Option<LinearUnit>,
    measure: impl Fn() -> Result<f64, CliError>,
) -> Result<f64, CliError> {
    let Some(length) = args.tiles.tile else { return measure() };
    let in_metres = length.unit.map_or(1.0, LinearUnit::metres) / own.map_or(1.0, LinearUnit::metres);
    Ok(length.value * in_metres)
}

/// Bytes of a tile at a time for each cell of its surface, in a draft and else; see the plan of a whole.
const BYTES_A_DRAFT_CELL: f64 = 750.0;
const BYTES_A_CELL: f64 = 6700.0;
/// Cells of surface above a square cell of ground.
const CELLS_A_SQUARE: f64 = 2.0;
/// Cells of halo, both sides together.
const HALO: f64 = 80.0;
/// The fewest cells along a tile that is chosen for the user.
const LEAST: f64 = 160.0;

/// The memory that a tile needs.
fn bytes_of(side: f64, resolution: f64, quality: Quality) -> f64 {
    let a_cell = if quality == Quality::Draft { BYTES_A_DRAFT_CELL } else { BYTES_A_CELL };
    a_cell * CELLS_A_SQUARE * (side / resolution + HALO).powi(2)
}

/// The side of tiles that memory allows for. Reads all inputs once.
fn measured(args: &ReconstructArgs, params: &ReconstructParams, threads: usize) -> Result<f64, CliError> {
    let (mut points, mut low, mut high) = (0.0, [f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for path in &args.input.inputs {
        let mut cloud = read_cloud(path)?.cloud;
        let _ = filter(&args.input).apply(&mut cloud);
        points += cloud.len() as f64;
        for i in 0..cloud.len() {
            let p = params.up.upright(cloud.world(i));
            for a in 0..2 {
                low[a] = low[a].min(p[a]);
                high[a] = high[a].max(p[a]);
            }
        }
    }
    if points == 0.0 {
        return Err(TilesError::NoPoints.into());
    }
    let spacing = ((high[0] - low[0]) * (high[1] - low[1]) / points).sqrt();
    let resolution = match params.resolution {
        Resolution::Length(length) => length,
        _ => 1.5 * spacing,
    };
    let least = bytes_of(LEAST * resolution, resolution, params.quality);
    let jobs = args.tiles.jobs.map_or(threads, usize::from).min((params.memory as f64 / least) as usize).max(1);
    let a_cell = bytes_of(1.0, 1.0, params.quality) / (1.0 + HALO).powi(2);
    let cells = (params.memory as f64 / jobs as f64 / a_cell).sqrt() - HALO;
    Ok(round_down(cells.max(LEAST) * resolution))
}

/// The largest of 1, 2, 2.5, 5 times a power of ten that is no larger.
fn round_down(length: f64) -> f64 {
    let power = 10.0_f64.powf(length.log10().floor());
    [5.0, 2.5, 2.0, 1.0].into_iter().map(|step| step * power).find(|&value| value <= length).unwrap_or(length)
}

/// How many tiles at a time.
fn jobs(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    sorted: &Sorted,
    resolution: f64,
    threads: usize,
) -> Result<usize, CliError> {
    let each = bytes_of(sorted.side, resolution, params.quality);
    let most = (params.memory as f64 / each) as usize;
    match args.tiles.jobs.map(usize::from) {
        Some(jobs) if jobs <= most.max(1) => Ok(jobs),
        Some(jobs) => Err(CliError::TilesTooLarge {
            jobs,
            side: sorted.side,
            needed_gb: each * jobs as f64 / 1e9,
            allowed_gb: params.memory as f64 / 1e9,
        }),
        None => Ok(threads.min(most).max(1)),
    }
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
    for (input, path) in args.input.inputs.iter().enumerate().filter(|(input, _)| !folder.is_sorted(*input)) {
        zeroset::monitor::check(progress).map_err(|_| CliError::Interrupted)?;
        progress.stage(&format!("sorting {}", shown(path)));
        let mut cloud = read_cloud(path)?.cloud;
        let _ = filter.apply(&mut cloud);
        folder.sort(input, &cloud, side, params.up)?;
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
