//! Symmetric matrices, dense or sparse, and their Cholesky factors.

use faer::linalg::matmul::matmul;
use faer::linalg::solvers::{Llt as DenseLlt, Solve};
use faer::sparse::linalg::solvers::Llt as SparseLlt;
use faer::sparse::{SparseColMat, SymbolicSparseColMat};
use faer::{Accum, Mat, MatMut, Par, Side};
use rustc_hash::FxHashMap;

/// A symmetric matrix.
#[derive(Debug, Clone)]
pub(crate) enum Matrix {
    /// Every entry.
    Dense(Mat<f64>),
    /// The lower triangle by columns, rows ascending; every diagonal entry is stored.
    Sparse {
        /// Where each column begins; one more entry than columns.
        starts: Vec<usize>,
        rows: Vec<usize>,
        values: Vec<f64>,
    },
}

/// A Cholesky factor.
pub(crate) enum Factor {
    Dense(DenseLlt<f64>),
    Sparse(SparseLlt<usize, f64>),
}

impl Factor {
    /// Solves in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        let rows = x.len();
        self.solve_columns(MatMut::from_column_major_slice_mut(x, rows, 1));
    }

    /// Solves for several right-hand sides at once, which costs less than one after the other.
    pub(super) fn solve_all(&self, sides: Vec<Vec<f64>>) -> Vec<Vec<f64>> {
        let Some(rows) = sides.first().map(Vec::len).filter(|&rows| rows > 0) else { return sides };
        let mut all = sides.concat();
        self.solve_columns(MatMut::from_column_major_slice_mut(&mut all, rows, sides.len()));
        all.chunks_exact(rows).map(<[f64]>::to_vec).collect()
    }

    fn solve_columns(&self, x: MatMut<'_, f64>) {
        match self {
            Self::Dense(factor) => factor.solve_in_place(x),
            Self::Sparse(factor) => factor.solve_in_place(x),
        }
    }
}

impl Matrix {
    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        match self {
            Self::Dense(matrix) => matrix.nrows(),
            Self::Sparse { starts, .. } => starts.len() - 1,
        }
    }

    pub(crate) fn is_dense(&self) -> bool {
        matches!(self, Self::Dense(_))
    }

    pub(crate) fn is_finite(&self) -> bool {
        let mut finite = true;
        self.for_each(|_, _, value| finite &= value.is_finite());
        finite
    }

    /// Number of stored entries.
    fn entries(&self) -> usize {
        match self {
            Self::Dense(matrix) => matrix.nrows() * matrix.nrows(),
            Self::Sparse { values, .. } => values.len(),
        }
    }

    /// y = A x.
    pub(crate) fn multiply(&self, x: &[f64], y: &mut [f64]) {
        match self {
            Self::Dense(matrix) => {
                for (j, y) in y.iter_mut().enumerate() {
                    // By symmetry a row is a column, and columns are contiguous.
                    *y = super::dot(matrix.col_as_slice(j), x);
                }
            }
            Self::Sparse { starts, rows, values } => {
                y.fill(0.0);
                for j in 0..x.len() {
                    let column = starts[j]..starts[j + 1];
                    let mut own = 0.0;
                    for (&i, &value) in rows[column.clone()].iter().zip(&values[column]) {
                        y[i] += value * x[j];
                        if i != j {
                            own += value * x[i];
                        }
                    }
                    y[j] += own;
                }
            }
        }
    }

    pub(crate) fn diagonal(&self) -> Vec<f64> {
        match self {
            Self::Dense(matrix) => (0..matrix.nrows()).map(|i| matrix[(i, i)]).collect(),
            Self::Sparse { starts, values, .. } => starts[..self.len()].iter().map(|&s| values[s]).collect(),
        }
    }

    /// Calls `visit(i, j, value)` for each stored entry of the lower triangle, column by column.
    pub(crate) fn for_each(&self, mut visit: impl FnMut(usize, usize, f64)) {
        match self {
            Self::Dense(matrix) => {
                for j in 0..matrix.nrows() {
                    for i in j..matrix.nrows() {
                        visit(i, j, matrix[(i, j)]);
                    }
                }
            }
            Self::Sparse { starts, rows, values } => {
                for j in 0..self.len() {
                    for k in starts[j]..starts[j + 1] {
                        visit(rows[k], j, values[k]);
                    }
                }
            }
        }
    }

    /// self + factor * other.
    pub(crate) fn plus(&self, factor: f64, other: &Self) -> Self {
        let mut sum = MatrixBuilder::like(self);
        self.for_each(|i, j, value| sum.add(i, j, value));
        other.for_each(|i, j, value| sum.add(i, j, factor * value));
        sum.finish()
    }

    /// self + factor * identity.
    pub(crate) fn plus_diagonal(&self, factor: f64) -> Self {
        let mut sum = self.clone();
        match &mut sum {
            Self::Dense(matrix) => (0..matrix.nrows()).for_each(|i| matrix[(i, i)] += factor),
            Self::Sparse { starts, values, .. } => {
                let (_, firsts) = starts.split_last().expect("there is one more start than columns");
                firsts.iter().for_each(|&s| values[s] += factor);
            }
        }
        sum
    }

    /// The rows and columns listed, in their order, which must ascend.
    pub(crate) fn restricted(&self, kept: &[usize]) -> Self {
        let mut place = vec![None; self.len()];
        for (to, &from) in kept.iter().enumerate() {
            place[from] = Some(to);
        }
        let mut part = MatrixBuilder::new(kept.len(), self.is_dense());
        self.for_each(|i, j, value| {
            if let (Some(i), Some(j)) = (place[i], place[j]) {
                part.add(i, j, value);
            }
        });
        part.finish()
    }

    /// The dense form.
    pub(super) fn to_dense(&self) -> Mat<f64> {
        match self {
            Self::Dense(matrix) => matrix.clone(),
            Self::Sparse { .. } => {
                let mut matrix = Mat::zeros(self.len(), self.len());
                self.for_each(|i, j, value| {
                    matrix[(i, j)] = value;
                    matrix[(j, i)] = value;
                });
                matrix
            }
        }
    }

    /// The Cholesky factor; `None` if the matrix is not positive definite, by rounding or in truth.
    pub(crate) fn factor(&self) -> Option<Factor> {
        match self {
            Self::Dense(matrix) => matrix.llt(Side::Lower).ok().map(Factor::Dense),
            Self::Sparse { starts, rows, values } => {
                let n = self.len();
                let symbolic = SymbolicSparseColMat::new_checked(n, n, starts.clone(), None, rows.clone());
                SparseColMat::new(symbolic, values.clone()).sp_cholesky(Side::Lower).ok().map(Factor::Sparse)
            }
        }
    }
}

