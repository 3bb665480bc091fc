//! All steps in memory, one after the other.

use super::{Measurement, Strip, TileFit, TileId, TileMesh, TilePlan, merge};
use crate::cloud::Cloud;
use crate::mesh::{Mesh, drop_small_components, simplify};
use crate::monitor::{Monitor, Part};
use crate::reconstruct::{ReconstructError, ReconstructParams};
use std::collections::BTreeMap;

/// Reconstructs a cloud in tiles of a side, and joins them. For a cloud that fits into memory [`plan`](crate::reconstruct::plan) is faster: this is how the steps
/// fit together.
///
/// # Errors
/// As for [`TilePlan::new`], if no surface is found, or if the monitor asks to stop.
pub fn reconstruct(
    cloud: &Cloud,
    side: f64,
    params: &ReconstructParams,
    monitor: &dyn Monitor,
) -> Result<(Mesh, TilePlan), ReconstructError> {
    let up = params.up;
    let offset = up.upright(cloud.world_from_local);
    let mut places: BTreeMap<TileId, Vec<bool>> = BTreeMap::new();
    for (i, &p) in cloud.points.iter().enumerate() {
        let tile = TileId::of(up.upright(p), offset, side);
        places.entry(tile).or_insert_with(|| vec![false; cloud.len()])[i] = true;
    }
    let bounds = crate::domain::bounds(cloud.points.iter().copied()).into();
    let tiles = places.keys().copied().collect();
    let plan = TilePlan::new(Measurement { points: cloud.len(), bounds, sample: cloud, tiles }, side, params)?;
    let mut sorted: BTreeMap<(TileId, u32), Cloud> = BTreeMap::new();
    for (&tile, keep) in &places {
        let mut own = cloud.clone();
        crate::cloud::retain(&mut own, keep);
        for thinning in 1..=plan.coarsest_thinning() {
            sorted.insert((tile, thinning), plan.thin(&own, thinning)?);
        }
        sorted.insert((tile, 0), own);
    }
    drop(places);
    let load = |tile: TileId, thinning: u32| -> Result<Cloud, ReconstructError> {
        Ok(sorted.get(&(tile, thinning)).cloned().unwrap_or_default())
    };
    let mut thinned = Cloud { world_from_local: cloud.world_from_local, ..Cloud::default() };
    for &tile in &plan.tiles {
        thinned.append(load(tile, plan.coarse_thinning())?);
    }
    let (coarse, _) = plan.coarse(&thinned, &params.constraints, &())?;
    let count = plan.tiles.len() as f64;
    let part = |i: usize, of: f64| Part::new(monitor, of + 0.5 * i as f64 / count..of + 0.5 * (i + 1) as f64 / count);
    let mut fits: BTreeMap<TileId, (TileFit, Strip)> = BTreeMap::new();
    for (i, &tile) in plan.tiles.iter().enumerate() {
        if let Some((fit, _)) = plan.fit(tile, &coarse, &params.constraints, load, &part(i, 0.0))? {
            let strip = plan.strip(tile, &fit)?;
            fits.insert(tile, (fit, strip));
        }
    }
    let mut meshes: Vec<TileMesh> = Vec::with_capacity(fits.len());
    for (i, (&tile, (fit, _))) in fits.iter().enumerate() {
        let strips: Vec<(TileId, &Strip)> =
            plan.neighbors(tile).filter_map(|other| Some((other, &fits.get(&other)?.1))).collect();
        meshes.push(plan.mesh(tile, fit, &strips, load, &part(i, 0.5))?.0);
    }
    let mut mesh = merge(meshes);
    mesh.crs.clone_from(&cloud.crs);
    if let Some(least) = plan.report.min_component {
        drop_small_components(&mut mesh, least);
    }
    // Here the whole is at hand.
    if let Some(params) = &plan.report.simplify {
        mesh = simplify(&mesh, params, &())?.0;
    }
    if mesh.triangles.is_empty() {
        return Err(ReconstructError::NoSurface);
    }
    Ok((mesh, plan))
}
