//! Points sorted into files, one for each tile that an input meets.
//!
//! Inputs are sorted one by one, in any order and anywhere, each part by part, so that none need fit into memory. What is written last tells that an
//! input is done; one that is not is begun anew.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use zeroset::cloud::{Cloud, Filter, choose_offset};
use zeroset::monitor::{Monitor, check};
use zeroset::reconstruct::Up;
use zeroset::tile::TileId;
use zeroset_io::{CloudPart, read_cloud_parts};

use crate::folder::{create, read_json, remove, remove_file, write_json};
use crate::points::{Values, read_points, segment};
use crate::{Folder, TilesError};

/// What was sorted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Sorted {
    /// Tiles that hold points, in order.
    pub tiles: Vec<SortedTile>,
    /// Points.
    pub points: u64,
    /// Their box in world coordinates.
    pub bounds: [[f64; 3]; 2],
    /// Which values they have.
    pub values: Values,
    /// Side of a tile.
    pub side: f64,
    /// Coordinate reference system of the first input that states one.
    pub crs: Option<String>,
}

/// A tile that holds points.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SortedTile {
    /// Which.
    pub id: TileId,
    /// How many points.
    pub points: u64,
    /// The inputs that they come from, in order.
    pub inputs: Vec<usize>,
}

/// What was sorted of one input.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
struct OfInput {
    side: f64,
    tiles: Vec<(TileId, u64)>,
    bounds: Option<[[f64; 3]; 2]>,
    values: Values,
    crs: Option<String>,
}

impl Sorted {
    /// The offset of local coordinates.
    #[must_use]
    pub fn offset(&self) -> [f64; 3] {
        choose_offset(self.bounds.into_iter())
    }

    fn of(&self, tile: TileId) -> Option<&SortedTile> {
        self.tiles.binary_search_by(|own| own.id.cmp(&tile)).ok().map(|i| &self.tiles[i])
    }
}

impl Folder {
    fn input(&self, input: usize) -> PathBuf {
        self.work().join("inputs").join(input.to_string())
    }

    fn input_done(&self, input: usize) -> PathBuf {
        self.input(input).with_extension("json")
    }

    /// Whether an input is sorted into tiles of a side.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn is_sorted(&self, input: usize, side: f64) -> Result<bool, TilesError> {
        let path = self.input_done(input);
        Ok(self.sorted_at().exists() || path.exists() && read_json::<OfInput>(&path)?.side == side)
    }

    /// Begins to sort an input into tiles of a side. `up` tells which axes these are cut along.
    ///
    /// # Errors
    /// If the folder of the input cannot be made.
    pub fn sort(&self, input: usize, side: f64, up: Up) -> Result<InputSort, TilesError> {
        let sort = InputSort {
            place: self.input(input),
            done_at: self.input_done(input),
            side,
            up,
            tiles: BTreeMap::new(),
            done: OfInput { side, ..OfInput::default() },
        };
        remove_file(&sort.done_at)?;
        remove(&sort.place)?;
        create(&sort.place)?;
        Ok(sort)
    }

    /// Sorts those points of a file that a filter lets through, if that is not done.
    ///
    /// # Errors
    /// If a file cannot be read or written, or the monitor asks to stop.
    pub fn sort_file(
        &self,
        input: usize,
        path: &Path,
        filter: &Filter,
        (side, up): (f64, Up),
        monitor: &dyn Monitor,
    ) -> Result<(), TilesError> {
        if self.is_sorted(input, side)? {
            return Ok(());
        }
        let mut sort = self.sort(input, side, up)?;
        read_cloud_parts(path, PART, |CloudPart { first, mut cloud }| {
            check(monitor)?;
            if first == 0 {
                sort = self.sort(input, side, up)?;
            }
            let _ = filter.apply(&mut cloud);
            sort.add(&cloud)
        })?;
        sort.finish()
    }

    /// Puts together what was sorted of all inputs.
    ///
    /// # Errors
    /// If an input is not sorted yet, there are no points, or a file cannot be read or written.
    pub fn finish_sort(&self, inputs: usize, side: f64) -> Result<Sorted, TilesError> {
        let mut tiles: BTreeMap<TileId, SortedTile> = BTreeMap::new();
        let (mut bounds, mut values, mut crs) = (None, Values::default(), None);
        for input in 0..inputs {
            let done: OfInput = read_json(&self.input_done(input))?;
            for (id, points) in done.tiles {
                let tile = tiles.entry(id).or_insert(SortedTile { id, points: 0, inputs: Vec::new() });
                tile.points += points;
                tile.inputs.push(input);
            }
            bounds = done.bounds.map(|own| with(bounds, own)).or(bounds);
            values = values.or(done.values);
            crs = crs.or(done.crs);
        }
        let tiles: Vec<SortedTile> = tiles.into_values().collect();
        let points = tiles.iter().map(|tile| tile.points).sum();
        let bounds = bounds.ok_or(TilesError::NoPoints)?;
        let sorted = Sorted { tiles, points, bounds, values, side, crs };
        write_json(&self.sorted_at(), &sorted)?;
        Ok(sorted)
    }

    /// The points of a tile, thinned; none where there are none.
    pub(crate) fn load(&self, sorted: &Sorted, tile: TileId, thinning: u32) -> Result<Cloud, TilesError> {
        let mut cloud = Cloud { world_from_local: sorted.offset(), ..Cloud::default() };
        if thinning > 0 {
            return read_points(&self.thinned(tile, thinning), cloud, Values::default());
        }
        for &input in sorted.of(tile).into_iter().flat_map(|own| &own.inputs) {
            cloud = read_points(&of_tile(&self.input(input), tile), cloud, sorted.values)?;
        }
        Ok(cloud)
    }

    /// Writes thinned points of a tile.
    pub(crate) fn write_thinned(&self, cloud: &Cloud, tile: TileId, thinning: u32) -> Result<(), TilesError> {
        create(&self.work().join("thinned"))?;
        let all: Vec<u32> = (0..cloud.len() as u32).collect();
        segment(cloud, &all).write(&self.thinned(tile, thinning))
    }
}

