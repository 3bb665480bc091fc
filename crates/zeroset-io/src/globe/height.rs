//! Units of heights.

use super::GlobeError;
use crate::epsg;

/// Vertical systems whose heights are not in metres, and their units in metres. Out of version 11.022 of the EPSG data set.
const UNITS: [(u32, f64); 9] = [
    (5702, US_SURVEY_FOOT),
    (5754, 0.304_800_749_1),
    (6130, FOOT),
    (6131, FOOT),
    (6132, FOOT),
    (6360, US_SURVEY_FOOT),
    (8050, FOOT),
    (8052, US_SURVEY_FOOT),
    (8228, FOOT),
];
const FOOT: f64 = 0.3048;
const US_SURVEY_FOOT: f64 = 1200.0 / 3937.0;

/// First and last code of runs of systems of depths, ascending: between the two no code stands for heights. Out of the same.
const DEPTHS: [(u32, u32); 24] = [
    (5336, 5336),
    (5612, 5612),
    (5614, 5614),
    (5706, 5706),
    (5715, 5715),
    (5734, 5734),
    (5739, 5739),
    (5789, 5789),
    (5831, 5831),
    (5861, 5867),
    (5873, 5873),
    (6357, 6359),
    (7976, 7976),
    (8051, 8051),
    (8053, 8053),
    (8358, 8378),
    (8897, 8897),
    (9287, 9288),
    (9672, 9672),
    (10150, 10151),
    (10349, 10349),
    (10364, 10379),
    (10547, 10552),
    (10649, 10678),
];

/// Codes of GeoTIFF 1.0 for vertical systems, which state no unit.
const WITHOUT_UNIT: [std::ops::RangeInclusive<u32>; 2] = [5001..=5033, 5101..=5106];

/// The unit of heights in metres: that of the vertical system in the text of a reference system. `None` if it states none.
pub(super) fn metres(crs: &str) -> Result<Option<f64>, GlobeError> {
    let node = epsg::vertical_node(crs);
    if node.is_some_and(points_down) {
        return Err(GlobeError::Depths);
    }
    let code = epsg::vertical_code(crs);
    if code.is_some_and(|code| DEPTHS.iter().any(|(first, last)| (*first..=*last).contains(&code))) {
        return Err(GlobeError::Depths);
    }
    Ok(node.and_then(unit_of_wkt).or_else(|| code.and_then(unit_of_code)))
}

fn unit_of_code(code: u32) -> Option<f64> {
    if WITHOUT_UNIT.iter().any(|codes| codes.contains(&code)) {
        return None;
    }
    Some(UNITS.iter().find(|(known, _)| *known == code).map_or(1.0, |(_, metres)| *metres))
}

/// The first unit of a vertical system in WKT: `UNIT["name",metres]`, `LENGTHUNIT["name",metres]`.
fn unit_of_wkt(node: &str) -> Option<f64> {
    let unit = &node[node.find("UNIT[")? + "UNIT[".len()..];
    // The name is quoted and may hold commas.
    let after_name = unit.splitn(3, '"').nth(2)?.trim_start_matches([',', ' ']);
    let factor = after_name.split([',', ']']).next()?.trim();
    factor.parse().ok().filter(|metres: &f64| metres.is_normal() && *metres > 0.0)
}

/// Whether the axis of a vertical system in WKT points down: `AXIS["name",DOWN]`, or as a parameter in WKT of ESRI.
fn points_down(node: &str) -> bool {
    let axis = node.find("AXIS[").map(|at| &node[at..]);
    let direction = axis.and_then(|axis| axis.splitn(3, '"').nth(2)).map(|rest| rest.trim_start_matches([',', ' ']));
    direction.is_some_and(|word| word.get(..4).is_some_and(|word| word.eq_ignore_ascii_case("down")))
        || node.contains("\"Direction\",-1")
}
