//! Quadratics reproduce every kind of conic.

use super::{distance_to_segment, interpolated, segments, square};
use crate::basis::{Expansion, P2};
use crate::contour::{Branches, Polyline, zero_lines};
use crate::domain::SimplicialMesh;
use crate::sample::Chance;

/// A conic as a function, and as curves that run through a parameter from -1 to 1.
struct Kind {
    name: &'static str,
    value: fn(f64, f64) -> f64,
    slopes: fn(f64, f64) -> [f64; 2],
    curves: &'static [fn(f64) -> [f64; 2]],
}

const KINDS: [Kind; 7] = [
    Kind {
        name: "ellipse",
        value: |x, y| x * x + y * y - 1.0,
        slopes: |x, y| [2.0 * x, 2.0 * y],
        curves: &[|t| [(3.2 * t).cos(), (3.2 * t).sin()]],
    },
    Kind {
        name: "hole",
        value: |x, y| 1.0 - x * x - y * y,
        slopes: |x, y| [-2.0 * x, -2.0 * y],
        curves: &[|t| [(3.2 * t).cos(), (3.2 * t).sin()]],
    },
    Kind {
        name: "parabola",
        value: |x, y| y - x * x,
        slopes: |x, _| [-2.0 * x, 1.0],
        curves: &[|t| [9.0 * t, 81.0 * t * t]],
    },
    Kind {
        name: "hyperbola",
        value: |x, y| x * x - y * y - 1.0,
        slopes: |x, y| [2.0 * x, -2.0 * y],
        curves: &[|t| [(4.0 * t).cosh(), (4.0 * t).sinh()], |t| [-(4.0 * t).cosh(), (4.0 * t).sinh()]],
    },
    Kind {
        name: "narrow hyperbola",
        value: |x, y| x * y + 1e-6,
        slopes: |x, y| [y, x],
        curves: &[
            |t| [-1e-3 * (10.0 * t).exp(), 1e-3 * (-10.0 * t).exp()],
            |t| [1e-3 * (10.0 * t).exp(), -1e-3 * (-10.0 * t).exp()],
        ],
    },
    Kind {
        name: "crossing lines",
        value: |x, y| x * y,
        slopes: |x, y| [y, x],
        curves: &[|t| [20.0 * t, 0.0], |t| [0.0, 20.0 * t]],
    },
    Kind {
        name: "parallel lines",
        value: |x, _| x * x - 0.09,
        slopes: |x, _| [2.0 * x, 0.0],
        curves: &[|t| [0.3, 20.0 * t], |t| [-0.3, 20.0 * t]],
    },
];

/// An affine map x = origin + columns u, and back.
struct Map {
    origin: [f64; 2],
    columns: [[f64; 2]; 2],
}

impl Map {
    fn random(chance: &mut Chance) -> Self {
        let angle = chance.between(0.0, std::f64::consts::TAU);
        let (sin, cos) = angle.sin_cos();
        let (a, b) = (chance.between(0.1, 0.9), chance.between(0.1, 0.9));
        Self {
            origin: [chance.between(-0.8, 0.8), chance.between(-0.8, 0.8)],
            columns: [[a * cos, a * sin], [-b * sin, b * cos]],
        }
    }

    fn there(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [u, v] = self.columns;
        [0, 1].map(|a| self.origin[a] + x * u[a] + y * v[a])
    }

    fn back(&self, p: [f64; 2]) -> [f64; 2] {
        let d = [p[0] - self.origin[0], p[1] - self.origin[1]];
        self.columns.map(|c| (d[0] * c[0] + d[1] * c[1]) / (c[0] * c[0] + c[1] * c[1]))
    }

    fn value(&self, kind: &Kind, p: [f64; 2]) -> f64 {
        let [x, y] = self.back(p);
        (kind.value)(x, y)
    }

    fn gradient(&self, kind: &Kind, p: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.back(p);
        let slopes = (kind.slopes)(x, y);
        let scaled = [0, 1].map(|k| slopes[k] / self.columns[k].iter().map(|c| c * c).sum::<f64>());
        [0, 1].map(|a| scaled[0] * self.columns[0][a] + scaled[1] * self.columns[1][a])
    }
}

