//! One level of the cascade: which nodes exist, which may move, and what the data say about them.

use rayon::prelude::*;

use super::prior::{Columns, Prior};
use super::prolong::Solved;
use super::samples::Samples;
use super::stencil::Stencil;
use crate::domain::{Blocks, Cells, Lattice, LatticePoints, Mask, NONE};
use crate::fit::Gradient;

/// Which faces of the box hold F fixed.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FixedFaces {
    /// All six: outside.
    All,
    /// The top (outside) and the bottom (inside).
    TopBottom,
    /// None.
    None,
}

impl FixedFaces {
    /// The nodes of block `b` on fixed faces.
    pub(super) fn mask(self, blocks: &Blocks, b: usize) -> Mask {
        let axes = match self {
            Self::All => 0..3,
            Self::TopBottom => 2..3,
            Self::None => 0..0,
        };
        let mut mask = [0_u64; 8];
        for axis in axes {
            for far in [false, true] {
                if blocks.at_domain_face(b, axis, far) {
                    for (z, word) in mask.iter_mut().enumerate() {
                        *word |= match (axis, far) {
                            (0, false) => 0x0101_0101_0101_0101,
                            (0, true) => 0x8080_8080_8080_8080,
                            (1, false) => 0xff,
                            (1, true) => 0xff << 56,
                            (_, _) => {
                                if z == if far { 7 } else { 0 } {
                                    u64::MAX
                                } else {
                                    0
                                }
                            }
                        };
                    }
                }
            }
        }
        mask
    }
}

/// A level, ready to be solved on.
pub(super) struct Level {
    pub(super) index: u32,
    pub(super) blocks: Blocks,
    /// Nodes that have a value.
    pub(super) known: Vec<Mask>,
    /// Nodes whose value is sought; a subset of the known ones whose neighbours are all known.
    pub(super) free: Vec<Mask>,
    pub(super) cells: Cells,
    /// Place of each block in `cells`, or [`NONE`].
    pub(super) data_block: Vec<u32>,
    pub(super) samples: Samples,
    pub(super) stencil: Stencil,
    pub(super) prior: Option<Prior>,
    /// The element's gradient, until set otherwise.
    pub(super) gradient: Gradient,
}

/// What stays the same from level to level.
#[derive(Debug, Clone, Copy)]
pub(super) struct LevelParams {
    pub(super) alpha: f32,
    pub(super) faces: FixedFaces,
    pub(super) column_prior: bool,
}

impl Level {
    pub(super) fn new(
        lattice: &Lattice,
        points: &LatticePoints,
        index: u32,
        nodes: Nodes,
        params: &LevelParams,
    ) -> Self {
        let Nodes { blocks, known, free, cells, columns } = nodes;
        let shift = lattice.shift_at(index);
        let data_block = data_blocks(&blocks, &cells);
        let weights = point_weights(&blocks, &data_block, &cells);
        let samples = Samples::new(points, &cells, &weights, shift);
        let stencil = Stencil::new(&blocks, &data_block, points, &cells, &weights, shift, params.alpha);
        let prior = columns.map(|columns| Prior::new(&columns, &blocks, &free));
        Self { index, blocks, known, free, cells, data_block, samples, stencil, prior, gradient: Gradient::Element }
    }

    /// Keeps F and lets go of the rest.
    pub(super) fn into_solved(self, f: Vec<f32>) -> Solved {
        Solved { index: self.index, blocks: self.blocks, known: self.known, f }
    }

    /// Number of stored values.
    pub(super) fn len(&self) -> usize {
        self.blocks.len() * 512
    }

    pub(super) fn free_nodes(&self) -> u64 {
        self.free.iter().flatten().map(|w| u64::from(w.count_ones())).sum()
    }

    /// Bytes held by this level, without the vectors of the solver.
    pub(super) fn bytes(&self) -> usize {
        let blocks = self.blocks.len() * (27 * 4 + 8 + 12 + 24 + 2 * 64 + if self.prior.is_some() { 128 } else { 0 });
        blocks + self.stencil.bytes() + self.samples.bytes() + self.cells.len() * 6
    }
}

/// The nodes of a level before anything is summed on them.
pub(super) struct Nodes {
    pub(super) blocks: Blocks,
    pub(super) known: Vec<Mask>,
    pub(super) free: Vec<Mask>,
    pub(super) cells: Cells,
    /// The columns of the prior, where there is one.
    pub(super) columns: Option<Columns>,
}

impl Nodes {
    /// Every node of a level; all are free but those on fixed faces.
    pub(super) fn dense(lattice: &Lattice, cells: Cells, index: u32, params: &LevelParams) -> Self {
        let blocks = Blocks::dense(lattice.blocks_at(index));
        let known = vec![[u64::MAX; 8]; blocks.len()];
        let free = (0..blocks.len()).map(|b| params.faces.mask(&blocks, b).map(|w| !w)).collect();
        let columns = params.column_prior.then(|| Columns::new(&cells));
        Self { blocks, known, free, cells, columns }
    }
}

/// Place of each block in the cells' list of blocks, or [`NONE`].
pub(super) fn data_blocks(blocks: &Blocks, cells: &Cells) -> Vec<u32> {
    blocks.keys.par_iter().map(|key| cells.block_keys.binary_search(key).map_or(NONE, |i| i as u32)).collect()
}

/// The weight of each point of a cell: one over the mean number of points in the occupied cells among it and its 26
/// neighbours.
///
/// So an occupied cell weighs about the same whatever the density of the scan, but a cell that the surface only clips, and that
/// holds few points for this reason, weighs less than a whole one: the weights measure area.
fn point_weights(blocks: &Blocks, data_block: &[u32], cells: &Cells) -> Vec<f32> {
    let parts: Vec<Vec<f32>> = cells
        .block_keys
        .par_iter()
        .with_min_len(16)
        .map_init(
            || [0_u32; 1000],
            |counts, key| {
                let b = blocks.keys.binary_search(key).expect("a block of data is stored");
                counts.fill(0);
                let at = |c: [i32; 3]| ((c[0] + 1) + 10 * (c[1] + 1) + 100 * (c[2] + 1)) as usize;
                for (code, &other) in blocks.neighbors[b].iter().enumerate() {
                    if other == NONE || data_block[other as usize] == NONE {
                        continue;
                    }
                    let step = [code % 3, code / 3 % 3, code / 9].map(|s| 8 * (s as i32 - 1));
                    for cell in cells.of_block(data_block[other as usize] as usize) {
                        let local = cells.local[cell];
                        let place: [i32; 3] = std::array::from_fn(|a| i32::from(local >> (3 * a) & 7) + step[a]);
                        if place.iter().all(|c| (-1..=8).contains(c)) {
                            counts[at(place)] = cells.points(cell).len() as u32;
                        }
                    }
                }
                let own = data_block[b] as usize;
                cells
                    .of_block(own)
                    .map(|cell| {
                        let local = cells.local[cell];
                        let place: [i32; 3] = std::array::from_fn(|a| i32::from(local >> (3 * a) & 7));
                        let (mut sum, mut occupied) = (0, 0);
                        for dz in -1..=1 {
                            for dy in -1..=1 {
                                for dx in -1..=1 {
                                    let count = counts[at([place[0] + dx, place[1] + dy, place[2] + dz])];
                                    sum += count;
                                    occupied += u32::from(count > 0);
                                }
                            }
                        }
                        occupied as f32 / sum as f32
                    })
                    .collect()
            },
        )
        .collect();
    parts.concat()
}
