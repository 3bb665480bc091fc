//! How a plane is turned to be looked at.

/// A plane is level if its normal is this near to the vertical: the length of the normal's horizontal part.
const LEVEL: f64 = 1e-6;

/// The directions to the right and up in a picture of the plane, of length 1 and at right angles to each other and to the
/// normal.
///
/// A level plane is a map, whichever way its normal points: x is to the right and y is up. In any other plane the first
/// direction is horizontal and the second goes up as steeply as it can, straight up if the plane is upright. It is seen
/// from the tip of the normal, so counter-clockwise there is counter-clockwise in the picture.
///
/// ```
/// assert_eq!(zeroset_io::plane_frame([0.0, 0.0, 1.0]), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
/// assert_eq!(zeroset_io::plane_frame([0.0, -1.0, 0.0]), [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]);
/// ```
#[must_use]
pub fn plane_frame(normal: [f64; 3]) -> [[f64; 3]; 2] {
    let [x, y, z] = normal;
    let horizontal = x.hypot(y);
    if horizontal.is_nan() || horizontal <= LEVEL {
        return [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    }
    let length = horizontal.hypot(z);
    // The vertical times the normal, then the normal times that. Adding zero makes a plain zero of a negative one.
    let [a, b] = [-y / horizontal + 0.0, x / horizontal + 0.0];
    let slope = z / length;
    [[a, b, 0.0], [-slope * b + 0.0, slope * a + 0.0, horizontal / length]]
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
        a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
    }

    #[test]
    fn level_planes_are_maps() {
        for normal in [[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1e-9, 0.0, 1.0], [f64::NAN; 3], [0.0; 3]] {
            assert_eq!(plane_frame(normal), [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]);
        }
    }

    proptest! {
        #[test]
        fn others_are_seen_from_the_tip(x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64) {
            prop_assume!(x.hypot(y) > 1e-3);
            let n = [x, y, z];
            let length = dot(n, n).sqrt();
            let [u, v] = plane_frame(n.map(|c| c / length));
            for (found, expected) in [(dot(u, u), 1.0), (dot(v, v), 1.0), (dot(u, v), 0.0), (dot(u, n), 0.0), (dot(v, n), 0.0)] {
                prop_assert!((found - expected).abs() < 1e-12);
            }
            let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            prop_assert!((dot(cross, n) / length - 1.0).abs() < 1e-12);
            prop_assert!(u[2] == 0.0 && v[2] > 0.0);
        }
    }
}
