//! The first eigenvectors of a large symmetric pencil K x = lambda M x.
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
//! A step on n unknowns for k vectors takes k solves of at most [`Accuracy::inner_steps`] steps and O(k^2 n) for the products.
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

use super::dot;
use crate::monitor::{Cancelled, Monitor, check};

/// A symmetric pencil, applied without being stored.
pub(crate) trait Pencil: Sync {
    /// y = K x.
    fn stiffness(&self, x: &[f64], y: &mut [f64]);
    /// y = M x.
    fn mass(&self, x: &[f64], y: &mut [f64]);
    /// The diagonal of K, for Jacobi's preconditioner.
    fn diagonal(&self) -> &[f64];
    /// Solutions of K w = r for each r, as rough as may be.
    fn corrections(&self, residuals: Vec<Vec<f64>>, accuracy: &Accuracy) -> Vec<Vec<f64>>
    where
        Self: Sized,
    {
        rough_solutions(self, residuals, accuracy)
    }
}

/// How far to go.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accuracy {
    /// Most steps.
    pub(crate) steps: usize,
    /// The end: the first theta rose by no more than this share ...
    pub(crate) at_rest: f64,
    /// ... and the others asked for by no more than this one.
    pub(crate) others_at_rest: f64,
    /// A correction is solved to this share of its right-hand side.
    pub(crate) inner: f64,
    /// Most steps of conjugate gradients for one correction.
    pub(crate) inner_steps: usize,
}

/// Eigenvectors, the best first.
pub(crate) struct Eigenpairs {
    /// x'Kx / x'Mx, ascending.
    pub(crate) values: Vec<f64>,
    /// With x'Kx = 1.
    pub(crate) vectors: Vec<Vec<f64>>,
    /// Whether the vectors asked for came to rest before the steps ran out.
    pub(crate) at_rest: bool,
}

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

/// The eigenvectors of smallest x'Kx / x'Mx, as many as there are starts. The end is reached when the first `wanted` are at rest.
///
/// # Errors
/// If the monitor asks to stop.
pub(crate) fn smallest(
    pencil: &impl Pencil,
    start: Vec<Vec<f64>>,
    wanted: usize,
    accuracy: &Accuracy,
    monitor: &dyn Monitor,
) -> Result<Eigenpairs, Cancelled> {
    let width = start.len();
    if width == 0 {
        return Ok(Eigenpairs { values: Vec::new(), vectors: Vec::new(), at_rest: true });
    }
    let (mut block, mut theta, _) = rayleigh_ritz(&Block::new(pencil, start), width);
    let mut directions = Block::default();
    let mut rests = false;
    for _ in 0..accuracy.steps {
        check(monitor)?;
        let residual = |j: usize| block.mx[j].iter().zip(&block.kx[j]).map(|(m, k)| m - theta[j] * k).collect();
        let corrections = pencil.corrections((0..theta.len()).map(residual).collect(), accuracy);
        if corrections.is_empty() {
            rests = true;
            break;
        }
        let own = block.x.len();
        let mut span = block;
        span.append(Block::new(pencil, corrections));
        span.append(directions);
        let (next, found, coefficients) = rayleigh_ritz(&span, width);
        directions = span.combined(&coefficients, own);
        let at_rest = |k: usize| {
            let share = if k == 0 { accuracy.at_rest } else { accuracy.others_at_rest };
            found[k] - theta[k] <= share * found[k]
        };
        rests = found.len() == theta.len() && (0..wanted.min(found.len())).all(at_rest);
        (block, theta) = (next, found);
        if rests {
            break;
        }
    }
    Ok(Eigenpairs { values: theta.iter().map(|t| 1.0 / t).collect(), vectors: block.x, at_rest: rests })
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

/// Solutions of K w = r for each r by a few steps of conjugate gradients.
pub(super) fn rough_solutions(pencil: &impl Pencil, residuals: Vec<Vec<f64>>, accuracy: &Accuracy) -> Vec<Vec<f64>> {
    residuals.into_par_iter().map(|r| solve(pencil, r, accuracy.inner, accuracy.inner_steps)).collect()
}

/// K w = r by conjugate gradients with Jacobi's preconditioner, to a residual of `tolerance` times the first in the
/// preconditioner's norm.
pub(crate) fn solve(pencil: &impl Pencil, mut r: Vec<f64>, tolerance: f64, most: usize) -> Vec<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Chance;

    const ACCURACY: Accuracy =
        Accuracy { steps: 40, at_rest: 1e-4, others_at_rest: 1e-4, inner: 0.05, inner_steps: 150 };

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
            let found = smallest(&pencil, start(n, wanted), wanted, &ACCURACY, &()).expect("nobody cancels");
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
