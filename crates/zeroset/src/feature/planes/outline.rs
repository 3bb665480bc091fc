//! The outline of points in a plane: their alpha shape.
//!
//! # What
//! Triangles of the Delaunay triangulation with no side longer than a reach are kept; the boundary of what they cover is the outline.
//! It ends on points, so it lies within the true outline by about half the spacing.
//!
//! # Source
//! Edelsbrunner, Kirkpatrick and Seidel, "On the shape of a set of points in the plane", 1983, with the longest side for the radius.

use spade::handles::FixedFaceHandle;
use spade::{DelaunayTriangulation, Point2, Triangulation};

/// A closed ring of positions in the plane; the first is not repeated.
pub(in crate::feature) type Ring = Vec<[f64; 2]>;

/// The rings around the pieces of the alpha shape whose area is at least `least`: counter-clockwise outside, clockwise around holes of
/// at least that area. The ring with the largest area comes first.
///
/// Points must be finite. Cost: O(n log n).
pub(in crate::feature) fn outline(points: &[[f64; 2]], reach: f64, least: f64) -> Vec<Ring> {
    let sites: Vec<Point2<f64>> = points.iter().map(|&[x, y]| Point2::new(x, y)).collect();
    let Ok(plane) = DelaunayTriangulation::<Point2<f64>>::bulk_load(sites) else { return Vec::new() };
    let limit = reach * reach;
    let mut kept = vec![false; plane.num_all_faces()];
    for face in plane.inner_faces() {
        let [a, b, c] = face.positions();
        let longest = [(a, b), (b, c), (c, a)].map(|(p, q)| p.distance_2(q)).into_iter().fold(0.0, f64::max);
        kept[face.fix().index()] = longest <= limit;
    }
    let is_kept = |face: FixedFaceHandle<spade::handles::PossiblyOuterTag>| kept[face.index()];
    let mut visited = vec![false; plane.num_directed_edges()];
    let mut rings: Vec<(f64, Ring)> = Vec::new();
    for start in plane.directed_edges() {
        let is_border = is_kept(start.face().fix()) && !is_kept(start.rev().face().fix());
        if !is_border || visited[start.fix().index()] {
            continue;
        }
        let (mut ring, mut edge) = (Vec::new(), start);
        loop {
            visited[edge.fix().index()] = true;
            let from = edge.from().position();
            ring.push([from.x, from.y]);
            // The next border edge around the end of this one, over the kept triangles between.
            let mut next = edge.next();
            while is_kept(next.rev().face().fix()) {
                next = next.rev().next();
            }
            edge = next;
            if edge == start {
                break;
            }
        }
        let area = signed_area(&ring);
        if area.abs() >= least {
            rings.push((area, ring));
        }
    }
    rings.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()).then_with(|| a.1[0].partial_cmp(&b.1[0]).expect("finite")));
    rings.into_iter().map(|(_, ring)| ring).collect()
}

/// The area that a ring encloses: positive for counter-clockwise rings, negative for clockwise ones.
pub(in crate::feature) fn signed_area(ring: &[[f64; 2]]) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    let from = |p: [f64; 2]| [p[0] - origin[0], p[1] - origin[1]];
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(&p, &q)| (from(p), from(q))).map(|(p, q)| p[0] * q[1] - p[1] * q[0]).sum::<f64>()
}

