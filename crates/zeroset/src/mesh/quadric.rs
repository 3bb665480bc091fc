//! Sums of squared distances from planes.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::vec3::{self, Vec3};

/// Directions whose share in the sum is below this, relative to the strongest, are left undecided.
///
/// A crease of angle a between equal areas has the share tan^2(a / 2): 0.001 is 3.6 degrees. Planes that are flat but for noise have
/// the square of their triangles' tilts, which decides nothing. A tenth of it lets noise of a hundredth of an edge push
/// vertices along their plane.
const LEAST_SHARE: f64 = 1e-3;

/// The weighted sum of the squared distances of a position from planes, as a polynomial around a centre.
///
/// The value at `centre + d` is `value + 2 gradient . d + d . matrix d`. Planes that pass through the centre leave gradient and
/// value exactly zero, so nothing is lost to cancellation where a surface is flat.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Quadric {
    /// xx, xy, xz, yy, yz, zz.
    matrix: [f64; 6],
    gradient: Vec3,
    value: f64,
    /// Sum of the weights of planes that bear an area.
    pub(super) area: f64,
}

impl Quadric {
    /// Adds a plane, given its unit normal and the height of the centre over it.
    pub(super) fn add_plane(&mut self, n: Vec3, height: f64, weight: f64) {
        self.gradient = vec3::add_scaled(self.gradient, n, weight * height);
        self.value += weight * height * height;
        let products = [n[0] * n[0], n[0] * n[1], n[0] * n[2], n[1] * n[1], n[1] * n[2], n[2] * n[2]];
        for (sum, product) in self.matrix.iter_mut().zip(products) {
            *sum += weight * product;
        }
    }

    fn times(&self, d: Vec3) -> Vec3 {
        let [xx, xy, xz, yy, yz, zz] = self.matrix;
        [xx * d[0] + xy * d[1] + xz * d[2], xy * d[0] + yy * d[1] + yz * d[2], xz * d[0] + yz * d[1] + zz * d[2]]
    }

    /// The value at a distance from the centre; rounding never makes it negative.
    pub(super) fn at(&self, d: Vec3) -> f64 {
        let linear = vec3::add_scaled(vec3::scale(self.gradient, 2.0), self.times(d), 1.0);
        (self.value + vec3::dot(linear, d)).max(0.0)
    }

    /// The same sum around another centre.
    pub(super) fn around(&self, shift: Vec3) -> Self {
        Self { gradient: vec3::add(self.gradient, self.times(shift)), value: self.at(shift), ..*self }
    }

    /// The sum of two around one centre.
    pub(super) fn plus(&self, other: &Self) -> Self {
        Self {
            matrix: std::array::from_fn(|i| self.matrix[i] + other.matrix[i]),
            gradient: vec3::add(self.gradient, other.gradient),
            value: self.value + other.value,
            area: self.area + other.area,
        }
    }

    /// Where the sum is least; where that leaves a choice, the place nearest to the centre. Relative to the centre.
    ///
    /// In a plane it is the foot on the plane, on a crease the foot on the crease, at a corner the corner.
    pub(super) fn least(&self) -> Vec3 {
        // The decomposition of what is not finite may never end.
        if !self.matrix.iter().chain(&self.gradient).all(|x| x.is_finite()) {
            return [0.0; 3];
        }
        let [xx, xy, xz, yy, yz, zz] = self.matrix;
        let matrix = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        let SymmetricEigen { eigenvectors, eigenvalues } = matrix.symmetric_eigen();
        let gradient = Vector3::from(self.gradient);
        let floor = LEAST_SHARE * eigenvalues.amax();
        let mut step = Vector3::zeros();
        for (axis, &value) in eigenvectors.column_iter().zip(&eigenvalues) {
            if value > floor {
                step -= axis * (axis.dot(&gradient) / value);
            }
        }
        step.into()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_place_lies_on_planes_creases_and_corners() {
        let third = 1.0 / 3.0_f64.sqrt();
        let normals = [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [third, third, third]];
        for planes in 1..=3 {
            // Planes through the corner, seen from elsewhere.
            let mut quadric = Quadric::default();
            for normal in &normals[..planes] {
                quadric.add_plane(*normal, 0.0, 2.0);
            }
            let seen = quadric.around([-0.5, 0.25, 0.125]);
            let place = seen.least();
            assert!(seen.at(place) < 1e-30, "{planes}");
            let from_corner = vec3::add(place, [-0.5, 0.25, 0.125]);
            for normal in &normals[..planes] {
                // A few roundings of numbers below one.
                assert!(vec3::dot(*normal, from_corner).abs() < 1e-15, "{planes}");
            }
        }
    }

    #[test]
    fn the_value_is_the_weighted_square_of_the_distance() {
        let mut quadric = Quadric::default();
        quadric.add_plane([0.0, 0.6, 0.8], 0.25, 3.0);
        let moved = quadric.around([1.0, 2.0, 0.5]);
        let expected = 3.0 * (0.6 * 2.0 + 0.8 * 0.5 + 0.25_f64).powi(2);
        assert!((quadric.at([1.0, 2.0, 0.5]) - expected).abs() < 1e-14);
        assert!(
            (moved.at([0.0; 3]) - expected).abs() < 1e-14 && (moved.at([-1.0, -2.0, -0.5]) - 3.0 / 16.0).abs() < 1e-14
        );
    }
}
