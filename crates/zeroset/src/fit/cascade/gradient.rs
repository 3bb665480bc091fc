//! The gradient at the data, the normalisation N(F), and the right-hand side that is its transpose.
//!
//! Two gradients serve. The *element's* is that of F on the sample's own tetrahedron; it sees nothing beyond it, so two sheets a cell and
//! a half apart do not disturb each other. The *recovered* one takes central differences at the nodes and interpolates
//! them; it is smoother under noise, but across a thin wall it sees the far side, and the two sheets cancel. So the first
//! levels, which decide on inside and outside, use the element's, and later ones the recovered one, unless the body is
//! thin-walled. Both are linear in F, so N is convex and homogeneous with either.

use std::ops::Range;

use rayon::prelude::*;

use super::level::Level;
use super::operator::{LANES, Real, row_at};
use super::prior::{AIR, GAMMA};
use super::samples::Sample;
use crate::domain::{Halo, NONE, TETRAHEDRA, gather, halo_index, mask_row, neighbor_code};
use crate::fit::Gradient;

/// Nodes 0..=8 along each axis: those that the samples of one block reach.
const REACH: usize = 9 * 9 * 9;
/// Of these the nodes that belong to the blocks after it.
const RIM: usize = REACH - 512;

/// What one block's samples give to the nodes they reach, x + 9 y + 81 z: the vector sum of w b n of the recovered gradients by
/// component, or the finished right-hand side of the element gradients as the last one.
type Splat<T> = [[T; REACH]; 4];

/// The components of a [`Splat`] that a gradient fills.
fn components(gradient: Gradient) -> Range<usize> {
    match gradient {
        Gradient::Element => 3..4,
        Gradient::Recovered => 0..3,
    }
}

/// Place in a block's rim of a node of which a coordinate is 8.
#[inline(always)]
fn rim_index(x: usize, y: usize, z: usize) -> usize {
    match (y, z) {
        (_, 8) => x + 9 * y,
        (8, _) => 81 + x + 9 * z,
        _ => 153 + y + 8 * z,
    }
}

/// Freezes n_i = g_i / |g_i| and sums w_i n_i to the nodes; returns N(F) = sum w |g| + gamma sum t F.
///
/// `vectors` is scratch for the three components; `rhs` receives the right-hand side div(sum w n delta) + gamma t at the free
/// nodes. Both in a fixed order: a block's own samples, then those of the seven blocks before it.
pub(super) fn linearise<T: Real>(level: &Level, f: &[T], mut vectors: [&mut [T]; 3], rhs: &mut [T]) -> f64 {
    let (rims, partial): (Vec<Box<[T]>>, Vec<f64>) = by_block(&mut vectors, rhs)
        .enumerate()
        .with_min_len(8)
        .map_init(
            || ([T::default(); 2304], [[T::default(); REACH]; 4]),
            |(halo, splat), (b, out)| own_samples(level, b, f, halo, splat, out),
        )
        .unzip();
    let data = partial.into_iter().sum::<f64>();
    by_block(&mut vectors, rhs).enumerate().with_min_len(16).for_each(|(b, out)| add_rims(level, b, &rims, out));
    drop(rims);
    data + right_hand_side(level, f, vectors.map(|v| &*v), rhs)
}

/// The three components and the right-hand side of each block.
fn by_block<'a, T: Real>(
    [x, y, z]: &'a mut [&mut [T]; 3],
    rhs: &'a mut [T],
) -> impl IndexedParallelIterator<Item = [&'a mut [T]; 4]> {
    x.par_chunks_exact_mut(512)
        .zip(y.par_chunks_exact_mut(512))
        .zip(z.par_chunks_exact_mut(512).zip(rhs.par_chunks_exact_mut(512)))
        .map(|((x, y), (z, rhs))| [x, y, z, rhs])
}

/// The gradient at a sample, in cells.
#[inline(always)]
fn gradient_at<T: Real>(halo: &Halo<T>, sample: &Sample, gradient: Gradient) -> [T; 3] {
    let mut g = [T::default(); 3];
    let nodes = nodes_of(sample);
    match gradient {
        Gradient::Element => {
            for (s, axis) in TETRAHEDRA[usize::from(sample.tetrahedron)].axes.into_iter().enumerate() {
                g[axis] = halo[nodes[s + 1]] - halo[nodes[s]];
            }
        }
        Gradient::Recovered => {
            for (at, weight) in nodes.into_iter().zip(sample.barycentric) {
                for (axis, step) in [1, 16, 192].into_iter().enumerate() {
                    g[axis] += T::from(0.5 * weight) * (halo[at + step] - halo[at - step]);
                }
            }
        }
    }
    g
}

