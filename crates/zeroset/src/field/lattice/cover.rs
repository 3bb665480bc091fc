//! What lies where no block is stored, and the bounds of all blocks.

use rustc_hash::FxHashMap;

use super::LatticeField;
use crate::domain::{BLOCK_NODES, NONE, block_key, block_of_key, neighbor_code};
use crate::field::Interval;

/// A cube of the cover: blocks of the finest level, doubled in size from level to level.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Cube {
    /// Blocks are stored in it, with values in these bounds.
    Mixed(Interval),
    /// No block is stored in it: F has this value at its nodes. The bounds hold the nodes on its far faces, too, which belong to the next block.
    Empty(f32, Interval),
}

/// All of the lattice's box, cut into the stored blocks and the largest cubes that hold none.
#[derive(Debug)]
pub(super) struct Cover {
    /// The cubes of each level by their keys.
    levels: Vec<FxHashMap<u64, Cube>>,
    /// Cubes along each axis at level 0.
    extent: [u32; 3],
}

/// The six steps to the cubes beside one.
const SIDES: [[i32; 3]; 6] = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];

impl Cover {
    /// The cover of a field whose blocks are filled.
    pub(super) fn new(field: &LatticeField) -> Self {
        let finest = field.lattice.finest as usize;
        let extent = field.lattice.blocks_at(0);
        let mut levels: Vec<FxHashMap<u64, Cube>> = vec![FxHashMap::default(); finest + 1];
        let nothing = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for &key in &field.blocks.keys {
            for level in (0..=finest).rev() {
                if levels[level].insert(key >> (3 * (finest - level)), Cube::Mixed(nothing)).is_some() {
                    break;
                }
            }
        }
        let mut cover = Self { levels, extent };
        let empty = cover.empty_cubes();
        let far = field.greatest();
        let signs = cover.signs(field, &empty);
        for (&(level, key), is_inside) in empty.iter().zip(signs) {
            let value = if is_inside { -far } else { far };
            let own = Interval { low: value.into(), high: value.into() };
            cover.levels[level].insert(key, Cube::Empty(value, own));
        }
        cover.set_bounds(field);
        cover
    }

    /// Level and key of the largest cubes without a block.
    fn empty_cubes(&self) -> Vec<(usize, u64)> {
        let [x, y, z] = self.extent;
        let mut open: Vec<u64> =
            (0..x).flat_map(|i| (0..y).flat_map(move |j| (0..z).map(move |k| block_key([i, j, k])))).collect();
        let mut empty = Vec::new();
        for (level, cubes) in self.levels.iter().enumerate() {
            open.sort_unstable();
            let (mixed, bare): (Vec<u64>, Vec<u64>) = open.iter().partition(|key| cubes.contains_key(key));
            empty.extend(bare.into_iter().map(|key| (level, key)));
            open = mixed.into_iter().flat_map(|key| (0..8).map(move |child| key << 3 | child)).collect();
        }
        empty
    }

