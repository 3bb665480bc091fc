//! Data in the plane for the small exact fit, and what came of it.
//!
//! | format | holds |
//! |---|---|
//! | JSON, read | an object with any of `points`, `segments`, `polygons` and `domain`; see [`read_planar`] |
//! | CSV, TXT, XYZ, read | points, one a line: x, y and perhaps a weight |
//! | JSON, written | the fields of [`PlanarResult`], by their names |

mod csv;
mod json;
mod result;

use std::path::Path;

pub(crate) use json::damaged as damaged_json;
pub use result::{MethodReport, PlanarResult, planar_json};

use crate::input::read_file;
use crate::{IoError, MAX_COORDINATE};

/// Points, segments and polygons, and perhaps the triangles to fit on.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanarData {
    /// Points, each with its weight.
    pub points: Vec<WeightedPoint>,
    /// Segments, by their ends.
    pub segments: Vec<[[f64; 2]; 2]>,
    /// Polygons, by their corners. Whether the first is repeated at the end does not matter.
    pub polygons: Vec<Vec<[f64; 2]>>,
    /// The triangles to fit on.
    pub domain: Option<PlanarDomain>,
}

/// A point in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeightedPoint {
    /// Where it is.
    pub position: [f64; 2],
    /// Its weight; 1 if the file tells none.
    pub weight: f64,
}

/// Triangles in the plane. Every index is that of a vertex; whether the triangles overlap was not examined.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct PlanarDomain {
    /// Positions.
    pub vertices: Vec<[f64; 2]>,
    /// Three vertices each.
    pub triangles: Vec<[u32; 3]>,
}

impl PlanarData {
    /// Number of points, segments and polygons.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len() + self.segments.len() + self.polygons.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A format of data in the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PlanarFormat {
    /// Points, segments, polygons and a domain.
    Json,
    /// Points, one a line.
    Csv,
    /// Standard input: JSON if the first character is `{`, else points, one a line.
    Stream,
}

impl PlanarFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] = &[("json", Self::Json), ("csv", Self::Csv), ("txt", Self::Csv)];

    /// The format that the suffix of `path` stands for, in upper or lower case. `-` is standard input.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        if path == Path::new("-") {
            return Ok(Self::Stream);
        }
        crate::format::by_suffix(path, "planar", Self::KNOWN)
    }
}

/// Reads data in the plane from a file, or from standard input for `-`.
///
/// JSON is an object with these keys, all of them optional, and no others:
///
/// | key | value |
/// |---|---|
/// | `points` | `[[x, y], [x, y, weight], ...]` |
/// | `segments` | `[[[x, y], [x, y]], ...]` |
/// | `polygons` | `[[[x, y], [x, y], [x, y], ...], ...]` |
/// | `domain` | `{"vertices": [[x, y], ...], "triangles": [[i, j, k], ...]}`, with vertices counted from 0 |
///
/// CSV has a point on each line, x, y and perhaps a weight, between commas, semicolons, tabs or spaces. A line of names may stand on
/// top: `x` and `y` (or `easting` and `northing`), and `weight` or `w`; columns of other names are passed over. Lines that are empty or
/// start with `#`, `//` or `%` are, too.
///
/// # Errors
/// If the file cannot be read, is damaged, holds no data, or a number in it is not finite or too large.
pub fn read_planar(path: &Path) -> Result<PlanarData, IoError> {
    let format = PlanarFormat::from_path(path)?;
    read_planar_bytes(path, format, &read_file(path)?)
}

/// The same of a content in memory; `path` is for messages only.
///
/// # Errors
/// As [`read_planar`].
pub fn read_planar_bytes(path: &Path, format: PlanarFormat, bytes: &[u8]) -> Result<PlanarData, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if [b"\xFF\xFE", b"\xFE\xFF"].iter().any(|mark| text.starts_with(*mark)) {
        return Err(IoError::malformed(path, "the text is UTF-16", "save it as UTF-8"));
    }
    let is_json = match format {
        PlanarFormat::Json => true,
        PlanarFormat::Csv => false,
        PlanarFormat::Stream => text.trim_ascii_start().starts_with(b"{"),
    };
    let data = if is_json { json::read(path, text)? } else { csv::read(path, text)? };
    if data.is_empty() {
        return Err(IoError::malformed(
            path,
            "there are no points, segments or polygons in it",
            "check the program that wrote it",
        ));
    }
    Ok(data)
}

/// Looks at the coordinates of an item.
fn in_range(path: &Path, item: &'static str, index: usize, values: &[f64]) -> Result<(), IoError> {
    let (path, index) = (path.to_path_buf(), index as u64);
    if values.iter().any(|v| !v.is_finite()) {
        return Err(IoError::NonFinite { path, item, index });
    }
    match values.iter().find(|v| v.abs() > MAX_COORDINATE) {
        Some(&value) => Err(IoError::TooLarge { path, item, index, value, limit: MAX_COORDINATE }),
        None => Ok(()),
    }
}