/// The four nodes of a sample's tetrahedron in the halo.
#[inline(always)]
fn nodes_of(sample: &Sample) -> [usize; 4] {
    let local = sample.local;
    let origin = [local & 7, local >> 3 & 7, local >> 6].map(i32::from);
    TETRAHEDRA[usize::from(sample.tetrahedron)].corners.map(|corner| {
        let [x, y, z]: [i32; 3] = std::array::from_fn(|a| origin[a] + (corner >> a & 1) as i32);
        halo_index(x, y, z)
    })
}

/// Sums one block's samples; returns sum w |g|. The transpose of [`gradient_at`] begins here: for the recovered gradient vectors are summed, and
/// differences taken later; for the element's the differences are taken at once and fill the last component.
fn splat_block<T: Real>(halo: &Halo<T>, samples: &[Sample], gradient: Gradient, splat: &mut Splat<T>) -> f64 {
    let mut sum = 0.0_f64;
    for sample in samples {
        let g = gradient_at(halo, sample, gradient);
        let length = (g[0] * g[0] + g[1] * g[1] + g[2] * g[2]).root();
        if length <= T::default() {
            continue;
        }
        let weight = T::from(sample.weight);
        sum += (weight * length).into();
        let n = g.map(|c| weight * (c / length));
        let local = sample.local;
        let origin = usize::from(local & 7) + 9 * usize::from(local >> 3 & 7) + 81 * usize::from(local >> 6);
        let tetrahedron = TETRAHEDRA[usize::from(sample.tetrahedron)];
        let nodes =
            tetrahedron.corners.map(|corner| origin + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2));
        match gradient {
            Gradient::Element => {
                for (s, axis) in tetrahedron.axes.into_iter().enumerate() {
                    splat[3][nodes[s + 1]] += n[axis];
                    splat[3][nodes[s]] -= n[axis];
                }
            }
            Gradient::Recovered => {
                for (node, weight) in nodes.into_iter().zip(sample.barycentric) {
                    for axis in 0..3 {
                        splat[axis][node] += T::from(weight) * n[axis];
                    }
                }
            }
        }
    }
    sum
}

/// Gives block `b` what its own samples bear; returns what they give to the blocks after it, and sum w |g|.
fn own_samples<T: Real>(
    level: &Level,
    b: usize,
    f: &[T],
    halo: &mut Halo<T>,
    splat: &mut Splat<T>,
    mut out: [&mut [T]; 4],
) -> (Box<[T]>, f64) {
    let components = components(level.gradient);
    let d = level.data_block[b];
    if d == NONE {
        out.iter_mut().for_each(|component| component.fill(T::default()));
        return (Box::default(), 0.0);
    }
    gather::<T, 1, 2>(f, &level.blocks.neighbors[b], T::default(), halo);
    splat[components.clone()].fill([T::default(); REACH]);
    let sum = splat_block(halo, &level.samples.of_block[d as usize], level.gradient, splat);
    out[3].fill(T::default());
    let mut rim = vec![T::default(); components.len() * RIM].into_boxed_slice();
    for (c, rim) in components.zip(rim.chunks_exact_mut(RIM)) {
        for (row, own) in out[c].chunks_exact_mut(8).enumerate() {
            let from = 9 * (row & 7) + 81 * (row >> 3);
            own.copy_from_slice(&splat[c][from..from + 8]);
        }
        for i in 0..9 {
            for j in 0..9 {
                rim[rim_index(i, j, 8)] = splat[c][i + 9 * j + 81 * 8];
                rim[rim_index(i, 8, j)] = splat[c][i + 9 * 8 + 81 * j];
                rim[rim_index(8, i, j)] = splat[c][8 + 9 * i + 81 * j];
            }
        }
    }
    (rim, sum)
}

/// Adds to block `b` what the samples of the seven blocks before it give to its first layers.
fn add_rims<T: Real>(level: &Level, b: usize, rims: &[Box<[T]>], out: [&mut [T]; 4]) {
    for before in 1..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| -((before >> a & 1) as i32));
        let other = level.blocks.neighbors[b][neighbor_code(step)];
        if other == NONE {
            continue;
        }
        let range = |a: usize| if before >> a & 1 == 1 { 8..9 } else { 0..8 };
        for (c, rim) in components(level.gradient).zip(rims[other as usize].chunks_exact(RIM)) {
            for z in range(2) {
                for y in range(1) {
                    for x in range(0) {
                        out[c][(x & 7) + 8 * (y & 7) + 64 * (z & 7)] += rim[rim_index(x, y, z)];
                    }
                }
            }
        }
    }
}

