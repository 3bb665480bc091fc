//! Polish: F becomes a distance, faces become flat, creases stay.
//!
//! # What
//! The cascade gives F like a blurred step, with a small ripple. The polish finds d near {F = 0}, in cells, and a field of unit
//! vectors N beside it that is smooth but for creases:
//!
//! ```text
//! minimise  alpha * sum_i w_i d(P_i)^2  +  4 alpha * integral of d^2 over facets and lines
//!           + sum_e (d_j - d_i - N_e)^2  +  lambda * sum_e rho(|N_j - N_i|)
//! ```
//!
//! over the lattice edges e = (i, j) of a band, N_e being the mean of N at both ends along the edge. With N eliminated this is an
//! order-2 energy: where N is free to follow grad d, only the change of the gradient costs.
//!
//! # How
//! The two unknowns take turns. For N: a few sweeps of weighted averaging with the gradient of d; rho is Geman and McClure's, so differences
//! beyond [`EDGE`] cost no more and creases are not smoothed away. For d: a screened Poisson equation, solved by conjugate gradients.
//! Data screen it everywhere on the surface, so the number of steps does not grow with the size of the lattice.
//!
//! # Source
//! The splitting of an order-2 energy is that of design section 2 (polish), made solvable; half-quadratic weights after Geman and
//! McClure 1987.

mod cut;
mod directions;
mod pieces;
mod start;

#[cfg(test)]
mod tests;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::level::{FixedFaces, Level, LevelParams, Nodes};
use super::operator::apply;
use super::solve::{SolveParams, conjugate_gradients};
use crate::domain::TETRAHEDRA;
use crate::domain::{
    Cells, Halo, Lattice, LatticePoints, Mask, barycentric, gather, halo_index, mask_get, tetrahedron_of,
};
use crate::field::LatticeField;
use crate::fit::Gradient;
use crate::monitor::{Cancelled, Monitor, check};
use directions::{Directions, smooth};
pub(super) use pieces::Piece;
use pieces::Pieces;
pub(crate) use pieces::{Held, OrientedTriangle};
use start::{Start, start};

/// How to polish.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PolishParams {
    /// The weight alpha of the data.
    pub screening: f64,
    /// The weight lambda of the smoothness.
    pub smoothness: f64,
    /// How often the two unknowns take turns.
    pub rounds: usize,
}

/// What a polish did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PolishReport {
    /// Nodes whose value was sought.
    pub free_nodes: u64,
    /// Steps of conjugate gradients in each round.
    pub solver_steps: Vec<usize>,
    /// |grad F| at the data, 5, 50 and 95 %.
    pub gradient_quantiles: [f64; 3],
    /// Wall time.
    pub seconds: f64,
}

/// When the equation for d counts as solved: the root of the mean square residual, in cells.
const SOLVE: SolveParams = SolveParams { tolerance: 1e-3, max_steps: 60 };
/// The weight of a squared cell of a facet, or of a cell's length of a line, over that of a cell with points: they are known better than
/// points.
const FACET: f32 = 4.0;
/// Points farther than this from the zero set, in cells, have been overruled by the cascade and stay so.
const FARTHEST: f32 = 1.5;

/// Polishes a field. `points` are those that pull at F; positions on what it is held to need not be among them.
pub(crate) fn polish(
    field: &LatticeField,
    points: &[[f64; 3]],
    held: Held<'_>,
    params: PolishParams,
    monitor: &dyn Monitor,
) -> Result<(LatticeField, PolishReport), Cancelled> {
    let clock = std::time::Instant::now();
    let Start { mut d, mut directions, known, free } = start(field, points, held);
    let near: Vec<[f64; 3]> = points.par_iter().copied().filter(|&p| is_near(field, &known, &d, p)).collect();
    let points = LatticePoints::new(&field.lattice, &near);
    drop(near);
    let finest = field.lattice.finest;
    let cells = Cells::new(&field.lattice, &points, finest);
    let pieces = Pieces::new(field, held, &directions, &d, &known);
    let nodes = Nodes { blocks: field.blocks.clone(), known: known.clone(), free, cells, columns: None };
    let level_params = LevelParams { alpha: params.screening as f32, faces: FixedFaces::None, column_prior: false };
    let mut level = Level::new(&field.lattice, &points, finest, nodes, &level_params);
    level.gradient = Gradient::Recovered;
    level.stencil.add(&level.blocks, &pieces.of_block, FACET * params.screening as f32);
    let n = level.len();
    let (mut r, mut p, mut q, mut s) = (vec![0.0_f32; n], vec![0.0_f32; n], vec![0.0_f32; n], vec![0.0_f32; n]);
    let scale = (level.free_nodes() as f64).sqrt();
    let mut solver_steps = Vec::with_capacity(params.rounds);
    for _ in 0..params.rounds {
        check(monitor)?;
        directions = smooth(&level, &d, directions, &pieces.pins, params.smoothness as f32, [&mut p, &mut q, &mut s]);
        extend(&level, &mut d, &directions);
        residual(&level, &d, &directions, &mut r, &mut q);
        solver_steps.push(conjugate_gradients(&level, &mut d, &mut r, [&mut p, &mut q, &mut s], scale, SOLVE));
    }
    let gradient_quantiles = super::gradient::gradient_lengths(&level, &d);
    let report = PolishReport {
        free_nodes: level.free_nodes(),
        solver_steps,
        gradient_quantiles,
        seconds: clock.elapsed().as_secs_f64(),
    };
    Ok((finish(field, &level, &d), report))
}

