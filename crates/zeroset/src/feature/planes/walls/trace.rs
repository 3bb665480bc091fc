//! Walls in plan: their lines, and what walls next to one another tell of each other.

use rayon::prelude::*;

use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// How far the rim may stray from a straight side, over the spacing.
pub(super) const STRAIGHT: f64 = 1.2;
/// How well the rim is known, over the spacing.
pub(super) const TRUST: f64 = 0.3;
/// Sides are one wall if their directions differ by a sine under this and their offsets by less than this, over the spacing.
const SAME_SINE: f64 = 0.12;
const SAME_OFFSET: f64 = 1.0;
/// Walls whose ends are this near, over the spacing, meet.
const MEET: f64 = 3.0;

/// Standard errors by which a wall may be off the right angle to its neighbour and still be turned to it.
const SQUARE: f64 = 2.5;

/// A wall stands beside a longer one if it is nearer to it than this, over the spacing, and their directions have more than this cosine.
const BESIDE: f64 = 3.0;
const BESIDE_COSINE: f64 = 0.85;

pub(super) type Planar = [f64; 2];
/// Heights along a line: place and height, by place.
pub(super) type Profile = Vec<(f64, f64)>;

pub(super) fn dot(a: Planar, b: Planar) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(super) fn minus(a: Planar, b: Planar) -> Planar {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn along(a: Planar, direction: Planar, t: f64) -> Planar {
    [a[0] + t * direction[0], a[1] + t * direction[1]]
}

/// Part of a wall under one side of one roof.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    /// Places along the line.
    pub(super) ends: [f64; 2],
    /// Heights of the rim at the ends.
    pub(super) top: [f64; 2],
    /// Height of the surface below.
    pub(super) bottom: f64,
}

impl Piece {
    /// Height of the rim at a place.
    fn height(&self, t: f64) -> f64 {
        let length = self.ends[1] - self.ends[0];
        let share = if length > 0.0 { (t - self.ends[0]) / length } else { 0.0 };
        self.top[0] + share * (self.top[1] - self.top[0])
    }
}

/// Adds a position to a chain, without one that lies in a straight line between its neighbours.
fn push(chain: &mut Profile, next: (f64, f64)) {
    if chain.last() == Some(&next) {
        return;
    }
    if let [.., a, b] = chain[..] {
        let turn = (b.0 - a.0) * (next.1 - b.1) - (b.1 - a.1) * (next.0 - b.0);
        if turn.abs() <= 1e-9 * ((next.0 - a.0).abs() + (next.1 - a.1).abs()).powi(2) {
            chain.pop();
        }
    }
    chain.push(next);
}

/// A wall in plan: the line `origin + t direction`, with the outside on its right.
#[derive(Debug, Clone)]
pub(super) struct Trace {
    pub(super) origin: Planar,
    pub(super) direction: Planar,
    pub(super) pieces: Vec<Piece>,
}

impl Trace {
    /// The unit normal that points outside.
    pub(super) fn outward(&self) -> Planar {
        [self.direction[1], -self.direction[0]]
    }

    pub(super) fn ends(&self) -> [f64; 2] {
        let low = self.pieces.iter().map(|p| p.ends[0]).fold(f64::INFINITY, f64::min);
        [low, self.pieces.iter().map(|p| p.ends[1]).fold(f64::NEG_INFINITY, f64::max)]
    }

    pub(super) fn length(&self) -> f64 {
        let [low, high] = self.ends();
        high - low
    }

