//! From one level to the next: the band of nodes to solve on, and F carried over exactly.

use rayon::prelude::*;

use super::level::{LevelParams, Nodes, data_blocks};
use super::prior::Columns;
use super::region::Region;
use crate::domain::{
    Blocks, Cells, Lattice, LatticePoints, Mask, NONE, TETRAHEDRA, block_key, dilate, dilate_box, mask_get, mask_set,
    neighbor_code, shift, tetrahedron_of,
};

/// Steps from the data, or from the zero set of the prolonged F, to the rim of the band.
///
/// Two, three and four give the same surfaces: no distance or share measured on cities and bodies differs by more than a hundredth.
const BAND: usize = 3;

/// F of a level that has been solved.
pub(super) struct Solved {
    pub(super) index: u32,
    pub(super) blocks: Blocks,
    /// Nodes that have a value.
    pub(super) known: Vec<Mask>,
    /// 512 values a block.
    pub(super) f: Vec<f32>,
}

/// Values of the coarse level around one fine block, at coarse nodes -1..=5 of the fine block's own corner.
struct Parent {
    values: [f32; 7 * 7 * 7],
}

impl Parent {
    /// Coarse values around the fine block at `fine`; NaN where there is none.
    fn new(coarse: &Solved, fine: [u32; 3]) -> Option<Self> {
        let b = coarse.blocks.find(fine.map(|c| c >> 1))?;
        let corner: [i32; 3] = fine.map(|c| 4 * (c & 1) as i32);
        let mut values = [f32::NAN; 343];
        for z in 0..7 {
            for y in 0..7 {
                for x in 0..7 {
                    let node: [i32; 3] = [x + corner[0] - 1, y + corner[1] - 1, z + corner[2] - 1];
                    let step = node.map(|c| if c < 0 { -1 } else { i32::from(c > 7) });
                    let other = coarse.blocks.neighbors[b][neighbor_code(step)];
                    if other == NONE {
                        continue;
                    }
                    let local = (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as usize;
                    if mask_get(&coarse.known[other as usize], local) {
                        values[(x + 7 * y + 49 * z) as usize] = coarse.f[other as usize * 512 + local];
                    }
                }
            }
        }
        Some(Self { values })
    }

    /// F at a fine node, each coordinate in -1..=8 of the fine block: the mean of the two ends of the coarse edge, diagonal
    /// or not, in whose middle the node lies.
    #[inline]
    fn at(&self, node: [i32; 3]) -> f32 {
        let place = |up: i32| {
            let [x, y, z] = node.map(|c| ((c + up) >> 1) + 1);
            (x + 7 * y + 49 * z) as usize
        };
        let (a, b) = (self.values[place(0)], self.values[place(1)]);
        // Beyond the last coarse node of the domain F goes on as a constant.
        if a.is_nan() {
            b
        } else if b.is_nan() {
            a
        } else {
            0.5 * (a + b)
        }
    }
}

/// The nodes of the next finer level: those within [`BAND`] steps of the data, of the zero set of the prolonged F, or of a node that the column
/// prior tells another sign than the prolonged F has; and those one step further as fixed neighbours. In a region data and zero set beyond it
/// do not count.
pub(super) fn band(
    lattice: &Lattice,
    points: &LatticePoints,
    cells: Cells,
    coarse: &Solved,
    params: &LevelParams,
    region: Option<&Region>,
) -> Nodes {
    let index = coarse.index + 1;
    let extent = lattice.blocks_at(index);
    let columns = params.column_prior.then(|| Columns::new(&cells));
    let mut keys: Vec<u64> = (0..coarse.blocks.len())
        .into_par_iter()
        .flat_map_iter(|b| {
            let c = coarse.blocks.coordinates[b].map(|c| 2 * c);
            let children = (0..8_u32).map(move |i| [c[0] + (i & 1), c[1] + (i >> 1 & 1), c[2] + (i >> 2)]);
            let signs = signs(coarse, b);
            let columns = columns.as_ref();
            children
                .filter(move |&child| signs.both() || columns.is_some_and(|c| signs.contradict(c.told(child))))
                .map(block_key)
        })
        .collect();
    keys.extend_from_slice(&cells.block_keys);
    keys.par_sort_unstable();
    keys.dedup();
    if let Some(region) = region {
        keys.retain(|&key| region.contains(index, key, 0));
    }
    let blocks = Blocks::new(Blocks::grown_keys(&keys, extent), extent);
    let data_block = data_blocks(&blocks, &cells);
    let shift = lattice.shift_at(index);
    let mut free: Vec<Mask> = (0..blocks.len())
        .into_par_iter()
        .with_min_len(8)
        .map(|b| {
            let mut mask = data_nodes(&blocks, b, &data_block, points, &cells, shift);
            if let Some(parent) = Parent::new(coarse, blocks.coordinates[b]) {
                crossing_nodes(&parent, &mut mask);
                if let Some(columns) = &columns {
                    contradicted_nodes(&parent, columns.told(blocks.coordinates[b]), &mut mask);
                }
            }
            mask
        })
        .collect();
    for _ in 0..BAND {
        free = dilate(&blocks, &free);
    }
    free.par_iter_mut().enumerate().for_each(|(b, mask)| {
        let fixed = params.faces.mask(&blocks, b);
        for z in 0..8 {
            mask[z] &= !fixed[z];
        }
    });
    let known = dilate(&blocks, &free);
    drop(data_block);
    keep_nodes_in_use(blocks, known, free, cells, columns)
}

fn keep_nodes_in_use(
    blocks: Blocks,
    known: Vec<Mask>,
    free: Vec<Mask>,
    cells: Cells,
    columns: Option<Columns>,
) -> Nodes {
    let used: Vec<usize> = (0..blocks.len()).filter(|&b| known[b] != [0; 8]).collect();
    let keys = used.iter().map(|&b| blocks.keys[b]).collect();
    Nodes {
        known: used.iter().map(|&b| known[b]).collect(),
        free: used.iter().map(|&b| free[b]).collect(),
        blocks: Blocks::new(keys, blocks.extent),
        cells,
        columns,
    }
}

/// Which signs F has in a place.
#[derive(Clone, Copy)]
struct Signs {
    negative: bool,
    positive: bool,
}

impl Signs {
    fn both(self) -> bool {
        self.negative && self.positive
    }

