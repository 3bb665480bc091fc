//! Shows what is thinner than an edge of the lattice.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::sheets::{FAR, position};
use super::{ACUTE, Node, stepped};
use crate::domain::BLOCK_NODES;
use crate::field::{Field, LatticeField};
use crate::vec3::{self, Vec3};

/// Where the field changes sides twice along an edge of the lattice, from one sheet to another and through an acute wedge, the end that is nearer to them changes sides, with the value of
/// the sheet beyond.
pub(super) fn thicken(values: &mut LatticeField, field: &dyn Field, sheets: &[u32]) {
    let of_block = |b: usize| {
        let nodes = b * BLOCK_NODES..(b + 1) * BLOCK_NODES;
        nodes.flat_map(|node| changes(values, field, sheets, node)).collect()
    };
    let changes: Vec<Vec<(Node, f32)>> = (0..values.blocks.len()).into_par_iter().map(of_block).collect();
    let mut least: FxHashMap<Node, f32> = FxHashMap::default();
    for (node, value) in changes.into_iter().flatten() {
        let own = least.entry(node).or_insert(value);
        if value.abs() < own.abs() {
            *own = value;
        }
    }
    for (node, value) in least {
        values.values[node] = value;
    }
}

/// The nodes that change sides for the edges that go forward from a node, with their new values.
fn changes(values: &LatticeField, field: &dyn Field, sheets: &[u32], node: Node) -> impl Iterator<Item = (Node, f32)> {
    let own = sheets[node];
    let edges = if own == FAR { 1..1 } else { 1..8 };
    let is_outside = values.values[node] >= 0.0;
    edges.filter_map(move |subset| {
        let next = stepped(values, node, [0, 1, 2].map(|a| subset >> a & 1))?;
        let beyond = sheets[next];
        if beyond == FAR || beyond == own || is_outside != (values.values[next] >= 0.0) {
            return None;
        }
        let ends = [node, next].map(|node| position(values, node));
        let (end, value) = crossing(field, [own, beyond], ends, is_outside)?;
        Some(([node, next][end], value as f32))
    })
}

/// The end of an edge that is nearer to what lies between two sheets, and the value that this end gets; `None` where nothing does.
fn crossing(field: &dyn Field, sheets: [u32; 2], ends: [Vec3; 2], is_outside: bool) -> Option<(usize, f64)> {
    let at = |sheet: u32| ends.map(|p| field.on_sheet(sheet, p));
    let ([(own_near, own_normal), (own_far, _)], [(beyond_near, beyond_normal), (beyond_far, _)]) =
        (at(sheets[0]), at(sheets[1]));
    let lengths = vec3::norm(own_normal) * vec3::norm(beyond_normal);
    if vec3::dot(own_normal, beyond_normal) > ACUTE * lengths {
        return None;
    }
    let enter = own_near / (own_near - own_far);
    let leave = beyond_near / (beyond_near - beyond_far);
    if !(0.0 < enter && enter < leave && leave < 1.0) {
        return None;
    }
    let between = field.value(vec3::lerp(ends[0], ends[1], 0.5 * (enter + leave)));
    if (between >= 0.0) == is_outside {
        return None;
    }
    let (end, value) = if enter < 1.0 - leave { (0, beyond_near) } else { (1, own_far) };
    // In single precision it may be zero, which is outside.
    ((value as f32 >= 0.0) != is_outside).then_some((end, value))
}
