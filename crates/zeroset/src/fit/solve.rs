//! Conjugate gradients on the free nodes, with Jacobi's preconditioner and a warm start.

use rayon::prelude::*;

use super::level::Level;
use super::operator::{Real, apply, for_each_free_row};

/// When to stop.
#[derive(Debug, Clone, Copy)]
pub(super) struct SolveParams {
    /// Residual over right-hand side (or over the first residual where that is zero).
    pub(super) tolerance: f64,
    /// Most steps.
    pub(super) max_steps: usize,
}

/// Solves A f = rhs at the free nodes, starting from `f` and given its residual in `r`. `p` and `q` are scratch.
///
/// `scale` is the norm that the residual is compared with. Each step lowers f'Af/2 - f'rhs, so stopping early is safe.
/// Returns the number of steps.
pub(super) fn conjugate_gradients<T: Real>(
    level: &Level,
    f: &mut [T],
    r: &mut [T],
    p: &mut [T],
    q: &mut [T],
    scale: f64,
    params: SolveParams,
) -> usize {
    p.par_chunks_exact_mut(512).with_min_len(32).for_each(|p| p.fill(T::default()));
    let (mut rz, mut rr) = precondition_and_dot(level, r);
    direction(level, r, p, 0.0);
    let mut steps = 0;
    while steps < params.max_steps && rr.sqrt() > params.tolerance * scale && rz > 0.0 {
        let pq = apply(level, p, q);
        if pq <= 0.0 || pq.is_nan() {
            break;
        }
        let old = rz;
        (rz, rr) = advance(level, f, r, p, q, rz / pq);
        direction(level, r, p, rz / old);
        steps += 1;
    }
    steps
}

fn sum_pairs(partial: Vec<(f64, f64)>) -> (f64, f64) {
    partial.into_iter().fold((0.0, 0.0), |s, p| (s.0 + p.0, s.1 + p.1))
}

/// (r'z, r'r) with z = r / diagonal.
fn precondition_and_dot<T: Real>(level: &Level, r: &[T]) -> (f64, f64) {
    let partial = r
        .par_chunks_exact(512)
        .enumerate()
        .with_min_len(16)
        .map(|(b, r)| {
            let mut dots = Dots::default();
            for_each_free_row(level, b, |row, _, inverse| dots.add(&r[row * 8..row * 8 + 8], &inverse));
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
    fn add(&mut self, r: &[T], inverse: &[f32; 8]) {
        for k in 0..8 {
            let square = r[k] * r[k];
            self.rr[k] += square;
            self.rz[k] += square * T::from(inverse[k]);
        }
    }

    fn sums(self) -> (f64, f64) {
        (self.rz.into_iter().map(Into::into).sum(), self.rr.into_iter().map(Into::into).sum())
    }
}

/// f += step p, r -= step q; returns the new (r'z, r'r).
fn advance<T: Real>(level: &Level, f: &mut [T], r: &mut [T], p: &[T], q: &[T], step: f64) -> (f64, f64) {
    let step = T::of(step);
    let partial = f
        .par_chunks_exact_mut(512)
        .zip(r.par_chunks_exact_mut(512))
        .zip(p.par_chunks_exact(512).zip(q.par_chunks_exact(512)))
        .enumerate()
        .with_min_len(16)
        .map(|(b, ((f, r), (p, q)))| {
            let mut dots = Dots::default();
            for_each_free_row(level, b, |row, _, inverse| {
                let range = row * 8..row * 8 + 8;
                let (f, r) = (&mut f[range.clone()], &mut r[range.clone()]);
                let (p, q) = (&p[range.clone()], &q[range]);
                for k in 0..8 {
                    f[k] += step * p[k];
                    r[k] = r[k] - step * q[k];
                }
                dots.add(r, &inverse);
            });
            dots.sums()
        })
        .collect();
    sum_pairs(partial)
}

/// p = r / diagonal + beta p.
fn direction<T: Real>(level: &Level, r: &[T], p: &mut [T], beta: f64) {
    let beta = T::of(beta);
    p.par_chunks_exact_mut(512).zip(r.par_chunks_exact(512)).enumerate().with_min_len(16).for_each(|(b, (p, r))| {
        for_each_free_row(level, b, |row, _, inverse| {
            let range = row * 8..row * 8 + 8;
            let (p, r) = (&mut p[range.clone()], &r[range]);
            for k in 0..8 {
                p[k] = r[k] * T::from(inverse[k]) + beta * p[k];
            }
        });
    });
}
