//! Why a command failed, in one line.

use std::path::{Path, PathBuf};

use crate::fit2d::Fit2dError;
use zeroset::contour::FieldContourError;
use zeroset::feature::{CompareFeaturesError, FeatureError};
use zeroset::mesh::{CompareError, MeshError};
use zeroset::model::ModelError;
use zeroset::reconstruct::ReconstructError;
use zeroset_io::{IoError, SolidError, shown};
use zeroset_tiles::TilesError;
use zeroset_view::render::RenderError;
use zeroset_view::serve::ServeError;

/// Why a command failed. The message names the file and the remedy.
#[derive(Debug, thiserror::Error)]
pub(crate) enum CliError {
    /// A file could not be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// Standard output could not be written.
    #[error("standard output: {0}; check where it goes to")]
    Stdout(#[source] std::io::Error),
    /// Tiles cannot be made.
    #[error(transparent)]
    Tiles(TilesError),
    /// An option that is not possible with tiles.
    #[error("{option} needs all points at once, so it is not possible with tiles; {remedy}")]
    NotWithTiles {
        /// The option.
        option: &'static str,
        /// What to do.
        remedy: &'static str,
    },
    /// A length in a unit that cannot be converted.
    #[error(
        "{input}: the unit of its coordinates is not stated, so {option} cannot be converted; give it without a unit"
    )]
    NoUnit {
        /// The input.
        input: String,
        /// The option.
        option: &'static str,
    },
    /// All points were left out.
    #[error("{inputs}: no points are left to make tiles of; check --bounds, --classes and --exclude")]
    NoPointsForTiles {
        /// The inputs, in words.
        inputs: String,
    },
    /// More tiles at a time than memory is there for.
    #[error(
        "{jobs} tiles of {side} at a time need about {needed_gb:.1} GB, more than the {allowed_gb:.1} GB at hand; give fewer --jobs, a shorter --tile, or more --memory"
    )]
    TilesTooLarge {
        /// Tiles at a time.
        jobs: usize,
        /// Their side.
        side: f64,
        /// Memory that they need.
        needed_gb: f64,
        /// Memory allowed.
        allowed_gb: f64,
    },
    /// The reconstruction is not possible.
    #[error("{inputs}: {source}")]
    Reconstruct {
        /// The inputs, in words.
        inputs: String,
        /// Why.
        source: ReconstructError,
    },
    /// Constraints far from the points.
    #[error(
        "{}: none of its lines and polygons lies in the box of the points: they reach {own}, the points {points}; \
         give them in the coordinates of the points",
        shown(path)
    )]
    ConstraintsAstray {
        /// The file.
        path: PathBuf,
        /// Its box, in words.
        own: String,
        /// The box of the points, in words.
        points: String,
    },
    /// A solid cannot be read.
    #[error(transparent)]
    Solid(#[from] SolidError),
    /// Something is not possible with a model.
    #[error("{what}: {source}{}", remedy(source))]
    Model {
        /// The model.
        what: String,
        /// Why.
        source: ModelError,
    },
    /// Planes that miss a model.
    #[error("{what}: no plane goes through the surface; give others, or look at its box with zeroset info")]
    NothingCut {
        /// The model.
        what: String,
    },
    /// The fit in the plane is not possible.
    #[error("{}: {source}", shown(input))]
    Fit2d {
        /// The input.
        input: PathBuf,
        /// Why.
        source: Fit2dError,
    },
    /// A picture that cannot be drawn.
    #[error("{inputs}: {source}")]
    Render {
        /// The inputs, in words.
        inputs: String,
        /// Why.
        source: RenderError,
    },
    /// The viewer cannot be started.
    #[error(transparent)]
    Serve(#[from] ServeError),
    /// Colours that tell of what is not there.
    #[error("{inputs}: there are {what}; choose another --color")]
    NothingToColor {
        /// The inputs, in words.
        inputs: String,
        /// What is not there.
        what: &'static str,
    },
    /// A mesh without area.
    #[error("{}: there is no surface in it ({faces} triangles, no area); give a mesh", shown(path))]
    NoSurface {
        /// The file.
        path: PathBuf,
        /// Number of its triangles.
        faces: usize,
    },
    /// The comparison is not possible for a reason of its own.
    #[error(transparent)]
    Compare(CompareError),
    /// A mesh that cannot be examined.
    #[error("{}: {source}; repair or export the mesh again", shown(path))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Why.
        source: MeshError,
    },
    /// A file was to be read and written, or written twice.
    #[error("{}: named as both {first} and {second}; choose another name for one of them", shown(path))]
    SameFile {
        /// The file.
        path: PathBuf,
        /// What it is first.
        first: &'static str,
        /// What it is, too.
        second: &'static str,
    },
    /// The options left no point over.
    #[error("{inputs}: no point is left: {filters}; widen {}", if *several { "them" } else { "it" })]
    NothingLeft {
        /// The inputs, in words.
        inputs: String,
        /// What each option left out.
        filters: String,
        /// Whether several did.
        several: bool,
    },
    /// `--classes` for points that have none.
    #[error("{inputs}: the points have no classes; leave out --classes")]
    NoClasses {
        /// The inputs, in words.
        inputs: String,
    },
    /// `-` as the output for a mesh.
    #[error("standard output: meshes are not written there; name a file with one of the suffixes {known}")]
    MeshToStream {
        /// The suffixes that are known.
        known: String,
    },
    /// Two results for standard output.
    #[error("standard output: named as both {first} and {second}; name a file for one of them")]
    BothToStream {
        /// What it is first.
        first: &'static str,
        /// What it is, too.
        second: &'static str,
    },
    /// Features cannot be found.
    #[error("{inputs}: {source}")]
    Features {
        /// The inputs, in words.
        inputs: String,
        /// Why.
        source: FeatureError,
    },
    /// Features cannot be compared for a reason of its own.
    #[error("{}: {source}", shown(path))]
    CompareFeatures {
        /// The file.
        path: PathBuf,
        /// Why.
        source: CompareFeaturesError,
    },
    /// The threads cannot be started.
    #[error("the threads cannot be started: {0}; give fewer --threads")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Options that have no meaning together.
    #[error("{0}")]
    Usage(String),
    /// The user wants to stop.
    #[error("interrupted")]
    Interrupted,
}

impl CliError {
    /// Whether the reader of a pipe has gone, which is a quiet end.
    pub(crate) fn is_broken_pipe(&self) -> bool {
        match self {
            Self::Io(error) => error.is_broken_pipe(),
            Self::Stdout(error) => error.kind() == std::io::ErrorKind::BrokenPipe,
            _ => false,
        }
    }
}

/// The option that helps where the core cannot name it.
fn remedy(error: &ModelError) -> &'static str {
    match error {
        ModelError::Contour(FieldContourError::NoBounds | FieldContourError::EmptyBounds) => " with --bounds",
        ModelError::Contour(FieldContourError::NoSurface) => "; look elsewhere with --bounds, or with a smaller --cell",
        ModelError::Contour(FieldContourError::Lattice(_)) => " with --cell",
        _ => "",
    }
}

/// Several files in words.
pub(crate) fn in_words(paths: &[PathBuf]) -> String {
    let first = shown(paths.first().map_or(Path::new("-"), PathBuf::as_path));
    match paths.len() {
        0 | 1 => first,
        n => format!("{first} and {} more", n - 1),
    }
}

impl From<TilesError> for CliError {
    fn from(error: TilesError) -> Self {
        match error {
            TilesError::Cancelled(_) | TilesError::Reconstruct(ReconstructError::Cancelled(_)) => Self::Interrupted,
            other => Self::Tiles(other),
        }
    }
}
