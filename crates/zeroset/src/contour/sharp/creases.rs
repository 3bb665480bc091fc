//! The mesh edges that cross a crease.

use rayon::prelude::*;

use super::sheets::Sheets;
use crate::mesh::Mesh;

/// A mesh edge whose ends are on different sheets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    /// The ends, the lower first.
    pub(super) ends: [u32; 2],
    /// The sides of triangles that are this edge: side i of triangle t, from its corner i to the next, is 3 t + i. The second is that of a rim
    /// twice.
    pub(super) sides: [u32; 2],
}

/// The mesh edges that cross a crease, by their ends.
pub(super) fn crossings(mesh: &Mesh, sheets: &Sheets) -> Vec<Crossing> {
    let mut all: Vec<Crossing> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(t, corners)| {
            (0..3).filter_map(move |i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                let side = (3 * t + i) as u32;
                sheets.meet(a, b).then(|| Crossing { ends: [a.min(b), a.max(b)], sides: [side; 2] })
            })
        })
        .collect();
    all.par_sort_unstable();
    // The mesh is a manifold: an edge has at most two sides.
    all.dedup_by(|next, kept| {
        let same = next.ends == kept.ends;
        if same {
            kept.sides[1] = next.sides[1];
        }
        same
    });
    all
}
