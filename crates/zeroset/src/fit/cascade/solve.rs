//! Conjugate gradients on the free nodes, with Jacobi's preconditioner and a warm start.

use rayon::prelude::*;

use super::level::Level;
use super::operator::{Real, apply, for_each_diagonal, rows, rows_mut};
use crate::domain::{Mask, mask_row};

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolveParams {
    /// Residual over right-hand side (or over the first residual where that is zero).
    pub(super) tolerance: f64,
    /// Most steps.
    pub(super) max_steps: usize,
}

/// Solves A f = rhs at the free nodes, starting from `f` and given its residual in `r`, which is zero elsewhere.
///
/// `scale` is the norm that the residual is compared with. Each step lowers f'Af/2 - f'rhs, so stopping early is safe.
/// Returns the number of steps.
pub(super) fn conjugate_gradients<T: Real>(
    level: &Level,
    f: &mut [T],
    r: &mut [T],
    scratch: [&mut [T]; 3],
    scale: f64,
    params: SolveParams,
) -> usize {
    let [p, q, inverse] = scratch;
    p.par_chunks_exact_mut(512).with_min_len(32).for_each(|p| p.fill(T::default()));
    let (mut rz, mut rr) = precondition_and_dot(level, r, inverse);
    direction(level, r, inverse, p, 0.0);
    let mut steps = 0;
    while steps < params.max_steps && rr.sqrt() > params.tolerance * scale && rz > 0.0 {
        let pq = apply(level, p, q);
        if pq <= 0.0 || pq.is_nan() {
            break;
        }
        let old = rz;
        (rz, rr) = advance(level, f, r, [&*p, &*q, &*inverse], rz / pq);
        direction(level, r, inverse, p, rz / old);
        steps += 1;
    }
    steps
}

fn sum_pairs(partial: Vec<(f64, f64)>) -> (f64, f64) {
    partial.into_iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1))
}

/// Fills in 1 / diagonal where there are free nodes; (r'z, r'r) with z = r / diagonal.
fn precondition_and_dot<T: Real>(level: &Level, r: &[T], inverse: &mut [T]) -> (f64, f64) {
    let partial = r
        .par_chunks_exact(512)
        .zip(inverse.par_chunks_exact_mut(512))
        .enumerate()
        .with_min_len(16)
        .map(|(b, (r, inverse))| {
            let (r, inverse) = (rows(r), rows_mut(inverse));
            let mut dots = Dots::default();
            for_each_diagonal(level, b, |row, diagonal| {
                inverse[row] = diagonal.map(|d| T::from(1.0 / d));
                dots.add(r[row], inverse[row]);
            });
            dots.sums()
        })
        .collect();
    sum_pairs(partial)
}

/// Sums of r^2 / diagonal and r^2, eight lanes at a time.
#[derive(Default)]
struct Dots<T: Real> {
    rz: [T; 8],
    rr: [T; 8],
}

impl<T: Real> Dots<T> {
    #[inline(always)]
    fn add(&mut self, r: [T; 8], inverse: [T; 8]) {
        let square = product(r, r);
        self.rr = sum(self.rr, square);
        self.rz = sum(self.rz, product(square, inverse));
    }

    fn sums(self) -> (f64, f64) {
        (self.rz.into_iter().map(Into::into).sum(), self.rr.into_iter().map(Into::into).sum())
    }
}

/// f += step p, r -= step q; returns the new (r'z, r'r).
fn advance<T: Real>(level: &Level, f: &mut [T], r: &mut [T], [p, q, inverse]: [&[T]; 3], step: f64) -> (f64, f64) {
    let (step, minus_step) = (T::of(step), T::of(-step));
    let partial = f
        .par_chunks_exact_mut(512)
        .zip(r.par_chunks_exact_mut(512))
        .enumerate()
        .with_min_len(16)
        .map(|(b, (f, r))| {
            let block = b * 512..(b + 1) * 512;
            let (f, r) = (rows_mut(f), rows_mut(r));
            let (p, q, inverse) = (rows(&p[block.clone()]), rows(&q[block.clone()]), rows(&inverse[block]));
            let mut dots = Dots::default();
            for row in free_rows(&level.free[b]) {
                f[row] = plus_multiple(f[row], step, p[row]);
                r[row] = plus_multiple(r[row], minus_step, q[row]);
                dots.add(r[row], inverse[row]);
            }
            dots.sums()
        })
        .collect();
    sum_pairs(partial)
}

/// p = r / diagonal + beta p.
fn direction<T: Real>(level: &Level, r: &[T], inverse: &[T], p: &mut [T], beta: f64) {
    let beta = T::of(beta);
    p.par_chunks_exact_mut(512)
        .zip(r.par_chunks_exact(512).zip(inverse.par_chunks_exact(512)))
        .enumerate()
        .with_min_len(16)
        .for_each(|(b, (p, (r, inverse)))| {
            let (p, r, inverse) = (rows_mut(p), rows(r), rows(inverse));
            for row in free_rows(&level.free[b]) {
                p[row] = plus_multiple(product(r[row], inverse[row]), beta, p[row]);
            }
        });
}

/// The rows of a block that have free nodes.
#[inline(always)]
fn free_rows(free: &Mask) -> impl Iterator<Item = usize> {
    (0..64).filter(|row| mask_row(free, row & 7, row >> 3) != 0)
}

// Rows go in and out by value: the compiler then sees that no result overlaps an operand, and uses vector instructions.

/// a + factor b.
#[inline(always)]
fn plus_multiple<T: Real>(a: [T; 8], factor: T, b: [T; 8]) -> [T; 8] {
    std::array::from_fn(|k| a[k] + factor * b[k])
}

/// a + b.
#[inline(always)]
fn sum<T: Real>(a: [T; 8], b: [T; 8]) -> [T; 8] {
    std::array::from_fn(|k| a[k] + b[k])
}

/// a b, lane by lane.
#[inline(always)]
fn product<T: Real>(a: [T; 8], b: [T; 8]) -> [T; 8] {
    std::array::from_fn(|k| a[k] * b[k])
}
