//! What lies under a grid of heights.

use crate::field::{Field, FieldError, Interval, Metric, finite, positive};
use crate::vec3;

/// What lies under a grid of heights: bilinear between its nodes, and level beyond its rim.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightField {
    origin: [f64; 2],
    step: [f64; 2],
    count: [usize; 2],
    heights: Vec<f64>,
    lipschitz: f64,
}

impl HeightField {
    /// Heights at `count[0]` by `count[1]` nodes, x fastest, the first at `origin`.
    ///
    /// # Errors
    /// If a number is not finite, a step is not positive, there are fewer than two nodes along an axis, or not one height for each node.
    pub fn new(origin: [f64; 2], step: [f64; 2], count: [usize; 2], heights: Vec<f64>) -> Result<Self, FieldError> {
        finite("a coordinate", &origin)?;
        step.iter().try_for_each(|&s| positive("a step of a height grid", s))?;
        finite("a height", &heights)?;
        if count.iter().any(|&n| n < 2) || count[0].checked_mul(count[1]) != Some(heights.len()) {
            return Err(FieldError::Empty(
                "a height grid needs two nodes or more along each axis, and a height for each",
            ));
        }
        let slope = |stride: usize, axis: usize| {
            let along = (0..heights.len()).filter(move |i| {
                if axis == 0 { i % count[0] + 1 < count[0] } else { i + stride < count[0] * count[1] }
            });
            along.map(|i| (heights[i + stride] - heights[i]).abs() / step[axis]).fold(0.0, f64::max)
        };
        // Slopes of a bilinear patch lie between those of its sides.
        let lipschitz = vec3::norm([slope(1, 0), slope(count[0], 1), 1.0]).next_up();
        Ok(Self { origin, step, count, heights, lipschitz })
    }

    /// The cell along an axis, and the share of the way through it.
    fn cell(&self, axis: usize, x: f64) -> (usize, f64) {
        let cells = self.count[axis] - 1;
        let t = ((x - self.origin[axis]) / self.step[axis]).clamp(0.0, cells as f64);
        let cell = (t.floor() as usize).min(cells - 1);
        (cell, t - cell as f64)
    }

    fn corners(&self, i: usize, j: usize) -> [f64; 4] {
        let first = j * self.count[0] + i;
        [first, first + 1, first + self.count[0], first + self.count[0] + 1].map(|k| self.heights[k])
    }

    /// Whether a coordinate is beyond the rim.
    fn is_beyond(&self, axis: usize, x: f64) -> bool {
        let end = self.origin[axis] + (self.count[axis] - 1) as f64 * self.step[axis];
        x < self.origin[axis] || x > end
    }
}

impl Field for HeightField {
    fn value(&self, p: [f64; 3]) -> f64 {
        let ((i, s), (j, t)) = (self.cell(0, p[0]), self.cell(1, p[1]));
        let [a, b, c, d] = self.corners(i, j);
        p[2] - ((a * (1.0 - s) + b * s) * (1.0 - t) + (c * (1.0 - s) + d * s) * t)
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let ((i, s), (j, t)) = (self.cell(0, p[0]), self.cell(1, p[1]));
        let [a, b, c, d] = self.corners(i, j);
        let x = ((b - a) * (1.0 - t) + (d - c) * t) / self.step[0];
        let y = ((c - a) * (1.0 - s) + (d - b) * s) / self.step[1];
        let level = |axis: usize, slope: f64| if self.is_beyond(axis, p[axis]) { 0.0 } else { -slope };
        [level(0, x), level(1, y), 1.0]
    }

    /// The difference of heights, as distances would need a search.
    fn metric(&self) -> Metric {
        Metric::Sign
    }

    fn lipschitz(&self) -> f64 {
        self.lipschitz
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let [(i0, _), (j0, _), (i1, _), (j1, _)] =
            [self.cell(0, low[0]), self.cell(1, low[1]), self.cell(0, high[0]), self.cell(1, high[1])];
        let mut heights = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for j in j0..=j1 + 1 {
            for &h in &self.heights[j * self.count[0] + i0..=j * self.count[0] + i1 + 1] {
                heights = Interval { low: heights.low.min(h), high: heights.high.max(h) };
            }
        }
        // The mean of four heights may round out of them by a few bits.
        let rounding = 1e-14 * heights.low.abs().max(heights.high.abs());
        let least = low[2] - (heights.high + rounding);
        let most = high[2] - (heights.low - rounding);
        Interval { low: least.next_down(), high: most.next_up() }
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        None
    }
}
