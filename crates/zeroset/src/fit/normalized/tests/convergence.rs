//! The zero set nears a circle and a sphere with the orders that linear and quadratic functions allow: 2 and 3.
//!
//! The weight of the smoothness must fall faster than the squared error, or it is the smoothness that one sees: it falls as h^4 for P1
//! and as h^6 for P2. Its factor matters little: from 1e-3 to 1e-2 (P1) and from 1e-7 to 1e-5 (P2) the order on the circle stays within 0.2.

use crate::basis::{Basis, P1, P2};
use crate::contour::{Branches, zero_lines, zero_surface};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Data, Fitted, NormalizedFit, Order2, SquaredGradient};

const RADIUS: f64 = 0.61;
/// The middle lies nowhere special in the lattice.
const MIDDLE: [f64; 3] = [0.013, -0.02, 0.017];

/// How far a position is from the circle or sphere.
fn distance<const D: usize>(p: [f64; D]) -> f64 {
    ((0..D).map(|a| (p[a] - MIDDLE[a]).powi(2)).sum::<f64>().sqrt() - RADIUS).abs()
}

/// The slope of log(error) over log(h), by least squares.
fn order(errors: &[(f64, f64)]) -> f64 {
    let count = errors.len() as f64;
    let logs: Vec<(f64, f64)> = errors.iter().map(|(h, e)| (h.ln(), e.ln())).collect();
    let mean = logs.iter().fold((0.0, 0.0), |m, l| (m.0 + l.0 / count, m.1 + l.1 / count));
    let covariance: f64 = logs.iter().map(|l| (l.0 - mean.0) * (l.1 - mean.1)).sum();
    covariance / logs.iter().map(|l| (l.0 - mean.0).powi(2)).sum::<f64>()
}

fn fit<const D: usize>(basis: &dyn Basis<D>, points: &[[f64; D]], smoothness: f64) -> Fitted {
    let mut data = Data::new();
    data.points(points, 1.0 / points.len() as f64).unwrap();
    let smoothness = Order2 { weight: smoothness };
    let fit = NormalizedFit::new(basis, &data).smoothness(&smoothness);
    let fitted = fit.normalization(&SquaredGradient::default()).run().unwrap();
    assert!(fitted.diagnosis.warnings.is_empty(), "{:?}", fitted.diagnosis);
    fitted
}

#[test]
fn the_circle_is_neared_with_orders_two_and_three() {
    let points: Vec<[f64; 2]> = (0..6000)
        .map(|i| std::f64::consts::TAU * (f64::from(i) + 0.37) / 6000.0)
        .map(|angle| [MIDDLE[0] + RADIUS * angle.cos(), MIDDLE[1] + RADIUS * angle.sin()])
        .collect();
    let error = |basis: &dyn Basis<2>, smoothness: f64| {
        let fitted = fit(basis, &points, smoothness);
        let curves = zero_lines(&fitted.function(basis), 1e-9, Branches::All);
        assert!(curves.len() == 1 && curves[0].closed);
        let ring = &curves[0].points;
        // Straight pieces are farthest off between their ends.
        let pieces = (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]);
        let along = |[p, q]: [[f64; 2]; 2]| {
            (0..5)
                .map(move |t| 0.1 + 0.2 * f64::from(t))
                .map(move |t| std::array::from_fn(|a| p[a] + t * (q[a] - p[a])))
        };
        pieces.flat_map(along).map(distance::<2>).fold(0.0, f64::max)
    };
    let lattice = |cells: u32| SimplicialMesh::lattice([-1.0; 2], [1.0; 2], [cells; 2]).unwrap();
    let h = |cells: u32| 2.0 / f64::from(cells);
    let linear: Vec<_> =
        [8, 16, 32, 64].map(|n| (h(n), error(&P1::new(lattice(n)), 1e-2 * h(n).powi(4)))).into_iter().collect();
    let quadratic: Vec<_> =
        [6, 8, 11, 16, 22, 32].map(|n| (h(n), error(&P2::new(lattice(n)), 1e-6 * h(n).powi(6)))).into_iter().collect();
    assert!((order(&linear) - 2.0).abs() < 0.2, "P1: {} from {linear:?}", order(&linear));
    assert!((order(&quadratic) - 3.0).abs() < 0.2, "P2: {} from {quadratic:?}", order(&quadratic));
}

#[test]
fn the_sphere_is_neared_with_orders_two_and_three() {
    // The spiral of Fibonacci: nearly even.
    let points: Vec<[f64; 3]> = (0..20_000)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 20_000.0;
            let (sin, cos) = (f64::from(i) * 2.399_963_229_728_653).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let unit = [across * cos, across * sin, z];
            std::array::from_fn(|a| MIDDLE[a] + RADIUS * unit[a])
        })
        .collect();
    let error = |basis: &dyn Basis<3>, smoothness: f64| {
        let fitted = fit(basis, &points, smoothness);
        let linear = basis.degree() == Some(1);
        let mesh = zero_surface(&fitted.function(basis), u32::from(!linear), Branches::All);
        if linear {
            // Triangles are exact, and farthest off in their middles.
            let middle = |t: &[u32; 3]| {
                let corners = t.map(|v| mesh.vertices[v as usize]);
                std::array::from_fn(|a| (corners[0][a] + corners[1][a] + corners[2][a]) / 3.0)
            };
            mesh.triangles.iter().map(|t| distance::<3>(middle(t))).fold(0.0, f64::max)
        } else {
            // Only the vertices lie on the zero set.
            mesh.vertices.iter().map(|&v| distance(v)).fold(0.0, f64::max)
        }
    };
    let lattice = |cells: u32| SimplicialMesh::lattice([-1.0; 3], [1.0; 3], [cells; 3]).unwrap();
    let h = |cells: u32| 2.0 / f64::from(cells);
    let linear: Vec<_> =
        [8, 12, 17, 24].map(|n| (h(n), error(&P1::new(lattice(n)), 1e-4 * h(n).powi(4)))).into_iter().collect();
    let quadratic: Vec<_> =
        [4, 6, 8, 12].map(|n| (h(n), error(&P2::new(lattice(n)), 1e-4 * h(n).powi(6)))).into_iter().collect();
    assert!((order(&linear) - 2.0).abs() < 0.2, "P1: {} from {linear:?}", order(&linear));
    assert!((order(&quadratic) - 3.0).abs() < 0.2, "P2: {} from {quadratic:?}", order(&quadratic));
}
