//! The tetrahedra that hold the vertices.

use crate::vec3::{self, Vec3};

/// Crossings are kept this far from the ends of their edges, in parts of an edge, so that vertices of different tetrahedra never
/// coincide where F vanishes at a node. A hundredth of a cell is far below noise, and far above the rounding of
/// f32 formats.
const END: f64 = 0.01;

/// An active tetrahedron: F has both signs on its corners.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cell {
    /// Positions of the corners.
    pub(super) corners: [Vec3; 4],
    /// F at the corners.
    pub(super) values: [f64; 4],
}

impl Cell {
    /// The places where F vanishes on the edges, three or four, and their number.
    pub(super) fn crossings(&self) -> ([Vec3; 4], usize) {
        let (mut crossings, mut count) = ([[0.0; 3]; 4], 0);
        for i in 0..4 {
            for j in i + 1..4 {
                let (f, g) = (self.values[i], self.values[j]);
                if (f < 0.0) == (g < 0.0) {
                    continue;
                }
                let s = (f / (f - g)).clamp(END, 1.0 - END);
                for (a, c) in crossings[count].iter_mut().enumerate() {
                    *c = (1.0 - s) * self.corners[i][a] + s * self.corners[j][a];
                }
                count += 1;
            }
        }
        (crossings, count)
    }

    /// The mean of the places where F vanishes on the edges.
    pub(super) fn mean_of_crossings(&self) -> Vec3 {
        let (crossings, count) = self.crossings();
        let sum = crossings[..count].iter().fold([0.0; 3], |sum, &c| vec3::add(sum, c));
        sum.map(|s| s / count as f64)
    }

    /// The length of the longest edge.
    pub(super) fn longest_edge(&self) -> f64 {
        let edges = (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j)));
        edges.map(|(i, j)| vec3::distance(self.corners[i], self.corners[j])).fold(0.0, f64::max)
    }
}

/// The tetrahedra that hold the vertices of a mesh, one each.
pub(super) trait Cells: Sync {
    /// The tetrahedron of a vertex.
    fn cell(&self, vertex: usize) -> Cell;
}
