//! Fits that cannot be made say why.

use std::sync::Mutex;

use super::curve;
use crate::basis::{Kernel, P1, Radial, Tail};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{
    Coefficients, Data, FitError, MeanGradient, Normalization, NormalizedFit, Order0, Order1, Order2, Smoothness,
    Solver, SquaredGradient,
};
use crate::monitor::{Cancelled, tests::Log};

fn basis() -> P1<2> {
    P1::new(SimplicialMesh::lattice([0.0; 2], [1.0; 2], [6, 6]).unwrap())
}

fn data() -> Data<2> {
    let mut data = Data::new();
    data.points(&curve(40), 1.0).unwrap();
    data
}

#[test]
fn a_smoothness_below_zero_or_not_finite_is_refused() {
    let (basis, data) = (basis(), data());
    for weight in [-1.0, -1e-300, f64::INFINITY] {
        let orders: [&dyn Smoothness<2>; 2] = [&Order1 { weight }, &Order2 { weight }];
        for order in orders {
            let error = NormalizedFit::new(&basis, &data).smoothness(order).run().unwrap_err();
            assert_eq!(error, FitError::Smoothness(weight));
        }
    }
    let order = Order1 { weight: f64::NAN };
    let error = NormalizedFit::new(&basis, &data).smoothness(&order).run().unwrap_err();
    assert!(matches!(error, FitError::Smoothness(weight) if weight.is_nan()));
    // None at all is as good as order 0.
    let none = NormalizedFit::new(&basis, &data).smoothness(&Order2 { weight: 0.0 }).run().unwrap();
    assert_eq!(none, NormalizedFit::new(&basis, &data).smoothness(&Order0).run().unwrap());
}

#[test]
fn a_start_of_the_wrong_length_is_refused() {
    let (basis, data) = (basis(), data());
    for given in [0, 48, 50] {
        let mean = MeanGradient { start: Some(vec![1.0; given]), ..MeanGradient::default() };
        let order = Order1 { weight: 1.0 };
        let error = NormalizedFit::new(&basis, &data).smoothness(&order).normalization(&mean).run().unwrap_err();
        assert_eq!(error, FitError::Start { given, needed: 49 });
    }
}

#[test]
fn a_start_without_a_gradient_is_refused() {
    let (basis, data) = (basis(), data());
    // On this lattice the gradients of a cell's functions sum to exactly 0, so that of a constant is no rounding either.
    for start in [vec![0.0; 49], vec![1.0; 49]] {
        let mean = MeanGradient { start: Some(start), ..MeanGradient::default() };
        let order = Order1 { weight: 1.0 };
        let error = NormalizedFit::new(&basis, &data).smoothness(&order).normalization(&mean).run().unwrap_err();
        assert_eq!(error, FitError::NoGradient);
    }
}

#[test]
fn the_mean_gradient_asks_for_a_positive_definite_energy() {
    let basis = P1::new(SimplicialMesh::four_triangles([0.0; 2], [1.0; 2]).unwrap());
    let mut data = Data::new();
    // Three points for five functions, all of which they touch.
    data.points(&[[0.5, 0.2], [0.55, 0.8], [0.2, 0.6]], 1.0).unwrap();
    let mean = MeanGradient::default();
    let fit = NormalizedFit::new(&basis, &data).normalization(&mean);
    assert_eq!(fit.run().unwrap_err(), FitError::NotPositiveDefinite);
    // The remedy that it names.
    assert!(fit.smoothness(&Order1 { weight: 0.1 }).run().is_ok());
}

#[test]
fn a_normalisation_that_vanishes_is_refused() {
    // One Gaussian, and one point at its top.
    let mesh = SimplicialMesh::lattice([0.0; 2], [1.0; 2], [4, 4]).unwrap();
    let basis = Radial::new(mesh, Kernel::Gaussian { width: 0.5 }, vec![[0.4, 0.3]], Tail::None).unwrap();
    let mut data = Data::new();
    data.point([0.4, 0.3], 1.0).unwrap();
    let started = MeanGradient { start: Some(vec![1.0]), ..MeanGradient::default() };
    let normalizations: [&dyn Normalization<2>; 3] = [&SquaredGradient::default(), &MeanGradient::default(), &started];
    for normalization in normalizations {
        for solver in [Solver::Auto, Solver::ShiftInvert, Solver::Lobpcg] {
            let fit = NormalizedFit::new(&basis, &data).normalization(normalization).solver(solver);
            assert_eq!(fit.run().unwrap_err(), FitError::NoGradient, "{solver:?}");
        }
    }
    assert!(NormalizedFit::new(&basis, &data).run().is_ok());
}

#[test]
fn the_monitor_stops_every_normalisation_and_solver() {
    let (basis, data) = (basis(), data());
    let stopped = Log(Mutex::default(), 0);
    let order = Order1 { weight: 1.0 };
    let normalizations: [&dyn Normalization<2>; 3] =
        [&Coefficients, &SquaredGradient::default(), &MeanGradient::default()];
    for normalization in normalizations {
        for solver in [Solver::Auto, Solver::Dense, Solver::ShiftInvert, Solver::Lobpcg] {
            let fit = NormalizedFit::new(&basis, &data).smoothness(&order).normalization(normalization).solver(solver);
            assert_eq!(fit.monitor(&stopped).run().unwrap_err(), FitError::Cancelled(Cancelled), "{solver:?}");
            assert!(fit.run().is_ok(), "{solver:?}");
        }
    }
}
