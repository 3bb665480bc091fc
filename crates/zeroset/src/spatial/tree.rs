//! The tree that both kinds of item share: median splits, tight boxes, nodes in depth-first order.

use rayon::prelude::*;

use crate::vec3::{self, Vec3};

/// Below this many items a subtree is built by one thread: splitting finer costs more in hand-over than it gains.
const SEQUENTIAL: usize = 16_384;

/// An axis-aligned box.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Aabb {
    pub(super) low: Vec3,
    pub(super) high: Vec3,
}

impl Aabb {
    /// The box of nothing; the union with it changes no box.
    pub(super) const EMPTY: Self = Self { low: [f64::INFINITY; 3], high: [f64::NEG_INFINITY; 3] };

    #[inline]
    pub(super) fn of(point: Vec3) -> Self {
        Self { low: point, high: point }
    }

    #[inline]
    pub(super) fn union(self, other: Self) -> Self {
        Self { low: vec3::min(self.low, other.low), high: vec3::max(self.high, other.high) }
    }

    /// Whether two boxes have a point in common.
    #[inline]
    pub(super) fn meets(&self, other: &Self) -> bool {
        (0..3).all(|a| self.low[a] <= other.high[a] && other.low[a] <= self.high[a])
    }

    /// Squared distance to the box, 0 inside.
    ///
    /// Each operation rounds monotonically and in the order of [`vec3::distance_squared`], so the result never exceeds
    /// the computed squared distance to any point in the box. Pruning by it loses no answer.
    #[inline]
    pub(super) fn distance_squared(&self, q: Vec3) -> f64 {
        let gap = |a: usize| (self.low[a] - q[a]).max(q[a] - self.high[a]).max(0.0);
        let (x, y, z) = (gap(0), gap(1), gap(2));
        x * x + y * y + z * z
    }

    /// Squared distance to the farthest corner, with the same care about rounding.
    #[inline]
    pub(super) fn farthest_squared(&self, q: Vec3) -> f64 {
        let reach = |a: usize| (q[a] - self.low[a]).max(self.high[a] - q[a]);
        let (x, y, z) = (reach(0), reach(1), reach(2));
        x * x + y * y + z * z
    }

    /// The axis along which the box is longest; the first of equals.
    fn longest_axis(&self) -> usize {
        let extent = vec3::sub(self.high, self.low);
        let mut axis = 0;
        for candidate in 1..3 {
            if extent[candidate] > extent[axis] {
                axis = candidate;
            }
        }
        axis
    }
}

/// What a tree holds.
pub(super) trait Item: Copy + Send + Sync {
    /// The most items in a leaf.
    const LEAF: usize;
    /// Where the item counts as lying when items are split.
    fn centre(&self) -> Vec3;
    /// The tight box.
    fn aabb(&self) -> Aabb;
    /// The caller's number of this item.
    fn index(&self) -> usize;
}

/// An inner node: the boxes of its children and the lowest index under each.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    pub(super) aabb: [Aabb; 2],
    pub(super) first: [usize; 2],
}

impl Node {
    const UNSET: Self = Self { aabb: [Aabb::EMPTY; 2], first: [usize::MAX; 2] };
}

/// A subtree: where its root is among the nodes, which items it holds, and how many levels of nodes it has.
#[derive(Debug, Clone, Copy)]
pub(super) struct Subtree {
    pub(super) node: usize,
    pub(super) begin: usize,
    pub(super) end: usize,
    pub(super) levels: u32,
}

impl Subtree {
    pub(super) fn len(&self) -> usize {
        self.end - self.begin
    }

    /// The two halves of an inner subtree. With `levels` levels the left one fills 2^(levels-1) - 1 nodes.
    #[inline]
    pub(super) fn children(&self) -> [Self; 2] {
        let middle = self.begin + self.len() / 2;
        let levels = self.levels - 1;
        [
            Self { node: self.node + 1, begin: self.begin, end: middle, levels },
            Self { node: self.node + (1 << levels), begin: middle, end: self.end, levels },
        ]
    }
}

/// What a nearest-first search collects.
pub(super) trait Collector<T> {
    /// Nothing at or after this (squared distance, index) can still matter.
    fn limit(&self) -> (f64, usize);
    /// Looks at the items of a leaf.
    fn leaf(&mut self, items: &[T]);
}

#[derive(Debug, Clone)]
pub(super) struct Tree<T> {
    pub(super) items: Vec<T>,
    pub(super) nodes: Vec<Node>,
    pub(super) aabb: Aabb,
    pub(super) first: usize,
    levels: u32,
}

