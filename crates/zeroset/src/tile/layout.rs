//! Where tiles lie on the lattice.

use super::{TileId, TilePlan};
use crate::contour::Raster;
use crate::domain::Lattice;
use crate::fit::Frame;
use crate::fit::cascade::{FitParams, Region};
use crate::reconstruct::ReconstructError;

/// The coarse levels are those with at most so many nodes across.
const MOST_COARSE_NODES: u32 = 256;
/// How far beyond its own nodes a tile is fitted, in nodes of the level: on the finest level, on the one before, and on all others. What is farther is
/// felt as the coarser level left it.
pub(super) const HALO: [u32; 3] = [32, 24, 16];
/// How far beyond a face neighbours have a say in F, in nodes.
pub(super) const BLEND: u32 = 8;
/// How far beyond its own nodes a tile is extracted, in nodes, so that what is beside a face is seen from both sides.
pub(super) const CONTEXT: u32 = 12;
/// How far beyond a face all points of a neighbour are read, in nodes: the halo, rounded up to a block.
const FULL: u32 = 40;

/// How far a tile reaches into one that holds no points, in nodes.
const FRINGE: u32 = 4;

/// The lattice of all tiles.
pub(super) struct Layout {
    pub(super) lattice: Lattice,
    pub(super) frame: Frame,
    /// The finest level that is solved for the whole.
    pub(super) coarse: u32,
    /// The offset, upright.
    offset: [f64; 3],
    side: f64,
}

/// The finest level that is solved for the whole: the finest of at most [`MOST_COARSE_NODES`] across, but at least one is left for tiles.
fn coarse_level(finest: u32, width: u32) -> u32 {
    (0..finest).rev().find(|&level| width >> (finest - level) <= MOST_COARSE_NODES).unwrap_or(0)
}

impl Layout {
    pub(super) fn new(plan: &TilePlan) -> Result<Self, ReconstructError> {
        let frame = Frame::new(plan.report.up, plan.report.scene);
        let (low, high) = crate::domain::bounds(plan.bounds.into_iter().map(|corner| frame.enter(corner)));
        let lattice = Lattice::around(low, high, plan.report.resolution, FitParams::PADDING_REL)
            .map_err(crate::fit::cascade::FitError::from)?;
        let width = lattice.nodes_at(lattice.finest).into_iter().max().unwrap_or(0);
        let coarse = coarse_level(lattice.finest, width);
        let offset = plan.report.up.upright(plan.world_from_local);
        Ok(Self { lattice, frame, coarse, offset, side: plan.side })
    }

    /// The first node along x and y that is a tile's own, and the one after the last.
    pub(super) fn own(&self, tile: TileId) -> [[u32; 2]; 2] {
        let extent = self.lattice.nodes_at(self.lattice.finest);
        let at = |index: [i64; 2]| -> [u32; 2] {
            std::array::from_fn(|a| {
                let face = index[a] as f64 * self.side - self.offset[a];
                let node = ((face - self.lattice.origin[a]) / self.lattice.spacing).ceil();
                node.clamp(0.0, f64::from(extent[a])) as u32
            })
        };
        let index = [i64::from(tile.x), i64::from(tile.y)];
        [at(index), at(index.map(|i| i + 1))]
    }

    /// Whether what begins at a node is extracted as a tile's own: in the tile, and a little beyond it where there is no other. Each node is of one
    /// tile at most.
    pub(super) fn owns(&self, tile: TileId, tiles: &[TileId]) -> impl Fn([u32; 2]) -> bool + Sync + use<> {
        let own = self.own(tile);
        let is_there = |id: TileId| tiles.binary_search(&id).is_ok();
        // Rectangles of nodes of tiles that are not there, each with those who may have them, in order, and how far these reach into it.
        let fringes: Vec<([[u32; 2]; 2], Vec<TileId>)> = tile
            .around()
            .filter(|&other| !is_there(other))
            .map(|other| (self.own(other), other.around().filter(|&id| is_there(id)).collect()))
            .collect();
        let ids: Vec<TileId> = tile.around().filter(|&other| !is_there(other)).collect();
        move |node| {
            let is_in = |[first, last]: [[u32; 2]; 2]| (0..2).all(|a| (first[a]..last[a]).contains(&node[a]));
            if is_in(own) {
                return true;
            }
            let Some(i) = fringes.iter().position(|(nodes, _)| is_in(*nodes)) else { return false };
            let ([first, last], owners) = &fringes[i];
            let is_near = |owner: &&TileId| {
                let steps = [owner.x - ids[i].x, owner.y - ids[i].y];
                (0..2).all(|a| match steps[a] {
                    -1 => node[a] - first[a] < FRINGE,
                    1 => last[a] - node[a] <= FRINGE,
                    _ => true,
                })
            };
            owners.iter().find(is_near) == Some(&tile)
        }
    }

    /// Nodes up to so many beyond a tile's own.
    pub(super) fn grown(&self, tile: TileId, by: u32) -> [[u32; 2]; 2] {
        let [first, last] = self.own(tile);
        [first.map(|n| n.saturating_sub(by)), last.map(|n| n + by)]
    }

    /// Where a tile is fitted.
    pub(super) fn region(&self, tile: TileId) -> Region {
        let finest = self.lattice.finest;
        Region::around(&self.lattice, self.own(tile), |level| HALO[((finest - level) as usize).min(HALO.len() - 1)])
    }

    /// How far beyond its own nodes of the finest level anything of a tile is felt while it is fitted, at most.
    pub(super) fn reach(&self) -> u32 {
        let coarsest = self.lattice.finest - self.coarse - 1;
        let halo = |k: u32| (HALO[(k as usize).min(HALO.len() - 1)] + 8) << k;
        (0..=coarsest).map(halo).max().unwrap_or(FULL).max(FULL)
    }

    /// Rings of columns around a tile's own, from within: how many nodes they reach beyond them, up to `reach`, and how far the points in them are
    /// thinned.
    pub(super) fn rings(&self, reach: u32) -> Vec<(u32, u32)> {
        let mut rings = vec![(FULL.min(reach), 0)];
        while let Some(&(last, thinning)) = rings.last()
            && last < reach
        {
            rings.push(((2 * last).min(reach), (thinning + 1).min(self.lattice.finest - self.coarse)));
        }
        rings
    }

    /// Positions in the frame of the fit from `by` nodes before a tile's own to `by` after them.
    pub(super) fn rectangle(&self, tile: TileId, by: f64) -> [[f64; 2]; 2] {
        let h = self.lattice.spacing;
        let [first, last] = self.own(tile);
        let at = |n: [u32; 2], by: f64| std::array::from_fn(|a| self.lattice.origin[a] + h * (f64::from(n[a]) + by));
        [at(first, -by), at(last, by)]
    }

    /// The tiles that a rectangle in the frame of the fit meets.
    pub(super) fn tiles_in(&self, [low, high]: [[f64; 2]; 2]) -> impl Iterator<Item = TileId> + use<> {
        let index =
            |p: [f64; 2]| -> [i32; 2] { std::array::from_fn(|a| ((p[a] + self.offset[a]) / self.side).floor() as i32) };
        let (first, last) = (index(low), index(high));
        (first[1]..=last[1]).flat_map(move |y| (first[0]..=last[0]).map(move |x| TileId { x, y }))
    }

    /// The raster that vertices of all tiles lie on: relative to the middle of a tile single precision holds positions as far off as the tile is wide, and
    /// half as far again.
    pub(super) fn raster(&self) -> Raster {
        Raster::up_to(self.side)
    }
}
