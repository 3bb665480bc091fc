//! From F to triangles: Dual Marching Tetrahedra.
//!
//! # What
//! A tetrahedron on which F has both signs is active. The mesh has one vertex in each active tetrahedron, and one
//! polygon around each edge along which F changes sign: the ring of tetrahedra around that edge. A vertex is the mean
//! of the places where F vanishes on its tetrahedron's edges, or lies where the mesh bends least ([`placement`]).
//!
//! The tetrahedra are those of a lattice ([`contour`]), or of any mesh whose nodes are marked or bear values ([`contour_tetrahedra`]).
//! [`contour_field`] extracts any [`Field`](crate::field::Field), with its sharp edges.
//!
//! ```
//! use zeroset::contour::{ContourParams, LeastCurvature, Nodes, Placement, contour_tetrahedra};
//! use zeroset::domain::SimplicialMesh;
//! use zeroset::mesh::topology;
//!
//! // A segmentation: the nodes of a box that lie in a ball are marked.
//! let mesh = SimplicialMesh::<3>::lattice([-1.0; 3], [1.0; 3], [10; 3])?;
//! let marks: Vec<bool> = mesh.vertices().iter().map(|p| p.iter().map(|c| c * c).sum::<f64>() < 0.6).collect();
//! let params = ContourParams { placement: Placement::LeastCurvature(LeastCurvature::default()) };
//! let (surface, _) = contour_tetrahedra(&mesh, Nodes::Marks(&marks), &params)?;
//! assert!(topology(&surface)?.closed);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
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

mod active;
mod cells;
mod chain;
mod clip;
mod dual;
mod of_field;
mod outline;
pub mod placement;
mod rings;
mod seam;
mod sharp;
pub mod simplicial;
mod split;
mod tetrahedra;
mod triangulate;
mod wedges;

#[cfg(test)]
mod tests;

pub(crate) use clip::clip_at_box;
pub(crate) use dual::contour_part;
pub use dual::{ContourParams, ContourReport, contour, contour_with};
pub use of_field::{FieldContourError, FieldContourParams, FieldContourReport, contour_field};
pub(crate) use of_field::{SNAP, lattice_around, sampled};
pub use outline::ColumnOutline;
pub use placement::{Candidates, LeastCurvature, Norm, Placement, PlacementReport, Sweep};
pub(crate) use seam::{OwnNodes, Seam};
pub use sharp::SharpReport;
pub(crate) use sharp::{Known, Raster, sharpen, sharpen_field};
pub use simplicial::{Branches, Polyline, zero_lines, zero_surface};
pub(crate) use split::split_fans;
pub use tetrahedra::{ContourError, Nodes, contour_tetrahedra};
