//! Levels of detail: squares of tiles as one coarser mesh each.

use serde::{Deserialize, Serialize};
use zeroset::tile::{LevelMesh, Node, NodeId, TileId, TilePlan};

use crate::folder::{create, read_json, write_json};
use crate::mesh::{read_level_mesh, write_level_mesh};
use crate::tileset::Surface;
use crate::{Folder, Sorted, TileFormat, TilesError};

/// A square of tiles that was made.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct LevelEntry {
    /// Which.
    pub id: NodeId,
    /// Its file, relative to the folder.
    pub file: String,
    /// Triangles.
    pub triangles: u64,
    /// Its box in local coordinates of the plan.
    pub bounds: [[f64; 3]; 2],
    /// Its box in coordinates of the tileset.
    pub volume: [[f64; 3]; 2],
    /// No place of it is farther than this from the tiles, in the unit of the points; nor they from it, but for what is narrower than a cell of the level.
    pub error: f64,
}

impl Folder {
    /// Makes a square of tiles, and writes it as GLB; `None` if it has no surface. Its parts must be made: tiles with those around them on the first level, else the squares of the
    /// level below.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn make_level(&self, sorted: &Sorted, plan: &TilePlan, node: &Node) -> Result<Option<LevelEntry>, TilesError> {
        let done = self.level_entry(node.id);
        if done.exists() {
            return read_json(&done);
        }
        let part = |id: &NodeId| self.level_part(sorted, plan, *id);
        let parts = node.children.iter().map(part).collect::<Result<Vec<LevelMesh>, TilesError>>()?;
        let mut made = plan.level(node, parts)?;
        made.mesh.crs.clone_from(&sorted.crs);
        let path = self.level_mesh(node.id);
        path.parent().map_or(Ok(()), create)?;
        write_level_mesh(&path, &made)?;
        // To the tiles as they are written, too.
        let error = made.error + plan.rounding(node.id.level) + plan.rounding(0);
        let file = format!("levels/{}.glb", node.id);
        let entry = self.write_surface(sorted, plan, node, (made.mesh, &file), TileFormat::Glb)?.map(
            |Surface { triangles, bounds, volume }| LevelEntry { id: node.id, file, triangles, bounds, volume, error },
        );
        write_json(&done, &entry)?;
        Ok(entry)
    }

    /// A part of a square.
    fn level_part(&self, sorted: &Sorted, plan: &TilePlan, id: NodeId) -> Result<LevelMesh, TilesError> {
        if id.level > 0 {
            return read_level_mesh(&self.level_mesh(id));
        }
        let tile = TileId { x: id.x, y: id.y };
        let mesh = self.surface(sorted, plan, tile)?;
        let around = self.pieces_around(plan, tile)?;
        Ok(plan.part(mesh, around.iter().map(|pieces| pieces.iter().flat_map(|piece| &piece.keys)))?)
    }

    /// The squares that were made, level by level.
    pub(crate) fn level_entries(&self, plan: &TilePlan) -> Result<Vec<LevelEntry>, TilesError> {
        let mut entries = Vec::new();
        for node in plan.levels().into_iter().flatten() {
            entries.extend(read_json::<Option<LevelEntry>>(&self.level_entry(node.id))?);
        }
        Ok(entries)
    }
}
