//! Closest points of a mesh.

use super::tree::{Aabb, Collector, Item, Tree};
use super::winding::Dipole;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};
use rayon::prelude::*;
use std::sync::OnceLock;

/// The point of a mesh that is closest to a query.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClosestPoint {
    /// The triangle it lies on; the lowest index where several share it.
    pub triangle: usize,
    /// Where it is, in the mesh's local coordinates.
    pub position: [f64; 3],
    /// Its squared distance from the query.
    pub distance_squared: f64,
}

/// A tree over the triangles of a mesh: closest points, ray hits and winding numbers.
///
/// Positions are in the mesh's local coordinates. Triangles that name a vertex that is not there, or one with a
/// non-finite coordinate, are passed over. Degenerate triangles count as the segment or point that they cover.
///
/// ```
/// use zeroset::{mesh::Mesh, spatial::TriangleTree};
///
/// let mesh = Mesh {
///     vertices: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
///     triangles: vec![[0, 1, 2]],
///     ..Mesh::default()
/// };
/// let tree = TriangleTree::new(&mesh);
/// assert_eq!(tree.closest([0.25, 0.25, 2.0]).unwrap().position, [0.25, 0.25, 0.0]);
/// assert_eq!(tree.ray([0.25, 0.25, 2.0], [0.0, 0.0, -1.0]).unwrap().parameter, 2.0);
/// ```
#[derive(Debug, Clone)]
pub struct TriangleTree {
    pub(super) tree: Tree<Triangle>,
    /// One for each inner node: see [`super::winding`]. Only winding numbers ask for them.
    pub(super) dipoles: OnceLock<Vec<Dipole>>,
}

/// A triangle with its corners at hand.
#[derive(Debug, Clone, Copy)]
pub(super) struct Triangle {
    pub(super) corners: [Vec3; 3],
    pub(super) index: usize,
}

impl Item for Triangle {
    const LEAF: usize = 4;

    #[inline]
    fn centre(&self) -> Vec3 {
        // The middle of the box rather than the centroid: a box is what the tree has to separate.
        let aabb = self.aabb();
        vec3::add(vec3::scale(aabb.low, 0.5), vec3::scale(aabb.high, 0.5))
    }

    #[inline]
    fn aabb(&self) -> Aabb {
        let [a, b, c] = self.corners;
        Aabb { low: vec3::min(vec3::min(a, b), c), high: vec3::max(vec3::max(a, b), c) }
    }

    #[inline]
    fn index(&self) -> usize {
        self.index
    }
}

impl TriangleTree {
    /// Builds the tree. O(n log n), on all threads.
    #[must_use]
    pub fn new(mesh: &Mesh) -> Self {
        let corners = |t: &[u32; 3]| -> Option<[Vec3; 3]> {
            let [a, b, c] = t.map(|v| mesh.vertices.get(v as usize).copied());
            Some([a?, b?, c?])
        };
        let triangles = mesh
            .triangles
            .par_iter()
            .enumerate()
            .filter_map(|(index, t)| Some(Triangle { corners: corners(t)?, index }))
            .filter(|t| t.corners.iter().all(|&c| vec3::is_finite(c)))
            .collect();
        Self::from_items(triangles)
    }

    /// A tree over segments, each held as a triangle without area. [`closest`](Self::closest) then finds the closest
    /// point of the segments, and the triangle index is the segment's.
    #[must_use]
    pub fn from_segments(segments: &[[[f64; 3]; 2]]) -> Self {
        let triangles = segments
            .iter()
            .enumerate()
            .filter(|(_, s)| s.iter().all(|&p| vec3::is_finite(p)))
            .map(|(index, &[a, b])| Triangle { corners: [a, b, b], index })
            .collect();
        Self::from_items(triangles)
    }

    fn from_items(triangles: Vec<Triangle>) -> Self {
        Self { tree: Tree::new(triangles), dipoles: OnceLock::new() }
    }

    /// Follows the vertices of the mesh that the tree was built from. Searches stay right, and fast while vertices are near to where they were.
    pub(crate) fn follow(&mut self, mesh: &Mesh) {
        self.tree.items.par_iter_mut().for_each(|item| {
            item.corners = mesh.triangles[item.index].map(|v| mesh.vertices[v as usize]);
        });
        self.tree.fit_boxes();
        self.dipoles = OnceLock::new();
    }

    /// Number of triangles held.
    #[must_use]
    pub fn len(&self) -> usize {
        self.tree.items.len()
    }

