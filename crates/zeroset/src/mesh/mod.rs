//! Triangle meshes.

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
