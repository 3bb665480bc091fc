//! Where upright lines go through surfaces.

use crate::field::Field;
use crate::vec3::Vec3;

/// Steps of a line to a cell, where the surface may be near.
pub(super) const STEPS: f64 = 2.0;
/// Lines along either side of a tile, which are looked at together.
pub(super) const TILE: usize = 8;
/// Halvings of an interval that holds a root.
const HALVINGS: usize = 40;

/// Where an upright line goes through the surface of a field.
#[derive(Debug, Clone, Default, PartialEq)]
pub(super) struct Column {
    /// Whether its lower end is inside.
    pub(super) starts_inside: bool,
    /// The heights at which it goes in or out, ascending.
    pub(super) crossings: Vec<f64>,
}

/// The parts of upright lines within a box, from the lowest up, in which they may go through the surface: elsewhere the bounds of the field tell its sign.
pub(super) fn spans(field: &dyn Field, [low, high]: [Vec3; 2], step: f64) -> Vec<[f64; 2]> {
    let mut found = Vec::new();
    add_spans(field, [low, high], step, &mut found);
    found
}

fn add_spans(field: &dyn Field, [low, high]: [Vec3; 2], step: f64, found: &mut Vec<[f64; 2]>) {
    if !field.bounds(low, high).contains(0.0) {
        return;
    }
    let middle = 0.5 * (low[2] + high[2]);
    if high[2] - low[2] > step && low[2] < middle && middle < high[2] {
        add_spans(field, [low, [high[0], high[1], middle]], step, found);
        add_spans(field, [[low[0], low[1], middle], high], step, found);
        return;
    }
    match found.last_mut().filter(|last| last[1] == low[2]) {
        Some(last) => last[1] = high[2],
        None => found.push([low[2], high[2]]),
    }
}

impl Column {
    /// Follows the line over (x, y) between two heights, through the spans of a box that holds it. Parts of the solid, or gaps in it, that are thinner
    /// than `step` can be missed.
    pub(super) fn trace(
        field: &dyn Field,
        [x, y]: [f64; 2],
        [low, high]: [f64; 2],
        spans: &[[f64; 2]],
        step: f64,
    ) -> Self {
        let at = |z: f64| field.value([x, y, z]);
        let mut column = Self { starts_inside: at(low) < 0.0, crossings: Vec::new() };
        for [from, to] in spans.iter().map(|span| [span[0].max(low), span[1].min(high)]).filter(|[from, to]| from < to)
        {
            let steps = ((to - from) / step).ceil().max(1.0);
            let mut last = [from, at(from)];
            for i in 1..=steps as usize {
                let z = from + (to - from) * (i as f64 / steps);
                let next = [z, at(z)];
                if (last[1] < 0.0) != (next[1] < 0.0) {
                    column.crossings.push(root(at, last, next));
                }
                last = next;
            }
        }
        column
    }

    /// The parts inside, from the lowest up.
    pub(super) fn inside(&self, [low, high]: [f64; 2]) -> impl Iterator<Item = [f64; 2]> + '_ {
        let ends = self.starts_inside.then_some(low).into_iter().chain(self.crossings.iter().copied());
        let mut ends = ends.chain(std::iter::once(high));
        std::iter::from_fn(move || Some([ends.next()?, ends.next()?]))
    }
}

/// The root of a function between two places, with its values, at which it has different signs.
fn root(at: impl Fn(f64) -> f64, mut low: [f64; 2], mut high: [f64; 2]) -> f64 {
    for _ in 0..HALVINGS {
        // The chord, kept off the ends: a function that is straight there is done in a step, and any other halved at the latest after the next.
        let chord = low[0] + (high[0] - low[0]) * (low[1] / (low[1] - high[1]));
        let value = at(chord);
        if value == 0.0 || !(low[0] < chord && chord < high[0]) {
            return chord;
        }
        let is_low = (value < 0.0) == (low[1] < 0.0);
        (if is_low { &mut low } else { &mut high }).clone_from(&[chord, value]);
        let middle = 0.5 * (low[0] + high[0]);
        if !(low[0] < middle && middle < high[0]) {
            return middle;
        }
        let value = at(middle);
        let is_low = (value < 0.0) == (low[1] < 0.0);
        (if is_low { &mut low } else { &mut high }).clone_from(&[middle, value]);
    }
    0.5 * (low[0] + high[0])
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::field::{Ball, Cuboid, Difference};

    #[test]
    fn lines_go_in_and_out_where_they_should() {
        let block = Cuboid::new([0.0; 3], [1.0; 3]).unwrap();
        let field = Difference::new(Arc::new(block), Arc::new(Ball::new([0.5; 3], 0.25).unwrap()));
        let trace = |x: f64, y: f64, ends: [f64; 2]| {
            let spans = spans(&field, [[x - 0.1, y - 0.1, ends[0]], [x + 0.1, y + 0.1, ends[1]]], 0.01);
            Column::trace(&field, [x, y], ends, &spans, 0.01)
        };
        let column = trace(0.5, 0.5, [0.1, 3.0]);
        assert!(column.starts_inside && column.crossings.len() == 3, "{column:?}");
        for (found, expected) in column.crossings.iter().zip([0.25, 0.75, 1.0]) {
            assert!((found - expected).abs() < 1e-12, "{column:?}");
        }
        let inside: Vec<_> = column.inside([0.1, 3.0]).collect();
        assert_eq!(inside.len(), 2);
        assert_eq!(inside[0][0], 0.1);
        let clear = trace(2.0, 0.5, [0.1, 3.0]);
        assert_eq!(clear, Column::default());
        assert_eq!(clear.inside([0.1, 3.0]).count(), 0);
        let buried = trace(0.12, 0.12, [0.15, 0.85]);
        assert_eq!(buried.inside([0.15, 0.85]).collect::<Vec<_>>(), [[0.15, 0.85]]);
    }
}
