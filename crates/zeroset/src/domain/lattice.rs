//! The nested lattices: placement, spacing, and fixed-point coordinates.

/// The placement of all levels: nested cubic lattices with a common corner.
///
/// Level `l` has spacing `spacing * 2^(finest - l)` and `8 * blocks * 2^l` nodes along each axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Lattice {
    /// Position of node (0, 0, 0) of every level.
    pub origin: [f64; 3],
    /// Distance between neighbouring nodes at the finest level.
    pub spacing: f64,
    /// Index of the finest level; the coarsest is level 0.
    pub finest: u32,
    /// Blocks along each axis at level 0.
    pub blocks: [u32; 3],
    /// Bits of a fixed-point coordinate that lie below one cell of the finest level.
    fraction_bits: u32,
}

/// The lattice asked for cannot be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The spacing is not a positive number.
    #[error("a lattice spacing of {0} is not possible: give a positive length")]
    Spacing(f64),
    /// The box is not finite, or has no extent at all.
    #[error("the points have no extent: at least two different points are needed")]
    NoExtent,
    /// More cells along an axis than can be addressed.
    #[error("a spacing of {spacing} over an extent of {extent} is too fine: give a resolution of at least {least}")]
    TooFine {
        /// The spacing asked for.
        spacing: f64,
        /// The longest side of the box.
        extent: f64,
        /// The finest spacing that can be had.
        least: f64,
    },
}

/// Cells along the longest axis of level 0 lie in this many ..= twice as many.
const COARSEST_CELLS: f64 = 16.0;
/// More blocks than this at level 0 are a mistake.
const MOST_COARSE_BLOCKS: f64 = 1e6;
/// 2^21 nodes is what a Morton code holds.
const MAX_NODE_BITS: u32 = 21;

