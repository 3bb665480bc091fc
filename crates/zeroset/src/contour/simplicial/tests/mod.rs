//! Zero sets measured against closed forms.

mod conics;
mod lines;
mod surfaces;

use crate::basis::Basis;
use crate::domain::SimplicialMesh;

/// The coefficients that make F equal to a function at the nodes.
fn interpolated<const D: usize>(basis: &dyn Basis<D>, function: impl Fn([f64; D]) -> f64) -> Vec<f64> {
    (0..basis.len()).map(|j| function(basis.node(j).expect("polynomials have nodes"))).collect()
}

/// The square from (-1, -1) to (1, 1) in cells.
fn square(cells: u32) -> SimplicialMesh<2> {
    SimplicialMesh::<2>::lattice([-1.0; 2], [1.0; 2], [cells; 2]).expect("a lattice")
}

fn distance_to_segment(p: [f64; 2], [a, b]: [[f64; 2]; 2]) -> f64 {
    let (u, v) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let t = ((u[0] * v[0] + u[1] * v[1]) / (u[0] * u[0] + u[1] * u[1])).clamp(0.0, 1.0);
    (v[0] - t * u[0]).hypot(v[1] - t * u[1])
}

/// The segments of a polyline.
fn segments(line: &super::Polyline) -> Vec<[[f64; 2]; 2]> {
    let count = line.points.len();
    let last = if line.closed { count } else { count - 1 };
    (0..last).map(|i| [line.points[i], line.points[(i + 1) % count]]).collect()
}

fn length(line: &super::Polyline) -> f64 {
    segments(line).iter().map(|[a, b]| (b[0] - a[0]).hypot(b[1] - a[1])).sum()
}

/// Twice the area on the left of a closed polyline.
fn doubled_area(line: &super::Polyline) -> f64 {
    segments(line).iter().map(|[a, b]| a[0] * b[1] - a[1] * b[0]).sum()
}
