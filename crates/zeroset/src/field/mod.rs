//! Fields: F as a function of space, and the solid it bounds.
//!
//! # What
//! A [`Field`] has a value, a gradient and bounds everywhere. F < 0 inside, F > 0 outside, and the gradient points outward. Fields are
//! fitted models ([`LatticeSolid`], and [`ExpansionField`] for small fits), primitives ([`HalfSpace`], [`Cuboid`], [`Ball`], [`Frustum`] for cylinders and cones, [`Prism`], [`HeightField`],
//! [`MeshSolid`]), and what is made of others: [`Union`], [`Intersection`], [`Difference`], [`Complement`], [`SmoothUnion`], [`Offset`],
//! [`Shell`], [`Placed`] and [`Tagged`].
//!
//! # Formulas
//! Union is the least of the values, intersection the greatest, complement the negative, and a difference the intersection with a complement.
//!
//! # Distances
//! [`Field::metric`] tells what |F| is. Primitives are [`Metric::Distance`], true signed distances. What is made of them is
//! [`Metric::Bound`]: the surface is never nearer than |F|, and near a smooth part of it |F| is the distance.
//!
//! # Sheets
//! The surface of a field is made of smooth *sheets*, the faces of a box, say. [`Field::sheet`] names the one that counts at a position, and
//! [`Field::on_sheet`] carries it on beyond its edges. So the extraction ([`contour_field`](crate::contour::contour_field)) finds the edges
//! of a solid from its operands, and not from its cells.
//!
//! ```
//! use std::sync::Arc;
//! use zeroset::field::{Ball, Cuboid, Difference, Field};
//!
//! let block = Cuboid::new([0.0; 3], [4.0, 2.0, 1.0])?;
//! let hole = Ball::new([2.0, 1.0, 1.0], 0.5)?;
//! let part = Difference::new(Arc::new(block), Arc::new(hole));
//! assert!(part.value([1.0, 1.0, 0.5]) < 0.0);
//! assert!(part.value([2.0, 1.0, 0.8]) > 0.0);
//! // No surface within a small box in the hole.
//! assert!(part.bounds([1.9, 0.9, 0.8], [2.1, 1.1, 0.9]).low > 0.0);
//! # Ok::<(), zeroset::field::FieldError>(())
//! ```
//!
//! # Source
//! Boolean operations by least and greatest values: A. Ricci, A constructive geometry for computer graphics, 1973. Bounds by a Lipschitz
//! constant: D. Kalra and A. Barr, Guaranteed ray intersections with implicit surfaces, 1989.

mod combine;
mod expansion;
mod interval;
mod lattice;
mod primitive;

#[cfg(test)]
mod tests;

pub use combine::{Complement, Difference, Intersection, Offset, Placed, Placement, Shell, SmoothUnion, Tagged, Union};
pub use expansion::ExpansionField;
pub use interval::Interval;
pub use lattice::{LatticeField, LatticeSolid};
pub use primitive::{Ball, Cuboid, Frustum, HalfSpace, HeightField, MeshSolid, Prism};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use crate::vec3::{self, Vec3};

/// What the absolute value of a field is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Metric {
    /// The distance to the surface.
    Distance,
    /// Never more than the distance to the surface; equal to first order beside a smooth part of it.
    Bound,
    /// About the distance within some cells of the surface; beyond them only the sign counts.
    Near,
    /// Nothing: only the sign counts, and the gradient at the surface.
    Sign,
}

