//! The points in lattice coordinates, sorted once along the Morton curve for all levels.

use rayon::prelude::*;

use super::{Lattice, block_key, morton};

/// A cloud in fixed-point lattice coordinates, sorted along the Morton curve.
///
/// At every level the points of a block, and within it the points of a cell, are neighbours in the list.
#[derive(Debug, Clone, Default)]
pub struct LatticePoints {
    /// Fixed-point coordinates (see [`Lattice::fixed`]).
    pub coordinates: Vec<[u32; 3]>,
    /// Index in the original cloud of each sorted point.
    pub order: Vec<u32>,
}

impl LatticePoints {
    /// Places and sorts `points`. Points that share a Morton code keep their order. Cost: one parallel sort.
    #[must_use]
    pub fn new(lattice: &Lattice, points: &[[f64; 3]]) -> Self {
        let shift = lattice.bits().saturating_sub(21);
        let mut keys: Vec<(u64, u32)> = points
            .par_iter()
            .enumerate()
            .map(|(i, &p)| (morton::encode(lattice.fixed(p).map(|c| c >> shift)), i as u32))
            .collect();
        keys.par_sort_unstable();
        let coordinates = keys.par_iter().map(|&(_, i)| lattice.fixed(points[i as usize])).collect();
        let order = keys.into_par_iter().map(|(_, i)| i).collect();
        Self { coordinates, order }
    }

    /// Fractions (0..1) of point `i` in its cell of the level whose [`Lattice::shift_at`] is `shift`.
    #[inline]
    #[must_use]
    pub fn fractions(&self, i: usize, shift: u32) -> [f32; 3] {
        let (mask, unit) = ((1_u32 << shift) - 1, 1.0 / (1_u32 << shift) as f32);
        self.coordinates[i].map(|c| (c & mask) as f32 * unit)
    }
}

/// The cells of one level that hold points, grouped by block.
#[derive(Debug, Clone, Default)]
pub struct Cells {
    /// Morton keys of the blocks that hold points, ascending.
    pub block_keys: Vec<u64>,
    /// For each of these blocks where its cells begin; one more entry than blocks.
    pub first_cell: Vec<u32>,
    /// For each cell its place in its block: `x | y << 3 | z << 6`.
    pub local: Vec<u16>,
    /// For each cell where its points begin; one more entry than cells.
    pub first_point: Vec<u32>,
}

impl Cells {
    /// Finds the occupied cells of a level. Cost: one parallel pass over the points.
    #[must_use]
    pub fn new(lattice: &Lattice, points: &LatticePoints, level: u32) -> Self {
        let shift = lattice.shift_at(level);
        let n = points.coordinates.len();
        let cell = |i: usize| points.coordinates[i].map(|c| c >> shift);
        let key = |i: usize| block_key(cell(i).map(|c| c >> 3));
        // Chunks begin where a block begins, so that no block is seen from two chunks.
        let mut starts: Vec<usize> = (0..n).step_by(1 << 16).collect();
        for start in starts.iter_mut().skip(1) {
            while *start < n && key(*start) == key(*start - 1) {
                *start += 1;
            }
        }
        starts.push(n);
        starts.dedup();
        let parts: Vec<Self> = starts
            .par_windows(2)
            .map(|range| {
                let mut part = Self::default();
                let mut last = (u64::MAX, u16::MAX);
                for i in range[0]..range[1] {
                    let c = cell(i);
                    let local = (c[0] & 7 | (c[1] & 7) << 3 | (c[2] & 7) << 6) as u16;
                    let block = block_key(c.map(|v| v >> 3));
                    if block != last.0 {
                        part.block_keys.push(block);
                        part.first_cell.push(part.local.len() as u32);
                    }
                    if (block, local) != last {
                        part.local.push(local);
                        part.first_point.push(i as u32);
                        last = (block, local);
                    }
                }
                part
            })
            .collect();
        let mut all = Self::default();
        for part in parts {
            let base = all.local.len() as u32;
            all.block_keys.extend_from_slice(&part.block_keys);
            all.first_cell.extend(part.first_cell.iter().map(|c| c + base));
            all.local.extend_from_slice(&part.local);
            all.first_point.extend_from_slice(&part.first_point);
        }
        all.first_cell.push(all.local.len() as u32);
        all.first_point.push(n as u32);
        all
    }

    /// Number of occupied cells.
    #[must_use]
    pub fn len(&self) -> usize {
        self.local.len()
    }

    /// Whether no cell is occupied.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.local.is_empty()
    }

    /// The cells of the `b`-th block in the list.
    #[must_use]
    pub fn of_block(&self, b: usize) -> std::ops::Range<usize> {
        self.first_cell[b] as usize..self.first_cell[b + 1] as usize
    }

    /// The points of a cell.
    #[must_use]
    pub fn points(&self, cell: usize) -> std::ops::Range<usize> {
        self.first_point[cell] as usize..self.first_point[cell + 1] as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_each_point_once_at_every_level() {
        let points: Vec<[f64; 3]> =
            (0..5000).map(|i| [(i * 37 % 1000) as f64, (i * 91 % 700) as f64, (i * 13 % 50) as f64]).collect();
        let lattice = Lattice::around([0.0; 3], [1000.0, 700.0, 50.0], 4.0, 0.1).unwrap();
        let sorted = LatticePoints::new(&lattice, &points);
        for level in 0..=lattice.finest {
            let cells = Cells::new(&lattice, &sorted, level);
            assert!(cells.block_keys.is_sorted());
            assert_eq!(*cells.first_cell.last().unwrap() as usize, cells.len());
            assert_eq!((0..cells.len()).map(|c| cells.points(c).len()).sum::<usize>(), points.len());
            let mut seen = std::collections::BTreeSet::new();
            for b in 0..cells.block_keys.len() {
                for c in cells.of_block(b) {
                    assert!(seen.insert((cells.block_keys[b], cells.local[c])));
                }
            }
        }
    }
}
