//! The first eigenvectors of a large symmetric pencil K x = lambda M x, for the seed of free scenes.
//!
//! # What
//! The vectors of smallest x'Kx / x'Mx, with K positive definite and M positive semidefinite, possibly of low rank. Asked the
//! other way round, for the largest theta = 1 / lambda in M x = theta K x, the kernel of M is harmless: there theta = 0.
//!
//! # How
//! LOBPCG (Knyazev 2001). Each step spans the present vectors X, the corrections W = K^-1 (M X - theta K X), solved roughly by
//! conjugate gradients, and the last step's directions P, and takes the best vectors of this span (Rayleigh-Ritz). The small
//! problem is solved in an orthonormal basis of the span, from which nearly dependent directions are dropped.
//!
//! # Cost
//! A step on n unknowns for k vectors takes k solves of at most [`INNER_STEPS`] steps and O(k^2 n) for the products.
//!
//! # Guaranteed
//! Theta never falls from step to step but for rounding. Vectors are worked on in parallel and sums are taken by one
//! thread each, so the result is equal bit for bit on any number of threads.
//!
//! # Not guaranteed
//! That no better vector is missed: a start without a share of it finds it by rounding only.
//!
//! # Source
//! A. V. Knyazev, Toward the optimal preconditioned eigensolver, SIAM J. Sci. Comput. 23, 2001. Ours: the preconditioner is a
//! rough solve.

use nalgebra::{DMatrix, SymmetricEigen};
use rayon::prelude::*;

use crate::monitor::{Cancelled, Monitor, check};

/// A symmetric pencil, applied without being stored.
pub(super) trait Pencil: Sync {
    /// y = K x.
    fn stiffness(&self, x: &[f64], y: &mut [f64]);
    /// y = M x.
    fn mass(&self, x: &[f64], y: &mut [f64]);
    /// The diagonal of K, for Jacobi's preconditioner.
    fn diagonal(&self) -> &[f64];
}

/// Eigenvectors, the best first.
pub(super) struct Eigenpairs {
    /// x'Kx / x'Mx, ascending.
    #[cfg_attr(not(test), expect(dead_code, reason = "the order of the vectors is what the seed takes"))]
    pub(super) values: Vec<f64>,
    /// With x'Kx = 1.
    pub(super) vectors: Vec<Vec<f64>>,
}

/// Most steps.
const STEPS: usize = 40;
/// Most steps of conjugate gradients for one correction.
const INNER_STEPS: usize = 150;
/// A correction is solved to this share of its right-hand side.
const INNER: f64 = 0.05;
/// The end: no theta rose by more than this share.
const AT_REST: f64 = 1e-4;
/// Directions whose share of the basis is smaller, by their eigenvalue in its Gram matrix of unit columns, are dropped.
const DEPENDENT: f64 = 1e-12;

/// Vectors with their images under K and M.
#[derive(Default, Clone)]
struct Block {
    x: Vec<Vec<f64>>,
    kx: Vec<Vec<f64>>,
    mx: Vec<Vec<f64>>,
}

impl Block {
    fn new(pencil: &impl Pencil, x: Vec<Vec<f64>>) -> Self {
        let image = |apply: &(dyn Fn(&[f64], &mut [f64]) + Sync)| -> Vec<Vec<f64>> {
            x.par_iter()
                .map(|x| {
                    let mut y = vec![0.0; x.len()];
                    apply(x, &mut y);
                    y
                })
                .collect()
        };
        let kx = image(&|x, y| pencil.stiffness(x, y));
        let mx = image(&|x, y| pencil.mass(x, y));
        Self { x, kx, mx }
    }

    fn append(&mut self, other: Self) {
        self.x.extend(other.x);
        self.kx.extend(other.kx);
        self.mx.extend(other.mx);
    }

    /// The linear combinations in the columns of `coefficients`, of which the first `skipped` rows are left out.
    fn combined(&self, coefficients: &DMatrix<f64>, skipped: usize) -> Self {
        let combine = |vectors: &[Vec<f64>]| -> Vec<Vec<f64>> {
            (0..coefficients.ncols())
                .into_par_iter()
                .map(|column| {
                    let mut sum = vec![0.0; vectors[0].len()];
                    for (row, vector) in vectors.iter().enumerate().skip(skipped) {
                        add_multiple(&mut sum, coefficients[(row, column)], vector);
                    }
                    sum
                })
                .collect()
        };
        Self { x: combine(&self.x), kx: combine(&self.kx), mx: combine(&self.mx) }
    }
}

