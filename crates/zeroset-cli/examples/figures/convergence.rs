//! How fast the zero set nears a circle and a sphere as the cells get smaller, by the set-up of the tests of the core
//! (`fit/normalized/tests/convergence.rs`): exact points, the squared gradient, and a smoothness that falls faster than the squared error.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write;

use zeroset::basis::{Basis, P1, P2};
use zeroset::contour::{Branches, zero_lines, zero_surface};
use zeroset::domain::SimplicialMesh;
use zeroset::fit::normalized::{Data, Fitted, NormalizedFit, Order2, SquaredGradient};

const RADIUS: f64 = 0.61;
/// The middle lies nowhere special in the lattice.
const MIDDLE: [f64; 3] = [0.013, -0.02, 0.017];

/// What is neared.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Shape {
    Circle,
    Sphere,
}

/// The degree of the functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Degree {
    Linear,
    Quadratic,
}

/// One mesh.
pub(crate) struct Measurement {
    pub(crate) cells: u32,
    /// The side of a cell.
    pub(crate) h: f64,
    /// The largest distance of the zero set from the truth.
    pub(crate) error: f64,
}

/// One curve of the plot.
pub(crate) struct Series {
    pub(crate) degree: Degree,
    pub(crate) shape: Shape,
    pub(crate) measurements: Vec<Measurement>,
}

impl Series {
    pub(crate) const TITLE: &str =
        "Largest distance of the zero set from a circle and a sphere, over the side of a cell";

    pub(crate) fn name(&self) -> String {
        let degree = if self.degree == Degree::Linear { "P1" } else { "P2" };
        let shape = if self.shape == Shape::Circle { "circle" } else { "sphere" };
        format!("{degree}, {shape}")
    }

    /// The slope of log(error) over log(h), by least squares.
    pub(crate) fn order(&self) -> f64 {
        let logs: Vec<[f64; 2]> = self.measurements.iter().map(|m| [m.h.ln(), m.error.ln()]).collect();
        let mean = [0, 1].map(|a| logs.iter().map(|l| l[a]).sum::<f64>() / logs.len() as f64);
        let covariance: f64 = logs.iter().map(|l| (l[0] - mean[0]) * (l[1] - mean[1])).sum();
        covariance / logs.iter().map(|l| (l[0] - mean[0]).powi(2)).sum::<f64>()
    }
}

pub(crate) fn measure() -> Result<Vec<Series>, Box<dyn Error>> {
    let (circle, sphere) = (circle(), sphere());
    let on_circle = |cells: u32, degree, smoothness: f64| {
        let mesh = SimplicialMesh::lattice([-1.0; 2], [1.0; 2], [cells; 2])?;
        let basis: Box<dyn Basis<2>> =
            if degree == Degree::Linear { Box::new(P1::new(mesh)) } else { Box::new(P2::new(mesh)) };
        let fitted = fit(basis.as_ref(), &circle, smoothness)?;
        Ok::<_, Box<dyn Error>>(off_circle(basis.as_ref(), &fitted))
    };
    let on_sphere = |cells: u32, degree, smoothness: f64| {
        let mesh = SimplicialMesh::lattice([-1.0; 3], [1.0; 3], [cells; 3])?;
        let basis: Box<dyn Basis<3>> =
            if degree == Degree::Linear { Box::new(P1::new(mesh)) } else { Box::new(P2::new(mesh)) };
        let fitted = fit(basis.as_ref(), &sphere, smoothness)?;
        Ok::<_, Box<dyn Error>>(off_sphere(basis.as_ref(), &fitted))
    };
    // Degree, shape, the weight of smoothness for a cell of side 1, and cells along a side.
    let cases: [(_, _, f64, &[u32]); 4] = [
        (Degree::Linear, Shape::Circle, 1e-2, &[8, 16, 32, 64, 128]),
        (Degree::Linear, Shape::Sphere, 1e-4, &[8, 12, 17, 24, 34]),
        (Degree::Quadratic, Shape::Circle, 1e-6, &[6, 8, 11, 16, 22, 32, 45, 64]),
        (Degree::Quadratic, Shape::Sphere, 1e-4, &[4, 6, 8, 12, 17]),
    ];
    let mut all = Vec::new();
    for (degree, shape, factor, meshes) in cases {
        let mut measurements = Vec::new();
        for &cells in meshes {
            let h = 2.0 / f64::from(cells);
            let smoothness = factor * h.powi(if degree == Degree::Linear { 4 } else { 6 });
            let error = match shape {
                Shape::Circle => on_circle(cells, degree, smoothness)?,
                Shape::Sphere => on_sphere(cells, degree, smoothness)?,
            };
            measurements.push(Measurement { cells, h, error });
        }
        all.push(Series { degree, shape, measurements });
    }
    Ok(all)
}

