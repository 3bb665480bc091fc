//! What a caller can choose, and what it gets back.

use zeroset::mesh::Mesh;

use crate::LinearUnit;

/// How a mesh or a cloud is written.
#[derive(Debug, Clone, PartialEq)]
pub struct WriteOptions {
    /// The length of the smallest thing that matters, such as the cell of the lattice, in the unit of the mesh.
    ///
    /// Coordinates are written so that rounding moves no vertex by more than a ten-thousandth of it, and never by more
    /// than 0.0005 units, that is, half a millimetre where the unit is the metre. Without a resolution the
    /// ten-thousandth is taken of a hundredth of the longest side of the box.
    ///
    /// PLY holds single precision where that is enough, else double; text formats get as many digits as it takes.
    pub resolution: Option<f64>,
    /// The unit, stated in a comment where the format has comments.
    pub unit: Option<LinearUnit>,
    /// Name and version of the program, stated likewise.
    pub generator: String,
    /// Further lines of comment.
    pub comments: Vec<String>,
}

impl Default for WriteOptions {
    fn default() -> Self {
        Self {
            resolution: None,
            unit: None,
            generator: concat!("zeroset ", env!("CARGO_PKG_VERSION")).into(),
            comments: Vec::new(),
        }
    }
}

/// The largest rounding of any coordinate, in units: half a millimetre for metres.
const MOST: f64 = 0.0005;
/// The largest rounding relative to the resolution.
const SHARE_OF_RESOLUTION: f64 = 1e-4;
/// A resolution for those who state none, relative to the longest side of the box.
const SHARE_OF_BOX: f64 = 1e-2;

/// How far rounding may move a coordinate.
pub(crate) fn tolerance(options: &WriteOptions, points: &[[f64; 3]]) -> f64 {
    let stated = options.resolution.filter(|r| r.is_finite() && *r > 0.0);
    let resolution = stated.unwrap_or_else(|| SHARE_OF_BOX * longest_side(points));
    let tolerance = (SHARE_OF_RESOLUTION * resolution).min(MOST);
    // A single point, or none: any number of digits is enough.
    if tolerance > 0.0 { tolerance } else { MOST }
}

/// A text without line ends and other control characters.
pub(crate) fn one_line(text: &str) -> String {
    text.split(char::is_control).map(str::trim).collect::<Vec<_>>().join(" ").trim().to_string()
}

impl WriteOptions {
    /// Every comment, each on one line of printable text.
    pub(crate) fn comment_lines(&self, crs: Option<&str>) -> Vec<String> {
        let mut lines = vec![format!("generator {}", self.generator)];
        lines.extend(crs.map(|crs| format!("crs {crs}")));
        lines.extend(self.unit.map(|unit| format!("unit {}", unit.name())));
        lines.extend(self.comments.iter().cloned());
        lines.iter().map(|line| one_line(line)).collect()
    }
}

fn longest_side(points: &[[f64; 3]]) -> f64 {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    (0..3).map(|axis| high[axis] - low[axis]).fold(0.0, f64::max)
}

/// The world position of a local one.
#[inline]
pub(crate) fn world(point: [f64; 3], offset: [f64; 3]) -> [f64; 3] {
    [point[0] + offset[0], point[1] + offset[1], point[2] + offset[2]]
}

/// Whether single precision holds all world coordinates to the tolerance.
pub(crate) fn single_holds(points: &[[f64; 3]], offset: [f64; 3], tolerance: f64) -> bool {
    let largest = points.iter().flat_map(|p| world(*p, offset)).fold(0.0_f64, |a, b| a.max(b.abs()));
    // Rounding to 24 bits moves a value by up to 2^-24 of the power of two below it.
    largest * f64::from(f32::EPSILON) / 2.0 <= tolerance
}

/// What writing did.
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct WriteReport {
    /// Size of the file; 0 for standard output.
    pub bytes: u64,
    /// What to add to the coordinates in the file to get world coordinates, where the file holds local ones.
    pub local_offset: Option<[f64; 3]>,
    /// Attributes that the format has no place for.
    pub attributes_left_out: Vec<&'static str>,
}

impl WriteReport {
    pub(crate) fn leave_out(&mut self, mesh: &Mesh, kept: &[&str]) {
        let present = [
            ("colors", mesh.attributes.colors.is_some()),
            ("intensities", mesh.attributes.intensities.is_some()),
            ("classes", mesh.attributes.classes.is_some()),
        ];
        let left_out = present.iter().filter(|(name, present)| *present && !kept.contains(name));
        self.attributes_left_out.extend(left_out.map(|(name, _)| *name));
    }
}
