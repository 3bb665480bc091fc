//! What files of any kind hold, to be shown.

use std::path::{Path, PathBuf};

use zeroset::cloud::{Attributes, Cloud};
use zeroset::feature::Features;
use zeroset::mesh::Mesh;
use zeroset::model::{MeshParams, ModelError, Solid, evaluate, mesh};
use zeroset::monitor::Monitor;
use zeroset_io::solid::{MODEL_SUFFIX, TREE_SUFFIX};
use zeroset_io::{FeatureFormat, LinearUnit, read_features, shown};

use crate::error::CliError;
use crate::input::{CloudOrMesh, cloud_or_mesh, read_cloud_or_mesh};
use crate::model::open;

/// What all files hold.
#[derive(Debug, Default)]
pub(crate) struct Content {
    /// Clouds, and meshes with those of models, in the order of the files.
    pub(crate) items: Vec<Item>,
    /// Models.
    pub(crate) solids: Vec<(String, Solid)>,
    /// Features.
    pub(crate) features: Vec<Features>,
    /// The unit that the first file states.
    pub(crate) unit: Option<LinearUnit>,
}

/// Points or triangles.
#[derive(Debug)]
pub(crate) enum Item {
    /// Points.
    Cloud(Cloud),
    /// Triangles.
    Mesh(Mesh),
}

impl Item {
    /// What was measured beside the positions.
    pub(crate) fn attributes(&self) -> &Attributes {
        match self {
            Self::Cloud(cloud) => &cloud.attributes,
            Self::Mesh(mesh) => &mesh.attributes,
        }
    }

    /// Local positions, and the offset to world coordinates.
    pub(crate) fn positions(&self) -> (&[[f64; 3]], [f64; 3]) {
        match self {
            Self::Cloud(cloud) => (&cloud.points, cloud.world_from_local),
            Self::Mesh(mesh) => (&mesh.vertices, mesh.world_from_local),
        }
    }
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

/// Whether a file holds points or triangles, rather than what they can be coloured by.
pub(crate) fn is_input(path: &Path) -> bool {
    !is_solid(path) && !is_features(path)
}

/// Refuses files of unknown kinds.
pub(crate) fn is_possible(path: &Path) -> Result<(), CliError> {
    if !is_solid(path) && !is_features(path) {
        cloud_or_mesh(path, "cloud, mesh, model or feature", FURTHER)?;
    }
    Ok(())
}

impl Content {
    pub(crate) fn read(files: &[PathBuf], monitor: &dyn Monitor) -> Result<Self, CliError> {
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
pub(crate) fn reference(path: &Path, monitor: &dyn Monitor) -> Result<Item, CliError> {
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

/// How far points lie off a model, with the sign of F: its value over its slope, which is the distance near the surface. `name` is the model's in messages.
pub(crate) fn off_model(
    cloud: &Cloud,
    name: &str,
    solid: &Solid,
    monitor: &dyn Monitor,
) -> Result<Vec<Option<f64>>, CliError> {
    let world: Vec<[f64; 3]> = (0..cloud.len()).map(|i| cloud.world(i)).collect();
    let failed = |source| match source {
        ModelError::Cancelled(_) => CliError::Interrupted,
        source => CliError::Model { what: name.to_owned(), source },
    };
    let found = evaluate(solid, &world, monitor).map_err(failed)?;
    let off = |(value, gradient): (&f64, &[f64; 3])| {
        let slope = gradient.iter().map(|c| c * c).sum::<f64>().sqrt();
        (slope > 0.0).then(|| value / slope)
    };
    Ok(found.values.iter().zip(&found.gradients).map(off).collect())
}