    /// Whether no triangle is held.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tree.items.is_empty()
    }

    /// The closest point of the mesh; `None` if it has no triangle or `q` is not finite.
    #[must_use]
    pub fn closest(&self, q: [f64; 3]) -> Option<ClosestPoint> {
        self.closest_to(q, f64::INFINITY)
    }

    /// The closest point of the mesh at a distance of at most `radius`.
    #[must_use]
    pub fn closest_within(&self, q: [f64; 3], radius: f64) -> Option<ClosestPoint> {
        if radius >= 0.0 { self.closest_to(q, radius * radius) } else { None }
    }

    /// Calls `visit` with every triangle at a distance of at most `radius` and its squared distance, in an order that the triangles
    /// determine.
    pub(crate) fn visit_within(&self, q: [f64; 3], radius: f64, visit: impl FnMut(usize, f64)) {
        if vec3::is_finite(q) && radius >= 0.0 {
            self.tree.nearest_first(q, &mut Within { q, limit_squared: radius * radius, visit });
        }
    }

    fn closest_to(&self, q: Vec3, limit_squared: f64) -> Option<ClosestPoint> {
        if !vec3::is_finite(q) {
            return None;
        }
        let best = ClosestPoint { triangle: usize::MAX, position: q, distance_squared: limit_squared };
        let mut closest = Closest { q, best };
        self.tree.nearest_first(q, &mut closest);
        (closest.best.triangle != usize::MAX).then_some(closest.best)
    }
}

/// Keeps the closest point seen.
struct Closest {
    q: Vec3,
    best: ClosestPoint,
}

impl Collector<Triangle> for Closest {
    #[inline]
    fn limit(&self) -> (f64, usize) {
        (self.best.distance_squared, self.best.triangle)
    }

    #[inline]
    fn leaf(&mut self, items: &[Triangle]) {
        for triangle in items {
            let aabb = triangle.aabb();
            if (aabb.distance_squared(self.q), triangle.index) >= self.limit() {
                continue;
            }
            // The rounded point may stand a last bit outside the box; back inside, no box on the way down to it can
            // seem farther than it is, so the answer does not depend on the shape of the tree.
            let point = closest_on_triangle(triangle.corners, self.q);
            let position = vec3::max(aabb.low, vec3::min(aabb.high, point));
            let distance_squared = vec3::distance_squared(position, self.q);
            if (distance_squared, triangle.index) < self.limit() {
                self.best = ClosestPoint { triangle: triangle.index, position, distance_squared };
            }
        }
    }
}

/// Hands on all triangles within a distance.
struct Within<F: FnMut(usize, f64)> {
    q: Vec3,
    limit_squared: f64,
    visit: F,
}

impl<F: FnMut(usize, f64)> Collector<Triangle> for Within<F> {
    #[inline]
    fn limit(&self) -> (f64, usize) {
        (self.limit_squared, usize::MAX)
    }

    #[inline]
    fn leaf(&mut self, items: &[Triangle]) {
        for triangle in items {
            let distance_squared = vec3::distance_squared(closest_on_triangle(triangle.corners, self.q), self.q);
            if distance_squared <= self.limit_squared {
                (self.visit)(triangle.index, distance_squared);
            }
        }
    }
}

/// The point of segment `ab` closest to `q`.
fn closest_on_segment(a: Vec3, b: Vec3, q: Vec3) -> Vec3 {
    let along = vec3::sub(b, a);
    let length_squared = vec3::norm_squared(along);
    if length_squared == 0.0 {
        return a;
    }
    let t = vec3::dot(vec3::sub(q, a), along) / length_squared;
    if t <= 0.0 {
        a
    } else if t >= 1.0 {
        b
    } else {
        vec3::add_scaled(a, along, t)
    }
}

/// The point of a triangle closest to `q`.
///
/// The foot of the perpendicular counts if it lies strictly within all three edges; otherwise the nearest of the
/// closest points on the edges is the answer. A needle whose normal has drowned in rounding fails the first test or
/// lands on its edges anyway, so its answer is right to the width of the needle.
pub(crate) fn closest_on_triangle([a, b, c]: [Vec3; 3], q: Vec3) -> Vec3 {
    let (ab, ac, aq) = (vec3::sub(b, a), vec3::sub(c, a), vec3::sub(q, a));
    let normal = vec3::cross(ab, ac);
    let area_squared = vec3::norm_squared(normal);
    if area_squared > 0.0 {
        let beta = vec3::dot(vec3::cross(aq, ac), normal) / area_squared;
        let gamma = vec3::dot(vec3::cross(ab, aq), normal) / area_squared;
        if beta > 0.0 && gamma > 0.0 && beta + gamma < 1.0 {
            return vec3::add_scaled(vec3::add_scaled(a, ab, beta), ac, gamma);
        }
    }
    let candidates = [closest_on_segment(a, b, q), closest_on_segment(b, c, q), closest_on_segment(c, a, q)];
    let mut best = candidates[0];
    for candidate in &candidates[1..] {
        if vec3::distance_squared(*candidate, q) < vec3::distance_squared(best, q) {
            best = *candidate;
        }
    }
    best
}
