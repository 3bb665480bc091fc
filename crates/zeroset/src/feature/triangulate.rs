//! The polygon of a plane as triangles.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use super::Plane;
use super::planes::outline::crossed_by_ray;
use crate::vec3;

/// Cuts the polygon of a plane, holes and all, into triangles.
///
/// Indices count the positions of all rings, one ring after the other. Triangles are counter-clockwise seen from the tip
/// of the normal. They are the constrained Delaunay triangles whose centre has an odd number of sides to one side of it,
/// so any nesting of rings is understood. Where rings cross, one of the two sides gives way, and the outline is followed
/// only nearly. Positions that are not finite take no part. O(n log n).
///
/// ```
/// use zeroset::feature::{Plane, triangulate};
/// let square = |a: f64, b: f64| vec![[a, a, 2.0], [b, a, 2.0], [b, b, 2.0], [a, b, 2.0]];
/// let plane = Plane {
///     normal: [0.0, 0.0, 1.0],
///     offset: 2.0,
///     oriented: true,
///     points: 0,
///     rms: None,
///     area: 8.0,
///     rings: vec![square(0.0, 3.0), square(1.0, 2.0)],
/// };
/// assert_eq!(triangulate(&plane).len(), 8);
/// ```
#[must_use]
pub fn triangulate(plane: &Plane) -> Vec<[usize; 3]> {
    let Some(normal) = vec3::normalized(plane.normal) else {
        return Vec::new();
    };
    let axes = vec3::axes_across(normal);
    let positions: Vec<_> = plane.rings.iter().flatten().copied().collect();
    let Some(origin) = positions.iter().copied().find(|p| vec3::is_finite(*p)) else {
        return Vec::new();
    };
    let size = positions.iter().map(|p| vec3::distance(*p, origin)).filter(|d| d.is_finite()).fold(0.0, f64::max);
    // Numbers that are all but zero would be refused by the triangulation.
    let snap = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
    let flat: Vec<[f64; 2]> =
        positions.iter().map(|p| axes.map(|axis| snap(vec3::dot(vec3::sub(*p, origin), axis) / size))).collect();

    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    let mut index_of = Vec::new();
    let handles: Vec<_> = flat
        .iter()
        .enumerate()
        .map(|(i, p)| {
            let handle = mesh.insert(Point2::new(p[0], p[1])).ok()?;
            // Positions that are equal are one vertex, which is known by the first of them.
            if handle.index() == index_of.len() {
                index_of.push(i);
            }
            Some(handle)
        })
        .collect();
    let mut sides = Vec::new();
    let mut start = 0;
    for ring in &plane.rings {
        for i in 0..ring.len() {
            let [from, to] = [start + i, start + (i + 1) % ring.len()];
            if let (Some(a), Some(b)) = (handles[from], handles[to]) {
                if a != b && mesh.can_add_constraint(a, b) {
                    mesh.add_constraint(a, b);
                }
                sides.push([flat[from], flat[to]]);
            }
        }
        start += ring.len();
    }
    let inside = |p: [f64; 2]| sides.iter().filter(|side| crossed_by_ray(p, **side)).count() % 2 == 1;
    let faces = mesh.inner_faces().map(|face| face.vertices().map(|v| index_of[v.fix().index()]));
    faces.filter(|t| inside(std::array::from_fn(|a| (flat[t[0]][a] + flat[t[1]][a] + flat[t[2]][a]) / 3.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vec3::Vec3;

    fn plane(normal: Vec3, rings: Vec<Vec<Vec3>>) -> Plane {
        Plane { normal, offset: 0.0, oriented: true, points: 0, rms: None, area: 0.0, rings }
    }

    fn area(plane: &Plane) -> Vec3 {
        let positions: Vec<Vec3> = plane.rings.concat();
        triangulate(plane).into_iter().fold([0.0; 3], |sum, t| {
            let [a, b, c] = t.map(|i| positions[i]);
            vec3::add_scaled(sum, vec3::cross(vec3::sub(b, a), vec3::sub(c, a)), 0.5)
        })
    }

    fn square(from: f64, to: f64) -> Vec<Vec3> {
        vec![[0.0, from, from], [0.0, to, from], [0.0, to, to], [0.0, from, to]]
    }

    #[test]
    fn areas_of_rings_holes_and_islands() {
        let normal = [-1.0, 0.0, 0.0];
        for (rings, expected) in [
            (vec![square(0.0, 2.0)], 4.0),
            (vec![square(0.0, 5.0), square(1.0, 4.0)], 16.0),
            (vec![square(0.0, 5.0), square(1.0, 4.0), square(2.0, 3.0)], 17.0),
            (vec![square(0.0, 1.0), square(2.0, 4.0)], 5.0),
            // An L, whose fan from the first position would leave it.
            (
                vec![vec![
                    [0.0, 1.0, 0.0],
                    [0.0, 2.0, 0.0],
                    [0.0, 2.0, 2.0],
                    [0.0, 0.0, 2.0],
                    [0.0, 0.0, 1.0],
                    [0.0, 1.0, 1.0],
                ]],
                3.0,
            ),
        ] {
            let area = area(&plane(normal, rings));
            // Counter-clockwise seen from the tip of the normal, however the rings run.
            assert!(vec3::distance(area, [-expected, 0.0, 0.0]) < 1e-12, "{area:?} is not {expected}");
        }
    }

    #[test]
    fn what_has_no_area_has_no_triangles() {
        let up = [0.0, 0.0, 1.0];
        for rings in [
            vec![],
            vec![vec![]],
            vec![vec![[1.0; 3]]],
            vec![vec![[1.0; 3]; 4]],
            vec![vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]]],
            vec![vec![[f64::NAN; 3]; 3]],
        ] {
            assert_eq!(triangulate(&plane(up, rings)), Vec::<[usize; 3]>::new());
        }
        assert!(triangulate(&plane([0.0; 3], vec![square(0.0, 1.0)])).is_empty());
    }

    #[test]
    fn rings_that_cross_do_not_stop_it() {
        let bow_tie = vec![[0.0, 0.0, 0.0], [0.0, 2.0, 2.0], [0.0, 2.0, 0.0], [0.0, 0.0, 2.0]];
        assert!(vec3::norm(area(&plane([1.0, 0.0, 0.0], vec![bow_tie]))) < 4.0);
        let doubled = [square(0.0, 1.0), square(0.0, 1.0)].concat();
        let _ = area(&plane([1.0, 0.0, 0.0], vec![doubled, square(0.5, 1.5)]));
    }
}
