//! The seam of a surface that is extracted in parts.
//!
//! Neighbouring parts are extracted from the same values beside the seam, each together with some of what is around it. A polygon belongs to
//! the part whose nodes hold the first end of its lattice edge. Vertices of polygons of both sides are *held*: nothing after the extraction
//! moves them or cuts the edges between them, so both sides keep them bit for bit, and the parts fit together.

use rustc_hash::FxHashMap;

use super::clip::Cut;
use crate::mesh::Mesh;

/// Whether the polygons of edges that begin at a node of the finest level are a part's own; asked for its place along x and y.
pub(crate) type OwnNodes<'a> = &'a (dyn Fn([u32; 2]) -> bool + Sync);

/// What a held vertex is called in all parts that have it: the tetrahedron it was made in, or the place where a cut made it.
pub(crate) type SeamKey = [u64; 3];

/// The key of the vertex of a tetrahedron of a cell.
pub(super) fn key_of([x, y, z]: [u32; 3], tetrahedron: usize) -> SeamKey {
    [u64::from(x) | u64::from(y) << 32, u64::from(z) | (tetrahedron as u64) << 32, u64::MAX]
}

/// What of a mesh is a part's own, and what it shares.
#[derive(Debug, Clone, Default)]
pub(crate) struct Seam {
    /// For each triangle whether it is the part's own.
    pub(crate) own: Vec<bool>,
    /// The vertices that are held, with their keys.
    pub(crate) keys: FxHashMap<u32, SeamKey>,
}

impl Seam {
    /// Follows a cut of the mesh. A vertex on an edge between held ones is held, too.
    pub(super) fn follow(&mut self, cut: &Cut, mesh: &Mesh) {
        self.own = cut.source.iter().map(|&t| self.own[t as usize]).collect();
        let mut keys = FxHashMap::default();
        for (new, &old) in cut.kept.iter().enumerate() {
            let key = match cut.crossings.get((old as usize).wrapping_sub(cut.first)) {
                Some(ends) if ends.iter().all(|end| self.keys.contains_key(end)) => {
                    Some(mesh.vertices[new].map(f64::to_bits))
                }
                Some(_) => None,
                None => self.keys.get(&old).copied(),
            };
            if let Some(key) = key {
                keys.insert(new as u32, key);
            }
        }
        self.keys = keys;
    }

    /// Takes away what is not the part's own.
    pub(crate) fn keep_own(&mut self, mesh: &mut Mesh) {
        let mut own = self.own.iter();
        mesh.triangles.retain(|_| own.next().copied().unwrap_or(false));
        let kept = super::clip::drop_unused(mesh);
        let keys = kept.iter().enumerate().filter_map(|(new, old)| Some((new as u32, *self.keys.get(old)?)));
        self.keys = keys.collect();
        self.own = vec![true; mesh.triangles.len()];
    }
}
