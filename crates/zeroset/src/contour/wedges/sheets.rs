//! The sheets at the nodes.

use rayon::prelude::*;

use super::{Node, stepped};
use crate::contour::of_field;
use crate::domain::{BLOCK_NODES, Mask, dilate_box, mask_get, mask_set};
use crate::field::{Field, LatticeField};
use crate::vec3::Vec3;

/// No sheet: the node is unknown, or far from the surface.
pub(super) const FAR: u32 = u32::MAX;
/// Nodes this near to the surface have a sheet, in cells.
const NEAR: f32 = 2.5;

/// The sheet at each node near the surface, else [`FAR`].
pub(super) fn sheets(values: &LatticeField, field: &dyn Field) -> Vec<u32> {
    let most = NEAR * values.lattice.spacing as f32;
    let of = |node: Node| {
        let is_known = mask_get(&values.known[node / BLOCK_NODES], node % BLOCK_NODES);
        let is_near = is_known && values.values[node].abs() < most;
        if is_near { field.sheet(position(values, node)) } else { FAR }
    };
    (0..values.values.len()).into_par_iter().map(of).collect()
}

/// Where a node is.
pub(super) fn position(values: &LatticeField, node: Node) -> Vec3 {
    of_field::position(&values.lattice, &values.blocks, node / BLOCK_NODES, node % BLOCK_NODES)
}

/// The nodes within two steps of where a sheet gives way to another.
pub(super) fn between(values: &LatticeField, sheets: &[u32]) -> Vec<Mask> {
    let borders: Vec<Mask> = (0..values.blocks.len())
        .into_par_iter()
        .map(|b| {
            let mut found = [0; 8];
            for local in 0..BLOCK_NODES {
                let node = b * BLOCK_NODES + local;
                let differs = |step: [i32; 3]| {
                    stepped(values, node, step).is_some_and(|next| sheets[next] != FAR && sheets[next] != sheets[node])
                };
                if sheets[node] != FAR && [[1, 0, 0], [0, 1, 0], [0, 0, 1]].into_iter().any(differs) {
                    mask_set(&mut found, local);
                }
            }
            found
        })
        .collect();
    dilate_box(&values.blocks, &dilate_box(&values.blocks, &borders))
}
