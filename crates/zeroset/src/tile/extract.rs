//! The surface of a tile.

use super::layout::Layout;
use super::{Strip, TileFit, TileId, TilePlan};
use crate::cloud::Cloud;
use crate::contour::ColumnOutline;
use crate::mesh::{Mesh, SimplifyError, simplify_held};
use crate::model::{MeshReport, Piece, SAMPLES_REL, piece};
use crate::monitor::Monitor;
use crate::reconstruct::ReconstructError;
use crate::vec3::Vec3;

/// The surface of a tile, which ends at its faces.
#[derive(Debug, Clone)]
pub struct TileMesh {
    /// The mesh. Its local coordinates are those of the plan.
    pub mesh: Mesh,
    /// The vertices that neighbours have, too, ascending, each with what it is called in all of them.
    pub shared: Vec<(u32, [u64; 3])>,
}

impl TilePlan {
    /// The surface of a tile: its own part of the zero set, sharp, with values of the points. `strips` are those of the neighbours that were fitted,
    /// `load` gives the points of a tile, thinned. It may be empty.
    ///
    /// # Errors
    /// Those of `load`, or if the monitor asks to stop.
    pub fn mesh<E: From<ReconstructError>>(
        &self,
        tile: TileId,
        fit: &TileFit,
        strips: &[(TileId, &Strip)],
        load: impl FnMut(TileId, u32) -> Result<Cloud, E>,
        monitor: &dyn Monitor,
    ) -> Result<(TileMesh, MeshReport), E> {
        let layout = Layout::new(self)?;
        let outline = match self.report.trim {
            Some(radius) => Some(self.outline_of(&layout, tile, fit, radius, load)?),
            None => None,
        };
        let field = self.agreed(&layout, tile, fit, strips);
        let own = layout.owns(tile, &self.tiles);
        let part = Piece { own: &own, outline: outline.as_ref(), raster: layout.raster() };
        let extracted = piece(fit.fitted(), &field, &part, self.report.attributes, monitor);
        let (mesh, seam, report) = extracted.map_err(ReconstructError::from)?;
        let mut shared: Vec<(u32, [u64; 3])> = seam.keys.into_iter().collect();
        shared.sort_unstable();
        Ok((TileMesh { mesh, shared }, report))
    }

    /// The surface of a tile with fewer triangles, if the plan asks for it. What neighbours share stays, so they still fit together. Small pieces must be dropped
    /// before.
    ///
    /// # Errors
    /// If the monitor asks to stop.
    pub fn simplify(&self, tile: TileMesh, monitor: &dyn Monitor) -> Result<TileMesh, ReconstructError> {
        let Some(params) = &self.report.simplify else { return Ok(tile) };
        let held: Vec<u32> = tile.shared.iter().map(|(v, _)| *v).collect();
        let (mesh, numbers, _) = match simplify_held(&tile.mesh, &held, params, monitor) {
            Err(SimplifyError::NoSurface { .. }) => return Ok(tile),
            simplified => simplified?,
        };
        let named = tile.shared.iter().zip(numbers);
        let shared = named.filter_map(|((_, key), number)| Some((number?, *key))).collect();
        Ok(TileMesh { mesh, shared })
    }

    /// The outline of the data around a tile, closed by a radius, as it is for the whole.
    fn outline_of<E>(
        &self,
        layout: &Layout,
        tile: TileId,
        fit: &TileFit,
        radius: f64,
        load: impl FnMut(TileId, u32) -> Result<Cloud, E>,
    ) -> Result<ColumnOutline, E> {
        // What the closing sees: points within a radius of columns within a radius.
        let cell = self.report.resolution;
        let reach = (2.0 * radius / cell).ceil() as u32 + 2;
        let gathered = self.gather(layout, tile, reach, load)?;
        let mut points: Vec<Vec3> = gathered.near.points.iter().map(|&p| layout.frame.enter(p)).collect();
        points.extend_from_slice(&gathered.far);
        points.extend(fit.fitted().held().samples(SAMPLES_REL * cell).into_iter().map(|p| layout.frame.enter(p)));
        Ok(ColumnOutline::new(&points, cell, radius))
    }
}
