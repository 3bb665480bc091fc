//! The part of a flat inside a box.

use zeroset::feature::newe::Flat;

/// A box along the axes: the least and the greatest coordinates.
#[derive(Clone, Copy)]
pub(crate) struct Bounds<const D: usize> {
    pub(crate) low: [f64; D],
    pub(crate) high: [f64; D],
}

impl<const D: usize> Bounds<D> {
    /// The box of points, and a margin around it that is a share of its longest side.
    pub(crate) fn around(points: &[[f64; D]], margin: f64) -> Self {
        let mut bounds = Self { low: [f64::INFINITY; D], high: [f64::NEG_INFINITY; D] };
        for point in points {
            bounds.low = std::array::from_fn(|a| bounds.low[a].min(point[a]));
            bounds.high = std::array::from_fn(|a| bounds.high[a].max(point[a]));
        }
        let wide = (0..D).map(|a| bounds.high[a] - bounds.low[a]).fold(0.0, f64::max) * margin;
        Self { low: bounds.low.map(|c| c - wide), high: bounds.high.map(|c| c + wide) }
    }

    pub(crate) fn holds(&self, point: &[f64; D]) -> bool {
        (0..D).all(|a| (self.low[a]..=self.high[a]).contains(&point[a]))
    }

    /// Corner number `i`: bit a says which end along axis a.
    pub(crate) fn corner(&self, i: usize) -> [f64; D] {
        std::array::from_fn(|a| if i >> a & 1 == 0 { self.low[a] } else { self.high[a] })
    }

    /// The edges, as pairs of corners.
    pub(crate) fn edges(&self) -> Vec<[[f64; D]; 2]> {
        (0..D)
            .flat_map(|a| (0..1_usize << D).filter(move |i| i >> a & 1 == 0).map(move |i| [i, i | 1 << a]))
            .map(|ends| ends.map(|i| self.corner(i)))
            .collect()
    }

    /// Where a flat crosses the edges, in no order.
    pub(crate) fn crossings(&self, flat: &Flat<D>) -> Vec<[f64; D]> {
        let crossing = |[p, q]: [[f64; D]; 2]| {
            let (a, b) = (flat.signed_distance(&p), flat.signed_distance(&q));
            (a * b <= 0.0 && a != b).then(|| std::array::from_fn(|c| p[c] + a / (a - b) * (q[c] - p[c])))
        };
        self.edges().into_iter().filter_map(crossing).collect()
    }
}
