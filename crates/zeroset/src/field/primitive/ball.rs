//! Balls.

use crate::field::{Field, FieldError, Metric, direction, finite, positive};
use crate::vec3::{self, Vec3};

/// What lies within a distance of a centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ball {
    center: Vec3,
    radius: f64,
}

impl Ball {
    /// The ball around a centre.
    ///
    /// # Errors
    /// If a number is not finite, or the radius is not positive.
    pub fn new(center: [f64; 3], radius: f64) -> Result<Self, FieldError> {
        finite("a coordinate", &center)?;
        positive("a radius", radius)?;
        Ok(Self { center, radius })
    }
}

impl Field for Ball {
    fn value(&self, p: [f64; 3]) -> f64 {
        vec3::distance(p, self.center) - self.radius
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        direction(vec3::sub(p, self.center))
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        Some([self.center.map(|c| c - self.radius), self.center.map(|c| c + self.radius)])
    }
}
