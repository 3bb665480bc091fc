//! Unions that are rounded where operands meet.

use std::sync::Arc;

use crate::field::{Field, FieldError, Interval, Metric, Operand, positive};
use crate::vec3;

/// A union with a fillet where its operands meet.
///
/// F = min(a, b) - r h^2 / 4 with h = max(0, 1 - |a - b| / r): a parabola takes the place of the corner where a and b differ by less than r.
/// Its gradient is a mean of the operands', so it is Lipschitz where they are.
#[derive(Debug)]
pub struct SmoothUnion {
    operands: [Arc<dyn Field>; 2],
    radius: f64,
}

impl SmoothUnion {
    /// The union of two fields, rounded over a length.
    ///
    /// # Errors
    /// If the radius is not positive.
    pub fn new(a: Arc<dyn Field>, b: Arc<dyn Field>, radius: f64) -> Result<Self, FieldError> {
        positive("the radius of a smooth union", radius)?;
        Ok(Self { operands: [a, b], radius })
    }

    /// The operand that a sheet belongs to, and its number there; `None` for the fillet.
    fn of_sheet(&self, sheet: u32) -> Option<(&dyn Field, u32)> {
        let first = self.operands[0].sheets();
        match sheet {
            0 => None,
            s if s <= first => Some((&*self.operands[0], s - 1)),
            s => Some((&*self.operands[1], s - 1 - first)),
        }
    }

    fn blend(&self, a: f64, b: f64) -> f64 {
        let h = (1.0 - (a - b).abs() / self.radius).max(0.0);
        a.min(b) - 0.25 * self.radius * h * h
    }
}

impl Field for SmoothUnion {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.blend(self.operands[0].value(p), self.operands[1].value(p))
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let [a, b] = [0, 1].map(|i| self.operands[i].value(p));
        // The share of the operand with the greater value.
        let h = 0.5 * (1.0 - (a - b).abs() / self.radius).max(0.0);
        let (near, far) = if a <= b { (0, 1) } else { (1, 0) };
        if h == 0.0 {
            return self.operands[near].gradient(p);
        }
        vec3::lerp(self.operands[near].gradient(p), self.operands[far].gradient(p), h)
    }

    fn metric(&self) -> Metric {
        self.operands.iter().map(|field| field.metric()).fold(Metric::Bound, Metric::max)
    }

    fn lipschitz(&self) -> f64 {
        self.operands[0].lipschitz().max(self.operands[1].lipschitz())
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let [a, b] = [0, 1].map(|i| self.operands[i].bounds(low, high));
        // It grows with each of the values.
        let [low, high] = [self.blend(a.low, b.low), self.blend(a.high, b.high)];
        let rounding = 1e-14 * (self.radius + low.abs().max(high.abs()));
        if low.is_nan() || high.is_nan() {
            return Interval::ALL;
        }
        Interval { low: low - rounding, high: high + rounding }
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        // The fillet swells out by a quarter of the radius at most where values are distances. Where they are bounds no one knows how far.
        let grown = |field: &dyn Field| {
            let [low, high] = field.extent().filter(|_| field.metric() == Metric::Distance)?;
            Some([low.map(|c| c - self.radius), high.map(|c| c + self.radius)])
        };
        let [a, b] = [grown(&*self.operands[0])?, grown(&*self.operands[1])?];
        Some([vec3::min(a[0], b[0]), vec3::max(a[1], b[1])])
    }

    fn sheets(&self) -> u32 {
        1 + self.operands[0].sheets() + self.operands[1].sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let [a, b] = [0, 1].map(|i| self.operands[i].value(p));
        if (a - b).abs() < self.radius {
            0
        } else if a <= b {
            1 + self.operands[0].sheet(p)
        } else {
            1 + self.operands[0].sheets() + self.operands[1].sheet(p)
        }
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        match self.of_sheet(sheet) {
            Some((field, sheet)) => field.on_sheet(sheet, p),
            None => (self.value(p), self.gradient(p)),
        }
    }

    fn is_flat(&self, sheet: u32) -> bool {
        self.of_sheet(sheet).is_some_and(|(field, sheet)| field.is_flat(sheet))
    }

    fn operand(&self, sheet: u32) -> Operand {
        self.of_sheet(sheet).map_or_else(Operand::default, |(field, sheet)| field.operand(sheet))
    }
}
