//! The sharp edges of a mesh.
//!
//! # What
//! Every edge at which the surface turns by more than a given angle, as a segment.
//!
//! # Formula
//! The angle between the normals of the edge's two triangles, 0 where they lie in one plane. Normals are compared as if
//! the two triangles were oriented alike, so a triangle that is turned over makes no crease.
//!
//! # Cost
//! O(V + F log d), as for [`topology`](super::topology()).
//!
//! # Guaranteed
//! Segments come in the order of their lower and then their higher vertex, each once. Edges of three and more triangles
//! are sharp.
//!
//! # Not guaranteed
//! Boundary edges are no creases. An edge beside a triangle without area has no angle and is left out.

use super::edges::Edges;
use super::{Mesh, MeshError};
use crate::vec3::{self, Vec3};

/// The angle, in radians, from which an edge counts as sharp where the user names none: 30 degrees.
pub const SHARP_ANGLE: f64 = std::f64::consts::PI / 6.0;

/// The edges at which the normal turns by more than `angle` (radians), as segments in local coordinates.
///
/// # Errors
/// [`MeshError`] if the mesh is broken: see [`Mesh::check`].
pub fn creases(mesh: &Mesh, angle: f64) -> Result<Vec<[[f64; 3]; 2]>, MeshError> {
    let edges = Edges::new(mesh)?;
    let normal = |side: u32| -> Option<Vec3> {
        let [a, b, c] = mesh.triangles[side as usize / 3].map(|v| mesh.vertices[v as usize]);
        vec3::normalized(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))
    };
    let is_sharp = |[a, b]: [u32; 2]| {
        let (Some(m), Some(n)) = (normal(a), normal(b)) else {
            return false;
        };
        // Two triangles oriented alike run along their edge in opposite directions.
        let n = if edges.vertex(a) == edges.vertex(b) { vec3::scale(n, -1.0) } else { n };
        // The arctangent keeps its accuracy where the cosine is flat.
        vec3::norm(vec3::cross(m, n)).atan2(vec3::dot(m, n)) > angle
    };
    let sharp = edges.iter().filter(|edge| edge.count() > 2 || edge.pair().is_some_and(is_sharp));
    Ok(sharp.map(|edge| [edge.low, edge.high].map(|v| mesh.vertices[v as usize])).collect())
}
