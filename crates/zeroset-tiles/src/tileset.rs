//! Tiles as files for others: GLB with a 3D Tiles `tileset.json`, or PLY; and their outlines as GeoJSON.
//!
//! # Placement
//! Vertices of all tiles lie on one raster, whose step is a power of two, and so do the middles of tiles. In a GLB positions are single precision relative to the
//! middle, which they hold exactly, and the middle is the translation of a node. So what two tiles share is equal bit for bit in world coordinates, too.
//!
//! # Source
//! 3D Tiles 1.1, Open Geospatial Consortium 22-025r4. GeoJSON: RFC 7946, but in the reference system of the input.

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use zeroset::mesh::Mesh;
use zeroset::tile::{TileId, TilePlan};
use zeroset_io::{WriteOptions, write_mesh};

use crate::folder::{create, write_json};
use crate::{Folder, Sorted, TileFormat, TilesError};

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
}

impl Folder {
    /// Writes the surface of a tile; `None` if it has none. It and its neighbours must be extracted.
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
        let mesh = self.tile_mesh(sorted, plan, tile)?.mesh;
        let file = format!("tiles/{tile}.{}", format.suffix());
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        let bounds = box_of(&mesh);
        let triangles = mesh.triangles.len() as u64;
        let placed = match format {
            TileFormat::Glb => about_middle(mesh, plan.middle(tile, bounds)),
            TileFormat::Ply => Mesh { world_from_local: plan.world_from_local, ..mesh },
        };
        let options = WriteOptions { resolution: Some(plan.report.resolution), ..WriteOptions::default() };
        create(&self.path().join("tiles"))?;
        write_mesh(&self.path().join(&file), &placed, &options)?;
        Ok(Some(TileEntry { id: tile, file, triangles, bounds }))
    }

    /// Writes what lists the tiles that were written, last of all.
    ///
    /// # Errors
    /// If a file cannot be written.
    pub fn write_lists(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        mut entries: Vec<TileEntry>,
        format: TileFormat,
    ) -> Result<Vec<TileEntry>, TilesError> {
        entries.sort_by_key(|entry| entry.id);
        write_json(&self.path().join("tiles.json"), &outlines(sorted, plan, &entries))?;
        if format == TileFormat::Glb {
            write_json(&self.path().join("tileset.json"), &tileset(plan, &entries))?;
        }
        write_json(&self.done_at(), &entries)?;
        Ok(entries)
    }
}

/// A mesh relative to a position, which becomes its offset.
fn about_middle(mut mesh: Mesh, middle: [f64; 3]) -> Mesh {
    mesh.vertices.iter_mut().for_each(|v| *v = std::array::from_fn(|a| v[a] - middle[a]));
    Mesh { world_from_local: middle, ..mesh }
}

fn box_of(mesh: &Mesh) -> [[f64; 3]; 2] {
    let mut bounds = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for v in &mesh.vertices {
        for a in 0..3 {
            bounds[0][a] = bounds[0][a].min(v[a]);
            bounds[1][a] = bounds[1][a].max(v[a]);
        }
    }
    bounds
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

/// The tileset: one tile for each file, in a local frame whose origin is the offset of the plan, with z up.
fn tileset(plan: &TilePlan, entries: &[TileEntry]) -> Value {
    let volume = |[low, high]: [[f64; 3]; 2]| {
        let (middle, half): ([f64; 3], [f64; 3]) = (
            std::array::from_fn(|a| 0.5 * (low[a] + high[a])),
            std::array::from_fn(|a| (0.5 * (high[a] - low[a])).max(1e-3 * plan.report.resolution)),
        );
        json!({ "box": [
            middle[0], middle[1], middle[2], half[0], 0.0, 0.0, 0.0, half[1], 0.0, 0.0, 0.0, half[2],
        ]})
    };
    let whole = entries.iter().fold([[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]], |all, entry| {
        [
            std::array::from_fn(|a| all[0][a].min(entry.bounds[0][a])),
            std::array::from_fn(|a| all[1][a].max(entry.bounds[1][a])),
        ]
    });
    let child = |entry: &TileEntry| {
        json!({
            "boundingVolume": volume(entry.bounds),
            "geometricError": 0.0,
            "content": { "uri": entry.file },
        })
    };
    let [x, y, z] = plan.world_from_local;
    // Without its tiles nothing is seen of the whole.
    let error = (0..3).map(|a| whole[1][a] - whole[0][a]).fold(0.0, f64::max);
    json!({
        "asset": { "version": "1.1", "generator": WriteOptions::default().generator },
        "geometricError": error,
        "root": {
            "transform": [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x, y, z, 1.0],
            "boundingVolume": volume(whole),
            "geometricError": error,
            "refine": "ADD",
            "children": entries.iter().map(child).collect::<Vec<Value>>(),
        },
    })
}