/// Ends the transpose of [`gradient_at`]: adds to `rhs` the sum over axes of (V(q - e) - V(q + e)) / 2 and gamma t, all at the free
/// nodes. Returns gamma sum t F.
fn right_hand_side<T: Real>(level: &Level, f: &[T], vectors: [&[T]; 3], rhs: &mut [T]) -> f64 {
    let partial: Vec<f64> = rhs
        .par_chunks_exact_mut(512)
        .enumerate()
        .with_min_len(8)
        .map_init(
            || [T::default(); 2304],
            |halo, (b, rhs)| {
                let free = &level.free[b];
                let neighbors = &level.blocks.neighbors[b];
                if neighbors.iter().any(|&n| n != NONE && level.data_block[n as usize] != NONE) {
                    if level.gradient == Gradient::Recovered {
                        add_differences(vectors, neighbors, halo, rhs);
                    }
                    for row in 0..64 {
                        let lanes = &LANES[mask_row(free, row & 7, row >> 3) as usize];
                        for k in 0..8 {
                            rhs[row * 8 + k] *= T::from(lanes[k]);
                        }
                    }
                }
                level.prior.as_ref().map_or(0.0, |prior| {
                    let mut told = T::default();
                    for row in 0..64 {
                        let (y, z) = (row & 7, row >> 3);
                        let (air, solid) = (mask_row(&prior.air[b], y, z), mask_row(&prior.solid[b], y, z));
                        if air | solid == 0 {
                            continue;
                        }
                        for k in 0..8 {
                            let target = T::from(GAMMA * AIR * (LANES[air as usize][k] - LANES[solid as usize][k]));
                            rhs[row * 8 + k] += target;
                            told += target * f[b * 512 + row * 8 + k];
                        }
                    }
                    told.into()
                })
            },
        )
        .collect();
    partial.into_iter().sum()
}

fn add_differences<T: Real>(vectors: [&[T]; 3], neighbors: &[u32; 27], halo: &mut Halo<T>, rhs: &mut [T]) {
    for (v, step) in vectors.into_iter().zip([1, 16, 192]) {
        gather::<T, 1, 1>(v, neighbors, T::default(), halo);
        for row in 0..64 {
            let at = halo_index(0, (row & 7) as i32, (row >> 3) as i32);
            let (before, after) = (row_at(halo, at - step), row_at(halo, at + step));
            for k in 0..8 {
                rhs[row * 8 + k] += T::from(0.5) * (before[k] - after[k]);
            }
        }
    }
}

/// The quantiles (5, 50, 95 %) of |g| at the samples, relative to their largest: 1 where the sheet is resolved, small where
/// two sheets cancel.
pub(super) fn gradient_lengths(level: &Level, f: &[f32]) -> [f64; 3] {
    let mut lengths: Vec<f32> = (0..level.cells.block_keys.len())
        .into_par_iter()
        .map_init(
            || [0.0_f32; 2304],
            |halo, d| {
                let b = level.blocks.keys.binary_search(&level.cells.block_keys[d]).expect("a block of data is stored");
                gather::<f32, 1, 2>(f, &level.blocks.neighbors[b], 0.0, halo);
                let length = |s| gradient_at(halo, s, level.gradient).iter().map(|c| c * c).sum::<f32>().sqrt();
                level.samples.of_block[d].iter().map(length).collect::<Vec<_>>()
            },
        )
        .flatten_iter()
        .collect();
    lengths.par_sort_unstable_by(f32::total_cmp);
    let at = |share: f64| f64::from(lengths[((lengths.len() - 1) as f64 * share) as usize]);
    if lengths.is_empty() { [0.0; 3] } else { [at(0.05), at(0.5), at(0.95)] }
}

/// The share of samples at which the two gradients disagree because a second sheet is near.
pub(super) fn thin_share(level: &Level, f: &[f32]) -> f64 {
    let blocks = &level.blocks;
    let (thin, all) = level
        .samples
        .of_block
        .par_iter()
        .zip(&level.cells.block_keys)
        .map_init(
            || [0.0_f32; 2304],
            |halo, (samples, key)| {
                let b = blocks.keys.binary_search(key).expect("a block of data is stored");
                gather::<f32, 1, 2>(f, &blocks.neighbors[b], 0.0, halo);
                let is_thin = |s: &&Sample| {
                    !agree(gradient_at(halo, s, Gradient::Element), gradient_at(halo, s, Gradient::Recovered))
                };
                (samples.iter().filter(is_thin).count(), samples.len())
            },
        )
        .reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
    thin as f64 / all.max(1) as f64
}

/// Whether the recovered gradient points within 70 degrees of the element's and is at least a fifth as long: across a thin wall it turns
/// over or nearly vanishes, while noise turns it by a few degrees.
fn agree(element: [f32; 3], recovered: [f32; 3]) -> bool {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let along = dot(element, recovered);
    let (ee, rr) = (dot(element, element), dot(recovered, recovered));
    along > 0.0 && along * along >= 0.1 * ee * rr && rr >= 0.04 * ee
}
