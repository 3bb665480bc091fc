//! The curvature norm of a mesh at a vertex.

use super::Norm;
use crate::vec3::{self, Vec3};
use std::f64::consts::TAU;

/// The curvature norm k1^2 + k2^2 = 4 H^2 - 2 K at a vertex, in 1 / length^2, or its product with the area of the ring, which has no unit.
///
/// `ring` is the closed ring of neighbours in order, either way around. Infinite if the triangles around the vertex have no area.
pub(super) fn curvature_norm(vertex: Vec3, ring: &[Vec3], norm: Norm) -> f64 {
    let Some(&last) = ring.last() else { return f64::INFINITY };
    let mut spoke = vec3::sub(last, vertex);
    let mut before: Option<Vec3> = None;
    let (mut angles, mut bends, mut double_area) = (0.0, 0.0, 0.0);
    // One step more than spokes: the first gives the normal that the first bend turns from.
    for &next in ring.iter().chain(&ring[..1]) {
        let next_spoke = vec3::sub(next, vertex);
        let normal = vec3::cross(spoke, next_spoke);
        if let Some(before) = before {
            let length = vec3::norm(normal);
            double_area += length;
            angles += length.atan2(vec3::dot(spoke, next_spoke));
            let turn = vec3::norm(vec3::cross(before, normal));
            bends += vec3::norm(spoke) * turn.atan2(vec3::dot(before, normal));
        }
        before = Some(normal);
        spoke = next_spoke;
    }
    if double_area <= 0.0 {
        return f64::INFINITY;
    }
    // 4 (0.75 bends / A)^2 A - 2 (3 (2 pi - angles) / A) A, with A half of the double area.
    let total = 4.5 * bends * bends / double_area - 6.0 * (TAU - angles);
    match norm {
        Norm::TimesArea => total,
        Norm::Printed => 2.0 * total / double_area,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn total_curvature(vertex: Vec3, ring: &[Vec3]) -> f64 {
        curvature_norm(vertex, ring, Norm::TimesArea)
    }

    /// The pole of a sphere of radius 1 and a regular ring around it, at this angle from it.
    fn cap(count: usize, angle: f64) -> (Vec3, Vec<Vec3>) {
        let (sin, cos) = angle.sin_cos();
        let turn = |i: usize| TAU * i as f64 / count as f64;
        ([0.0, 0.0, 1.0], (0..count).map(|i| [sin * turn(i).cos(), sin * turn(i).sin(), cos]).collect())
    }

    #[test]
    fn a_flat_ring_has_none() {
        let ring = [[1.0, 0.0, 0.0], [0.3, 1.0, 0.0], [-1.0, 0.2, 0.0], [0.1, -1.0, 0.0]];
        // Six times the rounding of a sum of four angles.
        assert!(total_curvature([0.1, 0.1, 0.0], &ring).abs() < 1e-14);
    }

    #[test]
    fn a_regular_cap_has_what_the_formulas_say() {
        // For a fine cap with n spokes of length e: the angle at the pole lacks e^2 n tan(pi / n) / 4 of a full turn, and each spoke
        // bends by e tan(pi / n); the area is n e^2 sin(2 pi / n) / 2.
        for count in [3, 4, 6, 9] {
            let angle = 1e-2;
            let (pole, mut ring) = cap(count, angle);
            let n = count as f64;
            let (e, tan, sin) = (2.0 * (0.5 * angle).sin(), (TAU / (2.0 * n)).tan(), (TAU / n).sin());
            let area = 0.5 * n * e * e * sin;
            let mean = 0.75 * n * e * (e * tan) / area;
            let gauss = 3.0 * (n * tan * e * e / 4.0) / area;
            let expected = (4.0 * mean * mean - 2.0 * gauss) * area;
            let found = total_curvature(pole, &ring);
            // The next terms of the series are smaller by e^2 = 1e-4, times a few.
            assert!((found / expected - 1.0).abs() < 1e-3, "{count}: {found} {expected}");
            let printed = curvature_norm(pole, &ring, Norm::Printed);
            assert!((printed * area / expected - 1.0).abs() < 1e-3, "{count}: {printed}");
            ring.reverse();
            assert!((total_curvature(pole, &ring) / found - 1.0).abs() < 1e-9, "the way around does not matter");
        }
    }

    #[test]
    fn it_has_no_unit_and_does_not_see_rigid_motions() {
        let ring = [[1.0, 0.0, 0.3], [0.3, 1.0, 0.0], [-1.0, 0.2, -0.2], [0.1, -1.0, 0.1]];
        let moved = |p: Vec3| vec3::add(vec3::scale([p[1], p[2], p[0]], 1e3), [5.0, -7.0, 11.0]);
        let (a, b) = (total_curvature([0.0; 3], &ring), total_curvature(moved([0.0; 3]), &ring.map(moved)));
        // Positions of 1e3 are rounded to 1e-13.
        assert!((a / b - 1.0).abs() < 1e-12);
    }

    #[test]
    fn what_has_no_area_is_worst() {
        assert_eq!(total_curvature([0.0; 3], &[]), f64::INFINITY);
        assert_eq!(total_curvature([0.0; 3], &[[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), f64::INFINITY);
    }
}
