//! Curves in which a plane cuts a mesh.
//!
//! # What
//! A curve runs through the edges that have ends on both sides of the plane; an end on the plane itself counts as above it. So a closed mesh gives closed curves,
//! whatever the plane goes through.
//!
//! # Cost
//! O(F), and a logarithm of the triangles that are cut.
//!
//! # Guaranteed
//! Curves are oriented: seen from the tip of the normal, what the mesh surrounds lies on their left. Equal meshes give equal curves, in the order of their first
//! triangles.

use rayon::prelude::*;

use super::Mesh;
use crate::vec3::{self, Vec3};

/// A curve in a plane.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaneCurve {
    /// Its positions, in the local coordinates of the mesh. The first is not repeated at the end of a closed one.
    pub positions: Vec<[f64; 3]>,
    /// Whether the last position is joined to the first.
    pub closed: bool,
}

/// The curves in which a plane cuts a mesh. The plane goes through `point`; `normal` may have any length but zero.
#[must_use]
pub fn section(mesh: &Mesh, point: [f64; 3], normal: [f64; 3]) -> Vec<PlaneCurve> {
    let heights: Vec<f64> = mesh.vertices.par_iter().map(|v| vec3::dot(normal, vec3::sub(*v, point))).collect();
    let is_above = |v: u32| heights[v as usize] >= 0.0;
    // From the side of a triangle that leads down to the one that leads up.
    let mut links: Vec<([u32; 2], [u32; 2])> = mesh
        .triangles
        .par_iter()
        .filter_map(|t| {
            let side = |from_above: bool| {
                let ends = (0..3).map(|i| [t[i], t[(i + 1) % 3]]);
                ends.into_iter().find(|&[a, b]| is_above(a) == from_above && is_above(b) != from_above)
            };
            let sorted = |[a, b]: [u32; 2]| [a.min(b), a.max(b)];
            Some((sorted(side(true)?), sorted(side(false)?)))
        })
        .collect();
    let first_of: Vec<[u32; 2]> = links.iter().map(|link| link.0).collect();
    links.par_sort_unstable();
    let mut is_used = vec![false; links.len()];
    let next = |edge: [u32; 2], is_used: &[bool]| {
        let from = links.partition_point(|link| link.0 < edge);
        (from..links.len()).take_while(|&i| links[i].0 == edge).find(|&i| !is_used[i])
    };
    let mut ends: Vec<[u32; 2]> = links.iter().map(|link| link.1).collect();
    ends.par_sort_unstable();
    // Open curves begin where nothing ends; all others are closed.
    let begins = first_of.iter().filter(|edge| ends.binary_search(edge).is_err());
    let mut curves = Vec::new();
    for &edge in begins.chain(&first_of) {
        let Some(mut link) = next(edge, &is_used) else { continue };
        let mut along = vec![edge];
        loop {
            is_used[link] = true;
            along.push(links[link].1);
            match next(links[link].1, &is_used) {
                Some(after) => link = after,
                None => break,
            }
        }
        let closed = along.len() > 1 && along.first() == along.last();
        if closed {
            along.pop();
        }
        let at = |&[a, b]: &[u32; 2]| -> Vec3 {
            let (from, to) = (heights[a as usize], heights[b as usize]);
            vec3::lerp(mesh.vertices[a as usize], mesh.vertices[b as usize], from / (from - to))
        };
        let mut positions: Vec<Vec3> = along.iter().map(at).collect();
        positions.dedup();
        while closed && positions.len() > 1 && positions.first() == positions.last() {
            positions.pop();
        }
        if positions.len() > if closed { 2 } else { 1 } {
            curves.push(PlaneCurve { positions, closed });
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Scene, SceneKind};

    /// The area that curves surround, seen from the tip of the z axis.
    fn area(curves: &[PlaneCurve]) -> f64 {
        let of_curve = |curve: &PlaneCurve| {
            let n = curve.positions.len();
            let pairs = (0..n).map(|i| (curve.positions[i], curve.positions[(i + 1) % n]));
            pairs.map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum::<f64>()
        };
        curves.iter().map(of_curve).sum()
    }

    #[test]
    fn a_ring_is_cut_into_two_rings_and_its_hole_is_clockwise() {
        let torus = Scene::new(SceneKind::Torus, 1).truth;
        let middle =
            torus.vertices.iter().fold([0.0; 3], |sum, v| vec3::add_scaled(sum, *v, 1.0 / torus.vertices.len() as f64));
        for axis in 0..3 {
            let mut normal = [0.0; 3];
            normal[axis] = 2.0;
            let curves = section(&torus, middle, normal);
            assert_eq!(curves.len(), 2, "{axis}");
            assert!(curves.iter().all(|curve| curve.closed));
        }
        let level = section(&torus, middle, [0.0, 0.0, 1.0]);
        let [mut outer, mut inner] = [area(&level[..1]), area(&level[1..])];
        if outer < inner {
            std::mem::swap(&mut outer, &mut inner);
        }
        assert!(inner < 0.0 && outer > -inner, "{outer} {inner}");
        let below = section(&torus, middle, [0.0, 0.0, -1.0]);
        assert!((area(&below) + area(&level)).abs() < 1e-9);
    }

    #[test]
    fn planes_through_vertices_give_closed_curves() {
        let block = Scene::new(SceneKind::Box, 1).truth;
        let (low, high) = crate::domain::bounds(block.vertices.iter().copied());
        let exact = (high[0] - low[0]) * (high[1] - low[1]);
        for (z, expected) in [(low[2], 0.0), (0.5 * (low[2] + high[2]), exact), (high[2], exact)] {
            let curves = section(&block, [0.0, 0.0, z], [0.0, 0.0, 1.0]);
            assert!(curves.iter().all(|curve| curve.closed));
            assert!((area(&curves) - expected).abs() < 1e-9, "{z}: {} {expected}", area(&curves));
        }
    }

    #[test]
    fn an_open_mesh_gives_open_curves() {
        let mut block = Scene::new(SceneKind::Box, 1).truth;
        let (low, high) = crate::domain::bounds(block.vertices.iter().copied());
        let is_wall = |t: &[u32; 3]| t.iter().all(|&v| block.vertices[v as usize][0] < low[0] + 1e-9);
        let walls: Vec<bool> = block.triangles.iter().map(is_wall).collect();
        let mut keep = walls.iter();
        block.triangles.retain(|_| !keep.next().unwrap());
        let curves = section(&block, [0.0, 0.0, 0.5 * (low[2] + high[2])], [0.0, 0.0, 1.0]);
        assert_eq!(curves.len(), 1);
        assert!(!curves[0].closed && curves[0].positions.len() >= 4);
        let ends = [curves[0].positions[0], *curves[0].positions.last().unwrap()];
        assert!(ends.iter().all(|p| (p[0] - low[0]).abs() < 1e-9));
    }
}
