//! Shows what is thinner than an edge of the lattice.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::Node;
use crate::domain::{BLOCK_NODES, NONE, mask_get, neighbor_code};
use crate::field::{Field, LatticeField};
use crate::vec3::{self, Vec3};

/// No sheet: the node is unknown, or far from the surface.
const FAR: u32 = u32::MAX;
/// No edge of the lattice goes farther than this, in cells.
const LONGEST: f32 = 1.8;

/// Where the field changes sides twice along an edge of the lattice, from one sheet to another, the end that is nearer to them changes sides, with the value of
/// the sheet beyond.
pub(super) fn thicken(values: &mut LatticeField, field: &dyn Field) {
    let sheets = sheets(values, field);
    let changes: Vec<Vec<(Node, f32)>> =
        (0..values.blocks.len()).into_par_iter().map(|b| changes(values, field, &sheets, b)).collect();
    let mut least: FxHashMap<Node, f32> = FxHashMap::default();
    for (node, value) in changes.into_iter().flatten() {
        let own = least.entry(node).or_insert(value);
        if value.abs() < own.abs() {
            *own = value;
        }
    }
    for (node, value) in least {
        values.values[node as usize] = value;
    }
}

/// The sheet at each node that is near to the surface.
fn sheets(values: &LatticeField, field: &dyn Field) -> Vec<u32> {
    let most = LONGEST * values.lattice.spacing as f32;
    let of = |node: usize| {
        let (block, local) = (node / BLOCK_NODES, node % BLOCK_NODES);
        let is_near = mask_get(&values.known[block], local) && values.values[node].abs() < most;
        if is_near { field.sheet(position(values, block, local)) } else { FAR }
    };
    (0..values.values.len()).into_par_iter().map(of).collect()
}

fn position(values: &LatticeField, block: usize, local: usize) -> Vec3 {
    let first = values.blocks.coordinates[block].map(|c| 8 * c);
    let step = [local & 7, local >> 3 & 7, local >> 6];
    let node = std::array::from_fn(|a| f64::from(first[a] + step[a] as u32));
    values.lattice.position(values.lattice.finest, node)
}

/// The nodes that change sides for the edges from the nodes of a block on, with their new values.
fn changes(values: &LatticeField, field: &dyn Field, sheets: &[u32], block: usize) -> Vec<(Node, f32)> {
    let mut found = Vec::new();
    for local in 0..BLOCK_NODES {
        let node = block * BLOCK_NODES + local;
        if sheets[node] == FAR {
            continue;
        }
        for subset in 1..8_usize {
            let at: [usize; 3] = std::array::from_fn(|a| (local >> (3 * a) & 7) + (subset >> a & 1));
            let other = values.blocks.neighbors[block][neighbor_code(at.map(|c| (c >> 3) as i32))];
            if other == NONE {
                continue;
            }
            let place = at[0] & 7 | (at[1] & 7) << 3 | (at[2] & 7) << 6;
            let next = other as usize * BLOCK_NODES + place;
            let (own, beyond) = (sheets[node], sheets[next]);
            let is_outside = values.values[node] >= 0.0;
            if beyond == FAR || beyond == own || is_outside != (values.values[next] >= 0.0) {
                continue;
            }
            let ends = [position(values, block, local), position(values, other as usize, place)];
            if let Some((is_far, value)) = crossing(field, [own, beyond], ends, is_outside) {
                found.push((if is_far { next } else { node } as Node, value as f32));
            }
        }
    }
    found
}

/// Whether the far end of an edge is nearer to what lies between two sheets, and the value that this end gets; `None` where nothing does.
fn crossing(field: &dyn Field, sheets: [u32; 2], ends: [Vec3; 2], is_outside: bool) -> Option<(bool, f64)> {
    let at = |sheet: u32| ends.map(|p| field.on_sheet(sheet, p).0);
    let ([own_near, own_far], [beyond_near, beyond_far]) = (at(sheets[0]), at(sheets[1]));
    let enter = own_near / (own_near - own_far);
    let leave = beyond_near / (beyond_near - beyond_far);
    if !(0.0 < enter && enter < leave && leave < 1.0) {
        return None;
    }
    let between = field.value(vec3::lerp(ends[0], ends[1], 0.5 * (enter + leave)));
    if (between >= 0.0) == is_outside {
        return None;
    }
    let (is_far, value) = if enter < 1.0 - leave { (false, beyond_near) } else { (true, own_far) };
    ((value >= 0.0) != is_outside && value != 0.0).then_some((is_far, value))
}