fn fit<const D: usize>(basis: &dyn Basis<D>, points: &[[f64; D]], smoothness: f64) -> Result<Fitted, Box<dyn Error>> {
    let mut data = Data::new();
    data.points(points, 1.0 / points.len() as f64)?;
    let smoothness = Order2 { weight: smoothness };
    let fit = NormalizedFit::new(basis, &data).smoothness(&smoothness);
    let fitted = fit.normalization(&SquaredGradient::default()).run()?;
    match fitted.diagnosis.warnings.first() {
        Some(warning) => Err(warning.clone().into()),
        None => Ok(fitted),
    }
}

/// Even points on a circle.
fn circle() -> Vec<[f64; 2]> {
    let angle = |i: u32| TAU * (f64::from(i) + 0.37) / 6000.0;
    (0..6000).map(|i| [MIDDLE[0] + RADIUS * angle(i).cos(), MIDDLE[1] + RADIUS * angle(i).sin()]).collect()
}

/// Nearly even points on a sphere: the spiral of Fibonacci.
fn sphere() -> Vec<[f64; 3]> {
    const COUNT: u32 = 20_000;
    const GOLDEN_ANGLE: f64 = 2.399_963_229_728_653;
    (0..COUNT)
        .map(|i| {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(COUNT);
            let (sin, cos) = (f64::from(i) * GOLDEN_ANGLE).sin_cos();
            let across = (1.0 - z * z).sqrt();
            let unit = [across * cos, across * sin, z];
            std::array::from_fn(|a| MIDDLE[a] + RADIUS * unit[a])
        })
        .collect()
}

/// How far a position is from the circle or sphere.
fn distance<const D: usize>(p: [f64; D]) -> f64 {
    ((0..D).map(|a| (p[a] - MIDDLE[a]).powi(2)).sum::<f64>().sqrt() - RADIUS).abs()
}

/// Five places on each straight piece: it is farthest off between its ends.
fn off_circle(basis: &dyn Basis<2>, fitted: &Fitted) -> f64 {
    let mut most = 0.0_f64;
    for curve in zero_lines(&fitted.function(basis), 1e-9, Branches::All) {
        let ring = &curve.points;
        for (i, p) in ring.iter().enumerate() {
            let q = ring[(i + 1) % ring.len()];
            for t in [0.1, 0.3, 0.5, 0.7, 0.9] {
                most = most.max(distance::<2>(std::array::from_fn(|a| p[a] + t * (q[a] - p[a]))));
            }
        }
    }
    most
}

/// The middles of triangles where these are the zero set itself; else the vertices, which lie on it.
fn off_sphere(basis: &dyn Basis<3>, fitted: &Fitted) -> f64 {
    let is_linear = basis.degree() == Some(1);
    let mesh = zero_surface(&fitted.function(basis), u32::from(!is_linear), Branches::All);
    let middle = |t: &[u32; 3]| {
        let corners = t.map(|v| mesh.vertices[v as usize]);
        std::array::from_fn(|a| (corners[0][a] + corners[1][a] + corners[2][a]) / 3.0)
    };
    let places: Vec<[f64; 3]> =
        if is_linear { mesh.triangles.iter().map(middle).collect() } else { mesh.vertices.clone() };
    places.into_iter().map(distance).fold(0.0, f64::max)
}

/// All measurements as a Markdown table.
pub(crate) fn table(series: &[Series]) -> String {
    let mut table =
        String::from("| functions | cells along a side | h | largest distance | order |\n|---|--:|--:|--:|--:|\n");
    for one in series {
        let last = one.measurements.len() - 1;
        for (i, Measurement { cells, h, error }) in one.measurements.iter().enumerate() {
            let order = if i == last { format!("**{:.2}**", one.order()) } else { String::new() };
            let name = if i == 0 { one.name() } else { String::new() };
            let _ = writeln!(table, "| {name} | {cells} | {h:.4} | {error:.3e} | {order} |");
        }
    }
    table
}
