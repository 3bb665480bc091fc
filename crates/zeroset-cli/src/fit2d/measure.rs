//! Lengths and boxes of data in the plane.

use zeroset_io::PlanarData;

/// A box in the plane.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Extent {
    pub(super) low: [f64; 2],
    pub(super) high: [f64; 2],
}

impl Extent {
    pub(super) fn of<'a>(positions: impl Iterator<Item = &'a [f64; 2]>) -> Self {
        let nothing = Self { low: [f64::INFINITY; 2], high: [f64::NEG_INFINITY; 2] };
        positions.fold(nothing, |all, p| Self {
            low: std::array::from_fn(|a| all.low[a].min(p[a])),
            high: std::array::from_fn(|a| all.high[a].max(p[a])),
        })
    }

    pub(super) fn sides(self) -> [f64; 2] {
        std::array::from_fn(|a| self.high[a] - self.low[a])
    }

    pub(super) fn longer_side(self) -> f64 {
        let [x, y] = self.sides();
        x.max(y)
    }

    pub(super) fn grown(self, by: f64) -> Self {
        Self { low: self.low.map(|c| c - by), high: self.high.map(|c| c + by) }
    }
}

/// Every position of the data.
pub(super) fn positions(input: &PlanarData) -> impl Iterator<Item = &[f64; 2]> {
    let points = input.points.iter().map(|p| &p.position);
    points.chain(input.segments.as_flattened()).chain(input.polygons.iter().flatten())
}

/// Segments and the sides of polygons.
pub(super) fn lines(input: &PlanarData) -> impl Iterator<Item = [[f64; 2]; 2]> {
    let sides = |ring: &Vec<[f64; 2]>| -> Vec<[[f64; 2]; 2]> {
        (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect()
    };
    input.segments.iter().copied().chain(input.polygons.iter().flat_map(sides))
}

pub(super) fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

/// The length of all lines.
pub(super) fn length(input: &PlanarData) -> f64 {
    lines(input).map(|[p, q]| distance(p, q)).sum()
}

/// The points, and as many places along the lines as make their spacing about even: where functions and vertices may sit.
pub(super) fn places(input: &PlanarData) -> Vec<[f64; 2]> {
    /// Places along all lines together.
    const ALONG: f64 = 400.0;
    let spacing = length(input) / ALONG;
    let mut places: Vec<[f64; 2]> = input.points.iter().map(|p| p.position).collect();
    for [p, q] in lines(input) {
        let parts = (distance(p, q) / spacing).ceil().max(1.0) as usize;
        places.extend((0..=parts).map(|i| {
            let t = i as f64 / parts as f64;
            std::array::from_fn(|a| p[a] + t * (q[a] - p[a]))
        }));
    }
    places
}

/// The mean distance of a position to its nearest; 0 if there are fewer than two.
pub(super) fn mean_spacing(positions: &[[f64; 2]]) -> f64 {
    let nearest = |i: usize| {
        let others = (0..positions.len()).filter(|&j| j != i);
        others.map(|j| distance(positions[i], positions[j])).fold(f64::INFINITY, f64::min)
    };
    match positions.len() {
        0 | 1 => 0.0,
        n => (0..n).map(nearest).sum::<f64>() / n as f64,
    }
}