/// A field that cannot be.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FieldError {
    /// A number is infinite or not a number.
    #[error("{what} of {value} is not possible: give a finite number")]
    NotFinite {
        /// Which number.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A length that should be positive.
    #[error("{what} of {value} is not possible: give a positive length")]
    NotPositive {
        /// Which length.
        what: &'static str,
        /// The length.
        value: f64,
    },
    /// A shape without volume or direction.
    #[error("{0}")]
    Empty(&'static str),
    /// A mesh that bounds nothing.
    #[error("the mesh is not closed: {boundary_edges} of its edges have one triangle; close it first")]
    Open {
        /// Edges with one triangle.
        boundary_edges: usize,
    },
    /// A mesh that can't be examined.
    #[error(transparent)]
    Broken(#[from] crate::mesh::MeshError),
}

/// A field among those that another is made of.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Operand {
    /// The number that it was given: see [`Tagged`].
    pub tag: Option<usize>,
    /// Where its coordinates lie in those of the whole.
    pub placement: Placement,
    /// Whether its outside is inside of the whole.
    pub is_reversed: bool,
}

/// A function of space whose zero set is a surface: F < 0 inside, F > 0 outside.
pub trait Field: Send + Sync + std::fmt::Debug {
    /// F at a position.
    fn value(&self, p: [f64; 3]) -> f64;

    /// The gradient of F at a position, which points outward. On a crease it is that of one of the sides.
    fn gradient(&self, p: [f64; 3]) -> [f64; 3];

    /// Both, which may take less time together.
    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        (self.value(p), self.gradient(p))
    }

    /// Both at some positions, to the same bits, which may take less time than one by one. `found` is as long as `points`.
    fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
        for (p, found) in points.iter().zip(found) {
            *found = self.value_and_gradient(*p);
        }
    }

    /// What |F| is.
    fn metric(&self) -> Metric;

    /// F changes by no more than this for a unit of length.
    fn lipschitz(&self) -> f64 {
        1.0
    }

    /// An interval that holds F over a box, corners included. Sound: no value is outside of it.
    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let middle = vec3::lerp(low, high, 0.5);
        let radius = 0.5 * vec3::distance(low, high);
        // Values round by some bits of the coordinates they are made from.
        let rounding = 1e-13 * low.iter().chain(&high).fold(radius, |most, c| most.max(c.abs()));
        let value = self.value(middle);
        Interval::around(value, self.lipschitz() * (radius + rounding) + 1e-13 * value.abs())
    }

    /// A box outside of which the surface has no part; `None` if there is no such box. It may be infinite along some axes.
    fn extent(&self) -> Option<[[f64; 3]; 2]>;

    /// Number of sheets.
    fn sheets(&self) -> u32 {
        1
    }

    /// The sheet that counts at a position: the nearest part of the surface belongs to it.
    fn sheet(&self, p: [f64; 3]) -> u32 {
        let _ = p;
        0
    }

    /// The smooth function whose zero set carries a sheet, and its gradient: equal to F where the sheet counts, and carried on beyond.
    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let _ = sheet;
        (self.value(p), self.gradient(p))
    }

    /// Whether a sheet lies in a plane.
    fn is_flat(&self, sheet: u32) -> bool {
        let _ = sheet;
        false
    }

    /// The operand that a sheet belongs to.
    fn operand(&self, sheet: u32) -> Operand {
        let _ = sheet;
        Operand::default()
    }

    /// F at many positions, on all threads.
    fn values(&self, points: &[[f64; 3]]) -> Vec<f64> {
        points.par_iter().with_min_len(64).map(|&p| self.value(p)).collect()
    }

    /// The gradient at many positions, on all threads.
    fn gradients(&self, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
        points.par_iter().with_min_len(64).map(|&p| self.gradient(p)).collect()
    }
}

/// Checks that numbers are finite.
fn finite(what: &'static str, values: &[f64]) -> Result<(), FieldError> {
    match values.iter().find(|v| !v.is_finite()) {
        Some(&value) => Err(FieldError::NotFinite { what, value }),
        None => Ok(()),
    }
}

/// Checks that a length is finite and positive.
fn positive(what: &'static str, value: f64) -> Result<(), FieldError> {
    finite(what, &[value])?;
    if value > 0.0 { Ok(()) } else { Err(FieldError::NotPositive { what, value }) }
}

/// The unit vector of a vector; up for one without length, where no direction is better than another.
fn direction(v: Vec3) -> Vec3 {
    vec3::normalized(v).unwrap_or([0.0, 0.0, 1.0])
}