fn meshes() -> Vec<SimplicialMesh<2>> {
    let one =
        |corners: [[f64; 2]; 3]| SimplicialMesh::from_triangles(corners.to_vec(), &[[0, 1, 2]]).expect("a triangle");
    vec![
        one([[-1.0, -1.0], [1.2, -0.9], [-0.1, 1.0]]),
        one([[-1.5, -1.5], [3.0, -1.5], [-1.5, 3.0]]),
        SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2]).expect("a square"),
        square(3),
    ]
}

fn check(kind: &Kind, map: &Map, mesh: &SimplicialMesh<2>, tolerance: f64) -> Vec<Polyline> {
    let basis = P2::new(mesh.clone());
    let coefficients = interpolated(&basis, |p| map.value(kind, p));
    let scale = coefficients.iter().fold(1.0_f64, |m, c| m.max(c.abs()));
    let lines = zero_lines(&Expansion::new(&basis, &coefficients), tolerance, Branches::All);
    let all: Vec<_> = lines.iter().flat_map(segments).collect();
    for line in &lines {
        for &p in &line.points {
            assert!(map.value(kind, p).abs() < 1e-12 * scale, "{}: {p:?} is off the curve", kind.name);
        }
        if let (false, [first, .., last]) = (line.closed, line.points.as_slice()) {
            for &end in [first, last] {
                let place = mesh.locate(end).expect("curves stay in the mesh");
                let on_rim =
                    (0..3).any(|c| mesh.neighbor(place.simplex, c).is_none() && place.barycentric[c].abs() < 1e-12);
                assert!(on_rim, "{}: a curve ends inside at {end:?}", kind.name);
            }
        }
    }
    for [a, b] in &all {
        let middle = [0, 1].map(|k| 0.5 * (a[k] + b[k]));
        let gradient = map.gradient(kind, middle);
        let (size, length) = (gradient[0].hypot(gradient[1]), (b[0] - a[0]).hypot(b[1] - a[1]));
        let uphill = (gradient[0] * (b[1] - a[1]) - gradient[1] * (b[0] - a[0])) / (size * length);
        // Where two branches meet the direction turns at once.
        assert!(uphill > 0.0 || size < 0.1 * scale || length < 1e-9, "{}: F < 0 is not on the left", kind.name);
    }
    for curve in kind.curves {
        for p in (-500..=500).map(|i| map.there(curve(f64::from(i) / 500.0))).filter(|&p| mesh.locate(p).is_some()) {
            let distance = all.iter().map(|&s| distance_to_segment(p, s)).fold(f64::INFINITY, f64::min);
            // Where a curve grazes an edge, rounding decides whether it is crossed: it is missed by the root of a rounding.
            assert!(distance <= tolerance + 1e-7, "{}: {p:?} is missed by {distance}", kind.name);
        }
    }
    lines
}

#[test]
fn conics_of_every_kind_are_reproduced_in_any_position() {
    let mut chance = Chance::new(7, 72, 0);
    for mesh in &meshes() {
        for _ in 0..25 {
            let map = Map::random(&mut chance);
            for kind in &KINDS {
                let tolerance = 10.0_f64.powf(chance.between(-6.0, -2.0));
                let _ = check(kind, &map, mesh, tolerance);
            }
        }
    }
}

#[test]
fn an_ellipse_inside_a_triangle_is_found() {
    let mesh = &meshes()[1];
    let mut chance = Chance::new(8, 72, 0);
    for _ in 0..50 {
        let mut map = Map::random(&mut chance);
        map.origin = [chance.between(-0.4, 0.1), chance.between(-0.4, 0.1)];
        for (kind, turn) in [(&KINDS[0], 1.0), (&KINDS[1], -1.0)] {
            let lines = check(kind, &map, mesh, 1e-6);
            assert_eq!(lines.len(), 1);
            assert!(lines[0].closed);
            let [u, v] = map.columns;
            let area = std::f64::consts::PI * (u[0] * v[1] - u[1] * v[0]);
            assert!((0.5 * turn * super::doubled_area(&lines[0]) / area - 1.0).abs() < 1e-4);
        }
    }
}

#[test]
fn an_ellipse_around_a_triangle_is_not_its_own() {
    let mesh = &meshes()[0];
    let basis = P2::new(mesh.clone());
    for radius_squared in [9.0, 4.0] {
        let coefficients = interpolated(&basis, |[x, y]| x * x + y * y - radius_squared);
        assert!(zero_lines(&Expansion::new(&basis, &coefficients), 1e-3, Branches::All).is_empty());
    }
}
