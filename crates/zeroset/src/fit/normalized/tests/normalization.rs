//! The result has the least E / N, by the definitions of both.

use super::{bases, curve, interpolated, meshes_2d, meshes_3d, random, surface};
use crate::basis::{Basis, Expansion, P1, P2};
use crate::domain::{Place, SimplicialMesh};
use crate::fit::Gradient;
use crate::fit::normalized::gradient::rows;
use crate::fit::normalized::{
    Coefficients, Data, Fitted, MeanGradient, Normalization, NormalizedFit, Order1, Order2, Solver, SquaredGradient,
    Warning,
};
use crate::sample::Chance;

/// How N is defined.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Norm {
    Coefficients,
    Squared,
    Mean,
}

const NORMS: [Norm; 3] = [Norm::Coefficients, Norm::Squared, Norm::Mean];

impl Norm {
    fn normalization<const D: usize>(self) -> Box<dyn Normalization<D>> {
        match self {
            Self::Coefficients => Box::new(Coefficients),
            Self::Squared => Box::new(SquaredGradient::default()),
            Self::Mean => Box::new(MeanGradient { tolerance: 1e-12, max_steps: 20_000, ..MeanGradient::default() }),
        }
    }

    /// N(F), from F at points of weight w.
    fn of<const D: usize>(self, f: &Expansion<'_, D>, coefficients: &[f64], points: &[[f64; D]], w: f64) -> f64 {
        let squared = |&p: &[f64; D]| f.gradient(p).expect("points lie inside").iter().map(|c| c * c).sum::<f64>();
        match self {
            Self::Coefficients => coefficients.iter().map(|c| c * c).sum(),
            Self::Squared => points.iter().map(|p| w * squared(p)).sum(),
            Self::Mean => points.iter().map(|p| w * squared(p).sqrt()).sum::<f64>().powi(2),
        }
    }
}

/// Points of weight w, and smoothness of order 1.
struct Case<'a, const D: usize> {
    basis: &'a dyn Basis<D>,
    degree: usize,
    points: Vec<[f64; D]>,
    w: f64,
    smoothness: f64,
}

impl<const D: usize> Case<'_, D> {
    fn fitted(&self, norm: Norm) -> Fitted {
        let mut data = Data::new();
        data.points(&self.points, self.w).unwrap();
        let fit = NormalizedFit::new(self.basis, &data);
        fit.smoothness(&Order1 { weight: self.smoothness }).normalization(&*norm.normalization()).run().unwrap()
    }

    /// E(F) from its definition. On a simplex |grad F|^2 is quadratic at most; its mean is that at the corners, with the weight
    /// 1 / (D + 2), and that in the middle, with the rest.
    fn energy(&self, coefficients: &[f64]) -> f64 {
        let f = Expansion::new(self.basis, coefficients);
        let data: f64 = self.points.iter().map(|&p| self.w * f.value(p).expect("points lie inside").powi(2)).sum();
        let domain = self.basis.domain();
        let mut integral = 0.0;
        for simplex in 0..domain.len() {
            let squared = |barycentric: [f64; 4]| {
                let place = Place { simplex, barycentric, position: domain.position(simplex, &barycentric) };
                f.gradient_at(&place).iter().map(|c| c * c).sum::<f64>()
            };
            let corners: f64 = (0..=D).map(|c| squared(std::array::from_fn(|k| if k == c { 1.0 } else { 0.0 }))).sum();
            let middle = squared(std::array::from_fn(|k| if k <= D { 1.0 / (D + 1) as f64 } else { 0.0 }));
            let d = D as f64;
            integral += domain.volume(simplex) * (corners / ((d + 1.0) * (d + 2.0)) + middle * (d + 1.0) / (d + 2.0));
        }
        data + self.smoothness * integral
    }

    fn quotient(&self, norm: Norm, coefficients: &[f64]) -> f64 {
        let f = Expansion::new(self.basis, coefficients);
        self.energy(coefficients) / norm.of(&f, coefficients, &self.points, self.w)
    }
}

/// Calls `check` with points around a curve or a surface, on P1 and P2.
fn for_cases(check: impl Fn(&Case<'_, 2>), check_in_space: impl Fn(&Case<'_, 3>)) {
    for mesh in meshes_2d() {
        for (degree, basis) in &bases(&mesh) {
            check(&Case { basis: &**basis, degree: *degree, points: curve(60), w: 0.5, smoothness: 1e-2 });
        }
    }
    for mesh in meshes_3d() {
        for (degree, basis) in &bases(&mesh) {
            check_in_space(&Case { basis: &**basis, degree: *degree, points: surface(150), w: 0.5, smoothness: 1e-2 });
        }
    }
}

