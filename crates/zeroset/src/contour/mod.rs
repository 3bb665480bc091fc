//! From F to triangles: Dual Marching Tetrahedra.
//!
//! # What
//! A tetrahedron on which F has both signs is active. The mesh has one vertex in each active tetrahedron, and one
//! polygon around each lattice edge along which F changes sign: the ring of tetrahedra around that edge. A vertex is the mean
//! of the places where F vanishes on its tetrahedron's edges.
//!
//! # Guaranteed
//! Tetrahedra that share a face with both signs are neighbours in exactly the two rings of that face's crossed edges, so
//! every edge of the mesh has two polygons: a 2-manifold, closed unless the rim of the band, the domain, or a trim cuts it.
//! Two tetrahedra of a ring that are not neighbours in it share only the ring's own edge, so diagonals never meet an edge that is there
//! already, and the triangulated mesh is a manifold, too. Vertices where a trim leaves two fans are split. Triangles are
//! counter-clockwise seen from outside (F > 0). Vertices lie strictly inside their tetrahedra, so no two coincide.
//!
//! # Not guaranteed
//! Triangles can be slim. Creases are rounded by about a cell.
//!
//! # Cost
//! Linear in the cells with both signs; about 6 vertices and 12 triangles for each cell of flat surface.
//!
//! # Source
//! G. M. Nielson, Dual Marching Tetrahedra, ISVC 2008, LNCS 5358.

mod dual;
mod outline;
mod rings;
pub mod simplicial;
mod split;
mod triangulate;

#[cfg(test)]
mod tests;

pub use dual::{ContourReport, contour};
pub use outline::ColumnOutline;
pub use simplicial::{Branches, Polyline, zero_lines, zero_surface};
