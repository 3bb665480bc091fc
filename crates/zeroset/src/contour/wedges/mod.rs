//! Thin wedges of a sampled field: what the lattice sees of them by chance is made whole, with the topology of what is thick.
//!
//! # What
//! Where two sheets meet at a small angle, the solid, or the gap beside it, is thinner than a cell before their line, at any size of the cells.
//! There nodes fall inside by chance, which makes crumbs and handles.
//!
//! # How
//! 1. [`thicken`]: where an edge of the lattice goes through such a thin part, its nearer end changes sides, so that the part shows.
//! 2. [`open`]: near lines of sheets, nodes that no cube of their side holds change sides. What is left is thick, and so is its topology.
//! 3. [`regrow`]: they change back, the surest first, as long as none of them alters the topology.
//!
//! # Source
//! Openings: G. Matheron, Random sets and integral geometry, 1975. Growth by simple points: G. Bertrand, Simple points, topological numbers
//! and geodesic neighborhoods in cubic grids, 1994; X. Han, C. Xu and J. Prince, A topology preserving level set method, 2003.

mod open;
mod regrow;
mod thicken;

use crate::field::{Field, LatticeField};

/// A node, by its block and its place there: `512 block + local`.
type Node = u64;

/// Mends the values near where sheets meet, as far as `reach` from their line.
pub(super) fn mend(values: &mut LatticeField, field: &dyn Field, reach: f64) {
    if field.sheets() < 2 {
        return;
    }
    thicken::thicken(values, field);
    let changed = open::open(values, field, reach);
    regrow::regrow(values, &changed);
}
