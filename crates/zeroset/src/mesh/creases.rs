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

/// A sharp edge with what it joins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Crease {
    /// The lower and the higher vertex.
    pub(crate) vertices: [u32; 2],
    /// Its two sides; `None` for an edge of three and more triangles.
    pub(crate) sides: Option<Sides>,
}

/// The two sides of a crease.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sides {
    /// Unit normals, as if the two triangles were oriented alike.
    pub(crate) normals: [Vec3; 2],
    /// The angle between them, in radians.
    pub(crate) angle: f64,
    /// Whether the surface bends away from its normals; `None` where the triangles are not oriented alike.
    pub(crate) convex: Option<bool>,
}

/// The edges at which the normal turns by more than `angle` (radians), as segments in local coordinates.
///
/// # Errors
/// [`MeshError`] if the mesh is broken: see [`Mesh::check`].
pub fn creases(mesh: &Mesh, angle: f64) -> Result<Vec<[[f64; 3]; 2]>, MeshError> {
    let sharp = crease_edges(mesh, angle)?;
    Ok(sharp.iter().map(|crease| crease.vertices.map(|v| mesh.vertices[v as usize])).collect())
}

/// The same edges, with what they join.
///
/// # Errors
/// [`MeshError`] if the mesh is broken: see [`Mesh::check`].
pub(crate) fn crease_edges(mesh: &Mesh, angle: f64) -> Result<Vec<Crease>, MeshError> {
    let edges = Edges::new(mesh)?;
    let normal = |side: u32| -> Option<Vec3> {
        let [a, b, c] = mesh.triangles[side as usize / 3].map(|v| mesh.vertices[v as usize]);
        vec3::normalized(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))
    };
    let sides = |[a, b]: [u32; 2], [low, high]: [u32; 2]| -> Option<Sides> {
        let (m, n) = (normal(a)?, normal(b)?);
        // Two triangles oriented alike run along their edge in opposite directions.
        let alike = edges.vertex(a) != edges.vertex(b);
        let n = if alike { n } else { vec3::scale(n, -1.0) };
        let turn = vec3::cross(m, n);
        let along = vec3::sub(mesh.vertices[high as usize], mesh.vertices[low as usize]);
        let along = if edges.vertex(a) == low { along } else { vec3::scale(along, -1.0) };
        // The arctangent keeps its accuracy where the cosine is flat.
        let angle = vec3::norm(turn).atan2(vec3::dot(m, n));
        Some(Sides { normals: [m, n], angle, convex: alike.then_some(vec3::dot(turn, along) > 0.0) })
    };
    let sharp = edges.iter().filter_map(|edge| {
        let vertices = [edge.low, edge.high];
        if edge.count() > 2 {
            return Some(Crease { vertices, sides: None });
        }
        let sides = sides(edge.pair()?, vertices).filter(|sides| sides.angle > angle)?;
        Some(Crease { vertices, sides: Some(sides) })
    });
    Ok(sharp.collect())
}
