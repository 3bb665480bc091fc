//! The folder in which tiles are made.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use zeroset::tile::{NodeId, TileId, TilePlan};
use zeroset_io::{GlobeError, IoError, write_atomically};

use crate::binary::read;
use crate::placement::Placement;
use crate::{Sorted, TilesError, Written};

/// A folder with what was made so far.
#[derive(Debug, Clone)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Opens a folder, new or begun. `run` tells what is being made of what, as JSON: a folder that was begun must tell the same.
    ///
    /// # Errors
    /// If the folder holds other things, or cannot be written.
    pub fn open(path: &Path, run: &serde_json::Value) -> Result<Self, TilesError> {
        let folder = Self { path: path.to_path_buf() };
        let stated = folder.path.join("run.json");
        if stated.exists() {
            let found: serde_json::Value = read_json(&stated)?;
            if found != *run {
                return Err(TilesError::OtherRun { path: folder.path });
            }
        } else {
            let is_empty = match std::fs::read_dir(path) {
                // What an interrupted write left behind does not count.
                Ok(mut entries) => !entries.any(|entry| {
                    entry.is_ok_and(|entry| !entry.file_name().to_string_lossy().starts_with(".zeroset-"))
                }),
                Err(_) => true,
            };
            if !is_empty {
                return Err(TilesError::NotEmpty { path: folder.path });
            }
            create(path)?;
            write_json(&stated, run)?;
        }
        Ok(folder)
    }

    /// A folder that [`Self::open`] made before, perhaps in another process.
    #[must_use]
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_path_buf() }
    }

    /// Where it is.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Removes what steps handed on. What is made stays.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove_work(&self) -> Result<(), TilesError> {
        remove(&self.work())
    }

    /// Removes what was begun, where it is not worth going on from; and the folder, if nothing else is in it.
    pub fn abandon(&self) {
        // Whatever stays is seen by the next run, which says so.
        let _ = self.remove_work();
        for file in ["run.json", "sorted.json", "plan.json"] {
            let _ = std::fs::remove_file(self.path.join(file));
        }
        let _ = std::fs::remove_dir(&self.path);
    }

    /// What was written, once all is done.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn finished(&self) -> Result<Option<Written>, TilesError> {
        let path = self.done_at();
        if path.exists() { read_json(&path).map(Some) } else { Ok(None) }
    }

    /// Forgets what was sorted and planned, so that it can be sorted anew.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn forget_points(&self) -> Result<(), TilesError> {
        remove_file(&self.plan_at())?;
        remove_file(&self.sorted_at())?;
        self.remove_work()
    }

    /// Removes the folder with all that is in it.
    ///
    /// # Errors
    /// If it cannot be removed.
    pub fn remove(&self) -> Result<(), TilesError> {
        remove(&self.path)
    }

    /// The folder of what steps hand on.
    pub(crate) fn work(&self) -> PathBuf {
        self.path.join("work")
    }

    fn of_tile(&self, kind: &str, tile: TileId, suffix: &str) -> PathBuf {
        self.work().join(kind).join(format!("{tile}{suffix}"))
    }

    pub(crate) fn thinned(&self, tile: TileId, thinning: u32) -> PathBuf {
        self.of_tile("thinned", tile, &format!(".{thinning}"))
    }

    pub(crate) fn fitted(&self, tile: TileId) -> PathBuf {
        self.of_tile("fit", tile, ".zset")
    }

    /// Written last by the fit of a tile; empty where there was nothing to fit.
    pub(crate) fn strip(&self, tile: TileId) -> PathBuf {
        self.of_tile("fit", tile, ".strip")
    }

    pub(crate) fn mesh(&self, tile: TileId) -> PathBuf {
        self.of_tile("mesh", tile, ".mesh")
    }

    /// Written last by the extraction of a tile.
    pub(crate) fn pieces(&self, tile: TileId) -> PathBuf {
        self.of_tile("mesh", tile, ".pieces")
    }

    /// The surface of a tile with fewer triangles.
    pub(crate) fn simplified(&self, tile: TileId) -> PathBuf {
        self.of_tile("simplified", tile, ".mesh")
    }

    pub(crate) fn level_mesh(&self, node: NodeId) -> PathBuf {
        self.work().join(format!("levels/{node}.mesh"))
    }

    /// Written last of a square of tiles.
    pub(crate) fn level_entry(&self, node: NodeId) -> PathBuf {
        self.work().join(format!("levels/{node}.json"))
    }

    pub(crate) fn coarse(&self) -> PathBuf {
        self.work().join("coarse")
    }

    /// Written last of all.
    pub(crate) fn done_at(&self) -> PathBuf {
        self.path.join("done.json")
    }

    pub(crate) fn sorted_at(&self) -> PathBuf {
        self.path.join("sorted.json")
    }

    pub(crate) fn plan_at(&self) -> PathBuf {
        self.path.join("plan.json")
    }

    /// What was sorted, once all points are.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn sorted(&self) -> Result<Option<Sorted>, TilesError> {
        let path = self.sorted_at();
        if path.exists() { read_json(&path).map(Some) } else { Ok(None) }
    }

    /// Why a tileset of the points does not stand on the globe; `None` if it does.
    #[must_use]
    pub fn off_the_globe(sorted: &Sorted, plan: &TilePlan) -> Option<GlobeError> {
        Placement::on_globe(sorted, plan).err()
    }

    /// The plan, once there is one.
    ///
    /// # Errors
    /// If the file cannot be read.
    pub fn plan(&self) -> Result<Option<TilePlan>, TilesError> {
        let path = self.plan_at();
        if path.exists() { read_json(&path).map(Some) } else { Ok(None) }
    }
}

/// Removes a folder, if it is there.
pub(crate) fn remove(path: &Path) -> Result<(), TilesError> {
    match std::fs::remove_dir_all(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(TilesError::system(path, source)),
        _ => Ok(()),
    }
}

/// Removes a file, if it is there.
pub(crate) fn remove_file(path: &Path) -> Result<(), TilesError> {
    match std::fs::remove_file(path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => Err(TilesError::system(path, source)),
        _ => Ok(()),
    }
}

/// Makes a folder and those that it lies in.
pub(crate) fn create(path: &Path) -> Result<(), TilesError> {
    std::fs::create_dir_all(path).map_err(|source| TilesError::system(path, source))
}

pub(crate) fn read_json<T: DeserializeOwned>(path: &Path) -> Result<T, TilesError> {
    serde_json::from_slice(&read(path)?).map_err(|_| TilesError::damaged(path))
}

pub(crate) fn write_json(path: &Path, value: &impl Serialize) -> Result<(), TilesError> {
    write_atomically::<IoError>(path, |writer| {
        serde_json::to_writer(writer, value).map_err(|e| IoError::from_system(path, e.into()))
    })?;
    Ok(())
}