    /// Whether each empty cube is inside: as most of the nodes of stored blocks on its faces are; else as the cubes beside it.
    fn signs(&self, field: &LatticeField, empty: &[(usize, u64)]) -> Vec<bool> {
        let finest = field.lattice.finest as usize;
        let number: Vec<FxHashMap<u64, usize>> = {
            let mut number = vec![FxHashMap::default(); finest + 1];
            empty.iter().enumerate().for_each(|(i, &(level, key))| {
                number[level].insert(key, i);
            });
            number
        };
        // The empty cube, of this level or a coarser one, on a side of a cube.
        let beside = |level: usize, key: u64, side: [i32; 3]| -> Option<usize> {
            let own = block_of_key(key);
            let next: [u32; 3] = std::array::from_fn(|a| own[a].wrapping_add_signed(side[a]));
            if (0..3).any(|a| next[a] >= self.extent[a] << level) {
                return None;
            }
            let next = block_key(next);
            (0..=level).rev().find_map(|coarser| number[coarser].get(&(next >> (3 * (level - coarser)))).copied())
        };
        let mut votes = vec![0_i64; empty.len()];
        for (b, &key) in field.blocks.keys.iter().enumerate() {
            let values = &field.values[b * BLOCK_NODES..(b + 1) * BLOCK_NODES];
            for side in SIDES.into_iter().filter(|&side| field.blocks.neighbors[b][neighbor_code(side)] == NONE) {
                let Some(cube) = beside(finest, key, side) else { continue };
                let axis = side.iter().position(|&s| s != 0).unwrap_or(0);
                let layer = if side[axis] < 0 { 0 } else { 7 };
                let on_face = |local: usize| local >> (3 * axis) & 7 == layer;
                votes[cube] += (0..BLOCK_NODES)
                    .filter(|&local| on_face(local))
                    .map(|local| if values[local] < 0.0 { 1 } else { -1 })
                    .sum::<i64>();
            }
        }
        let mut pairs: Vec<(usize, usize)> = Vec::new();
        for (i, &(level, key)) in empty.iter().enumerate() {
            pairs.extend(SIDES.iter().filter_map(|&side| Some((i, beside(level, key, side)?))));
        }
        let mut neighbors: Vec<Vec<usize>> = vec![Vec::new(); empty.len()];
        for (i, j) in pairs {
            neighbors[i].push(j);
            neighbors[j].push(i);
        }
        let mut inside: Vec<Option<bool>> = votes.iter().map(|&vote| (vote != 0).then_some(vote > 0)).collect();
        let mut ring: Vec<usize> = (0..empty.len()).filter(|&i| inside[i].is_some()).collect();
        while !ring.is_empty() {
            let mut next: Vec<usize> =
                ring.iter().flat_map(|&i| &neighbors[i]).copied().filter(|&i| inside[i].is_none()).collect();
            next.sort_unstable();
            next.dedup();
            let said: Vec<bool> = next
                .iter()
                .map(|&i| {
                    let around = neighbors[i].iter().filter_map(|&j| inside[j]);
                    around.map(|is_inside| if is_inside { 1 } else { -1 }).sum::<i64>() > 0
                })
                .collect();
            next.iter().zip(said).for_each(|(&i, is_inside)| inside[i] = Some(is_inside));
            ring = next;
        }
        inside.into_iter().map(|is_inside| is_inside.unwrap_or(false)).collect()
    }

    /// Bounds of all cubes, from the finest up.
    fn set_bounds(&mut self, field: &LatticeField) {
        let finest = self.levels.len() - 1;
        let hull = |a: Interval, b: Interval| Interval { low: a.low.min(b.low), high: a.high.max(b.high) };
        let own: Vec<Interval> = (0..field.blocks.len()).map(|b| self.of_closed_block(field, b)).collect();
        for (&key, bounds) in field.blocks.keys.iter().zip(own) {
            self.levels[finest].insert(key, Cube::Mixed(bounds));
        }
        // Nodes of stored blocks that are corners of cells of an empty cube before them.
        for (b, &key) in field.blocks.keys.iter().enumerate() {
            let own = block_of_key(key);
            for before in 1..8_u32 {
                let step: [u32; 3] = std::array::from_fn(|a| before >> a & 1);
                if field.blocks.neighbors[b][neighbor_code(step.map(|s| -(s as i32)))] != NONE
                    || (0..3).any(|a| own[a] < step[a])
                {
                    continue;
                }
                let on_face = |local: usize| (0..3).all(|a| step[a] == 0 || local >> (3 * a) & 7 == 0);
                let nodes = (0..BLOCK_NODES).filter(|&local| on_face(local));
                let of_nodes = nodes.map(|local| f64::from(field.values[b * BLOCK_NODES + local]));
                let of_nodes = of_nodes.map(|value| Interval { low: value, high: value }).reduce(hull);
                let place = std::array::from_fn(|a| own[a] - step[a]);
                if let (Some(of_nodes), Some((level, key))) = (of_nodes, self.empty_at(place))
                    && let Some(Cube::Empty(_, bounds)) = self.levels[level].get_mut(&key)
                {
                    *bounds = hull(*bounds, of_nodes);
                }
            }
        }
        for level in (1..=finest).rev() {
            let (coarser, finer) = self.levels.split_at_mut(level);
            for (key, cube) in &finer[0] {
                let (Cube::Mixed(bounds) | Cube::Empty(_, bounds)) = *cube;
                if let Some(Cube::Mixed(parent)) = coarser[level - 1].get_mut(&(key >> 3)) {
                    *parent = hull(*parent, bounds);
                }
            }
        }
    }

    /// The values on the cells of a block, whose last corners are nodes of the next ones.
    fn of_closed_block(&self, field: &LatticeField, b: usize) -> Interval {
        let mut bounds = Interval { low: f64::INFINITY, high: f64::NEG_INFINITY };
        for ahead in 0..8_u32 {
            let step: [u32; 3] = std::array::from_fn(|a| ahead >> a & 1);
            let next = field.blocks.neighbors[b][neighbor_code(step.map(|s| s as i32))];
            let mut take = |value: f32| {
                bounds.low = bounds.low.min(value.into());
                bounds.high = bounds.high.max(value.into());
            };
            if next == NONE {
                let own = field.blocks.coordinates[b];
                take(self.value_in(std::array::from_fn(|a| own[a] + step[a])));
                continue;
            }
            let on_face = |local: usize| (0..3).all(|a| step[a] == 0 || local >> (3 * a) & 7 == 0);
            let first = next as usize * BLOCK_NODES;
            (0..BLOCK_NODES).filter(|&local| on_face(local)).for_each(|local| take(field.values[first + local]));
        }
        bounds
    }