    /// Whether the prior tells some node the sign that F has nowhere.
    fn contradict(self, (air, solid): (Mask, Mask)) -> bool {
        !self.positive && air != [0; 8] || !self.negative && solid != [0; 8]
    }
}

/// The signs of F among the known nodes of block `b` and the first layer of those after it.
fn signs(level: &Solved, b: usize) -> Signs {
    let (mut negative, mut positive) = (false, false);
    for after in 0..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| (after >> a & 1) as i32);
        let other = level.blocks.neighbors[b][neighbor_code(step)];
        if other == NONE {
            continue;
        }
        let range = |a: usize| if after >> a & 1 == 1 { 0..1 } else { 0..8 };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let local = x | y << 3 | z << 6;
                    if mask_get(&level.known[other as usize], local) {
                        let inside = level.f[other as usize * 512 + local] < 0.0;
                        negative |= inside;
                        positive |= !inside;
                    }
                }
            }
        }
    }
    Signs { negative, positive }
}

/// The nodes of block `b` that the tetrahedra of the points reach.
fn data_nodes(
    blocks: &Blocks,
    b: usize,
    data_block: &[u32],
    points: &LatticePoints,
    cells: &Cells,
    shift: u32,
) -> Mask {
    let mut mask = [0; 8];
    for before in 0..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| -((before >> a & 1) as i32));
        let other = blocks.neighbors[b][neighbor_code(step)];
        if other == NONE || data_block[other as usize] == NONE {
            continue;
        }
        for cell in cells.of_block(data_block[other as usize] as usize) {
            let local = cells.local[cell];
            let place: [i32; 3] = std::array::from_fn(|a| i32::from(local >> (3 * a) & 7) + 8 * step[a]);
            if place.iter().any(|&c| c < -1) {
                continue;
            }
            let mut seen = 0_u8;
            for i in cells.points(cell) {
                let t = tetrahedron_of(points.fractions(i, shift));
                if seen >> t & 1 == 1 {
                    continue;
                }
                seen |= 1 << t;
                for corner in TETRAHEDRA[t].corners {
                    let node: [i32; 3] = std::array::from_fn(|a| place[a] + (corner >> a & 1) as i32);
                    if node.iter().all(|c| (0..8).contains(c)) {
                        mask_set(&mut mask, (node[0] | node[1] << 3 | node[2] << 6) as usize);
                    }
                }
            }
        }
    }
    mask
}

