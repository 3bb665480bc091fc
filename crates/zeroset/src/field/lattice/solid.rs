//! A fitted F as a field: known everywhere, with bounds.

use std::sync::OnceLock;

use super::LatticeField;
use super::cover::Cover;
use crate::domain::{BLOCK_NODES, NONE, TETRAHEDRA, neighbor_code};
use crate::field::{Field, Interval, Metric};
use crate::vec3::{self, Vec3};

/// What a fitted F surrounds.
///
/// F is linear on each tetrahedron of the lattice. Where it is not known it has the greatest value that is, with the sign of what is known nearest; beyond
/// the box of the lattice it is as on the faces of the box.
pub struct LatticeSolid {
    field: LatticeField,
    metric: Metric,
    /// Made when first asked for: reading a model should take no time.
    cover: OnceLock<Cover>,
}

impl std::fmt::Debug for LatticeSolid {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (blocks, lattice) = (self.field.blocks.len(), &self.field.lattice);
        f.debug_struct("LatticeSolid").field("lattice", lattice).field("blocks", &blocks).finish_non_exhaustive()
    }
}

/// The cell that holds a position, and the shares of the way through it.
struct Place {
    cell: [u32; 3],
    fraction: [f64; 3],
    /// 1 along axes on which the position lies within the box of the lattice, else 0.
    within: [f64; 3],
}

/// Positions whose blocks are found before their values are read.
const TOGETHER: usize = 64;

impl LatticeSolid {
    /// The solid of a fitted F; `metric` tells what its values are.
    #[must_use]
    pub fn new(mut field: LatticeField, metric: Metric) -> Self {
        field.fill();
        Self::filled(field, metric)
    }

    /// The solid of an F that was a solid before: nodes whose value is not known have a sign.
    #[must_use]
    pub(crate) fn filled(field: LatticeField, metric: Metric) -> Self {
        Self { field, metric, cover: OnceLock::new() }
    }

    /// The F that was fitted.
    #[must_use]
    pub fn fitted(&self) -> &LatticeField {
        &self.field
    }

    fn cover(&self) -> &Cover {
        self.cover.get_or_init(|| Cover::new(&self.field))
    }

    /// Place of a coordinate in cells, and whether it had to be moved into the box of the lattice.
    fn place(&self, p: Vec3) -> Place {
        let lattice = &self.field.lattice;
        let nodes = lattice.nodes_at(lattice.finest);
        let mut place = Place { cell: [0; 3], fraction: [0.0; 3], within: [1.0; 3] };
        for a in 0..3 {
            let last = f64::from(nodes[a] - 1);
            let t = (p[a] - lattice.origin[a]) / lattice.spacing;
            if !(0.0..=last).contains(&t) {
                place.within[a] = 0.0;
            }
            let t = t.clamp(0.0, last);
            // A NaN becomes 0.
            place.cell[a] = (t as u32).min(nodes[a] - 2);
            place.fraction[a] = t - f64::from(place.cell[a]);
        }
        place
    }

    /// The block of a cell, if it is stored.
    fn block(&self, cell: [u32; 3]) -> Option<usize> {
        self.field.blocks.find([cell[0] / 8, cell[1] / 8, cell[2] / 8])
    }

    /// F at the corners of a cell in a block; bit 0 of the number of a corner is x, bit 1 is y, bit 2 is z.
    fn corners(&self, block: Option<usize>, cell: [u32; 3]) -> [f32; 8] {
        let field = &self.field;
        let Some(b) = block else { return self.corners_of_empty(cell) };
        let [x, y, z] = [cell[0] as usize & 7, cell[1] as usize & 7, cell[2] as usize & 7];
        let first = b * BLOCK_NODES + (x | y << 3 | z << 6);
        if x < 7 && y < 7 && z < 7 {
            let v = &field.values[first..first + 74];
            return [v[0], v[1], v[8], v[9], v[64], v[65], v[72], v[73]];
        }
        let mut values = [0.0; 8];
        for (corner, value) in values.iter_mut().enumerate() {
            let node = [x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)];
            let step = [(node[0] >> 3) as i32, (node[1] >> 3) as i32, (node[2] >> 3) as i32];
            let next = field.blocks.neighbors[b][neighbor_code(step)];
            *value = if next == NONE {
                self.cover().value_in(std::array::from_fn(|a| cell[a] / 8 + step[a] as u32))
            } else {
                field.values[next as usize * BLOCK_NODES + (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6)]
            };
        }
        values
    }

    #[cold]
    fn corners_of_empty(&self, cell: [u32; 3]) -> [f32; 8] {
        let value = self.cover().value_in(cell.map(|c| c / 8));
        if cell.iter().all(|c| c & 7 < 7) {
            return [value; 8];
        }
        std::array::from_fn(|corner| {
            let node: [u32; 3] = std::array::from_fn(|a| cell[a] + (corner as u32 >> a & 1));
            self.stored(node).unwrap_or(value)
        })
    }

    /// The value at a node of a stored block.
    fn stored(&self, node: [u32; 3]) -> Option<f32> {
        let b = self.field.blocks.find(node.map(|n| n / 8))?;
        Some(self.field.values[b * BLOCK_NODES + (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as usize])
    }

    /// The values at the four corners of the tetrahedron that holds a place, along its path, and the axes of the path.
    fn path(&self, block: Option<usize>, place: &Place) -> ([f64; 4], [usize; 3]) {
        let values = self.corners(block, place.cell);
        let tetrahedron = &TETRAHEDRA[crate::domain::tetrahedron_of(place.fraction)];
        let [a, b, c, d] = tetrahedron.corners;
        let values = [values[a].into(), values[b].into(), values[c].into(), values[d].into()];
        (values, tetrahedron.axes)
    }

    /// F and its gradient at a place.
    fn at(&self, block: Option<usize>, place: &Place) -> (f64, Vec3) {
        let (values, axes) = self.path(block, place);
        let (mut value, mut gradient) = (values[0], [0.0; 3]);
        for i in 0..3 {
            let step = values[i + 1] - values[i];
            value += place.fraction[axes[i]] * step;
            gradient[axes[i]] = place.within[axes[i]] * step / self.field.lattice.spacing;
        }
        (value, gradient)
    }

    /// Whether F has both signs on the face of a block.
    fn crosses_face(&self, b: usize, axis: usize, far: bool) -> bool {
        let layer = if far { 7 } else { 0 };
        let values = &self.field.values[b * BLOCK_NODES..(b + 1) * BLOCK_NODES];
        let mut on_face =
            (0..BLOCK_NODES).filter(|local| local >> (3 * axis) & 7 == layer).map(|local| values[local] < 0.0);
        let first = on_face.next();
        on_face.any(|is_inside| Some(is_inside) != first)
    }
}

