//! Triangles whose boxes meet a box.

use super::tree::{Aabb, Item, Subtree};
use super::triangles::TriangleTree;
use crate::vec3::Vec3;

impl TriangleTree {
    /// Calls `visit` with the index of every triangle whose box meets the box, borders included. O(log n) for a small box.
    pub(crate) fn visit_meeting(&self, low: Vec3, high: Vec3, visit: &mut impl FnMut(usize)) {
        let wanted = Aabb { low, high };
        if !self.is_empty() && self.tree.aabb.meets(&wanted) {
            self.descend_meeting(self.tree.root(), &wanted, visit);
        }
    }

    /// The triangles held, neighbours in space mostly side by side.
    pub(crate) fn leaf_order(&self) -> Vec<u32> {
        self.tree.items.iter().map(|item| item.index as u32).collect()
    }

    fn descend_meeting(&self, subtree: Subtree, wanted: &Aabb, visit: &mut impl FnMut(usize)) {
        if subtree.levels == 0 {
            for item in self.tree.items_of(subtree) {
                if item.aabb().meets(wanted) {
                    visit(item.index);
                }
            }
            return;
        }
        let node = &self.tree.nodes[subtree.node];
        for (child, aabb) in subtree.children().into_iter().zip(&node.aabb) {
            if aabb.meets(wanted) {
                self.descend_meeting(child, wanted, visit);
            }
        }
    }
}
