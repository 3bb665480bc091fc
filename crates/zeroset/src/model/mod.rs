//! Models: solids that are kept, asked, edited and made into meshes.
//!
//! # What
//! A [`Model`] is a [`Solid`], a tree of operands, with where it is from. [`Fitted`] holds what was fitted to a cloud: F on its lattice, and what the points
//! show of the surface, so that a mesh can be made of it later, as sharp as at once.
//!
//! ```
//! use std::sync::Arc;
//! use zeroset::model::{MeshParams, Solid, mesh};
//! use zeroset::reconstruct::{ReconstructParams, plan};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let cloud = Scene::new(SceneKind::Torus, 1).points(5_000, 0.001, 1);
//! let (fitted, _) = plan(&cloud, &ReconstructParams::default(), &())?.fit(&())?;
//! let torus = Solid::Fitted(Arc::new(fitted));
//! let half = Solid::HalfSpace { point: [0.0; 3], normal: [1.0, 0.0, 0.0] };
//! let (cut, report) = mesh(&Solid::Intersection(vec![torus, half]), &MeshParams::default(), &())?;
//! assert!(zeroset::mesh::topology(&cut)?.closed);
//! assert!(report.sharp.is_some_and(|sharp| sharp.on_creases > 0));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod attributes;
mod columns;
mod domain;
mod evaluate;
mod fitted;
mod heights;
mod keep;
mod slices;
mod solid;
mod surface;
mod volume;

pub use attributes::AttributeChoice;
pub use evaluate::{Values, evaluate};
pub(crate) use fitted::SAMPLES_REL;
pub use fitted::{Fitted, FittedParts, Structure};
pub use heights::{Heights, heights};
pub use slices::{Cuts, Slices, slices};
pub use solid::Solid;
pub use surface::{MeshParams, MeshReport, MeshSeconds, mesh};
pub(crate) use surface::{Piece, piece};
pub use volume::{CutAndFill, Volume, VolumeParams, cut_and_fill, volume};

use crate::contour::FieldContourError;
use crate::field::FieldError;
use crate::mesh::SimplifyError;
use crate::monitor::Cancelled;

/// A solid with where it is from.
#[derive(Debug, Clone)]
pub struct Model {
    /// The solid.
    pub solid: Solid,
    /// The coordinate reference system, as the input stated it.
    pub crs: Option<String>,
    /// What it was made from, and how.
    pub provenance: Provenance,
}

/// What a model was made from, and how.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Provenance {
    /// Version of this library.
    pub version: String,
    /// Names of the inputs, without folders.
    pub inputs: Vec<String>,
    /// Names and values of what was decided.
    pub parameters: Vec<(String, String)>,
}

/// What cannot be done with a model. Each message names the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ModelError {
    /// Parts that do not fit together.
    #[error("the model is damaged: {0}; make it again")]
    Inconsistent(&'static str),
    /// An operand that cannot be.
    #[error(transparent)]
    Field(#[from] FieldError),
    /// Something asked for that is not possible.
    #[error("{0}")]
    Parameter(&'static str),
    /// No mesh of it can be made.
    #[error(transparent)]
    Contour(#[from] FieldContourError),
    /// The mesh cannot be simplified.
    #[error("{0}; check --triangles and --max-error")]
    Simplify(SimplifyError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl From<SimplifyError> for ModelError {
    fn from(error: SimplifyError) -> Self {
        match error {
            SimplifyError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            other => Self::Simplify(other),
        }
    }
}
