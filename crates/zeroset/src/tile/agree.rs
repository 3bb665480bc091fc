//! F made the same where tiles overlap.

use rayon::prelude::*;

use super::layout::{BLEND, CONTEXT, Layout};
use super::{TileFit, TileId, TilePlan};
use crate::domain::{BLOCK_NODES, Blocks, Mask, mask_get, mask_set};
use crate::field::LatticeField;
use crate::model::Fitted;
use crate::reconstruct::ReconstructError;

/// How far on either side of the faces of a tile its neighbours see its F, in nodes.
const STRIP: u32 = 16;

/// F of a tile beside its faces: what its neighbours need of it.
#[derive(Debug, Clone)]
pub struct Strip(LatticeField);

impl Strip {
    /// The strip of a tile that is kept.
    #[must_use]
    pub fn new(field: LatticeField) -> Self {
        Self(field)
    }

    /// F on the nodes of the strip.
    #[must_use]
    pub fn field(&self) -> &LatticeField {
        &self.0
    }
}

impl TilePlan {
    /// F of a fitted tile beside its faces.
    ///
    /// # Errors
    /// If the plan's lattice cannot be made.
    pub fn strip(&self, tile: TileId, fit: &TileFit) -> Result<Strip, ReconstructError> {
        let layout = Layout::new(self)?;
        let (own, outer) = (layout.own(tile), layout.grown(tile, STRIP));
        // Blocks that lie neither beyond the strip nor within its inner side.
        let is_near = |c: &[u32; 3]| {
            let first = [8 * c[0], 8 * c[1]];
            let meets = (0..2).all(|a| first[a] < outer[1][a] && first[a] + 8 > outer[0][a]);
            let inner = (0..2).all(|a| first[a] >= own[0][a] + STRIP && first[a] + 8 + STRIP <= own[1][a]);
            meets && !inner
        };
        let field = fit.fitted().lattice();
        let near: Vec<usize> = (0..field.blocks.len()).filter(|&b| is_near(&field.blocks.coordinates[b])).collect();
        Ok(Strip(LatticeField::new(
            field.lattice.clone(),
            Blocks::new(near.iter().map(|&b| field.blocks.keys[b]).collect(), field.blocks.extent),
            near.iter().map(|&b| field.known[b]).collect(),
            near.iter().flat_map(|&b| &field.values[BLOCK_NODES * b..BLOCK_NODES * (b + 1)]).copied().collect(),
        )))
    }

    /// The model of a tile, which is its neighbours' where they meet: F in the tile and 14 nodes beyond its faces, with what the points show.
    /// `strips` are those of the neighbours that were fitted.
    ///
    /// # Errors
    /// If the plan's lattice cannot be made.
    pub fn model(&self, tile: TileId, fit: &TileFit, strips: &[(TileId, &Strip)]) -> Result<Fitted, ReconstructError> {
        let field = self.agreed(&Layout::new(self)?, tile, fit, strips);
        Ok(Fitted::kept(field, fit.fitted().parts().clone())?)
    }

    /// F of a tile and what is beside it, the same in all tiles where they share a vertex: the mean of those that know it, by weights that go
    /// from one to zero across a face.
    pub(super) fn agreed(
        &self,
        layout: &Layout,
        tile: TileId,
        fit: &TileFit,
        strips: &[(TileId, &Strip)],
    ) -> LatticeField {
        let own = fit.fitted().lattice();
        let mut sources: Vec<Source<'_>> = strips
            .iter()
            .map(|&(id, strip)| Source { tile: id, field: strip.field(), own: layout.own(id) })
            .chain([Source { tile, field: own, own: layout.own(tile) }])
            .collect();
        sources.sort_by_key(|source| source.tile);
        let [first, last] = layout.grown(tile, CONTEXT + 2);
        let is_near = |c: &[u32; 3]| (0..2).all(|a| 8 * c[a] < last[a] && 8 * c[a] + 8 > first[a]);
        let mut keys: Vec<u64> = sources
            .iter()
            .flat_map(|source| source.field.blocks.keys.iter().zip(&source.field.blocks.coordinates))
            .filter(|(_, c)| is_near(c))
            .map(|(key, _)| *key)
            .collect();
        keys.par_sort_unstable();
        keys.dedup();
        let blocks = Blocks::new(keys, own.blocks.extent);
        let parts: Vec<(Mask, Vec<f32>)> =
            blocks.coordinates.par_iter().with_min_len(8).map(|&c| mixed(c, &sources, tile)).collect();
        let (known, values): (Vec<Mask>, Vec<Vec<f32>>) = parts.into_iter().unzip();
        LatticeField::new(own.lattice.clone(), blocks, known, values.concat())
    }
}

/// F of a tile, and the nodes that are its own.
struct Source<'a> {
    tile: TileId,
    field: &'a LatticeField,
    own: [[u32; 2]; 2],
}

impl Source<'_> {
    /// The weight of this tile at eight nodes along an axis.
    fn weights(&self, block: [u32; 3], axis: usize) -> [f32; 8] {
        let [first, last] = [self.own[0][axis], self.own[1][axis]].map(i64::from);
        std::array::from_fn(|i| {
            let node = i64::from(8 * block[axis]) + i as i64;
            // The face lies half a node before the first own node, so opposite weights make up one.
            let inside = (2 * (node - first) + 1).min(2 * (last - node) - 1) as f32;
            (0.5 + inside / (4 * BLEND) as f32).clamp(0.0, 1.0)
        })
    }
}

/// The known nodes and values of a block. Where no tile with a say knows F, it is that of the tile at hand.
fn mixed(block: [u32; 3], sources: &[Source<'_>], tile: TileId) -> (Mask, Vec<f32>) {
    let there: Vec<(&Source<'_>, usize)> =
        sources.iter().filter_map(|source| Some((source, source.field.blocks.find(block)?))).collect();
    let of = |&(source, b): &(&Source<'_>, usize)| (source.field.known[b], b * BLOCK_NODES);
    if let [(source, b)] = there.as_slice() {
        let (known, from) = of(&(source, *b));
        return (known, source.field.values[from..from + BLOCK_NODES].to_vec());
    }
    let weights: Vec<[[f32; 8]; 2]> =
        there.iter().map(|(source, _)| [0, 1].map(|a| source.weights(block, a))).collect();
    let (mut known, mut values) = ([0; 8], vec![0.0; BLOCK_NODES]);
    for (local, value) in values.iter_mut().enumerate() {
        let (x, y) = (local & 7, local >> 3 & 7);
        let (mut sum, mut total) = (0.0_f32, 0.0_f32);
        let mut fallback = None;
        for (source, weight) in there.iter().zip(&weights) {
            let (is_known, from) = of(source);
            let theirs = source.0.field.values[from + local];
            if !mask_get(&is_known, local) {
                continue;
            }
            let weight = weight[0][x] * weight[1][y];
            sum += weight * theirs;
            total += weight;
            if fallback.is_none() || source.0.tile == tile {
                fallback = Some(theirs);
            }
        }
        if total > 0.0 {
            *value = sum / total;
            mask_set(&mut known, local);
        } else if let Some(theirs) = fallback {
            *value = theirs;
            mask_set(&mut known, local);
        } else if let Some((source, b)) = there.iter().find(|(source, _)| source.tile == tile).or(there.first()) {
            *value = source.field.values[b * BLOCK_NODES + local];
        }
    }
    (known, values)
}
