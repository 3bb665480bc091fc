//! The sign of F where nothing is known: the first eigenvectors of the order-2 problem with p = 2.
//!
//! # What
//! On the coarsest lattice, the functions F that minimise, each orthogonal to those before it,
//!
//! ```text
//! [ alpha sum_i w_i F(P_i)^2  +  alpha mu sum |Hess F|^2 ]  /  sum_i w_i |grad F(P_i)|^2
//! ```
//!
//! in cells. Nothing is said about sides: the quotient wants F to cross zero at the points, steeply, and to bend little
//! elsewhere. F and -F are equal, so the sign of the whole is open. |Hess F|^2 is summed from second differences (1, -2, 1 along each
//! axis, and twice the squares of 1, -1, -1, 1 on each face of a cell), only those that lie within the box, so linear
//! functions are free. The gradient is the recovered one: central differences at the nodes, interpolated.
//!
//! # Why order 2
//! With order 1, or with too little smoothness, the first eigenvectors sit on one patch of the surface, as p = 2 rewards a
//! steep place more than p = 1. This is so on fine lattices also with order 2 and the weight used here, so
//! eigenvectors are taken on the first level only. Even there |grad F| differs from place to place; the steps with p = 1 that follow make
//! it even.
//!
//! # Cost
//! At most 40 nodes across; see [`crate::fit::eigen`]. Sums are taken in a fixed order.
//!
//! # Guaranteed
//! The same vectors bit for bit on any number of threads. Neither normals nor any other knowledge enters.
//!
//! # Not guaranteed
//! That one of them tells inside from outside rightly everywhere. A body thinner than a cell is a sheet here, and has two sides
//! instead of an inside; the later levels try other starts for that ([`super::free`]).
//!
//! # Source
//! Taubin 1991 for the normalisation by squared gradients; its use on a lattice with order 2: design of this project.

use super::level::Level;
use super::samples::Sample;
use super::stencil::STEPS;
use crate::domain::{Blocks, TETRAHEDRA, block_of_key};
use crate::fit::eigen::lobpcg::{Accuracy, Eigenpairs, Pencil, smallest, solve};
use crate::monitor::{Cancelled, Monitor};
use crate::sample::Chance;

/// Weight of the Hessian, relative to that of the data.
///
/// From 1e-4 to 1e-2 five bodies get the same sides (fertility, fandisk, anchor, block, featuretype); with 1e-1 a handle of
/// fertility is filled, and 0.985 of its box is right instead of 0.9987.
const SMOOTHNESS: f64 = 1e-3;
/// Mass at every node relative to the weight of the data. It makes K positive definite where all points lie in a plane.
const MASS: f64 = 1e-9;
/// Eigenvectors taken. The steps with p = 1 then choose by R. On the five bodies the first has always won; on a city it is another.
const VECTORS: usize = 4;
/// Vectors good to a few per cent serve: the steps that follow go on from there.
const ACCURACY: Accuracy = Accuracy { steps: 40, at_rest: 1e-4, others_at_rest: 1e-4, inner: 0.05, inner_steps: 150 };

/// The nodes of a dense level in plain order, x fastest.
struct Grid {
    size: [usize; 3],
}

impl Grid {
    fn new(blocks: &Blocks) -> Self {
        Self { size: blocks.extent.map(|e| 8 * e as usize) }
    }

    fn len(&self) -> usize {
        self.size.iter().product()
    }

    fn strides(&self) -> [usize; 3] {
        [1, self.size[0], self.size[0] * self.size[1]]
    }

    fn at(&self, node: [usize; 3]) -> usize {
        node[0] + self.size[0] * (node[1] + self.size[1] * node[2])
    }

    /// Values in the order of the level's blocks.
    fn to_blocks(&self, blocks: &Blocks, values: &[f64]) -> Vec<f32> {
        let mut f = vec![0.0; blocks.len() * 512];
        for (i, f) in f.iter_mut().enumerate() {
            *f = values[self.place(blocks, i / 512, i % 512)] as f32;
        }
        f
    }

    /// The node at a place of a block.
    fn place(&self, blocks: &Blocks, b: usize, local: usize) -> usize {
        let corner = blocks.coordinates[b].map(|c| 8 * c as usize);
        self.at([corner[0] + (local & 7), corner[1] + (local >> 3 & 7), corner[2] + (local >> 6)])
    }
}

/// The gradient at a sample as a sum over nodes.
struct GradientRow {
    weight: f64,
    /// Nodes, and what each gives to the three components.
    entries: Vec<(usize, [f64; 3])>,
}

/// K: data, Hessian and mass. M: squared gradients at the samples.
struct OrderTwo {
    grid: Grid,
    smoothness: f64,
    mass: f64,
    /// The rows of the data term that are not empty: a node and its coefficients.
    data: Vec<(usize, [f64; 15])>,
    /// Distance of the nodes of a row of the data term.
    offsets: [isize; 15],
    gradients: Vec<GradientRow>,
    /// Of K.
    diagonal: Vec<f64>,
}

