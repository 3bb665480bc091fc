//! The ring of tetrahedra around each of the seven kinds of lattice edge.

use std::sync::LazyLock;

use crate::domain::TETRAHEDRA;

/// A tetrahedron around an edge: the step (0 or -1 along each axis) from the cell of the edge's first node, and its index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct RingMember {
    pub(super) step: [i32; 3],
    pub(super) tetrahedron: usize,
}

/// For each non-empty subset of the axes, as bits, the tetrahedra around the edge from a node to the node at that subset:
/// counter-clockwise seen from the edge's far end.
pub(super) static RINGS: LazyLock<[Vec<RingMember>; 8]> = LazyLock::new(|| std::array::from_fn(ring));

fn ring(subset: usize) -> Vec<RingMember> {
    let mut members: Vec<(f64, RingMember)> = Vec::new();
    if subset == 0 {
        return Vec::new();
    }
    let along: [f64; 3] = std::array::from_fn(|a| (subset >> a & 1) as f64);
    // Two directions that make a right-handed frame with the edge.
    let helper = if subset == 1 { [0.0, 1.0, 0.0] } else { [1.0, 0.0, 0.0] };
    let u = cross(along, helper);
    let v = cross(along, u);
    for before in 0..8_usize {
        if before & subset != 0 {
            continue;
        }
        for (t, tetrahedron) in TETRAHEDRA.iter().enumerate() {
            // In the cell at -before the edge runs from corner `before` to corner `before | subset`.
            if !(tetrahedron.corners.contains(&before) && tetrahedron.corners.contains(&(before | subset))) {
                continue;
            }
            let centre: [f64; 3] = std::array::from_fn(|a| {
                let sum: usize = tetrahedron.corners.iter().map(|c| c >> a & 1).sum();
                sum as f64 / 4.0 - (before >> a & 1) as f64 - 0.5 * along[a]
            });
            let step = std::array::from_fn(|a| -((before >> a & 1) as i32));
            let angle = dot(centre, v).atan2(dot(centre, u) * dot(v, v).sqrt() / dot(u, u).sqrt());
            members.push((angle, RingMember { step, tetrahedron: t }));
        }
    }
    members.sort_by(|a, b| a.0.total_cmp(&b.0));
    members.into_iter().map(|m| m.1).collect()
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn nodes(member: &RingMember) -> Vec<[i32; 3]> {
        TETRAHEDRA[member.tetrahedron]
            .corners
            .iter()
            .map(|c| std::array::from_fn(|a| member.step[a] + (c >> a & 1) as i32))
            .collect()
    }

    #[test]
    fn neighbours_in_a_ring_share_a_face_and_others_only_the_edge() {
        for subset in 1..8_usize {
            let ring = &RINGS[subset];
            assert_eq!(ring.len(), if subset.count_ones() == 2 { 4 } else { 6 });
            for (i, a) in ring.iter().enumerate() {
                for (j, b) in ring.iter().enumerate() {
                    let shared = nodes(a).iter().filter(|n| nodes(b).contains(n)).count();
                    let apart = (i + ring.len() - j) % ring.len();
                    let expected = match apart {
                        0 => 4,
                        1 => 3,
                        _ if apart == ring.len() - 1 => 3,
                        _ => 2,
                    };
                    assert_eq!(shared, expected, "subset {subset}: {i} and {j}");
                }
            }
        }
    }
}
