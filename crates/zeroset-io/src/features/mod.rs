//! Planes, edges and corners: writing them, and reading them back.
//!
//! | format | holds |
//! |---|---|
//! | JSON, written and read | everything but the points: see [`read_features`] |
//! | GeoJSON, written | planes as polygons, walls as lines in plan, edges as lines, corners as points: see [`write_features`] |
//! | OBJ, written | planes as faces, edges as lines, corners as points, in named groups |
//! | PLY, written | the points of the cloud, each with its plane and its class |
//! | DXF, written | closed polylines, lines and points on named layers |

mod check;
mod dxf;
mod geojson;
mod json;
mod obj;
mod ply;

use std::path::Path;

use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::feature::Features;

use crate::input::read_file;
use crate::mesh::{WriteOptions, WriteReport};
use crate::output::{Sink, write_file};
use crate::{IoError, LinearUnit};

/// A format of features.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum FeatureFormat {
    /// All figures; the only one that is read.
    Json,
    /// GeoJSON, for geographic information systems.
    GeoJson,
    /// Wavefront OBJ.
    Obj,
    /// Stanford polygon file: the points.
    Ply,
    /// Drawing interchange format, for CAD.
    Dxf,
}

impl FeatureFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] =
        &[("json", Self::Json), ("geojson", Self::GeoJson), ("obj", Self::Obj), ("ply", Self::Ply), ("dxf", Self::Dxf)];

    /// The format that the suffix of `path` stands for, in upper or lower case. `-` is a standard stream and is JSON.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        if path == Path::new("-") {
            return Ok(Self::Json);
        }
        crate::format::by_suffix(path, "feature", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Json => "JSON",
            Self::GeoJson => "GeoJSON",
            Self::Obj => "OBJ",
            Self::Ply => "PLY",
            Self::Dxf => "DXF",
        }
    }
}

/// What is written.
#[derive(Debug, Clone, Copy)]
pub struct FeatureOutput<'a> {
    /// The features.
    pub features: &'a Features,
    /// The cloud that they were found in. Only PLY asks for it.
    pub cloud: Option<&'a Cloud>,
    /// How they were found, with every default resolved. JSON holds it as it is.
    pub parameters: &'a Value,
    /// Unit, resolution and comments.
    pub options: &'a WriteOptions,
}

/// What a file of features holds.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureFile {
    /// The features; without points, which JSON does not hold.
    pub features: Features,
    /// The unit of the coordinates, if it is known.
    pub unit: Option<LinearUnit>,
    /// How they were found.
    pub parameters: Value,
}

