//! Surfaces at a distance from another.

use std::sync::Arc;

use super::boolean::Difference;
use crate::field::{Field, FieldError, Interval, Metric, finite, positive};

/// Two values are one sheet's if they differ by less than this share of their coordinates.
const SAME: f64 = 1e-9;

/// What lies within a distance of a solid, or deeper in it than one: F - distance.
///
/// Outward, edges become round where F is a true distance there. Where it is a bound only they stay sharp.
#[derive(Debug)]
pub struct Offset {
    field: Arc<dyn Field>,
    distance: f64,
}

impl Offset {
    /// A solid grown by a distance; shrunk by a negative one.
    ///
    /// # Errors
    /// If the distance is not finite.
    pub fn new(field: Arc<dyn Field>, distance: f64) -> Result<Self, FieldError> {
        finite("an offset", &[distance])?;
        Ok(Self { field, distance })
    }
}

impl Field for Offset {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.field.value(p) - self.distance
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.field.gradient(p)
    }

    fn metric(&self) -> Metric {
        self.field.metric().max(Metric::Bound)
    }

    fn lipschitz(&self) -> f64 {
        self.field.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        self.field.bounds(low, high).plus(-self.distance)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let [low, high] = self.field.extent()?;
        // A complement grows where its distance is negative. Where |F| is less than the distance, as bounds are, the surface goes farther
        // out, but not without end: only distances tell how far.
        (self.field.metric() == Metric::Distance).then(|| {
            let reach = self.distance.abs();
            [low.map(|c| c - reach), high.map(|c| c + reach)]
        })
    }

    fn sheets(&self) -> u32 {
        1 + self.field.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let own = self.field.sheet(p);
        let (carried, value) = (self.field.on_sheet(own, p).0, self.field.value(p));
        let scale = p.iter().fold(carried.abs(), |most, c| most.max(c.abs()));
        // Beyond an edge the distance is that to the edge: the surface is round there.
        if (carried - value).abs() <= SAME * scale { 1 + own } else { 0 }
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        if sheet == 0 {
            return (self.value(p), self.gradient(p));
        }
        let (value, gradient) = self.field.on_sheet(sheet - 1, p);
        (value - self.distance, gradient)
    }

    fn is_flat(&self, sheet: u32) -> bool {
        sheet > 0 && self.field.is_flat(sheet - 1)
    }
}

/// A wall around the surface of a solid: |F| - half the thickness.
#[derive(Debug)]
pub struct Shell(Difference);

impl Shell {
    /// A wall of a thickness, half of it on either side of the surface.
    ///
    /// # Errors
    /// If the thickness is not positive.
    pub fn new(field: Arc<dyn Field>, thickness: f64) -> Result<Self, FieldError> {
        positive("the thickness of a shell", thickness)?;
        let outer = Offset::new(Arc::clone(&field), 0.5 * thickness)?;
        let inner = Offset::new(field, -0.5 * thickness)?;
        Ok(Self(Difference::new(Arc::new(outer), Arc::new(inner))))
    }
}

super::forwarded!(Shell);
