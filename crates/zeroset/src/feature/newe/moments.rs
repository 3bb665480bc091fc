//! Weighted Gram matrices and the flats of least squares that follow from them.

use nalgebra::DMatrix;

use super::eigen;
use super::{Flat, Normalization};

/// Sums of w, w x and w x x' over points: all that a flat of least squares needs.
///
/// Points are near the origin and of size 1 wherever accuracy matters, so that the mean can be taken off the squares afterwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moments<const D: usize> {
    weight: f64,
    first: [f64; D],
    /// The upper triangle.
    second: [[f64; D]; D],
}

impl<const D: usize> Moments<D> {
    pub(super) const ZERO: Self = Self { weight: 0.0, first: [0.0; D], second: [[0.0; D]; D] };

    #[inline]
    pub(super) fn add(&mut self, point: &[f64; D], weight: f64) {
        self.weight += weight;
        for a in 0..D {
            let weighted = weight * point[a];
            self.first[a] += weighted;
            for (sum, component) in self.second[a][a..].iter_mut().zip(&point[a..]) {
                *sum += weighted * component;
            }
        }
    }

    pub(super) fn of<'a>(points: impl IntoIterator<Item = &'a [f64; D]>) -> Self {
        points.into_iter().fold(Self::ZERO, |mut sums, point| {
            sums.add(point, 1.0);
            sums
        })
    }

    pub(super) fn weight(&self) -> f64 {
        self.weight
    }

    /// The flat of least weighted squares. `None` without weight, or if the homogeneous minimum is the flat at infinity.
    pub(super) fn flat(&self, normalization: Normalization) -> Option<Flat<D>> {
        match normalization {
            Normalization::Affine => self.affine().map(|(flat, _)| flat),
            Normalization::Homogeneous => self.homogeneous(),
        }
    }

    /// The flat through the mean, and the weighted mean of the squared distances from it.
    pub(super) fn affine(&self) -> Option<(Flat<D>, f64)> {
        if !(self.weight > 0.0 && self.weight.is_finite()) {
            return None;
        }
        let mean = self.first.map(|c| c / self.weight);
        let mut matrix = [[0.0; D]; D];
        for a in 0..D {
            for b in a..D {
                matrix[a][b] = self.second[a][b] / self.weight - mean[a] * mean[b];
                matrix[b][a] = matrix[a][b];
            }
        }
        let mut axes = [[0.0; D]; D];
        eigen::diagonalize(matrix.as_flattened_mut(), axes.as_flattened_mut(), D);
        let least = eigen::smallest(matrix.as_flattened(), D);
        Flat::through(mean, axes[least]).map(|flat| (flat, matrix[least][least].max(0.0)))
    }

    /// The smallest eigenvector over all D + 1 coefficients.
    fn homogeneous(&self) -> Option<Flat<D>> {
        let n = D + 1;
        let entry = |a: usize, b: usize| match (a.min(b), a.max(b)) {
            (low, high) if high < D => self.second[low][high],
            (low, _) if low < D => self.first[low],
            _ => self.weight,
        };
        let gram = DMatrix::from_fn(n, n, entry);
        if !gram.iter().all(|v| v.is_finite()) || self.weight <= 0.0 {
            return None;
        }
        let spectrum = gram.symmetric_eigen();
        let coefficients = spectrum.eigenvectors.column(spectrum.eigenvalues.imin());
        let normal: [f64; D] = std::array::from_fn(|a| coefficients[a]);
        let squared = super::flat::dot(&normal, &normal);
        if squared < f64::MIN_POSITIVE {
            return None;
        }
        // The point of the flat that is nearest to the origin.
        Flat::through(normal.map(|c| -c * coefficients[D] / squared), normal)
    }
}