/// Writes features in world coordinates; the suffix tells the format, `-` is JSON on standard output. See
/// [`crate::write_atomically`] for what happens to an old file.
///
/// | format | planes | edges | corners |
/// |---|---|---|---|
/// | JSON | all figures, see [`read_features`] | likewise | likewise |
/// | GeoJSON | `Polygon`, `MultiPolygon` or, within a degree of upright, `LineString` | `LineString` | `Point` |
/// | OBJ | groups `plane_0`, `plane_1` and so on, of one convex polygon or of triangles | groups `edges_convex`, `edges_concave`, `edges_unknown` of lines | group `corners` of points |
/// | PLY | a number at each point: `plane` | | a class at each point: `feature` |
/// | DXF | a closed 3D polyline for each ring, on the layer `PLANES` | `LINE` or 3D `POLYLINE` on `EDGES_CONVEX`, `EDGES_CONCAVE`, `EDGES_UNKNOWN` | `POINT` on `CORNERS` |
///
/// **GeoJSON.** Coordinates stay in the reference system of the input, though RFC 7946 knows only longitude and latitude:
/// the member `crs` of the format's 2008 version names the system where it has an EPSG code, which QGIS and GDAL
/// understand. Else the member `crs_text` holds what the input said. Outer rings are counter-clockwise seen from above,
/// holes clockwise, as the RFC wants them. A plane within a degree of upright has no area in plan; it is a line in the
/// plane at half its height, from its first to its last position along, with `z_min` and `z_max` among its properties.
///
/// **PLY.** `plane` is the number of the plane, and -1 where there is none, as the format has no missing values. `feature`
/// is 0 for unstructured, 1 for flat, 2 for edge, 3 for corner. Where the cloud has no colours, each plane gets one, and
/// points of no plane are grey.
///
/// **DXF.** Release 12 in text, which every CAD program reads, with all digits of a coordinate.
///
/// # Errors
/// A number is not finite, a plane or edge is named that is not there, the points are not those of the cloud, or the file
/// cannot be written.
pub fn write_features(path: &Path, output: FeatureOutput<'_>) -> Result<WriteReport, IoError> {
    let format = FeatureFormat::from_path(path)?;
    check::sound(path, output.features)?;
    let mut report = WriteReport::default();
    if path == Path::new("-") {
        let mut out = std::io::stdout().lock();
        let written = std::io::Write::write_all(&mut out, json::text(output).as_bytes());
        return written.map(|()| report).map_err(|source| IoError::from_system(Path::new("standard output"), source));
    }
    let write = |fill: &dyn Fn(&mut dyn Sink) -> std::io::Result<()>| write_file(path, |sink| fill(sink));
    report.bytes = match format {
        FeatureFormat::Json => write(&|sink| sink.write_all(json::text(output).as_bytes()))?,
        FeatureFormat::GeoJson => write(&|sink| sink.write_all(geojson::text(output).as_bytes()))?,
        FeatureFormat::Obj => write(&|sink| sink.write_all(&obj::text(output)))?,
        FeatureFormat::Dxf => write(&|sink| sink.write_all(dxf::text(output).as_bytes()))?,
        FeatureFormat::Ply => {
            let cloud = check::cloud(path, output)?;
            write(&|sink| ply::write(sink, cloud, output))?
        }
    };
    Ok(report)
}

/// Reads features from JSON, or from standard input for `-`.
///
/// The file is an object with these keys; others are passed over. Lengths are in the unit of the coordinates, positions
/// in world coordinates with all digits, and lists name one another by `id`, which counts from 0 in the order of the
/// list.
///
/// | key | value |
/// |---|---|
/// | `schema_version` | 1; the meaning of the keys does not change within it |
/// | `zeroset_version` | of the program that wrote the file |
/// | `crs` | the reference system as the input stated it, or null |
/// | `unit` | `metre`, `foot`, `US survey foot` or null |
/// | `planes` | objects: `id`; `normal`, of length 1; `offset`, which is normal . x for positions x in world coordinates; `oriented`; `area`; `points`; `rms` or null; `polygon`, a list of rings `[[x, y, z], ...]` whose first position is not repeated |
/// | `edges` | objects: `id`; `kind`, which is `convex`, `concave` or `unknown`; `planes`; `angle`, in degrees; `length`; `polyline` |
/// | `corners` | objects: `id`; `kind`, which may be `mixed`, too; `position`; `planes`; `edges` |
/// | `parameters` | how the features were found |
///
/// At coordinates of 10^6 m `offset` is good to about 10^-9 m times the accuracy of the normal: an error of 10^-9 in a
/// normal moves the plane by a millimetre there. So use both as they are written, with all their digits.
///
/// # Errors
/// If the file cannot be read, is damaged, is of another version, or states what cannot be.
pub fn read_features(path: &Path) -> Result<FeatureFile, IoError> {
    if FeatureFormat::from_path(path)? != FeatureFormat::Json {
        let format = FeatureFormat::from_path(path)?.name();
        let remedy = "write json beside it and read that";
        return Err(IoError::NotOffered { path: path.to_path_buf(), format, action: "read as features", remedy });
    }
    read_features_bytes(path, &read_file(path)?)
}

/// The same of a content in memory; `path` is for messages only.
///
/// # Errors
/// As [`read_features`].
pub fn read_features_bytes(path: &Path, bytes: &[u8]) -> Result<FeatureFile, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    json::read(path, bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes))
}
