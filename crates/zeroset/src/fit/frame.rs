//! Which way is up, and the frame in which F is fitted.

use nalgebra::{Matrix3, Rotation3, Unit, Vector3};
use serde::{Deserialize, Serialize};

use super::cascade::Scene;
use crate::field::Placement;

/// The axis of the file that points to the sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Up {
    /// +x.
    X,
    /// +y: usual in graphics.
    Y,
    /// +z: usual in surveying.
    #[default]
    Z,
    /// -x.
    MinusX,
    /// -y.
    MinusY,
    /// -z.
    MinusZ,
}

impl Up {
    /// For each axis of the upright frame the axis of the file and its sign; a rotation, not a mirror image.
    fn axes(self) -> [(usize, f64); 3] {
        match self {
            Self::Z => [(0, 1.0), (1, 1.0), (2, 1.0)],
            Self::X => [(1, 1.0), (2, 1.0), (0, 1.0)],
            Self::Y => [(2, 1.0), (0, 1.0), (1, 1.0)],
            Self::MinusZ => [(1, 1.0), (0, 1.0), (2, -1.0)],
            Self::MinusX => [(2, 1.0), (1, 1.0), (0, -1.0)],
            Self::MinusY => [(0, 1.0), (2, 1.0), (1, -1.0)],
        }
    }

    /// A position of the file in the upright frame.
    #[must_use]
    pub fn upright(self, p: [f64; 3]) -> [f64; 3] {
        self.axes().map(|(axis, sign)| sign * p[axis])
    }

    /// A position of the upright frame in the file's.
    #[must_use]
    pub fn restore(self, p: [f64; 3]) -> [f64; 3] {
        let mut back = [0.0; 3];
        for (value, (axis, sign)) in p.into_iter().zip(self.axes()) {
            back[axis] = sign * value;
        }
        back
    }
}

/// The frame in which F is fitted: the file's frame, rotated.
///
/// Ground keeps its upright axis, which the seed and the column prior need. A body is turned away from all axes: faces along
/// planes of the lattice are a special case, and machined parts mostly come with such faces. On them the element's gradient
/// lets F crumple, and thin walls cannot be told from solid faces. The share of samples with a second sheet near, measured:
/// along the axes 0.24 on a solid l-block and 0.10 on a plate with walls of one cell; turned 0.02 and 0.77.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame(Matrix3<f64>);

/// The turn of bodies: about this axis, by this angle in degrees.
const TURN: ([f64; 3], f64) = ([1.0, 2.0, 3.0], 25.0);

impl Frame {
    pub(crate) fn new(up: Up, scene: Scene) -> Self {
        let upright =
            Matrix3::from_columns(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| up.upright(e).into()));
        Self(match scene {
            Scene::Terrain | Scene::Airborne => upright,
            Scene::Object | Scene::Free => {
                let axis = Unit::new_normalize(Vector3::from(TURN.0));
                Rotation3::from_axis_angle(&axis, TURN.1.to_radians()).matrix() * upright
            }
        })
    }

    /// The frame with the rows of a rotation; `None` if they are none.
    pub(crate) fn from_rows(rows: [[f64; 3]; 3]) -> Option<Self> {
        Placement::new(rows, 1.0, [0.0; 3]).ok()?;
        Some(Self(Matrix3::from_fn(|i, j| rows[i][j])))
    }

    /// The rows of its rotation.
    pub(crate) fn rows(&self) -> [[f64; 3]; 3] {
        std::array::from_fn(|i| std::array::from_fn(|j| self.0[(i, j)]))
    }

    /// A position of the file in the frame of the fit.
    pub(crate) fn enter(&self, p: [f64; 3]) -> [f64; 3] {
        (self.0 * Vector3::from(p)).into()
    }

    /// The way into the frame of the fit, from positions that have been shifted.
    pub(crate) fn entry(&self, shift: [f64; 3]) -> Placement {
        Placement::rigid(self.0, self.enter(shift.map(|c| -c)))
    }

    /// The way out of the frame of the fit, and then by a shift.
    pub(crate) fn exit(&self, shift: [f64; 3]) -> Placement {
        Placement::rigid(self.0.transpose(), shift)
    }

    /// A position of the frame of the fit in the file's.
    pub(crate) fn leave(&self, p: [f64; 3]) -> [f64; 3] {
        self.0.tr_mul(&Vector3::from(p)).into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_rotations_that_put_up_on_z() {
        let sky = [
            (Up::X, [1.0, 0.0, 0.0]),
            (Up::Y, [0.0, 1.0, 0.0]),
            (Up::Z, [0.0, 0.0, 1.0]),
            (Up::MinusX, [-1.0, 0.0, 0.0]),
            (Up::MinusY, [0.0, -1.0, 0.0]),
            (Up::MinusZ, [0.0, 0.0, -1.0]),
        ];
        for (up, direction) in sky {
            assert_eq!(up.upright(direction), [0.0, 0.0, 1.0], "{up:?}");
            assert_eq!(up.restore(up.upright([1.0, 2.0, 3.0])), [1.0, 2.0, 3.0], "{up:?}");
            let m: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| up.upright(e));
            let determinant = crate::vec3::dot(m[0], crate::vec3::cross(m[1], m[2]));
            assert_eq!(determinant, 1.0, "{up:?}");
            let p = [1.0, 2.0, 3.0];
            assert_eq!(Frame::new(up, Scene::Airborne).enter(p), up.upright(p), "{up:?}");
            assert_eq!(Frame::new(up, Scene::Terrain).leave(p), up.restore(p), "{up:?}");
            let turned = Frame::new(up, Scene::Object);
            let there = turned.enter(p);
            assert!(crate::vec3::distance(turned.leave(there), p) < 1e-14, "{up:?}");
            assert!((crate::vec3::norm(there) - crate::vec3::norm(p)).abs() < 1e-14, "{up:?}");
        }
    }
}
