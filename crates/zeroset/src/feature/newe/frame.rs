//! Points in an order and a frame of their own.

use super::{Flat, Normalization};

/// Points that no longer depend on the order in which they were given, nor, in affine mode, on where they lie and how large they are.
#[derive(Debug)]
pub(super) struct Framed<const D: usize> {
    /// The points, from the mean outwards.
    pub(super) points: Vec<[f64; D]>,
    /// For each of these, its index among the points as given.
    pub(super) given: Vec<u32>,
    centre: [f64; D],
    scale: f64,
    spread: f64,
    keyed: Vec<(f64, u32)>,
}

impl<const D: usize> Default for Framed<D> {
    fn default() -> Self {
        Self { points: Vec::new(), given: Vec::new(), centre: [0.0; D], scale: 1.0, spread: 0.0, keyed: Vec::new() }
    }
}

impl<const D: usize> Framed<D> {
    /// Takes new points. Sums run in an order by coordinates, so every bit is the same in whatever order the points came.
    pub(super) fn take(&mut self, given: &[[f64; D]], normalization: Normalization) {
        self.given.clear();
        self.given.extend(0..u32::try_from(given.len()).unwrap_or(u32::MAX));
        let by_coordinates = |a: &u32, b: &u32| {
            let (p, q) = (&given[*a as usize], &given[*b as usize]);
            p.iter().zip(q).map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
        };
        self.given.sort_unstable_by(by_coordinates);
        // The first point is taken off before the sum, so that far from the origin nothing is lost.
        let origin = self.given.first().map_or([0.0; D], |&i| given[i as usize]);
        let mut mean = [0.0; D];
        for &i in &self.given {
            for a in 0..D {
                mean[a] += given[i as usize][a] - origin[a];
            }
        }
        let mean: [f64; D] = std::array::from_fn(|a| origin[a] + mean[a] / given.len().max(1) as f64);
        // In units of the largest difference, so that squares neither overflow nor vanish.
        let differences = given.iter().flat_map(|p| (0..D).map(|a| (p[a] - mean[a]).abs()));
        let largest = Some(differences.fold(0.0, f64::max)).filter(|l| *l > 0.0).unwrap_or(1.0);
        self.keyed.clear();
        self.keyed.extend(self.given.iter().map(|&i| {
            let point = &given[i as usize];
            let squared: f64 = (0..D).map(|a| ((point[a] - mean[a]) / largest).powi(2)).sum();
            (squared, i)
        }));
        // Stable: among equal distances the order by coordinates stays.
        self.keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let squares = self.keyed.iter().map(|k| k.0).sum::<f64>() / given.len().max(1) as f64;
        self.spread = largest * squares.sqrt();
        (self.centre, self.scale) = match normalization {
            Normalization::Affine => (mean, Some(self.spread).filter(|s| *s > 0.0).unwrap_or(1.0)),
            Normalization::Homogeneous => ([0.0; D], 1.0),
        };
        self.given.clear();
        self.given.extend(self.keyed.iter().map(|k| k.1));
        self.points.clear();
        self.points.extend(self.given.iter().map(|&i| {
            let point = &given[i as usize];
            std::array::from_fn(|a| (point[a] - self.centre[a]) / self.scale)
        }));
    }

    /// Root of the mean squared distance from the mean, in the unit of the frame.
    pub(super) fn spread(&self) -> f64 {
        self.spread / self.scale
    }

    /// A length as given, in the unit of the frame.
    pub(super) fn inward(&self, length: f64) -> f64 {
        length / self.scale
    }

    /// A length in the unit of the frame, as the points were given.
    pub(super) fn outward(&self, length: f64) -> f64 {
        length * self.scale
    }

    /// The flat among the points as given.
    pub(super) fn flat_outward(&self, flat: &Flat<D>) -> Flat<D> {
        let offset = flat.offset * self.scale + super::flat::dot(&flat.normal, &self.centre);
        Flat { normal: flat.normal, offset }
    }
}
