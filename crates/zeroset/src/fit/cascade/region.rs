//! The part of a lattice on which a tile is fitted.

use super::prolong::Solved;
use crate::domain::{Blocks, Lattice, LatticePoints, block_of_key};
use crate::field::LatticeField;

/// Columns of blocks, seen from above, on each level: wider on coarse levels, as what happens there is felt farther.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Region {
    /// For each level the first block along x and y, and the one after the last.
    columns: Vec<[[u32; 2]; 2]>,
}

impl Region {
    /// The region around nodes of the finest level: from the first along x and y to the one after the last. It reaches `halo(level)` nodes of
    /// each level beyond them, rounded up to whole blocks.
    pub(crate) fn around(lattice: &Lattice, nodes: [[u32; 2]; 2], halo: impl Fn(u32) -> u32) -> Self {
        let at = |level: u32| {
            let (step, halo, extent) = (lattice.finest - level, halo(level), lattice.blocks_at(level));
            let first = nodes[0].map(|n| (n >> step).saturating_sub(halo) / 8);
            let last = std::array::from_fn(|a| ((nodes[1][a] >> step) + halo).div_ceil(8).min(extent[a]));
            [first, last]
        };
        Self { columns: (0..=lattice.finest).map(at).collect() }
    }

    /// Whether a block lies in it, or at most `margin` blocks beyond it.
    pub(super) fn contains(&self, level: u32, key: u64, margin: u32) -> bool {
        let [first, last] = self.columns[level as usize];
        let block = block_of_key(key);
        (0..2).all(|a| (first[a].saturating_sub(margin)..last[a] + margin).contains(&block[a]))
    }

    /// The points in it on a level.
    pub(super) fn points(&self, lattice: &Lattice, points: &LatticePoints, level: u32) -> LatticePoints {
        let [first, last] = self.columns[level as usize];
        let shift = lattice.shift_at(level) + 3;
        let is_in = |c: &[u32; 3]| (0..2).all(|a| (first[a]..last[a]).contains(&(c[a] >> shift)));
        let kept = || points.coordinates.iter().zip(&points.order).filter(|(c, _)| is_in(c));
        LatticePoints { coordinates: kept().map(|(c, _)| *c).collect(), order: kept().map(|(_, i)| *i).collect() }
    }

    /// The part of a coarse F that is felt in it.
    pub(super) fn of_coarse(&self, coarse: &LatticeField) -> Solved {
        let index = coarse.lattice.finest;
        let inside: Vec<usize> =
            (0..coarse.blocks.len()).filter(|&b| self.contains(index, coarse.blocks.keys[b], 1)).collect();
        Solved {
            index,
            blocks: Blocks::new(inside.iter().map(|&b| coarse.blocks.keys[b]).collect(), coarse.blocks.extent),
            known: inside.iter().map(|&b| coarse.known[b]).collect(),
            f: inside.iter().flat_map(|&b| &coarse.values[512 * b..512 * (b + 1)]).copied().collect(),
        }
    }
}