impl OrderTwo {
    /// The pencil of a dense level whose data term was summed with weight `alpha`.
    fn new(level: &Level, alpha: f64) -> Self {
        let grid = Grid::new(&level.blocks);
        let strides = grid.strides().map(|s| s as isize);
        let offsets = STEPS.map(|step| (0..3).map(|a| step[a] as isize * strides[a]).sum());
        let mut data = Vec::new();
        for b in 0..level.blocks.len() {
            let present = (0..64).filter(|row| level.stencil.present[b] >> row & 1 == 1);
            for (row, coefficients) in present.zip(&level.stencil.rows[b]) {
                for x in 0..8_usize {
                    let c = coefficients.map(|entry| f64::from(entry[x]));
                    if c[0] > 0.0 {
                        data.push((grid.place(&level.blocks, b, 8 * row + x), c));
                    }
                }
            }
        }
        let mut gradients = Vec::new();
        for (samples, &key) in level.samples.of_block.iter().zip(&level.cells.block_keys) {
            let corner = block_of_key(key).map(|c| 8 * c as usize);
            gradients.extend(samples.iter().map(|s| gradient_row(&grid, corner, s)));
        }
        let (smoothness, mass) = (SMOOTHNESS * alpha, MASS * alpha);
        let mut diagonal = vec![mass; grid.len()];
        second_differences(&grid, |weight, entries| {
            for &(at, c) in entries {
                diagonal[at] += smoothness * weight * c * c;
            }
        });
        for (node, c) in &data {
            diagonal[*node] += c[0];
        }
        Self { grid, smoothness, mass, data, offsets, gradients, diagonal }
    }
}

/// Calls `visit(weight, [(node, factor)])` for every second difference within the grid.
#[inline(always)]
fn second_differences(grid: &Grid, mut visit: impl FnMut(f64, &[(usize, f64)])) {
    let (size, strides) = (grid.size, grid.strides());
    for z in 0..size[2] {
        for y in 0..size[1] {
            for x in 0..size[0] {
                let node = [x, y, z];
                let at = grid.at(node);
                for a in 0..3 {
                    let s = strides[a];
                    if node[a] + 2 < size[a] {
                        visit(1.0, &[(at, 1.0), (at + s, -2.0), (at + 2 * s, 1.0)]);
                    }
                    let b = (a + 1) % 3;
                    if node[a] + 1 < size[a] && node[b] + 1 < size[b] {
                        let t = strides[b];
                        visit(2.0, &[(at, 1.0), (at + s, -1.0), (at + t, -1.0), (at + s + t, 1.0)]);
                    }
                }
            }
        }
    }
}

/// The recovered gradient at a sample in the block that begins at `corner`. The padding of the box keeps all nodes within it.
fn gradient_row(grid: &Grid, corner: [usize; 3], sample: &Sample) -> GradientRow {
    let local = usize::from(sample.local);
    let strides = grid.strides();
    let cell = grid.at([corner[0] + (local & 7), corner[1] + (local >> 3 & 7), corner[2] + (local >> 6)]);
    let mut entries: Vec<(usize, [f64; 3])> = Vec::with_capacity(24);
    let corners = TETRAHEDRA[usize::from(sample.tetrahedron)].corners;
    for (corner, barycentric) in corners.into_iter().zip(sample.barycentric) {
        let node = cell + (0..3).filter(|a| corner >> a & 1 == 1).map(|a| strides[a]).sum::<usize>();
        for axis in 0..3 {
            for (at, sign) in [(node + strides[axis], 0.5), (node - strides[axis], -0.5)] {
                let mut component = [0.0; 3];
                component[axis] = sign * f64::from(barycentric);
                entries.push((at, component));
            }
        }
    }
    GradientRow { weight: f64::from(sample.weight), entries }
}

impl Pencil for OrderTwo {
    fn stiffness(&self, x: &[f64], y: &mut [f64]) {
        for (y, x) in y.iter_mut().zip(x) {
            *y = self.mass * x;
        }
        second_differences(&self.grid, |weight, entries| {
            let d = self.smoothness * weight * entries.iter().map(|&(at, c)| c * x[at]).sum::<f64>();
            for &(at, c) in entries {
                y[at] += c * d;
            }
        });
        for (node, coefficients) in &self.data {
            y[*node] +=
                self.offsets.iter().zip(coefficients).map(|(o, c)| c * x[(*node as isize + o) as usize]).sum::<f64>();
        }
    }

    fn mass(&self, x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        for row in &self.gradients {
            let mut g = [0.0; 3];
            for (node, c) in &row.entries {
                for a in 0..3 {
                    g[a] += c[a] * x[*node];
                }
            }
            for (node, c) in &row.entries {
                y[*node] += row.weight * (0..3).map(|a| c[a] * g[a]).sum::<f64>();
            }
        }
    }

    fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }
}

/// The first eigenvectors on a dense level without fixed faces, whose data term was summed with weight `alpha`.
///
/// # Errors
/// If the monitor asks to stop.
pub(super) fn eigenvectors(level: &Level, alpha: f64, monitor: &dyn Monitor) -> Result<Vec<Vec<f32>>, Cancelled> {
    let pencil = OrderTwo::new(level, alpha);
    let n = pencil.grid.len();
    let start = (0..VECTORS)
        .map(|k| {
            let mut chance = Chance::new(1, 300, k);
            let noise: Vec<f64> = (0..n).map(|_| chance.normal()).collect();
            let mut image = vec![0.0; n];
            pencil.mass(&noise, &mut image);
            solve(&pencil, image, ACCURACY.inner, ACCURACY.inner_steps)
        })
        .collect();
    let Eigenpairs { vectors, .. } = smallest(&pencil, start, VECTORS, &ACCURACY, monitor)?;
    Ok(vectors.into_iter().map(|v| pencil.grid.to_blocks(&level.blocks, &v)).collect())
}