/// The `start.len()` eigenvectors of smallest x'Kx / x'Mx.
///
/// # Errors
/// If the monitor asks to stop.
pub(super) fn smallest(
    pencil: &impl Pencil,
    start: Vec<Vec<f64>>,
    monitor: &dyn Monitor,
) -> Result<Eigenpairs, Cancelled> {
    let wanted = start.len();
    let (mut block, mut theta, _) = rayleigh_ritz(&Block::new(pencil, start), wanted);
    let mut directions = Block::default();
    for _ in 0..STEPS {
        check(monitor)?;
        let corrections: Vec<Vec<f64>> =
            (0..theta.len()).into_par_iter().map(|j| correction(pencil, &block, j, theta[j])).collect();
        if corrections.is_empty() {
            break;
        }
        let own = block.x.len();
        let mut span = block;
        span.append(Block::new(pencil, corrections));
        span.append(directions);
        let (next, found, coefficients) = rayleigh_ritz(&span, wanted);
        directions = span.combined(&coefficients, own);
        let rests = found.len() == theta.len() && found.iter().zip(&theta).all(|(n, o)| n - o <= AT_REST * n);
        (block, theta) = (next, found);
        if rests {
            break;
        }
    }
    Ok(Eigenpairs { values: theta.iter().map(|t| 1.0 / t).collect(), vectors: block.x })
}

/// The best vectors of a span, their theta, and their coefficients. Fewer than `wanted` if the span bears no more with theta > 0.
fn rayleigh_ritz(span: &Block, wanted: usize) -> (Block, Vec<f64>, DMatrix<f64>) {
    let n = span.x.len();
    let products = |images: &[Vec<f64>]| {
        let upper: Vec<f64> = (0..n * n)
            .into_par_iter()
            .map(|k| if k / n <= k % n { dot(&span.x[k / n], &images[k % n]) } else { 0.0 })
            .collect();
        DMatrix::from_fn(n, n, |i, j| upper[i.min(j) * n + i.max(j)])
    };
    let (k, m) = (products(&span.kx), products(&span.mx));
    let unit = |i: usize| if k[(i, i)] > 0.0 { 1.0 / k[(i, i)].sqrt() } else { 0.0 };
    let gram = SymmetricEigen::new(DMatrix::from_fn(n, n, |i, j| unit(i) * k[(i, j)] * unit(j)));
    let most = gram.eigenvalues.max();
    let kept: Vec<usize> = (0..n).filter(|&i| gram.eigenvalues[i] > DEPENDENT * most).collect();
    // Columns: an orthonormal basis of the span in the product of K.
    let basis = DMatrix::from_fn(n, kept.len(), |i, j| {
        unit(i) * gram.eigenvectors[(i, kept[j])] / gram.eigenvalues[kept[j]].sqrt()
    });
    let ritz = SymmetricEigen::new(basis.tr_mul(&m) * &basis);
    let mut order: Vec<usize> = (0..kept.len()).filter(|&i| ritz.eigenvalues[i] > 0.0).collect();
    order.sort_by(|&a, &b| ritz.eigenvalues[b].total_cmp(&ritz.eigenvalues[a]));
    order.truncate(wanted);
    let theta = order.iter().map(|&i| ritz.eigenvalues[i]).collect();
    let coefficients = basis * DMatrix::from_fn(kept.len(), order.len(), |i, j| ritz.eigenvectors[(i, order[j])]);
    (span.combined(&coefficients, 0), theta, coefficients)
}

/// A rough solution of K w = M x - theta K x for vector `j`.
fn correction(pencil: &impl Pencil, block: &Block, j: usize, theta: f64) -> Vec<f64> {
    let residual = block.mx[j].iter().zip(&block.kx[j]).map(|(m, k)| m - theta * k).collect();
    solve(pencil, residual, INNER, INNER_STEPS)
}

