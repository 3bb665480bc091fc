//! Triangle meshes, and what can be measured on them.

mod cluster;
mod compare;
mod components;
mod creases;
mod curvature;
mod edges;
mod intersections;
mod quadric;
mod section;
mod simplify;
mod topology;

#[cfg(test)]
mod tests;

pub use cluster::{Clustered, cluster};
pub use compare::{Agreement, CompareError, CompareParams, CompareReport, Distances, OneWay, Role, compare};
pub use components::{Components, DroppedComponents, drop_small_components};
pub(crate) use creases::{Crease, crease_edges};
pub use creases::{SHARP_ANGLE, creases};
pub use curvature::mean_curvature;
pub(crate) use edges::Edges;
pub(crate) use intersections::{Facet, Projection, pairs_of as overlapping_pairs, projections};
pub use intersections::{SelfIntersectionError, SelfIntersections, self_intersections};
pub use section::{PlaneCurve, section};
pub use simplify::{Deviation, SimplifyError, SimplifyParams, SimplifyReport, simplify, simplify_held};
pub use topology::{Component, Topology, topology};

use crate::cloud::Attributes;

/// An indexed triangle mesh. Triangles are counter-clockwise seen from outside.
///
/// Coordinates are f64 and local: the world position of vertex `i` is `vertices[i] + world_from_local`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Mesh {
    /// What to add to a local position to get the world position, in the file's unit.
    pub world_from_local: [f64; 3],
    /// Local positions.
    pub vertices: Vec<[f64; 3]>,
    /// Three vertex indices a triangle.
    pub triangles: Vec<[u32; 3]>,
    /// Values at the vertices.
    pub attributes: Attributes,
    /// The coordinate reference system as the input stated it.
    pub crs: Option<String>,
}

/// A mesh that no examination can be made of.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MeshError {
    /// A triangle names a vertex that is not there.
    #[error("triangle {triangle} names vertex {vertex}, but there are only {count} vertices")]
    VertexMissing {
        /// The triangle.
        triangle: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} is at {position:?}, which is not finite")]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Where it is said to be.
        position: [f64; 3],
    },
    /// More triangles than can be numbered.
    #[error("the mesh has {count} triangles, more than {}; cut it into pieces", edges::MOST_TRIANGLES)]
    TooManyTriangles {
        /// Number of triangles.
        count: usize,
    },
}
