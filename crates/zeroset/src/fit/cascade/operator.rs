//! The operator A = alpha B'WB + L + gamma, applied block by block, and the energy E(F) = F'AF.

use std::ops::{Add, AddAssign, Div, Mul, MulAssign, Sub, SubAssign};

use rayon::prelude::*;

use super::level::Level;
use super::prior::GAMMA;
use super::stencil::{STEPS, StencilRow};
use crate::domain::{Halo, gather, halo_index, mask_row, replicate_at_domain_faces};

/// f32 where memory counts, f64 for the seed, whose field decays exponentially into cavities.
pub(super) trait Real:
    Copy
    + Default
    + Send
    + Sync
    + PartialOrd
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + AddAssign
    + SubAssign
    + MulAssign
    + From<f32>
    + Into<f64>
{
    fn of(value: f64) -> Self;
    fn root(self) -> Self;
}

impl Real for f32 {
    fn of(value: f64) -> Self {
        value as Self
    }

    fn root(self) -> Self {
        self.sqrt()
    }
}

impl Real for f64 {
    fn of(value: f64) -> Self {
        value
    }

    fn root(self) -> Self {
        self.sqrt()
    }
}

/// Eight bits as eight factors of 0 or 1.
pub(super) const LANES: [[f32; 8]; 256] = {
    let mut lanes = [[0.0; 8]; 256];
    let mut bits = 0;
    while bits < 256 {
        let mut x = 0;
        while x < 8 {
            lanes[bits][x] = (bits >> x & 1) as f32;
            x += 1;
        }
        bits += 1;
    }
    lanes
};

/// Distance in the halo buffer of each stencil step.
const OFFSETS: [isize; 15] = {
    let mut offsets = [0; 15];
    let mut k = 0;
    while k < 15 {
        offsets[k] = STEPS[k][0] as isize + STEPS[k][1] as isize * 16 + STEPS[k][2] as isize * 192;
        k += 1;
    }
    offsets
};

#[inline(always)]
pub(super) fn row_at<T: Copy>(halo: &Halo<T>, at: usize) -> &[T; 8] {
    halo[at..at + 8].try_into().expect("eight values")
}

/// The rows of eight values of a block.
#[inline(always)]
pub(super) fn rows<T>(block: &[T]) -> &[[T; 8]; 64] {
    block.as_chunks().0.try_into().expect("64 rows")
}

/// The rows of eight values of a block.
#[inline(always)]
pub(super) fn rows_mut<T>(block: &mut [T]) -> &mut [[T; 8]; 64] {
    block.as_chunks_mut().0.try_into().expect("64 rows")
}

#[inline(always)]
fn stencil_product<T: Real>(halo: &Halo<T>, at: usize, row: &StencilRow) -> [T; 8] {
    let mut sum = [T::default(); 8];
    for (offset, coefficients) in OFFSETS.iter().zip(row) {
        let values = row_at(halo, (at as isize + offset) as usize);
        for x in 0..8 {
            sum[x] += T::from(coefficients[x]) * values[x];
        }
    }
    sum
}

/// Rows of a block that are stored in the stencil, in order, as the caller walks over them.
struct StencilCursor<'a> {
    present: u64,
    rows: std::slice::Iter<'a, StencilRow>,
}

impl<'a> StencilCursor<'a> {
    fn new(level: &'a Level, b: usize) -> Self {
        Self { present: level.stencil.present[b], rows: level.stencil.rows[b].iter() }
    }

    /// The coefficients of the row, which must be later than every row asked for before.
    #[inline(always)]
    fn next(&mut self, row: usize) -> Option<&'a StencilRow> {
        if self.present >> row & 1 == 1 { self.rows.next() } else { None }
    }
}

/// q = A x at the free nodes, zero elsewhere; returns x'q, summed in a fixed order.
pub(super) fn apply<T: Real>(level: &Level, x: &[T], q: &mut [T]) -> f64 {
    let gamma = T::from(GAMMA);
    let partial: Vec<f64> = q
        .par_chunks_exact_mut(512)
        .enumerate()
        .with_min_len(8)
        .map_init(
            || [T::default(); 2304],
            |halo, (b, q)| {
                let free = &level.free[b];
                if *free == [0; 8] {
                    q.fill(T::default());
                    return 0.0;
                }
                gather::<T, 1, 1>(x, &level.blocks.neighbors[b], T::default(), halo);
                replicate_at_domain_faces(&level.blocks, b, halo);
                let mut stencil = StencilCursor::new(level, b);
                let mut dot = [T::default(); 8];
                for row in 0..64 {
                    let (y, z) = (row & 7, row >> 3);
                    let coefficients = stencil.next(row);
                    let out: &mut [T; 8] = (&mut q[row * 8..row * 8 + 8]).try_into().expect("eight values");
                    let bits = mask_row(free, y, z);
                    if bits == 0 {
                        *out = [T::default(); 8];
                        continue;
                    }
                    let at = halo_index(0, y as i32, z as i32);
                    let centre = row_at(halo, at);
                    let mut sum = laplacian(halo, at);
                    if let Some(prior) = &level.prior {
                        let told = mask_row(&prior.air[b], y, z) | mask_row(&prior.solid[b], y, z);
                        if told != 0 {
                            for k in 0..8 {
                                sum[k] += gamma * T::from(LANES[told as usize][k]) * centre[k];
                            }
                        }
                    }
                    if let Some(coefficients) = coefficients {
                        let data = stencil_product(halo, at, coefficients);
                        for k in 0..8 {
                            sum[k] += data[k];
                        }
                    }
                    for k in 0..8 {
                        out[k] = sum[k] * T::from(LANES[bits as usize][k]);
                        dot[k] += out[k] * centre[k];
                    }
                }
                dot.into_iter().map(Into::into).sum()
            },
        )
        .collect();
    partial.into_iter().sum()
}