/// Whether a point is one that F still goes by.
fn is_near(field: &LatticeField, known: &[Mask], d: &[f32], p: [f64; 3]) -> bool {
    let lattice: &Lattice = &field.lattice;
    let shift = lattice.shift_at(lattice.finest);
    let fixed = lattice.fixed(p);
    let cell = fixed.map(|c| c >> shift);
    let fraction = fixed.map(|c| (c & ((1 << shift) - 1)) as f32 / (1_u32 << shift) as f32);
    let t = tetrahedron_of(fraction);
    let mut value = 0.0;
    for (corner, weight) in TETRAHEDRA[t].corners.into_iter().zip(barycentric(t, fraction)) {
        let node: [u32; 3] = std::array::from_fn(|a| cell[a] + (corner >> a & 1) as u32);
        let Some(b) = field.blocks.find(node.map(|c| c / 8)) else { return false };
        let local = (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as usize;
        if !mask_get(&known[b], local) {
            return false;
        }
        value += weight * d[b * 512 + local];
    }
    value.abs() < FARTHEST
}

/// Carries d from the free nodes to the fixed ones beside them.
fn extend(level: &Level, d: &mut [f32], directions: &Directions) {
    let old = d.to_vec();
    d.par_chunks_exact_mut(512).enumerate().with_min_len(8).for_each_init(
        || (Box::new([0.0_f32; 2304]), [(); 3].map(|()| Box::new([0.0_f32; 2304])), Box::new([0.0_f32; 2304])),
        |(values, vectors, freedom), (b, out)| {
            let rim: Mask = std::array::from_fn(|z| level.known[b][z] & !level.free[b][z]);
            if rim == [0; 8] {
                return;
            }
            let around = &level.blocks.neighbors[b];
            gather::<f32, 1, 1>(&old, around, 0.0, values);
            for (vector, component) in vectors.iter_mut().zip(&directions.0) {
                gather::<f32, 1, 1>(component, around, 0.0, vector);
            }
            gather_mask(level, b, &level.free, freedom);
            for local in (0..512).filter(|&local| mask_get(&rim, local)) {
                let at = halo_index((local & 7) as i32, (local >> 3 & 7) as i32, (local >> 6) as i32);
                let (mut sum, mut count) = (0.0, 0.0);
                for (axis, step) in [1, 16, 192].into_iter().enumerate() {
                    for (next, sign) in [(at - step, 1.0), (at + step, -1.0)] {
                        let slope = 0.5 * (vectors[axis][at] + vectors[axis][next]);
                        sum += freedom[next] * (values[next] + sign * slope);
                        count += freedom[next];
                    }
                }
                if count > 0.0 {
                    out[local] = sum / count;
                }
            }
        },
    );
}

/// 1 where a node is in the set, else 0.
fn gather_mask(level: &Level, b: usize, masks: &[Mask], halo: &mut Halo<f32>) {
    halo.fill(0.0);
    for (code, &other) in level.blocks.neighbors[b].iter().enumerate() {
        if other == crate::domain::NONE {
            continue;
        }
        let step = [code % 3, code / 3 % 3, code / 9].map(|s| 8 * (s as i32 - 1));
        let range = |a: usize| (-1 - step[a]).max(0)..(9 - step[a]).min(8);
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    if mask_get(&masks[other as usize], (x | y << 3 | z << 6) as usize) {
                        halo[halo_index(x + step[0], y + step[1], z + step[2])] = 1.0;
                    }
                }
            }
        }
    }
}

/// The residual of the equation for d, at the free nodes.
fn residual(level: &Level, d: &[f32], directions: &Directions, r: &mut [f32], q: &mut [f32]) {
    apply(level, d, q);
    r.par_chunks_exact_mut(512).zip(q.par_chunks_exact(512)).enumerate().with_min_len(8).for_each_init(
        || Box::new([0.0_f32; 2304]),
        |halo, (b, (r, q))| {
            r.fill(0.0);
            if level.free[b] == [0; 8] {
                return;
            }
            for (axis, step) in [1, 16, 192].into_iter().enumerate() {
                gather::<f32, 1, 1>(&directions.0[axis], &level.blocks.neighbors[b], 0.0, halo);
                for (row, r) in r.as_chunks_mut::<8>().0.iter_mut().enumerate() {
                    let at = halo_index(0, (row & 7) as i32, (row >> 3) as i32);
                    for (x, r) in r.iter_mut().enumerate() {
                        *r += 0.5 * (halo[at + x - step] - halo[at + x + step]);
                    }
                }
            }
            for (local, (r, q)) in r.iter_mut().zip(q).enumerate() {
                *r = if mask_get(&level.free[b], local) { *r - q } else { 0.0 };
            }
        },
    );
}

/// The polished field: d as a length near the zero set, and beyond it the sign of F at a constant distance.
fn finish(field: &LatticeField, level: &Level, d: &[f32]) -> LatticeField {
    let h = field.lattice.spacing as f32;
    let mut polished = field.clone();
    polished.values.par_chunks_exact_mut(512).enumerate().for_each(|(b, values)| {
        for (local, value) in values.iter_mut().enumerate() {
            if mask_get(&level.known[b], local) {
                *value = h * d[b * 512 + local];
            } else {
                *value = (4.0 * h).copysign(*value);
            }
        }
    });
    polished
}
