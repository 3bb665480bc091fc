//! Curves of a function that is no polynomial, followed between two of their points.

use crate::basis::Expansion;
use crate::domain::Place;

use super::roots::{bracketed, is_negative};

/// Most halvings of a piece.
const MOST_HALVINGS: u32 = 14;

/// F near one triangle. It is asked for beyond the triangle, too, where a curve bulges out of it.
pub(super) struct Follower<'a> {
    pub(super) f: &'a Expansion<'a, 2>,
    pub(super) simplex: usize,
    pub(super) tolerance: f64,
}

#[derive(Clone, Copy)]
struct Point {
    position: [f64; 2],
    gradient: [f64; 2],
}

impl Follower<'_> {
    /// The points of the curve between two of its points, with F < 0 on its left.
    pub(super) fn between(&self, ends: [[f64; 2]; 2]) -> Vec<[f64; 2]> {
        let mut points = Vec::new();
        self.halve(ends.map(|end| self.point(end)), MOST_HALVINGS, &mut points);
        points
    }

    fn place(&self, position: [f64; 2]) -> Place<2> {
        let barycentric = self.f.domain().barycentric(self.simplex, position);
        Place { simplex: self.simplex, barycentric, position }
    }

    fn point(&self, position: [f64; 2]) -> Point {
        Point { position, gradient: self.f.gradient_at(&self.place(position)) }
    }

    fn halve(&self, [a, b]: [Point; 2], halvings: u32, points: &mut Vec<[f64; 2]>) {
        let chord = [0, 1].map(|k| b.position[k] - a.position[k]);
        let length = chord[0].hypot(chord[1]);
        if halvings == 0 || length == 0.0 {
            return;
        }
        let along = chord.map(|c| c / length);
        let normal = [along[1], -along[0]];
        let middle = self.point([0, 1].map(|k| a.position[k] + 0.5 * chord[k]));
        let Some(height) = self.height(&middle, normal, 0.5 * length) else { return };
        // The largest distance of the cubic with these end slopes from its chord, when both bend the same way.
        let slope = |p: &Point| (dot(p.gradient, along) / dot(p.gradient, normal)).abs();
        let bulge = 4.0 / 27.0 * length * (slope(&a) + slope(&b));
        if height.abs() <= 0.5 * self.tolerance && bulge <= self.tolerance {
            return;
        }
        let summit = self.point([0, 1].map(|k| middle.position[k] + height * normal[k]));
        self.halve([a, summit], halvings - 1, points);
        points.push(summit.position);
        self.halve([summit, b], halvings - 1, points);
    }

    /// How far from a point F vanishes along a normal that points from F < 0 to F > 0; `None` if not within a limit.
    fn height(&self, middle: &Point, normal: [f64; 2], limit: f64) -> Option<f64> {
        let value = |s: f64| {
            let position = [0, 1].map(|k| middle.position[k] + s * normal[k]);
            self.f.value_at(&self.place(position))
        };
        let at_middle = value(0.0);
        if at_middle == 0.0 {
            return Some(0.0);
        }
        let side = if is_negative(at_middle) { 1.0 } else { -1.0 };
        let newton = 1.5 * (at_middle / dot(middle.gradient, normal)).abs();
        let mut reach = if newton > 0.0 { newton.min(limit) } else { limit / 8.0 };
        loop {
            let at_reach = value(side * reach);
            if is_negative(at_reach) != is_negative(at_middle) {
                return Some(side * reach * bracketed([at_middle, at_reach], |t| value(side * reach * t)));
            }
            if reach >= limit || !at_reach.is_finite() {
                return None;
            }
            reach = (2.0 * reach).min(limit);
        }
    }
}

fn dot(u: [f64; 2], v: [f64; 2]) -> f64 {
    u[0] * v[0] + u[1] * v[1]
}
