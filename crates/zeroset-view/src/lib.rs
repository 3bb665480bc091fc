//! Pictures of clouds, meshes and features, without a display and without a graphics card, and a page that shows them.
//!
//! ```text
//! scene (what is there) ── color (which colour stands for what) ── render (camera, drawing, light) ── a picture
//!                                                               └─ serve (octree, bytes, server) ── the page in page/
//! ```
//!
//! - [`scene`]: layers of points, surfaces and lines, each with its colours.
//! - [`color`]: scales from values to colours, colours of classes and planes, legends.
//! - [`render`]: a scene seen by a camera. Equal scenes give equal pictures bit for bit, on any number of threads.
//! - [`serve`]: a server on this machine, and what it sends to the page.
//!
//! Nothing here knows of files: what is drawn comes as the core's clouds, meshes and features, and a picture is a grid of colours.
//!
//! ```
//! use zeroset::sample::{Scene as Sample, SceneKind};
//! use zeroset_view::render::{Direction, View, render};
//! use zeroset_view::scene::{Layer, Paint, Scene};
//!
//! let torus = Sample::new(SceneKind::Torus, 0).truth;
//! let scene = Scene { layers: vec![Layer::surface(torus, Paint::Plain([200, 180, 90]))], legend: None };
//! let picture = render(&scene, &View { direction: Direction::Front, size: [64, 48], ..View::default() })?;
//! assert_eq!(picture.pixels.len(), 64 * 48);
//! # Ok::<(), zeroset_view::render::RenderError>(())
//! ```

pub mod color;
pub mod render;
pub mod scene;
pub mod serve;
mod vector;