/// Adds the nodes of a block at either end of an axis edge along which the prolonged F changes sign.
fn crossing_nodes(parent: &Parent, mask: &mut Mask) {
    let mut values = [0.0_f32; 1000];
    let at = |n: [i32; 3]| (n[0] + 1 + 10 * (n[1] + 1) + 100 * (n[2] + 1)) as usize;
    for z in -1..9 {
        for y in -1..9 {
            for x in -1..9 {
                values[at([x, y, z])] = parent.at([x, y, z]);
            }
        }
    }
    for local in 0..512_usize {
        let node = [local & 7, local >> 3 & 7, local >> 6].map(|c| c as i32);
        let here = values[at(node)];
        if here.is_nan() {
            continue;
        }
        let crosses = (0..6).any(|side| {
            let mut next = node;
            next[side / 2] += if side & 1 == 1 { 1 } else { -1 };
            let there = values[at(next)];
            !there.is_nan() && (there < 0.0) != (here < 0.0)
        });
        if crosses {
            mask_set(mask, local);
        }
    }
}

/// Adds the nodes that the prior tells another sign than the prolonged F has.
///
/// A tower that is two cells wide on a coarse level is held by too few nodes there, and may be air with a floating roof. On the
/// next level many nodes in its midst are told to be solid, but these lie far from the data and from the zero set.
fn contradicted_nodes(parent: &Parent, (air, solid): (Mask, Mask), mask: &mut Mask) {
    for local in 0..512_usize {
        let (air, solid) = (mask_get(&air, local), mask_get(&solid, local));
        if air || solid {
            let f = parent.at([local & 7, local >> 3 & 7, local >> 6].map(|c| c as i32));
            if air && f < 0.0 || solid && f >= 0.0 {
                mask_set(mask, local);
            }
        }
    }
}

/// F of the coarse level at every known node of the fine one; exact, because P1 on a level is contained in P1 on the next.
pub(super) fn prolong(coarse: &Solved, fine: &Blocks, known: &[Mask]) -> Vec<f32> {
    let mut values = vec![0.0; fine.len() * 512];
    values.par_chunks_exact_mut(512).enumerate().with_min_len(8).for_each(|(b, values)| {
        let parent = Parent::new(coarse, fine.coordinates[b]);
        for (local, value) in values.iter_mut().enumerate() {
            if !mask_get(&known[b], local) {
                continue;
            }
            let node = [local & 7, local >> 3 & 7, local >> 6].map(|c| c as i32);
            let prolonged = parent.as_ref().map_or(f32::NAN, |p| p.at(node));
            // A node beyond what the coarse level stored is far from the surface; outside is where most of space is.
            *value = if prolonged.is_nan() { super::prior::AIR } else { prolonged };
        }
    });
    values
}

