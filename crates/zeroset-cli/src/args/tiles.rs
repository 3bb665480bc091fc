//! How ground that is larger than memory is cut up.

use std::num::NonZeroUsize;

use clap::ValueEnum;

use super::values::{self, Length};

/// How ground that is larger than memory is cut up.
#[derive(Debug, Clone, clap::Args)]
pub struct TileArgs {
    /// Side of the tiles that ground is fitted in one after the other, such as 250m or 800ft; without a unit it is that of the input [default: none, as long as the whole fits into memory, or else what memory allows for].
    #[arg(long, value_name = "LENGTH", value_parser = values::length, help_heading = "Tiles")]
    pub tile: Option<Length>,
    /// Tiles at a time [default: one for each thread, as far as memory goes].
    #[arg(long, value_name = "N", value_parser = values::threads, help_heading = "Tiles")]
    pub jobs: Option<NonZeroUsize>,
    /// How tiles in a folder are written: glb, with levels of detail and a tileset.json for 3D Tiles; ply; or zset, their models [default: glb].
    #[arg(long, value_name = "FORMAT", hide_possible_values = true, help_heading = "Tiles")]
    pub tile_format: Option<TileFormatChoice>,
    /// Keep what was handed from step to step in the folder's subfolder work, once all is done.
    #[arg(long, help_heading = "Tiles")]
    pub keep_work: bool,
}

/// How tiles are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum TileFormatChoice {
    Glb,
    Ply,
    Zset,
}
