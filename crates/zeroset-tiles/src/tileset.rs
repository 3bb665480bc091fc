//! Tiles as files for others: GLB with a 3D Tiles `tileset.json`, PLY, or models; and their outlines as GeoJSON.
//!
//! # Placement
//! A tileset stands on the globe if the reference system of the points can be placed there: each vertex is, and its place is told in metres east, north and up of the
//! middle of all tiles, which the transform of the root takes to EPSG:4978. Else it stands in the local coordinates of the plan, and the transform is their offset.
//!
//! Vertices of all tiles lie on one raster, whose step is a power of two, and so do the middles of tiles. In a GLB positions are single precision relative to the
//! middle, which they hold exactly, and the middle is the translation of a node. So what two tiles share is equal bit for bit in world coordinates, too.
//!
//! Squares of tiles keep to the same raster up to level 2, or 1 where a tile is hardly shorter than a power of two. A wider square has a raster twice as coarse as
//! the level below: what squares of one level share is still equal bit for bit, and levels differ by half a step at most.
//!
//! # Levels
//! A tree of tiles that replace one another: a square of tiles has the squares of the level below as children, and the first level has tiles. The geometric error of
//! a square is a bound that adds up over levels, that of a tile is 0.
//!
//! # Source
//! 3D Tiles 1.1, Open Geospatial Consortium 22-025r4. GeoJSON: RFC 7946, but in the reference system of the input.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use zeroset::mesh::Mesh;
use zeroset::tile::{Node, NodeId, TileId, TilePlan};
use zeroset_io::{WriteOptions, write_mesh, write_model};

use crate::folder::{create, write_json};
use crate::placement::{Placement, box_of};
use crate::{Folder, LevelEntry, Sorted, TileFormat, TilesError, Written};

/// A tile that was written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TileEntry {
    /// Which.
    pub id: TileId,
    /// Its file, relative to the folder.
    pub file: String,
    /// Triangles.
    pub triangles: u64,
    /// Its box in local coordinates of the plan.
    pub bounds: [[f64; 3]; 2],
    /// Its box in coordinates of the tileset, for GLB.
    pub volume: [[f64; 3]; 2],
}

/// A surface that was written.
pub(crate) struct Surface {
    /// Triangles.
    pub(crate) triangles: u64,
    /// Its box in local coordinates of the plan.
    pub(crate) bounds: [[f64; 3]; 2],
    /// Its box in coordinates of the tileset.
    pub(crate) volume: [[f64; 3]; 2],
}

impl Folder {
    /// Writes the surface of a tile; `None` if it has none. It and its neighbours must be extracted, and it simplified if the plan asks for it.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn write_tile(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        tile: TileId,
        format: TileFormat,
    ) -> Result<Option<TileEntry>, TilesError> {
        let mesh = self.surface(sorted, plan, tile)?.mesh;
        let file = format!("tiles/{tile}.{}", format.suffix());
        let written = match format {
            TileFormat::Zset => self.write_model(sorted, plan, tile, (mesh, &file))?,
            TileFormat::Glb | TileFormat::Ply => {
                self.write_surface(sorted, plan, &tile.into(), (mesh, &file), format)?
            }
        };
        Ok(written.map(|Surface { triangles, bounds, volume }| TileEntry { id: tile, file, triangles, bounds, volume }))
    }

    /// Writes the model of a tile that has a surface.
    fn write_model(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        tile: TileId,
        (mesh, file): (Mesh, &str),
    ) -> Result<Option<Surface>, TilesError> {
        let Some(model) = self.model(sorted, plan, tile)?.filter(|_| !mesh.triangles.is_empty()) else {
            return Ok(None);
        };
        let path = self.path().join(file);
        path.parent().map_or(Ok(()), create)?;
        write_model(&path, &model)?;
        let bounds = box_of(&mesh);
        Ok(Some(Surface { triangles: mesh.triangles.len() as u64, bounds, volume: bounds }))
    }

    /// Writes the surface of a square of tiles; `None` if it has none.
    pub(crate) fn write_surface(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        node: &Node,
        (mut mesh, file): (Mesh, &str),
        format: TileFormat,
    ) -> Result<Option<Surface>, TilesError> {
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        plan.put_on_raster(node.id.level, 1.0, &mut mesh.vertices);
        let bounds = box_of(&mesh);
        let triangles = mesh.triangles.len() as u64;
        let placed = match format {
            TileFormat::Glb => Placement::of(sorted, plan).place(plan, node, mesh, bounds)?,
            TileFormat::Ply | TileFormat::Zset => Mesh { world_from_local: plan.world_from_local, ..mesh },
        };
        let options = WriteOptions { resolution: Some(plan.report.resolution), ..WriteOptions::default() };
        let path = self.path().join(file);
        path.parent().map_or(Ok(()), create)?;
        write_mesh(&path, &placed, &options)?;
        let volume = box_of(&placed).map(|corner| std::array::from_fn(|a| corner[a] + placed.world_from_local[a]));
        Ok(Some(Surface { triangles, bounds, volume }))
    }

    /// Writes what lists the tiles that were written, last of all. Levels of detail must be there for GLB.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn write_lists(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        mut entries: Vec<TileEntry>,
        format: TileFormat,
    ) -> Result<Written, TilesError> {
        entries.sort_by_key(|entry| entry.id);
        write_json(&self.path().join("tiles.json"), &outlines(sorted, plan, &entries))?;
        let mut levels = Vec::new();
        if format == TileFormat::Glb {
            levels = self.level_entries(plan)?;
            write_json(
                &self.path().join("tileset.json"),
                &tileset(&Placement::of(sorted, plan), plan, &entries, &levels),
            )?;
        }
        let written = Written { tiles: entries, levels };
        write_json(&self.done_at(), &written)?;
        Ok(written)
    }
}

