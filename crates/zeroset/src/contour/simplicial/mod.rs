//! Zero sets of an expansion: polylines in the plane, triangles in space, without branches that no data bear.
//!
//! # What
//! [`zero_lines`] and [`zero_surface`] cut {F = 0} out cell by cell. Pieces meet on the faces of the cells, as all that belongs to a
//! vertex, an edge or a node is computed once. The value 0 counts as positive, so every sign is certain.
//!
//! In the plane:
//!
//! | F on a triangle | piece |
//! |---|---|
//! | linear | a segment, exact |
//! | quadratic | arcs of a conic, flattened to the tolerance; up to three, or a whole ellipse |
//! | else | one curve between two crossings of the edges, followed to the tolerance |
//!
//! In space the tetrahedra are cut into 8 parts as often as asked, and each part into triangles by the signs at its corners.
//!
//! # Formula
//! Along an edge F is q(t) = a (1 - t)^2 + 2 b t (1 - t) + c t^2, and t / (1 - t) solves a quadratic equation; so crossings are exact.
//! A conic is convex on one side: {F < 0}, say, is one convex set or two, the two on different sides of a line through the centre of a
//! hyperbola. A convex set has a convex part in common with the triangle. The parts of the triangle's outline that lie in one set follow
//! one another around the triangle, and an arc leads from the end of each to the beginning of the next. An arc is halved where
//! the normal in the middle of its chord meets it, until it rises above the chord by at most half the tolerance and does not bend back
//! under it; an arc lies nowhere farther from such a chord than twice its height in the middle.
//!
//! # Branches
//! A quadratic can hold a corner inside a cell: two lines are a degenerate hyperbola. It then has a second branch that no data
//! bear. [`Branches::WithData`] drops it. The rule: a sample belongs to the component of the zero set that is nearest to it among
//! those of its own cell and of the cells across its faces. It tells nothing if that is farther than a quarter of the cell's longest
//! edge, or if a component of another curve (one that does not continue this one) is not at least twice as far. A component
//! holds data if its curve has a sample there; it stays if it holds data or continues, through whatever cells, one that does.
//! A curve with fewer than one in twenty of the samples in the cells that it passes is left to outliers, and goes. It follows that
//! - a curve is followed through empty cells until the domain ends;
//! - a loop in empty cells goes;
//! - a branch without data goes with all that it leads to, unless it leads to data.
//!
//! # Cost
//! Linear in the number of cells, times 8^subdivisions in space, plus the points that a tolerance asks for: about
//! 1 / sqrt(tolerance) along a curve. The values of radial functions cost most: each asks for all centres.
//!
//! # Guaranteed
//! - Curves are closed or end on the rim of where F is known; F < 0 lies on their left.
//! - Points of a conic have F = 0 to rounding; between them the polyline is within the tolerance of the conic.
//! - Each surface is a manifold of indexed triangles, counter-clockwise seen from F > 0, with its boundary on the rim of where F is
//!   known, and its vertices have F = 0 to rounding.
//! - The order is that of the cells, whatever the number of threads.
//!
//! # Not guaranteed
//! - Functions that are neither linear nor quadratic are seen at the corners of the cells only: what passes between two corners of
//!   one sign is missed, and so is a curve that doubles back between two crossings. The tolerance is then an aim.
//! - In space a sub-edge with two roots counts as having none, for quadratics, too: thin sheets ask for more subdivisions.
//!
//! # Failure cases
//! - A zero exactly at a node of the refined mesh gives several vertices in that place, joined by triangles without area.
//! - Which way two lines are joined where they cross is decided by rounding. If it joins an arm with data to one without,
//!   both stay: the arms are one component.
//! - Cells on which F is not finite are left out.
//!
//! # Source
//! The removal of branches is that of G. M. Nielson, 3AI 2013, "data in cells and continuity"; the rules against outliers are ours. Red
//! refinement: J. Bey, Computing 55, 1995. Marching tetrahedra: Doi and Koide, IEICE Transactions E74, 1991.
//!
//! ```
//! use zeroset::basis::{Basis, Expansion, P2};
//! use zeroset::contour::{Branches, zero_lines};
//! use zeroset::domain::SimplicialMesh;
//!
//! let basis = P2::new(SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2])?);
//! // Two lines that nearly cross, with data along one half of each.
//! let corner = |[x, y]: [f64; 2]| (x - 0.1) * y - 1e-4;
//! let coefficients: Vec<f64> = (0..basis.len()).filter_map(|j| basis.node(j)).map(corner).collect();
//! let f = Expansion::new(&basis, &coefficients);
//! let data: Vec<_> = (1..9)
//!     .map(|i| 0.1 * f64::from(i))
//!     .flat_map(|t| [[0.1 + t, 0.0], [0.1, t]])
//!     .filter_map(|p| basis.domain().locate(p))
//!     .collect();
//!
//! assert_eq!(zero_lines(&f, 1e-6, Branches::All).len(), 2);
//! let kept = zero_lines(&f, 1e-6, Branches::WithData(&data));
//! assert_eq!(kept.len(), 1);
//! assert!(kept[0].points.iter().all(|p| p[0] > 0.1));
//! # Ok::<(), zeroset::domain::DomainError>(())
//! ```

mod branches;
mod conic;
mod follow;
mod lines;
mod refine;
mod roots;
mod surface;

#[cfg(test)]
mod tests;

pub use lines::zero_lines;
pub use surface::zero_surface;

use crate::domain::Place;

/// A curve of the zero set in the plane.
///
/// F < 0 lies to its left, so the outline of a negative region is counter-clockwise, and that of a hole in it clockwise.
#[derive(Debug, Clone, PartialEq)]
pub struct Polyline {
    /// Its points, at least two; at least three if it is closed. No two in succession are equal.
    pub points: Vec<[f64; 2]>,
    /// Whether the last point is joined to the first, which is not repeated. Open curves end on the rim of where F is known.
    pub closed: bool,
}

/// Which parts of the zero set to keep.
#[derive(Debug, Clone, Copy)]
pub enum Branches<'a, const D: usize> {
    /// All of them.
    All,
    /// Those that hold some of the data at these places, and what continues them. Each place names the simplex that holds it.
    WithData(&'a [Place<D>]),
}
