//! The data term alpha B'WB as a stencil of 15 nodes, stored for the rows of nodes that data touch.

use rayon::prelude::*;

use super::polish::Piece;
use crate::domain::{Blocks, Cells, LatticePoints, NONE, TETRAHEDRA, barycentric, neighbor_code, tetrahedron_of};

/// Coefficients of a row of eight nodes. Entry 0 is the node itself; entries 1..=7 are its neighbours at the non-empty subsets
/// of the axes taken as bits, entries 8..=14 the same backwards.
pub(super) type StencilRow = [[f32; 8]; 15];

/// Steps of the 15 entries.
pub(super) const STEPS: [[i32; 3]; 15] = {
    let mut steps = [[0; 3]; 15];
    let mut s = 1;
    while s < 8 {
        let mut axis = 0;
        while axis < 3 {
            let bit = ((s >> axis) & 1) as i32;
            steps[s][axis] = bit;
            steps[7 + s][axis] = -bit;
            axis += 1;
        }
        s += 1;
    }
    steps
};

/// The stored rows of a level.
#[derive(Debug, Default)]
pub(super) struct Stencil {
    /// For each block the rows (bit `y + 8 z`) that are stored.
    pub(super) present: Vec<u64>,
    /// For each block its stored rows in ascending order.
    pub(super) rows: Vec<Box<[StencilRow]>>,
}

impl Stencil {
    /// Sums the data term from the points. `data_block[b]` is the place of block `b` in `cells`, or [`NONE`].
    pub(super) fn new(
        blocks: &Blocks,
        data_block: &[u32],
        points: &LatticePoints,
        cells: &Cells,
        weights: &[f32],
        shift: u32,
        alpha: f32,
    ) -> Self {
        let (present, rows) = (0..blocks.len())
            .into_par_iter()
            .with_min_len(16)
            .map(|b| block_rows(&blocks.neighbors[b], data_block, points, cells, weights, shift, alpha))
            .unzip();
        Self { present, rows }
    }

    /// Adds the matrices of pieces, block by block, times `alpha`.
    pub(super) fn add(&mut self, blocks: &Blocks, pieces: &[Vec<Piece>], alpha: f32) {
        let added: Vec<Option<(u64, Box<[StencilRow]>)>> = (0..blocks.len())
            .into_par_iter()
            .with_min_len(16)
            .map(|b| self.with_pieces(b, &blocks.neighbors[b], pieces, alpha))
            .collect();
        for (b, added) in added.into_iter().enumerate() {
            if let Some((present, rows)) = added {
                self.present[b] = present;
                self.rows[b] = rows;
            }
        }
    }

    /// The rows of a block with the pieces that reach it; `None` if none does.
    fn with_pieces(
        &self,
        b: usize,
        neighbors: &[u32; 27],
        pieces: &[Vec<Piece>],
        alpha: f32,
    ) -> Option<(u64, Box<[StencilRow]>)> {
        let mut present = self.present[b];
        let mut dense: Option<Box<[StencilRow; 64]>> = None;
        for before in 0..8_usize {
            let step: [i32; 3] = std::array::from_fn(|a| -(((before >> a) & 1) as i32));
            let other = neighbors[neighbor_code(step)];
            if other == NONE {
                continue;
            }
            for piece in &pieces[other as usize] {
                let place: [i32; 3] = std::array::from_fn(|a| i32::from(piece.local >> (3 * a) & 7) + 8 * step[a]);
                if place.iter().any(|&c| c < -1) {
                    continue;
                }
                let rows = dense.get_or_insert_with(|| {
                    let mut dense = Box::new([[[0.0; 8]; 15]; 64]);
                    let stored = (0..64).filter(|row| self.present[b] >> row & 1 == 1);
                    stored.zip(&self.rows[b]).for_each(|(row, values)| dense[row] = *values);
                    dense
                });
                present |= add_tetrahedron(rows, place, usize::from(piece.tetrahedron), &piece.moments, alpha);
            }
        }
        let dense = dense?;
        Some((present, (0..64).filter(|row| present >> row & 1 == 1).map(|row| dense[row]).collect()))
    }

    pub(super) fn bytes(&self) -> usize {
        self.rows.iter().map(|r| r.len() * size_of::<StencilRow>()).sum()
    }
}

/// The rows of one block: from its own cells, and from the last layer of cells of the seven blocks before it.
fn block_rows(
    neighbors: &[u32; 27],
    data_block: &[u32],
    points: &LatticePoints,
    cells: &Cells,
    weights: &[f32],
    shift: u32,
    alpha: f32,
) -> (u64, Box<[StencilRow]>) {
    let mut present = 0_u64;
    let mut dense: Option<Box<[StencilRow; 64]>> = None;
    for before in 0..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| -(((before >> a) & 1) as i32));
        let other = neighbors[neighbor_code(step)];
        if other == NONE || data_block[other as usize] == NONE {
            continue;
        }
        for cell in cells.of_block(data_block[other as usize] as usize) {
            let local = cells.local[cell];
            // The cell in coordinates of this block: -1 on the axes along which the other block lies before it.
            let place: [i32; 3] = std::array::from_fn(|a| i32::from(local >> (3 * a) & 7) + 8 * step[a]);
            if place.iter().any(|&c| c < -1) {
                continue;
            }
            let rows = dense.get_or_insert_with(|| Box::new([[[0.0; 8]; 15]; 64]));
            for (t, moments) in cell_moments(points, cells, cell, shift).into_iter().enumerate() {
                let Some(moments) = moments else { continue };
                let scale = alpha * weights[cell];
                present |= add_tetrahedron(rows, place, t, &moments, scale);
            }
        }
    }
    let rows = dense.map_or_else(Vec::new, |dense| {
        (0..64).filter(|row| present >> row & 1 == 1).map(|row| dense[row]).collect::<Vec<_>>()
    });
    (present, rows.into_boxed_slice())
}

/// For each tetrahedron of a cell the sum of b b' over its points, or `None` where it holds none.
fn cell_moments(points: &LatticePoints, cells: &Cells, cell: usize, shift: u32) -> [Option<[[f32; 4]; 4]>; 6] {
    let mut moments = [None; 6];
    for i in cells.points(cell) {
        let f = points.fractions(i, shift);
        let t = tetrahedron_of(f);
        let b = barycentric(t, f);
        let m = moments[t].get_or_insert([[0.0; 4]; 4]);
        for (row, bi) in m.iter_mut().zip(b) {
            for (entry, bj) in row.iter_mut().zip(b) {
                *entry += bi * bj;
            }
        }
    }
    moments
}

/// Adds one tetrahedron's matrix to the rows of those of its nodes that lie in the block; the set of rows touched.
fn add_tetrahedron(rows: &mut [StencilRow; 64], place: [i32; 3], t: usize, moments: &[[f32; 4]; 4], scale: f32) -> u64 {
    let mut touched = 0;
    let corners = TETRAHEDRA[t].corners;
    for (i, &me) in corners.iter().enumerate() {
        let [x, y, z]: [i32; 3] = std::array::from_fn(|a| place[a] + ((me >> a) & 1) as i32);
        if ![x, y, z].iter().all(|c| (0..8).contains(c)) {
            continue;
        }
        let row = (y + 8 * z) as usize;
        touched |= 1 << row;
        for (j, &other) in corners.iter().enumerate() {
            // Corners grow along the path, so the difference of two is a subset of the axes.
            let entry = if j >= i { other ^ me } else { 7 + (other ^ me) };
            rows[row][entry][x as usize] += scale * moments[i][j];
        }
    }
    touched
}
