//! Closed curves and surfaces from few radial functions, nearer to the truth than the points.

use crate::basis::{Kernel, Radial, Tail, farthest_points};
use crate::contour::{Branches, zero_lines, zero_surface};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Data, NormalizedFit, Order2, SquaredGradient};
use crate::mesh::topology;
use crate::sample::Chance;

/// For each point. Between 1e-6 and 1e-4 every case here stays below the noise; 1e-3 flattens curves by more than it.
const SMOOTHNESS: f64 = 1e-5;

fn kernels(width: f64) -> [Kernel; 6] {
    [
        Kernel::Gaussian { width },
        Kernel::Multiquadric { width },
        Kernel::InverseMultiquadric { width },
        Kernel::ThinPlate { width },
        Kernel::WendlandC2 { width: 3.0 * width },
        Kernel::WendlandC4 { width: 3.0 * width },
    ]
}

/// Points with noise in all directions.
fn noisy<const D: usize>(count: usize, noise: f64, on: impl Fn(&mut Chance) -> [f64; D]) -> Vec<[f64; D]> {
    let mut chance = Chance::new(21, 306, D);
    (0..count).map(|_| on(&mut chance).map(|c| c + noise * chance.normal())).collect()
}

/// Fits points with each kernel at `centres` of them. Returns for each kernel what `measure` finds.
fn fits<const D: usize, T>(
    points: &[[f64; D]],
    (centres, width): (usize, f64),
    domain: &SimplicialMesh<D>,
    measure: impl Fn(&crate::basis::Expansion<'_, D>) -> T,
) -> Vec<(Kernel, T)> {
    let mut data = Data::new();
    data.points(points, 1.0).unwrap();
    let centres: Vec<_> = farthest_points(points, centres).into_iter().map(|i| points[i]).collect();
    let smoothness = Order2 { weight: SMOOTHNESS * points.len() as f64 };
    kernels(width)
        .into_iter()
        .map(|kernel| {
            let basis = Radial::new(domain.clone(), kernel, centres.clone(), Tail::Linear).unwrap();
            let fit = NormalizedFit::new(&basis, &data).smoothness(&smoothness);
            let fitted = fit.normalization(&SquaredGradient::default()).run().unwrap();
            assert!(fitted.diagnosis.warnings.is_empty(), "{kernel:?}: {:?}", fitted.diagnosis);
            (kernel, measure(&fitted.function(&basis)))
        })
        .collect()
}

#[test]
fn noisy_circles_and_an_ellipse_become_closed_curves_within_the_noise() {
    let noise = 0.02;
    // Half axes of each closed curve, and the middles: a circle; an ellipse; two circles in one fit.
    let cases = [
        (vec![[0.0, 0.0]], [0.7, 0.7], [16, 16]),
        (vec![[0.0, 0.0]], [1.0, 0.6], [20, 14]),
        (vec![[-0.62, 0.0], [0.62, 0.0]], [0.45, 0.45], [24, 14]),
    ];
    for (middles, [a, b], cells) in cases {
        let truth = |middle: [f64; 2], angle: f64| [middle[0] + a * angle.cos(), middle[1] + b * angle.sin()];
        let points = noisy(500, noise, |chance| {
            let middle = middles[(chance.uniform() * middles.len() as f64) as usize];
            truth(middle, std::f64::consts::TAU * chance.uniform())
        });
        let domain = SimplicialMesh::lattice([-1.4, -1.0], [1.4, 1.0], cells).unwrap();
        let exact: Vec<[f64; 2]> = middles
            .iter()
            .flat_map(|&m| (0..2000).map(move |i| (m, std::f64::consts::TAU * f64::from(i) / 2000.0)))
            .map(|(m, angle)| truth(m, angle))
            .collect();
        let nearest =
            |p: [f64; 2]| exact.iter().map(|q| (p[0] - q[0]).hypot(p[1] - q[1])).fold(f64::INFINITY, f64::min);
        let found = fits(&points, (60, 0.5), &domain, |f| {
            let curves = zero_lines(f, 1e-3, Branches::All);
            let vertices: Vec<f64> = curves.iter().flat_map(|c| &c.points).map(|&p| nearest(p)).collect();
            let inside = middles.iter().all(|&m| f.value(m).is_some_and(|v| v < 0.0));
            let closed = curves.iter().filter(|c| c.closed).count();
            (curves.len(), closed, inside, vertices.iter().sum::<f64>() / vertices.len() as f64)
        });
        for (kernel, (curves, closed, inside, mean)) in found {
            assert_eq!((curves, closed, inside), (middles.len(), middles.len(), true), "{kernel:?}, {a} {b}");
            assert!(mean < 0.5 * noise, "{kernel:?}, {a} {b}: mean error {mean}");
        }
    }
}

#[test]
fn a_noisy_sphere_and_a_torus_become_closed_surfaces_within_the_noise() {
    let noise = 0.02;
    let ring = |p: [f64; 3]| (p[0].hypot(p[1]) - 0.9).hypot(p[2]) - 0.4;
    let ball = |p: [f64; 3]| p.iter().map(|c| c * c).sum::<f64>().sqrt() - 0.8;
    let torus = noisy(2000, noise, |chance| {
        // Uniform over the area: the angle around the tube by rejection.
        loop {
            let (u, v) = (std::f64::consts::TAU * chance.uniform(), std::f64::consts::TAU * chance.uniform());
            let radius = 0.9 + 0.4 * v.cos();
            if 1.3 * chance.uniform() < radius {
                return [radius * u.cos(), radius * u.sin(), 0.4 * v.sin()];
            }
        }
    });
    let sphere = noisy(1000, noise, |chance| chance.direction().map(|c| 0.8 * c));
    let cube = SimplicialMesh::lattice([-1.1; 3], [1.1; 3], [8; 3]).unwrap();
    let slab = SimplicialMesh::lattice([-1.6, -1.6, -0.7], [1.6, 1.6, 0.7], [10, 10, 5]).unwrap();
    for (points, centres, domain, genus) in [(&sphere, 100, &cube, 0), (&torus, 220, &slab, 1)] {
        let distance = |p: [f64; 3]| if genus == 0 { ball(p) } else { ring(p) };
        let found = fits(points, (centres, 0.6), domain, |f| zero_surface(f, 1, Branches::All));
        for (kernel, mesh) in found {
            let topology = topology(&mesh).unwrap();
            assert_eq!(topology.components.len(), 1, "{kernel:?}");
            assert_eq!(topology.components[0].genus, Some(genus), "{kernel:?}: closed, with as many handles");
            let errors = mesh.vertices.iter().map(|&v| distance(v).abs());
            let mean = errors.sum::<f64>() / mesh.vertices.len() as f64;
            assert!(mean < noise, "{kernel:?}: mean error {mean}");
        }
    }
}
