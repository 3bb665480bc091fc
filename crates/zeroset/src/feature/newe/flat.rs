//! Flats, and where they meet.

use super::eigen;

/// A hyperplane: a line in the plane, a plane in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Flat<const D: usize> {
    /// Unit normal. Its sign has no meaning; its component of largest size is positive.
    pub normal: [f64; D],
    /// `normal . x` of the points x of the flat, in their unit.
    pub offset: f64,
}

/// Eigenvalues of the sum of n n' up to which flats count as parallel: normals less than 0.08 degrees apart.
const PARALLEL: f64 = 1e-6;

impl<const D: usize> Flat<D> {
    /// The flat with a normal of any length through a point. `None` if the normal is zero or not finite.
    #[must_use]
    pub fn through(point: [f64; D], normal: [f64; D]) -> Option<Self> {
        let largest = normal.iter().fold(0.0_f64, |largest, c| largest.max(c.abs()));
        if largest == 0.0 || !normal.iter().all(|c| c.is_finite()) {
            return None;
        }
        // Divided by the largest component first, so that squares neither overflow nor vanish.
        let shrunk = normal.map(|c| c / largest);
        let length = dot(&shrunk, &shrunk).sqrt();
        let lead = normal.iter().copied().find(|c| c.abs() == largest).unwrap_or(1.0);
        let unit = shrunk.map(|c| c * lead.signum() / length);
        Some(Self { normal: unit, offset: dot(&unit, &point) })
    }

    /// Distance of a point from the flat, positive on the side of the normal.
    #[inline]
    #[must_use]
    pub fn signed_distance(&self, point: &[f64; D]) -> f64 {
        dot(&self.normal, point) - self.offset
    }

    /// Whether two flats differ by no more than `length`, measured at the origin and at distance 1 from it.
    pub(super) fn agrees(&self, other: &Self, length: f64) -> bool {
        let sign = dot(&self.normal, &other.normal).signum();
        let across: [f64; D] = std::array::from_fn(|a| self.normal[a] - sign * other.normal[a]);
        (self.offset - sign * other.offset).abs() <= length && dot(&across, &across) <= length * length
    }

    /// The angle in radians between two flats, from 0 to a quarter turn.
    #[must_use]
    pub fn angle(&self, other: &Self) -> f64 {
        // The sine from the part of one normal across the other: the inverse cosine is blind near 0.
        let cos = dot(&self.normal, &other.normal);
        let across: [f64; D] = std::array::from_fn(|a| other.normal[a] - cos * self.normal[a]);
        dot(&across, &across).sqrt().atan2(cos.abs())
    }
}

/// Where flats meet.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Meeting<const D: usize> {
    /// The common point.
    pub position: [f64; D],
    /// How many independent directions the flats fix: D at a corner, one less along an edge.
    pub rank: usize,
}

/// The point nearest to `near` among those that lie on all flats, or as near to them as can be.
///
/// With D independent flats it is the corner, and `near` does not matter but for rounding. With fewer it is the foot of `near` on
/// what they share; with more, the point of least squared distances. Normals less than 0.08 degrees apart count as parallel.
#[must_use]
pub fn corner<const D: usize>(flats: &[Flat<D>], near: [f64; D]) -> Meeting<D> {
    let mut matrix = [[0.0; D]; D];
    let mut pull = [0.0; D];
    for flat in flats {
        let distance = flat.signed_distance(&near);
        for a in 0..D {
            pull[a] -= flat.normal[a] * distance;
            for (entry, component) in matrix[a].iter_mut().zip(&flat.normal) {
                *entry += flat.normal[a] * component;
            }
        }
    }
    let mut axes = [[0.0; D]; D];
    eigen::diagonalize(matrix.as_flattened_mut(), axes.as_flattened_mut(), D);
    let mut meeting = Meeting { position: near, rank: 0 };
    for (a, axis) in axes.iter().enumerate() {
        let value = matrix[a][a];
        if value > PARALLEL {
            let step = dot(axis, &pull) / value;
            meeting.rank += 1;
            meeting.position = std::array::from_fn(|c| meeting.position[c] + step * axis[c]);
        }
    }
    meeting
}

/// A straight line in space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    /// A point of the line.
    pub point: [f64; 3],
    /// Unit direction. Its sign has no meaning.
    pub direction: [f64; 3],
}

/// The line in which two planes meet; its point is the one nearest to `near`. `None` for parallel planes, less than 0.08 degrees
/// apart.
#[must_use]
pub fn edge_line(planes: [Flat<3>; 2], near: [f64; 3]) -> Option<Line> {
    let direction = crate::vec3::normalized(crate::vec3::cross(planes[0].normal, planes[1].normal))?;
    let meeting = corner(&planes, near);
    (meeting.rank == 2).then_some(Line { point: meeting.position, direction })
}

#[inline]
pub(super) fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    let mut sum = 0.0;
    for c in 0..D {
        sum += a[c] * b[c];
    }
    sum
}
