//! Tiles as one mesh.

use rustc_hash::FxHashMap;

use super::TileMesh;
use crate::contour::split_fans;
use crate::mesh::Mesh;

/// Joins tiles at the vertices that they share.
#[must_use]
pub fn merge(tiles: impl IntoIterator<Item = TileMesh>) -> Mesh {
    let (mut whole, numbers) = joined(tiles.into_iter().map(|tile| (tile.mesh, tile.shared)));
    let mut is_shared = vec![false; whole.vertices.len()];
    numbers.into_values().for_each(|v| is_shared[v as usize] = true);
    // A trim may have left two fans at a shared vertex.
    let (_, old) = split_fans(&mut whole, &is_shared);
    whole.attributes = whole.attributes.picked(&old);
    whole
}

/// What vertices are called in several meshes.
pub(super) type Names = Vec<(u32, [u64; 3])>;

/// Joins meshes at the vertices with the same name, and tells their numbers. Copies of them stay behind without triangles.
pub(super) fn joined(parts: impl Iterator<Item = (Mesh, Names)>) -> (Mesh, FxHashMap<[u64; 3], u32>) {
    let mut whole = Mesh::default();
    let mut numbers: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    // One without vertices says nothing of values either.
    for (mesh, names) in parts.filter(|(mesh, _)| !mesh.vertices.is_empty()) {
        if whole.vertices.is_empty() {
            whole.world_from_local = mesh.world_from_local;
            whole.crs.clone_from(&mesh.crs);
        }
        let first = whole.vertices.len() as u32;
        let mut number: Vec<u32> = (first..first + mesh.vertices.len() as u32).collect();
        for (v, key) in names {
            number[v as usize] = *numbers.entry(key).or_insert(first + v);
        }
        whole.vertices.extend_from_slice(&mesh.vertices);
        whole.attributes.append(mesh.attributes, first as usize);
        whole.triangles.extend(mesh.triangles.iter().map(|corners| corners.map(|v| number[v as usize])));
    }
    (whole, numbers)
}
