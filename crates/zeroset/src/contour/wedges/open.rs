//! Takes the tips of wedges off.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::Node;
use crate::contour::sharp::meeting;
use crate::domain::{BLOCK_NODES, Blocks, Mask, NONE, mask_get, mask_set, neighbor_code, shift};
use crate::field::{Field, LatticeField};
use crate::vec3::{self, Vec3};

/// Rounds, each of which may go a cell farther from the line.
const ROUNDS: usize = 8;
/// Nodes along a side of the cubes, one of which must hold a node.
const SIDE: usize = 4;
/// Sides that are looked at for another sheet, in cells.
const BESIDE: [f64; 2] = [1.0, 2.0];
/// The value of a node that changed sides, in cells.
const SLIGHT: f32 = 0.1;

/// Changes the sides of nodes near where sheets meet, as far as `reach` from their line. Returns the values that they had.
pub(super) fn open(values: &mut LatticeField, field: &dyn Field, reach: f64) -> FxHashMap<Node, f32> {
    let mut changed = FxHashMap::default();
    let slight = SLIGHT * values.lattice.spacing as f32;
    for _ in 0..ROUNDS {
        let before = changed.len();
        for inside in [true, false] {
            let lonely = lonely(values, inside);
            let found = in_wedges(values, &lonely, field, reach);
            for (b, found) in found.iter().enumerate().filter(|(_, found)| **found != [0; 8]) {
                for local in (0..BLOCK_NODES).filter(|&local| mask_get(found, local)) {
                    let node = b * BLOCK_NODES + local;
                    changed.entry(node as Node).or_insert(values.values[node]);
                    values.values[node] = if inside { slight } else { -slight };
                }
            }
        }
        if changed.len() == before {
            break;
        }
    }
    changed
}

/// The known nodes of a side that no cube of eight nodes of that side holds; unknown nodes are of either side.
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
        cubes = stepped(&values.blocks, &cubes, axis, true, u64::MAX, |own, next| own & next);
    }
    for axis in (0..3).flat_map(|axis| [axis; SIDE - 1]) {
        cubes = stepped(&values.blocks, &cubes, axis, false, u64::MAX, |own, next| own | next);
    }
    // At the rim of what is known a node that changed sides would leave a hole.
    let mut within = values.known.clone();
    for (axis, ahead) in (0..3).flat_map(|axis| [(axis, false), (axis, true)]) {
        within = stepped(&values.blocks, &within, axis, ahead, 0, |own, next| own & next);
    }
    let rest = side.into_par_iter().zip(cubes).zip(within);
    rest.map(|((side, held), within)| std::array::from_fn(|z| side[z] & !held[z] & within[z])).collect()
}

/// Each set joined with the one a step along an axis; blocks that are not there have the words `missing`.
fn stepped(
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

/// Those of some nodes beside which another sheet counts that meets their own within reach.
fn in_wedges(values: &LatticeField, nodes: &[Mask], field: &dyn Field, reach: f64) -> Vec<Mask> {
    let lattice = &values.lattice;
    let h = lattice.spacing;
    let is_in_wedge = |p: Vec3| {
        let own = field.sheet(p);
        let mut tried = vec![own];
        let places = BESIDE.into_iter().flat_map(|far| (0..27).filter(|code| *code != 13).map(move |code| (far, code)));
        places.into_iter().any(|(far, code)| {
            let step = [code % 3, code / 3 % 3, code / 9].map(|s| far * h * f64::from(s - 1));
            let other = field.sheet(vec3::add(p, step));
            if tried.contains(&other) {
                return false;
            }
            tried.push(other);
            meeting(field, own, other, p, reach)
        })
    };
    nodes
        .par_iter()
        .enumerate()
        .map(|(b, nodes)| {
            let mut found = [0; 8];
            if *nodes == [0; 8] {
                return found;
            }
            let first = values.blocks.coordinates[b].map(|c| 8 * c);
            for local in (0..BLOCK_NODES).filter(|&local| mask_get(nodes, local)) {
                let step = [local & 7, local >> 3 & 7, local >> 6];
                let node = std::array::from_fn(|a| f64::from(first[a] + step[a] as u32));
                if is_in_wedge(lattice.position(lattice.finest, node)) {
                    mask_set(&mut found, local);
                }
            }
            found
        })
        .collect()
}
