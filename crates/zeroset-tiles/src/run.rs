//! All steps on this machine, several tiles at a time.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use rayon::ThreadPoolBuilder;
use serde::{Deserialize, Serialize};
use zeroset::monitor::{Monitor, check};
use zeroset::reconstruct::ReconstructParams;
use zeroset::tile::TilePlan;

use crate::{Folder, LevelEntry, Sorted, TileEntry, TileFormat, TilesError};

/// How tiles are made.
#[derive(Debug, Clone)]
pub struct RunParams {
    /// What is reconstructed, and how.
    pub reconstruct: ReconstructParams,
    /// Tiles at a time.
    pub jobs: usize,
    /// Threads in all.
    pub threads: usize,
}

/// Wall seconds of each kind of step, this time.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct TileSeconds {
    /// Thinning.
    pub thin: f64,
    /// The coarse levels.
    pub coarse: f64,
    /// Fits of tiles.
    pub fit: f64,
    /// Their surfaces.
    pub mesh: f64,
    /// Their simplification.
    pub simplify: f64,
    /// Writing of what was asked for.
    pub write: f64,
    /// Levels of detail.
    pub levels: f64,
}

/// What [`write_tiles`] wrote.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Written {
    /// The tiles with a surface, in order.
    pub tiles: Vec<TileEntry>,
    /// The squares of tiles with one, level by level.
    pub levels: Vec<LevelEntry>,
}

/// The share of the whole that is done after each kind of step: thinning, the coarse levels, fits, surfaces, simplification, writing, levels of detail.
const SHARES: [f64; 7] = [0.03, 0.08, 0.55, 0.85, 0.94, 0.97, 1.0];

/// Makes all that is missing of the surfaces of all tiles, once the points are sorted and planned.
///
/// # Errors
/// If a step fails or the monitor asks to stop. What was made stays, and the next run goes on from there.
pub fn run(
    folder: &Folder,
    sorted: &Sorted,
    plan: &TilePlan,
    params: &RunParams,
    monitor: &dyn Monitor,
) -> Result<TileSeconds, TilesError> {
    let mut seconds = TileSeconds::default();
    let start = Instant::now();
    let constraints = &params.reconstruct.constraints;
    let crew = Crew { jobs: params.jobs, threads: params.threads, monitor };
    crew.each(&plan.tiles, "thinning the points of tile", 0.0..SHARES[0], |tile, _| folder.thin(sorted, plan, tile))?;
    seconds.thin = start.elapsed().as_secs_f64();
    let start = Instant::now();
    monitor.share(SHARES[0]);
    folder.fit_coarse(sorted, plan, constraints, &Quiet(monitor))?;
    let coarse = folder.read_coarse()?;
    seconds.coarse = start.elapsed().as_secs_f64();
    let start = Instant::now();
    crew.each(&plan.tiles, "fitting tile", SHARES[1]..SHARES[2], |tile, monitor| {
        folder.fit_tile(sorted, plan, tile, (&coarse, constraints), monitor)
    })?;
    drop(coarse);
    seconds.fit = start.elapsed().as_secs_f64();
    let start = Instant::now();
    crew.each(&plan.tiles, "extracting tile", SHARES[2]..SHARES[3], |tile, monitor| {
        folder.mesh_tile(sorted, plan, tile, monitor)
    })?;
    seconds.mesh = start.elapsed().as_secs_f64();
    if plan.report.simplify.is_some() {
        let start = Instant::now();
        crew.each(&plan.tiles, "simplifying tile", SHARES[3]..SHARES[4], |tile, monitor| {
            folder.simplify_tile(plan, tile, monitor)
        })?;
        seconds.simplify = start.elapsed().as_secs_f64();
    }
    Ok(seconds)
}

/// Writes the tiles that are extracted, makes their levels of detail if they are GLB, and writes the lists of them. Adds to the seconds what that takes.
///
/// # Errors
/// If a file cannot be read or written, or the monitor asks to stop.
pub fn write_tiles(
    folder: &Folder,
    sorted: &Sorted,
    plan: &TilePlan,
    format: TileFormat,
    crew: &Crew<'_>,
    seconds: &mut TileSeconds,
) -> Result<Written, TilesError> {
    let start = Instant::now();
    let entries: Mutex<Vec<TileEntry>> = Mutex::default();
    crew.each(&plan.tiles, "writing tile", SHARES[4]..SHARES[5], |tile, _| {
        if let Some(entry) = folder.write_tile(sorted, plan, tile, format)? {
            entries.lock().unwrap_or_else(PoisonError::into_inner).push(entry);
        }
        Ok(())
    })?;
    seconds.write = start.elapsed().as_secs_f64();
    let start = Instant::now();
    let levels = if format == TileFormat::Glb { plan.levels() } else { Vec::new() };
    for (i, nodes) in levels.iter().enumerate() {
        // Each level takes about a quarter of the one before.
        let left = |i: usize| SHARES[6] - (SHARES[6] - SHARES[5]) * 0.25_f64.powi(i as i32);
        crew.each(nodes, &format!("level of detail {}: square", i + 1), left(i)..left(i + 1), |node, _| {
            folder.make_level(sorted, plan, &node).map(drop)
        })?;
    }
    let entries = entries.into_inner().unwrap_or_else(PoisonError::into_inner);
    let written = folder.write_lists(sorted, plan, entries, format)?;
    seconds.levels = start.elapsed().as_secs_f64();
    Ok(written)
}

/// Those who work on tiles.
pub struct Crew<'a> {
    /// Tiles at a time.
    pub jobs: usize,
    /// Threads in all.
    pub threads: usize,
    /// Who watches.
    pub monitor: &'a dyn Monitor,
}

impl Crew<'_> {
    /// Does something for each tile, or whatever else. After the first error nothing new is begun.
    fn each<T: Clone + Sync>(
        &self,
        tiles: &[T],
        what: &str,
        shares: std::ops::Range<f64>,
        work: impl Fn(T, &dyn Monitor) -> Result<(), TilesError> + Sync,
    ) -> Result<(), TilesError> {
        let (next, done) = (AtomicUsize::new(0), Mutex::new(0_usize));
        let failed: Mutex<Option<TilesError>> = Mutex::new(None);
        let jobs = self.jobs.clamp(1, tiles.len().max(1));
        let threads = (self.threads / jobs).max(1);
        let quiet = Quiet(self.monitor);
        let one = |tile: T| -> Result<(), TilesError> {
            check(self.monitor)?;
            work(tile, &quiet)?;
            let mut done = done.lock().unwrap_or_else(PoisonError::into_inner);
            *done += 1;
            self.monitor.stage(&format!("{what} {} of {}", *done, tiles.len()));
            self.monitor.share(shares.start + (shares.end - shares.start) * *done as f64 / tiles.len() as f64);
            Ok(())
        };
        let worker = || {
            while failed.lock().unwrap_or_else(PoisonError::into_inner).is_none() {
                let Some(tile) = tiles.get(next.fetch_add(1, Ordering::Relaxed)).cloned() else { break };
                if let Err(error) = one(tile) {
                    failed.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..jobs {
                scope.spawn(|| match ThreadPoolBuilder::new().num_threads(threads).build() {
                    Ok(pool) => pool.install(worker),
                    // The pool of the process will do.
                    Err(_) => worker(),
                });
            }
        });
        failed.into_inner().unwrap_or_else(PoisonError::into_inner).map_or(Ok(()), Err)
    }
}

/// Passes on the wish to stop, and nothing of the progress: that is told tile by tile.
struct Quiet<'a>(&'a dyn Monitor);

impl Monitor for Quiet<'_> {
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
