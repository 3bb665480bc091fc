//! Lines and polygons of the user, which a surface is to pass through.
//!
//! | format | lines | polygons |
//! |---|---|---|
//! | OBJ | `l` | `f`, of any number of corners |
//! | GeoJSON | `LineString`, `MultiLineString` | `Polygon`, `MultiPolygon`, with holes |
//! | DXF, text or binary | `LINE`, `LWPOLYLINE`, `POLYLINE`, open or closed, with arcs | `3DFACE`, polyface meshes |
//! | JSON, as `zeroset features` writes it | edges | planes |
//!
//! Coordinates are world coordinates with heights. What has no extent (points, lines of one position, faces without area), and what is of another
//! kind (texts, blocks, circles), is passed over and counted.

mod dxf;
mod geojson;
mod obj;
mod plan;

use std::path::Path;

use serde::Deserialize;
use serde_json::Value;
use zeroset::constraint::{ConstraintError, Constraints};

pub use plan::{Footprint, read_footprints, read_footprints_bytes};

use plan::Plan;

use crate::features::FeatureFile;
use crate::input::read_file;
use crate::mesh::world;
use crate::{IoError, MAX_COORDINATE, read_features_bytes};

/// A format of lines and polygons.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ConstraintFormat {
    /// Wavefront OBJ.
    Obj,
    /// GeoJSON.
    GeoJson,
    /// Features of `zeroset`, or GeoJSON, if the object has a `type`.
    Json,
    /// Drawing interchange format.
    Dxf,
}

impl ConstraintFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] =
        &[("obj", Self::Obj), ("geojson", Self::GeoJson), ("json", Self::Json), ("dxf", Self::Dxf)];

    /// The format that the suffix of `path` stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        crate::format::by_suffix(path, "constraint", Self::KNOWN)
    }
}

/// What a file of constraints holds.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ConstraintFile {
    /// Lines and polygons in world coordinates.
    pub constraints: Constraints,
    /// The reference system, if the file states one.
    pub crs: Option<String>,
    /// Items that are no lines and no polygons, or have no extent.
    pub passed_over: usize,
}

impl ConstraintFile {
    /// The code of the horizontal system, if the file states one.
    #[must_use]
    pub fn epsg(&self) -> Option<u32> {
        epsg(self.crs.as_deref()?)
    }
}

/// The EPSG code of the horizontal system in the text of a reference system: `EPSG:n`, `EPSG:n+m` or WKT.
#[must_use]
pub fn epsg(crs: &str) -> Option<u32> {
    crate::epsg::code(crs)
}

/// Reads lines and polygons; the suffix tells the format.
///
/// A closed polyline of DXF is a line, as outlines of houses are drawn so. A polygon of GeoJSON or a face is a part of the surface; see
/// [`Constraints::into_outlines`] where only its rings are.
///
/// # Errors
/// If the file cannot be read or is damaged, holds neither lines nor polygons, positions have no heights or are not finite or too large, or a
/// polygon is not plane.
pub fn read_constraints(path: &Path) -> Result<ConstraintFile, IoError> {
    let format = ConstraintFormat::from_path(path)?;
    read_constraints_bytes(path, format, &read_file(path)?)
}

/// The same of a content in memory; `path` is for messages only.
///
/// # Errors
/// As [`read_constraints`].
pub fn read_constraints_bytes(path: &Path, format: ConstraintFormat, bytes: &[u8]) -> Result<ConstraintFile, IoError> {
    let file = gather(path, format, bytes, None)?.file;
    if file.constraints.is_empty() {
        return Err(nothing(path, "lines or polygons", file.passed_over));
    }
    Ok(file)
}

