//! Takes off what is thin.

use std::iter::repeat_n;

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::sheets::{FAR, between, position};
use super::{ACUTE, Node, stepped};
use crate::domain::{BLOCK_NODES, Blocks, Mask, NONE, mask_get, neighbor_code, shift};
use crate::field::{Field, LatticeField};
use crate::vec3;

/// Nodes along a side of the cubes, one of which must hold a node ...
const SIDE: usize = 2;
/// ... and in acute wedges.
const SIDE_IN_ACUTE: usize = 4;
/// Sheets whose unit normals have at most this product are the two sides of a wall or a gap, and no wedge: 6 degrees.
const PARALLEL: f64 = -0.9945;
/// The value of a node that changed sides, in cells.
const SLIGHT: f32 = 0.1;

/// Changes the sides of nodes between sheets that no cube of their side holds: first those inside, then those outside. Returns the values that those in acute wedges had.
pub(super) fn open(values: &mut LatticeField, field: &dyn Field, sheets: &[u32]) -> FxHashMap<Node, f32> {
    let mut changed = FxHashMap::default();
    let slight = SLIGHT * values.lattice.spacing as f32;
    let (between, within) = (between(values, sheets), surrounded(values));
    for inside in [true, false] {
        let own = of_side(values, inside);
        let [lonely, in_acute] = [SIDE, SIDE_IN_ACUTE].map(|length| lonely(values, &own, length));
        // Each node that changes sides, and whether it is in an acute wedge.
        let of_block = |b: usize| {
            let found: Mask = std::array::from_fn(|z| in_acute[b][z] & between[b][z] & within[b][z]);
            let is_found = |local: &usize| found != [0; 8] && mask_get(&found, *local);
            let change = |local: usize| {
                let node = b * BLOCK_NODES + local;
                let product = least_product(values, field, sheets, node);
                let is_acute = product < ACUTE;
                (product > PARALLEL && (is_acute || mask_get(&lonely[b], local))).then_some((node, is_acute))
            };
            (0..BLOCK_NODES).filter(is_found).filter_map(change).collect()
        };
        let found: Vec<Vec<(Node, bool)>> = (0..values.blocks.len()).into_par_iter().map(of_block).collect();
        for (node, is_acute) in found.into_iter().flatten() {
            if is_acute {
                changed.entry(node).or_insert(values.values[node]);
            }
            values.values[node] = if inside { slight } else { -slight };
        }
    }
    changed
}

/// The least product of the unit normals of two sheets near a node: how far they face each other.
fn least_product(values: &LatticeField, field: &dyn Field, sheets: &[u32], node: Node) -> f64 {
    let mut near = vec![sheets[node]];
    for far in [1, 2] {
        for code in 0..27 {
            let step = [code % 3, code / 3 % 3, code / 9].map(|s| far * (s - 1));
            let sheet = stepped(values, node, step).map_or(FAR, |next| sheets[next]);
            if !near.contains(&sheet) {
                near.push(sheet);
            }
        }
    }
    let p = position(values, node);
    let normal = |&sheet: &u32| vec3::normalized(field.on_sheet(sheet, p).1);
    let normals: Vec<_> = near.iter().filter(|&&sheet| sheet != FAR).filter_map(normal).collect();
    let products = normals.iter().flat_map(|&a| normals.iter().map(move |&b| vec3::dot(a, b)));
    products.fold(1.0, f64::min)
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

/// The nodes of a side; unknown nodes are of either.
fn of_side(values: &LatticeField, inside: bool) -> Vec<Mask> {
    let mut side = values.inside();
    side.par_iter_mut().zip(&values.known).for_each(|(side, known)| {
        for z in 0..8 {
            let own = if inside { side[z] } else { !side[z] };
            side[z] = own | !known[z];
        }
    });
    side
}

/// The known nodes of a side that no cube of that side with so many nodes along an edge holds.
fn lonely(values: &LatticeField, side: &[Mask], length: usize) -> Vec<Mask> {
    let steps = || (0..3).flat_map(|axis| repeat_n(axis, length - 1));
    // First nodes of whole cubes, and then all nodes of these.
    let mut cubes = side.to_vec();
    for axis in steps() {
        cubes = joined(&values.blocks, &cubes, axis, true, u64::MAX, |own, next| own & next);
    }
    for axis in steps() {
        cubes = joined(&values.blocks, &cubes, axis, false, u64::MAX, |own, next| own | next);
    }
    let rest = side.par_iter().zip(cubes).zip(&values.known);
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
