//! Thin parts of a sampled field: what the lattice sees of them by chance is made whole, with the topology of what is thick.
//!
//! # What
//! Where two sheets meet at a small angle, the solid, or the gap beside it, is thinner than a cell before their line, at any size of the cells.
//! There nodes fall inside by chance, which makes crumbs and handles.
//!
//! # How
//! 1. [`thicken`](thicken::thicken): where an edge of the lattice goes through such a thin part, its nearer end changes sides, so that the part shows.
//! 2. [`open`](open::open): between sheets, nodes that no cube of their side holds change sides: a small cube, or in acute wedges a larger one. What is left there is
//!    thick, and so is its topology.
//! 3. [`regrow`](regrow::regrow): those in acute wedges change back, the surest first, unless they are thin and alter the topology.
//!
//! # Source
//! Openings: G. Matheron, Random sets and integral geometry, 1975. Growth by simple points: G. Bertrand, Simple points, topological numbers
//! and geodesic neighborhoods in cubic grids, 1994; X. Han, C. Xu and J. Prince, A topology preserving level set method, 2003.

mod open;
mod regrow;
mod sheets;
mod thicken;

use crate::domain::{BLOCK_NODES, NONE, neighbor_code};
use crate::field::{Field, LatticeField};

/// Sheets whose unit normals have at most this product go together to an acute wedge: of 50 degrees at most.
const ACUTE: f64 = -0.65;

/// A node, by its block and its place there: `512 block + local`.
type Node = usize;

/// Mends the values where two sheets are near.
pub(super) fn mend(values: &mut LatticeField, field: &dyn Field) {
    if field.sheets() < 2 {
        return;
    }
    let sheets = sheets::sheets(values, field);
    thicken::thicken(values, field, &sheets);
    let changed = open::open(values, field, &sheets);
    regrow::regrow(values, &changed);
}

/// The node some steps from another; `None` if it is not stored.
fn stepped(values: &LatticeField, node: Node, step: [i32; 3]) -> Option<Node> {
    let (block, local) = (node / BLOCK_NODES, node % BLOCK_NODES);
    let at: [i32; 3] = std::array::from_fn(|a| (local >> (3 * a) & 7) as i32 + step[a]);
    let other = values.blocks.neighbors[block][neighbor_code(at.map(|c| c >> 3))];
    let place = at[0] & 7 | (at[1] & 7) << 3 | (at[2] & 7) << 6;
    (other != NONE).then(|| other as usize * BLOCK_NODES + place as usize)
}
