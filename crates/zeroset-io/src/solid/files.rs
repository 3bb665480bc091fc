//! Solids from files.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use rustc_hash::FxHashMap;
use zeroset::field::FieldError;
use zeroset::mesh::{Mesh, topology};
use zeroset::model::Solid;

use super::{MODEL_SUFFIX, Operands, SolidError, TREE_SUFFIX, expression, suffixes, tree};
use crate::constraints::{Footprint, read_footprints};
use crate::input::read_file;
use crate::{IoError, MeshFormat, read_mesh};

/// How often files can be named, in a tree and all that it names: trees that name others several times multiply.
pub(super) const MOST_FILES: usize = 10_000;

type Models<'a> = Box<dyn FnMut(&Path) -> Result<Solid, IoError> + 'a>;

/// Reads solids, and the files that they name: meshes, trees, footprints, and models by a function that is given.
///
/// Names in an expression are relative to the working directory, those in a tree to its folder. A mesh or model that is named twice is read once.
pub struct SolidFiles<'a> {
    models: Models<'a>,
    /// Meshes and models that were read.
    read: FxHashMap<PathBuf, Solid>,
    /// The trees that are being read, each named by the one before it: as they are found, and as they are named.
    open: Vec<(PathBuf, PathBuf)>,
    /// What names are relative to.
    folder: PathBuf,
    named: usize,
}

impl fmt::Debug for SolidFiles<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SolidFiles").field("read", &self.read.len()).field("open", &self.open).finish_non_exhaustive()
    }
}

impl Default for SolidFiles<'_> {
    fn default() -> Self {
        Self::new(|path| Ok(crate::read_model(path)?.solid))
    }
}

impl<'a> SolidFiles<'a> {
    /// `models` reads files that end in `.zset`; the default is [`read_model`](crate::read_model).
    pub fn new(models: impl FnMut(&Path) -> Result<Solid, IoError> + 'a) -> Self {
        Self {
            models: Box::new(models),
            read: FxHashMap::default(),
            open: Vec::new(),
            folder: PathBuf::new(),
            named: 0,
        }
    }

    /// Reads an expression.
    ///
    /// # Errors
    /// If it cannot be understood, a shape in it has no volume, or a file that it names cannot be read.
    pub fn expression(&mut self, text: &str) -> Result<Solid, SolidError> {
        expression::parse(text, self, 0)
    }

    /// Reads a file: a mesh, a model, or a tree; the suffix tells which.
    ///
    /// # Errors
    /// If the file, or one that it names, cannot be read, a mesh is not closed, or a tree names itself.
    pub fn read(&mut self, path: &Path) -> Result<Solid, SolidError> {
        self.file(path, 0)
    }

    /// The path of a file that is named.
    fn found(&mut self, name: &Path) -> Result<PathBuf, SolidError> {
        let path = self.folder.join(name);
        self.named += 1;
        if self.named > MOST_FILES { Err(SolidError::TooManyFiles { path }) } else { Ok(path) }
    }

    fn tree(&mut self, path: PathBuf, depth: usize) -> Result<Solid, SolidError> {
        let found = std::fs::canonicalize(&path).map_err(|source| IoError::from_system(&path, source))?;
        if let Some(first) = self.open.iter().position(|(open, _)| *open == found) {
            let mut files: Vec<PathBuf> = self.open[first..].iter().map(|(_, named)| named.clone()).collect();
            files.push(path);
            return Err(SolidError::Cycle { files });
        }
        let text = String::from_utf8(read_file(&path)?)
            .map_err(|_| IoError::malformed(&path, "the text has bytes that are not UTF-8", "save it as UTF-8"))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let outer = std::mem::replace(&mut self.folder, folder);
        self.open.push((found, path.clone()));
        let solid = tree::parse(&path, &text, self, depth);
        self.open.pop();
        self.folder = outer;
        solid
    }

    /// A mesh or a model.
    fn leaf(&mut self, path: PathBuf) -> Result<Solid, SolidError> {
        if let Some(solid) = self.read.get(&path) {
            return Ok(solid.clone());
        }
        let solid = if has_suffix(&path, MODEL_SUFFIX) {
            (self.models)(&path)?
        } else {
            let mesh = read_mesh(&path)?;
            check_closed(&mesh).map_err(|source| SolidError::Mesh { path: path.clone(), source })?;
            Solid::Mesh(Arc::new(mesh))
        };
        self.read.insert(path, solid.clone());
        Ok(solid)
    }
}

impl Operands for SolidFiles<'_> {
    fn file(&mut self, path: &Path, depth: usize) -> Result<Solid, SolidError> {
        let path = self.found(path)?;
        if has_suffix(&path, TREE_SUFFIX) {
            self.tree(path, depth)
        } else if has_suffix(&path, MODEL_SUFFIX) || MeshFormat::from_path(&path).is_ok() {
            self.leaf(path)
        } else {
            let suffix = path.extension().map(|suffix| suffix.to_string_lossy().into_owned());
            Err(IoError::UnknownSuffix { path, kind: "solid", suffix, known: suffixes() }.into())
        }
    }

    fn footprints(&mut self, path: &Path) -> Result<Vec<Footprint>, SolidError> {
        Ok(read_footprints(&self.found(path)?)?)
    }
}

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(suffix))
}

/// Refuses a mesh with holes here, where its file is known.
fn check_closed(mesh: &Mesh) -> Result<(), FieldError> {
    let topology = topology(mesh)?;
    if topology.closed { Ok(()) } else { Err(FieldError::Open { boundary_edges: topology.boundary_edges }) }
}
