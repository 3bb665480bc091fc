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

/// How many points were sifted, and what of them was left out.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Sifted {
    read: u64,
    kept: u64,
    non_finite: u64,
    withheld: u64,
}

impl Sifted {
    pub(crate) fn and(self, other: Self) -> Self {
        Self {
            read: self.read + other.read,
            kept: self.kept + other.kept,
            non_finite: self.non_finite + other.non_finite,
            withheld: self.withheld + other.withheld,
        }
    }
}

impl Columns {
    /// Leaves out what cannot be used, and checks the rest.
    pub(crate) fn finish(mut self, path: &Path, format: CloudFormat) -> Result<WorldCloud, IoError> {
        let sifted = self.sift(path, 0)?;
        let report = self.report(path, format, sifted)?;
        Ok(WorldCloud { points: self.points, attributes: self.attributes, crs: self.crs, report })
    }

    /// Leaves out what cannot be used. `first` is the place of the first point in its file.
    pub(crate) fn sift(&mut self, path: &Path, first: u64) -> Result<Sifted, IoError> {
        debug_assert!(crate::mesh::check_attributes(path, self.points.len(), &self.attributes).is_ok());
        let finite = |p: &[f64; 3]| p.iter().all(|c| c.is_finite());
        let is_withheld = |i: usize| self.withheld.get(i) == Some(&true);
        let read = self.points.len() as u64;
        let keep: Vec<bool> = self.points.iter().enumerate().map(|(i, p)| finite(p) && !is_withheld(i)).collect();
        let count = |marks: &mut dyn Iterator<Item = bool>| marks.filter(|mark| *mark).count() as u64;
        let sifted = Sifted {
            read,
            kept: count(&mut keep.iter().copied()),
            non_finite: count(&mut self.points.iter().map(|p| !finite(p))),
            withheld: count(&mut self.withheld.iter().copied()),
        };
        if sifted.kept < read {
            keep_marked(&mut self.points, &keep);
            keep_marked_in(&mut self.attributes.colors, &keep);
            keep_marked_in(&mut self.attributes.intensities, &keep);
            keep_marked_in(&mut self.attributes.classes, &keep);
        }
        check_size(path, "point", &self.points, first)?;
        Ok(sifted)
    }

    /// What there is to say about all that was sifted; the columns are those of the last part. An error if nothing is left.
    pub(crate) fn report(&self, path: &Path, format: CloudFormat, sifted: Sifted) -> Result<ReadReport, IoError> {
        let (points_read, points) = (sifted.kept, sifted.read + self.invalid);
        let (non_finite, withheld) = (sifted.non_finite + self.invalid, sifted.withheld);
        if points_read == 0 {
            let path = path.to_path_buf();
            return Err(match (points, withheld, non_finite) {
                (0, ..) => IoError::NoPoints { path },
                (_, 1.., 0) => IoError::AllWithheld { path, points },
                _ => IoError::NoFinitePoints { path, points },
            });
        }
        Ok(ReadReport {
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
            facts: self.facts.clone(),
            notes: self.notes.clone(),
        })
    }
}

/// Refuses coordinates beyond [`MAX_COORDINATE`]. They are finite here. `first` is the place of the first in its file.
pub(crate) fn check_size(path: &Path, item: &'static str, points: &[[f64; 3]], first: u64) -> Result<(), IoError> {
    for (index, point) in points.iter().enumerate() {
        if let Some(value) = point.iter().find(|c| c.abs() > MAX_COORDINATE) {
            return Err(IoError::TooLarge {
                path: path.to_path_buf(),
                item,
                index: first + index as u64,
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

/// Whether colours need 16 bits.
pub(crate) fn is_wide<'a>(mut channels: impl Iterator<Item = &'a u16>) -> bool {
    channels.any(|v| *v > 255)
}

/// As [`colors_from_values`] for integers, of which some are known to need 16 bits.
pub(crate) fn colors_from_u16(values: &[[u16; 3]], are_wide: bool) -> Vec<[u8; 3]> {
    if are_wide {
        // 65535 = 255 * 257, so this rounds to the nearest.
        values.iter().map(|v| v.map(|c| ((u32::from(c) + 128) / 257) as u8)).collect()
    } else {
        values.iter().map(|v| v.map(|c| c as u8)).collect()
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
        assert_eq!(colors_from_u16(&[[0, 128, 255]], false), [[0, 128, 255]]);
        assert_eq!(colors_from_u16(&[[0, 0x8080, 0xFFFF]], true), [[0, 0x80, 0xFF]]);
        assert!(is_wide([255, 256].iter()) && !is_wide([0, 255].iter()));
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