    /// The lowest and the highest place of all pieces along the line, as two chains of positions from one end to the other. Gaps between
    /// pieces are bridged.
    pub(super) fn profiles(&self) -> (Profile, Profile) {
        let mut cuts: Vec<f64> = self.pieces.iter().flat_map(|piece| piece.ends).collect();
        cuts.sort_by(f64::total_cmp);
        cuts.dedup();
        let (mut bottom, mut top) = (Profile::new(), Profile::new());
        for ends in cuts.windows(2) {
            let covers = |piece: &&Piece| piece.ends[0] <= ends[0] && piece.ends[1] >= ends[1];
            let covering: Vec<&Piece> = self.pieces.iter().filter(covers).collect();
            if covering.is_empty() {
                continue;
            }
            let lowest = covering.iter().map(|p| p.bottom).fold(f64::INFINITY, f64::min);
            for t in [ends[0], ends[1]] {
                let highest = covering.iter().map(|p| p.height(t)).fold(f64::NEG_INFINITY, f64::max);
                push(&mut bottom, (t, lowest));
                push(&mut top, (t, highest));
            }
        }
        (bottom, top)
    }

    /// The same pieces on another line.
    pub(super) fn moved_to(mut self, origin: Planar, direction: Planar) -> Self {
        for end in self.pieces.iter_mut().flat_map(|piece| &mut piece.ends) {
            *end = dot(minus(along(self.origin, self.direction, *end), origin), direction);
        }
        Self { origin, direction, ..self }
    }
}

/// The heights along a rim as a line of few corners, from one end of the side to the other.
pub(super) fn profile(rim: &[(f64, f64)], ends: [f64; 2], tolerance: f64) -> Profile {
    let (Some(first), Some(last)) = (rim.first(), rim.last()) else { return Vec::new() };
    let mut all = vec![(ends[0], first.1)];
    all.extend_from_slice(rim);
    all.push((ends[1], last.1));
    let mut keep = vec![false; all.len()];
    (keep[0], keep[all.len() - 1]) = (true, true);
    let mut parts = vec![(0, all.len() - 1)];
    while let Some((a, b)) = parts.pop() {
        let at = |t: f64| all[a].1 + (all[b].1 - all[a].1) * (t - all[a].0) / (all[b].0 - all[a].0);
        let worst = (a + 1..b).map(|i| ((all[i].1 - at(all[i].0)).abs(), i)).max_by(|p, q| p.0.total_cmp(&q.0));
        if let Some((_, i)) = worst.filter(|(off, _)| *off > tolerance) {
            keep[i] = true;
            parts.extend([(a, i), (i, b)]);
        }
    }
    all.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| p).collect()
}

/// The line that touches a rim from outside: a position and the direction of the side.
pub(super) fn rim(ring: &[Planar], ends: [Planar; 2], length: f64, spacing: f64) -> Option<(Planar, Planar)> {
    let direction = minus(ends[1], ends[0]).map(|c| c / length);
    let outward = [direction[1], -direction[0]];
    // Abscissa and height over the side.
    let mut rim: Vec<(f64, f64)> = ring
        .iter()
        .map(|&p| minus(p, ends[0]))
        .map(|d| (dot(d, direction), dot(d, outward)))
        .filter(|(t, off)| *t > 0.0 && *t < length && off.abs() <= STRAIGHT * spacing)
        .collect();
    if rim.len() < 2 {
        return None;
    }
    rim.sort_by(|a, b| a.0.total_cmp(&b.0).then(b.1.total_cmp(&a.1)));
    let mean = rim.iter().map(|p| p.0).sum::<f64>() / rim.len() as f64;
    let mut hull: Vec<(f64, f64)> = Vec::new();
    for p in rim {
        while let [.., a, b] = hull[..] {
            if (b.0 - a.0) * (p.1 - a.1) - (b.1 - a.1) * (p.0 - a.0) < 0.0 {
                break;
            }
            hull.pop();
        }
        hull.push(p);
    }
    let place = hull.windows(2).position(|w| w[0].0 <= mean && mean <= w[1].0 && w[1].0 > w[0].0)?;
    let (a, b) = (hull[place], hull[place + 1]);
    let lift = |(t, off): (f64, f64)| along(along(ends[0], direction, t), outward, off);
    let (p, q) = (lift(a), lift(b));
    let d = minus(q, p);
    let size = d[0].hypot(d[1]);
    // A short edge of the hull tells a place but no direction.
    let tilt = (b.1 - a.1) / (b.0 - a.0);
    let direction = if tilt.abs() < 0.2 { d.map(|c| c / size) } else { direction };
    Some((p, direction))
}

