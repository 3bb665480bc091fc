//! Surfaces larger than memory: fitted and extracted tile by tile, without a seam.
//!
//! # What
//! The ground plane is cut into squares whose sides lie at whole multiples of their length in world coordinates, here called *tiles*. The coarse
//! levels of the cascade are solved once for the whole: they decide what is inside. Each tile goes on alone from there, on its
//! own nodes and a halo around them, finds its planes and polishes F. Where tiles overlap, F is made the same: near a face it is the mean of
//! all that know it, with weights that go over from one tile to the other. Each tile then extracts the surface of its own nodes.
//!
//! # How
//! The work is a graph of five kinds of steps, all of them functions of what they are given:
//!
//! ```text
//! plan ── thin(tile) ── coarse ── fit(tile) ── mesh(tile)
//!                                     └── strip(tile) ──> mesh(tile and its eight neighbours)
//! ```
//!
//! - [`TilePlan`]: every default resolved, which tiles there are, and which points each step needs.
//! - [`TilePlan::thin`]: a few points for each cell of a coarser level, where no more are of use.
//! - [`TilePlan::coarse`]: F on the levels that are about 128 nodes across.
//! - [`TilePlan::fit`]: F on the finest level of a tile with its halo, and its planes.
//! - [`Strip`]: F beside the faces of a tile, for its neighbours.
//! - [`TilePlan::mesh`]: F made the same as the neighbours', and its zero set, sharp, with the vertices that are shared.
//! - [`TilePlan::simplify`]: fewer triangles, where that is asked for.
//! - [`merge`]: tiles as one mesh.
//! - [`TilePlan::part`] and [`TilePlan::level`]: a tile, and up to four parts together, as a coarser mesh for a view from afar.
//! - [`TileMemory`]: how wide tiles may be.
//!
//! Where the steps run, and where their results are kept meanwhile, is the caller's: [`reconstruct`] does all in memory and shows how
//! they fit together.
//!
//! # Guaranteed
//! The vertices that neighbouring tiles share are equal bit for bit, simplified or not and on all levels, and merged tiles are a manifold. The result does not depend on where, when or in
//! which order steps ran.
//!
//! # Not guaranteed
//! That the result is that of a run without tiles: planes are found in each tile with its halo only, and creases end one cell before a face
//! and go on behind it, where the surface is as F has it.
//!
//! # Source
//! Design of this project. Partitions of unity: Shepard 1968.

mod agree;
mod extract;
mod fit;
mod gather;
mod layout;
mod level;
mod memory;
mod merge;
mod plan;
mod run;
mod thin;

#[cfg(test)]
mod tests;

pub use agree::Strip;
pub use extract::TileMesh;
pub use fit::{TileFit, TileFitReport};
pub use level::{LevelMesh, Node, NodeId, Shared};
pub use memory::TileMemory;
pub use merge::merge;
pub use plan::{Measurement, TileId, TilePlan};
pub use run::reconstruct;
