//! The blocks of one level that are stored, and who their neighbours are.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::morton;

/// Nodes in a block.
pub const BLOCK_NODES: usize = 512;
/// No block there.
pub const NONE: u32 = u32::MAX;

/// Morton key of the block at these block coordinates.
#[inline]
#[must_use]
pub fn block_key(block: [u32; 3]) -> u64 {
    morton::encode(block)
}

/// Block coordinates of a key.
#[inline]
#[must_use]
pub fn block_of_key(key: u64) -> [u32; 3] {
    morton::decode(key)
}

/// Place of a neighbour in the list of 27, from steps of -1, 0 or 1; the block itself is 13.
#[inline]
#[must_use]
pub fn neighbor_code(step: [i32; 3]) -> usize {
    (step[0] + 1 + 3 * (step[1] + 1) + 9 * (step[2] + 1)) as usize
}

/// A set of blocks of one level, sorted along the Morton curve, with the 27 neighbours of each.
#[derive(Debug, Clone, Default)]
pub struct Blocks {
    /// Morton keys, ascending.
    pub keys: Vec<u64>,
    /// Block coordinates.
    pub coordinates: Vec<[u32; 3]>,
    /// Indices of the neighbours by [`neighbor_code`], or [`NONE`].
    pub neighbors: Vec<[u32; 27]>,
    /// Blocks along each axis of the whole level.
    pub extent: [u32; 3],
    index: Index,
}

/// The place of each block among those that are stored.
#[derive(Debug, Clone)]
enum Index {
    /// An entry for every block of the level, x fastest.
    Dense(Vec<u32>),
    /// By key.
    Sparse(FxHashMap<u64, u32>),
}

/// Levels of so many blocks at most have a dense index.
const MOST_DENSE: u64 = 1 << 22;

impl Default for Index {
    fn default() -> Self {
        Self::Dense(Vec::new())
    }
}

impl Index {
    fn new(keys: &[u64], coordinates: &[[u32; 3]], extent: [u32; 3]) -> Self {
        let all = extent.iter().try_fold(1_u64, |all, &n| all.checked_mul(u64::from(n)));
        let Some(all) = all.filter(|&all| all <= MOST_DENSE) else {
            return Self::Sparse(keys.iter().enumerate().map(|(i, &k)| (k, i as u32)).collect());
        };
        let mut places = vec![NONE; all as usize];
        for (i, c) in coordinates.iter().enumerate() {
            places[dense_place(*c, extent)] = i as u32;
        }
        Self::Dense(places)
    }

    /// The place of a block within the level.
    #[inline]
    fn get(&self, block: [u32; 3], extent: [u32; 3]) -> Option<u32> {
        match self {
            Self::Dense(places) => places.get(dense_place(block, extent)).copied().filter(|&place| place != NONE),
            Self::Sparse(places) => places.get(&block_key(block)).copied(),
        }
    }
}

#[inline]
fn dense_place([x, y, z]: [u32; 3], extent: [u32; 3]) -> usize {
    x as usize + extent[0] as usize * (y as usize + extent[1] as usize * z as usize)
}

impl Blocks {
    /// A set from its keys, which must be ascending and distinct.
    #[must_use]
    pub fn new(keys: Vec<u64>, extent: [u32; 3]) -> Self {
        debug_assert!(keys.is_sorted_by(|a, b| a < b));
        let coordinates: Vec<[u32; 3]> = keys.par_iter().map(|&k| block_of_key(k)).collect();
        let index = Index::new(&keys, &coordinates, extent);
        let neighbors = coordinates
            .par_iter()
            .map(|&c| {
                std::array::from_fn(|code| {
                    let step = [code % 3, code / 3 % 3, code / 9].map(|s| s as u32);
                    let n: [u32; 3] = std::array::from_fn(|a| (c[a] + step[a]).wrapping_sub(1));
                    if (0..3).all(|a| n[a] < extent[a]) { index.get(n, extent).unwrap_or(NONE) } else { NONE }
                })
            })
            .collect();
        Self { keys, coordinates, neighbors, extent, index }
    }

    /// Every block of a level.
    #[must_use]
    pub fn dense(extent: [u32; 3]) -> Self {
        let mut keys: Vec<u64> = (0..extent[2])
            .flat_map(|z| (0..extent[1]).flat_map(move |y| (0..extent[0]).map(move |x| block_key([x, y, z]))))
            .collect();
        keys.sort_unstable();
        Self::new(keys, extent)
    }

    /// Number of blocks.
    #[must_use]
    pub fn len(&self) -> usize {
        self.keys.len()
    }

    /// Whether there is no block.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    /// Index of the block at these block coordinates.
    #[must_use]
    pub fn find(&self, block: [u32; 3]) -> Option<usize> {
        if (0..3).any(|a| block[a] >= self.extent[a]) {
            return None;
        }
        self.index.get(block, self.extent).map(|i| i as usize)
    }

    /// Whether the block's face on this side of `axis` is a face of the whole domain.
    #[must_use]
    pub fn at_domain_face(&self, b: usize, axis: usize, far: bool) -> bool {
        self.coordinates[b][axis] == if far { self.extent[axis] - 1 } else { 0 }
    }

    /// The keys of these blocks and of all their 26 neighbours inside the domain, ascending.
    #[must_use]
    pub fn grown_keys(keys: &[u64], extent: [u32; 3]) -> Vec<u64> {
        let mut grown: Vec<u64> = keys
            .par_iter()
            .flat_map_iter(|&key| {
                let c = block_of_key(key);
                (0..27_u32).filter_map(move |code| {
                    let step = [code % 3, code / 3 % 3, code / 9];
                    let n: [u32; 3] = std::array::from_fn(|a| (c[a] + step[a]).wrapping_sub(1));
                    (0..3).all(|a| n[a] < extent[a]).then(|| block_key(n))
                })
            })
            .collect();
        grown.par_sort_unstable();
        grown.dedup();
        grown
    }
}
