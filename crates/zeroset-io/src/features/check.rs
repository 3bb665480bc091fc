//! What features must be like before they are written or after they were read.

use std::path::Path;

use zeroset::cloud::Cloud;
use zeroset::feature::Features;

use super::FeatureOutput;
use crate::mesh::{check_attributes, check_points};
use crate::{IoError, MAX_COORDINATE};

/// How far the length of a normal may be from 1.
const UNIT: f64 = 1e-6;

/// Looks at every number and every index.
pub(super) fn sound(path: &Path, features: &Features) -> Result<(), IoError> {
    let wrong = |what: String| Err(IoError::malformed(path, what, "correct it there, or write the file again"));
    let positions = |item: &str, i: usize, positions: &mut dyn Iterator<Item = [f64; 3]>| {
        let offset = features.world_from_local;
        let worst = positions
            .flat_map(|p| [0, 1, 2].map(|a| p[a] + offset[a]))
            .find(|c| !c.is_finite() || c.abs() > MAX_COORDINATE);
        worst.map_or(Ok(()), |c| wrong(format!("{item} {i} has the coordinate {c:e}")))
    };
    let lists =
        |item: &str, i: usize, name: &str, ids: &[usize], count: usize| match ids.iter().find(|id| **id >= count) {
            Some(id) => wrong(format!("{item} {i} names {name} {id} of {count}")),
            None => Ok(()),
        };
    let figure = |item: &str, i: usize, name: &str, value: f64| {
        if value.is_finite() && value >= 0.0 { Ok(()) } else { wrong(format!("{item} {i} has the {name} {value}")) }
    };
    for (i, plane) in features.planes.iter().enumerate() {
        let length = plane.normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        if !length.is_finite() || (length - 1.0).abs() > UNIT {
            return wrong(format!("plane {i} has a normal of length {length}, not 1"));
        }
        let offset = features.world_offset(i);
        if !offset.is_finite() || offset.abs() > 2.0 * MAX_COORDINATE {
            return wrong(format!("plane {i} has the offset {offset:e}"));
        }
        figure("plane", i, "area", plane.area)?;
        figure("plane", i, "rms", plane.rms.unwrap_or(0.0))?;
        if let Some(ring) = plane.rings.iter().find(|ring| ring.len() < 3) {
            return wrong(format!("plane {i} has a ring of {} positions, fewer than 3", ring.len()));
        }
        positions("plane", i, &mut plane.rings.iter().flatten().copied())?;
    }
    for (i, edge) in features.edges.iter().enumerate() {
        figure("edge", i, "angle", edge.angle)?;
        if edge.polyline.len() < 2 {
            return wrong(format!("edge {i} has {} positions, fewer than 2", edge.polyline.len()));
        }
        positions("edge", i, &mut edge.polyline.iter().copied())?;
        lists("edge", i, "plane", &edge.planes, features.planes.len())?;
    }
    for (i, corner) in features.corners.iter().enumerate() {
        positions("corner", i, &mut std::iter::once(corner.position))?;
        lists("corner", i, "plane", &corner.planes, features.planes.len())?;
        lists("corner", i, "edge", &corner.edges, features.edges.len())?;
    }
    Ok(())
}

/// The cloud, if the features are its.
pub(super) fn cloud<'a>(path: &Path, output: FeatureOutput<'a>) -> Result<&'a Cloud, IoError> {
    let Some(cloud) = output.cloud else {
        let what = "PLY holds the points, and none are at hand";
        return Err(IoError::malformed(path, what, "write json, geojson, obj or dxf"));
    };
    check_points(path, "point", &cloud.points)?;
    check_points(path, "point", &[cloud.world_from_local])?;
    check_attributes(path, cloud.len(), &cloud.attributes)?;
    let values = output.features.points.len();
    if values != cloud.len() {
        let (path, points) = (path.to_path_buf(), cloud.len());
        return Err(IoError::AttributeLength { path, attribute: "features", values, points });
    }
    Ok(cloud)
}
