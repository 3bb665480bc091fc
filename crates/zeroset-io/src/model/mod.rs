//! Models: `.zset`, as `docs/format.md` describes it.
//!
//! A header in JSON tells what is there and where; arrays of numbers follow, each with a checksum. The same model gives the same bytes.
//!
//! Counts and sizes are held against the size of the file before memory is taken; a model takes at most some 20 times the size of its file.

mod container;
mod fitted;
mod header;
mod tree;

use std::collections::BTreeMap;
use std::path::Path;

use zeroset::model::{Model, Provenance};

use crate::IoError;
use crate::format::by_suffix;
use crate::input::read_file;
use crate::output::write_file;
use crate::solid::MODEL_SUFFIX;
use container::{Reader, Writer};
use header::{Header, Provenance as ProvenanceHeader};

/// Whether a name is that of a model: its suffix is `zset`, in upper or lower case.
#[must_use]
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case(MODEL_SUFFIX))
}

/// Refuses a name that is not that of a model.
///
/// # Errors
/// [`IoError::UnknownSuffix`], which tells the suffix of models.
pub fn check_model_suffix(path: &Path) -> Result<(), IoError> {
    by_suffix(path, "model", &[(MODEL_SUFFIX, ())])
}

/// Whether no coordinate is infinite, NaN, or beyond all grids.
fn is_possible(p: &[f64; 3]) -> bool {
    p.iter().all(|c| c.abs() <= crate::MAX_COORDINATE)
}

/// Reads a model.
///
/// # Errors
/// If the file cannot be read, is no model, of a version that is not known, or damaged. Whether shapes have a volume and meshes are closed is
/// told by [`Solid::field`](zeroset::model::Solid::field).
pub fn read_model(path: &Path) -> Result<Model, IoError> {
    read_model_bytes(path, &read_file(path)?)
}

/// Reads a model from the content of a file; `path` is its name in messages.
///
/// # Errors
/// As for [`read_model`].
pub fn read_model_bytes(path: &Path, bytes: &[u8]) -> Result<Model, IoError> {
    let (header, arrays): (Header, Reader<'_>) = container::open(path, bytes)?;
    let damaged = |what: String| IoError::damaged(path, what);
    let fitted = fitted::read(&header.models, &arrays).map_err(damaged)?;
    let solid = tree::read(header.solid, &header.meshes, &fitted, &arrays).map_err(damaged)?;
    let ProvenanceHeader { zeroset, inputs, parameters } = header.provenance;
    let provenance = Provenance { version: zeroset, inputs, parameters: parameters.into_iter().collect() };
    Ok(Model { solid, crs: header.crs, provenance })
}

/// Writes a model; returns the number of bytes.
///
/// # Errors
/// If the name does not end in `.zset`, the file cannot be written, the solid is more than 200 operands deep, or a number in it is not finite
/// or beyond [`MAX_COORDINATE`](crate::MAX_COORDINATE).
pub fn write_model(path: &Path, model: &Model) -> Result<u64, IoError> {
    check_model_suffix(path)?;
    let mut arrays = Writer::default();
    let refused =
        |what: String| IoError::malformed(path, what, "it could not be read again, so change the solid first");
    let table = tree::write(&model.solid, &mut arrays).map_err(refused)?;
    let Provenance { version, inputs, parameters } = &model.provenance;
    let header = Header {
        crs: model.crs.clone(),
        provenance: ProvenanceHeader {
            zeroset: version.clone(),
            inputs: inputs.clone(),
            parameters: parameters.iter().cloned().collect(),
        },
        models: fitted::write(&table.fitted, &mut arrays).map_err(refused)?,
        meshes: table.meshes,
        solid: table.nodes,
        arrays: BTreeMap::new(),
    };
    write_file(path, |sink| arrays.write(header, sink))
}
