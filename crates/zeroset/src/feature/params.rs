//! What to look for, what was done, and what can be wrong.

use serde::{Deserialize, Serialize};

use crate::fit::cascade::Scene;
use crate::monitor::Cancelled;
use crate::reconstruct::{ReconstructError, Up};

/// What to look for. Every `None` is resolved from the measured noise and spacing of the points.
#[derive(Debug, Clone, PartialEq)]
pub struct FeatureParams {
    /// The scene; `None` decides from the shape of the cloud.
    pub scene: Option<Scene>,
    /// Which way is up.
    pub up: Up,
    /// The smallest area of a plane, in square units of the cloud.
    pub min_area: Option<f64>,
    /// The farthest that a point lies from its plane, in units of the cloud.
    pub max_distance: Option<f64>,
    /// The largest angle, in radians, between a plane and the surface around its points.
    pub max_angle: Option<f64>,
    /// The angle, in radians, by which the surface turns at an edge, at least.
    pub sharp_angle: f64,
    /// Whether walls are taken for upright and flats for level.
    pub posture: Posture,
    /// Memory to use at most, in bytes.
    pub memory: u64,
}

impl FeatureParams {
    /// Whether the parameters make sense.
    pub(super) fn check(&self) -> Result<(), FeatureError> {
        let sizes = [("minimum area", self.min_area), ("maximum distance", self.max_distance)];
        for (name, value) in sizes.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            if !(value > 0.0 && value.is_finite()) {
                return Err(FeatureError::Parameter { name, value, remedy: "a positive number" });
            }
        }
        let angles = [("maximum angle", self.max_angle), ("sharp angle", Some(self.sharp_angle))];
        for (name, value) in angles.into_iter().filter_map(|(name, value)| Some((name, value?))) {
            if !(value > 0.0 && value < std::f64::consts::FRAC_PI_2) {
                let value = value.to_degrees();
                return Err(FeatureError::Parameter { name, value, remedy: "an angle between 0 and 90 degrees" });
            }
        }
        Ok(())
    }
}

impl Default for FeatureParams {
    fn default() -> Self {
        Self {
            scene: None,
            up: Up::Z,
            min_area: None,
            max_distance: None,
            max_angle: None,
            sharp_angle: crate::mesh::SHARP_ANGLE,
            posture: Posture::default(),
            memory: 4 << 30,
        }
    }
}

/// Whether a plane that is nearly upright, or nearly level, is taken to be so.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Posture {
    /// In terrain and airborne scenes, unless the points of the plane contradict: a small wall of a building is then known far better than
    /// from its own points.
    #[default]
    Upright,
    /// Never: every plane is the one of least squares.
    Free,
}

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FeatureSeconds {
    /// Spacing, noise, scene, and the fit of F that tells inside from outside.
    pub fit: f64,
    /// Neighbours of all points and the planes through them.
    pub neighbours: f64,
    /// Planes.
    pub planes: f64,
    /// Edges and corners.
    pub edges: f64,
    /// Polygons.
    pub polygons: f64,
    /// From the first to the last.
    pub total: f64,
}

/// What detection did. Lengths are in the unit of the cloud, angles in degrees.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FeatureReport {
    /// Points of the cloud.
    pub points: usize,
    /// Spacing of the points.
    pub spacing: f64,
    /// Measured noise of the points.
    pub noise: f64,
    /// The scene.
    pub scene: Scene,
    /// Why this scene.
    pub scene_reason: String,
    /// Smallest area of a plane.
    pub min_area: f64,
    /// Farthest that a point lies from its plane.
    pub max_distance: f64,
    /// Largest angle between a plane and the surface around its points, in degrees.
    pub max_angle_deg: f64,
    /// Angle by which the surface turns at an edge, at least, in degrees.
    pub sharp_angle_deg: f64,
    /// Points on planes.
    pub points_on_planes: usize,
    /// Sum of the planes' areas.
    pub plane_area: f64,
    /// Root of the mean square distance of points from their planes; `None` without any.
    pub plane_rms: Option<f64>,
    /// Sum of the edges' lengths.
    pub edge_length: f64,
    /// Wall seconds.
    pub seconds: FeatureSeconds,
}

/// Features that could not be looked for. Each message names the remedy.
#[derive(Debug, thiserror::Error)]
pub enum FeatureError {
    /// The points bear no surface.
    #[error(transparent)]
    Surface(#[from] ReconstructError),
    /// A parameter that is not possible.
    #[error("a {name} of {value} is not possible; give {remedy}")]
    Parameter {
        /// What it is.
        name: &'static str,
        /// The value.
        value: f64,
        /// What to give.
        remedy: &'static str,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}
