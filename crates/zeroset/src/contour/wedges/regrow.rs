//! Growth that keeps the topology.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::LazyLock;

use rustc_hash::FxHashMap;

use super::{Node, stepped};
use crate::domain::{BLOCK_NODES, mask_get};
use crate::field::LatticeField;

/// Steps to the fourteen nodes with which a node shares an edge.
type Steps = [[i32; 3]; 14];

/// These steps, and for each the set of those whose nodes share an edge with its own.
static LINK: LazyLock<(Steps, [u16; 14])> = LazyLock::new(|| {
    let steps: Steps = std::array::from_fn(|k| {
        let (subset, sign) = (k / 2 + 1, if k % 2 == 0 { 1 } else { -1 });
        std::array::from_fn(|a| sign * (subset >> a & 1) as i32)
    });
    let is_edge = |a: [i32; 3], b: [i32; 3]| {
        let apart: [i32; 3] = std::array::from_fn(|i| b[i] - a[i]);
        apart != [0; 3] && (apart.iter().all(|c| (0..=1).contains(c)) || apart.iter().all(|c| (-1..=0).contains(c)))
    };
    let beside = |a: usize| (0..14).filter(|&b| is_edge(steps[a], steps[b])).fold(0, |set, b| set | 1 << b);
    (steps, std::array::from_fn(beside))
});

/// All fourteen.
const ALL: u16 = (1 << 14) - 1;

/// Whether a node can change sides without a change of topology, if those around it that are inside are these: they, and the others, must hang
/// together. The nodes around one are the corners of a sphere of triangles, so neither set has a hole then.
fn is_simple(inside: u16) -> bool {
    hang_together(inside) && hang_together(ALL & !inside)
}

/// Whether a set of neighbours is connected, and not empty.
fn hang_together(set: u16) -> bool {
    let (_, beside) = &*LINK;
    let mut reached = set & set.wrapping_neg();
    loop {
        let next = (0..14).filter(|k| reached >> k & 1 == 1).fold(reached, |all, k| all | beside[k] & set);
        if next == reached {
            return set != 0 && reached == set;
        }
        reached = next;
    }
}

/// What is as thick as to have a node this far from the surface is no chance, in cells: it may be a piece of its own ...
const OWN_PIECE: f32 = 0.5;
/// ... or alter the topology of another.
const SURE: f32 = 0.75;

/// Gives nodes their values back, those first that are farthest from zero, unless that would alter the topology. Then, for what is left and thick, even so.
pub(super) fn regrow(values: &mut LatticeField, wanted: &FxHashMap<Node, f32>) {
    let mut all: Vec<Entry> = wanted.iter().map(|(&node, &value)| entry(node, value)).collect();
    all.sort_unstable_by(|a, b| b.cmp(a));
    grow(values, wanted, all.clone());
    let [own_piece, sure] = [OWN_PIECE, SURE].map(|cells| cells * values.lattice.spacing as f32);
    for (_, Reverse(node)) in all {
        let value = wanted[&node];
        if value.abs() < own_piece {
            break;
        }
        let is_same = |node: Node| (values.values[node] < 0.0) == (value < 0.0);
        if is_same(node) {
            continue;
        }
        let Some(around) = around(values, node) else { continue };
        if value.abs() < sure && around.iter().any(|&next| is_same(next)) {
            continue;
        }
        values.values[node] = value;
        grow(values, wanted, entries(wanted, around));
    }
}

/// A node in the order of growth: the distance of its value from zero, and the node.
type Entry = (u32, Reverse<Node>);

fn entry(node: Node, value: f32) -> Entry {
    (value.abs().to_bits(), Reverse(node))
}

/// Those of some nodes that want a value.
fn entries(wanted: &FxHashMap<Node, f32>, nodes: [Node; 14]) -> Vec<Entry> {
    nodes.iter().filter_map(|&node| Some(entry(node, *wanted.get(&node)?))).collect()
}

/// Gives nodes, and those around them, their values back where that is simple.
fn grow(values: &mut LatticeField, wanted: &FxHashMap<Node, f32>, first: Vec<Entry>) {
    let mut open = BinaryHeap::from(first);
    while let Some((_, Reverse(node))) = open.pop() {
        let value = wanted[&node];
        if (values.values[node] < 0.0) == (value < 0.0) {
            continue;
        }
        let Some(around) = around(values, node) else { continue };
        let is_inside = |k: &usize| values.values[around[*k]] < 0.0;
        if is_simple((0..14).filter(is_inside).fold(0, |set, k| set | 1 << k)) {
            values.values[node] = value;
            open.extend(entries(wanted, around));
        }
    }
}

/// The nodes around one, if all are known.
fn around(values: &LatticeField, node: Node) -> Option<[Node; 14]> {
    let mut found = [0; 14];
    for (found, step) in found.iter_mut().zip(LINK.0) {
        let next = stepped(values, node, step)?;
        if !mask_get(&values.known[next / BLOCK_NODES], next % BLOCK_NODES) {
            return None;
        }
        *found = next;
    }
    Some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nodes_around_one_are_the_corners_of_a_sphere_of_triangles() {
        let (steps, beside) = &*LINK;
        let edges: u32 = beside.iter().map(|set| set.count_ones()).sum::<u32>() / 2;
        // Euler: 14 corners, 36 edges and 24 triangles.
        assert_eq!(edges, 36);
        for (k, step) in steps.iter().enumerate() {
            assert_eq!(beside[k] >> k & 1, 0);
            let expected = if step.iter().filter(|c| **c != 0).count() == 2 { 4 } else { 6 };
            assert_eq!(beside[k].count_ones(), expected, "{step:?}");
        }
    }

    #[test]
    fn a_node_is_simple_where_both_sides_hang_together() {
        assert!(!is_simple(0) && !is_simple(ALL));
        for k in 0..14 {
            assert!(is_simple(1 << k) && is_simple(ALL & !(1 << k)));
            // Opposite nodes: a handle would be made, or a piece split.
            assert!(!is_simple(1 << k | 1 << (k ^ 1)));
        }
    }
}