fn quotient_is_least<const D: usize>(case: &Case<'_, D>) {
    let mut chance = Chance::new(31, 306, D);
    for norm in NORMS {
        let label = format!("{norm:?}, D {D}, degree {}", case.degree);
        let fitted = case.fitted(norm);
        let f = &fitted.coefficients;
        let least = fitted.rayleigh_quotient;
        // Sums in another order.
        let found = case.quotient(norm, f);
        assert!((found / least - 1.0).abs() < 1e-11, "{label}: {found} {least}");
        let n = norm.of(&Expansion::new(case.basis, f), f, &case.points, case.w);
        assert!((n - 1.0).abs() < 1e-11, "{label}: N = {n}");
        assert!((case.energy(f) / least - 1.0).abs() < 1e-11, "{label}");
        // The mean gradient is at rest in a local minimum, the others in the least.
        let sizes: &[f64] = if norm == Norm::Mean { &[1e-3] } else { &[1e-3, 0.1, 1.0] };
        let largest = f.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        for &size in sizes {
            for _ in 0..20 {
                let other: Vec<f64> = f.iter().map(|c| c + size * largest * chance.normal()).collect();
                let higher = case.quotient(norm, &other);
                assert!(higher > least * (1.0 - 1e-11), "{label}, moved by {size}: {higher} {least}");
            }
        }
    }
}

#[test]
fn the_result_has_the_least_quotient_by_its_definition() {
    for_cases(quotient_is_least, quotient_is_least);
}

fn steps_fall<const D: usize>(case: &Case<'_, D>) {
    for gradient in [Gradient::Element, Gradient::Recovered] {
        let mut data = Data::new();
        data.points(&case.points, case.w).unwrap();
        let start: Vec<f64> = random::<1>(32, case.basis.len(), -1.0, 1.0).into_iter().flatten().collect();
        for start in [None, Some(start)] {
            let mean = MeanGradient { gradient, start, max_steps: 20_000, ..MeanGradient::default() };
            let smoothness = Order1 { weight: case.smoothness };
            let fit = NormalizedFit::new(case.basis, &data).smoothness(&smoothness).normalization(&mean);
            let fitted = fit.run().unwrap();
            let steps = &fitted.steps;
            assert!(steps.len() > 2, "{steps:?}");
            // Rounding of a quotient.
            let rise = steps.windows(2).map(|s| s[1] / s[0] - 1.0).fold(f64::NEG_INFINITY, f64::max);
            assert!(rise < 1e-12, "{gradient:?}, D {D}, degree {}: {rise}", case.degree);
            assert_eq!(fitted.rayleigh_quotient, *steps.last().unwrap());
            assert!(fitted.diagnosis.warnings.is_empty(), "D {D}, degree {}: {:?}", case.degree, fitted.diagnosis);
        }
    }
}

#[test]
fn steps_of_the_mean_gradient_never_rise_and_come_to_rest() {
    for_cases(steps_fall, steps_fall);
}

#[test]
fn a_few_steps_do_not_come_to_rest_and_say_so() {
    let basis = P1::new(SimplicialMesh::lattice([0.0; 2], [1.0; 2], [5, 4]).unwrap());
    let mut data = Data::new();
    data.points(&curve(60), 1.0).unwrap();
    let few = MeanGradient { max_steps: 2, ..MeanGradient::default() };
    let smoothness = Order1 { weight: 1e-2 };
    let fit = NormalizedFit::new(&basis, &data).smoothness(&smoothness);
    let fitted = fit.normalization(&few).run().unwrap();
    assert_eq!(fitted.steps.len(), 3);
    assert_eq!(fitted.diagnosis.warnings, [Warning::NotAtRest]);
    // Where it comes to rest, it stays.
    let many = MeanGradient { max_steps: 20_000, ..MeanGradient::default() };
    let rested = fit.normalization(&many).run().unwrap();
    let again = MeanGradient { start: Some(rested.coefficients.clone()), ..MeanGradient::default() };
    let again = fit.normalization(&again).run().unwrap();
    assert!(again.steps.len() <= 3, "{:?}", again.steps);
    assert!((again.rayleigh_quotient / rested.rayleigh_quotient - 1.0).abs() < 1e-12);
}

