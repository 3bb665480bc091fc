//! All that lies on one side of a plane.

use crate::field::{Field, FieldError, Metric, finite};
use crate::vec3::{self, Vec3};

/// What lies behind a plane, seen from where its normal points.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HalfSpace {
    point: Vec3,
    normal: Vec3,
}

impl HalfSpace {
    /// The half-space behind the plane through `point` with a normal of any length.
    ///
    /// # Errors
    /// If a number is not finite, or the normal is zero.
    pub fn new(point: [f64; 3], normal: [f64; 3]) -> Result<Self, FieldError> {
        finite("a coordinate", &point)?;
        finite("a part of a normal", &normal)?;
        let normal = vec3::normalized(normal)
            .ok_or(FieldError::Empty("the normal of a half-space is zero: give a direction"))?;
        Ok(Self { point, normal })
    }
}

impl Field for HalfSpace {
    fn value(&self, p: [f64; 3]) -> f64 {
        vec3::dot(self.normal, vec3::sub(p, self.point))
    }

    fn gradient(&self, _: [f64; 3]) -> [f64; 3] {
        self.normal
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        None
    }

    fn is_flat(&self, _: u32) -> bool {
        true
    }
}