/// Joins sides that lie in one line and touch.
pub(super) fn merged(traces: Vec<Trace>, spacing: f64) -> Vec<Trace> {
    let mut walls: Vec<Trace> = Vec::new();
    for trace in traces {
        let middle = along(trace.origin, trace.direction, 0.5 * (trace.ends()[0] + trace.ends()[1]));
        let same = walls.iter().position(|wall| {
            let turned = wall.direction[0] * trace.direction[1] - wall.direction[1] * trace.direction[0];
            let off = dot(minus(middle, wall.origin), wall.outward());
            let t = dot(minus(middle, wall.origin), wall.direction);
            let reach = 0.5 * trace.length() + 2.0 * spacing;
            let [low, high] = wall.ends();
            turned.abs() < SAME_SINE
                && dot(wall.direction, trace.direction) > 0.0
                && off.abs() < SAME_OFFSET * spacing
                && t > low - reach
                && t < high + reach
        });
        match same {
            Some(place) => walls[place] = joined(&walls[place], &trace),
            None => walls.push(trace),
        }
    }
    walls
}

/// Two traces in the line of least squares through their ends.
fn joined(a: &Trace, b: &Trace) -> Trace {
    let ends: Vec<Planar> =
        [a, b].into_iter().flat_map(|trace| trace.ends().map(|t| along(trace.origin, trace.direction, t))).collect();
    let weights = [a.length(), a.length(), b.length(), b.length()];
    let total: f64 = weights.iter().sum();
    let mean = [0, 1].map(|c| ends.iter().zip(weights).map(|(p, w)| w * p[c]).sum::<f64>() / total);
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (p, w) in ends.iter().zip(weights) {
        let d = minus(*p, mean);
        xx += w * d[0] * d[0];
        xy += w * d[0] * d[1];
        yy += w * d[1] * d[1];
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    let direction = [angle.cos(), angle.sin()];
    let direction = if dot(direction, a.direction) < 0.0 { direction.map(|c| -c) } else { direction };
    let mut one = a.clone().moved_to(mean, direction);
    one.pieces.extend(b.clone().moved_to(mean, direction).pieces);
    one
}

/// Turns walls at right angles to a longer neighbour where their direction is not known to better.
///
/// The direction of a side follows from few points of the rim: its standard error is about `trust sqrt(12) / length`.
pub(super) fn square(walls: &mut [Trace], spacing: f64) {
    let ends: Vec<Vec3> = walls
        .iter()
        .flat_map(|wall| wall.ends().map(|t| along(wall.origin, wall.direction, t)))
        .map(|p| [p[0], p[1], 0.0])
        .collect();
    let tree = PointTree::new(&ends);
    let mut found = Vec::new();
    let mut turned = Vec::new();
    for (number, wall) in walls.iter().enumerate() {
        let doubt = SQUARE * TRUST * spacing * 12.0_f64.sqrt() / wall.length();
        let mut best: Option<(f64, Planar)> = None;
        for which in 0..2 {
            tree.k_nearest(ends[2 * number + which], 4, &mut found);
            for other in found.iter().filter(|n| n.distance_squared.sqrt() <= 2.0 * MEET * spacing).map(|n| n.index / 2)
            {
                let longer = &walls[other];
                let off = dot(wall.direction, longer.direction);
                if other != number
                    && longer.length() > wall.length()
                    && off.abs() < doubt.min(0.3)
                    && best.is_none_or(|(length, _)| longer.length() > length)
                {
                    let across = [-longer.direction[1], longer.direction[0]];
                    let across = if dot(across, wall.direction) < 0.0 { across.map(|c| -c) } else { across };
                    best = Some((longer.length(), across));
                }
            }
        }
        if let Some((_, direction)) = best {
            turned.push((number, direction));
        }
    }
    for (number, direction) in turned {
        let wall = &mut walls[number];
        let [low, high] = wall.ends();
        let middle = along(wall.origin, wall.direction, 0.5 * (low + high));
        *wall = wall.clone().moved_to(middle, direction);
    }
}

/// Leaves out walls that stand beside a longer one, at about its height and nearly along it: a rim with a gap, or a cut corner, has such
/// sides.
pub(super) fn drop_doubles(walls: &mut Vec<Trace>, spacing: f64) {
    let heights = |wall: &Trace| {
        let low = wall.pieces.iter().map(|p| p.bottom).fold(f64::INFINITY, f64::min);
        [low, wall.pieces.iter().flat_map(|p| p.top).fold(f64::NEG_INFINITY, f64::max)]
    };
    let is_beside = |wall: &Trace, longer: &Trace| {
        let [low, high] = wall.ends();
        let d = minus(along(wall.origin, wall.direction, 0.5 * (low + high)), longer.origin);
        let (t, off) = (dot(d, longer.direction), dot(d, longer.outward()));
        let [first, last] = longer.ends();
        let ([bottom, top], [below, above]) = (heights(wall), heights(longer));
        dot(wall.direction, longer.direction) > BESIDE_COSINE
            && off.abs() < BESIDE * spacing
            && t > first
            && t < last
            && top.min(above) - bottom.max(below) > 0.5 * (top - bottom)
    };
    let keep: Vec<bool> = walls
        .par_iter()
        .map(|wall| !walls.iter().any(|longer| longer.length() > 1.5 * wall.length() && is_beside(wall, longer)))
        .collect();
    let mut place = 0;
    walls.retain(|_| {
        place += 1;
        keep[place - 1]
    });
}

/// Draws walls whose ends are near each other out to where they meet.
pub(super) fn meet(walls: &mut [Trace], spacing: f64) {
    let reach = MEET * spacing;
    let end = |wall: &Trace, which: usize| along(wall.origin, wall.direction, wall.ends()[which]);
    let ends: Vec<Vec3> =
        walls.iter().flat_map(|wall| [end(wall, 0), end(wall, 1)]).map(|p| [p[0], p[1], 0.0]).collect();
    let tree = PointTree::new(&ends);
    let (mut found, mut moves) = (Vec::new(), Vec::new());
    for (number, &p) in ends.iter().enumerate() {
        tree.k_nearest(p, 4, &mut found);
        let (wall, which) = (number / 2, number % 2);
        let other = found.iter().map(|n| n.index).find(|&other| {
            let (a, b) = (walls[wall].direction, walls[other / 2].direction);
            other / 2 != wall
                && crate::vec3::distance(ends[other], p) <= reach
                && (a[0] * b[1] - a[1] * b[0]).abs() > 0.3
        });
        let Some(other) = other else { continue };
        let (a, b) = (&walls[wall], &walls[other / 2]);
        let slope = dot(a.direction, b.outward());
        let t = dot(minus(b.origin, a.origin), b.outward()) / slope;
        if (t - a.ends()[which]).abs() <= reach {
            moves.push((wall, which, t));
        }
    }
    for (wall, which, t) in moves {
        let wall = &mut walls[wall];
        let outermost = wall.ends()[which];
        for piece in &mut wall.pieces {
            if piece.ends[which] == outermost
                && (t - piece.ends[1 - which]) * (if which == 1 { 1.0 } else { -1.0 }) > 0.0
            {
                let slope = (piece.top[1] - piece.top[0]) / (piece.ends[1] - piece.ends[0]);
                piece.top[which] += slope * (t - piece.ends[which]);
                piece.ends[which] = t;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rim_is_touched_from_outside_by_the_line_of_least_mean_distance() {
        // Points of a roof under y = 0, at most 0.1 away; the outside of a side from left to right is its right, so below.
        let ring: Vec<Planar> = (1..40).map(|i| [0.25 * f64::from(i), 0.1 * f64::from(i * 7 % 5) / 4.0]).collect();
        let (origin, direction) = rim(&ring, [[0.0, 0.05], [10.0, 0.05]], 10.0, 0.25).expect("a straight side");
        assert!(direction[1].abs() < 1e-12 && origin[1].abs() < 1e-12, "{origin:?} {direction:?}");
        // One point of the rim that sticks out does not turn it by more than its share.
        let mut bent = ring.clone();
        bent[20] = [5.25, -0.05];
        let (origin, direction) = rim(&bent, [[0.0, 0.05], [10.0, 0.05]], 10.0, 0.25).expect("a straight side");
        assert!(direction[1].abs() < 0.02 && origin[1] >= -0.05, "{origin:?} {direction:?}");
        assert_eq!(rim(&ring[..1], [[0.0, 0.05], [10.0, 0.05]], 10.0, 0.25), None);
    }

    #[test]
    fn the_rim_of_a_gable_keeps_its_top() {
        let rim: Vec<(f64, f64)> =
            (0..=20).map(|i| f64::from(i) / 2.0).map(|t| (t, 3.0 - 0.4 * (t - 5.0).abs())).collect();
        let profile = profile(&rim, [0.0, 10.0], 0.1);
        assert_eq!(profile, [(0.0, 1.0), (5.0, 3.0), (10.0, 1.0)]);
    }

    fn trace(from: Planar, to: Planar) -> Trace {
        let d = minus(to, from);
        let length = d[0].hypot(d[1]);
        let piece = Piece { ends: [0.0, length], top: [5.0, 5.0], bottom: 0.0 };
        Trace { origin: from, direction: d.map(|c| c / length), pieces: vec![piece] }
    }

    #[test]
    fn pieces_that_overlap_have_one_outline() {
        let piece = |ends: [f64; 2], top: f64, bottom: f64| Piece { ends, top: [top, top], bottom };
        let mut wall = trace([0.0, 0.0], [10.0, 0.0]);
        wall.pieces = vec![piece([0.0, 6.0], 5.0, 0.0), piece([4.0, 10.0], 5.0, 0.0), piece([5.0, 9.0], 7.0, 1.0)];
        let (bottom, top) = wall.profiles();
        assert_eq!(bottom, [(0.0, 0.0), (10.0, 0.0)]);
        assert_eq!(top, [(0.0, 5.0), (5.0, 5.0), (5.0, 7.0), (9.0, 7.0), (9.0, 5.0), (10.0, 5.0)]);
    }

    #[test]
    fn short_walls_are_squared_to_long_ones_and_meet_them() {
        let mut walls = vec![trace([0.0, 0.0], [20.0, 0.0]), trace([20.1, 0.2], [20.6, 5.0])];
        square(&mut walls, 0.5);
        assert!(walls[1].direction[0].abs() < 1e-12, "{:?}", walls[1].direction);
        meet(&mut walls, 0.5);
        let end = along(walls[0].origin, walls[0].direction, walls[0].ends()[1]);
        let start = along(walls[1].origin, walls[1].direction, walls[1].ends()[0]);
        assert!((end[0] - start[0]).hypot(end[1] - start[1]) < 1e-9, "{end:?} {start:?}");
        // A wall whose direction is known well keeps it.
        let mut walls = vec![trace([0.0, 0.0], [20.0, 0.0]), trace([20.1, 0.2], [23.0, 15.0])];
        square(&mut walls, 0.1);
        assert!(walls[1].direction[0] > 0.1);
    }

    #[test]
    fn of_two_walls_side_by_side_the_longer_stays() {
        let mut walls =
            vec![trace([0.0, 0.0], [20.0, 0.0]), trace([5.0, 0.5], [9.0, 0.4]), trace([5.0, 9.0], [9.0, 9.0])];
        drop_doubles(&mut walls, 0.5);
        assert_eq!(walls.len(), 2);
        assert_eq!(walls[1].origin, [5.0, 9.0]);
    }
}