/// The outlines of the tiles as GeoJSON, in world coordinates.
fn outlines(sorted: &Sorted, plan: &TilePlan, entries: &[TileEntry]) -> Value {
    let points = |id: TileId| sorted.tiles.iter().find(|tile| tile.id == id).map_or(0, |tile| tile.points);
    let feature = |entry: &TileEntry| {
        let [low, high] = plan.outline(entry.id);
        let ring = [low, [high[0], low[1]], high, [low[0], high[1]], low];
        json!({
            "type": "Feature",
            "id": entry.id.to_string(),
            "geometry": { "type": "Polygon", "coordinates": [ring] },
            "properties": {
                "file": entry.file,
                "triangles": entry.triangles,
                "points": points(entry.id),
                "lowest": entry.bounds[0][2] + plan.world_from_local[2],
                "highest": entry.bounds[1][2] + plan.world_from_local[2],
            },
        })
    };
    let mut collection = json!({
        "type": "FeatureCollection",
        "features": entries.iter().map(feature).collect::<Vec<Value>>(),
    });
    if let Some(crs) = &sorted.crs {
        collection["crs_wkt"] = json!(crs);
    }
    collection
}

/// A place in the tree of a tileset.
struct Branch {
    /// The box of all that is below, and of what is shown here.
    bounds: [[f64; 3]; 2],
    error: f64,
    value: Value,
}

impl Branch {
    /// What shows a file, or nothing, in place of its children.
    fn new(shown: Option<(&str, [[f64; 3]; 2])>, error: f64, children: Vec<Self>, least: f64) -> Self {
        let boxes = children.iter().map(|child| child.bounds).chain(shown.map(|(_, bounds)| bounds));
        let bounds = boxes.fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |[low, high], [l, h]| {
            [std::array::from_fn(|a| low[a].min(l[a])), std::array::from_fn(|a| high[a].max(h[a]))]
        });
        // Nothing is nearer to the truth than what it is made of.
        let error = children.iter().map(|child| child.error).fold(error, f64::max);
        let mut value = json!({ "boundingVolume": volume(bounds, least), "geometricError": error });
        if let Some((file, _)) = shown {
            value["content"] = json!({ "uri": file });
        }
        if !children.is_empty() {
            value["children"] = children.into_iter().map(|child| child.value).collect();
        }
        Self { bounds, error, value }
    }
}

/// A box with half sides of at least a length, which is also what it is larger than asked for.
fn volume([low, high]: [[f64; 3]; 2], least: f64) -> Value {
    let middle: [f64; 3] = std::array::from_fn(|a| 0.5 * (low[a] + high[a]));
    let half: [f64; 3] = std::array::from_fn(|a| 0.5 * (high[a] - low[a]) + least);
    json!({ "box": [
        middle[0], middle[1], middle[2], half[0], 0.0, 0.0, 0.0, half[1], 0.0, 0.0, 0.0, half[2],
    ]})
}

/// The tileset: a tree of the files.
fn tileset(placement: &Placement, plan: &TilePlan, tiles: &[TileEntry], levels: &[LevelEntry]) -> Value {
    let least = 1e-3 * plan.report.resolution * placement.unit();
    let leaf =
        |tile: &TileEntry| (tile.id.into(), Branch::new(Some((&tile.file, tile.volume)), 0.0, Vec::new(), least));
    let mut branches: BTreeMap<NodeId, Branch> = tiles.iter().map(leaf).collect();
    let shown: BTreeMap<NodeId, &LevelEntry> = levels.iter().map(|entry| (entry.id, entry)).collect();
    for node in plan.levels().into_iter().flatten() {
        let children: Vec<Branch> = node.children.iter().filter_map(|child| branches.remove(child)).collect();
        if !children.is_empty() {
            let entry = shown.get(&node.id);
            let content = entry.map(|entry| (entry.file.as_str(), entry.volume));
            let error = entry.map_or(0.0, |entry| entry.error * placement.unit());
            branches.insert(node.id, Branch::new(content, error, children, least));
        }
    }
    // Without its content nothing is seen of the whole.
    let size = |[low, high]: [[f64; 3]; 2]| (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let mut roots: Vec<Branch> = branches.into_values().collect();
    let root = match roots.pop() {
        Some(only) if roots.is_empty() && !levels.is_empty() => only,
        last => {
            roots.extend(last);
            let error = roots.iter().map(|root| size(root.bounds)).fold(0.0, f64::max);
            Branch::new(None, error, roots, least)
        }
    };
    let error = size(root.bounds).max(root.error);
    let mut value = root.value;
    value["transform"] = json!(placement.transform(plan));
    value["refine"] = json!("REPLACE");
    json!({
        "asset": { "version": "1.1", "generator": WriteOptions::default().generator },
        "geometricError": error,
        "root": value,
    })
}
