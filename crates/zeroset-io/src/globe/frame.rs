//! The frame of east, north and up at a position on the globe.

/// Half the longer axis of WGS 84, in metres.
const A: f64 = 6_378_137.0;
/// The flattening of WGS 84.
const F: f64 = 1.0 / 298.257_223_563;

/// East, north and up at a position on the globe.
///
/// Up is the normal of the ellipsoid of WGS 84 through the position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    origin: [f64; 3],
    /// East, north and up.
    axes: [[f64; 3]; 3],
}

impl Frame {
    /// The frame at a position in earth-centred, earth-fixed metres of WGS 84. At the poles east is that of the meridian of
    /// Greenwich.
    #[must_use]
    pub fn at(geocentric: [f64; 3]) -> Self {
        let [x, y, z] = geocentric;
        let from_axis = x.hypot(y);
        let [cos_lon, sin_lon] = unit(x, y);
        let [cos_lat, sin_lat] = normal(from_axis, z);
        let axes = [
            [-sin_lon, cos_lon, 0.0],
            [-sin_lat * cos_lon, -sin_lat * sin_lon, cos_lat],
            [cos_lat * cos_lon, cos_lat * sin_lon, sin_lat],
        ];
        Self { origin: geocentric, axes }
    }

    /// Where the frame is, in earth-centred, earth-fixed metres of WGS 84.
    #[must_use]
    pub fn origin(&self) -> [f64; 3] {
        self.origin
    }

    /// The matrix that takes positions of the frame to earth-centred, earth-fixed metres, column by column, as 3D Tiles
    /// have it. It is a rotation and a translation, to the last bits.
    #[must_use]
    pub fn transform(&self) -> [f64; 16] {
        let [[a, b, c], [d, e, f], [g, h, i]] = self.axes;
        let [x, y, z] = self.origin;
        [a, b, c, 0.0, d, e, f, 0.0, g, h, i, 0.0, x, y, z, 1.0]
    }

    /// Metres east, north and up from the frame to a position in earth-centred, earth-fixed metres.
    ///
    /// The origin is taken off first, so that nothing is lost beyond what the position itself has lost, a nanometre.
    #[must_use]
    pub fn local(&self, geocentric: [f64; 3]) -> [f64; 3] {
        let [x, y, z]: [f64; 3] = std::array::from_fn(|axis| geocentric[axis] - self.origin[axis]);
        self.axes.map(|[a, b, c]| a * x + b * y + c * z)
    }
}

/// Cosine and sine of the latitude of a position, given its distances from the axis and from the plane of the equator.
///
/// Source: B. R. Bowring, Transformation from spatial to geographical coordinates, Survey Review 23 (1976), repeated: each
/// round leaves less than a millionth of the error near the ground.
fn normal(from_axis: f64, z: f64) -> [f64; 2] {
    let b = A * (1.0 - F);
    let e2 = F * (2.0 - F);
    let mut latitude = unit(from_axis * (1.0 - e2), z);
    for _ in 0..3 {
        let [cos, sin] = unit(latitude[0], latitude[1] * (1.0 - F));
        latitude = unit(from_axis - e2 * A * cos.powi(3), z + e2 / (1.0 - e2) * b * sin.powi(3));
    }
    latitude
}

/// A direction in the plane, of length 1. What has none is taken for the first axis.
fn unit(x: f64, y: f64) -> [f64; 2] {
    let length = x.hypot(y);
    if length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
}
