//! Point clouds: positions with what was measured beside them.

mod filter;
mod noise;
mod offset;
mod outliers;
mod spacing;
mod variation;

pub(crate) use filter::retain_items;
pub use filter::{Filter, FilterReport, NOISE_CLASSES, retain};
pub use noise::noise;
pub use offset::choose_offset;
pub use outliers::isolated_points;
pub use spacing::Spacing;
pub use variation::surface_variation;

/// Values measured at each point, or carried by each vertex of a mesh. Each present list has one entry per point.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Attributes {
    /// Red, green, blue, 0..=255.
    pub colors: Option<Vec<[u8; 3]>>,
    /// Strength of the return, in the scanner's own unit.
    pub intensities: Option<Vec<f32>>,
    /// ASPRS classification codes: 2 ground, 6 building, 7 low noise, 18 high noise, and so on.
    pub classes: Option<Vec<u8>>,
}

/// A raw cloud: points without normals.
///
/// Coordinates are f64 and local: the world position of point `i` is `points[i] + world_from_local`. The offset keeps
/// georeferenced coordinates (10^6 m) exact wherever differences of them are taken.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cloud {
    /// What to add to a local position to get the world position, in the file's unit.
    pub world_from_local: [f64; 3],
    /// Local positions.
    pub points: Vec<[f64; 3]>,
    /// What was measured beside the positions.
    pub attributes: Attributes,
    /// The coordinate reference system as the file states it: WKT, or `EPSG:n`.
    pub crs: Option<String>,
}

impl Cloud {
    /// A cloud from world positions; the offset is chosen by [`choose_offset`].
    #[must_use]
    pub fn from_world(mut points: Vec<[f64; 3]>) -> Self {
        let offset = choose_offset(points.iter().copied());
        if offset != [0.0; 3] {
            for point in &mut points {
                for axis in 0..3 {
                    point[axis] -= offset[axis];
                }
            }
        }
        Self { world_from_local: offset, points, ..Self::default() }
    }

    /// Number of points.
    #[must_use]
    pub fn len(&self) -> usize {
        self.points.len()
    }

    /// Whether the cloud holds no point.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.points.is_empty()
    }

    /// Adds the points of another cloud with the same offset. Values stay where both clouds have them.
    pub fn append(&mut self, other: Self) {
        let count = self.len();
        self.points.extend_from_slice(&other.points);
        self.attributes.append(other.attributes, count);
    }

    /// Lowest and highest coordinates in the world; `None` without points.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let first = *self.points.first()?;
        let local = self.points.iter().fold([first; 2], |[low, high], p| {
            [std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a]))]
        });
        Some(local.map(|p| std::array::from_fn(|a| p[a] + self.world_from_local[a])))
    }

    /// World position of point `i`.
    #[must_use]
    pub fn world(&self, i: usize) -> [f64; 3] {
        let (p, o) = (self.points[i], self.world_from_local);
        [p[0] + o[0], p[1] + o[1], p[2] + o[2]]
    }
}
