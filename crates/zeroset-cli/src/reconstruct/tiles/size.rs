//! How wide tiles are and how many are worked on at a time, so that memory is enough.

use std::path::PathBuf;

use zeroset::fit::cascade::Scene;
use zeroset::reconstruct::{PlanReport, ReconstructParams, Resolution};
use zeroset::tile::{TileMemory, TilePlan};
use zeroset_io::{CloudFormat, CloudSize, IoError, cloud_size, shown};
use zeroset_tiles::Sorted;

use crate::args::ReconstructArgs;
use crate::error::CliError;

/// Bytes of a point that is read with all others, before anything is done with it.
const BYTES_A_POINT: f64 = 56.0;
/// The fewest cells along a tile that is chosen for the user: somewhat more than are needed, as the cells of an estimate may be too small.
const LEAST: f64 = 160.0;
/// Cells in units of the spacing of the points, where the user says nothing.
const SPACINGS: f64 = 1.5;

/// Whether the points alone take more memory than there is. Only files that tell without being read are looked at.
pub(super) fn points_exceed(args: &ReconstructArgs, memory: u64) -> bool {
    let tells = |path: &&PathBuf| matches!(CloudFormat::from_path(path), Ok(CloudFormat::Las | CloudFormat::Laz));
    // What cannot be read is told about when it is.
    let points = |path| cloud_size(path).map_or(0, |size| size.points);
    let points: u64 = args.input.inputs.iter().filter(tells).map(|path| points(path)).sum();
    BYTES_A_POINT * points as f64 > memory as f64
}

/// Whether cells of ground had to be larger than the points bear, and tiles of such as they bear fit into memory.
pub(super) fn are_enough(plan: &PlanReport, params: &ReconstructParams) -> bool {
    let [low, high] = plan.bounds.map(|corner| params.up.upright(corner));
    let ground = (high[0] - low[0]).abs() * (high[1] - low[1]).abs();
    let fits = |resolution| {
        let memory = TileMemory { quality: params.quality, resolution, density: plan.points as f64 / ground };
        memory.widest(params.memory as f64).is_some()
    };
    matches!(plan.scene, Scene::Terrain | Scene::Airborne) && plan.wanted_resolution.is_some_and(fits)
}

/// The side that the user asks for, in the unit of the input.
pub(super) fn asked_for(args: &ReconstructArgs) -> Result<Option<f64>, CliError> {
    let Some(length) = args.tiles.tile else { return Ok(None) };
    let Some(unit) = length.unit else { return Ok(Some(length.value)) };
    let first = &args.input.inputs[0];
    let own = cloud_size(first)?.unit.ok_or_else(|| CliError::NoUnit { input: shown(first), option: "--tile" })?;
    Ok(Some(length.value * unit.metres() / own.metres()))
}

/// A side from what the files tell of themselves. Where they lie in patches it is too wide.
pub(super) fn estimated(args: &ReconstructArgs, params: &ReconstructParams, threads: usize) -> Result<f64, CliError> {
    let sizes: Vec<CloudSize> =
        args.input.inputs.iter().map(|path| cloud_size(path)).collect::<Result<_, IoError>>()?;
    let area = |[low, high]: [[f64; 3]; 2]| {
        let [low, high] = [low, high].map(|corner| params.up.upright(corner));
        (high[0] - low[0]).abs() * (high[1] - low[1]).abs()
    };
    let points: f64 = sizes.iter().map(|size| size.points as f64).sum();
    let ground: f64 = sizes.iter().map(|size| area(size.bounds)).sum();
    let density = points / ground;
    let resolution = match params.resolution {
        Resolution::Length(length) => length,
        _ => SPACINGS / density.sqrt(),
    };
    if !(density.is_finite() && density > 0.0) {
        // Points on a line or none: whatever comes next tells.
        return Ok(1.0);
    }
    widest(args, params, TileMemory { quality: params.quality, resolution, density }, threads)
}

/// What the tiles of a plan take.
pub(super) fn memory(sorted: &Sorted, plan: &TilePlan, params: &ReconstructParams) -> TileMemory {
    let most = sorted.tiles.iter().map(|tile| tile.points).max().unwrap_or(0) as f64;
    let density = most / plan.side.powi(2);
    TileMemory { quality: params.quality, resolution: plan.report.resolution, density }
}

/// The widest tiles for which memory is enough, as many at a time as asked for or as there are threads, or else fewer.
pub(super) fn widest(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    memory: TileMemory,
    threads: usize,
) -> Result<f64, CliError> {
    let allowed = params.memory as f64;
    let wanted = args.tiles.jobs.map_or(threads, usize::from);
    let fewest = if args.tiles.jobs.is_some() { wanted } else { 1 };
    let least = LEAST * memory.resolution;
    let widest = |jobs: usize| memory.widest(allowed / jobs as f64).filter(|side| *side >= least);
    let side = (fewest..=wanted).rev().find_map(widest);
    let round = |side| Some(round_down(side)).filter(|round| *round >= least).unwrap_or(side);
    side.map(round).ok_or_else(|| too_large(fewest, least, memory, allowed))
}

/// How many tiles at a time.
pub(super) fn jobs(
    args: &ReconstructArgs,
    params: &ReconstructParams,
    (side, memory): (f64, TileMemory),
    threads: usize,
) -> Result<usize, CliError> {
    let allowed = params.memory as f64;
    let most = (allowed / memory.bytes(side)) as usize;
    let jobs = args.tiles.jobs.map_or(threads.min(most).max(1), usize::from);
    if jobs > most { Err(too_large(jobs, side, memory, allowed)) } else { Ok(jobs) }
}

fn too_large(jobs: usize, side: f64, memory: TileMemory, allowed: f64) -> CliError {
    CliError::TilesTooLarge { jobs, side, needed_gb: jobs as f64 * memory.bytes(side) / 1e9, allowed_gb: allowed / 1e9 }
}

/// The largest of 1, 2, 2.5, 5 times a power of ten that is no larger.
fn round_down(length: f64) -> f64 {
    let power = 10.0_f64.powf(length.log10().floor());
    [5.0, 2.5, 2.0, 1.0].into_iter().map(|step| step * power).find(|&value| value <= length).unwrap_or(length)
}
