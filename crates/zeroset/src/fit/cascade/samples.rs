//! The points of a level, one sample for each tetrahedron that holds any.

use rayon::prelude::*;

use crate::domain::{Cells, LatticePoints, barycentric, tetrahedron_of};

/// All points of one tetrahedron at once. The recovered gradient is linear there, so their mean place stands for them.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    /// Sum of the weights w_i of its points.
    pub(super) weight: f32,
    /// Mean barycentric weights, in the order of the tetrahedron's corners.
    pub(super) barycentric: [f32; 4],
    /// Place of the cell in its block, `x | y << 3 | z << 6`.
    pub(super) local: u16,
    /// Index of the tetrahedron.
    pub(super) tetrahedron: u8,
}

/// The samples of a level, grouped as [`Cells`] groups its blocks.
#[derive(Debug, Default)]
pub(super) struct Samples {
    /// For each block of the cells its samples.
    pub(super) of_block: Vec<Box<[Sample]>>,
}

impl Samples {
    pub(super) fn new(points: &LatticePoints, cells: &Cells, weights: &[f32], shift: u32) -> Self {
        let of_block = (0..cells.block_keys.len())
            .into_par_iter()
            .with_min_len(16)
            .map(|b| {
                let mut samples = Vec::with_capacity(2 * cells.of_block(b).len());
                for cell in cells.of_block(b) {
                    let mut sums = [([0.0_f32; 4], 0_u32); 6];
                    for i in cells.points(cell) {
                        let f = points.fractions(i, shift);
                        let t = tetrahedron_of(f);
                        for (sum, weight) in sums[t].0.iter_mut().zip(barycentric(t, f)) {
                            *sum += weight;
                        }
                        sums[t].1 += 1;
                    }
                    for (t, (sum, count)) in sums.into_iter().enumerate().filter(|(_, s)| s.1 > 0) {
                        samples.push(Sample {
                            weight: count as f32 * weights[cell],
                            barycentric: sum.map(|s| s / count as f32),
                            local: cells.local[cell],
                            tetrahedron: t as u8,
                        });
                    }
                }
                samples.into_boxed_slice()
            })
            .collect();
        Self { of_block }
    }

    pub(super) fn bytes(&self) -> usize {
        self.of_block.iter().map(|s| s.len() * size_of::<Sample>()).sum()
    }
}
