//! A collection of features in GeoJSON (RFC 7946), in the reference system of the input.

use serde::Serialize;
use serde_json::{Value, json};

use crate::{LinearUnit, WriteOptions, epsg};

/// The file. Programs look for the type in the first bytes, so it comes first, here and below.
///
/// The member `crs` of the format's 2008 version names the reference system where it has an EPSG code; else `crs_text`
/// holds what the input said.
#[derive(Serialize)]
pub(crate) struct Collection<'a> {
    #[serde(rename = "type")]
    kind: &'static str,
    generator: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    crs: Option<Value>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crs_text: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    unit: Option<&'static str>,
    features: Vec<Feature>,
}

/// A geometry with what is known of it.
#[derive(Serialize)]
pub(crate) struct Feature {
    #[serde(rename = "type")]
    kind: &'static str,
    properties: Value,
    geometry: Value,
}

pub(crate) fn feature(geometry: Value, properties: Value) -> Feature {
    Feature { kind: "Feature", properties, geometry }
}

impl<'a> Collection<'a> {
    pub(crate) fn new(crs: Option<&'a str>, options: &'a WriteOptions, features: Vec<Feature>) -> Self {
        let name = crs.and_then(epsg::code).map(|code| format!("urn:ogc:def:crs:EPSG::{code}"));
        Self {
            kind: "FeatureCollection",
            generator: &options.generator,
            crs_text: crs.filter(|_| name.is_none()),
            crs: name.map(|name| json!({ "type": "name", "properties": { "name": name } })),
            unit: options.unit.map(LinearUnit::name),
            features,
        }
    }

    /// The content of the file, with a line end.
    pub(crate) fn text(&self) -> String {
        // Plain structures with names for keys always serialise.
        let mut text = serde_json::to_string(self).unwrap_or_default();
        text.push('\n');
        text
    }
}
