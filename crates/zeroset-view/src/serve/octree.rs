//! Points in an octree, so that few of them show a large cloud from afar.
//!
//! A node holds points of its cube that lie apart, and its children the rest: what is drawn of a child is drawn beside its parent's points. The cube
//! of a node is cut into 128 cells a side, and the first point of each in the order of the Morton curve is the node's. As points lie on surfaces, that makes some
//! ten to thirty thousand. A cube with fewer points keeps all of them.
//!
//! Cost: sorting by Morton codes, and one pass over the points for each level.

use rayon::prelude::*;

/// A cube with no more points keeps them all.
const FEW: usize = 20_000;
/// Cells along a node, as a power of two.
const CELL_BITS: u32 = 7;
/// Bits of a code for each axis.
const BITS: u32 = 21;

/// A cube with points.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Node {
    /// Its parent's number.
    pub(super) parent: Option<u32>,
    /// Lowest corner.
    pub(super) low: [f64; 3],
    /// Side.
    pub(super) side: f64,
    /// About how far its points lie apart.
    pub(super) spacing: f64,
    /// Its points.
    pub(super) points: Vec<u32>,
}

/// Sorts points into nodes; parents come before their children. Points that are not finite are left out.
pub(super) fn octree(positions: &[[f64; 3]]) -> Vec<Node> {
    let finite = || positions.par_iter().enumerate().filter(|(_, p)| p.iter().all(|c| c.is_finite()));
    let none = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let join = |a: ([f64; 3], [f64; 3]), b: ([f64; 3], [f64; 3])| {
        (std::array::from_fn(|i| a.0[i].min(b.0[i])), std::array::from_fn(|i| a.1[i].max(b.1[i])))
    };
    let (low, high) = finite().map(|(_, p)| (*p, *p)).reduce(|| none, join);
    if low[0] > high[0] {
        return Vec::new();
    }
    let extent = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let side = if extent > 0.0 { extent } else { 1.0 };
    let steps = f64::from(1_u32 << BITS) / side;
    let code = |p: &[f64; 3]| {
        let at: [u64; 3] = std::array::from_fn(|a| (((p[a] - low[a]) * steps) as u64).min((1 << BITS) - 1));
        at.into_iter().enumerate().map(|(a, c)| spread(c) << a).sum::<u64>()
    };
    let mut codes: Vec<(u64, u32)> = finite().map(|(i, p)| (code(p), i as u32)).collect();
    codes.par_sort_unstable();
    let mut nodes = Vec::new();
    gather(&mut nodes, codes, 0, Cube { parent: None, low, side });
    nodes
}

/// The bits of a number, two zeros between each and the next.
fn spread(value: u64) -> u64 {
    let mut x = value & 0x1f_ffff;
    for (shift, mask) in [
        (32, 0x1f_0000_0000_ffff),
        (16, 0x1f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ] {
        x = (x | (x << shift)) & mask;
    }
    x
}

#[derive(Clone, Copy)]
struct Cube {
    parent: Option<u32>,
    low: [f64; 3],
    side: f64,
}

fn gather(nodes: &mut Vec<Node>, codes: Vec<(u64, u32)>, level: u32, cube: Cube) {
    let Cube { parent, low, side } = cube;
    let number = nodes.len() as u32;
    let is_last = codes.len() <= FEW || level + CELL_BITS >= BITS;
    let spacing = if is_last { side / (codes.len() as f64).sqrt() } else { side / f64::from(1_u32 << CELL_BITS) };
    let node = |points| Node { parent, low, side, spacing, points };
    if is_last {
        nodes.push(node(codes.into_iter().map(|(_, i)| i).collect()));
        return;
    }
    let shift = 3 * (BITS - level - CELL_BITS);
    let (mut own, mut rest) = (Vec::new(), Vec::with_capacity(codes.len()));
    let mut last = None;
    for entry in codes {
        let cell = Some(entry.0 >> shift);
        if cell == last {
            rest.push(entry)
        } else {
            own.push(entry.1)
        }
        last = cell;
    }
    nodes.push(node(own));
    let below = 3 * (BITS - level - 1);
    let mut from = 0;
    while from < rest.len() {
        let child = rest[from].0 >> below;
        let to = from + rest[from..].partition_point(|entry| entry.0 >> below == child);
        let half = 0.5 * side;
        let corner = std::array::from_fn(|a| low[a] + if child >> a & 1 == 1 { half } else { 0.0 });
        gather(nodes, rest[from..to].to_vec(), level + 1, Cube { parent: Some(number), low: corner, side: half });
        from = to;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use zeroset::sample::{Scene, SceneKind};

    #[test]
    fn every_point_is_in_one_node_and_in_its_cube() {
        let mut points = Scene::new(SceneKind::City, 1).points(300_000, 0.001, 1).points;
        points.extend([[f64::NAN, 0.0, 0.0], [0.0, f64::INFINITY, 0.0]]);
        let nodes = octree(&points);
        let mut seen = vec![0; points.len()];
        for (i, node) in nodes.iter().enumerate() {
            assert!(node.parent.is_none_or(|parent| (parent as usize) < i) && (node.parent.is_none() == (i == 0)));
            let slack = 1e-5 * nodes[0].side;
            for &k in &node.points {
                seen[k as usize] += 1;
                let p = points[k as usize];
                let within = |a: usize| p[a] >= node.low[a] - slack && p[a] <= node.low[a] + node.side + slack;
                assert!((0..3).all(within), "{p:?} in {:?}, {}", node.low, node.side);
            }
            if let Some(parent) = node.parent {
                let outer = &nodes[parent as usize];
                assert_eq!(node.side, 0.5 * outer.side);
                assert!((0..3).all(
                    |a| node.low[a] >= outer.low[a] && node.low[a] + node.side <= outer.low[a] + outer.side + slack
                ));
            }
        }
        assert!(seen[..300_000].iter().all(|n| *n == 1) && seen[300_000..] == [0, 0]);
        let sizes: Vec<usize> = nodes.iter().map(|node| node.points.len()).collect();
        assert!(nodes.len() > 10 && sizes.iter().all(|n| *n <= 40_000), "{sizes:?}");
    }

    #[test]
    fn points_in_one_place_and_no_points_end() {
        assert_eq!(octree(&[]), []);
        assert_eq!(octree(&[[f64::NAN; 3]]), []);
        let same = octree(&vec![[3.0; 3]; 50_000]);
        assert_eq!(same.iter().map(|node| node.points.len()).sum::<usize>(), 50_000);
    }
}
