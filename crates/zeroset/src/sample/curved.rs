//! Curved shapes: a fine mesh as the truth, and points on the exact surface.

use super::random::Chance;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};
use std::collections::BTreeMap;
use std::f64::consts::TAU;

/// The sphere's radius; its centre is the origin.
pub(super) const SPHERE_RADIUS: f64 = 0.5;
/// The torus's radius from the axis (z) to the middle of the tube.
pub(super) const TORUS_MAJOR: f64 = 0.35;
/// The radius of the tube.
pub(super) const TORUS_MINOR: f64 = 0.15;

/// How often the icosahedron's faces are cut in four: 81,920 triangles, at most 1.5e-5 under the true sphere.
const SPHERE_CUTS: u32 = 6;
/// Cuts around the axis and around the tube: 262,144 triangles, at most 2e-5 off the true torus.
const TORUS_CUTS: [u32; 2] = [512, 256];

/// A sphere of radius 0.5: an icosahedron cut in four six times, its vertices on the sphere.
pub(super) fn sphere() -> Mesh {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut vertices = Vec::new();
    // The corners of three golden rectangles, one across each axis.
    for (x, y) in [(-1.0, golden), (1.0, golden), (-1.0, -golden), (1.0, -golden)] {
        vertices.extend([[x, y, 0.0], [0.0, x, y], [y, 0.0, x]]);
    }
    // The faces are the triples of corners at the edge length, 2, from each other.
    let close = |a: usize, b: usize| (vec3::distance_squared(vertices[a], vertices[b]) - 4.0).abs() < 1e-9;
    let mut triangles = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if close(a, b) && close(b, c) && close(c, a) {
                    let outward = vec3::dot(vertices[a], vec3::cross(vertices[b], vertices[c])) > 0.0;
                    triangles.push(if outward { [a, b, c] } else { [a, c, b] }.map(|v| v as u32));
                }
            }
        }
    }
    let onto = |p: Vec3| vec3::scale(p, SPHERE_RADIUS / vec3::norm(p));
    let mut mesh = Mesh { vertices: vertices.into_iter().map(onto).collect(), triangles, ..Mesh::default() };
    for _ in 0..SPHERE_CUTS {
        let mut middles = BTreeMap::new();
        let mut finer = Vec::with_capacity(4 * mesh.triangles.len());
        for &[a, b, c] in &mesh.triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(from, to)| {
                *middles.entry((from.min(to), from.max(to))).or_insert_with(|| {
                    let middle = vec3::add(mesh.vertices[from as usize], mesh.vertices[to as usize]);
                    mesh.vertices.push(onto(middle));
                    mesh.vertices.len() as u32 - 1
                })
            });
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        mesh.triangles = finer;
    }
    mesh
}

/// A torus around z.
pub(super) fn torus() -> Mesh {
    let [around, tube] = TORUS_CUTS;
    let mut mesh = Mesh::default();
    for i in 0..around {
        for j in 0..tube {
            let [u, v] = [(i, around), (j, tube)].map(|(at, of)| TAU * f64::from(at) / f64::from(of));
            mesh.vertices.push(torus_point(u, v));
            let number = |i: u32, j: u32| i % around * tube + j % tube;
            let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// The torus at angle `u` around the axis and `v` around the tube.
fn torus_point(u: f64, v: f64) -> Vec3 {
    let across = TORUS_MAJOR + TORUS_MINOR * v.cos();
    [across * u.cos(), across * u.sin(), TORUS_MINOR * v.sin()]
}

/// A uniform point of the exact sphere.
pub(super) fn on_sphere(chance: &mut Chance) -> Vec3 {
    vec3::scale(chance.direction(), SPHERE_RADIUS)
}

/// A uniform point of the exact torus: the area element is proportional to the distance from the axis, so that share of
/// the uniform angles is kept.
pub(super) fn on_torus(chance: &mut Chance) -> Vec3 {
    let u = TAU * chance.uniform();
    loop {
        let v = TAU * chance.uniform();
        if chance.uniform() * (TORUS_MAJOR + TORUS_MINOR) <= TORUS_MAJOR + TORUS_MINOR * v.cos() {
            return torus_point(u, v);
        }
    }
}
