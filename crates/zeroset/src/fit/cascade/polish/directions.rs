//! The field of unit vectors: smooth, but for creases.

use rayon::prelude::*;

use super::super::level::Level;
use super::gather_mask;
use super::pieces::Pins;
use crate::domain::{gather, halo_index, mask_get};

/// One vector a node, by component.
#[derive(Debug, Clone)]
pub(super) struct Directions(pub(super) [Vec<f32>; 3]);

/// Neighbours whose vectors differ by more than this belong to two faces: 17 degrees a cell.
const EDGE: f32 = 0.3;
/// Sweeps of averaging in each round.
const SWEEPS: usize = 4;

/// Averages the vectors with the gradient of d and with each other.
pub(super) fn smooth(
    level: &Level,
    d: &[f32],
    directions: Directions,
    pins: &Pins,
    smoothness: f32,
    mut gradient: [&mut Vec<f32>; 3],
) -> Directions {
    gradients(level, d, &directions, &mut gradient);
    let mut current = directions;
    for _ in 0..SWEEPS {
        let mut next = current.clone();
        let [x, y, z] = &mut next.0;
        x.par_chunks_exact_mut(512)
            .zip(y.par_chunks_exact_mut(512).zip(z.par_chunks_exact_mut(512)))
            .enumerate()
            .with_min_len(8)
            .for_each_init(
                || ([(); 3].map(|()| Box::new([0.0_f32; 2304])), Box::new([0.0_f32; 2304])),
                |(vectors, present), (b, (x, (y, z)))| {
                    if level.known[b] == [0; 8] {
                        return;
                    }
                    let around = &level.blocks.neighbors[b];
                    for (vector, component) in vectors.iter_mut().zip(&current.0) {
                        gather::<f32, 1, 1>(component, around, 0.0, vector);
                    }
                    gather_mask(level, b, &level.known, present);
                    for local in (0..512).filter(|&local| mask_get(&level.known[b], local)) {
                        let at = halo_index((local & 7) as i32, (local >> 3 & 7) as i32, (local >> 6) as i32);
                        let own: [f32; 3] = std::array::from_fn(|a| vectors[a][at]);
                        let mut sum = [0.0; 3];
                        if mask_get(&level.free[b], local) {
                            (0..3).for_each(|a| sum[a] = gradient[a][b * 512 + local]);
                        }
                        if let Some(pin) = pins.at(b, local) {
                            (0..3).for_each(|a| sum[a] += pin[a]);
                        }
                        for step in [-1_isize, 1, -16, 16, -192, 192] {
                            let next = at.wrapping_add_signed(step);
                            let difference: f32 = (0..3).map(|a| (vectors[a][next] - own[a]).powi(2)).sum();
                            let excess = 1.0 + difference / (EDGE * EDGE);
                            let weight = smoothness * present[next] / (excess * excess);
                            (0..3).for_each(|a| sum[a] += weight * vectors[a][next]);
                        }
                        let length = (sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]).sqrt();
                        if length > 0.0 {
                            (x[local], y[local], z[local]) = (sum[0] / length, sum[1] / length, sum[2] / length);
                        }
                    }
                },
            );
        current = next;
    }
    current
}

/// Central differences of d at the free nodes.
fn gradients(level: &Level, d: &[f32], _directions: &Directions, out: &mut [&mut Vec<f32>; 3]) {
    for (axis, out) in out.iter_mut().enumerate() {
        let step = [1, 16, 192][axis];
        out.par_chunks_exact_mut(512).enumerate().with_min_len(8).for_each_init(
            || Box::new([0.0_f32; 2304]),
            |halo, (b, out)| {
                out.fill(0.0);
                if level.free[b] == [0; 8] {
                    return;
                }
                gather::<f32, 1, 1>(d, &level.blocks.neighbors[b], 0.0, halo);
                for (local, out) in out.iter_mut().enumerate() {
                    let at = halo_index((local & 7) as i32, (local >> 3 & 7) as i32, (local >> 6) as i32);
                    *out = 0.5 * (halo[at + step] - halo[at - step]);
                }
            },
        );
    }
}
