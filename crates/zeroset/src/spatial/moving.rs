//! A tree over boxes that change.

use super::tree::Aabb;
use crate::domain::morton_code;
use crate::vec3::{self, Vec3};

/// Items that share a leaf, so that the tree is small beside what it is over.
const LEAF: usize = 4;
/// Cells along each axis of the grid in whose order the items come.
const GRID: f64 = 1024.0;

/// Finds the items whose boxes meet a box, while items move a little and go.
///
/// Items are sorted along the Morton curve, and a complete binary tree stands over them; when an item changes, the boxes above
/// it are made anew. The order stays, so the tree should be built again when most items have gone. The boxes themselves are
/// the caller's: `aabb` gives the lowest and highest corner of an item, or `None` once it is gone.
///
/// Building costs O(n log n), a change O(log n), a query O(log n + found) while items stay near where they were.
#[derive(Debug)]
pub(crate) struct MovingBoxes {
    /// Items in their order.
    items: Vec<u32>,
    /// Where each item is among them.
    places: Vec<u32>,
    /// Node i is over 2 i + 1 and 2 i + 2; the leaves come last.
    nodes: Vec<Aabb>,
    leaves: usize,
}

impl MovingBoxes {
    /// A tree over the items below `count` that are there.
    pub(crate) fn new(count: usize, aabb: &impl Fn(u32) -> Option<[Vec3; 2]>) -> Self {
        let boxes = (0..count as u32).filter_map(|item| Some((item, aabb(item)?)));
        let centred: Vec<(u32, Vec3)> = boxes.map(|(item, [low, high])| (item, vec3::lerp(low, high, 0.5))).collect();
        let all = centred.iter().fold(Aabb::EMPTY, |all, (_, centre)| all.union(Aabb::of(*centre)));
        let mut keyed: Vec<(u64, u32)> = centred.iter().map(|(item, centre)| (key(*centre, &all), *item)).collect();
        keyed.sort_unstable();
        let items: Vec<u32> = keyed.into_iter().map(|(_, item)| item).collect();
        let mut places = vec![0; count];
        for (place, &item) in items.iter().enumerate() {
            places[item as usize] = place as u32;
        }
        let leaves = items.len().div_ceil(LEAF).next_power_of_two();
        let mut tree = Self { items, places, nodes: vec![Aabb::EMPTY; 2 * leaves - 1], leaves };
        for leaf in 0..leaves {
            tree.nodes[leaves - 1 + leaf] = tree.leaf_box(leaf, aabb);
        }
        for node in (0..leaves - 1).rev() {
            tree.nodes[node] = tree.nodes[2 * node + 1].union(tree.nodes[2 * node + 2]);
        }
        tree
    }

    fn items_of(&self, leaf: usize) -> &[u32] {
        let begin = (LEAF * leaf).min(self.items.len());
        &self.items[begin..(begin + LEAF).min(self.items.len())]
    }

    fn leaf_box(&self, leaf: usize, aabb: &impl Fn(u32) -> Option<[Vec3; 2]>) -> Aabb {
        let boxes = self.items_of(leaf).iter().filter_map(|&item| aabb(item));
        boxes.fold(Aabb::EMPTY, |all, [low, high]| all.union(Aabb { low, high }))
    }

    /// An item has moved or gone.
    pub(crate) fn update(&mut self, item: u32, aabb: &impl Fn(u32) -> Option<[Vec3; 2]>) {
        let leaf = self.places[item as usize] as usize / LEAF;
        let mut node = self.leaves - 1 + leaf;
        let mut now = self.leaf_box(leaf, aabb);
        while self.nodes[node] != now {
            self.nodes[node] = now;
            if node == 0 {
                return;
            }
            node = (node - 1) / 2;
            now = self.nodes[2 * node + 1].union(self.nodes[2 * node + 2]);
        }
    }

    /// Calls `visit` with every item, gone ones among them, that shares a leaf with one whose box may meet the given one.
    pub(crate) fn visit_near(&self, low: Vec3, high: Vec3, visit: &mut impl FnMut(u32)) {
        let wanted = Aabb { low, high };
        let mut waiting = vec![0];
        while let Some(node) = waiting.pop() {
            if !self.nodes[node].meets(&wanted) {
                continue;
            }
            match node.checked_sub(self.leaves - 1) {
                Some(leaf) => self.items_of(leaf).iter().for_each(|&item| visit(item)),
                None => waiting.extend([2 * node + 2, 2 * node + 1]),
            }
        }
    }
}

/// The place of a position along the Morton curve through a box.
fn key(position: Vec3, within: &Aabb) -> u64 {
    // The cast keeps within 0 and what 32 bits hold.
    let cell = |axis: usize| {
        let extent = within.high[axis] - within.low[axis];
        let share = if extent > 0.0 { (position[axis] - within.low[axis]) / extent } else { 0.0 };
        ((share * GRID) as u32).min(GRID as u32 - 1)
    };
    morton_code([cell(0), cell(1), cell(2)])
}
