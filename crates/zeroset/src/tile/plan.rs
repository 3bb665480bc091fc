//! Every default resolved, and which tiles there are.

use std::fmt;

use serde::{Deserialize, Serialize};

use super::layout::Layout;
use crate::cloud::Cloud;
use crate::constraint::Local;
use crate::feature::farthest_from_planes;
use crate::fit::Frame;
use crate::fit::cascade::Scene;
use crate::reconstruct::{Measured, PlanReport, ReconstructError, ReconstructParams, Trim};

/// Column and row of a tile: its lower left corner lies at so many times the side, in world coordinates with z up. Ordered by row, then by
/// column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct TileId {
    /// Column, along x.
    pub x: i32,
    /// Row, along y.
    pub y: i32,
}

impl TileId {
    /// The tile of a local position, z up, given the offset to world coordinates, z up, and the side of tiles.
    #[must_use]
    pub fn of(p: [f64; 3], offset: [f64; 3], side: f64) -> Self {
        let at = |a: usize| ((p[a] + offset[a]) / side).floor() as i32;
        Self { x: at(0), y: at(1) }
    }

    /// The tile so many columns and rows on.
    #[must_use]
    pub fn offset(self, columns: i32, rows: i32) -> Self {
        Self { x: self.x.saturating_add(columns), y: self.y.saturating_add(rows) }
    }

    /// The eight tiles around it, in order.
    pub fn around(self) -> impl Iterator<Item = Self> {
        let steps = (-1..=1).flat_map(|y| (-1..=1).map(move |x| (x, y)));
        steps.filter(|&step| step != (0, 0)).map(move |(x, y)| self.offset(x, y))
    }
}

impl Ord for TileId {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.y, self.x).cmp(&(other.y, other.x))
    }
}

impl PartialOrd for TileId {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for TileId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}_{}", self.x, self.y)
    }
}

/// Every default resolved for a whole, and the tiles it is cut into. Plain data, so that steps can run elsewhere.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TilePlan {
    /// What will be done, for the whole.
    pub report: PlanReport,
    /// What to add to local coordinates to get world coordinates.
    pub world_from_local: [f64; 3],
    /// Lowest and highest corner of the points, in local coordinates.
    pub bounds: [[f64; 3]; 2],
    /// Side of a tile, in the unit of the points.
    pub side: f64,
    /// The tiles, in order: those that hold points.
    pub tiles: Vec<TileId>,
    /// How far a point lies from its plane at most; `None` in a draft.
    pub plane_distance: Option<f64>,
}

/// What is known of the points of a whole, measured wherever they are.
#[derive(Debug, Clone, PartialEq)]
pub struct Measurement<'a> {
    /// How many there are.
    pub points: usize,
    /// Lowest and highest corner of their box, in local coordinates.
    pub bounds: [[f64; 3]; 2],
    /// A part of them at full density: spacing, noise and scene are measured on it.
    pub sample: &'a Cloud,
    /// The tiles that hold points.
    pub tiles: Vec<TileId>,
}

/// A tile has at least so many nodes along a side: halos and the gaps that the trim bridges are smaller.
pub(super) const LEAST_NODES: f64 = 128.0;

impl TilePlan {
    /// Resolves every default.
    ///
    /// # Errors
    /// If the points bear no surface, the scene is neither terrain nor airborne, tiles are narrower than 128 cells, nothing is trimmed, or a number of triangles is asked
    /// for.
    pub fn new(measured: Measurement<'_>, side: f64, params: &ReconstructParams) -> Result<Self, ReconstructError> {
        params.check()?;
        if !(side.is_finite() && side > 0.0) {
            return Err(ReconstructError::Length { name: "tile", value: side });
        }
        let Measurement { points, bounds, sample, mut tiles } = measured;
        let of_sample = Measured::of(sample, params)?;
        let whole = Measured { points, bounds, ..of_sample };
        if !matches!(whole.scene, Scene::Terrain | Scene::Airborne) {
            return Err(ReconstructError::TilesOfBody);
        }
        if params.trim == Trim::Off {
            return Err(ReconstructError::TilesWithoutTrim);
        }
        if params.simplify.as_ref().is_some_and(|simplify| simplify.triangles.is_some()) {
            return Err(ReconstructError::TilesToTriangles);
        }
        let resolution = whole.wanted(params)?;
        if side < LEAST_NODES * resolution {
            return Err(ReconstructError::NarrowTiles { side, least: LEAST_NODES * resolution });
        }
        let frame = Frame::new(params.up, whole.scene);
        let enter = |p: &[f64; 3]| frame.enter(*p);
        let inside = crate::domain::bounds(bounds.iter().map(enter));
        let known = Local::new(&params.constraints, sample.world_from_local, |p| frame.enter(p), inside);
        if known.is_empty() && !params.constraints.is_empty() {
            return Err(ReconstructError::ConstraintsAstray);
        }
        let mut report = whole.report(params, (resolution, resolution), 0, whole.surface_cells(resolution), &known);
        tiles.sort_unstable();
        tiles.dedup();
        let plane_distance = match report.polish {
            Some(_) => Some(farthest_from_planes(sample, &report, &())?),
            None => None,
        };
        let world_from_local = sample.world_from_local;
        let mut plan = Self { report: report.clone(), world_from_local, bounds, side, tiles, plane_distance };
        report.levels = Layout::new(&plan)?.lattice.finest + 1;
        plan.report = report;
        Ok(plan)
    }

    /// Lower left and upper right corner of a tile in world coordinates, z up.
    #[must_use]
    pub fn outline(&self, tile: TileId) -> [[f64; 2]; 2] {
        let corner = |step: i32| [tile.x, tile.y].map(|c| (f64::from(c) + f64::from(step)) * self.side);
        [corner(0), corner(1)]
    }

    /// The tiles around one that hold points, in order.
    pub fn neighbors(&self, tile: TileId) -> impl Iterator<Item = TileId> + '_ {
        tile.around().filter(|other| self.tiles.binary_search(other).is_ok())
    }

    /// The coarsest cells that [`Self::thin`] is asked for, as a power of two of the finest.
    #[must_use]
    pub fn coarsest_thinning(&self) -> u32 {
        Layout::new(self).map_or(0, |layout| layout.lattice.finest - layout.coarse)
    }

    /// The thinning of the points that [`Self::coarse`] takes.
    #[must_use]
    pub fn coarse_thinning(&self) -> u32 {
        self.coarsest_thinning().saturating_sub(1)
    }
}
