//! Layers as the page gets them: positions with everything that their colours can tell.

use crate::color::{ColorMap, Ends, Rgb, Scale};
use crate::scene::Shape;

/// One thing that is shown.
#[derive(Debug, Clone)]
pub struct ViewLayer {
    /// Its name, mostly that of the file.
    pub name: String,
    /// What it is.
    pub kind: Kind,
    /// What to add to a position for the world's, in the unit of the file.
    pub world_from_local: [f64; 3],
    /// Local positions.
    pub positions: Vec<[f64; 3]>,
    /// What lies at them.
    pub shape: Shape,
    /// What colours can tell.
    pub channels: Vec<Channel>,
    /// The channel that is shown at first; `None`: plain.
    pub shown: Option<&'static str>,
    /// The colour where no channel is shown.
    pub plain: Rgb,
    /// Whether it is drawn a little nearer than it is: for lines that lie on a surface.
    pub lifted: bool,
    /// The coordinate reference system, and the sign of the unit.
    pub system: (Option<String>, Option<&'static str>),
    /// The planes that a channel numbers.
    pub planes: Vec<ViewPlane>,
}

/// What a layer is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Points.
    Points,
    /// Triangles.
    Surface,
    /// Lines.
    Lines,
    /// Triangles of planes.
    Planes,
}

/// A plane, for who picks it.
#[derive(Debug, Clone, serde::Serialize)]
pub struct ViewPlane {
    /// Unit normal.
    pub normal: [f64; 3],
    /// `normal . x` of its positions x, in world coordinates.
    pub offset: f64,
    /// Area of its polygon.
    pub area: f64,
    /// Root of the mean square of its points' distances.
    pub rms: Option<f64>,
    /// Number of its points.
    pub points: usize,
    /// Its colour.
    pub color: Rgb,
}

/// What the colours of a layer can tell.
#[derive(Debug, Clone)]
pub struct Channel {
    /// Its name, one word.
    pub name: &'static str,
    /// What people read, with the unit.
    pub title: String,
    /// The values, one for each position.
    pub data: Data,
}

/// Values for each position.
#[derive(Debug, Clone)]
pub enum Data {
    /// The height, which the positions tell.
    Height {
        /// Values at the ends of the colour bar.
        ends: [f64; 2],
    },
    /// Numbers.
    Values {
        /// One each.
        values: Vec<Option<f32>>,
        /// The least and the largest of them.
        reach: [f64; 2],
        /// Values at the ends of the colour bar.
        ends: [f64; 2],
        /// Whether 0 is in the middle of the bar.
        signed: bool,
    },
    /// ASPRS classes.
    Classes {
        /// One each.
        values: Vec<u8>,
        /// The name of a class.
        name: fn(u8) -> &'static str,
    },
    /// Colours.
    Colors(Vec<Rgb>),
    /// Planes, by number.
    Planes(Vec<Option<u32>>),
}

impl Channel {
    /// Numbers, with the ends of their bar found as for pictures.
    #[must_use]
    pub fn values(name: &'static str, title: String, values: &[Option<f64>], ends: Ends) -> Self {
        let scale = Scale::of(values, ColorMap::Viridis, ends);
        let values: Vec<Option<f32>> =
            values.iter().map(|value| value.filter(|v| v.is_finite()).map(|v| v as f32)).collect();
        let present = || values.iter().flatten().map(|v| f64::from(*v));
        let (low, high) = (present().fold(f64::INFINITY, f64::min), present().fold(f64::NEG_INFINITY, f64::max));
        // Numbers are sent as steps from the least to the largest, so there must be some way between them.
        let reach = if low > high { [0.0, 1.0] } else { [low, high.max(low + f64::EPSILON.max(1e-9 * low.abs()))] };
        let data = Data::Values { values, reach, ends: [scale.low, scale.high], signed: ends == Ends::Symmetric };
        Self { name, title, data }
    }

    /// Heights in world coordinates.
    #[must_use]
    pub fn height(title: String, heights: &[Option<f64>]) -> Self {
        let scale = Scale::of(heights, ColorMap::Viridis, Ends::Both);
        Self { name: "height", title, data: Data::Height { ends: [scale.low, scale.high] } }
    }
}