/// Sums a symmetric matrix from parts. Parts are added in the order in which they come, so the sum is the same on every run.
pub(crate) enum MatrixBuilder {
    Dense {
        sum: Mat<f64>,
        /// Vectors still to be added as outer products, one a column.
        waiting: Mat<f64>,
        /// How many.
        count: usize,
    },
    Sparse {
        len: usize,
        /// The lower triangle, by (column, row).
        entries: FxHashMap<(u32, u32), f64>,
    },
}

/// Outer products that a dense matrix takes at once.
const WAITING: usize = 256;

impl MatrixBuilder {
    pub(crate) fn new(len: usize, dense: bool) -> Self {
        if dense {
            Self::Dense { sum: Mat::zeros(len, len), waiting: Mat::zeros(len, WAITING), count: 0 }
        } else {
            Self::Sparse { len, entries: FxHashMap::default() }
        }
    }

    fn like(matrix: &Matrix) -> Self {
        let mut new = Self::new(matrix.len(), matrix.is_dense());
        if let Self::Sparse { entries, .. } = &mut new {
            entries.reserve(matrix.entries());
        }
        new
    }

    /// Adds to the entry (i, j) of the lower triangle and its mirror image. Each pair is added once, not as (i, j) and (j, i).
    pub(crate) fn add(&mut self, i: usize, j: usize, value: f64) {
        let (row, column) = (i.max(j), i.min(j));
        match self {
            Self::Dense { sum, .. } => {
                sum[(row, column)] += value;
                if row != column {
                    sum[(column, row)] += value;
                }
            }
            Self::Sparse { entries, .. } => *entries.entry((column as u32, row as u32)).or_insert(0.0) += value,
        }
    }

    /// Adds weight * v v', with v given by its entries at `indices`, all different. The weight must not be negative.
    pub(crate) fn add_outer(&mut self, weight: f64, indices: &[u32], values: &[f64]) {
        match self {
            Self::Dense { waiting, count, .. } => {
                let column = waiting.col_as_slice_mut(*count);
                column.fill(0.0);
                for (&i, &value) in indices.iter().zip(values) {
                    column[i as usize] = weight.sqrt() * value;
                }
                *count += 1;
                if *count == WAITING {
                    self.add_waiting();
                }
            }
            Self::Sparse { .. } => {
                for (b, &j) in indices.iter().enumerate() {
                    for (a, &i) in indices.iter().enumerate().take(b + 1) {
                        self.add(i as usize, j as usize, weight * values[a] * values[b]);
                    }
                }
            }
        }
    }

    fn add_waiting(&mut self) {
        if let Self::Dense { sum, waiting, count } = self {
            let vectors = waiting.as_ref().subcols(0, *count);
            matmul(sum.as_mut(), Accum::Add, vectors, vectors.transpose(), 1.0, Par::Seq);
            *count = 0;
        }
    }

    pub(crate) fn finish(mut self) -> Matrix {
        self.add_waiting();
        match self {
            Self::Dense { sum, .. } => Matrix::Dense(sum),
            Self::Sparse { len, mut entries } => {
                for i in 0..len as u32 {
                    entries.entry((i, i)).or_insert(0.0);
                }
                let mut sorted: Vec<((u32, u32), f64)> = entries.into_iter().collect();
                sorted.sort_unstable_by_key(|entry| entry.0);
                let mut starts = vec![0; len + 1];
                for ((column, _), _) in &sorted {
                    starts[*column as usize + 1] += 1;
                }
                for column in 0..len {
                    starts[column + 1] += starts[column];
                }
                let rows = sorted.iter().map(|((_, row), _)| *row as usize).collect();
                let values = sorted.into_iter().map(|(_, value)| value).collect();
                Matrix::Sparse { starts, rows, values }
            }
        }
    }
}
