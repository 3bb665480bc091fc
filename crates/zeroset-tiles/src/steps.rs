//! The steps, each from files to a file.

use std::sync::Arc;

use rayon::prelude::*;
use zeroset::cloud::Cloud;
use zeroset::constraint::Constraints;
use zeroset::field::LatticeField;
use zeroset::mesh::{Mesh, drop_small_components};
use zeroset::model::{Fitted, Model, Provenance, Solid};
use zeroset::monitor::Monitor;
use zeroset::reconstruct::{ReconstructError, ReconstructParams};
use zeroset::tile::{Measurement, Strip, TileFit, TileId, TileMesh, TilePlan, merge};
use zeroset_io::{read_model, write_model};

use crate::field::{read_field, write_field};
use crate::folder::{create, read_json, write_json};
use crate::mesh::{read_tile_mesh, write_tile_mesh};
use crate::pieces::{Piece, drop_small, pieces};
use crate::{Folder, Sorted, TilesError};

/// How the surface of each tile is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TileFormat {
    /// GLB, with a `tileset.json` around them.
    #[default]
    Glb,
    /// PLY in world coordinates.
    Ply,
    /// The model of each tile.
    Zset,
}

impl TileFormat {
    /// The suffix of the files.
    #[must_use]
    pub fn suffix(self) -> &'static str {
        match self {
            Self::Glb => "glb",
            Self::Ply => "ply",
            Self::Zset => "zset",
        }
    }
}

impl Folder {
    /// Resolves every default against the points, or reads the plan that is there.
    ///
    /// # Errors
    /// As for [`TilePlan::new`], or if a file cannot be read or written.
    pub fn make_plan(&self, sorted: &Sorted, params: &ReconstructParams) -> Result<TilePlan, TilesError> {
        if let Some(plan) = self.plan()? {
            return Ok(plan);
        }
        let offset = sorted.offset();
        let sample = self.sample(sorted, params.up)?;
        let measured = Measurement {
            points: usize::try_from(sorted.points).unwrap_or(usize::MAX),
            bounds: sorted.bounds.map(|corner| std::array::from_fn(|a| corner[a] - offset[a])),
            sample: &sample,
            tiles: sorted.tiles.iter().map(|tile| tile.id).collect(),
        };
        let plan = TilePlan::new(measured, sorted.side, params)?;
        write_json(&self.plan_at(), &plan)?;
        Ok(plan)
    }

    /// Thins the points of a tile, for coarser levels.
    ///
    /// # Errors
    /// If a file cannot be read or written.
    pub fn thin(&self, sorted: &Sorted, plan: &TilePlan, tile: TileId) -> Result<(), TilesError> {
        let last = plan.coarsest_thinning();
        if last == 0 || self.thinned(tile, last).exists() {
            return Ok(());
        }
        let mut points = self.load(sorted, tile, 0)?;
        for thinning in 1..=last {
            points = plan.thin(&points, thinning)?;
            self.write_thinned(&points, tile, thinning)?;
        }
        Ok(())
    }

    /// Fits the coarse levels of the whole.
    ///
    /// # Errors
    /// If a file cannot be read or written, the fit fails, or the monitor asks to stop.
    pub fn fit_coarse(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        constraints: &Constraints,
        monitor: &dyn Monitor,
    ) -> Result<(), TilesError> {
        if self.coarse().exists() {
            return Ok(());
        }
        let load = |tile: &TileId| self.load(sorted, *tile, plan.coarse_thinning());
        let mut points = Cloud { world_from_local: plan.world_from_local, ..Cloud::default() };
        for part in plan.tiles.par_iter().map(load).collect::<Result<Vec<Cloud>, TilesError>>()? {
            points.append(Cloud { attributes: Default::default(), ..part });
        }
        let (field, _) = plan.coarse(&points, constraints, monitor)?;
        write_field(&self.coarse(), &field)
    }

    /// F on the coarse levels.
    ///
    /// # Errors
    /// If it is not there.
    pub fn read_coarse(&self) -> Result<LatticeField, TilesError> {
        read_field(&self.coarse())
    }

    /// Fits a tile.
    ///
    /// # Errors
    /// If a file cannot be read or written, the fit fails, or the monitor asks to stop.
    pub fn fit_tile(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        tile: TileId,
        (coarse, constraints): (&LatticeField, &Constraints),
        monitor: &dyn Monitor,
    ) -> Result<(), TilesError> {
        if self.strip(tile).exists() {
            return Ok(());
        }
        create(&self.work().join("fit"))?;
        let load = |tile, thinning| self.load(sorted, tile, thinning);
        let Some((fit, _)) = plan.fit(tile, coarse, constraints, load, monitor)? else {
            return crate::binary::Out::default().write(&self.strip(tile));
        };
        let strip = plan.strip(tile, &fit)?;
        write_model(&self.fitted(tile), &model_of(fit.into_fitted(), sorted))?;
        write_field(&self.strip(tile), strip.field())
    }

    /// Whether a tile was fitted and there was something to fit.
    fn has_fit(&self, tile: TileId) -> Result<bool, TilesError> {
        let path = self.strip(tile);
        match std::fs::metadata(&path) {
            Ok(facts) => Ok(facts.len() > 0),
            Err(source) if source.kind() == std::io::ErrorKind::NotFound => Err(TilesError::Missing { path }),
            Err(source) => Err(TilesError::system(&path, source)),
        }
    }

