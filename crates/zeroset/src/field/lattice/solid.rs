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

    /// F at the corners of a cell; bit 0 of the number of a corner is x, bit 1 is y, bit 2 is z.
    fn corners(&self, cell: [u32; 3]) -> [f32; 8] {
        let field = &self.field;
        let block = cell.map(|c| c / 8);
        let Some(b) = field.blocks.find(block) else { return self.corners_of_empty(block, cell) };
        let [x, y, z] = cell.map(|c| c as usize & 7);
        if x < 7 && y < 7 && z < 7 {
            let first = b * BLOCK_NODES + (x | y << 3 | z << 6);
            let values = &field.values[first..first + 74];
            return [0, 1, 8, 9, 64, 65, 72, 73].map(|step| values[step]);
        }
        std::array::from_fn(|corner| {
            let node = [x + (corner & 1), y + (corner >> 1 & 1), z + (corner >> 2)];
            let step = node.map(|c| (c >> 3) as i32);
            let next = field.blocks.neighbors[b][neighbor_code(step)];
            if next == NONE {
                return self.cover().value_in(std::array::from_fn(|a| block[a] + step[a] as u32));
            }
            field.values[next as usize * BLOCK_NODES + (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6)]
        })
    }

    #[cold]
    fn corners_of_empty(&self, block: [u32; 3], cell: [u32; 3]) -> [f32; 8] {
        let value = self.cover().value_in(block);
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

    /// The values at the four corners of the tetrahedron that holds a position, along its path, with the axes of the path and the place.
    fn path(&self, p: Vec3) -> ([f64; 4], [usize; 3], Place) {
        let place = self.place(p);
        let values = self.corners(place.cell);
        let tetrahedron = TETRAHEDRA[crate::domain::tetrahedron_of(place.fraction)];
        (tetrahedron.corners.map(|corner| f64::from(values[corner])), tetrahedron.axes, place)
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
        let (values, axes, place) = self.path(p);
        let steps = (0..3).map(|i| place.fraction[axes[i]] * (values[i + 1] - values[i]));
        values[0] + steps.sum::<f64>()
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        self.value_and_gradient(p).1
    }

    fn value_and_gradient(&self, p: [f64; 3]) -> (f64, [f64; 3]) {
        let (values, axes, place) = self.path(p);
        let (mut value, mut gradient) = (values[0], [0.0; 3]);
        for i in 0..3 {
            let step = values[i + 1] - values[i];
            value += place.fraction[axes[i]] * step;
            gradient[axes[i]] = place.within[axes[i]] * step / self.field.lattice.spacing;
        }
        (value, gradient)
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
