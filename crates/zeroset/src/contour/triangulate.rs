//! Cuts the polygon of a ring into triangles: of all cuts, the one whose triangles are least slim in sum.

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

/// The slimness of a triangle that is seen edge on; it loses against any sound one.
const EDGE_ON: f64 = 1e6;

/// How slim a triangle is: sum of squared sides over twice the area. One that faces against `normal` is worse than any other, the more so the
/// more it does: of several folded cuts the least folded is taken.
fn slimness(p: [[f64; 3]; 3], normal: [f64; 3]) -> f64 {
    let side = |i: usize, j: usize| -> [f64; 3] { std::array::from_fn(|a| p[j][a] - p[i][a]) };
    let (u, v, w) = (side(0, 1), side(0, 2), side(1, 2));
    let square = |s: [f64; 3]| s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let facing = n[0] * normal[0] + n[1] * normal[1] + n[2] * normal[2];
    let sides = square(u) + square(v) + square(w);
    if facing * EDGE_ON > sides {
        sides / facing
    } else if sides > 0.0 {
        EDGE_ON * (1.0 - facing / sides)
    } else {
        EDGE_ON
    }
}

/// Polygons with more vertices are halved until they have no more, as the search for the best cut takes cubic time.
const MOST_VERTICES: usize = 24;

/// The triangles of a ring's polygon with the least sum of slimness. `normal` is the unit direction that the polygon faces. Fewer than three
/// vertices have no triangles.
pub(super) fn triangulate(polygon: &[[f64; 3]], normal: [f64; 3], mut emit: impl FnMut([usize; 3])) {
    // The rings of a lattice have four or six.
    match polygon.len() {
        0..3 => {}
        3 => emit([0, 1, 2]),
        4 => least_slim(&QUADRANGLE, polygon, normal).iter().for_each(|&t| emit(t)),
        6 => least_slim(&HEXAGON, polygon, normal).iter().for_each(|&t| emit(t)),
        n => cut(polygon, normal, &(0..n).collect::<Vec<_>>(), &mut emit),
    }
}

/// The triangulation of a table that has the least sum of slimness.
fn least_slim<'a, const N: usize>(
    table: &'a [[[usize; 3]; N]],
    polygon: &[[f64; 3]],
    normal: [f64; 3],
) -> &'a [[usize; 3]; N] {
    // Costs are positive: a sum that has reached the least so far need not be finished.
    let cost = |triangles: &[[usize; 3]; N], least: f64| -> f64 {
        let mut sum = 0.0;
        for t in triangles {
            sum += slimness(t.map(|v| polygon[v]), normal);
            if sum >= least {
                break;
            }
        }
        sum
    };
    let mut best = (&table[0], f64::INFINITY);
    for triangles in table {
        let c = cost(triangles, best.1);
        if c < best.1 {
            best = (triangles, c);
        }
    }
    best.0
}

/// Cuts the part of a polygon that has these vertices, in order.
fn cut(polygon: &[[f64; 3]], normal: [f64; 3], part: &[usize], emit: &mut impl FnMut([usize; 3])) {
    let n = part.len();
    if n > MOST_VERTICES {
        let middle = n / 2;
        cut(polygon, normal, &part[..=middle], emit);
        let rest: Vec<usize> = part[middle..].iter().chain(&part[..1]).copied().collect();
        return cut(polygon, normal, &rest, emit);
    }
    // The best cut from vertex i to vertex j: the apex of the triangle at their side, and the sum of slimness.
    let mut best = vec![(0, 0.0); n * n];
    for length in 2..n {
        for i in 0..n - length {
            let j = i + length;
            let mut least = (i + 1, f64::INFINITY);
            for apex in i + 1..j {
                let sides = best[i * n + apex].1 + best[apex * n + j].1;
                let cost = sides + slimness([i, apex, j].map(|k| polygon[part[k]]), normal);
                if cost < least.1 {
                    least = (apex, cost);
                }
            }
            best[i * n + j] = least;
        }
    }
    let mut open = vec![(0, n - 1)];
    while let Some((i, j)) = open.pop() {
        if j - i >= 2 {
            let apex = best[i * n + j].0;
            emit([i, apex, j].map(|k| part[k]));
            open.extend([(apex, j), (i, apex)]);
        }
    }
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
    fn every_number_of_vertices_is_covered_once() {
        for n in 3..70_usize {
            let corner = |i: usize| {
                let angle = i as f64 * std::f64::consts::TAU / n as f64;
                [angle.cos(), (1.0 + 0.1 * (3.0 * angle).sin()) * angle.sin(), 0.0]
            };
            let polygon: Vec<_> = (0..n).map(corner).collect();
            let area = |t: [usize; 3]| {
                let [a, b, c] = t.map(|v| polygon[v]);
                0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
            };
            let whole: f64 = (1..n - 1).map(|i| area([0, i, i + 1])).sum();
            let (mut count, mut sum) = (0, 0.0);
            triangulate(&polygon, [0.0, 0.0, 1.0], |t| {
                assert!(area(t) > 0.0, "{n}: {t:?}");
                (count, sum) = (count + 1, sum + area(t));
            });
            assert_eq!(count, n - 2);
            // The sums differ by the rounding of some 70 areas.
            assert!((sum - whole).abs() < 1e-12, "{n}");
        }
    }

    #[test]
    fn the_search_agrees_with_the_table() {
        let mut chance = crate::sample::Chance::new(1, 103, 0);
        for _ in 0..200 {
            let polygon: Vec<[f64; 3]> = (0..6)
                .map(|i| {
                    let angle = f64::from(i) * std::f64::consts::TAU / 6.0;
                    [angle.cos() + 0.2 * chance.normal(), angle.sin() + 0.2 * chance.normal(), 0.3 * chance.normal()]
                })
                .collect();
            let set = |triangles: Vec<[usize; 3]>| -> BTreeSet<BTreeSet<usize>> {
                triangles.into_iter().map(|t| t.into_iter().collect()).collect()
            };
            let mut searched = Vec::new();
            cut(&polygon, [0.0, 0.0, 1.0], &[0, 1, 2, 3, 4, 5], &mut |t| searched.push(t));
            let table = least_slim(&HEXAGON, &polygon, [0.0, 0.0, 1.0]).to_vec();
            assert_eq!(set(searched), set(table));
        }
    }

    #[test]
    fn a_dent_is_not_folded_over() {
        let dent = [[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [2.0, 0.0, 0.0], [1.0, 0.3, 0.0]];
        let mut triangles = Vec::new();
        triangulate(&dent, [0.0, 0.0, 1.0], |t| triangles.push(t));
        assert!(triangles.iter().all(|t| t.contains(&1) && t.contains(&3)));
    }
}
