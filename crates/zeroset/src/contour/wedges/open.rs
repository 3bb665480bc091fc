//! Takes off what is thin.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::Node;
use super::sheets::between;
use crate::domain::{BLOCK_NODES, Blocks, Mask, NONE, mask_get, neighbor_code, shift};
use crate::field::LatticeField;

/// Nodes along a side of the cubes, one of which must hold a node.
const SIDE: usize = 4;
/// The value of a node that changed sides, in cells.
const SLIGHT: f32 = 0.1;

/// Changes the sides of nodes between sheets that no cube of their side holds: first those inside, then those outside. Returns the values that they had.
pub(super) fn open(values: &mut LatticeField, sheets: &[u32]) -> FxHashMap<Node, f32> {
    let mut changed = FxHashMap::default();
    let slight = SLIGHT * values.lattice.spacing as f32;
    let (between, within) = (between(values, sheets), surrounded(values));
    for inside in [true, false] {
        let lonely = lonely(values, inside);
        for (b, lonely) in lonely.iter().enumerate() {
            let found: Mask = std::array::from_fn(|z| lonely[z] & between[b][z] & within[b][z]);
            for local in (0..BLOCK_NODES).filter(|&local| found != [0; 8] && mask_get(&found, local)) {
                let node = b * BLOCK_NODES + local;
                changed.entry(node).or_insert(values.values[node]);
                values.values[node] = if inside { slight } else { -slight };
            }
        }
    }
    changed
}

/// The nodes all of whose neighbours are known.
fn surrounded(values: &LatticeField) -> Vec<Mask> {
    let mut within = values.known.clone();
    for axis in 0..3 {
        for ahead in [false, true] {
            within = joined(&values.blocks, &within, axis, ahead, 0, |own, next| own & next);
        }
    }
    within
}

/// The known nodes of a side that no cube of nodes of that side holds; unknown nodes are of either side.
fn lonely(values: &LatticeField, inside: bool) -> Vec<Mask> {
    let mut side = values.inside();
    side.par_iter_mut().zip(&values.known).for_each(|(side, known)| {
        for z in 0..8 {
            let own = if inside { side[z] } else { !side[z] };
            side[z] = own | !known[z];
        }
    });
    // First nodes of whole cubes, and then all nodes of these.
    let mut cubes = side.clone();
    for axis in (0..3).flat_map(|axis| [axis; SIDE - 1]) {
        cubes = joined(&values.blocks, &cubes, axis, true, u64::MAX, |own, next| own & next);
    }
    for axis in (0..3).flat_map(|axis| [axis; SIDE - 1]) {
        cubes = joined(&values.blocks, &cubes, axis, false, u64::MAX, |own, next| own | next);
    }
    let rest = side.into_par_iter().zip(cubes).zip(&values.known);
    rest.map(|((side, held), known)| std::array::from_fn(|z| side[z] & !held[z] & known[z])).collect()
}

/// Each set joined with the one a step along an axis; blocks that are not there have the words `missing`.
fn joined(
    blocks: &Blocks,
    masks: &[Mask],
    axis: usize,
    ahead: bool,
    missing: u64,
    join: impl Fn(u64, u64) -> u64 + Sync,
) -> Vec<Mask> {
    let mut step = [0_i32; 3];
    step[axis] = if ahead { 1 } else { -1 };
    (0..masks.len())
        .into_par_iter()
        .map(|b| {
            let other = blocks.neighbors[b][neighbor_code(step)];
            let far = if other == NONE { [missing; 8] } else { masks[other as usize] };
            let moved = shift(&masks[b], &far, axis, ahead);
            std::array::from_fn(|z| join(masks[b][z], moved[z]))
        })
        .collect()
}
