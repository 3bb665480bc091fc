//! Features as JSON.

use std::path::Path;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use zeroset::cloud::choose_offset;
use zeroset::feature::{Corner, Edge, FeatureKind, Features, Plane};

use super::{FeatureFile, FeatureOutput, check};
use crate::format::sniff;
use crate::mesh::world;
use crate::{IoError, LinearUnit};

/// Version of the file's shape.
const SCHEMA_VERSION: u64 = 1;

/// The part that tells whether the rest can be understood.
#[derive(Deserialize)]
struct Head {
    schema_version: Option<u64>,
}

/// The file as it is written.
#[derive(Serialize, Deserialize)]
struct File {
    schema_version: u64,
    zeroset_version: String,
    crs: Option<String>,
    unit: Option<String>,
    planes: Vec<PlaneRecord>,
    edges: Vec<EdgeRecord>,
    corners: Vec<CornerRecord>,
    #[serde(default)]
    parameters: Value,
}

#[derive(Serialize, Deserialize)]
struct PlaneRecord {
    id: usize,
    normal: [f64; 3],
    offset: f64,
    oriented: bool,
    area: f64,
    points: usize,
    rms: Option<f64>,
    polygon: Vec<Vec<[f64; 3]>>,
}

#[derive(Serialize, Deserialize)]
struct EdgeRecord {
    id: usize,
    kind: FeatureKind,
    planes: Vec<usize>,
    angle: f64,
    length: f64,
    polyline: Vec<[f64; 3]>,
}

#[derive(Serialize, Deserialize)]
struct CornerRecord {
    id: usize,
    kind: FeatureKind,
    position: [f64; 3],
    planes: Vec<usize>,
    edges: Vec<usize>,
}

/// The content of a file, with a line end.
pub(super) fn text(output: FeatureOutput<'_>) -> String {
    let features = output.features;
    let at = |p: &[f64; 3]| world(*p, features.world_from_local);
    let planes = features.planes.iter().enumerate().map(|(id, plane)| PlaneRecord {
        id,
        normal: plane.normal,
        offset: features.world_offset(id),
        oriented: plane.oriented,
        area: plane.area,
        points: plane.points,
        rms: plane.rms,
        polygon: plane.rings.iter().map(|ring| ring.iter().map(at).collect()).collect(),
    });
    let edges = features.edges.iter().enumerate().map(|(id, edge)| EdgeRecord {
        id,
        kind: edge.kind,
        planes: edge.planes.clone(),
        angle: edge.angle.to_degrees(),
        length: edge.length(),
        polyline: edge.polyline.iter().map(at).collect(),
    });
    let corners = features.corners.iter().enumerate().map(|(id, corner)| CornerRecord {
        id,
        kind: corner.kind,
        position: at(&corner.position),
        planes: corner.planes.clone(),
        edges: corner.edges.clone(),
    });
    let file = File {
        schema_version: SCHEMA_VERSION,
        zeroset_version: env!("CARGO_PKG_VERSION").to_owned(),
        crs: features.crs.clone(),
        unit: output.options.unit.map(|unit| unit.name().to_owned()),
        planes: planes.collect(),
        edges: edges.collect(),
        corners: corners.collect(),
        parameters: output.parameters.clone(),
    };
    // Plain structures with names for keys always serialise.
    let mut text = serde_json::to_string(&file).unwrap_or_default();
    text.push('\n');
    text
}

pub(super) fn read(path: &Path, text: &[u8]) -> Result<FeatureFile, IoError> {
    // Without this a list would pass for an object whose keys are left out.
    if !text.trim_ascii_start().starts_with(b"{") {
        let looks = sniff(text);
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "JSON", looks });
    }
    let damaged = |error: serde_json::Error| crate::planar::damaged_json(path, &error);
    match serde_json::from_slice::<Head>(text).map_err(damaged)?.schema_version {
        Some(SCHEMA_VERSION) => {}
        Some(version) => {
            let feature = format!("schema_version {version} of features");
            let remedy = "read it with the version of zeroset that wrote it";
            return Err(IoError::Unsupported { path: path.to_path_buf(), feature, remedy });
        }
        None => {
            let what = "it has no `schema_version`, as files of features have";
            return Err(IoError::malformed(path, what, "give a file that `zeroset features` wrote"));
        }
    }
    let file: File = serde_json::from_slice(text).map_err(damaged)?;
    numbered(path, "plane", file.planes.iter().map(|plane| plane.id))?;
    numbered(path, "edge", file.edges.iter().map(|edge| edge.id))?;
    numbered(path, "corner", file.corners.iter().map(|corner| corner.id))?;
    let world = in_world(&file);
    check::sound(path, &world)?;
    let unit = file.unit.as_deref().and_then(LinearUnit::from_name);
    Ok(FeatureFile { features: local(world), unit, parameters: file.parameters })
}

/// Numbers must count from 0, or the lists that name them mean nothing.
fn numbered(path: &Path, item: &str, ids: impl Iterator<Item = usize>) -> Result<(), IoError> {
    match ids.enumerate().find(|(place, id)| place != id) {
        Some((place, id)) => {
            let what = format!("{item} {place} of the list has the id {id}");
            Err(IoError::malformed(path, what, "number each list from 0 in its order"))
        }
        None => Ok(()),
    }
}

/// The features, with world coordinates for local ones.
fn in_world(file: &File) -> Features {
    let planes = file.planes.iter().map(|plane| Plane {
        normal: plane.normal,
        offset: plane.offset,
        oriented: plane.oriented,
        points: plane.points,
        rms: plane.rms,
        area: plane.area,
        rings: plane.polygon.clone(),
    });
    let edges = file.edges.iter().map(|edge| Edge {
        kind: edge.kind,
        planes: edge.planes.clone(),
        polyline: edge.polyline.clone(),
        angle: edge.angle.to_radians(),
    });
    let corners = file.corners.iter().map(|corner| Corner {
        kind: corner.kind,
        position: corner.position,
        planes: corner.planes.clone(),
        edges: corner.edges.clone(),
    });
    Features {
        crs: file.crs.clone(),
        planes: planes.collect(),
        edges: edges.collect(),
        corners: corners.collect(),
        ..Features::default()
    }
}

/// Takes the offset off.
fn local(mut features: Features) -> Features {
    let rings = features.planes.iter().flat_map(|plane| plane.rings.iter().flatten());
    let polylines = features.edges.iter().flat_map(|edge| &edge.polyline);
    let corners = features.corners.iter().map(|corner| &corner.position);
    let offset = choose_offset(rings.chain(polylines).chain(corners).copied().collect::<Vec<_>>().into_iter());
    let shift = |p: &mut [f64; 3]| (0..3).for_each(|a| p[a] -= offset[a]);
    for plane in &mut features.planes {
        plane.offset -= (0..3).map(|a| plane.normal[a] * offset[a]).sum::<f64>();
        plane.rings.iter_mut().flatten().for_each(shift);
    }
    features.edges.iter_mut().flat_map(|edge| &mut edge.polyline).for_each(shift);
    features.corners.iter_mut().for_each(|corner| shift(&mut corner.position));
    features.world_from_local = offset;
    features
}
