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
    let split = |c: i32| {
        if c < 0 {
            (0, c + 8)
        } else if c > 7 {
            (2, c - 8)
        } else {
            (1, c)
        }
    };
    let range = -(BELOW as i32)..8 + ABOVE as i32;
    for z in range.clone() {
        let (block_z, local_z) = split(z);
        for y in range.clone() {
            let (block_y, local_y) = split(y);
            let code = 3 * block_y + 9 * block_z;
            let row = (local_y * 8 + local_z * 64) as usize;
            let to = halo_index(0, y, z);
            let west = neighbors[code];
            if west == NONE {
                halo[to - BELOW..to].fill(missing);
            } else {
                let from = west as usize * 512 + row + 8;
                halo[to - BELOW..to].copy_from_slice(&values[from - BELOW..from]);
            }
            let own = neighbors[code + 1];
            if own == NONE {
                halo[to..to + 8].fill(missing);
            } else {
                let from = own as usize * 512 + row;
                halo[to..to + 8].copy_from_slice(&values[from..from + 8]);
            }
            let east = neighbors[code + 2];
            if east == NONE {
                halo[to + 8..to + 8 + ABOVE].fill(missing);
            } else {
                let from = east as usize * 512 + row;
                halo[to + 8..to + 8 + ABOVE].copy_from_slice(&values[from..from + ABOVE]);
            }
        }
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
