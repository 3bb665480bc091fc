//! A fitted F: values on the nodes of a sparse lattice, linear on each tetrahedron.

use crate::domain::{Blocks, Lattice, Mask};

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
}