    /// Level and key of the empty cube that holds a block of the finest level.
    fn empty_at(&self, block: [u32; 3]) -> Option<(usize, u64)> {
        let finest = self.levels.len() - 1;
        let key = block_key(block);
        for (level, cubes) in self.levels.iter().enumerate() {
            let key = key >> (3 * (finest - level));
            match cubes.get(&key)? {
                Cube::Empty(..) => return Some((level, key)),
                Cube::Mixed(_) => {}
            }
        }
        None
    }

    /// The value at the nodes of a block that is not stored.
    pub(super) fn value_in(&self, block: [u32; 3]) -> f32 {
        let value = self.empty_at(block).and_then(|(level, key)| match self.levels[level].get(&key)? {
            Cube::Empty(value, _) => Some(*value),
            Cube::Mixed(_) => None,
        });
        value.unwrap_or(f32::MIN_POSITIVE)
    }

    /// The stored blocks with the bounds of F on their cells.
    pub(super) fn of_blocks<'a>(&'a self, field: &'a LatticeField) -> impl Iterator<Item = (usize, Interval)> + 'a {
        let finest = &self.levels[self.levels.len() - 1];
        let own = field.blocks.keys.iter().enumerate();
        own.filter_map(|(b, key)| match finest.get(key)? {
            Cube::Mixed(bounds) => Some((b, *bounds)),
            Cube::Empty(..) => None,
        })
    }

    /// An interval that holds F over the cells from `low` to `high`, both included. `of_block` tells that of some cells of a stored block.
    pub(super) fn bounds(
        &self,
        low: [u32; 3],
        high: [u32; 3],
        of_block: &dyn Fn([u32; 3], [u32; 3], [u32; 3]) -> Interval,
    ) -> Interval {
        let first = low.map(|c| c >> (3 + self.levels.len() - 1));
        let last = high.map(|c| c >> (3 + self.levels.len() - 1));
        let mut found: Option<Interval> = None;
        for z in first[2]..=last[2] {
            for y in first[1]..=last[1] {
                for x in first[0]..=last[0] {
                    self.visit(0, [x, y, z], (low, high), of_block, &mut found);
                }
            }
        }
        found.unwrap_or(Interval::ALL)
    }

    fn visit(
        &self,
        level: usize,
        cube: [u32; 3],
        (low, high): ([u32; 3], [u32; 3]),
        of_block: &dyn Fn([u32; 3], [u32; 3], [u32; 3]) -> Interval,
        found: &mut Option<Interval>,
    ) {
        let shift = 3 + self.levels.len() - 1 - level;
        let (first, last) = (cube.map(|c| c << shift), cube.map(|c| ((c + 1) << shift) - 1));
        if (0..3).any(|a| last[a] < low[a] || first[a] > high[a]) {
            return;
        }
        let take = |own: Interval, found: &mut Option<Interval>| {
            *found = Some(match *found {
                Some(f) => Interval { low: f.low.min(own.low), high: f.high.max(own.high) },
                None => own,
            });
        };
        let is_whole = (0..3).all(|a| low[a] <= first[a] && last[a] <= high[a]);
        match self.levels[level].get(&block_key(cube)) {
            Some(Cube::Empty(_, bounds)) => take(*bounds, found),
            Some(Cube::Mixed(bounds)) if is_whole => take(*bounds, found),
            Some(Cube::Mixed(bounds)) => {
                // Nothing to gain where the whole cube is within what was found.
                if found.is_some_and(|f| f.low <= bounds.low && bounds.high <= f.high) {
                    return;
                }
                if level + 1 == self.levels.len() {
                    let from = std::array::from_fn(|a| low[a].max(first[a]));
                    let to = std::array::from_fn(|a| high[a].min(last[a]));
                    take(of_block(cube, from, to), found);
                    return;
                }
                for child in 0..8_u32 {
                    let child = std::array::from_fn(|a| 2 * cube[a] + (child >> a & 1));
                    self.visit(level + 1, child, (low, high), of_block, found);
                }
            }
            None => take(Interval::ALL, found),
        }
    }
}