impl<T: Item> Tree<T> {
    /// A tree over items whose indices rise.
    pub(super) fn new(items: Vec<T>) -> Self {
        let mut levels = 0;
        while items.len().div_ceil(1 << levels) > T::LEAF {
            levels += 1;
        }
        let key = |(slot, item): (usize, &T)| Key { centre: item.centre(), slot };
        let mut keys: Vec<Key> = items.par_iter().enumerate().map(key).collect();
        sort(&mut keys, levels);
        let items: Vec<T> = keys.into_par_iter().map(|key| items[key.slot]).collect();
        let nodes = vec![Node::UNSET; (1 << levels) - 1];
        let mut tree = Self { items, nodes, aabb: Aabb::EMPTY, first: usize::MAX, levels };
        tree.fit_boxes();
        tree
    }

    /// Makes the boxes those of the items, which may have moved since.
    pub(super) fn fit_boxes(&mut self) {
        (self.aabb, self.first) = fit(&self.items, &mut self.nodes, self.levels);
    }

    pub(super) fn root(&self) -> Subtree {
        Subtree { node: 0, begin: 0, end: self.items.len(), levels: self.levels }
    }

    pub(super) fn items_of(&self, subtree: Subtree) -> &[T] {
        &self.items[subtree.begin..subtree.end]
    }

    /// Visits leaves from near to far until the collector's limit rules out the rest.
    pub(super) fn nearest_first(&self, q: Vec3, collector: &mut impl Collector<T>) {
        if self.items.is_empty() || (self.aabb.distance_squared(q), self.first) >= collector.limit() {
            return;
        }
        self.descend(self.root(), q, collector);
    }

    /// Recursion, as its frames are free: a stack of its own would have to be cleared or allocated for each search.
    fn descend(&self, subtree: Subtree, q: Vec3, collector: &mut impl Collector<T>) {
        if subtree.levels == 0 {
            collector.leaf(self.items_of(subtree));
            return;
        }
        let node = &self.nodes[subtree.node];
        let children = subtree.children();
        let rank = [0, 1].map(|side| (node.aabb[side].distance_squared(q), node.first[side]));
        let near = usize::from(rank[1] < rank[0]);
        if rank[near] < collector.limit() {
            self.descend(children[near], q, collector);
        }
        if rank[1 - near] < collector.limit() {
            self.descend(children[1 - near], q, collector);
        }
    }
}

/// Where an item counts as lying. Sorting these is cheaper than sorting the items.
struct Key {
    centre: Vec3,
    slot: usize,
}

/// Sorts keys into the order of the leaves.
fn sort(keys: &mut [Key], levels: u32) {
    if levels == 0 {
        return;
    }
    let axis = keys.iter().fold(Aabb::EMPTY, |all, key| all.union(Aabb::of(key.centre))).longest_axis();
    let middle = keys.len() / 2;
    // The slot breaks ties, so which item goes where follows from the items alone, and equal points are sorted by index.
    keys.select_nth_unstable_by(middle, |a, b| a.centre[axis].total_cmp(&b.centre[axis]).then(a.slot.cmp(&b.slot)));
    let parallel = keys.len() > SEQUENTIAL;
    let (left, right) = keys.split_at_mut(middle);
    if parallel {
        rayon::join(|| sort(left, levels - 1), || sort(right, levels - 1));
    } else {
        sort(left, levels - 1);
        sort(right, levels - 1);
    }
}

/// Fills the nodes, and gives the box and the lowest index of the whole.
fn fit<T: Item>(items: &[T], nodes: &mut [Node], levels: u32) -> (Aabb, usize) {
    if levels == 0 {
        return items
            .iter()
            .fold((Aabb::EMPTY, usize::MAX), |(aabb, first), item| (aabb.union(item.aabb()), first.min(item.index())));
    }
    let (left_items, right_items) = items.split_at(items.len() / 2);
    let (node, below) = nodes.split_first_mut().expect("a subtree of one or more levels has a root");
    let (left_nodes, right_nodes) = below.split_at_mut((1 << (levels - 1)) - 1);
    let (left, right) = if items.len() > SEQUENTIAL {
        rayon::join(|| fit(left_items, left_nodes, levels - 1), || fit(right_items, right_nodes, levels - 1))
    } else {
        (fit(left_items, left_nodes, levels - 1), fit(right_items, right_nodes, levels - 1))
    };
    *node = Node { aabb: [left.0, right.0], first: [left.1, right.1] };
    (left.0.union(right.0), left.1.min(right.1))
}
