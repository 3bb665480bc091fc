//! A fitted F: values on the nodes of a sparse lattice, linear on each tetrahedron.

use crate::domain::{Blocks, Lattice, Mask, mask_get};

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
