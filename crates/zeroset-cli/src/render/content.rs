//! What the files hold.

use std::path::{Path, PathBuf};

use zeroset::cloud::Cloud;
use zeroset::feature::Features;
use zeroset::mesh::Mesh;
use zeroset::model::{MeshParams, Solid, mesh};
use zeroset::monitor::Monitor;
use zeroset_io::solid::{MODEL_SUFFIX, TREE_SUFFIX};
use zeroset_io::{FeatureFormat, LinearUnit, read_features, shown};

use crate::error::CliError;
use crate::input::{CloudOrMesh, cloud_or_mesh, read_cloud_or_mesh};
use crate::model::open;

/// What all files hold.
#[derive(Debug, Default)]
pub(super) struct Content {
    /// Clouds, and meshes with those of models, in the order of the files.
    pub(super) items: Vec<Item>,
    /// Models.
    pub(super) solids: Vec<(String, Solid)>,
    /// Features.
    pub(super) features: Vec<Features>,
    /// The unit that the first file states.
    pub(super) unit: Option<LinearUnit>,
}

/// Points or triangles.
#[derive(Debug)]
pub(super) enum Item {
    /// Points.
    Cloud(Cloud),
    /// Triangles.
    Mesh(Mesh),
}

/// What else there is beside clouds and meshes.
const FURTHER: &[&str] = &[MODEL_SUFFIX, TREE_SUFFIX, "json"];

fn has_suffix(path: &Path, suffix: &str) -> bool {
    path.extension().is_some_and(|own| own.eq_ignore_ascii_case(suffix))
}

fn is_solid(path: &Path) -> bool {
    has_suffix(path, MODEL_SUFFIX) || has_suffix(path, TREE_SUFFIX)
}

fn is_features(path: &Path) -> bool {
    matches!(FeatureFormat::from_path(path), Ok(FeatureFormat::Json)) && has_suffix(path, "json")
}

/// Refuses files of unknown kinds.
pub(super) fn is_possible(path: &Path) -> Result<(), CliError> {
    if !is_solid(path) && !is_features(path) {
        cloud_or_mesh(path, "cloud, mesh, model or feature", FURTHER)?;
    }
    Ok(())
}

impl Content {
    pub(super) fn read(files: &[PathBuf], monitor: &dyn Monitor) -> Result<Self, CliError> {
        let mut content = Self::default();
        for path in files {
            monitor.stage(&format!("reading {}", shown(path)));
            if is_features(path) {
                content.features.push(read_features(path)?.features);
            } else if is_solid(path) {
                let solid = open(&path.to_string_lossy())?.solid;
                content.items.push(Item::Mesh(surface_of(&solid, path, monitor)?));
                content.solids.push((shown(path), solid));
            } else {
                let (item, unit) = item_of(path)?;
                content.unit = content.unit.or(unit);
                content.items.push(item);
            }
        }
        Ok(content)
    }
}

/// Something to measure distances to.
pub(super) fn reference(path: &Path, monitor: &dyn Monitor) -> Result<Item, CliError> {
    monitor.stage(&format!("reading {}", shown(path)));
    if is_features(path) {
        return Err(CliError::Usage(format!(
            "{}: distances are measured to clouds, meshes and models, not to features",
            shown(path)
        )));
    }
    if is_solid(path) {
        return Ok(Item::Mesh(surface_of(&open(&path.to_string_lossy())?.solid, path, monitor)?));
    }
    Ok(item_of(path)?.0)
}

fn item_of(path: &Path) -> Result<(Item, Option<LinearUnit>), CliError> {
    let format = cloud_or_mesh(path, "cloud, mesh, model or feature", FURTHER)?;
    Ok(match read_cloud_or_mesh(path, format)? {
        CloudOrMesh::Cloud(cloud, _, report) => (Item::Cloud(cloud), report.and_then(|report| report.unit)),
        CloudOrMesh::Mesh(mesh, _) => (Item::Mesh(mesh), None),
    })
}

fn surface_of(solid: &Solid, path: &Path, monitor: &dyn Monitor) -> Result<Mesh, CliError> {
    let made = mesh(solid, &MeshParams::default(), monitor);
    Ok(made.map_err(|source| CliError::Model { what: shown(path), source })?.0)
}
