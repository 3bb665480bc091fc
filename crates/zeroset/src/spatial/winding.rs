//! Generalised winding numbers.
//!
//! # What
//! How often a mesh surrounds a point: 1 inside a closed surface whose triangles are counter-clockwise from outside, 0
//! outside, -1 inside one turned inside out, and a smooth value between where the surface has holes.
//!
//! # Formula
//! w(q) = 1/(4 pi) sum over triangles of the signed solid angle under which q sees the triangle. Near triangles are
//! taken exactly (van Oosterom and Strackee, "The solid angle of a plane triangle", 1983). A cluster of far ones is
//! expanded around its area centroid p: with d = p - q, N the sum of area vectors A_t n_t, and M = sum A_t (c_t - p)
//! n_t^T,
//!
//! ```text
//! 4 pi w = N.d/|d|^3  +  tr M/|d|^3 - 3 d.M d/|d|^5  +  R
//! |R| <= 3 S/(|d| - r)^4,   S = sum of the integrals of |x - p|^2,   r = the cluster's radius around p
//! ```
//!
//! The bound is Taylor's: the third derivative of 1/|y| is at most 6/|y|^4 in any three unit directions, halved for the
//! second-order remainder and integrated. A cluster counts as far at |d| > 4 r.
//!
//! # Cost
//! O(log n) a query for a surface of n triangles: some hundreds of clusters.
//!
//! # Guaranteed
//! [`WindingNumber::error_bound`] is the sum of the bounds of the clusters used, plus nothing for exact triangles.
//!
//! # Not guaranteed
//! The bound does not count rounding (about 1e-15 a triangle). It is pessimistic: remainders of different sign cancel,
//! and the error measured on closed surfaces is at most 0.02, enough to tell 0 from 1 but no more. On the surface
//! itself w jumps, and any value between is given.
//!
//! # Source
//! Barill, Dickson, Schmidt, Levin and Jacobson, "Fast winding numbers for soups and clouds", 2018. The bound, and
//! carrying it along with the value, are ours.

use super::tree::{Item, Subtree, Tree};
use super::triangles::{Triangle, TriangleTree};
use crate::vec3::{self, Vec3};
use std::f64::consts::PI;

/// A cluster is expanded beyond this multiple of its radius. Worst error measured on a sphere of 16 k triangles, for 2,
/// 3, 4, 6, 8: 0.049, 0.025, 0.013, 0.006, 0.003; a query costs in proportion to the square.
const FAR: f64 = 4.0;

/// Below this many triangles a subtree is summed up by one thread.
const SEQUENTIAL: usize = 16_384;

/// A winding number and how far it may be off.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindingNumber {
    /// The winding number.
    pub value: f64,
    /// The exact value is no farther than this from `value`, rounding aside.
    pub error_bound: f64,
}

/// The moments of the triangles in one inner subtree.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Dipole {
    centre: Vec3,
    /// N: the sum of area vectors.
    normal: Vec3,
    /// M: row i is the moment along axis i.
    moment: [Vec3; 3],
    area: f64,
    /// S: the second moment around the centre.
    second: f64,
    /// No triangle reaches farther from the centre.
    radius: f64,
}

impl Dipole {
    /// The dipoles of all inner subtrees, in the order of the nodes.
    pub(super) fn of_tree(tree: &Tree<Triangle>) -> Vec<Self> {
        let mut dipoles = vec![Self::default(); tree.nodes.len()];
        sum_up(tree, tree.root(), &mut dipoles);
        dipoles
    }

