//! A scene seen by a camera, as a grid of colours.
//!
//! # What
//! Points are discs, lines have a width in pixels, surfaces are lit from the upper left of the camera and from the sky. Depth
//! is shown by darkening what lies behind its surroundings on the picture (eye-dome lighting), so clouds need no normals.
//!
//! # How
//! 1. All positions are placed on the picture (`camera.rs`), in the homogeneous coordinates of Olano and Greer: triangles need no clipping.
//! 2. The picture, in so many samples a pixel, is cut into squares. Each gets a list of what may show in it, in order.
//! 3. Squares are drawn on all threads: each sample keeps the nearest thing, and of equally near ones the first.
//! 4. What is seen gets its colour and its light, once a sample; samples become pixels.
//!
//! # Cost
//! Linear in the things that are drawn and in the samples. A million triangles on 1600 by 1200 pixels with four samples each: see
//! `bench/render.py`.
//!
//! # Guaranteed
//! Equal scenes and views give equal pictures, on any number of threads. Two triangles with a common edge leave no gap between them.
//!
//! # Not guaranteed
//! Things smaller than a sample may be missed. Nothing is transparent but the background.
//!
//! Sources: Olano, Greer 1997, *Triangle scan conversion using 2D homogeneous coordinates*; Boucheny 2009, eye-dome lighting.

mod camera;
mod legend;
mod raster;
mod shade;
mod text;

#[cfg(test)]
mod tests;

pub use camera::{Direction, Projection};

use zeroset::reconstruct::Up;

use crate::color::Rgb;
use crate::scene::Scene;
use camera::Camera;
use raster::Frame;

/// How a scene is seen.
#[derive(Debug, Clone, PartialEq)]
pub struct View {
    /// From where.
    pub direction: Direction,
    /// The axis of the scene that points to the sky.
    pub up: Up,
    /// How depth is shown.
    pub projection: Projection,
    /// How many times larger than what fits into the picture.
    pub zoom: f64,
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Samples along either side of a pixel.
    pub antialias: u32,
    /// What is behind everything.
    pub background: Background,
}

impl Default for View {
    fn default() -> Self {
        Self {
            direction: Direction::Iso,
            up: Up::Z,
            projection: Projection::default(),
            zoom: 1.0,
            size: [1600, 1200],
            antialias: 2,
            background: Background::Plain([255, 255, 255]),
        }
    }
}

/// What is behind everything.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// A colour.
    Plain(Rgb),
    /// Nothing.
    Transparent,
}

/// A grid of colours.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across and down.
    pub size: [u32; 2],
    /// Red, green, blue and opacity, row by row from the top; colours are not multiplied by opacity.
    pub pixels: Vec<[u8; 4]>,
}

/// A picture that cannot be made.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum RenderError {
    /// Nothing to see.
    #[error("there is nothing to draw: no finite point, no triangle and no line")]
    Empty,
    /// Pixels.
    #[error("a picture of {width} by {height} pixels is not possible; give sides of 16 to {MOST_PIXELS}")]
    Size {
        /// Across.
        width: u32,
        /// Down.
        height: u32,
    },
    /// Samples.
    #[error("{0} samples along a pixel are not possible; give 1 to {MOST_SAMPLES}")]
    Antialias(u32),
    /// Zoom.
    #[error("a zoom of {0} is not possible; give a number above 0")]
    Zoom(f64),
    /// Angle of view.
    #[error("an angle of view of {0} degrees is not possible; give more than 0 and less than 170")]
    FieldOfView(f64),
    /// A camera in its own target.
    #[error("the camera stands where it looks; place it somewhere else")]
    CameraInTarget,
    /// Too much.
    #[error("{0} points, triangles and lines are more than can be drawn; leave some out")]
    TooMany(usize),
    /// Triangles or colours that name positions that are not there.
    #[error(
        "layer {0} names positions that it does not have, or has not one colour for each; this is a fault of the program that made it"
    )]
    Broken(usize),
}

/// Pixels along a side.
pub const MOST_PIXELS: u32 = 16_384;
/// Samples along a side of a pixel.
pub const MOST_SAMPLES: u32 = 4;

/// Draws a scene.
///
/// # Errors
/// If there is nothing to draw, or the view or a layer makes no sense.
pub fn render(scene: &Scene, view: &View) -> Result<Picture, RenderError> {
    let [width, height] = view.size;
    if !view.size.iter().all(|side| (16..=MOST_PIXELS).contains(side)) {
        return Err(RenderError::Size { width, height });
    }
    if !(1..=MOST_SAMPLES).contains(&view.antialias) {
        return Err(RenderError::Antialias(view.antialias));
    }
    for (i, layer) in scene.layers.iter().enumerate() {
        layer.check().map_err(|()| RenderError::Broken(i))?;
    }
    let panel = scene.legend.as_ref().map(|legend| legend::Panel::new(legend, view.size));
    let free = panel.as_ref().map_or(width, |panel| width - panel.width());
    let camera = Camera::new(scene, view, [free, height])?;
    let frame = Frame::draw(scene, &camera, view)?;
    let mut picture = shade::picture(&camera, &frame, view);
    if let Some(panel) = panel {
        panel.draw(&mut picture, view.background);
    }
    Ok(picture)
}