#[inline(always)]
fn laplacian<T: Real>(halo: &Halo<T>, at: usize) -> [T; 8] {
    let (centre, west, east) = (row_at(halo, at), row_at(halo, at - 1), row_at(halo, at + 1));
    let (south, north) = (row_at(halo, at - 16), row_at(halo, at + 16));
    let (down, up) = (row_at(halo, at - 192), row_at(halo, at + 192));
    let six = T::from(6.0);
    std::array::from_fn(|k| six * centre[k] - ((west[k] + east[k]) + (south[k] + north[k]) + (down[k] + up[k])))
}

/// The diagonal of A on a row: for Jacobi's preconditioner.
#[inline(always)]
fn diagonal(level: &Level, b: usize, row: usize, stencil: Option<&StencilRow>) -> [f32; 8] {
    let mut diagonal = [6.0; 8];
    if let Some(coefficients) = stencil {
        for k in 0..8 {
            diagonal[k] += coefficients[0][k];
        }
    }
    if let Some(prior) = &level.prior {
        let (y, z) = (row & 7, row >> 3);
        let told = mask_row(&prior.air[b], y, z) | mask_row(&prior.solid[b], y, z);
        for k in 0..8 {
            diagonal[k] += GAMMA * LANES[told as usize][k];
        }
    }
    diagonal
}

/// Calls `visit(row, diagonal of A)` for each row of block `b` that has free nodes.
#[inline(always)]
pub(super) fn for_each_diagonal(level: &Level, b: usize, mut visit: impl FnMut(usize, [f32; 8])) {
    let free = &level.free[b];
    if *free == [0; 8] {
        return;
    }
    let mut stencil = StencilCursor::new(level, b);
    for row in 0..64 {
        let coefficients = stencil.next(row);
        if mask_row(free, row & 7, row >> 3) != 0 {
            visit(row, diagonal(level, b, row, coefficients));
        }
    }
}

/// E(F): data, stiffness over all edges between known nodes, and prior. Summed in a fixed order.
pub(super) fn energy(level: &Level, f: &[f32]) -> f64 {
    let partial: Vec<f64> = (0..level.blocks.len())
        .into_par_iter()
        .with_min_len(8)
        .map_init(
            || [0.0_f32; 2304],
            |halo, b| {
                gather::<f32, 1, 1>(f, &level.blocks.neighbors[b], 0.0, halo);
                let known = &level.known[b];
                let ahead: [_; 3] =
                    std::array::from_fn(|axis| crate::domain::shifted(&level.blocks, &level.known, b, axis, true));
                let mut stencil = StencilCursor::new(level, b);
                let mut sum = [0.0_f32; 8];
                for row in 0..64 {
                    let (y, z) = (row & 7, row >> 3);
                    let coefficients = stencil.next(row);
                    let bits = mask_row(known, y, z);
                    if bits == 0 {
                        continue;
                    }
                    let at = halo_index(0, y as i32, z as i32);
                    let centre = row_at(halo, at);
                    for (step, ahead) in [1, 16, 192].into_iter().zip(&ahead) {
                        let (next, both) = (row_at(halo, at + step), &LANES[(bits & mask_row(ahead, y, z)) as usize]);
                        for k in 0..8 {
                            let d = (next[k] - centre[k]) * both[k];
                            sum[k] += d * d;
                        }
                    }
                    if let Some(coefficients) = coefficients {
                        let data = stencil_product(halo, at, coefficients);
                        for k in 0..8 {
                            sum[k] += data[k] * centre[k];
                        }
                    }
                    if let Some(prior) = &level.prior {
                        let told = mask_row(&prior.air[b], y, z) | mask_row(&prior.solid[b], y, z);
                        for k in 0..8 {
                            sum[k] += GAMMA * LANES[told as usize][k] * centre[k] * centre[k];
                        }
                    }
                }
                sum.into_iter().map(f64::from).sum()
            },
        )
        .collect();
    partial.into_iter().sum()
}
