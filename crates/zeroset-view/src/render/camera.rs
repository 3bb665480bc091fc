//! Where positions come to lie on the picture.

use super::{RenderError, View};
use crate::scene::{Layer, Scene};
use crate::vector::{self, Vec3};

/// From where a scene is seen.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum Direction {
    /// From the south-west and above, along the diagonal of a cube.
    #[default]
    Iso,
    /// From above; north is up.
    Top,
    /// From below; east is right.
    Bottom,
    /// From the south, along +y.
    Front,
    /// From the north.
    Back,
    /// From the west, along +x.
    Left,
    /// From the east.
    Right,
    /// From a point of the compass and an angle above the horizon, both in radians. Azimuth is counted from north to east.
    From {
        /// Where the camera stands, seen from the scene.
        azimuth: f64,
        /// Above the horizon.
        elevation: f64,
    },
    /// From one position to another, both in world coordinates. The scene is not fitted into the picture.
    Placed {
        /// Of the camera.
        eye: [f64; 3],
        /// What is in the middle.
        target: [f64; 3],
    },
}

/// How depth is shown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// What is farther is smaller.
    Perspective {
        /// Angle between the lower and the upper side of the picture, in radians.
        field_of_view: f64,
    },
    /// All in one scale.
    Parallel,
}

impl Default for Projection {
    /// An angle of 30 degrees.
    fn default() -> Self {
        Self::Perspective { field_of_view: 30_f64.to_radians() }
    }
}

/// The scene takes so much of the picture.
const FILLED: f64 = 0.94;
/// Positions nearer to the camera than this share of the diagonal are not seen.
const NEAREST_REL: f64 = 1e-4;
/// The smallest diagonal, as a share of the largest coordinate.
const SMALLEST_REL: f64 = 1e-6;
/// How far a lifted layer comes nearer, as a share of the diagonal.
const LIFT_REL: f64 = 0.002;
/// Positions by which a scene is fitted into the picture, at most, from each layer.
const FITTED: usize = 200_000;

/// Where positions come to lie on the picture.
#[derive(Debug, Clone)]
pub(super) struct Camera {
    eye: Vec3,
    /// To the right, up, and into the picture.
    axes: [Vec3; 3],
    /// Samples for a unit at distance 1, or, in parallel, anywhere.
    focal: f64,
    /// Where the middle is, in samples.
    middle: [f64; 2],
    is_parallel: bool,
    nearest: f64,
    /// How much nearer a lifted layer is: in parallel a length, else a share of its nearness.
    lift: f64,
    /// The scale of depths.
    pub(super) reach: f64,
    /// To the sky, right and up on the picture and out of it.
    pub(super) sky: [f32; 3],
}

/// A position on the picture in homogeneous coordinates, in samples: x w, y w, w; and how near it is times w. Nearness is one over the depth, or in
/// parallel the depth with its sign changed: what is linear on the picture.
pub(super) type Placed = [f32; 4];

impl Camera {
    /// `free` is what of the picture, in pixels from its left upper corner, shows the scene.
    pub(super) fn new(scene: &Scene, view: &View, free: [u32; 2]) -> Result<Self, RenderError> {
        if !(view.zoom.is_finite() && view.zoom > 0.0) {
            return Err(RenderError::Zoom(view.zoom));
        }
        let (is_parallel, tangent) = match view.projection {
            Projection::Parallel => (true, 0.0),
            Projection::Perspective { field_of_view: angle } if angle > 0.0 && angle.to_degrees() < 170.0 => {
                (false, (0.5 * angle).tan())
            }
            Projection::Perspective { field_of_view } => {
                return Err(RenderError::FieldOfView(field_of_view.to_degrees()));
            }
        };
        let [low, high] = scene.bounds().ok_or(RenderError::Empty)?;
        // A scene of one point has a size, too, which its coordinates can resolve.
        let farthest = low.into_iter().chain(high).fold(1.0, |most: f64, c| most.max(c.abs()));
        let diagonal = vector::norm(vector::sub(high, low)).max(SMALLEST_REL * farthest);
        let samples = f64::from(view.antialias);
        let half = free.map(|side| 0.5 * samples * f64::from(side));
        let mut camera = Self {
            eye: vector::scale(vector::add(low, high), 0.5),
            axes: axes(view)?,
            focal: 1.0,
            middle: half,
            is_parallel,
            nearest: NEAREST_REL * diagonal,
            lift: LIFT_REL * diagonal,
            reach: 2.0 * diagonal,
            sky: [0.0; 3],
        };
        let sky = view.up.restore([0.0, 0.0, 1.0]);
        camera.sky = camera.axes.map(|axis| vector::dot(axis, sky) as f32);
        camera.sky[2] = -camera.sky[2];
        match view.direction {
            Direction::Placed { eye, target } => {
                camera.eye = eye;
                // In parallel, what lies as far as the target has the size that it has under the usual angle.
                let angle = 0.5 * 30_f64.to_radians();
                let seen = if is_parallel { vector::norm(vector::sub(target, eye)) * angle.tan() } else { tangent };
                camera.focal = view.zoom * half[1] / seen;
                camera.lift_at(vector::norm(vector::sub(target, eye)));
            }
            _ => {
                let away = camera.fit(scene, view, half, tangent);
                camera.lift_at(away);
            }
        }
        Ok(camera)
    }

    /// Makes the lift a share of nearness, such that at a distance it is the length that it was.
    fn lift_at(&mut self, away: f64) {
        if !self.is_parallel {
            self.lift /= away;
        }
    }

