//! A block's values with those around it, copied into one small array so that stencils need no case analysis.

use super::{Blocks, NONE};

/// Row length of the buffer; nodes -2..=9 of each axis fit, x = 0 stands at column 4.
const ROW: usize = 16;
const SLAB: usize = 12 * ROW;

/// Values at nodes -2..=9 along each axis of a block.
pub(crate) type Halo<T> = [T; 12 * SLAB];

/// Place in the buffer of a node relative to the block, each coordinate in -2..=9.
#[inline]
pub(crate) fn halo_index(x: i32, y: i32, z: i32) -> usize {
    ((z + 2) as usize) * SLAB + ((y + 2) as usize) * ROW + (x + 4) as usize
}

/// Copies nodes `-BELOW..8 + ABOVE` of each axis into the buffer. Nodes of blocks that are not there become `missing`.
#[inline]
pub(crate) fn gather<T: Copy, const BELOW: usize, const ABOVE: usize>(
    values: &[T],
    neighbors: &[u32; 27],
    missing: T,
    halo: &mut Halo<T>,
) {
    // Where a block behind, the block itself and the one ahead begin in the buffer, and which of their layers are copied.
    let parts = [(-8, 8 - BELOW..8), (0, 0..8), (8, 0..ABOVE)];
    for (code, sides) in neighbors.chunks_exact(3).enumerate() {
        let ((y, rows), (z, slabs)) = (&parts[code % 3], &parts[code / 3]);
        let block = |side: usize| {
            let first = sides[side] as usize * 512;
            (sides[side] != NONE).then(|| &values[first..first + 512])
        };
        let (west, own, east) = (block(0), block(1), block(2));
        for local_z in slabs.clone() {
            for local_y in rows.clone() {
                let from = local_y * 8 + local_z * 64;
                let to = halo_index(0, y + local_y as i32, z + local_z as i32);
                let target = &mut halo[to - 4..to + 12];
                copy_or_fill(&mut target[4 - BELOW..4], west.map(|w| &w[from + 8 - BELOW..from + 8]), missing);
                copy_or_fill(&mut target[4..12], own.map(|o| &o[from..from + 8]), missing);
                copy_or_fill(&mut target[12..12 + ABOVE], east.map(|e| &e[from..from + ABOVE]), missing);
            }
        }
    }
}

#[inline(always)]
fn copy_or_fill<T: Copy>(target: &mut [T], source: Option<&[T]>, missing: T) {
    match source {
        Some(source) => target.copy_from_slice(source),
        None => target.fill(missing),
    }
}

/// Repeats the outermost layer of nodes beyond the faces of the domain: differences across them vanish (Neumann).
#[inline]
pub(crate) fn replicate_at_domain_faces<T: Copy>(blocks: &Blocks, b: usize, halo: &mut Halo<T>) {
    for axis in 0..3 {
        for far in [false, true] {
            if !blocks.at_domain_face(b, axis, far) {
                continue;
            }
            let (inside, outside) = if far { (7, 8) } else { (0, -1) };
            for u in 0..8 {
                for v in 0..8 {
                    let at = |w: i32| match axis {
                        0 => halo_index(w, u, v),
                        1 => halo_index(u, w, v),
                        _ => halo_index(u, v, w),
                    };
                    halo[at(outside)] = halo[at(inside)];
                }
            }
        }
    }
}
