//! A fitted F: values on the nodes of a sparse lattice, linear on each tetrahedron.

mod cover;
mod fill;
mod solid;

use rayon::prelude::*;

use crate::domain::{BLOCK_NODES, Blocks, Lattice, Mask, block_of_key, mask_count, mask_get};
pub use solid::LatticeSolid;

/// A fitted function, known in a band around the surface.
#[derive(Debug, Clone)]
pub struct LatticeField {
    /// Placement of the lattice.
    pub lattice: Lattice,
    /// The blocks of the finest level that are stored.
    pub blocks: Blocks,
    /// The nodes of each block whose value is known.
    pub known: Vec<Mask>,
    /// 512 values a block, x fastest.
    pub values: Vec<f32>,
}

impl LatticeField {
    pub(crate) fn new(lattice: Lattice, blocks: Blocks, known: Vec<Mask>, values: Vec<f32>) -> Self {
        Self { lattice, blocks, known, values }
    }

    /// A field from what is kept of it: the keys of its blocks, ascending, the nodes whose value is known, the nodes among the others that are inside, and the
    /// values that are known, block by block.
    ///
    /// # Errors
    /// What is wrong, if the lists do not fit together.
    pub fn from_packed(
        lattice: Lattice,
        keys: Vec<u64>,
        known: Vec<Mask>,
        inside: &[Mask],
        packed: &[f32],
    ) -> Result<Self, &'static str> {
        let extent = lattice.blocks_at(lattice.finest);
        if known.len() != keys.len() || inside.len() != keys.len() {
            return Err("it has not one set of nodes for each block");
        }
        if !keys.is_sorted_by(|a, b| a < b) {
            return Err("the keys of its blocks do not ascend");
        }
        if keys.iter().any(|&key| key >> 63 != 0 || (0..3).any(|a| block_of_key(key)[a] >= extent[a])) {
            return Err("a block lies outside of its lattice");
        }
        let counts: Vec<usize> = known.iter().map(mask_count).collect();
        if counts.iter().sum::<usize>() != packed.len() {
            return Err("it has not one value for each node that is known");
        }
        if !packed.par_iter().all(|value| value.is_finite()) {
            return Err("a value is not finite");
        }
        let far = packed.par_iter().map(|value| value.abs()).reduce(|| 0.0, f32::max).max(f32::MIN_POSITIVE);
        let mut first = 0;
        let parts: Vec<&[f32]> = counts
            .into_iter()
            .map(|count| {
                first += count;
                &packed[first - count..first]
            })
            .collect();
        let mut values = vec![0.0; keys.len() * BLOCK_NODES];
        values.par_chunks_exact_mut(BLOCK_NODES).zip(parts).enumerate().for_each(|(b, (values, part))| {
            let mut part = part.iter();
            for (local, value) in values.iter_mut().enumerate() {
                *value = if mask_get(&known[b], local) {
                    *part.next().expect("as many values as nodes")
                } else if mask_get(&inside[b], local) {
                    -far
                } else {
                    far
                };
            }
        });
        Ok(Self { lattice, blocks: Blocks::new(keys, extent), known, values })
    }

    /// What of a field is kept, beside its lattice, keys and known nodes: the other nodes that are inside, and the values that are known.
    #[must_use]
    pub fn packed(&self) -> (Vec<Mask>, Vec<f32>) {
        let mut inside = self.inside();
        let mut packed = Vec::with_capacity(self.known_nodes());
        for ((values, known), inside) in self.values.chunks_exact(BLOCK_NODES).zip(&self.known).zip(&mut inside) {
            (0..8).for_each(|z| inside[z] &= !known[z]);
            packed
                .extend(values.iter().enumerate().filter(|(local, _)| mask_get(known, *local)).map(|(_, value)| value));
        }
        (inside, packed)
    }

    /// Number of nodes whose value is known.
    #[must_use]
    pub fn known_nodes(&self) -> usize {
        self.known.par_iter().map(mask_count).sum()
    }

    /// The nodes of each block whose value is negative, known or not.
    pub(crate) fn inside(&self) -> Vec<Mask> {
        let of_block = |values: &[f32]| {
            let row = |z: usize| values[64 * z..64 * (z + 1)].iter().enumerate();
            std::array::from_fn(|z| row(z).fold(0, |bits, (i, &value)| bits | u64::from(value < 0.0) << i))
        };
        self.values.par_chunks_exact(BLOCK_NODES).map(of_block).collect()
    }

    /// The value at a node of the finest level; `None` outside the band.
    #[must_use]
    pub fn node(&self, node: [u32; 3]) -> Option<f32> {
        let block = self.blocks.find(node.map(|n| n / 8))?;
        let local = node[0] as usize & 7 | (node[1] as usize & 7) << 3 | (node[2] as usize & 7) << 6;
        mask_get(&self.known[block], local).then(|| self.values[block * 512 + local])
    }

    /// The mean gradient of F over the cube that holds a position: the differences along its four edges in each direction, averaged.
    /// `None` outside the band.
    ///
    /// It points outward. Positions are in the coordinates of the lattice, and the gradient is in values of F a unit of them.
    #[must_use]
    pub fn gradient(&self, p: [f64; 3]) -> Option<[f64; 3]> {
        let h = self.lattice.spacing;
        let nodes = self.lattice.nodes_at(self.lattice.finest);
        let mut low = [0; 3];
        for a in 0..3 {
            let cell = ((p[a] - self.lattice.origin[a]) / h).floor();
            if !(cell >= 0.0 && cell < f64::from(nodes[a] - 1)) {
                return None;
            }
            low[a] = cell as u32;
        }
        let mut gradient = [0.0; 3];
        for corner in 0..8_u32 {
            let value = self.node(std::array::from_fn(|a| low[a] + (corner >> a & 1)))?;
            for (a, g) in gradient.iter_mut().enumerate() {
                *g += if corner >> a & 1 == 1 { f64::from(value) } else { -f64::from(value) };
            }
        }
        Some(gradient.map(|g| 0.25 * g / h))
    }
}
