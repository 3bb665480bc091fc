//! The places that a vertex may take in its tetrahedron: lattice points of a few generators.

use super::Candidates;
use crate::contour::cells::Cell;
use crate::vec3::{self, Vec3};

/// Whole-number weights of the generators; all that are used are positive. Divided by their sum they are barycentric coordinates.
pub(super) type Weights = [u32; 4];

/// The means of three or four generators with positive weights.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chart {
    generators: [Vec3; 4],
    pub(super) count: usize,
}

impl Chart {
    /// The chart of a tetrahedron.
    pub(super) fn new(cell: &Cell, candidates: Candidates) -> Self {
        match candidates {
            Candidates::Tetrahedron => Self { generators: cell.corners, count: 4 },
            Candidates::ZeroSet => {
                let (generators, count) = cell.crossings();
                Self { generators, count }
            }
        }
    }

    /// The place with these weights, whose sum is `whole`.
    pub(super) fn place(&self, weights: Weights, whole: u32) -> Vec3 {
        let mut place = [0.0; 3];
        for (generator, weight) in self.generators.iter().zip(weights).take(self.count) {
            place = vec3::add_scaled(place, *generator, f64::from(weight));
        }
        place.map(|c| c / f64::from(whole))
    }

    /// The neighbours of a lattice point, twelve or six, that have all weights at least `least`.
    pub(super) fn neighbors(&self, weights: Weights, least: u32) -> impl Iterator<Item = Weights> {
        let count = self.count;
        let pairs = (0..count).flat_map(move |i| (0..count).map(move |j| (i, j)));
        pairs.filter(move |&(i, j)| i != j && weights[j] > least).map(move |(i, j)| {
            let mut neighbor = weights;
            neighbor[i] += 1;
            neighbor[j] -= 1;
            neighbor
        })
    }
}

/// All weights of `count` generators whose sum is `whole`.
pub(super) fn lattice_points(count: usize, whole: u32) -> Vec<Weights> {
    let mut all = Vec::new();
    for a in 1..whole {
        for b in 1..whole - a {
            if count == 3 {
                all.push([a, b, whole - a - b, 0]);
            } else {
                all.extend((1..whole - a - b).map(|c| [a, b, c, whole - a - b - c]));
            }
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lattice_points_are_counted_by_binomials() {
        for n in 5..10_u32 {
            let triangle = lattice_points(3, n);
            let tetrahedron = lattice_points(4, n);
            assert_eq!(triangle.len() as u32, (n - 1) * (n - 2) / 2);
            assert_eq!(tetrahedron.len() as u32, (n - 1) * (n - 2) * (n - 3) / 6);
            assert!(triangle.iter().all(|w| w.iter().sum::<u32>() == n && w[..3].iter().all(|&w| w > 0)));
            assert!(tetrahedron.iter().all(|w| w.iter().sum::<u32>() == n && w.iter().all(|&w| w > 0)));
        }
    }

    #[test]
    fn neighbors_stay_on_the_lattice_and_above_the_least_weight() {
        let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let cell = Cell { corners, values: [-1.0, 1.0, 1.0, 1.0] };
        let chart = Chart::new(&cell, Candidates::Tetrahedron);
        assert_eq!(chart.neighbors([2, 2, 2, 3], 1).count(), 12);
        assert_eq!(chart.neighbors([6, 1, 1, 1], 1).count(), 3);
        assert!(chart.neighbors([4, 2, 2, 1], 1).all(|w| w.iter().sum::<u32>() == 9 && w.iter().all(|&w| w > 0)));
        assert_eq!(chart.place([1, 1, 1, 1], 4), [0.25; 3]);
        let chart = Chart::new(&cell, Candidates::ZeroSet);
        assert_eq!((chart.count, chart.neighbors([3, 3, 3, 0], 1).count()), (3, 6));
        assert_eq!(chart.place([1, 1, 1, 0], 3), [0.5 / 3.0; 3]);
    }
}