impl Lattice {
    /// The lattices around a box, grown on every side by `pad_rel` times its longest side.
    ///
    /// # Errors
    /// If the spacing is not positive, the box has no extent, or the spacing is too fine for it.
    pub fn around(low: [f64; 3], high: [f64; 3], spacing: f64, pad_rel: f64) -> Result<Self, LatticeError> {
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(LatticeError::Spacing(spacing));
        }
        let side: [f64; 3] = std::array::from_fn(|a| high[a] - low[a]);
        let longest = side.into_iter().fold(0.0, f64::max);
        if !longest.is_finite() || longest <= 0.0 {
            return Err(LatticeError::NoExtent);
        }
        // At least two cells of padding, so that the stencils around the data never meet the faces of the box.
        let pad = (pad_rel * longest).max(2.0 * spacing);
        let padded = longest + 2.0 * pad;
        let too_fine =
            || LatticeError::TooFine { spacing, extent: longest, least: padded / f64::from(1 << (MAX_NODE_BITS - 1)) };
        if padded / spacing > f64::from(1 << (MAX_NODE_BITS - 1)) {
            return Err(too_fine());
        }
        let finest = (padded / (COARSEST_CELLS * spacing)).log2().floor().max(0.0) as u32;
        let coarse = spacing * f64::from(1 << finest);
        let blocks = side.map(|s| (((s + 2.0 * pad) / coarse).ceil() / 8.0).ceil().max(1.0) as u32);
        let origin = std::array::from_fn(|a| {
            let whole = f64::from(blocks[a] * 8 - 1) * coarse;
            0.5 * (low[a] + high[a]) - 0.5 * whole
        });
        let nodes = (blocks.into_iter().max().unwrap_or(1) * 8) << finest;
        let node_bits = nodes.next_power_of_two().trailing_zeros();
        if node_bits > MAX_NODE_BITS {
            return Err(too_fine());
        }
        Ok(Self { origin, spacing, finest, blocks, fraction_bits: (32 - node_bits).min(20) })
    }

    /// A lattice over a box whose nodes lie where those of the finest level of this one do, or would beyond its box.
    ///
    /// # Errors
    /// If the box is not finite or has too many cells.
    pub(crate) fn over(&self, low: [f64; 3], high: [f64; 3]) -> Result<Self, LatticeError> {
        let block = 8.0 * self.spacing;
        let extent = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
        if !extent.is_finite() || extent <= 0.0 {
            return Err(LatticeError::NoExtent);
        }
        if extent / self.spacing > f64::from(1 << (MAX_NODE_BITS - 1)) {
            let least = extent / f64::from(1 << (MAX_NODE_BITS - 1));
            return Err(LatticeError::TooFine { spacing: self.spacing, extent, least });
        }
        let first: [f64; 3] = std::array::from_fn(|a| ((low[a] - self.origin[a]) / block).floor());
        // The last node of a block is not the first of the next.
        let count: [u32; 3] = std::array::from_fn(|a| {
            ((high[a] - self.origin[a] + self.spacing) / block - first[a]).ceil().max(1.0) as u32
        });
        let most = count.into_iter().max().unwrap_or(1);
        let finest = (8.0 * f64::from(most) / COARSEST_CELLS).log2().floor().max(0.0) as u32;
        let blocks = count.map(|n| n.div_ceil(1 << finest));
        let origin = std::array::from_fn(|a| self.origin[a] + block * first[a]);
        Self::new(origin, self.spacing, finest, blocks)
    }

    /// A lattice from its parts, as they are kept.
    ///
    /// # Errors
    /// If a number is not finite, the spacing is not positive, or it has too many nodes.
    pub fn new(origin: [f64; 3], spacing: f64, finest: u32, blocks: [u32; 3]) -> Result<Self, LatticeError> {
        if !(spacing.is_finite() && spacing > 0.0) {
            return Err(LatticeError::Spacing(spacing));
        }
        if !origin.iter().all(|c| c.is_finite()) || blocks.contains(&0) {
            return Err(LatticeError::NoExtent);
        }
        let most = blocks.into_iter().max().unwrap_or(1);
        let nodes = 8.0 * f64::from(most) * 2.0_f64.powi(finest.min(64) as i32);
        let all: f64 = blocks.iter().map(|&b| f64::from(b)).product();
        if nodes > f64::from(1 << MAX_NODE_BITS) || all > MOST_COARSE_BLOCKS {
            let extent = nodes * spacing;
            return Err(LatticeError::TooFine { spacing, extent, least: extent / f64::from(1 << MAX_NODE_BITS) });
        }
        let node_bits = ((8 * most) << finest).next_power_of_two().trailing_zeros();
        Ok(Self { origin, spacing, finest, blocks, fraction_bits: (32 - node_bits).min(20) })
    }

    /// The same lattices without those finer than a level.
    pub(crate) fn up_to(&self, level: u32) -> Self {
        let removed = self.finest - level;
        Self {
            spacing: self.spacing_at(level),
            finest: level,
            fraction_bits: (self.fraction_bits + removed).min(20),
            ..self.clone()
        }
    }

    /// Distance between neighbouring nodes of a level.
    #[must_use]
    pub fn spacing_at(&self, level: u32) -> f64 {
        self.spacing * f64::from(1_u32 << (self.finest - level))
    }

    /// Blocks along each axis at a level.
    #[must_use]
    pub fn blocks_at(&self, level: u32) -> [u32; 3] {
        self.blocks.map(|b| b << level)
    }

    /// Nodes along each axis at a level.
    #[must_use]
    pub fn nodes_at(&self, level: u32) -> [u32; 3] {
        self.blocks_at(level).map(|b| b * 8)
    }

    /// Bits of a fixed-point coordinate below one cell of a level.
    #[must_use]
    pub fn shift_at(&self, level: u32) -> u32 {
        self.fraction_bits + self.finest - level
    }

    /// Bits that a fixed-point coordinate uses in all.
    pub(super) fn bits(&self) -> u32 {
        let nodes = self.nodes_at(self.finest).into_iter().max().unwrap_or(1);
        self.fraction_bits + nodes.next_power_of_two().trailing_zeros()
    }

    /// Fixed-point coordinates of a position: a cell of the finest level is 2^fraction_bits. Positions outside the box are
    /// clamped to it.
    #[must_use]
    pub fn fixed(&self, p: [f64; 3]) -> [u32; 3] {
        let nodes = self.nodes_at(self.finest);
        let unit = f64::from(1_u32 << self.fraction_bits) / self.spacing;
        std::array::from_fn(|a| {
            let last = (f64::from(nodes[a] - 1) * f64::from(1_u32 << self.fraction_bits)) - 1.0;
            ((p[a] - self.origin[a]) * unit).clamp(0.0, last) as u32
        })
    }

    /// Position of a place given in cells of a level.
    #[must_use]
    pub fn position(&self, level: u32, node: [f64; 3]) -> [f64; 3] {
        let h = self.spacing_at(level);
        std::array::from_fn(|a| self.origin[a] + h * node[a])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_box_is_covered_with_its_padding() {
        let (low, high) = ([-3.0, 10.0, 0.0], [7.0, 12.0, 0.5]);
        let lattice = Lattice::around(low, high, 0.05, 0.1).unwrap();
        for level in 0..=lattice.finest {
            let nodes = lattice.nodes_at(level);
            let far = lattice.position(level, nodes.map(|n| f64::from(n - 1)));
            for a in 0..3 {
                assert!(lattice.origin[a] <= low[a] - 0.5 && far[a] >= high[a] + 0.5, "level {level} axis {a}");
            }
        }
        let across = lattice.nodes_at(0).into_iter().max().unwrap();
        assert!((16..=40).contains(&across), "{across}");
    }

    #[test]
    fn boxes_of_any_size_are_covered_by_nodes_in_step() {
        for i in 0..400 {
            let high = [0.5 + 0.013 * f64::from(i), 0.4, 0.01 * f64::from(i)];
            let from = Lattice::new([0.37, -0.2, 5.0], 0.02, 3, [2; 3]).unwrap();
            let lattice = from.over([0.0; 3], high).unwrap();
            let last = lattice.nodes_at(lattice.finest).map(|n| f64::from(n - 1));
            let far = lattice.position(lattice.finest, last);
            // But for rounding where a node is at the face.
            assert!((0..3).all(|a| lattice.origin[a] < 1e-12 && far[a] > high[a] - 1e-12), "{high:?}");
            let off = (lattice.origin[0] - from.origin[0]) / 0.02;
            assert!((off - off.round()).abs() < 1e-9);
        }
    }

    #[test]
    fn fixed_point_coordinates_resolve_a_thousandth_of_a_cell() {
        let lattice = Lattice::around([0.0; 3], [1000.0, 800.0, 50.0], 0.1, 0.1).unwrap();
        let p = [123.456, 7.89, 33.3];
        let (fixed, shift) = (lattice.fixed(p), lattice.shift_at(lattice.finest));
        for a in 0..3 {
            let back = lattice.origin[a] + f64::from(fixed[a]) / f64::from(1_u32 << shift) * lattice.spacing;
            assert!((back - p[a]).abs() < 1e-4);
        }
    }

    #[test]
    fn impossible_lattices_are_refused() {
        let unit = ([0.0; 3], [1.0; 3]);
        assert_eq!(Lattice::around(unit.0, unit.1, 0.0, 0.1), Err(LatticeError::Spacing(0.0)));
        assert_eq!(Lattice::around([1.0; 3], [1.0; 3], 0.1, 0.1), Err(LatticeError::NoExtent));
        assert!(matches!(Lattice::around(unit.0, unit.1, 1e-12, 0.1), Err(LatticeError::TooFine { .. })));
        assert_eq!(Lattice::around(unit.0, [f64::NAN; 3], 0.1, 0.1), Err(LatticeError::NoExtent));
    }
}