/// Adds nodes until every cell around a change of sign is known whole, with values of the coarse level.
///
/// While a level is solved the zero set moves, and may come to lie against the rim of the band: the tetrahedra there would be cut
/// off and leave holes in the surface. Beyond the rim F is what it was before, so the coarse values continue it.
///
/// In a region the surface is followed to its rim.
pub(super) fn complete(mut level: Solved, coarse: &Solved, region: Option<&Region>) -> Solved {
    // Each round follows the zero set by one node; that of the coarse level lies in the band, so few are needed. On the scans
    // measured one round of at most eleven nodes was enough.
    loop {
        let crossing: Vec<Mask> = (0..level.blocks.len()).into_par_iter().map(|b| sign_changes(&level, b)).collect();
        let mut keys = Blocks::grown_keys(&keys_on_rim(&level, &crossing), level.blocks.extent);
        if let Some(region) = region {
            keys.retain(|&key| region.contains(level.index, key, 1));
        }
        let mut all: Vec<u64> = level.blocks.keys.iter().copied().chain(keys).collect();
        all.par_sort_unstable();
        all.dedup();
        let grown = Blocks::new(all, level.blocks.extent);
        let place: Vec<Option<usize>> =
            grown.keys.par_iter().map(|k| level.blocks.keys.binary_search(k).ok()).collect();
        let spread = |masks: &[Mask]| -> Vec<Mask> { place.iter().map(|p| p.map_or([0; 8], |b| masks[b])).collect() };
        let needed = dilate_box(&grown, &spread(&crossing));
        let old = spread(&level.known);
        let missing: Vec<Mask> = needed.iter().zip(&old).map(|(n, k)| std::array::from_fn(|z| n[z] & !k[z])).collect();
        if missing.iter().all(|m| *m == [0; 8]) {
            break;
        }
        let mut f = prolong(coarse, &grown, &missing);
        f.par_chunks_exact_mut(512).enumerate().for_each(|(b, f)| {
            if let Some(from) = place[b] {
                for (local, value) in f.iter_mut().enumerate() {
                    if mask_get(&old[b], local) {
                        *value = level.f[from * 512 + local];
                    }
                }
            }
        });
        let known = old.iter().zip(&missing).map(|(k, m)| std::array::from_fn(|z| k[z] | m[z])).collect();
        let nodes = keep_blocks_in_use(grown, known, f);
        level = Solved { index: level.index, ..nodes };
    }
    level
}

/// The nodes of block `b` at either end of an axis edge between known nodes along which F changes sign.
fn sign_changes(level: &Solved, b: usize) -> Mask {
    let inside = |b: usize| -> Mask {
        let mut mask = [0; 8];
        for (local, value) in level.f[b * 512..(b + 1) * 512].iter().enumerate() {
            if *value < 0.0 {
                mask_set(&mut mask, local);
            }
        }
        mask
    };
    let mut crossing = [0; 8];
    let own = inside(b);
    for axis in 0..3 {
        for ahead in [false, true] {
            let mut step = [0; 3];
            step[axis] = if ahead { 1 } else { -1 };
            let other = level.blocks.neighbors[b][neighbor_code(step)];
            let (far_known, far_inside) =
                if other == NONE { ([0; 8], [0; 8]) } else { (level.known[other as usize], inside(other as usize)) };
            let known = shift(&level.known[b], &far_known, axis, ahead);
            let sign = shift(&own, &far_inside, axis, ahead);
            for z in 0..8 {
                crossing[z] |= (own[z] ^ sign[z]) & known[z] & level.known[b][z];
            }
        }
    }
    crossing
}

/// The blocks in which a change of sign lies on the outermost nodes.
fn keys_on_rim(level: &Solved, crossing: &[Mask]) -> Vec<u64> {
    const INNER: u64 = 0x007e_7e7e_7e7e_7e00;
    let on_rim = |m: &Mask| m[0] | m[7] != 0 || m[1..7].iter().any(|w| w & !INNER != 0);
    (0..crossing.len()).filter(|&b| on_rim(&crossing[b])).map(|b| level.blocks.keys[b]).collect()
}

fn keep_blocks_in_use(blocks: Blocks, known: Vec<Mask>, f: Vec<f32>) -> Solved {
    let used: Vec<usize> = (0..blocks.len()).filter(|&b| known[b] != [0; 8]).collect();
    let keys = used.iter().map(|&b| blocks.keys[b]).collect();
    let mut kept = Vec::with_capacity(used.len() * 512);
    for &b in &used {
        kept.extend_from_slice(&f[b * 512..(b + 1) * 512]);
    }
    let known = used.iter().map(|&b| known[b]).collect();
    Solved { index: 0, blocks: Blocks::new(keys, blocks.extent), known, f: kept }
}
