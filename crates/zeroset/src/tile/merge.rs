//! Tiles as one mesh.

use rustc_hash::FxHashMap;

use super::TileMesh;
use crate::contour::split_fans;
use crate::mesh::Mesh;

/// Joins tiles at the vertices that they share.
#[must_use]
pub fn merge(tiles: impl IntoIterator<Item = TileMesh>) -> Mesh {
    let mut whole = Mesh::default();
    let mut numbers: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let mut is_shared = Vec::new();
    for TileMesh { mesh, shared } in tiles {
        if whole.vertices.is_empty() {
            whole.world_from_local = mesh.world_from_local;
            whole.crs.clone_from(&mesh.crs);
        }
        let first = whole.vertices.len() as u32;
        let mut number: Vec<u32> = (first..first + mesh.vertices.len() as u32).collect();
        is_shared.resize(number.len() + is_shared.len(), false);
        for (v, key) in shared {
            let own = first + v;
            let joined = *numbers.entry(key).or_insert(own);
            number[v as usize] = joined;
            is_shared[joined as usize] = true;
        }
        whole.vertices.extend_from_slice(&mesh.vertices);
        whole.attributes.append(mesh.attributes, first as usize);
        whole.triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|v| number[v as usize])));
    }
    // A trim may have left two fans at a shared vertex.
    let (_, old) = split_fans(&mut whole, &is_shared);
    whole.attributes = whole.attributes.picked(&old);
    whole
}
