//! The first d: F over the length of its gradient beside the zero set, and from there layer by layer.

use rayon::prelude::*;

use super::directions::Directions;
use super::pieces::Held;
use crate::domain::{Mask, bounds, gather, halo_index, mask_get, mask_set};
use crate::field::LatticeField;
use crate::vec3::Vec3;

/// Layers of nodes beyond those at either end of a crossed edge.
const LAYERS: usize = 3;
/// How far beyond the box of the data F is polished, in cells.
const MARGIN: f64 = 6.0;
/// The farthest that a node at the end of a crossed edge is taken to be, in cells.
const FARTHEST: f32 = 1.5;

/// Where the polish begins.
pub(super) struct Start {
    /// Distances in cells; zero where not known.
    pub(super) d: Vec<f32>,
    /// Unit vectors beside them.
    pub(super) directions: Directions,
    /// Nodes with a distance.
    pub(super) known: Vec<Mask>,
    /// Those of them whose six neighbours all have one.
    pub(super) free: Vec<Mask>,
}

/// Steps in the halo to the six neighbours, with axis and sign.
const NEIGHBOURS: [(isize, usize, f32); 6] =
    [(-1, 0, -1.0), (1, 0, 1.0), (-16, 1, -1.0), (16, 1, 1.0), (-192, 2, -1.0), (192, 2, 1.0)];

pub(super) fn start(field: &LatticeField, points: &[Vec3], held: Held<'_>) -> Start {
    let blocks = &field.blocks;
    let reached = reached(field, points, held);
    let mut f = field.values.clone();
    f.par_chunks_exact_mut(512).enumerate().for_each(|(b, f)| {
        for (local, f) in f.iter_mut().enumerate() {
            if !mask_get(&field.known[b], local) {
                *f = f32::NAN;
            }
        }
    });
    let n = f.len();
    // NaN marks a node that has no distance yet.
    let mut d = vec![f32::NAN; n];
    let mut vectors = [vec![0.0_f32; n], vec![0.0_f32; n], vec![0.0_f32; n]];
    for_nodes(&mut d, &mut vectors, |b, d, vectors| {
        if !reached[b] {
            return;
        }
        let mut halo = [f32::NAN; 2304];
        gather::<f32, 1, 1>(&f, &blocks.neighbors[b], f32::NAN, &mut halo);
        for local in 0..512 {
            let at = place(local);
            let here = halo[at];
            let crosses = NEIGHBOURS.iter().any(|&(step, ..)| {
                let there = halo[at.wrapping_add_signed(step)];
                !there.is_nan() && (there < 0.0) != (here < 0.0)
            });
            if here.is_nan() || !crosses {
                continue;
            }
            let g: [f32; 3] = std::array::from_fn(|a| {
                let step = [1, 16, 192][a];
                let (before, after) = (halo[at - step], halo[at + step]);
                match (before.is_nan(), after.is_nan()) {
                    (false, false) => 0.5 * (after - before),
                    (true, false) => after - here,
                    (false, true) => here - before,
                    (true, true) => 0.0,
                }
            });
            let length = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).sqrt();
            if length > 0.0 {
                d[local] = (here / length).clamp(-FARTHEST, FARTHEST);
                (0..3).for_each(|a| vectors[a][local] = g[a] / length);
            }
        }
    });
    for _ in 0..LAYERS {
        let (old, old_vectors) = (d.clone(), vectors.clone());
        for_nodes(&mut d, &mut vectors, |b, d, vectors| {
            if d.iter().all(|d| !d.is_nan()) {
                return;
            }
            let around = &blocks.neighbors[b];
            let mut halo = [f32::NAN; 2304];
            gather::<f32, 1, 1>(&old, around, f32::NAN, &mut halo);
            let mut beside = [[0.0; 2304]; 3];
            for (vector, component) in beside.iter_mut().zip(&old_vectors) {
                gather::<f32, 1, 1>(component, around, 0.0, vector);
            }
            for local in 0..512 {
                let f = f[b * 512 + local];
                if !d[local].is_nan() || f.is_nan() {
                    continue;
                }
                let at = place(local);
                let (mut sum, mut count, mut vector) = (0.0, 0.0, [0.0; 3]);
                for (step, axis, sign) in NEIGHBOURS {
                    let next = at.wrapping_add_signed(step);
                    if !halo[next].is_nan() {
                        sum += halo[next] - sign * beside[axis][next];
                        count += 1.0;
                        (0..3).for_each(|a| vector[a] += beside[a][next]);
                    }
                }
                let length = (vector[0] * vector[0] + vector[1] * vector[1] + vector[2] * vector[2]).sqrt();
                if count > 0.0 && length > 0.0 {
                    d[local] = (sum / count).abs().max(0.5).copysign(f);
                    (0..3).for_each(|a| vectors[a][local] = vector[a] / length);
                }
            }
        });
    }
    let (known, free): (Vec<Mask>, Vec<Mask>) = (0..blocks.len())
        .into_par_iter()
        .map(|b| {
            let mut halo = [f32::NAN; 2304];
            gather::<f32, 1, 1>(&d, &blocks.neighbors[b], f32::NAN, &mut halo);
            let (mut known, mut free) = ([0; 8], [0; 8]);
            for local in 0..512 {
                let at = place(local);
                if !halo[at].is_nan() {
                    mask_set(&mut known, local);
                    if NEIGHBOURS.iter().all(|&(step, ..)| !halo[at.wrapping_add_signed(step)].is_nan()) {
                        mask_set(&mut free, local);
                    }
                }
            }
            (known, free)
        })
        .unzip();
    d.par_iter_mut().for_each(|d| *d = if d.is_nan() { 0.0 } else { *d });
    Start { d, directions: Directions(vectors), known, free }
}

/// The blocks within the box of all data and a little beyond: around open ground the zero set goes on to the faces of the domain, where nobody
/// looks at it.
fn reached(field: &LatticeField, points: &[Vec3], held: Held<'_>) -> Vec<bool> {
    let corners = held.reach.into_iter().flatten();
    let (low, high) = bounds(points.iter().copied().chain(held.corners()).chain(corners));
    let lattice = &field.lattice;
    let in_cells = |p: f64, a: usize| (p - lattice.origin[a]) / lattice.spacing;
    let inside = |c: &[u32; 3]| {
        (0..3).all(|a| {
            let first = f64::from(8 * c[a]);
            first + 8.0 > in_cells(low[a], a) - MARGIN && first < in_cells(high[a], a) + MARGIN
        })
    };
    field.blocks.coordinates.iter().map(inside).collect()
}

/// Place of a node in the halo.
fn place(local: usize) -> usize {
    halo_index((local & 7) as i32, (local >> 3 & 7) as i32, (local >> 6) as i32)
}

/// Calls `visit` with each block's values and vectors.
fn for_nodes(d: &mut [f32], [x, y, z]: &mut [Vec<f32>; 3], visit: impl Fn(usize, &mut [f32], [&mut [f32]; 3]) + Sync) {
    d.par_chunks_exact_mut(512)
        .zip(x.par_chunks_exact_mut(512))
        .zip(y.par_chunks_exact_mut(512).zip(z.par_chunks_exact_mut(512)))
        .enumerate()
        .with_min_len(8)
        .for_each(|(b, ((d, x), (y, z)))| visit(b, d, [x, y, z]));
}
