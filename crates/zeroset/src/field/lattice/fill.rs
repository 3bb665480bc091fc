//! Signs for the nodes whose value is not known.

use rayon::prelude::*;

use super::LatticeField;
use crate::domain::{BLOCK_NODES, Mask, dilate, mask_get};

const ALL: Mask = [u64::MAX; 8];

impl LatticeField {
    /// The greatest absolute value that is known; the least positive number if there is none.
    pub(crate) fn greatest(&self) -> f32 {
        let of_block = |(values, known): (&[f32], &Mask)| {
            let own = values.iter().enumerate().filter(|(local, _)| mask_get(known, *local));
            own.fold(0.0, |most: f32, (_, value)| most.max(value.abs()))
        };
        let greatest =
            self.values.par_chunks_exact(BLOCK_NODES).zip(&self.known).map(of_block).reduce(|| 0.0, f32::max);
        greatest.max(f32::MIN_POSITIVE)
    }

    /// Gives the nodes of all blocks whose value is not known the greatest value that is, with the sign of the nearest node that has one, counted in
    /// steps along the axes.
    pub(crate) fn fill(&mut self) {
        let far = self.greatest();
        let mut inside = self.inside();
        let mut outside = self.known.clone();
        inside.par_iter_mut().zip(&mut outside).for_each(|(inside, outside)| {
            for z in 0..8 {
                inside[z] &= outside[z];
                outside[z] &= !inside[z];
            }
        });
        let missing = |inside: &[Mask], outside: &[Mask]| -> usize {
            let open = |(i, o): (&Mask, &Mask)| (0..8).map(|z| (i[z] | o[z]).count_zeros() as usize).sum::<usize>();
            inside.par_iter().zip(outside).map(open).sum()
        };
        let mut left = missing(&inside, &outside);
        while left > 0 {
            let (more_inside, more_outside) = (dilate(&self.blocks, &inside), dilate(&self.blocks, &outside));
            inside.par_iter_mut().zip(&mut outside).zip(more_inside.par_iter().zip(&more_outside)).for_each(
                |((inside, outside), (more_inside, more_outside))| {
                    for z in 0..8 {
                        let open = !(inside[z] | outside[z]);
                        outside[z] |= more_outside[z] & open;
                        inside[z] |= more_inside[z] & open & !more_outside[z];
                    }
                },
            );
            let now = missing(&inside, &outside);
            if now == left {
                // Nothing is known anywhere near.
                break;
            }
            left = now;
        }
        self.values.par_chunks_exact_mut(BLOCK_NODES).zip(&self.known).zip(&inside).for_each(
            |((values, known), inside)| {
                if *known == ALL {
                    return;
                }
                for (local, value) in values.iter_mut().enumerate() {
                    if !mask_get(known, local) {
                        *value = if mask_get(inside, local) { -far } else { far };
                    }
                }
            },
        );
    }
}
