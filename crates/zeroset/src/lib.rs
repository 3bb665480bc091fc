//! Implicit models from raw point clouds.
//!
//! `zeroset` finds a function F of space whose zero set is the surface that a cloud of points was measured on. It needs
//! no normals and no orientation. F is negative inside and positive outside.
//!
//! The rooms follow the data: [`cloud`] -> [`domain`] -> [`basis`] -> [`fit`] -> [`field`] -> [`contour`] -> [`mesh`]; [`reconstruct`]
//! walks through all of them in one call, and [`tile`] does so piece by piece. [`feature`] finds planes, edges and corners, and [`constraint`] holds those that the user knows. The remaining
//! rooms serve all of these: [`spatial`] answers nearest-neighbour questions, [`sample`] makes scenes with a known truth, and
//! [`monitor`] carries progress out and a wish to stop in.

pub mod basis;
pub mod cloud;
pub mod constraint;
pub mod contour;
pub mod domain;
pub mod feature;
pub mod field;
pub mod fit;
pub mod mesh;
pub mod model;
pub mod monitor;
pub mod reconstruct;
pub mod sample;
pub mod spatial;
pub mod tile;

mod vec3;
