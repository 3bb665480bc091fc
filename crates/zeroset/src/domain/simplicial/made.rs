//! Meshes that are made: regular lattices, and the square of four triangles.

use super::predicates::{LEAST, MOST};
use super::{DomainError, SimplicialMesh};
use crate::domain::TETRAHEDRA;

/// Most cells of a lattice.
const MOST_CELLS: usize = 1 << 24;

impl SimplicialMesh<2> {
    /// A rectangle cut into four triangles by its diagonals: vertices at the corners, counter-clockwise from `low`, then the
    /// middle.
    ///
    /// # Errors
    /// If `high` does not exceed `low`.
    pub fn four_triangles(low: [f64; 2], high: [f64; 2]) -> Result<Self, DomainError> {
        lattice_sides(low, high, [1, 1])?;
        let middle = std::array::from_fn(|a| low[a] + 0.5 * (high[a] - low[a]));
        let vertices = vec![low, [high[0], low[1]], high, [low[0], high[1]], middle];
        Self::from_triangles(vertices, &[[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }
}

impl<const D: usize> SimplicialMesh<D> {
    /// A regular lattice: a box cut into equal cells, each cut into Freudenthal simplices around its main diagonal (two triangles or six
    /// tetrahedra). Vertices are numbered with the first axis fastest.
    ///
    /// # Errors
    /// If `high` does not exceed `low`, or there are no cells, or more than 2^24.
    pub fn lattice(low: [f64; D], high: [f64; D], cells: [u32; D]) -> Result<Self, DomainError> {
        let sides = lattice_sides(low, high, cells)?;
        let nodes = cells.map(|c| c as usize + 1);
        let strides: [usize; D] = std::array::from_fn(|a| nodes[..a].iter().product());
        let place = |mut index: usize, sizes: [usize; D]| -> [usize; D] {
            sizes.map(|size| {
                let along = index % size;
                index /= size;
                along
            })
        };
        let vertices =
            (0..nodes.iter().product())
                .map(|v| {
                    let node = place(v, nodes);
                    // The last node lies exactly on the upper face.
                    std::array::from_fn(|a| {
                        if node[a] + 1 == nodes[a] { high[a] } else { low[a] + sides[a] * node[a] as f64 }
                    })
                })
                .collect();
        let counts = cells.map(|c| c as usize);
        let mut corners = Vec::with_capacity(counts.iter().product::<usize>() * (D + 1) * if D == 2 { 2 } else { 6 });
        for cell in 0..counts.iter().product() {
            let node = place(cell, counts);
            let first: usize = (0..D).map(|a| strides[a] * node[a]).sum();
            let corner = |bits: usize| (first + (0..D).map(|a| strides[a] * (bits >> a & 1)).sum::<usize>()) as u32;
            if D == 2 {
                corners.extend([0, 1, 3, 0, 3, 2].map(corner));
            } else {
                for tetrahedron in TETRAHEDRA {
                    let [a, b, _] = tetrahedron.axes;
                    let [p, q, r, s] = tetrahedron.corners.map(corner);
                    let right_handed = (b + 3 - a) % 3 == 1;
                    corners.extend(if right_handed { [p, q, r, s] } else { [p, r, q, s] });
                }
            }
        }
        Ok(Self::trusted(vertices, corners))
    }
}

/// The sides of the cells of a lattice that is possible.
fn lattice_sides<const D: usize>(low: [f64; D], high: [f64; D], cells: [u32; D]) -> Result<[f64; D], DomainError> {
    let sides: [f64; D] = std::array::from_fn(|a| (high[a] - low[a]) / f64::from(cells[a]));
    // Sides of a few roundings would let two nodes fall together.
    let extends = (0..D).all(|a| {
        let reach = low[a].abs().max(high[a].abs());
        cells[a] > 0 && reach <= MOST && sides[a] >= LEAST && sides[a] >= 4.0 * f64::EPSILON * reach
    });
    let count = cells.iter().try_fold(1_usize, |product, &c| product.checked_mul(c as usize));
    if extends && count.is_some_and(|count| count <= MOST_CELLS) {
        Ok(sides)
    } else {
        Err(DomainError::Lattice { low: low.to_vec(), high: high.to_vec(), cells: cells.to_vec(), most: MOST_CELLS })
    }
}
