//! The sign of F on the first level: boundary potentials, pulled to zero at the data.
//!
//! F is held on some faces of the box, and pulled to its targets by the column prior where there is one; the energy is
//! minimised with no other driving term: field lines flood in from outside and stop at the data. In a deep cavity the field is exponentially weak; it is solved in f64, because the first step with
//! p = 1 asks for its direction only.

use super::level::{FixedFaces, Level};
use super::operator::apply;
use super::prior::{AIR, GAMMA};
use super::solve::{SolveParams, conjugate_gradients};
use crate::domain::mask_get;

/// Values on the faces of the box, zero elsewhere.
fn boundary_values(level: &Level, faces: FixedFaces) -> Vec<f64> {
    let outside = f64::from(AIR);
    let mut f = vec![0.0; level.len()];
    for b in 0..level.blocks.len() {
        let mask = faces.mask(&level.blocks, b);
        for local in 0..512 {
            if mask_get(&mask, local) {
                let below =
                    faces == FixedFaces::TopBottom && level.blocks.at_domain_face(b, 2, false) && local >> 6 == 0;
                f[b * 512 + local] = if below { -outside } else { outside };
            }
        }
    }
    f
}

/// The seed on a dense level.
pub(super) fn boundary_potential(level: &Level, faces: FixedFaces) -> Vec<f32> {
    potential(level, boundary_values(level, faces))
}

/// The seed on a dense level without fixed faces, if all of them were held, inside at the places that `is_inside` tells.
pub(super) fn potential_between(level: &mut Level, is_inside: impl Fn(usize) -> bool) -> Vec<f32> {
    let mut f = vec![0.0; level.len()];
    let mut free = Vec::with_capacity(level.blocks.len());
    for b in 0..level.blocks.len() {
        let mask = FixedFaces::All.mask(&level.blocks, b);
        for at in (0..512).filter(|&local| mask_get(&mask, local)).map(|local| b * 512 + local) {
            f[at] = f64::from(if is_inside(at) { -AIR } else { AIR });
        }
        free.push(mask.map(|w| !w));
    }
    let every = std::mem::replace(&mut level.free, free);
    let f = potential(level, f);
    level.free = every;
    f
}

/// The least energy with F held where it is not free.
fn potential(level: &Level, mut f: Vec<f64>) -> Vec<f32> {
    let [mut r, mut p, mut q, mut s] = std::array::from_fn(|_| vec![0.0; f.len()]);
    apply(level, &f, &mut q);
    for (r, q) in r.iter_mut().zip(&q) {
        *r = -q;
    }
    if let Some(prior) = &level.prior {
        for b in 0..level.blocks.len() {
            for local in 0..512 {
                let told = |mask| f64::from(u8::from(mask_get(mask, local)));
                r[b * 512 + local] += f64::from(GAMMA * AIR) * (told(&prior.air[b]) - told(&prior.solid[b]));
            }
        }
    }
    let scale = r.iter().map(|r| r * r).sum::<f64>().sqrt();
    let params = SolveParams { tolerance: 1e-8, max_steps: 1000 };
    conjugate_gradients(level, &mut f, &mut r, [&mut p, &mut q, &mut s], scale, params);
    f.into_iter().map(|v| v as f32).collect()
}