impl Field for LatticeSolid {
    fn value(&self, p: [f64; 3]) -> f64 {
        let place = self.place(p);
        let (values, axes) = self.path(self.block(place.cell), &place);
        (0..3).fold(values[0], |value, i| value + place.fraction[axes[i]] * (values[i + 1] - values[i]))
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.value_and_gradient(p).1
    }

    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let place = self.place(p);
        self.at(self.block(place.cell), &place)
    }

    fn evaluate(&self, points: &[[f64; 3]], found: &mut [(f64, [f64; 3])]) {
        // All blocks of some points are found before values are read: memory answers many questions at once, but not one that hangs on another.
        let mut places: Vec<(Option<usize>, Place)> = Vec::with_capacity(TOGETHER);
        for (points, found) in points.chunks(TOGETHER).zip(found.chunks_mut(TOGETHER)) {
            places.clear();
            places.extend(points.iter().map(|&p| {
                let place = self.place(p);
                (self.block(place.cell), place)
            }));
            for ((block, place), found) in places.iter().zip(found) {
                *found = self.at(*block, place);
            }
        }
    }

    fn metric(&self) -> Metric {
        self.metric
    }

    fn lipschitz(&self) -> f64 {
        // No two nodes differ by more.
        2.0 * 3.0_f64.sqrt() * f64::from(self.field.greatest()) / self.field.lattice.spacing
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        if low.iter().chain(&high).any(|c| c.is_nan()) {
            return Interval::ALL;
        }
        let (low, high) = (self.place(low), self.place(high));
        let within = self.cover().bounds(low.cell, high.cell, &|block, from, to| {
            let Some(b) = self.field.blocks.find(block) else { return Interval::ALL };
            let mut bounds = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
            for z in from[2]..=to[2] + 1 {
                for y in from[1]..=to[1] + 1 {
                    for x in from[0]..=to[0] + 1 {
                        let step = [0, 1, 2].map(|a| (([x, y, z][a] >> 3) - block[a]) as i32);
                        let next = self.field.blocks.neighbors[b][neighbor_code(step)];
                        let value = if next == NONE {
                            self.cover().value_in(std::array::from_fn(|a| block[a] + step[a] as u32))
                        } else {
                            let local = (x & 7 | (y & 7) << 3 | (z & 7) << 6) as usize;
                            self.field.values[next as usize * BLOCK_NODES + local]
                        };
                        bounds.low = bounds.low.min(value.into());
                        bounds.high = bounds.high.max(value.into());
                    }
                }
            }
            bounds
        });
        // Interpolation rounds.
        let rounding = 1e-14 * within.low.abs().max(within.high.abs());
        Interval { low: within.low - rounding, high: within.high + rounding }
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let field = &self.field;
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        let mut is_open = [[false; 2]; 3];
        for (b, bounds) in self.cover().of_blocks(field) {
            if bounds.low >= 0.0 || bounds.high < 0.0 {
                continue;
            }
            let first = field.blocks.coordinates[b].map(|c| f64::from(8 * c));
            low = vec3::min(low, field.lattice.position(field.lattice.finest, first));
            high = vec3::max(high, field.lattice.position(field.lattice.finest, first.map(|c| c + 8.0)));
            for (axis, is_open) in is_open.iter_mut().enumerate() {
                for far in [false, true] {
                    is_open[usize::from(far)] |=
                        field.blocks.at_domain_face(b, axis, far) && self.crosses_face(b, axis, far);
                }
            }
        }
        // A surface that meets the face of the box goes on straight beyond it.
        for axis in 0..3 {
            if is_open[axis][0] {
                low[axis] = f64::NEG_INFINITY;
            }
            if is_open[axis][1] {
                high[axis] = f64::INFINITY;
            }
        }
        Some([low, high])
    }
}
