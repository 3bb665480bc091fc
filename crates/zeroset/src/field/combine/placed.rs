//! Fields that are turned, moved and scaled.

use std::sync::Arc;

use nalgebra::{Rotation3, Unit, Vector3};

use crate::field::{Field, FieldError, Interval, Metric, finite, positive};
use crate::vec3::{self, Vec3};

/// A field elsewhere: x goes to `scale` R x + `shift`, and lengths, F among them, grow by `scale`.
#[derive(Debug)]
pub struct Placed {
    field: Arc<dyn Field>,
    rotation: Rotation3<f64>,
    scale: f64,
    shift: Vec3,
}

impl Placed {
    /// A field where it is.
    #[must_use]
    pub fn new(field: Arc<dyn Field>) -> Self {
        Self { field, rotation: Rotation3::identity(), scale: 1.0, shift: [0.0; 3] }
    }

    /// Moves it.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn moved(mut self, by: [f64; 3]) -> Result<Self, FieldError> {
        finite("a shift", &by)?;
        self.shift = vec3::add(self.shift, by);
        Ok(self)
    }

    /// Turns it around an axis through the origin, by an angle in radians, counter-clockwise for one who looks against the axis.
    ///
    /// # Errors
    /// If a number is not finite, or the axis is zero.
    pub fn turned(mut self, axis: [f64; 3], angle: f64) -> Result<Self, FieldError> {
        finite("an angle", &[angle])?;
        finite("a part of an axis", &axis)?;
        let axis =
            vec3::normalized(axis).ok_or(FieldError::Empty("the axis of a rotation is zero: give a direction"))?;
        let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::from(axis)), angle);
        self.rotation = turn * self.rotation;
        self.shift = (turn * Vector3::from(self.shift)).into();
        Ok(self)
    }

    /// Scales it about the origin.
    ///
    /// # Errors
    /// If the factor is not positive.
    pub fn scaled(mut self, factor: f64) -> Result<Self, FieldError> {
        positive("a scale", factor)?;
        self.scale *= factor;
        self.shift = vec3::scale(self.shift, factor);
        Ok(self)
    }

    fn back(&self, p: Vec3) -> Vec3 {
        let step = Vector3::from(vec3::sub(p, self.shift));
        vec3::scale(self.rotation.inverse_transform_vector(&step).into(), 1.0 / self.scale)
    }

    fn forth(&self, v: Vec3) -> Vec3 {
        (self.rotation * Vector3::from(v)).into()
    }

    /// The box around a box that was turned forth, or back.
    fn turned_box(&self, low: Vec3, high: Vec3, back: bool) -> [Vec3; 2] {
        let half = vec3::scale(vec3::sub(high, low), 0.5);
        let middle = vec3::lerp(low, high, 0.5);
        let r = self.rotation.matrix();
        let reach: Vec3 =
            std::array::from_fn(|i| (0..3).map(|j| half[j] * if back { r[(j, i)] } else { r[(i, j)] }.abs()).sum());
        let (middle, reach) = if back {
            (self.back(middle), vec3::scale(reach, 1.0 / self.scale))
        } else {
            (vec3::add(vec3::scale(self.forth(middle), self.scale), self.shift), vec3::scale(reach, self.scale))
        };
        [vec3::sub(middle, reach), vec3::add(middle, reach)]
    }
}

impl Field for Placed {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.scale * self.field.value(self.back(p))
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.forth(self.field.gradient(self.back(p)))
    }

    fn metric(&self) -> Metric {
        self.field.metric()
    }

    fn lipschitz(&self) -> f64 {
        self.field.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let [a, b] = self.turned_box(low, high, true);
        let most = a.iter().chain(&b).fold(0.0_f64, |most, c| most.max(c.abs()));
        let rounding = 1e-13
            * low.iter().chain(&high).chain(&self.shift).fold(most * self.scale, |m, c| m.max(c.abs()))
            / self.scale;
        self.field.bounds(a.map(|c| c - rounding), b.map(|c| c + rounding)).times(self.scale)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let [low, high] = self.field.extent()?;
        Some(self.turned_box(low, high, false))
    }

    fn sheets(&self) -> u32 {
        self.field.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        self.field.sheet(self.back(p))
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.field.on_sheet(sheet, self.back(p));
        (self.scale * value, self.forth(gradient))
    }

    fn is_flat(&self, sheet: u32) -> bool {
        self.field.is_flat(sheet)
    }
}
