//! Boxes along the axes.

use crate::field::{Field, FieldError, Metric, finite};
use crate::vec3::{self, Vec3};

/// A box along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cuboid {
    center: Vec3,
    half: Vec3,
}

impl Cuboid {
    /// The box between two opposite corners, in any order.
    ///
    /// # Errors
    /// If a number is not finite, or the box has no volume.
    pub fn new(a: [f64; 3], b: [f64; 3]) -> Result<Self, FieldError> {
        finite("a coordinate", &a)?;
        finite("a coordinate", &b)?;
        let half: Vec3 = std::array::from_fn(|i| 0.5 * (b[i] - a[i]).abs());
        if half.iter().any(|h| *h <= 0.0) {
            return Err(FieldError::Empty("a box has no volume: its corners must differ along each axis"));
        }
        Ok(Self { center: vec3::lerp(a, b, 0.5), half })
    }

    /// How far outside of the faces of each axis a position is.
    fn beyond(&self, p: Vec3) -> Vec3 {
        std::array::from_fn(|i| (p[i] - self.center[i]).abs() - self.half[i])
    }

    fn axis(beyond: Vec3) -> usize {
        (1..3).fold(0, |best, i| if beyond[i] > beyond[best] { i } else { best })
    }
}

impl Field for Cuboid {
    fn value(&self, p: [f64; 3]) -> f64 {
        let beyond = self.beyond(p);
        let outside = vec3::norm(beyond.map(|d| d.max(0.0)));
        outside + beyond[Self::axis(beyond)].min(0.0)
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let beyond = self.beyond(p);
        let side: Vec3 = std::array::from_fn(|i| if p[i] < self.center[i] { -1.0 } else { 1.0 });
        let axis = Self::axis(beyond);
        if beyond[axis] <= 0.0 {
            return std::array::from_fn(|i| if i == axis { side[i] } else { 0.0 });
        }
        let outside: Vec3 = std::array::from_fn(|i| side[i] * beyond[i].max(0.0));
        vec3::scale(outside, 1.0 / vec3::norm(outside))
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        Some([vec3::sub(self.center, self.half), vec3::add(self.center, self.half)])
    }

    fn sheets(&self) -> u32 {
        6
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let axis = Self::axis(self.beyond(p));
        2 * axis as u32 + u32::from(p[axis] >= self.center[axis])
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (axis, side) = ((sheet / 2) as usize, if sheet.is_multiple_of(2) { -1.0 } else { 1.0 });
        let mut normal = [0.0; 3];
        normal[axis] = side;
        (side * (p[axis] - self.center[axis]) - self.half[axis], normal)
    }

    fn is_flat(&self, _: u32) -> bool {
        true
    }
}
