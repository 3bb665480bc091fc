//! Errors of the library as exceptions, one class for each kind.

use pyo3::prelude::*;
use zeroset::constraint::ConstraintError;
use zeroset::feature::FeatureError;
use zeroset::feature::newe::NeweError;
use zeroset::field::FieldError;
use zeroset::fit::normalized::{DataError, FitError};
use zeroset::mesh::{MeshError, SelfIntersectionError, SimplifyError};
use zeroset::model::ModelError;
use zeroset::monitor::Cancelled;
use zeroset::reconstruct::ReconstructError;
use zeroset_io::{IoError, SolidError};
use zeroset_tiles::TilesError;

/// What went wrong, before it is an exception.
#[derive(Debug)]
pub(crate) struct Failure {
    /// The name of the class in `zeroset._errors`.
    class: &'static str,
    message: String,
}

impl Failure {
    /// What the caller gave as data cannot be used.
    pub(crate) fn input(message: impl Into<String>) -> Self {
        Self::new("InputError", message)
    }

    /// A value of a parameter is not possible.
    pub(crate) fn parameter(message: impl Into<String>) -> Self {
        Self::new("ParameterError", message)
    }

    fn new(class: &'static str, message: impl Into<String>) -> Self {
        Self { class, message: in_python(&message.into()) }
    }
}

/// Remedies name options of the command; in Python they are parameters: `--max-error` is `max_error`.
fn in_python(message: &str) -> String {
    let mut parts = message.split("--");
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let end = part.find(|c: char| !(c.is_ascii_lowercase() || c == '-')).unwrap_or(part.len());
        text.push_str(&part[..end].replace('-', "_"));
        text.push_str(&part[end..]);
    }
    text
}

impl From<Failure> for PyErr {
    fn from(failure: Failure) -> Self {
        Python::attach(|py| {
            let class = py.import("zeroset._errors").and_then(|errors| errors.getattr(failure.class));
            match class.and_then(|class| class.call1((failure.message,))) {
                Ok(exception) => Self::from_value(exception),
                Err(error) => error,
            }
        })
    }
}

impl From<Cancelled> for Failure {
    fn from(error: Cancelled) -> Self {
        Self::new("Cancelled", error.to_string())
    }
}

impl From<ReconstructError> for Failure {
    fn from(error: ReconstructError) -> Self {
        let class = match error {
            ReconstructError::Astray { extent, spacing } => {
                return Self::input(format!(
                    "the box of the points is {extent:.3e} wide but the points are {spacing:.3e} apart, so stray points lie far \
                     off; drop them, or give a resolution"
                ));
            }
            ReconstructError::Memory { resolution, needed_gb, allowed_gb, possible } => {
                return Self::new(
                    "MemoryLimitError",
                    format!(
                        "a resolution of {resolution} needs about {needed_gb:.1} GB, more than the {allowed_gb:.1} GB at hand; \
                         give a resolution of {possible:.4} or more, or fewer points"
                    ),
                );
            }
            ReconstructError::Model(error) => return error.into(),
            ReconstructError::Cancelled(cancelled) => return cancelled.into(),
            ReconstructError::TooFewPoints { .. }
            | ReconstructError::Degenerate { .. }
            | ReconstructError::ConstraintsAstray => "InputError",
            ReconstructError::Length { .. }
            | ReconstructError::Simplify(_)
            | ReconstructError::TilesOfBody
            | ReconstructError::TilesWithoutTrim
            | ReconstructError::TilesToTriangles
            | ReconstructError::NarrowTiles { .. } => "ParameterError",
            ReconstructError::NoSurface => "NoSurfaceError",
            ReconstructError::Fit(_) => "FitError",
        };
        Self::new(class, error.to_string())
    }
}

impl From<ModelError> for Failure {
    fn from(error: ModelError) -> Self {
        use zeroset::contour::FieldContourError;
        let class = match error {
            ModelError::Cancelled(cancelled) => return cancelled.into(),
            ModelError::Contour(FieldContourError::NoSurface) => "NoSurfaceError",
            ModelError::Parameter(_) | ModelError::Simplify(_) => "ParameterError",
            _ => "ModelError",
        };
        Self::new(class, error.to_string())
    }
}

impl From<FieldError> for Failure {
    fn from(error: FieldError) -> Self {
        Self::new("ModelError", error.to_string())
    }
}

impl From<SolidError> for Failure {
    fn from(error: SolidError) -> Self {
        match error {
            SolidError::File(error) => error.into(),
            other => Self::new("ModelError", other.to_string()),
        }
    }
}

impl From<MeshError> for Failure {
    fn from(error: MeshError) -> Self {
        Self::new("MeshError", error.to_string())
    }
}

impl From<SelfIntersectionError> for Failure {
    fn from(error: SelfIntersectionError) -> Self {
        match error {
            SelfIntersectionError::Cancelled(cancelled) => cancelled.into(),
            other => Self::new("MeshError", other.to_string()),
        }
    }
}

impl From<SimplifyError> for Failure {
    fn from(error: SimplifyError) -> Self {
        let class = match error {
            SimplifyError::Cancelled(cancelled) => return cancelled.into(),
            SimplifyError::NoTarget | SimplifyError::Parameter { .. } => "ParameterError",
            SimplifyError::NoSurface { .. } | SimplifyError::Broken(_) => "MeshError",
        };
        Self::new(class, error.to_string())
    }
}

impl From<FeatureError> for Failure {
    fn from(error: FeatureError) -> Self {
        match error {
            FeatureError::Surface(error) => error.into(),
            FeatureError::Cancelled(cancelled) => cancelled.into(),
            other @ FeatureError::Parameter { .. } => Self::parameter(other.to_string()),
        }
    }
}

impl From<NeweError> for Failure {
    fn from(error: NeweError) -> Self {
        match error {
            NeweError::TooFewPoints { .. } | NeweError::NotFinite(_) | NeweError::Extreme | NeweError::NoDimensions => {
                Self::input(error.to_string())
            }
            other => Self::parameter(other.to_string()),
        }
    }
}

impl From<DataError> for Failure {
    fn from(error: DataError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<ConstraintError> for Failure {
    fn from(error: ConstraintError) -> Self {
        Self::input(error.to_string())
    }
}

impl From<FitError> for Failure {
    fn from(error: FitError) -> Self {
        match error {
            FitError::Cancelled(cancelled) => cancelled.into(),
            FitError::Data(error) => error.into(),
            FitError::Smoothness(_) => Self::parameter(error.to_string()),
            other => Self::new("FitError", other.to_string()),
        }
    }
}

impl From<IoError> for Failure {
    fn from(error: IoError) -> Self {
        let class = match error {
            IoError::NotFound { .. } | IoError::FolderMissing { .. } => "FileMissingError",
            IoError::PermissionDenied { .. }
            | IoError::IsDirectory { .. }
            | IoError::DiskFull { .. }
            | IoError::System { .. } => "FileError",
            _ => "FormatError",
        };
        Self::new(class, error.to_string())
    }
}

impl From<TilesError> for Failure {
    fn from(error: TilesError) -> Self {
        let class = match error {
            TilesError::Io(error) => return error.into(),
            TilesError::Reconstruct(error) => return error.into(),
            TilesError::Cancelled(cancelled) => return cancelled.into(),
            TilesError::OtherRun { .. } | TilesError::NotEmpty { .. } => "FileError",
            TilesError::Damaged { .. } => "FormatError",
            TilesError::Missing { .. } => "FileMissingError",
            TilesError::NoPoints | TilesError::Globe(_) => "InputError",
        };
        Self::new(class, error.to_string())
    }
}
