//! Fields that are turned, moved and scaled.

use std::sync::Arc;

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

use crate::field::{Field, FieldError, Interval, Metric, Operand, finite, positive};
use crate::vec3::{self, Vec3};

/// Turns, scales and moves: x goes to `scale` R x + `shift`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    rotation: Matrix3<f64>,
    scale: f64,
    shift: Vec3,
}

impl Default for Placement {
    fn default() -> Self {
        Self { rotation: Matrix3::identity(), scale: 1.0, shift: [0.0; 3] }
    }
}

/// How far a rotation may be from one: the largest entry of R R^T - 1.
const TURNED: f64 = 1e-9;

impl Placement {
    /// A placement from the rows of a rotation, a scale and a shift.
    ///
    /// # Errors
    /// If a number is not finite, the rows are no rotation, or the scale is not positive.
    pub fn new(rotation: [[f64; 3]; 3], scale: f64, shift: [f64; 3]) -> Result<Self, FieldError> {
        finite("a part of a rotation", rotation.as_flattened())?;
        finite("a shift", &shift)?;
        positive("a scale", scale)?;
        let rotation = Matrix3::from_fn(|i, j| rotation[i][j]);
        let off = (rotation * rotation.transpose() - Matrix3::identity()).abs().max();
        if off > TURNED || rotation.determinant() < 0.0 {
            return Err(FieldError::Empty("a rotation that is none: its rows must be perpendicular unit vectors"));
        }
        Ok(Self { rotation, scale, shift })
    }

    /// Then moves.
    ///
    /// # Errors
    /// If a number is not finite.
    pub fn moved(mut self, by: [f64; 3]) -> Result<Self, FieldError> {
        finite("a shift", &by)?;
        self.shift = vec3::add(self.shift, by);
        Ok(self)
    }

    /// Then turns around an axis through a position, by an angle in radians, counter-clockwise for one who looks against the axis.
    ///
    /// # Errors
    /// If a number is not finite, or the axis is zero.
    pub fn turned(mut self, axis: [f64; 3], angle: f64, about: [f64; 3]) -> Result<Self, FieldError> {
        finite("an angle", &[angle])?;
        finite("a part of an axis", &axis)?;
        finite("a coordinate", &about)?;
        let axis =
            vec3::normalized(axis).ok_or(FieldError::Empty("the axis of a rotation is zero: give a direction"))?;
        let turn = Rotation3::from_axis_angle(&Unit::new_unchecked(Vector3::from(axis)), angle);
        self.rotation = turn.matrix() * self.rotation;
        self.shift = vec3::add((turn * Vector3::from(vec3::sub(self.shift, about))).into(), about);
        Ok(self)
    }

    /// Then scales, about a position.
    ///
    /// # Errors
    /// If the factor is not positive, or a number not finite.
    pub fn scaled(mut self, factor: f64, about: [f64; 3]) -> Result<Self, FieldError> {
        positive("a scale", factor)?;
        finite("a coordinate", &about)?;
        self.scale *= factor;
        self.shift = vec3::add(vec3::scale(vec3::sub(self.shift, about), factor), about);
        Ok(self)
    }

