//! Eigenvectors of very small symmetric matrices.
//!
//! Rotations of Jacobi, on memory of the caller, for any size: the sizes D and D + 1 are needed together, which the types of a
//! dense library do not let a constant D express, and nothing is allocated. Small eigenvalues keep their accuracy.

/// More than ever needed: convergence is quadratic.
const SWEEPS: usize = 30;

/// Makes a symmetric matrix of n x n numbers diagonal. Its eigenvalues are left on the diagonal, in no order; row i of `vectors`
/// becomes the unit eigenvector of the i-th.
#[inline]
pub(super) fn diagonalize(matrix: &mut [f64], vectors: &mut [f64], n: usize) {
    debug_assert!(matrix.len() == n * n && vectors.len() == n * n);
    for (i, v) in vectors.iter_mut().enumerate() {
        *v = f64::from(i / n == i % n);
    }
    for _ in 0..SWEEPS {
        let mut turned = false;
        for p in 0..n {
            for q in p + 1..n {
                let off = matrix[p * n + q];
                let (at_p, at_q) = (matrix[p * n + p], matrix[q * n + q]);
                // Below the last bit of both: nothing left to turn.
                if off == 0.0 || off.abs() <= f64::EPSILON * (at_p.abs() * at_q.abs()).sqrt() {
                    continue;
                }
                turned = true;
                let theta = 0.5 * (at_q - at_p) / off;
                let tan = theta.signum() / (theta.abs() + theta.hypot(1.0));
                let cos = 1.0 / (1.0 + tan * tan).sqrt();
                let sin = tan * cos;
                matrix[p * n + p] = at_p - tan * off;
                matrix[q * n + q] = at_q + tan * off;
                matrix[p * n + q] = 0.0;
                matrix[q * n + p] = 0.0;
                for r in 0..n {
                    if r != p && r != q {
                        let (a, b) = (matrix[r * n + p], matrix[r * n + q]);
                        let (a, b) = (cos * a - sin * b, sin * a + cos * b);
                        matrix[r * n + p] = a;
                        matrix[p * n + r] = a;
                        matrix[r * n + q] = b;
                        matrix[q * n + r] = b;
                    }
                    let (a, b) = (vectors[p * n + r], vectors[q * n + r]);
                    vectors[p * n + r] = cos * a - sin * b;
                    vectors[q * n + r] = sin * a + cos * b;
                }
            }
        }
        if !turned {
            return;
        }
    }
}

/// Index of the smallest eigenvalue of a matrix that is diagonal by now. The first of equal ones.
#[inline]
pub(super) fn smallest(matrix: &[f64], n: usize) -> usize {
    let mut best = 0;
    for i in 1..n {
        if matrix[i * n + i] < matrix[best * n + best] {
            best = i;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Chance;

    #[test]
    fn matrices_of_any_size_are_rebuilt_from_their_eigenvectors() {
        let mut chance = Chance::new(3, 0, 0);
        for n in 1..=6 {
            let half: Vec<f64> = (0..n * n).map(|_| chance.normal()).collect();
            let given: Vec<f64> =
                (0..n * n).map(|i| (0..n).map(|r| half[r * n + i / n] * half[r * n + i % n]).sum()).collect();
            let (mut matrix, mut vectors) = (given.clone(), vec![0.0; n * n]);
            diagonalize(&mut matrix, &mut vectors, n);
            for i in 0..n * n {
                let rebuilt: f64 =
                    (0..n).map(|r| matrix[r * n + r] * vectors[r * n + i / n] * vectors[r * n + i % n]).sum();
                let unit: f64 = (0..n).map(|r| vectors[(i / n) * n + r] * vectors[(i % n) * n + r]).sum();
                // Some rounding errors of numbers of size 10.
                assert!((rebuilt - given[i]).abs() < 1e-13, "{n}");
                assert!((unit - f64::from(i / n == i % n)).abs() < 1e-14, "{n}");
            }
        }
    }

    #[test]
    fn a_zero_matrix_and_a_diagonal_one_are_left_alone() {
        let mut vectors = [0.0; 4];
        let mut matrix = [0.0; 4];
        diagonalize(&mut matrix, &mut vectors, 2);
        assert_eq!(vectors, [1.0, 0.0, 0.0, 1.0]);
        let mut matrix = [3.0, 0.0, 0.0, 2.0];
        diagonalize(&mut matrix, &mut vectors, 2);
        assert_eq!(smallest(&matrix, 2), 1);
    }
}
