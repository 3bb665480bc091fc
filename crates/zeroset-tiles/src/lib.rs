//! Cities tile by tile: out of core and resumable.
//!
//! [`zeroset::tile`] says what is computed. Here it is said where its steps run and where their results are kept: in a folder, one file a
//! result. A step whose file is there is done. So whoever runs them, in whatever order and however often they are interrupted, gets the same
//! files, and nothing that is there is made again.
//!
//! ```text
//! OUT/
//!   run.json          what is being made of which inputs; sorted.json and plan.json: what was decided
//!   tileset.json      3D Tiles 1.1, for CesiumJS and QGIS
//!   tiles.json        outlines of the tiles, as GeoJSON
//!   tiles/x_y.glb     the surface of each tile
//!   levels/l/x_y.glb  squares of 2^l by 2^l tiles as one coarser mesh each, for a view from afar
//!   done.json         what was written; there when all is done
//!   work/             what steps hand on; gone when all is done
//! ```
//!
//! - [`Folder`] has the steps: each reads files, and writes some.
//! - [`run`] does all steps on this machine, several tiles at a time.

mod binary;
mod error;
mod field;
mod folder;
mod levels;
mod mesh;
mod pieces;
mod placement;
mod points;
mod run;
mod sample;
mod sort;
mod steps;
mod tileset;

#[cfg(test)]
mod tests;

pub use error::TilesError;
pub use folder::Folder;
pub use levels::LevelEntry;
pub use points::Values;
pub use run::{Crew, RunParams, TileSeconds, Written, run, write_tiles};
pub use sort::{InputSort, Sorted, SortedTile};
pub use steps::TileFormat;
pub use tileset::TileEntry;
