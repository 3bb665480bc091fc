//! Sections as DXF.

use super::{Section, SectionLevel};
use crate::WriteOptions;
use crate::drawing::{Closing, Drawing};
use crate::mesh::world;
use crate::number::trimmed;

/// Colours that layers get in turn, out of the palette that all programs share: red to magenta, without white.
const COLORS: [u8; 6] = [1, 5, 3, 6, 4, 2];

/// The content of a file.
pub(super) fn text(section: &Section, options: &WriteOptions) -> String {
    let at = |p: &[f64; 3]| world(*p, section.world_from_local);
    let names: Vec<String> = (1..).zip(&section.levels).map(|(number, level)| layer(number, level)).collect();
    let mut layers: Vec<(&str, u8)> = Vec::new();
    for name in &names {
        if layers.iter().all(|(known, _)| known != name) {
            layers.push((name, COLORS[layers.len() % COLORS.len()]));
        }
    }
    let all = section.levels.iter().flat_map(|level| &level.lines).flat_map(|line| &line.positions).map(at);
    let mut file = Drawing::new(&options.comment_lines(section.crs.as_deref()), all, &layers);
    for (name, level) in names.iter().zip(&section.levels) {
        for line in &level.lines {
            let closing = if line.closed { Closing::Closed } else { Closing::Open };
            file.polyline(name, closing, line.positions.iter().map(at));
        }
    }
    file.finish()
}

/// The name of a layer. A millionth of a unit tells heights apart, and hides what f64 does to steps of 0.1.
fn layer(number: usize, level: &SectionLevel) -> String {
    match level.height {
        Some(height) => format!("CONTOUR_{}", trimmed(height, 6).replace('.', "_")),
        None => format!("SECTION_{number}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::section::SectionPlane;

    #[test]
    fn names_of_layers_are_those_of_release_12() {
        let name = |height| {
            let plane = SectionPlane { point: [0.0; 3], normal: [0.0, 0.0, 1.0] };
            layer(3, &SectionLevel { plane, height, lines: Vec::new() })
        };
        for (height, expected) in [
            (Some(12.5), "CONTOUR_12_5"),
            (Some(-3.0), "CONTOUR_-3"),
            (Some(0.1 + 0.2), "CONTOUR_0_3"),
            (Some(-0.0), "CONTOUR_0"),
            (None, "SECTION_3"),
        ] {
            assert_eq!(name(height), expected);
        }
        let longest = name(Some(-99_999_999_999.25));
        assert!(longest.len() <= 31 && longest.bytes().all(|b| b.is_ascii_uppercase() || b"0123456789-_".contains(&b)));
    }
}
