//! F on the coarse levels of the whole, and on the finest level of a tile.

use serde::Serialize;

use super::layout::{HALO, Layout};
use super::{TileId, TilePlan};
use crate::cloud::Cloud;
use crate::constraint::{Constraints, Local};
use crate::field::LatticeField;
use crate::fit::cascade::{self, FitParams, FitReport, PolishReport, Prepared};
use crate::model::{Fitted, SAMPLES_REL};
use crate::monitor::{Monitor, Part};
use crate::reconstruct::{Beyond, LEAST_POINTS, ReconstructError, Shaped, StructureReport, shape};
use crate::vec3::Vec3;

/// What was fitted to the points of a tile and its halo.
#[derive(Debug)]
pub struct TileFit(Fitted);

impl TileFit {
    /// A fit that was kept.
    #[must_use]
    pub fn new(fitted: Fitted) -> Self {
        Self(fitted)
    }

    /// Takes the model out.
    #[must_use]
    pub fn into_fitted(self) -> Fitted {
        self.0
    }

    /// The model: F in the tile and its halo, with what the points there show.
    #[must_use]
    pub fn fitted(&self) -> &Fitted {
        &self.0
    }
}

/// What the fit of a tile did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TileFitReport {
    /// Points in the tile and its halo.
    pub points: usize,
    /// Points farther off, thinned.
    pub far_points: usize,
    /// Level by level, coarsest first.
    pub fit: FitReport,
    /// The planes; `None` in a draft.
    pub structure: Option<StructureReport>,
    /// The polish; `None` in a draft.
    pub polish: Option<PolishReport>,
}

/// The share of a tile that the cascade takes.
const CASCADE: f64 = 0.4;

impl TilePlan {
    /// F on the coarse levels of the whole. `points` are those of all tiles, thinned by [`Self::coarse_thinning`], tile after tile.
    ///
    /// # Errors
    /// If the fit fails or the monitor asks to stop.
    pub fn coarse(
        &self,
        points: &Cloud,
        constraints: &Constraints,
        monitor: &dyn Monitor,
    ) -> Result<(LatticeField, FitReport), ReconstructError> {
        let layout = Layout::new(self)?;
        let entered: Vec<Vec3> = points.points.iter().map(|&p| layout.frame.enter(p)).collect();
        let (low, high) = crate::domain::bounds(self.bounds.into_iter().map(|corner| layout.frame.enter(corner)));
        let samples = self.known(&layout, constraints, [low, high]).samples(layout.lattice.spacing_at(layout.coarse));
        let prepared = Prepared::on(layout.lattice, &entered, &samples, &self.fit_params());
        Ok(prepared.coarse(layout.coarse, monitor)?)
    }

    /// Fits a tile, from F on the coarse levels of the whole. `load` gives the points of a tile, thinned. `None` if there are hardly any points in the tile and
    /// its halo.
    ///
    /// # Errors
    /// Those of `load`, if the fit fails, or if the monitor asks to stop.
    pub fn fit<E: From<ReconstructError>>(
        &self,
        tile: TileId,
        coarse: &LatticeField,
        constraints: &Constraints,
        load: impl FnMut(TileId, u32) -> Result<Cloud, E>,
        monitor: &dyn Monitor,
    ) -> Result<Option<(TileFit, TileFitReport)>, E> {
        let layout = Layout::new(self)?;
        let gathered = self.gather(&layout, tile, layout.reach(), load)?;
        if gathered.near.len() < LEAST_POINTS {
            return Ok(None);
        }
        let region = layout.region(tile);
        let halo = self.reached(&layout, tile);
        let known = self.known(&layout, constraints, halo);
        let mut entered: Vec<Vec3> = gathered.near.points.iter().map(|&p| layout.frame.enter(p)).collect();
        entered.extend_from_slice(&gathered.far);
        let samples = known.samples(SAMPLES_REL * self.report.resolution);
        let prepared = Prepared::on(layout.lattice, &entered, &samples, &self.fit_params());
        drop(entered);
        let refined = prepared.refine(coarse, &region, &Part::new(monitor, 0.0..CASCADE / cascade::SHARE));
        let (field, fit) = refined.map_err(ReconstructError::from)?;
        let beyond = Beyond { bounds: self.bounds, reach: Some(halo), max_distance: self.plane_distance };
        let rest = &Part::new(monitor, CASCADE..1.0);
        let Shaped { fitted, structure, polish, .. } =
            shape(field, &gathered.near, &self.report, &known, beyond, rest)?;
        let (points, far_points) = (gathered.near.len(), gathered.far.len());
        Ok(Some((TileFit(fitted), TileFitReport { points, far_points, fit, structure, polish })))
    }

    fn fit_params(&self) -> FitParams {
        FitParams { screening: self.report.screening, ..FitParams::new(self.report.scene, self.report.resolution) }
    }

    /// The user's lines and polygons in a box of the frame of the fit.
    fn known(&self, layout: &Layout, constraints: &Constraints, [low, high]: [Vec3; 2]) -> Local {
        Local::new(constraints, self.world_from_local, |p| layout.frame.enter(p), (low, high))
    }

    /// The box of a tile and its halo, as far as there are points anywhere, in the frame of the fit.
    fn reached(&self, layout: &Layout, tile: TileId) -> [Vec3; 2] {
        let (low, high) = crate::domain::bounds(self.bounds.into_iter().map(|corner| layout.frame.enter(corner)));
        let [first, last] = layout.rectangle(tile, HALO[0].into());
        [
            [low[0].max(first[0]).min(high[0]), low[1].max(first[1]).min(high[1]), low[2]],
            [high[0].min(last[0]).max(low[0]), high[1].min(last[1]).max(low[1]), high[2]],
        ]
    }
}
