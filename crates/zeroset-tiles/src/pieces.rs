//! Small pieces of the surface, which may go on in a neighbouring tile.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use zeroset::mesh::Mesh;
use zeroset::tile::TileMesh;

/// A piece of a tile's surface with shared vertices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Piece {
    /// Triangles.
    pub(crate) triangles: u64,
    /// What its shared vertices are called. A large piece has many: of these only one in each place is of use.
    pub(crate) keys: Vec<[u64; 3]>,
}

/// The piece of each vertex, and the triangles of each.
fn numbered(mesh: &Mesh) -> (Vec<u32>, Vec<u64>) {
    let mut parent: Vec<u32> = (0..mesh.vertices.len() as u32).collect();
    fn root(parent: &mut [u32], mut v: u32) -> u32 {
        while parent[v as usize] != v {
            parent[v as usize] = parent[parent[v as usize] as usize];
            v = parent[v as usize];
        }
        v
    }
    for &[a, b, c] in &mesh.triangles {
        for other in [b, c] {
            let (x, y) = (root(&mut parent, a), root(&mut parent, other));
            parent[x.max(y) as usize] = x.min(y);
        }
    }
    let roots: Vec<u32> = (0..parent.len() as u32).map(|v| root(&mut parent, v)).collect();
    let mut triangles = vec![0; roots.len()];
    mesh.triangles.iter().for_each(|t| triangles[roots[t[0] as usize] as usize] += 1);
    (roots, triangles)
}

/// The pieces of a tile that others may go on with, in order.
pub(crate) fn pieces(tile: &TileMesh) -> Vec<Piece> {
    let (roots, triangles) = numbered(&tile.mesh);
    let mut pieces: BTreeMap<u32, Piece> = BTreeMap::new();
    for &(v, key) in &tile.shared {
        let root = roots[v as usize];
        let new = Piece { triangles: triangles[root as usize], keys: Vec::new() };
        pieces.entry(root).or_insert(new).keys.push(key);
    }
    pieces.into_values().collect()
}

/// Drops the pieces of fewer than `least` triangles, those in the tiles around counted.
pub(crate) fn drop_small(tile: &mut TileMesh, around: &[Vec<Piece>], least: u64) {
    let mut of_key: FxHashMap<[u64; 3], Vec<usize>> = FxHashMap::default();
    let all: Vec<&Piece> = around.iter().flatten().collect();
    for (i, piece) in all.iter().enumerate() {
        piece.keys.iter().for_each(|key| of_key.entry(*key).or_default().push(i));
    }
    let (roots, triangles) = numbered(&tile.mesh);
    let mut keys: FxHashMap<u32, Vec<[u64; 3]>> = FxHashMap::default();
    tile.shared.iter().for_each(|(v, key)| keys.entry(roots[*v as usize]).or_default().push(*key));
    // What goes on in other tiles, and there in others again, until it is clear that it is large.
    let is_small = |root: u32| {
        let mut total = triangles[root as usize];
        let mut seen = vec![false; all.len()];
        let mut open: Vec<[u64; 3]> = keys.get(&root).cloned().unwrap_or_default();
        while total < least {
            let Some(key) = open.pop() else { return true };
            for &i in of_key.get(&key).into_iter().flatten() {
                if !std::mem::replace(&mut seen[i], true) {
                    total += all[i].triangles;
                    open.extend_from_slice(&all[i].keys);
                }
            }
        }
        false
    };
    let mut small: FxHashMap<u32, bool> = FxHashMap::default();
    let TileMesh { mesh, shared } = tile;
    mesh.triangles.retain(|t| {
        let root = roots[t[0] as usize];
        !*small.entry(root).or_insert_with(|| is_small(root))
    });
    // The others are numbered anew.
    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    if used.iter().all(|used| *used) {
        return;
    }
    let mut next = 0;
    let number: Vec<u32> = used
        .iter()
        .map(|&used| {
            next += u32::from(used);
            next.wrapping_sub(1)
        })
        .collect();
    mesh.triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
    shared.retain(|(v, _)| used[*v as usize]);
    shared.iter_mut().for_each(|(v, _)| *v = number[*v as usize]);
    let mut keep = used.iter();
    mesh.vertices.retain(|_| keep.next().copied().unwrap_or(false));
    mesh.attributes.retain(&used);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strip(triangles: u32, shared: Vec<(u32, [u64; 3])>) -> TileMesh {
        let vertices = (0..triangles + 2).map(|i| [f64::from(i / 2), f64::from(i % 2), 0.0]).collect();
        let triangles = (0..triangles).map(|i| [i, i + 1, i + 2]).collect();
        TileMesh { mesh: Mesh { vertices, triangles, ..Mesh::default() }, shared }
    }

    #[test]
    fn a_piece_counts_with_what_goes_on_next_door() {
        let tile = strip(4, vec![(0, [7, 0, 0])]);
        let left = |around: &[Vec<Piece>], least| {
            let mut own = tile.clone();
            drop_small(&mut own, around, least);
            (own.mesh.triangles.len(), own.mesh.vertices.len(), own.shared.len())
        };
        assert_eq!(left(&[], 4), (4, 6, 1));
        assert_eq!(left(&[], 5), (0, 0, 0));
        let next_door = pieces(&strip(3, vec![(1, [7, 0, 0]), (4, [8, 0, 0])]));
        assert_eq!(next_door, [Piece { triangles: 3, keys: vec![[7, 0, 0], [8, 0, 0]] }]);
        assert_eq!(left(std::slice::from_ref(&next_door), 7), (4, 6, 1));
        assert_eq!(left(std::slice::from_ref(&next_door), 8), (0, 0, 0));
        let further = pieces(&strip(9, vec![(2, [8, 0, 0])]));
        assert_eq!(left(&[next_door, further], 16), (4, 6, 1));
    }
}
