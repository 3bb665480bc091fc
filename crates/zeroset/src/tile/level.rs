//! Levels of detail: squares of tiles as one coarser mesh.

use std::collections::BTreeMap;
use std::fmt;

use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};

use super::merge::joined;
use super::{TileId, TileMesh, TilePlan};
use crate::contour::Raster;
use crate::mesh::{Mesh, cluster};
use crate::reconstruct::ReconstructError;

/// Level, column and row of a square of tiles: 2<sup>level</sup> of them along a side, of which the lower left is so many squares from the origin of tiles.
/// Of level 0 are the tiles. Ordered by level, row and column.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct NodeId {
    /// Level.
    pub level: u32,
    /// Column, along x.
    pub x: i32,
    /// Row, along y.
    pub y: i32,
}

impl From<TileId> for NodeId {
    fn from(TileId { x, y }: TileId) -> Self {
        Self { level: 0, x, y }
    }
}

impl Ord for NodeId {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        (self.level, self.y, self.x).cmp(&(other.level, other.y, other.x))
    }
}

impl PartialOrd for NodeId {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl fmt::Display for NodeId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}_{}", self.level, self.x, self.y)
    }
}

/// A square of tiles and what it is made of.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Node {
    /// Which.
    pub id: NodeId,
    /// Its parts, one level below, in order: up to four.
    pub children: Vec<NodeId>,
    /// Column and row of the tile at the lower left of the square.
    first: [i64; 2],
}

impl From<TileId> for Node {
    fn from(tile: TileId) -> Self {
        Self { id: tile.into(), children: Vec::new(), first: [tile.x, tile.y].map(i64::from) }
    }
}

/// A vertex that several tiles have.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shared {
    /// Its number.
    pub vertex: u32,
    /// What it is called in all of them.
    pub key: [u64; 3],
    /// How many tiles have it: of the square, and in all.
    pub tiles: [u32; 2],
}

/// The surface of a square of tiles.
#[derive(Debug, Clone)]
pub struct LevelMesh {
    /// The mesh. Its local coordinates are those of the plan.
    pub mesh: Mesh,
    /// The vertices that tiles beyond the square have, too, ascending.
    pub shared: Vec<Shared>,
    /// No place of the mesh is farther than this from the tiles, in the unit of the points; nor they from it, but for what is narrower than a cell of the level.
    pub error: f64,
}

impl LevelMesh {
    /// The surface of a tile, given what the vertices are called that each of the tiles around shares.
    fn of_tile<'a, K: IntoIterator<Item = &'a [u64; 3]>>(tile: TileMesh, around: impl IntoIterator<Item = K>) -> Self {
        let mut tiles: FxHashMap<[u64; 3], u32> = tile.shared.iter().map(|(_, key)| (*key, 1)).collect();
        for keys in around {
            for key in keys {
                if let Some(count) = tiles.get_mut(key) {
                    *count += 1;
                }
            }
        }
        let shared = |(vertex, key): (u32, [u64; 3])| Shared { vertex, key, tiles: [1, tiles[&key]] };
        Self { shared: tile.shared.into_iter().map(shared).collect(), mesh: tile.mesh, error: 0.0 }
    }

    /// Joins the parts of a square. The vertices that nothing beyond it shares are free.
    fn of_parts(parts: Vec<Self>) -> Self {
        let mut tiles: FxHashMap<[u64; 3], [u32; 2]> = FxHashMap::default();
        for part in &parts {
            // A vertex in which two fans meet may be there twice.
            let own: FxHashMap<[u64; 3], [u32; 2]> = part.shared.iter().map(|s| (s.key, s.tiles)).collect();
            own.into_iter().for_each(|(key, [inside, all])| {
                let [sum, most] = tiles.entry(key).or_default();
                (*sum, *most) = (*sum + inside, all.max(*most));
            });
        }
        let error = parts.iter().map(|part| part.error).fold(0.0, f64::max);
        let named = |part: Self| (part.mesh, part.shared.iter().map(|s| (s.vertex, s.key)).collect());
        let (mesh, names) = joined(parts.into_iter().map(named));
        let shared = names.into_iter().map(|(key, vertex)| Shared { vertex, key, tiles: tiles[&key] });
        let mut shared: Vec<Shared> = shared.filter(|s| s.tiles[0] < s.tiles[1]).collect();
        shared.sort_unstable_by_key(|s| s.vertex);
        Self { mesh, shared, error }
    }
}

/// How far beyond its square the surface of a node may reach, in cells.
const BEYOND: f64 = 16.0;

