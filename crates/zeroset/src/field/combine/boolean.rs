//! Union, intersection, difference and complement.

use std::sync::Arc;

use crate::field::{Field, FieldError, Interval, Metric};
use crate::vec3;

/// The sheets of operands, one after the other.
#[derive(Debug)]
struct Operands {
    all: Vec<Arc<dyn Field>>,
    /// The number of the first sheet of each.
    first: Vec<u32>,
}

impl Operands {
    fn new(all: Vec<Arc<dyn Field>>) -> Self {
        let mut next = 0;
        let first = all
            .iter()
            .map(|field| {
                let own = next;
                next += field.sheets();
                own
            })
            .collect();
        Self { all, first }
    }

    /// The operand with the least value, the first of equals.
    fn least(&self, p: [f64; 3], sign: f64) -> (usize, f64) {
        let mut best = (0, f64::INFINITY);
        for (i, field) in self.all.iter().enumerate() {
            let value = sign * field.value(p);
            if value < best.1 || i == 0 {
                best = (i, value);
            }
        }
        best
    }

    /// The operand that a sheet belongs to, and its number there.
    fn of_sheet(&self, sheet: u32) -> (&dyn Field, u32) {
        let i = self.first.partition_point(|&first| first <= sheet) - 1;
        (&*self.all[i], sheet - self.first[i])
    }

    fn sheets(&self) -> u32 {
        self.first.last().copied().unwrap_or(0) + self.all.last().map_or(0, |field| field.sheets())
    }

    fn metric(&self) -> Metric {
        self.all.iter().map(|field| field.metric()).fold(Metric::Bound, Metric::max)
    }

    fn lipschitz(&self) -> f64 {
        self.all.iter().map(|field| field.lipschitz()).fold(0.0, f64::max)
    }
}

/// All that lies in one operand or more: the least of the values.
#[derive(Debug)]
pub struct Union(Operands);

impl Union {
    /// The union of some fields.
    ///
    /// # Errors
    /// If there are none.
    pub fn new(operands: Vec<Arc<dyn Field>>) -> Result<Self, FieldError> {
        if operands.is_empty() {
            return Err(FieldError::Empty("a union of nothing: give an operand or more"));
        }
        Ok(Self(Operands::new(operands)))
    }
}

impl Field for Union {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.0.least(p, 1.0).1
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.all[self.0.least(p, 1.0).0].gradient(p)
    }

    fn metric(&self) -> Metric {
        self.0.metric()
    }

    fn lipschitz(&self) -> f64 {
        self.0.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let all = self.0.all.iter().map(|field| field.bounds(low, high));
        all.reduce(Interval::min).unwrap_or(Interval::ALL)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let mut all = self.0.all.iter().map(|field| field.extent());
        let first = all.next()??;
        all.try_fold(first, |[low, high], own| own.map(|own| [vec3::min(low, own[0]), vec3::max(high, own[1])]))
    }

    fn sheets(&self) -> u32 {
        self.0.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let (i, _) = self.0.least(p, 1.0);
        self.0.first[i] + self.0.all[i].sheet(p)
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (field, sheet) = self.0.of_sheet(sheet);
        field.on_sheet(sheet, p)
    }

    fn is_flat(&self, sheet: u32) -> bool {
        let (field, sheet) = self.0.of_sheet(sheet);
        field.is_flat(sheet)
    }
}

/// What lies in all operands: the greatest of the values.
#[derive(Debug)]
pub struct Intersection(Operands);

impl Intersection {
    /// The intersection of some fields.
    ///
    /// # Errors
    /// If there are none.
    pub fn new(operands: Vec<Arc<dyn Field>>) -> Result<Self, FieldError> {
        if operands.is_empty() {
            return Err(FieldError::Empty("an intersection of nothing: give an operand or more"));
        }
        Ok(Self(Operands::new(operands)))
    }
}

impl Field for Intersection {
    fn value(&self, p: [f64; 3]) -> f64 {
        -self.0.least(p, -1.0).1
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.all[self.0.least(p, -1.0).0].gradient(p)
    }

    fn metric(&self) -> Metric {
        self.0.metric()
    }

    fn lipschitz(&self) -> f64 {
        self.0.lipschitz()
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let all = self.0.all.iter().map(|field| field.bounds(low, high));
        all.reduce(Interval::max).unwrap_or(Interval::ALL)
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        // The surface lies in what is solid of each operand; one whose surface has a box may still be solid all around it.
        let boxes = self.0.all.iter().filter(|field| is_bounded(&***field)).filter_map(|field| field.extent());
        let solid = boxes.reduce(|a, b| [vec3::max(a[0], b[0]), vec3::min(a[1], b[1])]);
        solid.map(|[low, high]| [low, vec3::max(low, high)]).or_else(|| {
            let mut all = self.0.all.iter().map(|field| field.extent());
            let first = all.next()??;
            all.try_fold(first, |[low, high], own| own.map(|own| [vec3::min(low, own[0]), vec3::max(high, own[1])]))
        })
    }

    fn sheets(&self) -> u32 {
        self.0.sheets()
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        let (i, _) = self.0.least(p, -1.0);
        self.0.first[i] + self.0.all[i].sheet(p)
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (field, sheet) = self.0.of_sheet(sheet);
        field.on_sheet(sheet, p)
    }

    fn is_flat(&self, sheet: u32) -> bool {
        let (field, sheet) = self.0.of_sheet(sheet);
        field.is_flat(sheet)
    }
}

/// Whether nothing solid lies outside of the box of a field's surface.
fn is_bounded(field: &dyn Field) -> bool {
    field.extent().is_some_and(|[low, high]| {
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
}

/// What lies in one field and not in another.
#[derive(Debug)]
pub struct Difference(Intersection);

impl Difference {
    /// What lies in `base` and not in `cut`.
    #[must_use]
    pub fn new(base: Arc<dyn Field>, cut: Arc<dyn Field>) -> Self {
        Self(Intersection(Operands::new(vec![base, Arc::new(Complement::new(cut))])))
    }
}

super::forwarded!(Difference);
