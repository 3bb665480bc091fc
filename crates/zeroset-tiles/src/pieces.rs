//! Small pieces of the surface, which may go on in a neighbouring tile.

use std::collections::BTreeMap;

use rustc_hash::FxHashMap;
use serde::{Deserialize, Serialize};
use zeroset::mesh::Components;
use zeroset::tile::TileMesh;

/// A piece of a tile's surface with shared vertices.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Piece {
    /// Triangles.
    pub(crate) triangles: u64,
    /// What its shared vertices are called. A large piece has many: of these only one in each place is of use.
    pub(crate) keys: Vec<[u64; 3]>,
}

/// The pieces of a tile that others may go on with, in order.
pub(crate) fn pieces(tile: &TileMesh) -> Vec<Piece> {
    let own = Components::of(&tile.mesh);
    let mut pieces: BTreeMap<u32, Piece> = BTreeMap::new();
    for &(v, key) in &tile.shared {
        let piece = own.of_vertex[v as usize];
        let new = Piece { triangles: own.triangles[piece as usize] as u64, keys: Vec::new() };
        pieces.entry(piece).or_insert(new).keys.push(key);
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
    let own = Components::of(&tile.mesh);
    let mut keys: FxHashMap<u32, Vec<[u64; 3]>> = FxHashMap::default();
    tile.shared.iter().for_each(|(v, key)| keys.entry(own.of_vertex[*v as usize]).or_default().push(*key));
    // What goes on in other tiles, and there in others again, until it is clear that it is large.
    let is_small = |piece: u32| {
        let mut total = own.triangles[piece as usize] as u64;
        let mut seen = vec![false; all.len()];
        let mut open: Vec<[u64; 3]> = keys.get(&piece).cloned().unwrap_or_default();
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
    for [vertex, ..] in &tile.mesh.triangles {
        let piece = own.of_vertex[*vertex as usize];
        small.entry(piece).or_insert_with(|| is_small(piece));
    }
    if small.values().any(|small| *small) {
        // What has no triangles is of no piece, and goes, too.
        let number = own.drop_from(&mut tile.mesh, |piece| small.get(&piece).copied().unwrap_or(true));
        tile.shared.retain_mut(|(v, _)| match number[*v as usize] {
            Some(new) => {
                *v = new;
                true
            }
            None => false,
        });
    }
}

#[cfg(test)]
mod tests {
    use zeroset::mesh::Mesh;

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