    /// The rows of the rotation.
    #[must_use]
    pub fn rotation(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| self.rotation[(i, j)]))
    }

    /// The scale.
    #[must_use]
    pub fn scale(&self) -> f64 {
        self.scale
    }

    /// The shift.
    #[must_use]
    pub fn shift(&self) -> [f64; 3] {
        self.shift
    }

    /// The position that goes to `p`.
    pub(crate) fn back(&self, p: Vec3) -> Vec3 {
        let step = Vector3::from(vec3::sub(p, self.shift));
        vec3::scale((self.rotation.transpose() * step).into(), 1.0 / self.scale)
    }

    /// This, and then another.
    pub(crate) fn then(&self, next: &Self) -> Self {
        Self { rotation: next.rotation * self.rotation, scale: next.scale * self.scale, shift: next.of(self.shift) }
    }

    /// Where a position goes.
    pub(crate) fn of(&self, p: Vec3) -> Vec3 {
        vec3::add(vec3::scale(self.of_direction(p), self.scale), self.shift)
    }

    /// A direction, turned.
    pub(crate) fn of_direction(&self, v: Vec3) -> Vec3 {
        (self.rotation * Vector3::from(v)).into()
    }

    /// A turn and a shift.
    pub(crate) fn rigid(rotation: Matrix3<f64>, shift: Vec3) -> Self {
        Self { rotation, scale: 1.0, shift }
    }

    /// The same but for the shift, which is zero.
    pub(crate) fn without_shift(self) -> Self {
        Self { shift: [0.0; 3], ..self }
    }

    /// The box around a box that was placed. Its corners may be infinite.
    pub(crate) fn of_box(&self, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
        let end = |i: usize, upper: bool| {
            let along = (0..3).filter(|&j| self.rotation[(i, j)] != 0.0).map(|j| {
                let r = self.rotation[(i, j)];
                r * if (r > 0.0) == upper { high[j] } else { low[j] }
            });
            self.scale * along.sum::<f64>() + self.shift[i]
        };
        [false, true].map(|upper| std::array::from_fn(|i| end(i, upper)))
    }

    /// The box around what is placed in a box.
    fn back_of_box(&self, [low, high]: [Vec3; 2]) -> [Vec3; 2] {
        let half = vec3::scale(vec3::sub(high, low), 0.5 / self.scale);
        let middle = self.back(vec3::lerp(low, high, 0.5));
        let reach: Vec3 = std::array::from_fn(|i| (0..3).map(|j| half[j] * self.rotation[(j, i)].abs()).sum());
        [vec3::sub(middle, reach), vec3::add(middle, reach)]
    }
}

/// A field elsewhere. Lengths, F among them, grow by the scale.
#[derive(Debug)]
pub struct Placed {
    field: Arc<dyn Field>,
    placement: Placement,
}

impl Placed {
    /// A field that is turned, scaled and moved.
    #[must_use]
    pub fn new(field: Arc<dyn Field>, placement: Placement) -> Self {
        Self { field, placement }
    }
}

impl Field for Placed {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.placement.scale * self.field.value(self.placement.back(p))
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.placement.of_direction(self.field.gradient(self.placement.back(p)))
    }

    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.field.value_and_gradient(self.placement.back(p));
        (self.placement.scale * value, self.placement.of_direction(gradient))
    }

    fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
        let own: Vec<Vec3> = points.iter().map(|&p| self.placement.back(p)).collect();
        self.field.evaluate(&own, found);
        for (value, gradient) in found {
            *value *= self.placement.scale;
            *gradient = self.placement.of_direction(*gradient);
        }
    }

    fn metric(&self) -> Metric {
        self.field.metric()
    }

    fn lipschitz(&self) -> f64 {
        self.field.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let [a, b] = self.placement.back_of_box([low, high]);
        let most = a.iter().chain(&b).fold(0.0_f64, |most, c| most.max(c.abs()));
        let rounding = 1e-13
            * low
                .iter()
                .chain(&high)
                .chain(&self.placement.shift)
                .fold(most * self.placement.scale, |m, c| m.max(c.abs()))
            / self.placement.scale;
        self.field.bounds(a.map(|c| c - rounding), b.map(|c| c + rounding)).times(self.placement.scale)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        Some(self.placement.of_box(self.field.extent()?))
    }

    fn sheets(&self) -> u32 {
        self.field.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        self.field.sheet(self.placement.back(p))
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.field.on_sheet(sheet, self.placement.back(p));
        (self.placement.scale * value, self.placement.of_direction(gradient))
    }

    fn is_flat(&self, sheet: u32) -> bool {
        self.field.is_flat(sheet)
    }

    fn operand(&self, sheet: u32) -> Operand {
        let own = self.field.operand(sheet);
        Operand { placement: own.placement.then(&self.placement), ..own }
    }
}
