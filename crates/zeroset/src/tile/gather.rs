//! The points that a tile needs, from those of the tiles around it.

use super::layout::Layout;
use super::{TileId, TilePlan};
use crate::cloud::Cloud;
use crate::vec3::Vec3;

/// The points around a tile.
pub(super) struct Gathered {
    /// All points in the tile and its halo, with their values.
    pub(super) near: Cloud,
    /// Points farther off, thinned, in the frame of the fit.
    pub(super) far: Vec<Vec3>,
}

impl TilePlan {
    /// Collects the points up to `reach` nodes beyond a tile's own. `load` gives those of a tile, thinned.
    pub(super) fn gather<E>(
        &self,
        layout: &Layout,
        tile: TileId,
        reach: u32,
        mut load: impl FnMut(TileId, u32) -> Result<Cloud, E>,
    ) -> Result<Gathered, E> {
        let mut near = Cloud { world_from_local: self.world_from_local, ..Cloud::default() };
        let mut far = Vec::new();
        let mut inner: Option<[[f64; 2]; 2]> = None;
        for (ring, (reach, thinning)) in layout.rings(reach).into_iter().enumerate() {
            let outer = layout.rectangle(tile, f64::from(reach));
            let is_in = |p: Vec3| within(outer, p) && !inner.is_some_and(|inner| within(inner, p));
            for other in layout.tiles_in(outer).filter(|other| self.tiles.binary_search(other).is_ok()) {
                let covered = inner.is_some_and(|[low, high]| {
                    let [first, last] = layout.rectangle(other, 1.0);
                    (0..2).all(|a| low[a] <= first[a] && last[a] <= high[a])
                });
                if covered {
                    continue;
                }
                let mut cloud = load(other, thinning)?;
                let keep: Vec<bool> = cloud.points.iter().map(|&p| is_in(layout.frame.enter(p))).collect();
                if ring > 0 {
                    let kept = cloud.points.iter().zip(&keep).filter(|(_, keep)| **keep);
                    far.extend(kept.map(|(&p, _)| layout.frame.enter(p)));
                } else {
                    crate::cloud::retain_items(&mut cloud.points, &keep);
                    cloud.attributes.retain(&keep);
                    near.append(cloud);
                }
            }
            inner = Some(outer);
        }
        Ok(Gathered { near, far })
    }
}

/// Whether a position lies in a rectangle, seen from above.
fn within([low, high]: [[f64; 2]; 2], p: Vec3) -> bool {
    (0..2).all(|a| low[a] <= p[a] && p[a] < high[a])
}
