//! The active tetrahedra of a lattice.

use crate::contour::cells::{Cell, Cells};
use crate::domain::{NONE, TETRAHEDRA, mask_get, neighbor_code};
use crate::field::LatticeField;

/// Values at nodes 0..=8 of a block; NaN where unknown.
pub(super) type Corner9 = [f32; 729];

/// A corner of the cell is unknown.
const CUT: u32 = 1 << 22;
/// A block with cells that are active or cut.
pub(super) struct ActiveBlock {
    /// For each cell the number of vertices before it in the block (low 16 bits), its six active tetrahedra (above), or [`CUT`].
    pub(super) cells: Box<[u32; 512]>,
    /// Number of vertices of the block.
    pub(super) count: u32,
}

/// The values around block `b`, or `None` if they have one sign.
pub(super) fn corner_values(field: &LatticeField, b: usize) -> Option<Box<Corner9>> {
    let mut values = Box::new([f32::NAN; 729]);
    let (mut negative, mut positive) = (false, false);
    for after in 0..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| (after >> a & 1) as i32);
        let other = field.blocks.neighbors[b][neighbor_code(step)];
        if other == NONE {
            continue;
        }
        let (known, from) = (&field.known[other as usize], other as usize * 512);
        let range = |a: usize| if after >> a & 1 == 1 { 8..9_usize } else { 0..8 };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let local = (x & 7) | (y & 7) << 3 | (z & 7) << 6;
                    if mask_get(known, local) {
                        let value = field.values[from + local];
                        values[x + 9 * y + 81 * z] = value;
                        negative |= value < 0.0;
                        positive |= value >= 0.0;
                    }
                }
            }
        }
    }
    (negative && positive).then_some(values)
}

/// The corners of a cell as bits, set where F < 0; `None` if a corner is unknown.
fn corner_signs(values: &Corner9, local: usize) -> Option<usize> {
    let origin = (local & 7) + 9 * (local >> 3 & 7) + 81 * (local >> 6);
    let mut signs = 0;
    for corner in 0..8_usize {
        let value = values[origin + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2)];
        if value.is_nan() {
            return None;
        }
        signs |= usize::from(value < 0.0) << corner;
    }
    Some(signs)
}

/// For each pattern of corner signs the active tetrahedra, as bits.
const ACTIVE: [u8; 256] = {
    let mut table = [0; 256];
    let mut signs = 0;
    while signs < 256 {
        let mut t = 0;
        while t < 6 {
            let c = TETRAHEDRA[t].corners;
            let inside = (signs >> c[0] & 1) + (signs >> c[1] & 1) + (signs >> c[2] & 1) + (signs >> c[3] & 1);
            if inside != 0 && inside != 4 {
                table[signs] |= 1 << t;
            }
            t += 1;
        }
        signs += 1;
    }
    table
};

/// The active tetrahedra of block `b`; `None` if there are none, and no cell is cut.
pub(super) fn activate(field: &LatticeField, b: usize) -> Option<ActiveBlock> {
    let values = corner_values(field, b)?;
    let mut cells = Box::new([0; 512]);
    let (mut count, mut cut) = (0, false);
    for local in 0..512 {
        let entry = corner_signs(&values, local).map_or(CUT, |signs| u32::from(ACTIVE[signs]) << 16);
        cells[local] = count | entry;
        count += (entry & !CUT).count_ones();
        cut |= entry == CUT;
    }
    (count > 0 || cut).then_some(ActiveBlock { cells, count })
}

/// A tetrahedron of a cell of a block, in the coordinates of the block's first node.
pub(super) fn cell_in_block(values: &Corner9, origin: [usize; 3], t: usize) -> Cell {
    let places = corners_of(origin, t);
    Cell {
        corners: places.map(|p| p.map(|c| c as f64)),
        values: places.map(|p| f64::from(values[p[0] + 9 * p[1] + 81 * p[2]])),
    }
}

/// The nodes of a tetrahedron, from the first node of the block; 8 is the first of the next block.
fn corners_of(origin: [usize; 3], t: usize) -> [[usize; 3]; 4] {
    TETRAHEDRA[t].corners.map(|corner| std::array::from_fn(|a| origin[a] + (corner >> a & 1)))
}

/// The tetrahedron of each vertex.
pub(super) struct LatticeCells<'a> {
    field: &'a LatticeField,
    /// Block, and eight times the cell in it plus the tetrahedron in that.
    tetrahedra: Vec<(u32, u16)>,
}

impl<'a> LatticeCells<'a> {
    /// The cells of all vertices, in their order.
    pub(super) fn new(field: &'a LatticeField, active: &[Option<ActiveBlock>]) -> Self {
        let mut tetrahedra = Vec::new();
        for (b, block) in active.iter().enumerate() {
            let Some(block) = block else { continue };
            for (local, cell) in block.cells.iter().enumerate() {
                let here = (0..6).filter(|t| cell >> (16 + t) & 1 == 1);
                tetrahedra.extend(here.map(|t| (b as u32, (local << 3 | t) as u16)));
            }
        }
        Self { field, tetrahedra }
    }

    /// The cell of a vertex, and which of its tetrahedra.
    pub(super) fn place(&self, vertex: usize) -> ([u32; 3], usize) {
        let (block, code) = self.tetrahedra[vertex];
        let local = u32::from(code >> 3);
        let corner = self.field.blocks.coordinates[block as usize];
        let inside = [local & 7, local >> 3 & 7, local >> 6];
        (std::array::from_fn(|a| 8 * corner[a] + inside[a]), usize::from(code & 7))
    }
}

impl Cells for LatticeCells<'_> {
    fn cell(&self, vertex: usize) -> Cell {
        let (block, code) = self.tetrahedra[vertex];
        let (b, local, t) = (block as usize, usize::from(code >> 3), usize::from(code & 7));
        let places = corners_of([local & 7, local >> 3 & 7, local >> 6], t);
        let first = self.field.blocks.coordinates[b].map(|c| 8 * c);
        let values = places.map(|p| {
            // All nodes of an active tetrahedron are known, so their blocks are there.
            let block = self.field.blocks.neighbors[b][neighbor_code(p.map(|c| (c >> 3) as i32))] as usize;
            f64::from(self.field.values[block * 512 + (p[0] & 7 | (p[1] & 7) << 3 | (p[2] & 7) << 6)])
        });
        let position = |p: [usize; 3]| {
            let node = std::array::from_fn(|a| f64::from(first[a] + p[a] as u32));
            self.field.lattice.position(self.field.lattice.finest, node)
        };
        Cell { corners: places.map(position), values }
    }
}
