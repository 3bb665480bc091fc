//! Free scenes: which starts are tried once F has a sign, and which side of the whole is outside.
//!
//! # What
//! The first level starts from eigenvectors ([`super::eigen_seed`]). On later dense levels F is continued, and seeded anew by
//! potentials as objects and terrain are, from what F itself says of the faces of the box; where it says that they lie on both sides of the
//! surface, the faces are also tried as all outside, for a thin body that was a sheet on the coarser lattice. R chooses.
//!
//! # The sign of the whole
//! F and -F have the same R. If at least [`CLEAR`] of the nodes on the faces of the box lie on one side, this side is outside: a body.
//! Otherwise the surface cuts the box, as open ground does, and neither side is clearly outside: then the upper one is, by the moment of
//! the faces' signs along the last axis.
//!
//! # Not guaranteed
//! A sheet that stands upright has no upper side; its sign is arbitrary, but the same from run to run. Parts that lie apart each may
//! have a sign of their own.

use super::level::{FixedFaces, Level};
use super::seed::potential_between;
use crate::domain::mask_get;

/// Share of the faces' nodes on one side above which this side is outside.
///
/// A body has all of them outside. A city seen in the turned frame has 0.70 and 0.76 on one side, not always the upper one.
const CLEAR: f64 = 0.9;

/// Calls `visit(place in F, height of the node)` for the nodes on the faces of the box.
fn for_each_on_faces(level: &Level, mut visit: impl FnMut(usize, f64)) {
    for (b, corner) in level.blocks.coordinates.iter().enumerate() {
        let mask = FixedFaces::All.mask(&level.blocks, b);
        for local in (0..512).filter(|&local| mask_get(&mask, local)) {
            visit(b * 512 + local, f64::from(8 * corner[2]) + (local >> 6) as f64);
        }
    }
}

/// Starts on a dense level for an F that has been continued to it.
pub(super) fn potentials(level: &mut Level, continued: &[f32]) -> Vec<Vec<f32>> {
    let mut both = false;
    for_each_on_faces(level, |at, _| both |= continued[at] < 0.0);
    let mut starts = vec![potential_between(level, |at| continued[at] < 0.0)];
    if both {
        starts.push(potential_between(level, |_| false));
    }
    starts
}

/// Whether a share of the faces' nodes that are outside leaves no doubt.
pub(super) fn is_clear(share: f64) -> bool {
    share.max(1.0 - share) >= CLEAR
}

/// Gives F its sign, and returns the share of the faces' nodes that are outside.
pub(super) fn turn_outward(level: &Level, f: &mut [f32]) -> f64 {
    let middle = f64::from(8 * level.blocks.extent[2] - 1) / 2.0;
    let (mut nodes, mut outside, mut moment) = (0_u32, 0_u32, 0.0);
    for_each_on_faces(level, |at, height| {
        nodes += 1;
        outside += u32::from(f[at] > 0.0);
        moment += (height - middle) * f64::from(f[at].signum());
    });
    let share = f64::from(outside) / f64::from(nodes);
    let turn = if is_clear(share) { share < 0.5 } else { moment < 0.0 };
    if turn {
        f.iter_mut().for_each(|v| *v = -*v);
        return 1.0 - share;
    }
    share
}