fn solvers_agree<const D: usize>(case: &Case<'_, D>) {
    let mut data = Data::new();
    data.points(&case.points, case.w).unwrap();
    let smoothness = Order2 { weight: 1e-4 };
    let normalizations: [&dyn Normalization<D>; 3] =
        [&Coefficients, &SquaredGradient::default(), &SquaredGradient { gradient: Gradient::Recovered }];
    for (k, normalization) in normalizations.into_iter().enumerate() {
        let fit = NormalizedFit::new(case.basis, &data).smoothness(&smoothness).normalization(normalization);
        let exact = fit.solver(Solver::Dense).run().unwrap();
        let gap = exact.gap().unwrap() / exact.rayleigh_quotient;
        assert!(gap > 0.01, "D {D}, degree {}, normalisation {k}: a gap of {gap}", case.degree);
        let largest = exact.coefficients.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
        for solver in [Solver::Auto, Solver::ShiftInvert, Solver::Lobpcg] {
            let found = fit.solver(solver).run().unwrap();
            let label = format!("D {D}, degree {}, normalisation {k}, {solver:?}", case.degree);
            let off = (found.rayleigh_quotient / exact.rayleigh_quotient - 1.0).abs();
            assert!(off < 1e-8, "{label}: {off}");
            let coefficients = found.coefficients.iter().zip(&exact.coefficients);
            let off = coefficients.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
            // A value good to rounding leaves its vector the root of that over the gap.
            let enough = (1e-15 / gap).sqrt().max(1e-8);
            assert!(off < enough, "{label}: {off}, with a gap of {gap}");
        }
    }
}

#[test]
fn all_solvers_agree() {
    for_cases(solvers_agree, solvers_agree);
}

#[test]
fn gradients_of_linear_functions_are_exact() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        let slopes: [f64; D] = std::array::from_fn(|a| 1.0 - 1.5 * a as f64);
        let linear = |p: [f64; D]| (0..D).map(|a| slopes[a] * p[a]).sum::<f64>() + 0.7;
        let mut data = Data::new();
        data.points(&random(33, 200, 0.0, 1.0), 1.0).unwrap();
        for (degree, basis) in bases(mesh) {
            let f = interpolated(&*basis, linear);
            let samples = data.samples(&*basis).unwrap();
            for gradient in [Gradient::Element, Gradient::Recovered] {
                for row in rows(&*basis, &samples, gradient) {
                    let found = row.of(&f);
                    let off = (0..D).map(|a| (found[a] - slopes[a]).abs()).fold(0.0, f64::max);
                    assert!(off < 1e-11, "{gradient:?}, D {D}, degree {degree}: {found:?}");
                }
            }
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

#[test]
fn the_recovered_gradient_on_a_lattice_is_that_of_central_differences() {
    fn check<const D: usize>() {
        const CELLS: u32 = 5;
        let side = 1.0 / f64::from(CELLS);
        let basis = P1::new(SimplicialMesh::lattice([0.0; D], [1.0; D], [CELLS; D]).unwrap());
        let f: Vec<f64> = random::<1>(34, basis.len(), -1.0, 1.0).into_iter().flatten().collect();
        let expansion = Expansion::new(&basis, &f);
        let mut data = Data::new();
        // In inner cells, whose corners have neighbours on all sides.
        data.points(&random(35, 50, 1.01 * side, 1.0 - 1.01 * side), 1.0).unwrap();
        let samples = data.samples(&basis).unwrap();
        for (row, sample) in rows(&basis, &samples, Gradient::Recovered).iter().zip(&samples) {
            let corners = basis.domain().simplex(sample.place.simplex);
            let expected: [f64; D] = std::array::from_fn(|a| {
                let difference = |v: u32| {
                    let at = |sign: f64| {
                        let mut p = basis.domain().vertices()[v as usize];
                        p[a] += sign * side;
                        expansion.value(p).expect("the neighbour lies inside")
                    };
                    (at(1.0) - at(-1.0)) / (2.0 * side)
                };
                corners.iter().zip(sample.place.barycentric).map(|(&v, b)| b * difference(v)).sum()
            });
            let found = row.of(&f);
            let off = (0..D).map(|a| (found[a] - expected[a]).abs()).fold(0.0, f64::max);
            assert!(off < 1e-11, "D {D}: {found:?} {expected:?}");
        }
    }
    check::<2>();
    check::<3>();
}

#[test]
fn the_mean_gradient_with_one_function_needs_one_step() {
    // Two triangles, with all but one vertex held at zero by nothing: the one that data touch is the only unknown.
    let mesh = SimplicialMesh::<2>::from_triangles(vec![[0.0; 2], [1.0, 0.0], [0.0, 1.0]], &[[0, 1, 2]]).unwrap();
    let basis = P2::new(mesh);
    let mut data = Data::new();
    data.point([1.0, 0.0], 3.0).unwrap();
    let fitted = NormalizedFit::new(&basis, &data).normalization(&MeanGradient::default()).run().unwrap();
    // l (2 l - 1) has the gradient 3 along x at its own corner, and the value 1: E = 3 F^2, N = (3 * 3 F)^2.
    assert!((fitted.rayleigh_quotient - 3.0 / 81.0).abs() < 1e-15, "{fitted:?}");
    assert!((fitted.coefficients[1].abs() - 1.0 / 9.0).abs() < 1e-15);
}
