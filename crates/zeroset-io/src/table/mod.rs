//! Tables of points: positions in, and the same positions out with what F is there.
//!
//! | format | read | written |
//! |---|---|---|
//! | PLY | positions | `x`, `y`, `z`, `value`, `gx`, `gy`, `gz` as double, `inside` as uchar |
//! | CSV | positions, as any text | a line of those names, then a point a line, in the fewest digits that give back the same numbers |
//! | NPY | an array of shape (n, 3) | an array of shape (n, 8) with those columns in that order, all double |
//! | all other formats of clouds | positions | |

mod npy;
mod write;

use std::path::Path;

use crate::cloud::{check_size, world};
use crate::input::read_file;
use crate::mesh::{WriteReport, check_points};
use crate::output::write_file;
use crate::{CloudFormat, IoError, LinearUnit, format};

/// Positions with the value and the gradient of F.
///
/// All lists are equally long. Where F is not known its value and gradient are NaN.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct EvaluatedPoints {
    /// Positions, in world coordinates.
    pub positions: Vec<[f64; 3]>,
    /// F there.
    pub values: Vec<f64>,
    /// The gradient of F there.
    pub gradients: Vec<[f64; 3]>,
    /// Whether the position is inside.
    pub inside: Vec<bool>,
    /// The reference system. Only PLY has a place for it.
    pub crs: Option<String>,
}

/// A format of tables that are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum TableFormat {
    /// Stanford polygon file, binary.
    Ply,
    /// Text with commas.
    Csv,
    /// An array of NumPy.
    Npy,
}

impl TableFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] = &[("ply", Self::Ply), ("csv", Self::Csv), ("npy", Self::Npy)];

    /// The format that the suffix of `path` stands for, in upper or lower case. `-` is a standard stream and is CSV.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        if path == Path::new("-") {
            return Ok(Self::Csv);
        }
        format::by_suffix(path, "table", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Ply => "PLY",
            Self::Csv => "CSV text",
            Self::Npy => "NPY",
        }
    }
}

/// A format that positions are read from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PositionFormat {
    /// Any format of clouds.
    Cloud(CloudFormat),
    /// An array of NumPy.
    Npy,
}

impl PositionFormat {
    /// The format that the suffix of `path` stands for, in upper or lower case. `-` is a standard stream and is text.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        if path.extension().is_some_and(|suffix| suffix.eq_ignore_ascii_case("npy")) {
            return Ok(Self::Npy);
        }
        CloudFormat::from_path(path).map(Self::Cloud).map_err(|error| match error {
            IoError::UnknownSuffix { path, suffix, known, .. } => {
                IoError::UnknownSuffix { path, kind: "point", suffix, known: known + ", npy" }
            }
            other => other,
        })
    }
}

/// Positions out of a file, and what there is to say about them.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct PositionFile {
    /// Positions in world coordinates, as f64 from the file on; never none.
    pub positions: Vec<[f64; 3]>,
    /// Points left out: those with a coordinate that is NaN or infinite, and those marked as invalid or withheld.
    pub left_out: u64,
    /// The reference system as the file states it.
    pub crs: Option<String>,
    /// The unit of the coordinates, where the file tells.
    pub unit: Option<LinearUnit>,
    /// Sentences about what a user may want to know.
    pub notes: Vec<String>,
}

/// Reads positions; the suffix tells the format, `-` is lines of x y z on standard input.
///
/// Any format of [`read_cloud`](crate::read_cloud) will do, and **NPY**: an array of shape (n, 3) of little-endian single
/// or double precision, in C order, as `numpy.save` writes it (versions 1 to 3).
///
/// # Errors
/// Whatever keeps the positions from being read in full: see [`IoError`].
pub fn read_positions(path: &Path) -> Result<PositionFile, IoError> {
    let format = PositionFormat::from_path(path)?;
    read_positions_bytes(path, format, read_file(path)?)
}

/// The same of a content in memory; `path` is for messages only.
///
/// # Errors
/// As [`read_positions`].
pub fn read_positions_bytes(path: &Path, format: PositionFormat, bytes: Vec<u8>) -> Result<PositionFile, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    match format {
        PositionFormat::Cloud(format) => {
            let cloud = world(path, format, bytes)?;
            let report = cloud.report;
            let left_out = report.non_finite + report.withheld;
            Ok(PositionFile {
                positions: cloud.points,
                left_out,
                crs: cloud.crs,
                unit: report.unit,
                notes: report.notes,
            })
        }
        PositionFormat::Npy => {
            let mut positions = npy::read(path, &bytes)?;
            let read = positions.len();
            positions.retain(|p| p.iter().all(|c| c.is_finite()));
            if positions.is_empty() {
                return Err(IoError::NoFinitePoints { path: path.to_path_buf(), points: read as u64 });
            }
            check_size(path, "point", &positions, 0)?;
            let left_out = (read - positions.len()) as u64;
            Ok(PositionFile { positions, left_out, ..PositionFile::default() })
        }
    }
}

/// Writes positions with what F is there; the suffix tells the format, `-` is CSV on standard output. See
/// [`crate::write_atomically`] for what happens to an old file.
///
/// The columns are `x`, `y`, `z`, `value`, `gx`, `gy`, `gz` and `inside`, which is 1 or 0. Nothing is rounded.
///
/// | format | types |
/// |---|---|
/// | PLY | vertices, binary little endian: seven doubles and an uchar |
/// | CSV | text with the names in the first line; NaN is `NaN` |
/// | NPY | an array of shape (n, 8) of doubles, in C order |
///
/// # Errors
/// A position is not finite, the lists are not equally long, or the file cannot be written.
///
/// ```
/// use zeroset_io::{EvaluatedPoints, read_positions, write_evaluated};
/// let points = EvaluatedPoints {
///     positions: vec![[84_800.1, 447_400.2, 3.3]],
///     values: vec![-0.25],
///     gradients: vec![[0.0, 0.0, 1.0]],
///     inside: vec![true],
///     crs: None,
/// };
/// let path = std::env::temp_dir().join("zeroset-doc-table.csv");
/// write_evaluated(&path, &points)?;
/// let text = std::fs::read_to_string(&path)?;
/// assert_eq!(text, "x,y,z,value,gx,gy,gz,inside\n84800.1,447400.2,3.3,-0.25,0.0,0.0,1.0,1\n");
/// assert_eq!(read_positions(&path)?.positions, points.positions);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_evaluated(path: &Path, points: &EvaluatedPoints) -> Result<WriteReport, IoError> {
    let format = TableFormat::from_path(path)?;
    check(path, points)?;
    let mut report = WriteReport::default();
    if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        let written = write::csv(&mut out, points).and_then(|()| std::io::Write::flush(&mut out));
        return written.map(|()| report).map_err(|source| IoError::from_system(Path::new("standard output"), source));
    }
    report.bytes = write_file(path, |sink| match format {
        TableFormat::Ply => write::ply(sink, points),
        TableFormat::Csv => write::csv(sink, points),
        TableFormat::Npy => write::npy(sink, points),
    })?;
    Ok(report)
}

fn check(path: &Path, points: &EvaluatedPoints) -> Result<(), IoError> {
    let count = points.positions.len();
    let lengths =
        [("values", points.values.len()), ("gradients", points.gradients.len()), ("inside", points.inside.len())];
    for (attribute, values) in lengths {
        if values != count {
            return Err(IoError::AttributeLength { path: path.to_path_buf(), attribute, values, points: count });
        }
    }
    check_points(path, "point", &points.positions)
}
