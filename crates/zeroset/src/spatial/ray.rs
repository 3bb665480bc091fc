//! First hits of rays.
//!
//! # Formula
//! The triangle is sheared so that the ray runs along one axis; the signs of three planar cross products then say on
//! which side of each edge the ray passes (Woop, Benthin and Wald, "Watertight ray/triangle intersection", JCGT 2013).
//! Two triangles evaluate their common edge from the same numbers, so their signs are exact opposites.
//!
//! # Guaranteed
//! No ray slips through an edge or a vertex between triangles: zero counts as inside on both sides.
//!
//! # Not guaranteed
//! A ray in the plane of a triangle does not hit it.

use super::tree::{Aabb, Subtree};
use super::triangles::{Triangle, TriangleTree};
use crate::vec3::{self, Vec3};

/// Where a ray first meets a mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RayHit {
    /// The triangle that is hit; the lowest index where several are hit at once.
    pub triangle: usize,
    /// `origin + parameter * direction` is the hit: a distance if the direction has length 1.
    pub parameter: f64,
    /// The hit.
    pub position: [f64; 3],
}

/// A ray prepared for many tests.
struct Ray {
    origin: Vec3,
    direction: Vec3,
    inverse: Vec3,
    /// The axes, permuted so that the last is the direction's largest component.
    axes: [usize; 3],
    shear: Vec3,
    /// How far boxes are grown: what rounding can move a corner seen from the origin, and then some.
    pad: f64,
}

impl Ray {
    fn new(origin: Vec3, direction: Vec3, scene: &Aabb) -> Option<Self> {
        if !vec3::is_finite(origin) || vec3::normalized(direction).is_none() {
            return None;
        }
        let mut z = 0;
        for axis in 1..3 {
            if direction[axis].abs() > direction[z].abs() {
                z = axis;
            }
        }
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        if direction[z] < 0.0 {
            // Keeps the permutation right-handed as seen along the ray.
            std::mem::swap(&mut x, &mut y);
        }
        let inverse = direction.map(f64::recip);
        let shear = [direction[x] / direction[z], direction[y] / direction[z], 1.0 / direction[z]];
        // The sheared corners carry a few roundings of numbers of this size; without the pad a box could miss what a
        // triangle in it counts as a hit.
        let pad = 1e-14 * scene.farthest_squared(origin).sqrt();
        Some(Self { origin, direction, inverse, axes: [x, y, z], shear, pad })
    }

    /// The parameter at which the ray enters the box, `None` if it misses. Errs only towards entering.
    fn entry(&self, aabb: &Aabb) -> Option<f64> {
        let (mut near, mut far) = (0.0_f64, f64::INFINITY);
        for axis in 0..3 {
            let mut low = (aabb.low[axis] - self.origin[axis] - self.pad) * self.inverse[axis];
            let mut high = (aabb.high[axis] - self.origin[axis] + self.pad) * self.inverse[axis];
            if low > high {
                std::mem::swap(&mut low, &mut high);
            }
            // 0 * infinity is NaN, which max and min pass over: the axis rules nothing out.
            near = near.max(low);
            far = far.min(high);
        }
        (near <= far).then_some(near)
    }

    fn hit(&self, triangle: &Triangle) -> Option<f64> {
        let [x, y, z] = self.axes;
        let sheared = triangle.corners.map(|corner| {
            let v = vec3::sub(corner, self.origin);
            (v[x] - self.shear[0] * v[z], v[y] - self.shear[1] * v[z], self.shear[2] * v[z])
        });
        let [a, b, c] = sheared;
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let parameter = (u * a.2 + v * b.2 + w * c.2) / determinant;
        (parameter >= 0.0 && parameter.is_finite()).then_some(parameter)
    }
}

impl TriangleTree {
    /// The first hit of the ray from `origin` along `direction`, on either side of a triangle.
    ///
    /// `None` if nothing is hit, or if `direction` is zero or anything is not finite.
    #[must_use]
    pub fn ray(&self, origin: [f64; 3], direction: [f64; 3]) -> Option<RayHit> {
        if self.is_empty() {
            return None;
        }
        let ray = Ray::new(origin, direction, &self.tree.aabb)?;
        let mut best = (f64::INFINITY, usize::MAX);
        let mut waiting: Vec<(f64, Subtree)> = Vec::with_capacity(64);
        waiting.extend(ray.entry(&self.tree.aabb).map(|t| (t, self.tree.root())));
        while let Some((entry, subtree)) = waiting.pop() {
            if entry > best.0 {
                continue;
            }
            if subtree.levels == 0 {
                for triangle in self.tree.items_of(subtree) {
                    if let Some(parameter) = ray.hit(triangle)
                        && (parameter, triangle.index) < best
                    {
                        best = (parameter, triangle.index);
                    }
                }
                continue;
            }
            let node = &self.tree.nodes[subtree.node];
            let children = subtree.children();
            let entries = [0, 1].map(|side| ray.entry(&node.aabb[side]).filter(|t| *t <= best.0));
            // The nearer child goes on last, so it comes off first.
            let order = match entries {
                [Some(left), Some(right)] if right < left => [0, 1],
                _ => [1, 0],
            };
            waiting.extend(order.into_iter().filter_map(|side| Some((entries[side]?, children[side]))));
        }
        (best.1 != usize::MAX).then(|| RayHit {
            triangle: best.1,
            parameter: best.0,
            position: vec3::add_scaled(ray.origin, ray.direction, best.0),
        })
    }
}
