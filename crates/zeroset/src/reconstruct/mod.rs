//! The main job in one call: a raw cloud in, a mesh out.
//!
//! [`plan`] resolves every default (scene, resolution, trim) against the cloud and says what the work will cost; [`Plan::run`]
//! does it. The two are apart so that a caller can show the plan first.
//!
//! ```
//! use zeroset::monitor::Monitor;
//! use zeroset::reconstruct::{ReconstructParams, plan};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let cloud = Scene::new(SceneKind::Torus, 1).points(20_000, 0.001, 1);
//! let (mesh, report) = plan(&cloud, &ReconstructParams::default(), &())?.run(&())?;
//! assert!(mesh.triangles.len() > 1000);
//! assert_eq!(report.plan.scene, zeroset::fit::cascade::Scene::Object);
//! # Ok::<(), zeroset::reconstruct::ReconstructError>(())
//! ```

mod patches;
mod plan;
mod quality;
mod run;
mod scene;
mod structure;

pub use crate::fit::Up;
pub use crate::model::AttributeChoice;
pub(crate) use plan::{LEAST_POINTS, Measured, expected_bytes};
pub use plan::{MinComponent, Plan, PlanReport, ReconstructParams, Resolution, Trim, plan};
pub use quality::Quality;
pub(crate) use run::{Beyond, Shaped, shape};
pub use run::{FittedReport, ReconstructReport, StageSeconds};
pub use scene::SceneEvidence;
pub use structure::StructureReport;

use crate::contour::FieldContourError;
use crate::fit::cascade::FitError;
use crate::mesh::SimplifyError;
use crate::model::ModelError;
use crate::monitor::Cancelled;

/// A reconstruction that could not be made. Each message names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum ReconstructError {
    /// Fewer distinct points than a surface needs.
    #[error("too few points to fit a surface: {found}; give at least {needed}")]
    TooFewPoints {
        /// Points found.
        found: usize,
        /// Points needed.
        needed: usize,
    },
    /// All points in one place, or on one line.
    #[error("the points lie {shape}, so they bear no surface; check the columns of the file, or give more of the scan")]
    Degenerate {
        /// "in one place" or "on one line".
        shape: &'static str,
    },
    /// A few points so far away that the rest is a speck in the box.
    #[error(
        "the box of the points is {extent:.3e} wide but the points are {spacing:.3e} apart, so stray points lie far off; \
         give --bounds or --outliers 8, or a --resolution of your own"
    )]
    Astray {
        /// Longest side of the box.
        extent: f64,
        /// Spacing of the points.
        spacing: f64,
    },
    /// No constraint is near the points.
    #[error(
        "no line or polygon of the constraints lies in the box of the points; give them in the same coordinates, which are not transformed"
    )]
    ConstraintsAstray,
    /// The resolution asked for needs more memory than allowed.
    #[error(
        "a resolution of {resolution} needs about {needed_gb:.1} GB, more than the {allowed_gb:.1} GB at hand; \
         give a resolution of {possible:.4} or more, or --bounds"
    )]
    Memory {
        /// The resolution asked for.
        resolution: f64,
        /// Memory that it needs.
        needed_gb: f64,
        /// Memory allowed.
        allowed_gb: f64,
        /// A resolution that fits.
        possible: f64,
    },
    /// The fit found no surface at all.
    #[error("no surface was found; give a finer --resolution or another --scene")]
    NoSurface,
    /// Tiles of something that is not open ground.
    #[error(
        "tiles are for ground seen from above, and this looks like an object; give --scene terrain or airborne, or no --tile"
    )]
    TilesOfBody,
    /// Tiles of a surface without an end.
    #[error("tiles end where the points do, so --trim off is not possible; give a length, or no --tile")]
    TilesWithoutTrim,
    /// A number of triangles for tiles.
    #[error("how many triangles each tile should have is not known; give --max-error, or no --tile")]
    TilesToTriangles,
    /// Tiles narrower than their halos.
    #[error("tiles of {side} are narrow for this resolution; give --tile {least:.1} or more, or a finer --resolution")]
    NarrowTiles {
        /// The side asked for.
        side: f64,
        /// The least that is possible.
        least: f64,
    },
    /// A length that is not positive.
    #[error("a {name} of {value} is not possible; give a positive length")]
    Length {
        /// What it is a length of.
        name: &'static str,
        /// The value.
        value: f64,
    },
    /// The mesh cannot be simplified.
    #[error("{0}; check --triangles and --max-error")]
    Simplify(SimplifyError),
    /// No mesh can be made of the fit.
    #[error(transparent)]
    Model(ModelError),
    /// The fit failed.
    #[error(transparent)]
    Fit(#[from] FitError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<ModelError> for ReconstructError {
    fn from(error: ModelError) -> Self {
        match error {
            ModelError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            ModelError::Contour(FieldContourError::NoSurface) => Self::NoSurface,
            ModelError::Simplify(source) => Self::Simplify(source),
            other => Self::Model(other),
        }
    }
}

impl From<SimplifyError> for ReconstructError {
    fn from(error: SimplifyError) -> Self {
        match error {
            SimplifyError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Simplify(other),
        }
    }
}