    fn of_triangle(triangle: &Triangle) -> Self {
        let [a, b, c] = triangle.corners;
        let centre = vec3::scale(vec3::add(vec3::add(a, b), c), 1.0 / 3.0);
        let normal = vec3::scale(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)), 0.5);
        let area = vec3::norm(normal);
        let squares = [a, b, c].map(|v| vec3::distance_squared(v, centre));
        Self {
            centre,
            normal,
            moment: [[0.0; 3]; 3],
            area,
            second: area * (squares[0] + squares[1] + squares[2]) / 12.0,
            radius: squares[0].max(squares[1]).max(squares[2]).sqrt(),
        }
    }

    fn merge(parts: &[Self]) -> Self {
        let area: f64 = parts.iter().map(|p| p.area).sum();
        let weight = |p: &Self| if area > 0.0 { p.area / area } else { 1.0 / parts.len() as f64 };
        let centre = parts.iter().fold([0.0; 3], |sum, p| vec3::add_scaled(sum, p.centre, weight(p)));
        let mut all = Self { centre, area, ..Self::default() };
        for part in parts {
            let shift = vec3::sub(part.centre, centre);
            let distance_squared = vec3::norm_squared(shift);
            all.normal = vec3::add(all.normal, part.normal);
            for ((sum, row), along) in all.moment.iter_mut().zip(part.moment).zip(shift) {
                *sum = vec3::add(*sum, vec3::add_scaled(row, part.normal, along));
            }
            all.second += part.second + part.area * distance_squared;
            all.radius = all.radius.max(distance_squared.sqrt() + part.radius);
        }
        all
    }

    /// 4 pi times value and bound, if `q` is far enough.
    #[inline]
    fn far(&self, q: Vec3) -> Option<(f64, f64)> {
        let d = vec3::sub(self.centre, q);
        let squared = vec3::norm_squared(d);
        if squared <= FAR * FAR * self.radius * self.radius {
            return None;
        }
        let length = squared.sqrt();
        let cubed = squared * length;
        let along = self.moment.map(|row| vec3::dot(row, d));
        let trace = self.moment[0][0] + self.moment[1][1] + self.moment[2][2];
        let value = (vec3::dot(self.normal, d) + trace - 3.0 * vec3::dot(along, d) / squared) / cubed;
        let gap_squared = (length - self.radius) * (length - self.radius);
        Some((value, 3.0 * self.second / (gap_squared * gap_squared)))
    }
}

/// The dipole of a subtree; `dipoles` are those of its inner nodes.
fn sum_up(tree: &Tree<Triangle>, subtree: Subtree, dipoles: &mut [Dipole]) -> Dipole {
    let Some((own, below)) = dipoles.split_first_mut() else {
        let mut parts = [Dipole::default(); Triangle::LEAF];
        let items = tree.items_of(subtree);
        for (part, triangle) in parts.iter_mut().zip(items) {
            *part = Dipole::of_triangle(triangle);
        }
        return Dipole::merge(&parts[..items.len()]);
    };
    let [left, right] = subtree.children();
    let (left_dipoles, right_dipoles) = below.split_at_mut((1 << left.levels) - 1);
    let (a, b) = if subtree.len() > SEQUENTIAL {
        rayon::join(|| sum_up(tree, left, left_dipoles), || sum_up(tree, right, right_dipoles))
    } else {
        (sum_up(tree, left, left_dipoles), sum_up(tree, right, right_dipoles))
    };
    let mut merged = Dipole::merge(&[a, b]);
    // Radii added up on the way grow; the tight boxes put a second limit on them.
    let node = &tree.nodes[subtree.node];
    merged.radius = merged.radius.min(node.aabb[0].union(node.aabb[1]).farthest_squared(merged.centre).sqrt());
    *own = merged;
    merged
}

/// The signed solid angle of a triangle seen from `q`: positive from behind, that is, from the inside.
fn solid_angle([a, b, c]: [Vec3; 3], q: Vec3) -> f64 {
    let (a, b, c) = (vec3::sub(a, q), vec3::sub(b, q), vec3::sub(c, q));
    let (la, lb, lc) = (vec3::norm(a), vec3::norm(b), vec3::norm(c));
    let volume = vec3::dot(a, vec3::cross(b, c));
    let denominator = la * lb * lc + vec3::dot(a, b) * lc + vec3::dot(b, c) * la + vec3::dot(c, a) * lb;
    2.0 * volume.atan2(denominator)
}

impl TriangleTree {
    /// The generalised winding number of the mesh around `q`. Zero for an empty mesh or a `q` that is not finite.
    #[must_use]
    pub fn winding_number(&self, q: [f64; 3]) -> WindingNumber {
        let (mut value, mut bound) = (0.0, 0.0);
        let dipoles = self.dipoles.get_or_init(|| Dipole::of_tree(&self.tree));
        let mut waiting = Vec::with_capacity(64);
        if !self.is_empty() && vec3::is_finite(q) {
            waiting.push(self.tree.root());
        }
        while let Some(subtree) = waiting.pop() {
            if subtree.levels == 0 {
                value += self.tree.items_of(subtree).iter().map(|t| solid_angle(t.corners, q)).sum::<f64>();
            } else if let Some(far) = dipoles[subtree.node].far(q) {
                value += far.0;
                bound += far.1;
            } else {
                waiting.extend(subtree.children());
            }
        }
        WindingNumber { value: value / (4.0 * PI), error_bound: bound / (4.0 * PI) }
    }

    /// The winding number by the exact solid angle of every triangle: O(n), the reference for [`Self::winding_number`].
    #[must_use]
    pub fn winding_number_exact(&self, q: [f64; 3]) -> f64 {
        if !vec3::is_finite(q) {
            return 0.0;
        }
        self.tree.items.iter().map(|t| solid_angle(t.corners, q)).sum::<f64>() / (4.0 * PI)
    }
}
