//! Sets of nodes of a block, one bit a node.

use super::{Blocks, NONE, neighbor_code};
use rayon::prelude::*;

/// A set of the 512 nodes of a block: word z, byte y, bit x.
pub type Mask = [u64; 8];

const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;
const LAST_COLUMN: u64 = 0x8080_8080_8080_8080;

/// The eight bits of row (y, z).
#[inline]
#[must_use]
pub fn mask_row(mask: &Mask, y: usize, z: usize) -> u8 {
    (mask[z] >> (8 * y)) as u8
}

/// Whether node `local` (`x | y << 3 | z << 6`) is in the set.
#[inline]
#[must_use]
pub fn mask_get(mask: &Mask, local: usize) -> bool {
    mask[local >> 6] >> (local & 63) & 1 == 1
}

/// Number of nodes in the set.
#[must_use]
pub fn mask_count(mask: &Mask) -> usize {
    mask.iter().map(|word| word.count_ones() as usize).sum()
}

/// Puts node `local` into the set.
#[inline]
pub fn mask_set(mask: &mut Mask, local: usize) {
    mask[local >> 6] |= 1 << (local & 63);
}

/// The nodes of block `b` whose neighbour one step along `axis`, ahead (`true`) or behind, is in the set.
pub(crate) fn shifted(blocks: &Blocks, masks: &[Mask], b: usize, axis: usize, ahead: bool) -> Mask {
    let mut step = [0_i32; 3];
    step[axis] = if ahead { 1 } else { -1 };
    let other = blocks.neighbors[b][neighbor_code(step)];
    let far = if other == NONE { [0; 8] } else { masks[other as usize] };
    shift(&masks[b], &far, axis, ahead)
}

/// The nodes whose neighbour one step along `axis` is in the set, given the set in the block and in the one on that side.
pub(crate) fn shift(own: &Mask, far: &Mask, axis: usize, ahead: bool) -> Mask {
    std::array::from_fn(|z| match (axis, ahead) {
        (0, true) => (own[z] & !FIRST_COLUMN) >> 1 | (far[z] & FIRST_COLUMN) << 7,
        (0, false) => (own[z] & !LAST_COLUMN) << 1 | (far[z] & LAST_COLUMN) >> 7,
        (1, true) => own[z] >> 8 | far[z] << 56,
        (1, false) => own[z] << 8 | far[z] >> 56,
        (_, true) => {
            if z < 7 {
                own[z + 1]
            } else {
                far[0]
            }
        }
        (_, false) => {
            if z > 0 {
                own[z - 1]
            } else {
                far[7]
            }
        }
    })
}

/// Grows a set by one step along each axis, across the faces of the blocks that are there.
#[must_use]
pub fn dilate(blocks: &Blocks, masks: &[Mask]) -> Vec<Mask> {
    (0..masks.len())
        .into_par_iter()
        .map(|b| {
            let mut grown = masks[b];
            for axis in 0..3 {
                for ahead in [false, true] {
                    let moved = shifted(blocks, masks, b, axis, ahead);
                    for z in 0..8 {
                        grown[z] |= moved[z];
                    }
                }
            }
            grown
        })
        .collect()
}

/// Grows a set by one step in all 26 directions, across the blocks that are there.
#[must_use]
pub fn dilate_box(blocks: &Blocks, masks: &[Mask]) -> Vec<Mask> {
    let mut grown = masks.to_vec();
    for axis in 0..3 {
        grown = (0..masks.len())
            .into_par_iter()
            .map(|b| {
                let (behind, ahead) = (shifted(blocks, &grown, b, axis, false), shifted(blocks, &grown, b, axis, true));
                std::array::from_fn(|z| grown[b][z] | behind[z] | ahead[z])
            })
            .collect();
    }
    grown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::block_key;

    #[test]
    fn dilation_grows_an_octahedron_across_blocks() {
        let mut keys: Vec<u64> = (0..27).map(|i| block_key([i % 3, i / 3 % 3, i / 9])).collect();
        keys.sort_unstable();
        let blocks = Blocks::new(keys, [3, 3, 3]);
        let mut masks = vec![[0; 8]; 27];
        let centre = [8_i32, 15, 12];
        let place = |n: [i32; 3]| {
            let b = blocks.find(n.map(|c| c as u32 / 8)).unwrap();
            (b, (n[0] & 7 | (n[1] & 7) << 3 | (n[2] & 7) << 6) as usize)
        };
        let (b, local) = place(centre);
        mask_set(&mut masks[b], local);
        for _ in 0..4 {
            masks = dilate(&blocks, &masks);
        }
        for x in 0..24 {
            for y in 0..24 {
                for z in 0..24 {
                    let (b, local) = place([x, y, z]);
                    let far = (x - centre[0]).abs() + (y - centre[1]).abs() + (z - centre[2]).abs();
                    assert_eq!(mask_get(&masks[b], local), far <= 4, "{x} {y} {z}");
                }
            }
        }
    }
}