/// K w = r by conjugate gradients with Jacobi's preconditioner, to a residual of `tolerance` times the first in the
/// preconditioner's norm.
pub(super) fn solve(pencil: &impl Pencil, mut r: Vec<f64>, tolerance: f64, most: usize) -> Vec<f64> {
    let scaled = |r: &[f64]| -> Vec<f64> { r.iter().zip(pencil.diagonal()).map(|(r, d)| r / d).collect() };
    let mut w = vec![0.0; r.len()];
    let mut q = w.clone();
    let mut p = scaled(&r);
    let mut rz = dot(&r, &p);
    let enough = tolerance * tolerance * rz;
    for _ in 0..most {
        if rz <= enough {
            break;
        }
        pencil.stiffness(&p, &mut q);
        let step = rz / dot(&p, &q);
        if !step.is_finite() {
            break;
        }
        add_multiple(&mut w, step, &p);
        add_multiple(&mut r, -step, &q);
        let z = scaled(&r);
        let old = std::mem::replace(&mut rz, dot(&r, &z));
        for (p, z) in p.iter_mut().zip(z) {
            *p = z + rz / old * *p;
        }
    }
    w
}

fn add_multiple(sum: &mut [f64], factor: f64, x: &[f64]) {
    for (s, x) in sum.iter_mut().zip(x) {
        *s += factor * x;
    }
}

/// Eight partial sums, so that the processor need not wait for each addition; their order is fixed.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let (a, rest_a) = a.as_chunks::<8>();
    let (b, rest_b) = b.as_chunks::<8>();
    for (a, b) in a.iter().zip(b) {
        for k in 0..8 {
            lanes[k] += a[k] * b[k];
        }
    }
    lanes.iter().sum::<f64>() + rest_a.iter().zip(rest_b).map(|(a, b)| a * b).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Chance;

    struct Dense {
        k: DMatrix<f64>,
        m: DMatrix<f64>,
        diagonal: Vec<f64>,
    }

    impl Pencil for Dense {
        fn stiffness(&self, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice((&self.k * nalgebra::DVector::from_column_slice(x)).as_slice());
        }

        fn mass(&self, x: &[f64], y: &mut [f64]) {
            y.copy_from_slice((&self.m * nalgebra::DVector::from_column_slice(x)).as_slice());
        }

        fn diagonal(&self) -> &[f64] {
            &self.diagonal
        }
    }

    /// K = second differences with a little mass, M of the given rank.
    fn pencil(n: usize, rank: usize) -> Dense {
        let mut chance = Chance::new(1, 301, 0);
        let k = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.01,
            1 => -1.0,
            _ => 0.0,
        });
        let b = DMatrix::from_fn(rank, n, |_, _| chance.normal());
        let diagonal = k.diagonal().as_slice().to_vec();
        Dense { k, m: b.tr_mul(&b), diagonal }
    }

    fn start(n: usize, count: usize) -> Vec<Vec<f64>> {
        (0..count)
            .map(|k| {
                let mut chance = Chance::new(2, 301, k);
                (0..n).map(|_| chance.normal()).collect()
            })
            .collect()
    }

    #[test]
    fn the_smallest_quotients_agree_with_a_dense_solver() {
        let (n, wanted) = (60, 3);
        for rank in [2, 20] {
            let pencil = pencil(n, rank);
            let factor = pencil.k.clone().cholesky().expect("K is positive definite").l();
            let inverse = factor.try_inverse().expect("K is regular");
            let mut exact: Vec<f64> =
                (&inverse * &pencil.m * inverse.transpose()).symmetric_eigenvalues().iter().copied().collect();
            exact.sort_by(|a, b| b.total_cmp(a));
            let found = smallest(&pencil, start(n, wanted), &()).expect("nobody cancels");
            assert_eq!(found.values.len(), found.vectors.len());
            // With rank 2 only two quotients are finite; others may be there as rounding.
            for (value, exact) in found.values.iter().zip(&exact).take(rank.min(wanted)) {
                // The iteration ends when theta rises by less than 1e-4 in a step.
                assert!((value * exact - 1.0).abs() < 1e-2, "rank {rank}: {value} {}", 1.0 / exact);
            }
            for (x, value) in found.vectors.iter().zip(&found.values).take(rank.min(wanted)) {
                let (mut kx, mut mx) = (vec![0.0; n], vec![0.0; n]);
                pencil.stiffness(x, &mut kx);
                pencil.mass(x, &mut mx);
                assert!((dot(x, &kx) - 1.0).abs() < 1e-9);
                assert!((dot(x, &kx) / dot(x, &mx) / value - 1.0).abs() < 1e-6);
            }
        }
    }
}
