//! Sums over points from which planes of least squares follow.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use crate::vec3::{self, Vec3};

/// The number of points, their sum and the sum of their products.
///
/// Positions should be near the origin against the accuracy wanted: variances lose 2 log10(|position| / deviation) of 16 digits.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Moments {
    pub(super) count: f64,
    sum: Vec3,
    /// xx, xy, xz, yy, yz, zz.
    products: [f64; 6],
}

/// A plane with the spread of the points that it was fitted to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Fit {
    /// Unit normal; either of the two.
    pub(super) normal: Vec3,
    /// `normal . x` on the plane.
    pub(super) offset: f64,
    /// Mean of the points.
    pub(super) centre: Vec3,
    /// Standard deviations across the plane, and along its shorter and longer axis.
    pub(super) deviations: [f64; 3],
}

impl Moments {
    #[inline]
    pub(super) fn add(&mut self, p: Vec3) {
        self.add_weighted(p, 1.0);
    }

    #[inline]
    pub(super) fn add_weighted(&mut self, p: Vec3, weight: f64) {
        let q = vec3::scale(p, weight);
        self.count += weight;
        self.sum = vec3::add(self.sum, q);
        let products = [q[0] * p[0], q[0] * p[1], q[0] * p[2], q[1] * p[1], q[1] * p[2], q[2] * p[2]];
        for (sum, product) in self.products.iter_mut().zip(products) {
            *sum += product;
        }
    }

    pub(super) fn merge(&mut self, other: &Self) {
        self.count += other.count;
        self.sum = vec3::add(self.sum, other.sum);
        for (sum, product) in self.products.iter_mut().zip(other.products) {
            *sum += product;
        }
    }

    pub(super) fn centre(&self) -> Vec3 {
        vec3::scale(self.sum, 1.0 / self.count)
    }

    /// The plane of total least squares; `None` for fewer than three points, or sums that are not finite.
    pub(super) fn fit(&self) -> Option<Fit> {
        if self.count < 3.0 {
            return None;
        }
        let c = self.centre();
        let covariance = self.covariance();
        if !covariance.iter().all(|v| v.is_finite()) {
            return None;
        }
        let SymmetricEigen { eigenvectors, eigenvalues } = covariance.symmetric_eigen();
        let mut order = [0, 1, 2];
        order.sort_by(|&a, &b| eigenvalues[a].total_cmp(&eigenvalues[b]));
        let n: Vector3<f64> = eigenvectors.column(order[0]).into_owned();
        let normal = vec3::normalized(n.into())?;
        let deviations = order.map(|a| eigenvalues[a].max(0.0).sqrt());
        Some(Fit { normal, offset: vec3::dot(normal, c), centre: c, deviations })
    }

    fn covariance(&self) -> Matrix3<f64> {
        let c = self.centre();
        let [xx, xy, xz, yy, yz, zz] = self.products.map(|p| p / self.count);
        let (xy, xz, yz) = (xy - c[0] * c[1], xz - c[0] * c[2], yz - c[1] * c[2]);
        Matrix3::new(xx - c[0] * c[0], xy, xz, xy, yy - c[1] * c[1], yz, xz, yz, zz - c[2] * c[2])
    }

    /// The plane of total least squares among those that hold a direction; `None` as for [`fit`](Self::fit), or if the points seen along
    /// the direction are spread alike to all sides.
    pub(super) fn fit_along(&self, direction: Vec3) -> Option<Fit> {
        if self.count < 2.0 {
            return None;
        }
        let [u, v] = vec3::axes_across(direction).map(Vector3::from);
        let covariance = self.covariance();
        let (uu, uv, vv) = (u.dot(&(covariance * u)), u.dot(&(covariance * v)), v.dot(&(covariance * v)));
        let angle = 0.5 * (2.0 * uv).atan2(uu - vv);
        let normal = vec3::normalized((v * angle.cos() - u * angle.sin()).into())?;
        let (mean, half) = (0.5 * (uu + vv), (0.5 * (uu - vv)).hypot(uv));
        let along = Vector3::from(direction).dot(&(covariance * Vector3::from(direction)));
        let [shorter, longer] = [along.min(mean + half), along.max(mean + half)];
        let deviations = [(mean - half).max(0.0), shorter, longer].map(|v| v.max(0.0).sqrt());
        let centre = self.centre();
        vec3::is_finite(normal).then_some(Fit { normal, offset: vec3::dot(normal, centre), centre, deviations })
    }

    /// Sum of the squared distances from a plane.
    pub(super) fn squares_off(&self, normal: Vec3, offset: f64) -> f64 {
        let [a, b, c] = normal;
        let [xx, xy, xz, yy, yz, zz] = self.products;
        let quadratic = a * a * xx + b * b * yy + c * c * zz + 2.0 * (a * b * xy + a * c * xz + b * c * yz);
        (quadratic - 2.0 * offset * vec3::dot(normal, self.sum) + offset * offset * self.count).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A lattice on the plane through a position, with a wave of the given height across it.
    fn plane(normal: Vec3, through: Vec3, height: f64) -> Moments {
        let [u, v] = vec3::axes_across(normal);
        let mut moments = Moments::default();
        for i in 0..20 {
            for j in 0..10 {
                let off = height * f64::from((i + j) % 2 * 2 - 1);
                let p = vec3::add_scaled(vec3::add_scaled(through, u, f64::from(i)), v, f64::from(j));
                moments.add(vec3::add_scaled(p, normal, off));
            }
        }
        moments
    }

    #[test]
    fn a_plane_is_found_with_its_deviations() {
        let normal = vec3::normalized([1.0, 2.0, -0.5]).expect("a direction");
        let fit = plane(normal, [100.0, -50.0, 7.0], 0.01).fit().expect("200 points");
        assert!(vec3::norm(vec3::cross(fit.normal, normal)) < 1e-4);
        assert!((fit.deviations[0] - 0.01).abs() < 1e-4, "{:?}", fit.deviations);
        // Uniform on 0..n in steps of 1: variance (n^2 - 1) / 12.
        assert!((fit.deviations[1] - (99.0_f64 / 12.0).sqrt()).abs() < 1e-3);
        assert!((fit.deviations[2] - (399.0_f64 / 12.0).sqrt()).abs() < 1e-3);
        let mut few = Moments::default();
        few.add([1.0; 3]);
        few.add([2.0; 3]);
        assert_eq!(few.fit(), None);
    }

    #[test]
    fn a_plane_that_must_be_upright_is() {
        let leaning = vec3::normalized([1.0, 0.3, 0.1]).expect("a direction");
        let moments = plane(leaning, [3.0, 4.0, 5.0], 0.01);
        let fit = moments.fit_along([0.0, 0.0, 1.0]).expect("200 points");
        assert!(fit.normal[2].abs() < 1e-12 && (fit.normal[0].abs() - 0.958).abs() < 0.02, "{:?}", fit.normal);
        // The free plane leaves less.
        let free = moments.fit().expect("200 points");
        assert!(moments.squares_off(fit.normal, fit.offset) > 2.0 * moments.squares_off(free.normal, free.offset));
        assert!((moments.squares_off(free.normal, free.offset) / 200.0 - 1e-4).abs() < 1e-5);
    }
}
