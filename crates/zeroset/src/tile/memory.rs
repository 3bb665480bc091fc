//! What a tile in work takes.

use super::plan::LEAST_NODES;
use crate::reconstruct::{Quality, expected_bytes};

/// Cells of surface above a square cell of ground.
const CELLS_A_SQUARE: f64 = 2.0;
/// Cells around a tile that are worked on with it, both sides together.
const AROUND: f64 = 40.0;

/// What decides how much memory a tile takes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TileMemory {
    /// How much is done.
    pub quality: Quality,
    /// Finest cell.
    pub resolution: f64,
    /// Points on a unit of ground.
    pub density: f64,
}

impl TileMemory {
    /// Peak bytes of the work on a tile of a side, expected.
    #[must_use]
    pub fn bytes(self, side: f64) -> f64 {
        let cells = (side / self.resolution + AROUND).powi(2);
        let points = self.density * cells * self.resolution.powi(2);
        expected_bytes(self.quality, (CELLS_A_SQUARE * cells) as usize, points as usize)
    }

    /// The widest tiles for so many bytes; `None` if that is not enough for any.
    #[must_use]
    pub fn widest(self, bytes: f64) -> Option<f64> {
        let of_square = self.bytes((1000.0 - AROUND) * self.resolution) / 1e6;
        let cells = (bytes / of_square).sqrt() - AROUND;
        (cells >= LEAST_NODES).then_some(cells * self.resolution)
    }
}
