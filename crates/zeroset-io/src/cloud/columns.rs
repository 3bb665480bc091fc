//! What a reader hands over, and the sifting that all formats share.

use std::path::Path;

use zeroset::cloud::Attributes;

use super::report::{LinearUnit, ReadReport, Source, WorldCloud, attribute_names};
use crate::{CloudFormat, IoError, MAX_COORDINATE};

/// Points as a file holds them: world coordinates, nothing left out yet.
#[derive(Debug, Default)]
pub(crate) struct Columns {
    pub(crate) points: Vec<[f64; 3]>,
    pub(crate) attributes: Attributes,
    /// Marks points to leave out; empty if there is none.
    pub(crate) withheld: Vec<bool>,
    /// The count that the file states.
    pub(crate) declared: Option<u64>,
    /// Points that the reader itself left out as invalid.
    pub(crate) invalid: u64,
    pub(crate) crs: Option<String>,
    pub(crate) unit: Option<LinearUnit>,
    pub(crate) facts: Vec<(&'static str, String)>,
    pub(crate) notes: Vec<String>,
}

impl Columns {
    /// Leaves out what cannot be used, and checks the rest.
    pub(crate) fn finish(mut self, path: &Path, format: CloudFormat) -> Result<WorldCloud, IoError> {
        let read = self.points.len() as u64;
        if read == 0 && self.invalid == 0 {
            return Err(IoError::NoPoints { path: path.to_path_buf() });
        }
        debug_assert!(crate::mesh::check_attributes(path, self.points.len(), &self.attributes).is_ok());

        let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
        let non_finite = self.points.iter().filter(|p| !finite(p)).count() as u64;
        let withheld = self.withheld.iter().filter(|w| **w).count() as u64;
        if non_finite > 0 || withheld > 0 {
            let keep: Vec<bool> = if self.withheld.is_empty() {
                self.points.iter().map(finite).collect()
            } else {
                self.points.iter().zip(&self.withheld).map(|(p, w)| finite(p) && !w).collect()
            };
            keep_marked(&mut self.points, &keep);
            keep_marked_in(&mut self.attributes.colors, &keep);
            keep_marked_in(&mut self.attributes.intensities, &keep);
            keep_marked_in(&mut self.attributes.classes, &keep);
        }
        if self.points.is_empty() {
            let (path, points) = (path.to_path_buf(), read + self.invalid);
            return Err(if withheld > 0 && non_finite == 0 {
                IoError::AllWithheld { path, points }
            } else {
                IoError::NoFinitePoints { path, points }
            });
        }
        check_size(path, "point", &self.points)?;

        let (points_read, non_finite) = (self.points.len() as u64, non_finite + self.invalid);
        let report = ReadReport {
            format,
            sources: vec![Source {
                path: path.to_path_buf(),
                format,
                points: points_read,
                non_finite,
                withheld,
                attributes: attribute_names(&self.attributes),
            }],
            points_declared: self.declared,
            points_read,
            non_finite,
            withheld,
            unit: self.unit,
            crs: self.crs.clone(),
            facts: self.facts,
            notes: self.notes,
        };
        Ok(WorldCloud { points: self.points, attributes: self.attributes, crs: self.crs, report })
    }
}

/// Refuses coordinates beyond [`MAX_COORDINATE`]. They are finite here.
pub(crate) fn check_size(path: &Path, item: &'static str, points: &[[f64; 3]]) -> Result<(), IoError> {
    for (index, point) in points.iter().enumerate() {
        if let Some(value) = point.iter().find(|c| c.abs() > MAX_COORDINATE) {
            return Err(IoError::TooLarge {
                path: path.to_path_buf(),
                item,
                index: index as u64,
                value: *value,
                limit: MAX_COORDINATE,
            });
        }
    }
    Ok(())
}

fn keep_marked<T>(values: &mut Vec<T>, keep: &[bool]) {
    let mut marks = keep.iter();
    values.retain(|_| marks.next().copied().unwrap_or(false));
}

fn keep_marked_in<T>(values: &mut Option<Vec<T>>, keep: &[bool]) {
    if let Some(values) = values {
        keep_marked(values, keep);
    }
}

/// Colours of any scale as 8 bits.
///
/// The files say nothing about the scale, so the largest value of the file decides: at most 1 with fractions is a share
/// of full brightness, at most 255 is 8 bits, anything more is 16 bits.
pub(crate) fn colors_from_values(values: &[[f32; 3]]) -> Vec<[u8; 3]> {
    let largest = values.iter().flatten().fold(0.0_f32, |a, b| a.max(*b));
    let fractions = values.iter().flatten().any(|v| v.fract() != 0.0);
    let factor = if largest <= 1.0 && fractions {
        255.0
    } else if largest <= 255.0 {
        1.0
    } else {
        255.0 / 65535.0
    };
    // `as` takes NaN to 0 and cuts at both ends.
    values.iter().map(|v| v.map(|c| (c * factor).round() as u8)).collect()
}

/// As [`colors_from_values`] for integers.
pub(crate) fn colors_from_u16(values: &[[u16; 3]]) -> Vec<[u8; 3]> {
    if values.iter().flatten().all(|v| *v <= 255) {
        values.iter().map(|v| v.map(|c| c as u8)).collect()
    } else {
        // 65535 = 255 * 257, so this rounds to the nearest.
        values.iter().map(|v| v.map(|c| ((u32::from(c) + 128) / 257) as u8)).collect()
    }
}

/// A classification code out of a value of any type; codes that are none become 0, "never classified".
pub(crate) fn class_from_value(value: f64) -> u8 {
    if (0.0..=255.0).contains(&value) { value as u8 } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_tells_the_scale_of_colours() {
        assert_eq!(colors_from_values(&[[0.0, 0.5, 1.0]]), [[0, 128, 255]]);
        assert_eq!(colors_from_values(&[[0.0, 1.0, 1.0]]), [[0, 1, 1]]);
        assert_eq!(colors_from_values(&[[0.0, 128.0, 255.0]]), [[0, 128, 255]]);
        assert_eq!(colors_from_values(&[[0.0, 32896.0, 65535.0]]), [[0, 128, 255]]);
        assert_eq!(colors_from_values(&[[f32::NAN, -3.0, 255.0]]), [[0, 0, 255]]);
        assert_eq!(colors_from_u16(&[[0, 128, 255]]), [[0, 128, 255]]);
        assert_eq!(colors_from_u16(&[[0, 0x8080, 0xFFFF]]), [[0, 0x80, 0xFF]]);
    }

    #[test]
    fn points_and_attributes_are_sifted_together() {
        let columns = Columns {
            points: vec![[0.0; 3], [f64::NAN, 0.0, 0.0], [1.0; 3], [2.0; 3]],
            attributes: Attributes { classes: Some(vec![1, 2, 3, 4]), ..Attributes::default() },
            withheld: vec![false, false, true, false],
            ..Columns::default()
        };
        let cloud = columns.finish(Path::new("a.las"), CloudFormat::Las).unwrap();
        assert_eq!(cloud.points, [[0.0; 3], [2.0; 3]]);
        assert_eq!(cloud.attributes.classes, Some(vec![1, 4]));
        assert_eq!((cloud.report.non_finite, cloud.report.withheld, cloud.report.points_read), (1, 1, 2));
    }
}
