//! What can go wrong. Each message names the remedy.

use std::path::{Path, PathBuf};

use zeroset::monitor::Cancelled;
use zeroset::reconstruct::ReconstructError;
use zeroset_io::{GlobeError, IoError, shown};

/// Why tiles were not made.
#[derive(Debug, thiserror::Error)]
pub enum TilesError {
    /// A file could not be read or written.
    #[error(transparent)]
    Io(#[from] IoError),
    /// The surface could not be made.
    #[error(transparent)]
    Reconstruct(#[from] ReconstructError),
    /// The folder holds the tiles of something else.
    #[error("{}: holds tiles of other inputs or options; give another folder, or remove this one", shown(path))]
    OtherRun {
        /// The folder.
        path: PathBuf,
    },
    /// The folder holds something that no run made.
    #[error("{}: is not empty, and no tiles were made in it; give a new folder", shown(path))]
    NotEmpty {
        /// The folder.
        path: PathBuf,
    },
    /// A file between two steps is not what was written.
    #[error("{}: is damaged; remove it and run again", shown(path))]
    Damaged {
        /// The file.
        path: PathBuf,
    },
    /// A step was asked for before those that it needs.
    #[error("{}: is not there yet; run the steps before it first", shown(path))]
    Missing {
        /// The file that it needs.
        path: PathBuf,
    },
    /// Inputs without any point.
    #[error("no points are left to sort into tiles; check the inputs and what is left out")]
    NoPoints,
    /// A position cannot be placed on the globe.
    #[error(transparent)]
    Globe(#[from] GlobeError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl TilesError {
    pub(crate) fn system(path: &Path, source: std::io::Error) -> Self {
        Self::Io(IoError::from_system(path, source))
    }

    pub(crate) fn damaged(path: &Path) -> Self {
        Self::Damaged { path: path.to_path_buf() }
    }
}
