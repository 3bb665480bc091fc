//! Points sorted into files, one for each tile that an input meets.
//!
//! Inputs are sorted one by one, in any order and anywhere. What is written last tells that an input is done; one that is not is begun anew.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use zeroset::cloud::{Cloud, choose_offset};
use zeroset::reconstruct::Up;
use zeroset::tile::TileId;

use crate::binary::Out;
use crate::folder::{create, read_json, remove, write_json};
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

    /// Whether an input is sorted.
    #[must_use]
    pub fn is_sorted(&self, input: usize) -> bool {
        self.sorted_at().exists() || self.input_done(input).exists()
    }

    /// Sorts the points of an input into tiles of a side. `up` tells which axes these are cut along.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn sort(&self, input: usize, cloud: &Cloud, side: f64, up: Up) -> Result<(), TilesError> {
        let place = self.input(input);
        remove(&place)?;
        create(&place)?;
        let offset = up.upright(cloud.world_from_local);
        let mut order: Vec<(TileId, u32)> = cloud
            .points
            .par_iter()
            .enumerate()
            .map(|(i, &p)| (TileId::of(up.upright(p), offset, side), i as u32))
            .collect();
        order.par_sort_unstable();
        let mut done = OfInput {
            bounds: (0..cloud.len()).map(|i| cloud.world(i)).fold(None, |bounds, p| Some(with(bounds, [p; 2]))),
            values: Values::of(&cloud.attributes),
            crs: cloud.crs.clone(),
            tiles: Vec::new(),
        };
        for own in order.chunk_by(|a, b| a.0 == b.0) {
            let which: Vec<u32> = own.iter().map(|(_, i)| *i).collect();
            segment(cloud, &which).write(&of_tile(&place, own[0].0))?;
            done.tiles.push((own[0].0, which.len() as u64));
        }
        write_json(&self.input_done(input), &done)
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
        let out: Out = segment(cloud, &all);
        out.write(&self.thinned(tile, thinning))
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