/// An input that is being sorted. Until it is finished it counts for nothing.
#[derive(Debug)]
pub struct InputSort {
    place: PathBuf,
    done_at: PathBuf,
    side: f64,
    up: Up,
    tiles: BTreeMap<TileId, u64>,
    done: OfInput,
}

/// Points that are sorted at a time.
const PART: usize = 1 << 21;

impl InputSort {
    /// Adds points to what was sorted before.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn add(&mut self, cloud: &Cloud) -> Result<(), TilesError> {
        let (side, up) = (self.side, self.up);
        let offset = up.upright(cloud.world_from_local);
        let mut order: Vec<(TileId, u32)> = cloud
            .points
            .par_iter()
            .enumerate()
            .map(|(i, &p)| (TileId::of(up.upright(p), offset, side), i as u32))
            .collect();
        order.par_sort_unstable();
        let tiles: Vec<&[(TileId, u32)]> = order.chunk_by(|a, b| a.0 == b.0).collect();
        tiles.par_iter().try_for_each(|own| {
            let which: Vec<u32> = own.iter().map(|(_, i)| *i).collect();
            segment(cloud, &which).append(&of_tile(&self.place, own[0].0))
        })?;
        for own in tiles {
            *self.tiles.entry(own[0].0).or_default() += own.len() as u64;
        }
        self.done.bounds = cloud.bounds().map(|own| with(self.done.bounds, own)).or(self.done.bounds);
        self.done.values = self.done.values.or(Values::of(&cloud.attributes));
        self.done.crs = self.done.crs.take().or_else(|| cloud.crs.clone());
        Ok(())
    }

    /// All points of the input are there.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn finish(self) -> Result<(), TilesError> {
        write_json(&self.done_at, &OfInput { tiles: self.tiles.into_iter().collect(), ..self.done })
    }
}

fn of_tile(input: &Path, tile: TileId) -> PathBuf {
    input.join(tile.to_string())
}

/// A box, grown to hold another.
fn with(bounds: Option<[[f64; 3]; 2]>, [low, high]: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let [old_low, old_high] = bounds.unwrap_or([low, high]);
    [std::array::from_fn(|a| low[a].min(old_low[a])), std::array::from_fn(|a| high[a].max(old_high[a]))]
}