    /// Extracts the surface of a tile. It and its neighbours must be fitted.
    ///
    /// # Errors
    /// If a file cannot be read or written, or the monitor asks to stop.
    pub fn mesh_tile(
        &self,
        sorted: &Sorted,
        plan: &TilePlan,
        tile: TileId,
        monitor: &dyn Monitor,
    ) -> Result<(), TilesError> {
        if self.pieces(tile).exists() {
            return Ok(());
        }
        create(&self.work().join("mesh"))?;
        let mut mesh = TileMesh { mesh: Mesh::default(), shared: Vec::new() };
        if let Some(found) = self.read_fit(plan, tile)? {
            let load = |tile, thinning| self.load(sorted, tile, thinning);
            mesh = plan.mesh(tile, &found.fit, &found.strips(), load, monitor)?.0;
        }
        write_tile_mesh(&self.mesh(tile), &mesh)?;
        write_json(&self.pieces(tile), &pieces(&mesh))
    }

    /// What was fitted to a tile, and the strips around it; `None` if there was nothing to fit.
    fn read_fit(&self, plan: &TilePlan, tile: TileId) -> Result<Option<Fit>, TilesError> {
        if !self.has_fit(tile)? {
            return Ok(None);
        }
        let mut strips = Vec::new();
        for other in plan.neighbors(tile) {
            if self.has_fit(other)? {
                strips.push((other, Strip::new(read_field(&self.strip(other))?)));
            }
        }
        let path = self.fitted(tile);
        let Solid::Fitted(fitted) = read_model(&path)?.solid else { return Err(TilesError::damaged(&path)) };
        let fit = TileFit::new(Arc::try_unwrap(fitted).map_err(|_| TilesError::damaged(&path))?);
        Ok(Some(Fit { fit, strips }))
    }

    /// The model of a tile, the same as its neighbours' where they meet; `None` if there was nothing to fit. It and its neighbours must be fitted.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn model(&self, sorted: &Sorted, plan: &TilePlan, tile: TileId) -> Result<Option<Model>, TilesError> {
        let Some(found) = self.read_fit(plan, tile)? else { return Ok(None) };
        Ok(Some(model_of(plan.model(tile, &found.fit, &found.strips())?, sorted)))
    }

    /// Simplifies the surface of a tile without small pieces, if the plan asks for it. It and its neighbours must be extracted.
    ///
    /// # Errors
    /// If a file cannot be read or written, or the monitor asks to stop.
    pub fn simplify_tile(&self, plan: &TilePlan, tile: TileId, monitor: &dyn Monitor) -> Result<(), TilesError> {
        let path = self.simplified(tile);
        if plan.report.simplify.is_none() || path.exists() {
            return Ok(());
        }
        create(&self.work().join("simplified"))?;
        write_tile_mesh(&path, &plan.simplify(self.without_small(plan, tile)?, monitor)?)
    }

    /// The surface of a tile without small pieces, simplified if the plan asks for it. It and its neighbours must be extracted, and it simplified.
    ///
    /// # Errors
    /// If a file cannot be read.
    pub fn surface(&self, sorted: &Sorted, plan: &TilePlan, tile: TileId) -> Result<TileMesh, TilesError> {
        let mut mesh = match plan.report.simplify {
            Some(_) => read_tile_mesh(&self.simplified(tile))?,
            None => self.without_small(plan, tile)?,
        };
        mesh.mesh.crs.clone_from(&sorted.crs);
        Ok(mesh)
    }

    fn without_small(&self, plan: &TilePlan, tile: TileId) -> Result<TileMesh, TilesError> {
        let mut mesh = read_tile_mesh(&self.mesh(tile))?;
        if let Some(least) = plan.report.min_component {
            drop_small(&mut mesh, &self.pieces_around(plan, tile)?, least as u64);
        }
        Ok(mesh)
    }

    /// The pieces of each of the tiles around one.
    pub(crate) fn pieces_around(&self, plan: &TilePlan, tile: TileId) -> Result<Vec<Vec<Piece>>, TilesError> {
        plan.neighbors(tile).map(|other| read_json(&self.pieces(other))).collect()
    }

    /// All tiles as one mesh.
    ///
    /// # Errors
    /// If a file cannot be read, or there is no surface.
    pub fn merged(&self, sorted: &Sorted, plan: &TilePlan) -> Result<Mesh, TilesError> {
        let is_simple = plan.report.simplify.is_some();
        let path = |tile| if is_simple { self.simplified(tile) } else { self.mesh(tile) };
        let mut tiles = Vec::new();
        for &tile in &plan.tiles {
            tiles.push(read_tile_mesh(&path(tile))?);
        }
        let mut mesh = merge(tiles);
        mesh.crs.clone_from(&sorted.crs);
        mesh.world_from_local = plan.world_from_local;
        // What was simplified was without them already, and its triangles are large.
        if let Some(least) = plan.report.min_component.filter(|_| !is_simple) {
            drop_small_components(&mut mesh, least);
        }
        if mesh.triangles.is_empty() { Err(ReconstructError::NoSurface.into()) } else { Ok(mesh) }
    }
}

fn model_of(fitted: Fitted, sorted: &Sorted) -> Model {
    Model {
        solid: Solid::Fitted(Arc::new(fitted)),
        crs: sorted.crs.clone(),
        provenance: Provenance { version: env!("CARGO_PKG_VERSION").to_owned(), ..Provenance::default() },
    }
}

/// What was fitted to a tile, and the strips of those around it.
struct Fit {
    fit: TileFit,
    strips: Vec<(TileId, Strip)>,
}

impl Fit {
    fn strips(&self) -> Vec<(TileId, &Strip)> {
        self.strips.iter().map(|(id, strip)| (*id, strip)).collect()
    }
}
