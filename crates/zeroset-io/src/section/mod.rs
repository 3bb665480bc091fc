//! Cross-sections and contour lines: curves in planes.
//!
//! | format | holds |
//! |---|---|
//! | SVG, written | a picture in the plane, to scale, with axes and a scale bar |
//! | DXF, written | 3D polylines, on a layer for each plane |
//! | GeoJSON, written | lines with their heights |
//!
//! See [`write_section`] for each.

mod check;
mod dxf;
mod frame;
mod geojson;
mod svg;

use std::path::Path;

pub use frame::plane_frame;

use crate::mesh::{WriteOptions, WriteReport};
use crate::output::write_file;
use crate::{IoError, format};

/// The curves in which planes cut a surface.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Section {
    /// What to add to local coordinates to get world coordinates.
    pub world_from_local: [f64; 3],
    /// The reference system of world coordinates, as the input stated it.
    pub crs: Option<String>,
    /// One for each plane, in the order in which they are to be numbered.
    pub levels: Vec<SectionLevel>,
}

/// The curves in one plane.
#[derive(Debug, Clone, PartialEq)]
pub struct SectionLevel {
    /// The plane.
    pub plane: SectionPlane,
    /// The height of contour lines, in world coordinates; `None` for a cross-section.
    pub height: Option<f64>,
    /// The curves.
    pub lines: Vec<SectionLine>,
}

/// A plane in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SectionPlane {
    /// A point of it, in local coordinates.
    pub point: [f64; 3],
    /// Its normal, of length 1. The section is seen from its tip.
    pub normal: [f64; 3],
}

/// A curve.
///
/// A closed one is counter-clockwise around solid, seen from the tip of the normal, and clockwise around a hole.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SectionLine {
    /// Its positions, in local coordinates. The first is not repeated at the end of a closed one.
    pub positions: Vec<[f64; 3]>,
    /// Whether the last position is joined to the first.
    pub closed: bool,
}

/// A format of sections.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SectionFormat {
    /// Scalable vector graphics: a picture.
    Svg,
    /// Drawing interchange format, for CAD.
    Dxf,
    /// GeoJSON, for geographic information systems.
    GeoJson,
}

impl SectionFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] =
        &[("svg", Self::Svg), ("dxf", Self::Dxf), ("geojson", Self::GeoJson)];

    /// The format that the suffix of `path` stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        format::by_suffix(path, "section", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Svg => "SVG",
            Self::Dxf => "DXF",
            Self::GeoJson => "GeoJSON",
        }
    }
}

/// Writes a section; the suffix tells the format. See [`crate::write_atomically`] for what happens to an old file.
///
/// **SVG.** The plane as [`plane_frame`] turns it, to scale, 800 pixels along its longer side. Marks on the axes are
/// world coordinates where an axis of the picture is one of the world; else they are distances from
/// [`SectionPlane::point`]. The insides of closed curves of a cross-section are filled lightly, by the even-odd rule. Of
/// contour lines those of round heights are thicker and labelled. The path of a curve is in the unit of the data: its
/// group scales it, and tells in `desc` where its zero is. All planes must be parallel; they are drawn over one another.
///
/// **DXF.** Release 12 in text, world coordinates with all digits. Each curve is a 3D polyline, closed or open, on the
/// layer `CONTOUR_12_5` for a contour line at 12.5 (release 12 allows no point in a name), and `SECTION_1`, `SECTION_2`
/// and so on for cross-sections, after their place among the levels.
///
/// **GeoJSON.** Each curve is a `LineString` in world coordinates with the properties `level`, which counts from 1,
/// `closed` and, for a contour line, `height`. A closed one repeats its first position. The reference system is written as
/// [`write_features`](crate::write_features) does.
///
/// # Errors
/// A number is not finite or too large, a line has too few positions, a normal has no unit length, an SVG is asked for
/// planes that are not parallel, or the file cannot be written.
///
/// ```
/// use zeroset_io::{Section, SectionLevel, SectionLine, SectionPlane, WriteOptions, write_section};
/// let square = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 3.0], [0.0, 0.0, 3.0]];
/// let section = Section {
///     levels: vec![SectionLevel {
///         plane: SectionPlane { point: [0.0; 3], normal: [0.0, -1.0, 0.0] },
///         height: None,
///         lines: vec![SectionLine { positions: square.to_vec(), closed: true }],
///     }],
///     ..Section::default()
/// };
/// let path = std::env::temp_dir().join("zeroset-doc-section.svg");
/// write_section(&path, &section, &WriteOptions::default())?;
/// # std::fs::remove_file(&path).ok();
/// # Ok::<(), zeroset_io::IoError>(())
/// ```
pub fn write_section(path: &Path, section: &Section, options: &WriteOptions) -> Result<WriteReport, IoError> {
    let format = SectionFormat::from_path(path)?;
    check::sound(path, section)?;
    let text = match format {
        SectionFormat::Svg => {
            check::parallel(path, section)?;
            svg::text(section, options)
        }
        SectionFormat::Dxf => dxf::text(section, options),
        SectionFormat::GeoJson => geojson::text(section, options),
    };
    let bytes = write_file(path, |sink| sink.write_all(text.as_bytes()))?;
    Ok(WriteReport { bytes, ..WriteReport::default() })
}
