//! Functions that are known, their lattices, and how far a mesh is from them.

use zeroset::domain::{Blocks, Lattice};
use zeroset::field::LatticeField;
use zeroset::mesh::Mesh;

pub(crate) type Place = [f64; 3];

/// A shape in the cube -1..1: its name and a function that is the distance to it near it.
pub(crate) type Shape = (&'static str, fn(Place) -> f64);

pub(crate) const SPHERE: Shape = ("sphere", |p| norm(minus(p, [0.013, -0.027, 0.041])) - 0.8);
pub(crate) const TORUS: Shape = ("torus", |[x, y, z]| (x.hypot(y) - 0.6).hypot(z) - 0.25);
pub(crate) const ELLIPSOID: Shape = ("ellipsoid", |[x, y, z]| {
    let q = [x / 0.9, y / 0.6, z / 0.4];
    let k = norm(q);
    k * (k - 1.0) / norm([q[0] / 0.9, q[1] / 0.6, q[2] / 0.4]).max(1e-9)
});
pub(crate) const BLOBS: Shape = ("two blobs", |p| {
    let ball = |middle: Place, radius: f64| (-9.0 * (norm(minus(p, middle)) - radius)).exp();
    -(ball([-0.35, -0.1, -0.15], 0.5) + ball([0.42, 0.15, 0.2], 0.38)).ln() / 9.0
});

/// What is known at the nodes.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Known {
    Values,
    Marks,
}

/// A function sampled at every node of the lattice with this many cells over the cube -1..1 and its padding.
pub(crate) fn field(f: fn(Place) -> f64, cells: f64, known: Known) -> LatticeField {
    let lattice = Lattice::around([-1.0; 3], [1.0; 3], 2.0 / cells, 0.1).expect("a sound box");
    let blocks = Blocks::dense(lattice.blocks_at(lattice.finest));
    let mut values = Vec::with_capacity(blocks.len() * 512);
    for c in &blocks.coordinates {
        for local in 0..512_u32 {
            let node = [local & 7, local >> 3 & 7, local >> 6];
            let node = std::array::from_fn(|a| f64::from(8 * c[a] + node[a]));
            let value = f(lattice.position(lattice.finest, node)) as f32;
            values.push(if known == Known::Marks { value.signum() } else { value });
        }
    }
    LatticeField { known: vec![[u64::MAX; 8]; blocks.len()], lattice, blocks, values }
}

/// How a mesh agrees with a function.
pub(crate) struct Agreement {
    /// Mean distance over the area.
    pub(crate) distance: f64,
    /// Mean cosine between the normals of triangles and the gradient, by area.
    pub(crate) normal_consistency: f64,
    /// Root of the mean square of that angle, in degrees.
    pub(crate) angle_deg: f64,
    /// Share of the triangles with an angle below 15 degrees.
    pub(crate) slim: f64,
}

pub(crate) fn agreement(mesh: &Mesh, f: fn(Place) -> f64) -> Agreement {
    let (mut area, mut distance, mut cosine, mut square, mut slim) = (0.0, 0.0, 0.0, 0.0, 0);
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| mesh.vertices[v as usize]);
        let [a, b, c] = corners;
        let normal = cross(minus(b, a), minus(c, a));
        let weight = norm(normal);
        let middle: Place = std::array::from_fn(|k| (a[k] + b[k] + c[k]) / 3.0);
        let gradient = gradient(f, middle);
        // The middle, and a place half way to each corner.
        let places = [middle].into_iter().chain(corners.map(|q| std::array::from_fn(|k| 0.5 * (middle[k] + q[k]))));
        distance += weight * places.map(|p| f(p).abs()).sum::<f64>() / (4.0 * norm(gradient));
        let angle = norm(cross(normal, gradient)).atan2(dot(normal, gradient));
        cosine += weight * angle.cos();
        square += weight * angle * angle;
        area += weight;
        slim += usize::from((0..3).any(|k| corner_angle(corners, k) < 15_f64.to_radians()));
    }
    Agreement {
        distance: distance / area,
        normal_consistency: cosine / area,
        angle_deg: f64::sqrt(square / area).to_degrees(),
        slim: slim as f64 / mesh.triangles.len() as f64,
    }
}

fn corner_angle(corners: [Place; 3], k: usize) -> f64 {
    let (u, v) = (minus(corners[(k + 1) % 3], corners[k]), minus(corners[(k + 2) % 3], corners[k]));
    norm(cross(u, v)).atan2(dot(u, v))
}

fn gradient(f: fn(Place) -> f64, p: Place) -> Place {
    const STEP: f64 = 1e-5;
    std::array::from_fn(|axis| {
        let at = |side: f64| f(std::array::from_fn(|k| if k == axis { p[k] + side * STEP } else { p[k] }));
        (at(1.0) - at(-1.0)) / (2.0 * STEP)
    })
}

pub(crate) fn minus(a: Place, b: Place) -> Place {
    std::array::from_fn(|k| a[k] - b[k])
}

pub(crate) fn dot(a: Place, b: Place) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: Place, b: Place) -> Place {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn norm(a: Place) -> f64 {
    dot(a, a).sqrt()
}
