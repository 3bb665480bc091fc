//! Sections as GeoJSON.

use serde_json::json;

use super::{Section, SectionLine};
use crate::WriteOptions;
use crate::collection::{Collection, feature};
use crate::mesh::world;

/// The content of a file, with a line end.
pub(super) fn text(section: &Section, options: &WriteOptions) -> String {
    let coordinates = |line: &SectionLine| -> Vec<[f64; 3]> {
        let again = line.positions.first().filter(|_| line.closed);
        line.positions.iter().chain(again).map(|p| world(*p, section.world_from_local)).collect()
    };
    let lines = (1..).zip(&section.levels).flat_map(|(number, level)| {
        level.lines.iter().map(move |line| {
            let mut properties = json!({ "level": number, "closed": line.closed });
            if let Some(height) = level.height {
                properties["height"] = height.into();
            }
            feature(json!({ "type": "LineString", "coordinates": coordinates(line) }), properties)
        })
    });
    Collection::new(section.crs.as_deref(), options, lines.collect()).text()
}
