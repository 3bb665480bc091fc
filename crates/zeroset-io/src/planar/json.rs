//! Data in the plane as JSON.

use std::fmt;
use std::path::Path;

use serde::Deserialize;
use serde::de::{Deserializer, Error as _, SeqAccess, Visitor};
use serde_json::error::Category;

use super::{PlanarData, PlanarDomain, WeightedPoint, in_range};
use crate::IoError;
use crate::format::sniff;

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    points: Vec<Row>,
    #[serde(default)]
    segments: Vec<Vec<Row>>,
    #[serde(default)]
    polygons: Vec<Vec<Row>>,
    domain: Option<Domain>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Domain {
    vertices: Vec<Row>,
    triangles: Vec<[u32; 3]>,
}

/// Most numbers of a row that are kept.
const ROW: usize = 3;

/// A list of numbers, of which only the first few are kept: a long one takes no memory.
#[derive(Clone, Copy)]
struct Row {
    values: [f64; ROW],
    count: usize,
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Numbers;
        impl<'de> Visitor<'de> for Numbers {
            type Value = Row;

            fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
                formatter.write_str("a list of numbers such as [x, y]")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Row, A::Error> {
                let mut row = Row { values: [0.0; ROW], count: 0 };
                while let Some(value) = list.next_element::<f64>()? {
                    if let Some(place) = row.values.get_mut(row.count) {
                        *place = value;
                    }
                    row.count = row.count.checked_add(1).ok_or_else(|| A::Error::custom("a list is too long"))?;
                }
                Ok(row)
            }
        }
        deserializer.deserialize_seq(Numbers)
    }
}

pub(super) fn read(path: &Path, text: &[u8]) -> Result<PlanarData, IoError> {
    // Without this a list would pass for an object whose keys are left out.
    if !text.trim_ascii_start().starts_with(b"{") {
        let what = "it does not start with `{`, as an object with `points`, `segments` or `polygons` does";
        return Err(match sniff(text) {
            Some(looks) => IoError::WrongMagic { path: path.to_path_buf(), expected: "JSON", looks: Some(looks) },
            None => IoError::malformed(path, what, "correct it, or give the file the suffix of its true format"),
        });
    }
    let file: File = serde_json::from_slice(text).map_err(|error| damaged(path, &error))?;
    let points = (0..).zip(&file.points).map(|(i, row)| point(path, i, row)).collect::<Result<_, _>>()?;
    let segments = (0..).zip(&file.segments).map(|(i, rows)| segment(path, i, rows)).collect::<Result<_, _>>()?;
    let polygons = (0..).zip(&file.polygons).map(|(i, rows)| polygon(path, i, rows)).collect::<Result<_, _>>()?;
    let domain = file.domain.map(|domain| of_domain(path, &domain)).transpose()?;
    Ok(PlanarData { points, segments, polygons, domain })
}

fn point(path: &Path, index: usize, row: &Row) -> Result<WeightedPoint, IoError> {
    let [x, y, third] = row.values;
    let weight = match row.count {
        2 => 1.0,
        3 => third,
        count => {
            let what = format!("point {index} has {count} numbers");
            return Err(IoError::malformed(path, what, "give it as [x, y] or [x, y, weight]"));
        }
    };
    in_range(path, "point", index, &[x, y])?;
    weighted(path, index, [x, y], weight)
}

/// A point with a weight that can be used.
pub(super) fn weighted(path: &Path, index: usize, position: [f64; 2], weight: f64) -> Result<WeightedPoint, IoError> {
    if weight.is_finite() && weight > 0.0 {
        Ok(WeightedPoint { position, weight })
    } else {
        let what = format!("point {index} has the weight {weight}");
        Err(IoError::malformed(path, what, "give it a positive weight, or leave the point out"))
    }
}

fn segment(path: &Path, index: usize, rows: &[Row]) -> Result<[[f64; 2]; 2], IoError> {
    let positions = positions(path, "segment", index, rows)?;
    positions.try_into().map_err(|given: Vec<_>| {
        let what = format!("segment {index} has {} positions", given.len());
        IoError::malformed(path, what, "give its two ends, as [[x, y], [x, y]]")
    })
}

fn polygon(path: &Path, index: usize, rows: &[Row]) -> Result<Vec<[f64; 2]>, IoError> {
    if rows.len() < 3 {
        let what = format!("polygon {index} has {} positions", rows.len());
        return Err(IoError::malformed(path, what, "give at least three, or a segment instead"));
    }
    positions(path, "polygon", index, rows)
}

fn positions(path: &Path, item: &'static str, index: usize, rows: &[Row]) -> Result<Vec<[f64; 2]>, IoError> {
    rows.iter().map(|row| position(path, item, index, row)).collect()
}

fn position(path: &Path, item: &'static str, index: usize, row: &Row) -> Result<[f64; 2], IoError> {
    if row.count != 2 {
        let what = format!("{item} {index} has a position of {} numbers", row.count);
        return Err(IoError::malformed(path, what, "give each position as [x, y]"));
    }
    let position = [row.values[0], row.values[1]];
    in_range(path, item, index, &position)?;
    Ok(position)
}

fn of_domain(path: &Path, domain: &Domain) -> Result<PlanarDomain, IoError> {
    let vertices: Vec<[f64; 2]> =
        (0..).zip(&domain.vertices).map(|(i, row)| position(path, "vertex", i, row)).collect::<Result<_, _>>()?;
    for (triangle, corners) in domain.triangles.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&c| c as usize >= vertices.len()) {
            return Err(IoError::BadIndex {
                path: path.to_path_buf(),
                face: triangle as u64,
                vertex: i64::from(vertex),
                vertices: vertices.len() as u64,
            });
        }
    }
    Ok(PlanarDomain { vertices, triangles: domain.triangles.clone() })
}

/// What is wrong, in the words of the library, which name the key, the line and the column.
pub(crate) fn damaged(path: &Path, error: &serde_json::Error) -> IoError {
    let what = error.to_string();
    match error.classify() {
        Category::Eof => IoError::malformed(path, format!("the JSON is cut short: {what}"), "copy or export it again"),
        Category::Syntax | Category::Io => {
            IoError::malformed(path, format!("this is not JSON: {what}"), "correct it there; numbers must be finite")
        }
        Category::Data => IoError::malformed(path, what, "correct it there, or leave it out"),
    }
}
