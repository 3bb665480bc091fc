//! Polygons in the plane.

/// The place of a segment that is nearest to a position.
pub(super) fn nearest_on_segment(from: [f64; 2], to: [f64; 2], q: [f64; 2]) -> [f64; 2] {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length_squared = along[0] * along[0] + along[1] * along[1];
    let t = ((q[0] - from[0]) * along[0] + (q[1] - from[1]) * along[1]) / length_squared;
    // Not a number for a segment without length.
    let t = if t > 0.0 { t.min(1.0) } else { 0.0 };
    if t == 1.0 { to } else { [from[0] + t * along[0], from[1] + t * along[1]] }
}

/// A side of a polygon that has the inside on its left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Side {
    pub(super) from: [f64; 2],
    pub(super) to: [f64; 2],
    /// Unit normal, to the right.
    pub(super) outward: [f64; 2],
}

impl Side {
    /// The distance from the line that it lies on, positive outside.
    pub(super) fn offset(&self, q: [f64; 2]) -> f64 {
        (q[0] - self.from[0]) * self.outward[0] + (q[1] - self.from[1]) * self.outward[1]
    }
}

/// A region with holes: what an odd number of rings surrounds.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Region {
    sides: Vec<Side>,
}

/// What is nearest to a position.
pub(super) struct Nearest {
    /// Distance from the rim, negative inside.
    pub(super) distance: f64,
    /// The place on the rim.
    pub(super) place: [f64; 2],
    /// The side that counts there.
    pub(super) side: usize,
}

fn area(ring: &[[f64; 2]]) -> f64 {
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

fn surrounds(ring: &[[f64; 2]], q: [f64; 2]) -> bool {
    let next = ring.iter().cycle().skip(1);
    let crosses = |(a, b): (&[f64; 2], &[f64; 2])| {
        (a[1] > q[1]) != (b[1] > q[1]) && {
            let turn = (b[0] - a[0]) * (q[1] - a[1]) - (b[1] - a[1]) * (q[0] - a[0]);
            (turn > 0.0) == (b[1] > a[1])
        }
    };
    ring.iter().zip(next).filter(|&pair| crosses(pair)).count() % 2 == 1
}

impl Region {
    /// `None` without a ring that has an area.
    pub(super) fn new(rings: &[Vec<[f64; 2]>]) -> Option<Self> {
        let mut sides = Vec::new();
        for (i, ring) in rings.iter().enumerate() {
            let own_area = area(ring);
            if ring.len() < 3 || own_area == 0.0 {
                continue;
            }
            let depth = rings.iter().enumerate().filter(|(j, other)| *j != i && surrounds(other, ring[0])).count();
            let turned = (own_area > 0.0) == (depth % 2 == 1);
            for k in 0..ring.len() {
                let (a, b) = (ring[k], ring[(k + 1) % ring.len()]);
                let (from, to) = if turned { (b, a) } else { (a, b) };
                let length = (to[0] - from[0]).hypot(to[1] - from[1]);
                if length > 0.0 {
                    let outward = [(to[1] - from[1]) / length, (from[0] - to[0]) / length];
                    sides.push(Side { from, to, outward });
                }
            }
        }
        (!sides.is_empty()).then_some(Self { sides })
    }

    pub(super) fn sides(&self) -> &[Side] {
        &self.sides
    }

    fn contains(&self, q: [f64; 2]) -> bool {
        let crosses = |side: &&Side| {
            let (a, b) = (side.from, side.to);
            (a[1] > q[1]) != (b[1] > q[1]) && (side.offset(q) < 0.0) == (b[1] > a[1])
        };
        self.sides.iter().filter(crosses).count() % 2 == 1
    }

    /// The nearest place of the rim. Where it is a corner, the side counts that the surface would have there without the other: the one farther
    /// out at a convex corner, the one farther in at a reflex one.
    pub(super) fn nearest(&self, q: [f64; 2]) -> Nearest {
        let sign = if self.contains(q) { -1.0 } else { 1.0 };
        let mut best = Nearest { distance: f64::INFINITY, place: q, side: 0 };
        for (i, side) in self.sides.iter().enumerate() {
            let place = nearest_on_segment(side.from, side.to, q);
            let distance = (place[0] - q[0]).hypot(place[1] - q[1]);
            let other = &self.sides[best.side];
            let counts = distance == best.distance && sign * side.offset(q) > sign * other.offset(q);
            if distance < best.distance || counts {
                best = Nearest { distance, place, side: i };
            }
        }
        best.distance *= sign;
        best
    }
}