impl TilePlan {
    /// The squares of tiles that are shown as one, level by level, from level 1 to that of the one square that has all. None for a single tile.
    ///
    /// A square is made of those with half its column and row, rounded down. The last is made of whatever is left, once that is two squares along either side.
    #[must_use]
    pub fn levels(&self) -> Vec<Vec<Node>> {
        let mut levels = Vec::new();
        let mut below: Vec<NodeId> = self.tiles.iter().map(|&tile| tile.into()).collect();
        while below.len() > 1 {
            let first =
                [below.iter().map(|n| n.x).min(), below.iter().map(|n| n.y).min()].map(Option::unwrap_or_default);
            let is_last = below.iter().all(|n| n.x.abs_diff(first[0]) <= 1 && n.y.abs_diff(first[1]) <= 1);
            let level = levels.len() as u32 + 1;
            let mut nodes: BTreeMap<NodeId, Node> = BTreeMap::new();
            for child in below {
                let [x, y] = (if is_last { first } else { [child.x, child.y] }).map(|c| c.div_euclid(2));
                let id = NodeId { level, x, y };
                let corner = if is_last { first.map(i64::from) } else { [x, y].map(|c| 2 * i64::from(c)) };
                let new = || Node { id, children: Vec::new(), first: corner.map(|c| c << (level - 1)) };
                nodes.entry(id).or_insert_with(new).children.push(child);
            }
            below = nodes.keys().copied().collect();
            levels.push(nodes.into_values().collect());
        }
        levels
    }

    /// The surface of a tile as a part of a square: clustered, with cells as wide as the finest. `around` tells of each of the tiles around it what the vertices are
    /// called that it shares.
    ///
    /// # Errors
    /// If the mesh is broken.
    pub fn part<'a, K: IntoIterator<Item = &'a [u64; 3]>>(
        &self,
        tile: TileMesh,
        around: impl IntoIterator<Item = K>,
    ) -> Result<LevelMesh, ReconstructError> {
        self.coarser(0, LevelMesh::of_tile(tile, around))
    }

    /// The surface of a square of tiles out of those of its parts: joined, and clustered with cells 2<sup>level</sup> times as wide as the finest.
    ///
    /// # Errors
    /// If a mesh is broken.
    pub fn level(&self, node: &Node, parts: Vec<LevelMesh>) -> Result<LevelMesh, ReconstructError> {
        self.coarser(node.id.level, LevelMesh::of_parts(parts))
    }

    /// Clusters the vertices of each cell of a level but for those that tiles beyond the square share.
    fn coarser(&self, level: u32, from: LevelMesh) -> Result<LevelMesh, ReconstructError> {
        let LevelMesh { mesh, mut shared, error } = from;
        let held: Vec<u32> = shared.iter().map(|s| s.vertex).collect();
        let cell = self.report.resolution * 2.0_f64.powi(level as i32);
        let clustered = cluster(&mesh, &held, cell)?;
        let mut numbers = clustered.held.iter();
        shared.retain_mut(|s| match numbers.next() {
            Some(Some(number)) => {
                s.vertex = *number;
                true
            }
            _ => false,
        });
        shared.sort_unstable_by_key(|s| s.vertex);
        Ok(LevelMesh { mesh: clustered.mesh, shared, error: error + clustered.moved })
    }

    /// The raster that the files of a level keep to: the finest that single precision holds all over a square, but none finer than that of tiles. A unit of the plan
    /// is so long in coordinates of the files.
    fn raster(&self, level: u32, unit: f64) -> Raster {
        let half = 0.5 * self.side * 2.0_f64.powi(level as i32) + BEYOND * self.report.resolution;
        // Single precision holds twice what a raster is made for.
        Raster::up_to(unit * self.side.max(0.5 * half))
    }

    /// How far putting vertices on the raster of a level moves them at most.
    #[must_use]
    pub fn rounding(&self, level: u32) -> f64 {
        0.5 * 3.0_f64.sqrt() * self.raster(level, 1.0).step()
    }

    /// Puts vertices on the raster of a level. There single precision holds them, relative to the middle of their square; those of tiles are there already, unless they were
    /// simplified, and those that neighbours share go to the same place in both. `unit` is how long a unit of the plan is in their coordinates: 1 in local ones.
    pub fn put_on_raster(&self, level: u32, unit: f64, vertices: &mut [[f64; 3]]) {
        let raster = self.raster(level, unit);
        vertices.iter_mut().for_each(|v| *v = raster.nearest(*v));
    }

    /// The place on the raster of a level that is nearest to a position, in coordinates in which a unit of the plan is so long.
    #[must_use]
    pub fn on_raster(&self, level: u32, unit: f64, position: [f64; 3]) -> [f64; 3] {
        self.raster(level, unit).nearest(position)
    }

    /// The place that positions of a square's surface are told from, in local coordinates: about the middle of its box, and on the raster of its level.
    #[must_use]
    pub fn middle(&self, node: &Node, [low, high]: [[f64; 3]; 2]) -> [f64; 3] {
        let up = self.report.up;
        let offset = up.upright(self.world_from_local);
        let (low, high) = (up.upright(low), up.upright(high));
        let half = 0.5 * 2.0_f64.powi(node.id.level as i32);
        let [x, y] = [0, 1].map(|a| (node.first[a] as f64 + half) * self.side - offset[a]);
        self.raster(node.id.level, 1.0).nearest(up.restore([x, y, 0.5 * (low[2] + high[2])]))
    }
}
