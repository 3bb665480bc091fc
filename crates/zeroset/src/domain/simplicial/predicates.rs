//! Exact signs: on which side of a face, in or out of a sphere.
//!
//! The predicates of Shewchuk 1997 as the crate `robust` has them. They are exact while nothing over- or underflows, which he
//! proves for coordinates that are zero or lie in 2^-142..=2^201.

use super::DomainError;
use robust::{Coord, Coord3D};

/// Least magnitude of a coordinate that is not zero.
pub(super) const LEAST: f64 = f64::from_bits((1023 - 142) << 52);
/// Most magnitude of a coordinate.
pub(super) const MOST: f64 = f64::from_bits((1023 + 201) << 52);

fn flat<const D: usize>(p: [f64; D]) -> Coord<f64> {
    Coord { x: p[0], y: p[1] }
}

fn solid<const D: usize>(p: [f64; D]) -> Coord3D<f64> {
    Coord3D { x: p[0], y: p[1], z: p[2] }
}

/// Twice the area of a triangle, six times the volume of a tetrahedron; the sign is exact, the magnitude rounded. Positive if the
/// triangle is counter-clockwise, or if the first three corners of the tetrahedron are clockwise as the fourth sees them.
pub(super) fn orientation<const D: usize>(corners: &[[f64; D]]) -> f64 {
    if D == 2 {
        robust::orient2d(flat(corners[0]), flat(corners[1]), flat(corners[2]))
    } else {
        // `robust` has the other sign.
        robust::orient3d(solid(corners[1]), solid(corners[0]), solid(corners[2]), solid(corners[3]))
    }
}

/// The orientation of a simplex with one corner put elsewhere: its sign tells on which side of the face opposite to the corner the
/// position lies. Positive inside.
#[inline]
pub(super) fn side<const D: usize>(simplex: &[[f64; D]; 4], corner: usize, position: [f64; D]) -> f64 {
    let mut moved = *simplex;
    moved[corner] = position;
    orientation(&moved[..=D])
}

/// Whether a position lies in a closed simplex that is positively oriented.
pub(super) fn holds<const D: usize>(simplex: &[[f64; D]; 4], position: [f64; D]) -> bool {
    (0..=D).all(|c| side(simplex, c, position) >= 0.0)
}

/// Positive if the position lies inside the sphere around a positively oriented tetrahedron, zero on it.
pub(super) fn in_sphere(tetrahedron: &[[f64; 3]; 4], position: [f64; 3]) -> f64 {
    let [a, b, c, d] = tetrahedron.map(solid);
    robust::insphere(b, a, c, d, solid(position))
}

/// Whether three positions in space lie in one line: they do so in all three projections.
pub(super) fn in_line([a, b, c]: [[f64; 3]; 3]) -> bool {
    PROJECTIONS.iter().all(|axes| orientation(&[a, b, c].map(|p| project(p, *axes))) == 0.0)
}

/// The pairs of axes that space is projected to.
pub(super) const PROJECTIONS: [[usize; 2]; 3] = [[0, 1], [1, 2], [2, 0]];

/// A position in space without one of its axes.
pub(super) fn project<const D: usize>(p: [f64; D], axes: [usize; 2]) -> [f64; 2] {
    axes.map(|a| p[a])
}

/// Refuses coordinates for which the predicates are not exact.
pub(super) fn in_range<const D: usize>(positions: &[[f64; D]]) -> Result<(), DomainError> {
    for (vertex, position) in positions.iter().enumerate() {
        if !position.iter().all(|c| c.is_finite()) {
            return Err(DomainError::NotFinite { vertex });
        }
        let exact = |c: f64| c == 0.0 || (LEAST..=MOST).contains(&c.abs());
        if let Some(&coordinate) = position.iter().find(|c| !exact(**c)) {
            return Err(DomainError::OutOfRange { vertex, coordinate, least: LEAST, most: MOST });
        }
    }
    Ok(())
}