/// The ring with fewer positions: none that was left out lies farther than the tolerance from the line that replaces it.
///
/// Douglas and Peucker 1973, from the two positions that are farthest apart from the first.
pub(in crate::feature) fn simplified(ring: &[[f64; 2]], tolerance: f64) -> Ring {
    if ring.len() < 4 {
        return ring.to_vec();
    }
    let squared = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2);
    let farthest = |from: [f64; 2]| {
        (0..ring.len()).max_by(|&i, &j| squared(ring[i], from).total_cmp(&squared(ring[j], from)).then(j.cmp(&i)))
    };
    let first = farthest(ring[0]).unwrap_or(0);
    let turned: Ring = ring[first..].iter().chain(&ring[..first]).copied().collect();
    let second = (0..turned.len())
        .max_by(|&i, &j| squared(turned[i], turned[0]).total_cmp(&squared(turned[j], turned[0])).then(j.cmp(&i)))
        .unwrap_or(0);
    let mut closed = turned;
    closed.push(closed[0]);
    let mut keep = vec![false; closed.len()];
    (keep[0], keep[second]) = (true, true);
    split(&closed, 0, second, tolerance, &mut keep);
    split(&closed, second, closed.len() - 1, tolerance, &mut keep);
    keep.pop();
    closed.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

fn split(line: &[[f64; 2]], first: usize, last: usize, tolerance: f64, keep: &mut [bool]) {
    let mut parts = vec![(first, last)];
    while let Some((first, last)) = parts.pop() {
        let mut worst = (tolerance, None);
        for (i, &p) in line.iter().enumerate().take(last).skip(first + 1) {
            let distance = to_segment(p, [line[first], line[last]]);
            if distance > worst.0 {
                worst = (distance, Some(i));
            }
        }
        if let Some(i) = worst.1 {
            keep[i] = true;
            parts.extend([(first, i), (i, last)]);
        }
    }
}

/// Whether a ray to the right of a position crosses a side. It crosses a ring around the position an odd number of times.
pub(in crate::feature) fn crossed_by_ray([x, y]: [f64; 2], [a, b]: [[f64; 2]; 2]) -> bool {
    (a[1] > y) != (b[1] > y) && a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > x
}

/// Distance from a segment.
fn to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = d[0] * d[0] + d[1] * d[1];
    let t = if squared > 0.0 { ((d[0] * e[0] + d[1] * e[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (e[0] - t * d[0]).hypot(e[1] - t * d[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(n: i32, keep: impl Fn(i32, i32) -> bool) -> Vec<[f64; 2]> {
        (0..n * n).map(|i| (i % n, i / n)).filter(|&(x, y)| keep(x, y)).map(|(x, y)| [x.into(), y.into()]).collect()
    }

    #[test]
    fn a_square_with_a_hole_has_two_rings() {
        let rings = outline(&lattice(21, |x, y| !(8..=12).contains(&x) || !(8..=12).contains(&y)), 1.5, 1.0);
        let areas: Vec<f64> = rings.iter().map(|r| signed_area(r)).collect();
        // The hole runs from 7 to 13, its corners cut.
        assert_eq!((areas.len(), areas[0]), (2, 400.0));
        assert!((-36.0..=-34.0).contains(&areas[1]), "{areas:?}");
        let corners = simplified(&rings[0], 0.1);
        assert_eq!(corners.len(), 4);
        assert_eq!(signed_area(&corners), 400.0);
    }

    #[test]
    fn pieces_that_touch_in_a_point_are_two_rings() {
        let rings = outline(&lattice(11, |x, y| (x <= 5 && y <= 5) || (x >= 5 && y >= 5)), 1.1, 1.0);
        assert!(rings.is_empty(), "no triangle has sides under 1.1");
        let rings = outline(&lattice(11, |x, y| (x <= 5 && y <= 5) || (x >= 5 && y >= 5)), 1.42, 1.0);
        let total: f64 = rings.iter().map(|r| signed_area(r)).sum();
        // One triangle on either side may bridge the corner.
        assert!((50.0..=51.0).contains(&total), "{total}");
    }

    #[test]
    fn few_points_and_points_on_a_line_have_no_outline() {
        assert!(outline(&[], 1.0, 0.0).is_empty());
        assert!(outline(&[[0.0, 0.0], [1.0, 0.0]], 2.0, 0.0).is_empty());
        assert!(outline(&lattice(10, |_, y| y == 0), 2.0, 0.0).is_empty());
    }
}
