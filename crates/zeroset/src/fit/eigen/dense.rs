//! All eigenpairs of a dense pencil.

use faer::{Mat, MatRef, Side};

use super::Pencil;

/// Directions in which A + tau M is smaller than this share of its largest are not told from zero, and left out.
const ZERO: f64 = 1e-14;

/// The vectors of the `count` smallest values; `None` if the iteration fails.
pub(super) fn smallest(pencil: &Pencil<'_>, count: usize) -> Option<Vec<Vec<f64>>> {
    let Some(mass) = pencil.mass else {
        let (_, vectors) = eigen(pencil.energy.to_dense().as_ref())?;
        return Some(columns(vectors.as_ref()).take(count).collect());
    };
    // A basis in which A + tau M is the identity; then the largest values of M in it.
    let shifted = pencil.shifted(pencil.shift(1.0));
    let scale: Vec<f64> = shifted.diagonal().iter().map(|&d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 }).collect();
    let mut shifted = shifted.to_dense();
    for j in 0..scale.len() {
        for i in 0..scale.len() {
            shifted[(i, j)] *= scale[i] * scale[j];
        }
    }
    let (values, vectors) = eigen(shifted.as_ref())?;
    let most = values.last().copied().unwrap_or(0.0);
    let kept: Vec<usize> = (0..values.len()).filter(|&k| values[k] > ZERO * most).collect();
    let basis =
        Mat::from_fn(values.len(), kept.len(), |i, k| scale[i] * vectors[(i, kept[k])] / values[kept[k]].sqrt());
    let projected = basis.transpose() * (mass.to_dense() * &basis);
    let (_, vectors) = eigen(projected.as_ref())?;
    let found = &basis * vectors;
    Some(columns(found.as_ref()).rev().take(count).collect())
}

/// Eigenvalues, ascending, and vectors as columns; `None` for an empty matrix, and if the iteration does not converge.
fn eigen(matrix: MatRef<'_, f64>) -> Option<(Vec<f64>, Mat<f64>)> {
    if matrix.nrows() == 0 {
        return None;
    }
    let found = matrix.self_adjoint_eigen(Side::Lower).ok()?;
    Some((found.S().column_vector().iter().copied().collect(), found.U().to_owned()))
}

fn columns(matrix: MatRef<'_, f64>) -> impl DoubleEndedIterator<Item = Vec<f64>> {
    (0..matrix.ncols()).map(move |j| matrix.col(j).iter().copied().collect())
}
