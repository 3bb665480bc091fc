//! Union, intersection, difference and complement.

use std::sync::Arc;

use crate::field::{Field, FieldError, Interval, Metric, Operand};
use crate::vec3;

/// The operand that counts at each position: the one with the least value, or the greatest. Their sheets are numbered one after the other.
#[derive(Debug)]
struct Choice {
    all: Vec<Arc<dyn Field>>,
    /// The number of the first sheet of each.
    first: Vec<u32>,
    /// 1 for the least value, -1 for the greatest.
    sign: f64,
}

impl Choice {
    fn new(all: Vec<Arc<dyn Field>>, sign: f64) -> Self {
        let mut next = 0;
        let first = all
            .iter()
            .map(|field| {
                let own = next;
                next += field.sheets();
                own
            })
            .collect();
        Self { all, first, sign }
    }

    /// The operand that counts, the first of equals, and its value.
    fn counting(&self, p: [f64; 3]) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        for (i, field) in self.all.iter().enumerate() {
            let value = self.sign * field.value(p);
            if value < best.1 || i == 0 {
                best = (i, value);
            }
        }
        (best.0, self.sign * best.1)
    }

    /// The operand that a sheet belongs to, and its number there.
    fn of_sheet(&self, sheet: u32) -> (&dyn Field, u32) {
        let i = self.first.partition_point(|&first| first <= sheet) - 1;
        (&*self.all[i], sheet - self.first[i])
    }

    /// The box around the surfaces of all operands.
    fn hull(&self) -> Option<[[f64; 3]; 2]> {
        let mut all = self.all.iter().map(|field| field.extent());
        let first = all.next()??;
        all.try_fold(first, |[low, high], own| own.map(|own| [vec3::min(low, own[0]), vec3::max(high, own[1])]))
    }
}

impl Field for Choice {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.counting(p).1
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.all[self.counting(p).0].gradient(p)
    }

    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (own, value) = self.counting(p);
        (value, self.all[own].gradient(p))
    }

    fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
        let Some((first, others)) = self.all.split_first() else { return };
        first.evaluate(points, found);
        let mut of_other = vec![(0.0, [0.0; 3]); points.len()];
        for field in others {
            field.evaluate(points, &mut of_other);
            for (best, other) in found.iter_mut().zip(&of_other) {
                if self.sign * other.0 < self.sign * best.0 {
                    *best = *other;
                }
            }
        }
    }

    fn metric(&self) -> Metric {
        self.all.iter().map(|field| field.metric()).fold(Metric::Bound, Metric::max)
    }

    fn lipschitz(&self) -> f64 {
        self.all.iter().map(|field| field.lipschitz()).fold(0.0, f64::max)
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let all = self.all.iter().map(|field| field.bounds(low, high));
        let choose = if self.sign > 0.0 { Interval::min } else { Interval::max };
        all.reduce(choose).unwrap_or(Interval::ALL)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        if self.sign > 0.0 {
            return self.hull();
        }
        // The surface lies in what is solid of each operand; one whose surface has a box may still be solid all around it.
        let boxes = self.all.iter().filter(|field| is_bounded(&***field)).filter_map(|field| field.extent());
        let solid = boxes.reduce(|a, b| [vec3::max(a[0], b[0]), vec3::min(a[1], b[1])]);
        solid.map(|[low, high]| [low, vec3::max(low, high)]).or_else(|| self.hull())
    }

    fn sheets(&self) -> u32 {
        self.first.last().copied().unwrap_or(0) + self.all.last().map_or(0, |field| field.sheets())
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let (i, _) = self.counting(p);
        self.first[i] + self.all[i].sheet(p)
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (field, sheet) = self.of_sheet(sheet);
        field.on_sheet(sheet, p)
    }

    fn is_flat(&self, sheet: u32) -> bool {
        let (field, sheet) = self.of_sheet(sheet);
        field.is_flat(sheet)
    }

    fn operand(&self, sheet: u32) -> Operand {
        let (field, sheet) = self.of_sheet(sheet);
        field.operand(sheet)
    }
}

/// All that lies in one operand or more: the least of the values.
#[derive(Debug)]
pub struct Union(Choice);

impl Union {
    /// The union of some fields.
    ///
    /// # Errors
    /// If there are none.
    pub fn new(operands: Vec<Arc<dyn Field>>) -> Result<Self, FieldError> {
        if operands.is_empty() {
            return Err(FieldError::Empty("a union of nothing: give an operand or more"));
        }
        Ok(Self(Choice::new(operands, 1.0)))
    }
}

super::forwarded!(Union);

/// What lies in all operands: the greatest of the values.
#[derive(Debug)]
pub struct Intersection(Choice);

impl Intersection {
    /// The intersection of some fields.
    ///
    /// # Errors
    /// If there are none.
    pub fn new(operands: Vec<Arc<dyn Field>>) -> Result<Self, FieldError> {
        if operands.is_empty() {
            return Err(FieldError::Empty("an intersection of nothing: give an operand or more"));
        }
        Ok(Self(Choice::new(operands, -1.0)))
    }
}

super::forwarded!(Intersection);

/// Whether nothing solid lies outside of the box of a field's surface.
fn is_bounded(field: &dyn Field) -> bool {
    field.extent().is_some_and(|[low, high]| {
        if !(vec3::is_finite(low) && vec3::is_finite(high)) {
            return false;
        }
        // There the sign is the same everywhere.
        let beyond = vec3::add(high, vec3::add(vec3::sub(high, low), [1.0; 3]));
        field.value(beyond) > 0.0
    })
}

/// What does not lie in a field: the negative.
#[derive(Debug)]
pub struct Complement(Arc<dyn Field>);

impl Complement {
    /// The complement of a field.
    #[must_use]
    pub fn new(field: Arc<dyn Field>) -> Self {
        Self(field)
    }
}

impl Field for Complement {
    fn value(&self, p: [f64; 3]) -> f64 {
        -self.0.value(p)
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        vec3::scale(self.0.gradient(p), -1.0)
    }

    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.0.value_and_gradient(p);
        (-value, vec3::scale(gradient, -1.0))
    }

    fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
        self.0.evaluate(points, found);
        for (value, gradient) in found {
            (*value, *gradient) = (-*value, vec3::scale(*gradient, -1.0));
        }
    }

    fn metric(&self) -> Metric {
        self.0.metric()
    }

    fn lipschitz(&self) -> f64 {
        self.0.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        -self.0.bounds(low, high)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        self.0.extent()
    }

    fn sheets(&self) -> u32 {
        self.0.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        self.0.sheet(p)
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (value, gradient) = self.0.on_sheet(sheet, p);
        (-value, vec3::scale(gradient, -1.0))
    }

    fn is_flat(&self, sheet: u32) -> bool {
        self.0.is_flat(sheet)
    }

    fn operand(&self, sheet: u32) -> Operand {
        let own = self.0.operand(sheet);
        Operand { is_reversed: !own.is_reversed, ..own }
    }
}

/// What lies in one field and not in another.
#[derive(Debug)]
pub struct Difference(Choice);

impl Difference {
    /// What lies in `base` and not in `cut`.
    #[must_use]
    pub fn new(base: Arc<dyn Field>, cut: Arc<dyn Field>) -> Self {
        Self(Choice::new(vec![base, Arc::new(Complement::new(cut))], -1.0))
    }
}

super::forwarded!(Difference);
