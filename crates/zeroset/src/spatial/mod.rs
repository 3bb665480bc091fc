//! Bounding-volume trees over points and over triangles.
//!
//! # What
//! [`PointTree`] finds the nearest points of a cloud; [`TriangleTree`] finds the exact closest point of a mesh, the
//! first hit of a ray, and the generalised winding number. All answers are exact but the last, which states its error.
//!
//! # How
//! One builder serves both: items are split at the median of the longest axis of their centres until eight or fewer
//! (points) or four or fewer (triangles) remain. An inner node keeps the tight boxes of its two children side by side,
//! so one fetch decides which child to enter first and whether to enter the other at all.
//!
//! # Cost
//! Building n items costs O(n log n) and runs on all threads. A query visits O(log n) nodes for data that lie on a
//! surface. Memory: about 50 bytes a point and 170 bytes a triangle.
//!
//! # Guaranteed
//! - The same answer whatever the number of threads: the tree is determined by its items, and among equal distances the
//!   lowest index wins.
//! - Equal points, collinear points, one and zero points, degenerate triangles and unused vertices are all legal.
//! - Items with a non-finite coordinate are passed over; they are never an answer.
//!
//! # Not guaranteed
//! Distances whose square overflows (coordinates over about 1e150) come out infinite.

mod moving;
mod overlap;
mod points;
mod ray;
mod tree;
mod triangles;
mod winding;

#[cfg(test)]
mod tests;

pub(crate) use moving::MovingBoxes;
pub use points::{Neighbour, PointTree};
pub use ray::RayHit;
pub(crate) use triangles::closest_on_triangle;
pub use triangles::{ClosestPoint, TriangleTree};
pub use winding::WindingNumber;
