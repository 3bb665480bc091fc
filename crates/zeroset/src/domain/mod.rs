//! Where F lives: a sparse cubic lattice, each cube cut into six tetrahedra.
//!
//! # What
//! Space is covered by cubes of one size. Each cube is cut into the six Freudenthal (Kuhn) tetrahedra around its main
//! diagonal, and F is linear on each of them (P1), so F is given by its values at the lattice's nodes. Level 0 is the
//! coarsest lattice; each level halves the spacing. P1 on one level is contained in P1 on the next, so a function moves to a
//! finer level unchanged.
//!
//! Only nodes near the surface are stored: in blocks of 8 x 8 x 8, sorted along the Morton curve. A block's row of eight
//! nodes along x is the unit of work: eight f32 and one byte of mask.
//!
//! # Formula
//! A point with fractions f in its cube lies in the tetrahedron given by the order of its fractions. With f sorted
//! descending, the barycentric weights are 1 - f(1), f(1) - f(2), f(2) - f(3), f(3). The stiffness matrix of P1 on this
//! mesh is h times the 7-point stencil.
//!
//! # Source
//! Freudenthal 1942; Kuhn 1960. The stiffness identity is classical; it is a test here.

mod blocks;
mod bounds;
mod gather;
mod kuhn;
mod lattice;
mod mask;
mod morton;
mod points;
mod simplicial;

pub use blocks::{BLOCK_NODES, Blocks, NONE, block_key, block_of_key, neighbor_code};
pub(crate) use bounds::bounds;
pub(crate) use gather::{Halo, gather, halo_index, replicate_at_domain_faces};
pub use kuhn::{TETRAHEDRA, Tetrahedron, barycentric, tetrahedron_of};
pub use lattice::{Lattice, LatticeError};
pub use mask::{Mask, dilate, dilate_box, mask_count, mask_get, mask_row, mask_set};
pub(crate) use mask::{shift, shifted};
pub(crate) use morton::encode as morton_code;
pub use points::{Cells, LatticePoints};
pub(crate) use simplicial::polygon_area;
pub use simplicial::{Barycentric, DomainError, FacetPiece, Place, SegmentPiece, SimplicialMesh};
