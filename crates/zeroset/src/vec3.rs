//! Small helpers on `[f64; 3]`, for code that needs no matrices.
//!
//! Every helper evaluates in one fixed order, so equal inputs give equal bits on every machine with IEEE arithmetic.
#![allow(dead_code, reason = "a shared toolbox: rooms take from it what they need")]

/// A position or a direction.
pub(crate) type Vec3 = [f64; 3];

/// `a + b`.
#[inline]
pub(crate) fn add(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// `a - b`.
#[inline]
pub(crate) fn sub(a: Vec3, b: Vec3) -> Vec3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// `factor * a`.
#[inline]
pub(crate) fn scale(a: Vec3, factor: f64) -> Vec3 {
    [a[0] * factor, a[1] * factor, a[2] * factor]
}

/// `a + factor * b`.
#[inline]
pub(crate) fn add_scaled(a: Vec3, b: Vec3, factor: f64) -> Vec3 {
    [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]]
}

/// `a + t (b - a)`.
#[inline]
pub(crate) fn lerp(a: Vec3, b: Vec3, t: f64) -> Vec3 {
    add_scaled(a, sub(b, a), t)
}

/// The scalar product.
#[inline]
pub(crate) fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[inline]
pub(crate) fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The squared length.
#[inline]
pub(crate) fn norm_squared(a: Vec3) -> f64 {
    dot(a, a)
}

/// The length. Overflows for components over about 1e154.
#[inline]
pub(crate) fn norm(a: Vec3) -> f64 {
    norm_squared(a).sqrt()
}

/// The squared distance between two positions.
#[inline]
pub(crate) fn distance_squared(a: Vec3, b: Vec3) -> f64 {
    norm_squared(sub(a, b))
}

/// The distance between two positions.
#[inline]
pub(crate) fn distance(a: Vec3, b: Vec3) -> f64 {
    distance_squared(a, b).sqrt()
}

/// `a` at length 1; `None` if its length is zero or not finite, so that no direction is made up.
#[inline]
pub(crate) fn normalized(a: Vec3) -> Option<Vec3> {
    let largest = a[0].abs().max(a[1].abs()).max(a[2].abs());
    if largest == 0.0 || !a.iter().all(|c| c.is_finite()) {
        return None;
    }
    // Dividing by the largest component first keeps tiny and huge vectors from under- and overflow in the square.
    let b = [a[0] / largest, a[1] / largest, a[2] / largest];
    let length = norm(b);
    Some([b[0] / length, b[1] / length, b[2] / length])
}

/// Two unit directions that make a right-handed system with a unit normal, which comes last.
pub(crate) fn axes_across(normal: Vec3) -> [Vec3; 2] {
    // The axis that the normal points along least gives the longest product.
    let least = (0..3).fold(0, |best, a| if normal[a].abs() < normal[best].abs() { a } else { best });
    let mut along = [0.0; 3];
    along[least] = 1.0;
    let across = cross(normal, along);
    let first = scale(across, 1.0 / norm(across));
    [first, cross(normal, first)]
}

/// Whether all three components are finite.
#[inline]
pub(crate) fn is_finite(a: Vec3) -> bool {
    a[0].is_finite() && a[1].is_finite() && a[2].is_finite()
}

/// The component-wise smaller of two.
#[inline]
pub(crate) fn min(a: Vec3, b: Vec3) -> Vec3 {
    [a[0].min(b[0]), a[1].min(b[1]), a[2].min(b[2])]
}

/// The component-wise larger of two.
#[inline]
pub(crate) fn max(a: Vec3, b: Vec3) -> Vec3 {
    [a[0].max(b[0]), a[1].max(b[1]), a[2].max(b[2])]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn products_follow_the_right_hand() {
        assert_eq!(cross([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_eq!(dot([1.0, 2.0, 3.0], [4.0, -5.0, 6.0]), 12.0);
        assert_eq!(lerp([0.0; 3], [2.0, 4.0, 6.0], 0.5), [1.0, 2.0, 3.0]);
    }

    #[test]
    fn a_direction_is_found_at_any_scale_or_not_at_all() {
        for size in [1e-300, 1.0, 1e300] {
            let unit = normalized([3.0 * size, 0.0, -4.0 * size]).expect("a finite vector has a direction");
            assert!((unit[0] - 0.6).abs() < 1e-15 && (unit[2] + 0.8).abs() < 1e-15);
        }
        assert_eq!(normalized([0.0; 3]), None);
        assert_eq!(normalized([f64::NAN, 0.0, 1.0]), None);
        assert_eq!(normalized([f64::INFINITY, 0.0, 1.0]), None);
    }
}
