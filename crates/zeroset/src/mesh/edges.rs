//! The edges of a mesh, grouped.

use super::{Mesh, MeshError};
use rayon::prelude::*;

/// Vertices whose edges one task sorts.
const CHUNK: usize = 1 << 14;

/// One triangle's side of an edge.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Side {
    /// The higher of the edge's two vertices.
    high: u32,
    /// The corner that the side starts from, 3 t + i; side i of triangle t runs from its corner i to the next.
    corner: u32,
}

/// All sides of all triangles, grouped by edge: by the lower vertex in buckets, and sorted by the higher within each.
///
/// Triangles that repeat a vertex are left out. Counting into buckets and sorting these small lists takes linear time
/// for meshes whose vertices have few neighbours, and the order follows from the mesh alone.
#[derive(Debug)]
pub(crate) struct Edges<'a> {
    mesh: &'a Mesh,
    /// Where the bucket of each vertex starts, and the total.
    starts: Vec<u32>,
    sides: Vec<Side>,
}

/// An edge with all its sides.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Edge<'a> {
    pub(crate) low: u32,
    pub(crate) high: u32,
    sides: &'a [Side],
}

impl Edge<'_> {
    /// Number of triangles at the edge, a triangle's repetitions counted.
    pub(crate) fn count(&self) -> usize {
        self.sides.len()
    }

    /// The corners that the sides start from.
    pub(crate) fn corners(&self) -> impl Iterator<Item = u32> + '_ {
        self.sides.iter().map(|side| side.corner)
    }

    /// The two corners, if the edge has exactly two sides.
    pub(crate) fn pair(&self) -> Option<[u32; 2]> {
        match self.sides {
            [a, b] => Some([a.corner, b.corner]),
            _ => None,
        }
    }
}

/// The next corner round the triangle.
pub(super) fn next(corner: u32) -> u32 {
    if corner % 3 == 2 { corner - 2 } else { corner + 1 }
}

/// Whether a triangle names a vertex twice.
pub(super) fn repeats(&[a, b, c]: &[u32; 3]) -> bool {
    a == b || b == c || c == a
}

impl<'a> Edges<'a> {
    /// Groups the edges.
    ///
    /// # Errors
    /// What [`Mesh::check`] finds.
    pub(crate) fn new(mesh: &'a Mesh) -> Result<Self, MeshError> {
        mesh.check()?;
        let proper = || mesh.triangles.iter().enumerate().filter(|(_, t)| !repeats(t));
        let mut starts = vec![0_u32; mesh.vertices.len() + 1];
        for (_, &[a, b, c]) in proper() {
            for low in [a.min(b), b.min(c), c.min(a)] {
                starts[low as usize] += 1;
            }
        }
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        let mut places = starts.clone();
        let mut sides = vec![Side { high: 0, corner: 0 }; total as usize];
        for (t, &[a, b, c]) in proper() {
            for (side, (from, to)) in [(a, b), (b, c), (c, a)].into_iter().enumerate() {
                let place = &mut places[from.min(to) as usize];
                sides[*place as usize] = Side { high: from.max(to), corner: (3 * t + side) as u32 };
                *place += 1;
            }
        }
        sort_buckets(&starts, &mut sides, 0..mesh.vertices.len());
        Ok(Self { mesh, starts, sides })
    }

    /// All edges, by their lower and then their higher vertex.
    pub(crate) fn iter(&self) -> impl Iterator<Item = Edge<'_>> {
        self.starts.windows(2).enumerate().flat_map(|(low, range)| {
            let bucket = &self.sides[range[0] as usize..range[1] as usize];
            bucket.chunk_by(|a, b| a.high == b.high).map(move |sides| Edge {
                low: low as u32,
                high: sides[0].high,
                sides,
            })
        })
    }

    /// The vertex at a corner.
    pub(crate) fn vertex(&self, corner: u32) -> u32 {
        self.mesh.triangles[corner as usize / 3][corner as usize % 3]
    }

    /// The corner of a side's triangle that lies at the given vertex of its edge.
    pub(super) fn corner_at(&self, side: u32, vertex: u32) -> u32 {
        if self.vertex(side) == vertex { side } else { next(side) }
    }
}

/// Sorts the buckets of a range of vertices; `sides` starts with the first of them.
fn sort_buckets(starts: &[u32], sides: &mut [Side], vertices: std::ops::Range<usize>) {
    let begin = starts[vertices.start];
    if vertices.len() > CHUNK {
        let middle = vertices.start + vertices.len() / 2;
        let (left, right) = sides.split_at_mut((starts[middle] - begin) as usize);
        rayon::join(
            || sort_buckets(starts, left, vertices.start..middle),
            || sort_buckets(starts, right, middle..vertices.end),
        );
        return;
    }
    for vertex in vertices {
        sides[(starts[vertex] - begin) as usize..(starts[vertex + 1] - begin) as usize].sort_unstable();
    }
}

/// The most triangles that [`Edges`] can hold.
pub(super) const MOST_TRIANGLES: usize = u32::MAX as usize / 3;

impl Mesh {
    /// Whether the triangles name only vertices that are there, the vertices are finite, and there are fewer than 2^32
    /// / 3 triangles.
    ///
    /// # Errors
    /// The first offence found, by its lowest index.
    pub fn check(&self) -> Result<(), MeshError> {
        if self.triangles.len() > MOST_TRIANGLES {
            return Err(MeshError::TooManyTriangles { count: self.triangles.len() });
        }
        let count = self.vertices.len();
        let broken = self.triangles.par_iter().position_first(|t| t.iter().any(|&v| v as usize >= count));
        if let Some(triangle) = broken {
            let vertex = self.triangles[triangle].into_iter().find(|&v| v as usize >= count).unwrap_or(u32::MAX);
            return Err(MeshError::VertexMissing { triangle, vertex, count });
        }
        match self.vertices.par_iter().position_first(|v| !crate::vec3::is_finite(*v)) {
            Some(vertex) => Err(MeshError::NotFinite { vertex, position: self.vertices[vertex] }),
            None => Ok(()),
        }
    }
}