/// Reads all lines and polygons of a file, as parts of a surface or in plan.
fn gather<'a>(
    path: &'a Path,
    format: ConstraintFormat,
    bytes: &[u8],
    plan: Option<Plan>,
) -> Result<Gathered<'a>, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut gathered = Gathered { path, file: ConstraintFile::default(), plan };
    match format {
        ConstraintFormat::Obj => obj::read(&mut gathered, bytes)?,
        ConstraintFormat::GeoJson => geojson::read(&mut gathered, bytes)?,
        ConstraintFormat::Json if is_geojson(bytes) => geojson::read(&mut gathered, bytes)?,
        ConstraintFormat::Json => of_features(&mut gathered, &read_features_bytes(path, bytes)?)?,
        ConstraintFormat::Dxf => dxf::read(&mut gathered, bytes)?,
    }
    Ok(gathered)
}

fn nothing(path: &Path, wanted: &str, passed_over: usize) -> IoError {
    let what = match passed_over {
        0 => format!("there are no {wanted} in it"),
        n => format!("there are no {wanted} in it, only {n} other items"),
    };
    IoError::malformed(path, what, "check the program that wrote it")
}

/// Whether an object has the `type` that all of GeoJSON has.
fn is_geojson(bytes: &[u8]) -> bool {
    #[derive(Deserialize)]
    struct Head {
        r#type: Option<Value>,
    }
    bytes.trim_ascii_start().starts_with(b"{")
        && serde_json::from_slice::<Head>(bytes).is_ok_and(|head| head.r#type.is_some())
}

/// Planes as polygons and edges as lines.
fn of_features(gathered: &mut Gathered<'_>, file: &FeatureFile) -> Result<(), IoError> {
    let features = &file.features;
    let at = |positions: &Vec<[f64; 3]>| -> Vec<[f64; 3]> {
        positions.iter().map(|p| world(*p, features.world_from_local)).collect()
    };
    for (i, plane) in features.planes.iter().enumerate() {
        gathered.polygon(("plane", i as u64), &plane.rings.iter().map(at).collect::<Vec<_>>())?;
    }
    for (i, edge) in features.edges.iter().enumerate() {
        gathered.line(("edge", i as u64), &at(&edge.polyline))?;
    }
    gathered.file.crs.clone_from(&features.crs);
    Ok(())
}

/// What was read so far.
struct Gathered<'a> {
    path: &'a Path,
    file: ConstraintFile,
    /// Takes the place of the constraints where only the plan counts.
    plan: Option<Plan>,
}

/// What a thing is in its file, and its number there.
type Item = (&'static str, u64);

impl Gathered<'_> {
    fn line(&mut self, item: Item, positions: &[[f64; 3]]) -> Result<(), IoError> {
        self.in_range(item, positions)?;
        let added = match &mut self.plan {
            Some(plan) => plan.line(positions),
            None => self.file.constraints.line(positions),
        };
        self.added(item, added)
    }

    fn polygon(&mut self, item: Item, rings: &[Vec<[f64; 3]>]) -> Result<(), IoError> {
        rings.iter().try_for_each(|ring| self.in_range(item, ring))?;
        let added = match &mut self.plan {
            Some(plan) => plan.polygon(rings),
            None => self.file.constraints.polygon(rings),
        };
        self.added(item, added)
    }

    fn pass_over(&mut self) {
        self.file.passed_over += 1;
    }

    fn added(&mut self, (item, index): Item, added: Result<(), ConstraintError>) -> Result<(), IoError> {
        match added {
            Ok(()) => {}
            Err(ConstraintError::NoExtent) => self.pass_over(),
            Err(source) => return Err(IoError::Constraint { path: self.path.to_path_buf(), item, index, source }),
        }
        Ok(())
    }

    fn in_range(&self, (item, index): Item, positions: &[[f64; 3]]) -> Result<(), IoError> {
        match positions.as_flattened().iter().find(|c| c.abs() > MAX_COORDINATE && c.is_finite()) {
            Some(&value) => {
                Err(IoError::TooLarge { path: self.path.to_path_buf(), item, index, value, limit: MAX_COORDINATE })
            }
            None => Ok(()),
        }
    }
}
