//! Triangles that cut through each other.
//!
//! # What
//! Pairs of triangles that have more in common than corners or an edge at the same places. A mesh without such pairs, without
//! triangles that have no area, and without non-manifold edges and vertices, is embedded: a surface that nowhere meets itself.
//!
//! # Definition
//! Places count, not numbers: vertices at one place are one, so that a mesh stored without shared vertices is judged as if it
//! were welded. A pair of triangles counts if
//! - they have no corner in common and any point in common, touching included;
//! - they have one corner in common and a point besides it;
//! - they have an edge in common, lie in one plane, and are folded onto each other;
//! - they have all three corners in common.
//!
//! # How
//! A tree finds pairs whose boxes meet. A pair is settled in the plane where a line along an edge has the two on different
//! sides, and else in space: two triangles meet only if an edge of one meets the other.
//!
//! # Cost
//! O(F log F + K) for K pairs of boxes that meet; on all threads.
//!
//! # Guaranteed
//! Exact, for coordinates that are zero or lie between 2^-142 and 2^201. The same answer on any number of threads.
//!
//! # Not guaranteed
//! Triangles without area (see [`Topology::degenerate_triangles`](super::Topology::degenerate_triangles)) are passed over. In a mesh
//! all of whose triangles are in one place the time grows with the square of their number; the memory does not.
//!
//! # Source
//! Orientations: Shewchuk, Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates, 1997, as the
//! crate `robust` has them.
//!
//! ```
//! use zeroset::mesh::{Mesh, self_intersections};
//!
//! let vertices = vec![
//!     [0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0],
//!     [0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [3.0, 3.0, 0.0],
//! ];
//! let mesh = Mesh { vertices, triangles: vec![[0, 1, 2], [3, 4, 5]], ..Mesh::default() };
//! let found = self_intersections(&mesh, 10, &())?;
//! assert_eq!((found.pairs, found.triangles, found.listed), (1, 2, vec![[0, 1]]));
//! # Ok::<(), zeroset::mesh::SelfIntersectionError>(())
//! ```

mod facet;

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

pub(crate) use facet::{Facet, Projection};

use super::{Mesh, MeshError};
use crate::monitor::{Cancelled, Monitor, Steps};
use crate::spatial::TriangleTree;
use crate::vec3;

/// Triangles that one task holds against the others.
const CHUNK: usize = 1 << 10;

/// What [`self_intersections`] finds.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
pub struct SelfIntersections {
    /// Number of pairs.
    pub pairs: u64,
    /// Number of triangles that are in a pair.
    pub triangles: usize,
    /// The first pairs, the lower triangle first, by the lower and then the higher one; no more than asked for.
    pub listed: Vec<[u32; 2]>,
}

/// Why self-intersections were not counted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SelfIntersectionError {
    /// A mesh that can't be examined.
    #[error(transparent)]
    Broken(#[from] MeshError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Counts the pairs of triangles that cut through each other, and lists the first of them, up to `most_listed`.
///
/// # Errors
/// [`SelfIntersectionError`] if the mesh is broken (see [`Mesh::check`]), or the monitor asks to stop.
pub fn self_intersections(
    mesh: &Mesh,
    most_listed: usize,
    monitor: &dyn Monitor,
) -> Result<SelfIntersections, SelfIntersectionError> {
    mesh.check()?;
    Ok(with_tree(mesh, &TriangleTree::new(mesh), most_listed, monitor)?)
}

/// The same for a mesh that is sound, with its tree.
pub(crate) fn with_tree(
    mesh: &Mesh,
    tree: &TriangleTree,
    most_listed: usize,
    monitor: &dyn Monitor,
) -> Result<SelfIntersections, Cancelled> {
    let projections = projections(mesh);
    let taking_part: Vec<AtomicBool> = mesh.triangles.iter().map(|_| AtomicBool::new(false)).collect();
    let steps = Steps::new(monitor, 0.0..1.0, mesh.triangles.len());
    let order = tree.leaf_order();
    let parts = order.par_chunks(CHUNK).map(|chunk| {
        let mut found = Listed { count: 0, first: Vec::new(), most: most_listed };
        for &t in chunk {
            // Each pair is looked at once, from its lower triangle.
            visit_overlapping(
                (mesh, &projections),
                tree,
                t,
                |other| other > t,
                |other| {
                    found.add([t, other]);
                    taking_part[t as usize].store(true, Ordering::Relaxed);
                    taking_part[other as usize].store(true, Ordering::Relaxed);
                },
            );
        }
        steps.advance(chunk.len()).map(|()| found)
    });
    let mut all = Listed { count: 0, first: Vec::new(), most: most_listed };
    for part in parts.collect::<Result<Vec<_>, _>>()? {
        all.count += part.count;
        all.first.extend(part.first);
    }
    all.cut();
    let triangles = taking_part.into_iter().filter(|part| part.load(Ordering::Relaxed)).count();
    Ok(SelfIntersections { pairs: all.count, triangles, listed: all.first })
}

/// The pairs in which one of the triangles asked for takes part, the lower triangle first, in their order.
pub(crate) fn pairs_of(
    mesh: &Mesh,
    tree: &TriangleTree,
    projections: &[Option<Projection>],
    asked: &[bool],
) -> Vec<[u32; 2]> {
    let order: Vec<u32> = tree.leaf_order().into_iter().filter(|&t| asked[t as usize]).collect();
    let mut pairs: Vec<[u32; 2]> = order
        .par_chunks(CHUNK)
        .flat_map_iter(|chunk| {
            let mut found = Vec::new();
            for &t in chunk {
                let counts = |other: u32| other > t || other < t && !asked[other as usize];
                visit_overlapping((mesh, projections), tree, t, counts, |other| {
                    found.push([t.min(other), t.max(other)])
                });
            }
            found
        })
        .collect();
    pairs.par_sort_unstable();
    pairs
}

/// How each triangle is best projected; `None` for one without area.
pub(crate) fn projections(mesh: &Mesh) -> Vec<Option<Projection>> {
    mesh.triangles.par_iter().map(|corners| Projection::new(corners.map(|v| mesh.vertices[v as usize]))).collect()
}

/// Visits the triangles that one has more in common with than it should, among those that count.
fn visit_overlapping(
    (mesh, projections): (&Mesh, &[Option<Projection>]),
    tree: &TriangleTree,
    t: u32,
    counts: impl Fn(u32) -> bool,
    mut visit: impl FnMut(u32),
) {
    let corners = |t: u32| mesh.triangles[t as usize].map(|v| mesh.vertices[v as usize]);
    let facet = |t: u32| Some(Facet::projected(corners(t), projections[t as usize]?));
    let Some(own) = facet(t) else { return };
    let [a, b, c] = corners(t);
    let (low, high) = (vec3::min(vec3::min(a, b), c), vec3::max(vec3::max(a, b), c));
    tree.visit_meeting(low, high, &mut |other| {
        let other = other as u32;
        if counts(other) && facet(other).is_some_and(|other| own.overlaps(&other)) {
            visit(other);
        }
    });
}

/// Counts pairs and keeps the first in their order.
struct Listed {
    count: u64,
    first: Vec<[u32; 2]>,
    most: usize,
}

impl Listed {
    fn add(&mut self, pair: [u32; 2]) {
        self.count += 1;
        self.first.push(pair);
        if self.first.len() > CHUNK && self.first.len() / 2 > self.most {
            self.cut();
        }
    }

    fn cut(&mut self) {
        self.first.sort_unstable();
        self.first.truncate(self.most);
    }
}
