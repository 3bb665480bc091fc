//! From data to F: two fits of one idea.
//!
//! Both minimise a normalised energy E(F) / N(F), so that F is kept from zero without normals.
//!
//! - [`cascade`] fits millions of points on the sparse lattice, coarse to fine. It is what reconstructs a city.
//! - [`normalized`] is the same idea in general: in 2D and 3D, on any simplicial mesh or with radial functions, from points, lines
//!   and facets, with every normalisation. It is exact, small, and the reference that the cascade is tested against.
//!
//! `eigen` holds the eigensolvers that both use.

pub mod cascade;
pub(crate) mod eigen;
mod frame;
pub mod normalized;

pub(crate) use frame::Frame;
pub use frame::Up;

use serde::Serialize;

/// Which gradient of a piecewise linear F enters the normalisation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Gradient {
    /// That of F on the sample's own simplex.
    Element,
    /// Taken at the nodes from their neighbours, and interpolated: on a lattice central differences.
    Recovered,
}
