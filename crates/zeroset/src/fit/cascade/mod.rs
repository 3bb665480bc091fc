//! Fits F to raw points, coarse to fine: the normal-free cascade.
//!
//! # What
//! Finds F with F(P_i) = 0 from points without normals by minimising a normalised energy
//!
//! ```text
//! R(F) = E(F) / N(F)^2
//! E(F) = alpha * sum_i w_i F(P_i)^2 + integral |grad F|^2  ( + gamma * sum_c F_c^2 )
//! N(F) = sum_i w_i |grad F(P_i)|                           ( + gamma * sum_c t_c F_c )
//! ```
//!
//! The terms in brackets are the column prior of airborne scenes: node c is told to be air (t = 1/2) or solid (t = -1/2). All
//! lengths are in cells of the level at hand, and w_i = 1 / (mean number of points in the occupied cells around i), so that the
//! surface weighs the same whatever the density of the scan.
//!
//! # How
//! Freeze n_i = grad F(P_i) / |grad F(P_i)|, solve the linear system (alpha B'WB + L + gamma) F = div(sum_i w_i n_i delta_i) +
//! gamma t, repeat. N is convex and homogeneous, so it lies above its linearisation, and each step lowers R (an inverse
//! power step for a nonlinear eigenproblem). This stays true when the system is only solved roughly: F is first scaled to the
//! best multiple of itself, and each step of conjugate gradients lowers the quadratic from there.
//!
//! The gradient in N is that of the point's own tetrahedron while inside and outside are decided, and on thin-walled bodies;
//! else the recovered one: central differences at the nodes, interpolated to the points. The right-hand side is its exact
//! transpose either way.
//!
//! # Source
//! The normalisation with p = 1: design of this project, after Taubin 1991 and Hein & Buehler 2010. One step is a
//! screened Poisson solve (Kazhdan & Hoppe 2013).

mod coarse_to_fine;
mod eigen_seed;
mod free;
mod gradient;
mod level;
mod operator;
mod polish;
mod prior;
mod prolong;
mod region;
mod samples;
mod seed;
mod solve;
mod stencil;

#[cfg(test)]
mod tests;

pub(crate) use coarse_to_fine::SHARE;
pub use coarse_to_fine::{FitError, FitParams, FitReport, Iteration, LevelReport, Prepared, Scene, fit};
pub(crate) use polish::{Held, OrientedTriangle, polish};
pub use polish::{PolishParams, PolishReport};
pub(crate) use region::Region;
