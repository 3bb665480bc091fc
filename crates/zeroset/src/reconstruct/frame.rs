//! Which way is up.

use serde::Serialize;

/// The axis of the file that points to the sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize)]
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
        }
    }
}
