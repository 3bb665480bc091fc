//! Cuts the polygon of a ring (4 or 6 vertices) into triangles.

/// The 14 triangulations of a hexagon: all fans and the two with a triangle in the middle are among them. Each is given by its
/// four triangles.
const HEXAGON: [[[usize; 3]; 4]; 14] = [
    // Fans.
    [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 5]],
    [[1, 2, 3], [1, 3, 4], [1, 4, 5], [1, 5, 0]],
    [[2, 3, 4], [2, 4, 5], [2, 5, 0], [2, 0, 1]],
    [[3, 4, 5], [3, 5, 0], [3, 0, 1], [3, 1, 2]],
    [[4, 5, 0], [4, 0, 1], [4, 1, 2], [4, 2, 3]],
    [[5, 0, 1], [5, 1, 2], [5, 2, 3], [5, 3, 4]],
    // Zigzags.
    [[0, 1, 2], [0, 2, 5], [2, 3, 5], [3, 4, 5]],
    [[0, 1, 5], [1, 2, 5], [2, 4, 5], [2, 3, 4]],
    [[1, 2, 3], [1, 3, 0], [3, 4, 0], [4, 5, 0]],
    [[1, 2, 0], [2, 3, 0], [3, 5, 0], [3, 4, 5]],
    [[2, 3, 4], [2, 4, 1], [4, 5, 1], [5, 0, 1]],
    [[2, 3, 1], [3, 4, 1], [4, 0, 1], [4, 5, 0]],
    // A triangle in the middle.
    [[0, 2, 4], [0, 1, 2], [2, 3, 4], [4, 5, 0]],
    [[1, 3, 5], [1, 2, 3], [3, 4, 5], [5, 0, 1]],
];

/// The two cuts of a quadrangle.
const QUADRANGLE: [[[usize; 3]; 2]; 2] = [[[0, 1, 2], [0, 2, 3]], [[1, 2, 3], [1, 3, 0]]];

/// How slim a triangle is: sum of squared sides over twice the area; negative area (against `normal`) counts as very slim.
fn slimness(p: [[f64; 3]; 3], normal: [f64; 3]) -> f64 {
    let side = |i: usize, j: usize| -> [f64; 3] { std::array::from_fn(|a| p[j][a] - p[i][a]) };
    let (u, v, w) = (side(0, 1), side(0, 2), side(1, 2));
    let square = |s: [f64; 3]| s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let facing = n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2];
    let sides = square(u) + square(v) + square(w);
    // A millionth of the sides bounds the figure for a folded or flat triangle; it then loses against any sound one.
    sides / (facing.max(1e-6 * sides))
}

/// The triangles of a ring's polygon with the least worst triangle. `normal` is the unit direction that the polygon faces.
pub(super) fn triangulate(polygon: &[[f64; 3]], normal: [f64; 3], mut emit: impl FnMut([usize; 3])) {
    // Costs are positive: a sum that has reached the least so far need not be finished.
    let cost = |triangles: &[[usize; 3]], least: f64| -> f64 {
        let mut sum = 0.0;
        for t in triangles {
            sum += slimness(t.map(|v| polygon[v]), normal);
            if sum >= least {
                break;
            }
        }
        sum
    };
    let best: &[[usize; 3]] = if polygon.len() == 4 {
        let first = cost(&QUADRANGLE[0], f64::INFINITY);
        &QUADRANGLE[usize::from(cost(&QUADRANGLE[1], first) < first)]
    } else {
        let mut best = (0, f64::INFINITY);
        for (i, triangles) in HEXAGON.iter().enumerate() {
            let c = cost(triangles, best.1);
            if c < best.1 {
                best = (i, c);
            }
        }
        &HEXAGON[best.0]
    };
    best.iter().for_each(|&t| emit(t));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_fourteen_are_distinct_and_cover_the_hexagon() {
        let corner = |i: usize| {
            let angle = i as f64 * std::f64::consts::TAU / 6.0;
            [angle.cos(), angle.sin(), 0.0]
        };
        let mut seen = BTreeSet::new();
        for triangles in HEXAGON {
            let area: f64 = triangles
                .iter()
                .map(|t| {
                    let [a, b, c] = t.map(corner);
                    0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
                })
                .inspect(|&a| assert!(a > 0.0))
                .sum();
            assert!((area - 1.5 * 3.0_f64.sqrt()).abs() < 1e-12);
            let mut set: Vec<BTreeSet<usize>> = triangles.iter().map(|t| t.iter().copied().collect()).collect();
            set.sort();
            assert!(seen.insert(set));
        }
        assert_eq!(seen.len(), 14);
    }

    #[test]
    fn a_dent_is_not_folded_over() {
        let dent = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [2.0, 0.0, 0.0], [1.0, 0.3, 0.0]];
        let mut triangles = Vec::new();
        triangulate(&dent, [0.0, 0.0, 1.0], |t| triangles.push(t));
        assert!(triangles.iter().all(|t| t.contains(&1) && t.contains(&3)));
    }
}
