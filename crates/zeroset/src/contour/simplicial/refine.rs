//! A tetrahedron cut into eight, over and over: the same cut for every cell, so that faces match.
//!
//! Each edge is halved. Four children sit at the corners, four around a diagonal of the octahedron between them. Bey's order of their
//! corners (1995) keeps the shapes at three classes however often the cut is repeated. Faces are cut along their edges' middles
//! only, so both sides of a face cut it alike.

use rustc_hash::FxHashMap;

/// The children of a tetrahedron by the middles of its corners i and j; i = j is the corner itself.
const CHILDREN: [[[usize; 2]; 4]; 8] = [
    [[0, 0], [0, 1], [0, 2], [0, 3]],
    [[0, 1], [1, 1], [1, 2], [1, 3]],
    [[0, 2], [1, 2], [2, 2], [2, 3]],
    [[0, 3], [1, 3], [2, 3], [3, 3]],
    [[0, 1], [0, 2], [0, 3], [1, 3]],
    [[0, 1], [0, 2], [1, 2], [1, 3]],
    [[0, 2], [0, 3], [1, 3], [2, 3]],
    [[0, 2], [1, 2], [1, 3], [2, 3]],
];

/// Barycentric coordinates in parts of a whole.
pub(super) type Weights = [u32; 4];

/// How a tetrahedron is cut.
pub(super) struct Refinement {
    /// The sum of the weights of each node.
    pub(super) whole: u32,
    /// The nodes.
    pub(super) nodes: Vec<Weights>,
    /// The parts, as indices of nodes; positively oriented if the tetrahedron is.
    pub(super) parts: Vec<[u32; 4]>,
}

impl Refinement {
    pub(super) fn new(times: u32) -> Self {
        let whole = 1 << times;
        let mut parts: Vec<[Weights; 4]> =
            vec![std::array::from_fn(|c| std::array::from_fn(|k| if c == k { whole } else { 0 }))];
        for _ in 0..times {
            parts = parts
                .iter()
                .flat_map(|part| CHILDREN.map(|child| child.map(|[i, j]| middle(part[i], part[j]))))
                .collect();
        }
        let mut indices: FxHashMap<Weights, u32> = FxHashMap::default();
        let mut nodes = Vec::new();
        let mut index = |weights: Weights| {
            *indices.entry(weights).or_insert_with(|| {
                nodes.push(weights);
                nodes.len() as u32 - 1
            })
        };
        let parts = parts
            .into_iter()
            .map(|mut part| {
                if !is_positive(&part) {
                    part.swap(2, 3);
                }
                part.map(&mut index)
            })
            .collect();
        Self { whole, nodes, parts }
    }
}

fn middle(p: Weights, q: Weights) -> Weights {
    std::array::from_fn(|k| (p[k] + q[k]) / 2)
}

/// Whether corners have the orientation of the whole tetrahedron.
fn is_positive(part: &[Weights; 4]) -> bool {
    let side =
        |c: usize| -> [i64; 3] { std::array::from_fn(|k| i64::from(part[c][k + 1]) - i64::from(part[0][k + 1])) };
    let [u, v, w] = [side(1), side(2), side(3)];
    let minor = |i: usize, j: usize| v[i] * w[j] - v[j] * w[i];
    u[0] * minor(1, 2) + u[1] * minor(2, 0) + u[2] * minor(0, 1) > 0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_fill_the_tetrahedron() {
        for times in 0..4 {
            let refinement = Refinement::new(times);
            assert_eq!(refinement.parts.len(), 8_usize.pow(times));
            let n = (1 << times) + 1;
            assert_eq!(refinement.nodes.len(), n * (n + 1) * (n + 2) / 6);
            assert!(refinement.nodes.iter().all(|w| w.iter().sum::<u32>() == refinement.whole));
            let corners = |part: &[u32; 4]| part.map(|node| refinement.nodes[node as usize]);
            assert!(refinement.parts.iter().all(|part| is_positive(&corners(part))));
        }
    }
}
