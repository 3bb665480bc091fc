//! Leaves out the smallest pieces of a mesh.
//!
//! # What
//! A *piece* is a set of triangles that are connected through shared vertices. Pieces of few triangles are dropped with
//! the vertices that only they use; the largest piece always stays (of equals, the one with the lowest vertex). What stays
//! keeps its order.
//!
//! # Why by the number of triangles
//! On a lattice it is a size in cells, whatever their length: the extraction makes 44 triangles around a single node
//! inside, and about 12 for each cell of flat surface, so 100 triangles are about two cells across. That is below what
//! the lattice resolves: such pieces are bubbles around stray echoes and scraps that a trim cut off.
//! A car of 4.5 m on cells of 0.5 m has over a thousand triangles, a crown of 2 m about six hundred, by their areas. On the airborne
//! tile of the tests (849 k points, cells of 0.55 m) half of the 434 pieces are under 100 triangles, with 0.05 % of the
//! area between them.
//!
//! # Cost
//! O(V + F), on one thread.

use super::Mesh;
use super::topology::Groups;
use crate::cloud::retain_items;
use serde::Serialize;

/// What [`drop_small_components`] left out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct DroppedComponents {
    /// Pieces.
    pub components: usize,
    /// Their triangles.
    pub triangles: usize,
}

/// The pieces of a mesh.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Components {
    /// The piece of each vertex, named by its lowest vertex.
    pub of_vertex: Vec<u32>,
    /// The number of triangles of each piece, at its lowest vertex.
    pub triangles: Vec<usize>,
}

impl Components {
    /// Finds the pieces. Every index of a triangle must name a vertex.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let mut groups = Groups::new(mesh.vertices.len());
        for [a, b, c] in &mesh.triangles {
            groups.merge(*a, *b);
            groups.merge(*b, *c);
        }
        let of_vertex: Vec<u32> = (0..mesh.vertices.len() as u32).map(|vertex| groups.root(vertex)).collect();
        let mut triangles = vec![0_usize; mesh.vertices.len()];
        for [vertex, ..] in &mesh.triangles {
            triangles[of_vertex[*vertex as usize] as usize] += 1;
        }
        Self { of_vertex, triangles }
    }

    /// Drops the vertices of some pieces from the mesh that these are of, with their triangles. Returns the new numbers of the vertices, `None` for those that went.
    pub fn drop_from(&self, mesh: &mut Mesh, goes: impl Fn(u32) -> bool) -> Vec<Option<u32>> {
        let keep: Vec<bool> = self.of_vertex.iter().map(|piece| !goes(*piece)).collect();
        let mut next = 0..;
        let number: Vec<Option<u32>> = keep.iter().map(|keep| keep.then(|| next.next()).flatten()).collect();
        mesh.triangles.retain(|[vertex, ..]| keep[*vertex as usize]);
        // All corners of a triangle are of one piece.
        mesh.triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize].unwrap_or(*v));
        retain_items(&mut mesh.vertices, &keep);
        mesh.attributes.retain(&keep);
        number
    }
}

/// Drops the pieces of fewer than `least` triangles, but never the largest one.
///
/// Every index of a triangle must name a vertex. Vertices that no triangle uses stay.
pub fn drop_small_components(mesh: &mut Mesh, least: usize) -> DroppedComponents {
    let components = Components::of(mesh);
    let triangles = &components.triangles;
    let largest = triangles.iter().copied().max().unwrap_or(0);
    let first_largest = triangles.iter().position(|count| *count == largest);
    let is_small = |piece: usize| (1..least).contains(&triangles[piece]) && first_largest != Some(piece);
    let mut dropped = DroppedComponents::default();
    for piece in (0..triangles.len()).filter(|piece| is_small(*piece)) {
        dropped.components += 1;
        dropped.triangles += triangles[piece];
    }
    if dropped.components > 0 {
        components.drop_from(mesh, |piece| is_small(piece as usize));
    }
    dropped
}
