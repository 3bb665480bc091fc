//! Lines and polygons of a GeoJSON (RFC 7946), in the reference system that its member `crs` names.

use geojson::{GeoJson, Geometry, GeometryValue, JsonObject, Position};

use super::{Gathered, Item};
use crate::IoError;
use crate::format::sniff;

pub(super) fn read(gathered: &mut Gathered<'_>, bytes: &[u8]) -> Result<(), IoError> {
    let path = gathered.path;
    if !bytes.trim_ascii_start().starts_with(b"{") {
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "GeoJSON", looks: sniff(bytes) });
    }
    let file: GeoJson = serde_json::from_slice(bytes).map_err(|error| crate::planar::damaged_json(path, &error))?;
    let members = match &file {
        GeoJson::FeatureCollection(collection) => &collection.foreign_members,
        GeoJson::Feature(feature) => &feature.foreign_members,
        GeoJson::Geometry(geometry) => &geometry.foreign_members,
    };
    gathered.file.crs = members.as_ref().and_then(crs);
    match file {
        GeoJson::FeatureCollection(collection) => {
            for (i, feature) in (0..).zip(&collection.features) {
                match &feature.geometry {
                    Some(geometry) => add(gathered, ("feature", i), geometry)?,
                    None => gathered.pass_over(),
                }
            }
        }
        GeoJson::Feature(feature) => match &feature.geometry {
            Some(geometry) => add(gathered, ("feature", 0), geometry)?,
            None => gathered.pass_over(),
        },
        GeoJson::Geometry(geometry) => add(gathered, ("geometry", 0), &geometry)?,
    }
    Ok(())
}

fn add(gathered: &mut Gathered<'_>, item: Item, geometry: &Geometry) -> Result<(), IoError> {
    match &geometry.value {
        GeometryValue::Point { .. } | GeometryValue::MultiPoint { .. } => gathered.pass_over(),
        GeometryValue::LineString { coordinates } => line(gathered, item, coordinates)?,
        GeometryValue::MultiLineString { coordinates } => {
            coordinates.iter().try_for_each(|coordinates| line(gathered, item, coordinates))?;
        }
        GeometryValue::Polygon { coordinates } => polygon(gathered, item, coordinates)?,
        GeometryValue::MultiPolygon { coordinates } => {
            coordinates.iter().try_for_each(|coordinates| polygon(gathered, item, coordinates))?;
        }
        GeometryValue::GeometryCollection { geometries } => {
            geometries.iter().try_for_each(|geometry| add(gathered, item, geometry))?;
        }
    }
    Ok(())
}

fn line(gathered: &mut Gathered<'_>, item: Item, coordinates: &[Position]) -> Result<(), IoError> {
    let positions = positions(gathered, item, coordinates)?;
    gathered.line(item, &positions)
}

fn polygon(gathered: &mut Gathered<'_>, item: Item, coordinates: &[Vec<Position>]) -> Result<(), IoError> {
    let rings = coordinates.iter().map(|ring| positions(gathered, item, ring)).collect::<Result<Vec<_>, _>>()?;
    gathered.polygon(item, &rings)
}

fn positions(gathered: &Gathered<'_>, (item, index): Item, coordinates: &[Position]) -> Result<Vec<[f64; 3]>, IoError> {
    let position = |position: &Position| match *position.as_slice() {
        [x, y, z, ..] => Ok([x, y, z]),
        [x, y] if gathered.plan.is_some() => Ok([x, y, 0.0]),
        _ => {
            let what = format!("{item} {index} has positions without heights, and a surface needs them");
            Err(IoError::malformed(gathered.path, what, "give each position as [x, y, z]"))
        }
    };
    coordinates.iter().map(position).collect()
}

/// The reference system: the member `crs` of the format's 2008 version, or what `zeroset` writes where there is no code.
fn crs(members: &JsonObject) -> Option<String> {
    let named = || members.get("crs")?.get("properties")?.get("name")?.as_str();
    let text = named().or_else(|| members.get("crs_text")?.as_str())?;
    let code = text.strip_prefix("urn:ogc:def:crs:EPSG:").and_then(|rest| rest.rsplit(':').next());
    Some(code.map_or_else(|| text.to_owned(), |code| format!("EPSG:{code}")))
}