    /// Steps back and aside until all is in the picture. Returns how far.
    fn fit(&mut self, scene: &Scene, view: &View, half: [f64; 2], tangent: f64) -> f64 {
        let [right, up, into] = self.axes;
        // For each side of the picture the farthest position beyond it: depth is counted from the middle to the camera.
        let mut most = [f64::NEG_INFINITY; 5];
        let slopes =
            if self.is_parallel { [1.0; 2] } else { [tangent * half[0] / half[1], tangent] }.map(|s| FILLED * s);
        for layer in &scene.layers {
            let step = layer.positions.len().div_ceil(FITTED).max(1);
            for &p in layer.positions.iter().step_by(step).filter(|p| p.iter().all(|c| c.is_finite())) {
                let q = vector::sub(vector::add(p, layer.world_from_local), self.eye);
                let near = -vector::dot(into, q);
                let depth = if self.is_parallel { 0.0 } else { near };
                let [x, y] = [vector::dot(right, q) / slopes[0], vector::dot(up, q) / slopes[1]];
                let reached = [depth + x, depth - x, depth + y, depth - y, near];
                most = std::array::from_fn(|i| most[i].max(reached[i]));
            }
        }
        let aside = [slopes[0] * 0.5 * (most[0] - most[1]), slopes[1] * 0.5 * (most[2] - most[3])];
        let needed = [0.5 * (most[0] + most[1]), 0.5 * (most[2] + most[3])];
        self.eye = vector::add(self.eye, vector::add(vector::scale(right, aside[0]), vector::scale(up, aside[1])));
        let least = 0.001 * self.reach;
        let away = if self.is_parallel {
            let [x, y] = [0, 1].map(|a| (slopes[a] * needed[a]).max(0.5 * least));
            self.focal = FILLED * (half[0] / x).min(half[1] / y);
            self.reach
        } else {
            self.focal = half[1] / tangent;
            needed[0].max(needed[1]).max(most[4] + least)
        };
        self.focal *= view.zoom;
        self.eye = vector::sub(self.eye, vector::scale(into, away));
        away
    }

    /// Right, up and out of the picture, of a vector.
    pub(super) fn turned(&self, v: Vec3) -> [f32; 3] {
        let [right, up, into] = self.axes.map(|axis| vector::dot(axis, v) as f32);
        [right, up, -into]
    }

    /// Where the positions of a layer come to lie.
    pub(super) fn place(&self, layer: &Layer, p: Vec3) -> Placed {
        // The difference of offsets first: it is exact where both are large.
        let from_eye = vector::add(p, vector::sub(layer.world_from_local, self.eye));
        let [x, y, depth] = self.axes.map(|axis| vector::dot(axis, from_eye));
        let lift = if layer.lifted { self.lift } else { 0.0 };
        let (w, near) = if self.is_parallel { (1.0, lift - depth) } else { (depth, 1.0 + lift) };
        [self.middle[0] * w + self.focal * x, self.middle[1] * w - self.focal * y, w, near].map(|c| c as f32)
    }

    /// Whether something so deep is seen at all.
    pub(super) fn is_before(&self, w: f32) -> bool {
        self.is_parallel || f64::from(w) > self.nearest
    }

    /// Nearness of what cannot be seen any more.
    pub(super) fn farthest(&self) -> f32 {
        if self.is_parallel { f32::NEG_INFINITY } else { 0.0 }
    }

    /// Nearness of what is too near.
    pub(super) fn nearest(&self) -> f32 {
        if self.is_parallel { f32::INFINITY } else { (1.0 / self.nearest) as f32 }
    }

    /// The logarithm, to the base of 2, of the depth of what is so near. In parallel, depth as a share of the reach, which varies alike.
    pub(super) fn log_depth(&self, nearness: f32) -> f32 {
        if self.is_parallel { -nearness / (self.reach * std::f64::consts::LN_2) as f32 } else { -nearness.log2() }
    }
}

/// Right, up and into the picture.
fn axes(view: &View) -> Result<[Vec3; 3], RenderError> {
    if let Direction::Placed { eye, target } = view.direction {
        let into = vector::normalized(vector::sub(target, eye)).ok_or(RenderError::CameraInTarget)?;
        let sky = view.up.restore([0.0, 0.0, 1.0]);
        // Straight up or down: north, as from the top.
        let north = view.up.restore([0.0, 1.0, 0.0]);
        let right = vector::normalized(vector::cross(into, sky)).filter(|_| vector::dot(into, sky).abs() < 1.0 - 1e-12);
        let right =
            right.or_else(|| vector::normalized(vector::cross(into, north))).ok_or(RenderError::CameraInTarget)?;
        return Ok([right, vector::cross(right, into), into]);
    }
    let quarter = std::f64::consts::FRAC_PI_2;
    let (azimuth, elevation) = match view.direction {
        Direction::Iso => (2.5 * quarter, 0.5_f64.sqrt().atan()),
        Direction::Top => (2.0 * quarter, quarter),
        Direction::Bottom => (2.0 * quarter, -quarter),
        Direction::Back => (0.0, 0.0),
        Direction::Left => (3.0 * quarter, 0.0),
        Direction::Right => (quarter, 0.0),
        Direction::From { azimuth, elevation } => (azimuth, elevation),
        Direction::Front | Direction::Placed { .. } => (2.0 * quarter, 0.0),
    };
    let (east, north) = azimuth.sin_cos();
    let (rise, level) = elevation.sin_cos();
    let to_camera = [east * level, north * level, rise];
    let up = [-east * rise, -north * rise, level];
    let turn = |v: Vec3| view.up.restore(v);
    let (into, up) = (vector::scale(turn(to_camera), -1.0), turn(up));
    Ok([vector::cross(into, up), up, into])
}
