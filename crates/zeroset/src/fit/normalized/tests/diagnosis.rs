//! The diagnosis names what is wrong, and nothing where all is well.

use super::{bases, curve, surface};
use crate::basis::{Basis, Derivatives, P1, Terms};
use crate::domain::{Place, SimplicialMesh};
use crate::fit::normalized::{
    Coefficients, Data, Diagnosis, MeanGradient, Minimum, Normalization, NormalizedFit, Order1, Order2,
    SquaredGradient, Warning,
};
use crate::sample::Chance;

#[test]
fn functions_that_nothing_constrains_are_named_and_f_is_not_known_there() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>, points: &[[f64; D]]) {
        let mut data = Data::new();
        data.points(points, 1.0).unwrap();
        for (degree, basis) in bases(mesh) {
            // Points lie inside simplices, so all functions of a simplex with points are constrained.
            let mut touched = vec![false; basis.len()];
            let mut terms = Terms::new();
            let places: Vec<_> = points.iter().filter_map(|&p| mesh.locate(p)).collect();
            for place in &places {
                basis.evaluate(place, Derivatives::None, &mut terms);
                terms.indices.iter().for_each(|&j| touched[j as usize] = true);
            }
            let free: Vec<usize> = (0..basis.len()).filter(|&j| !touched[j]).collect();
            assert!(!free.is_empty() && free.len() < basis.len());
            for normalization in [&Coefficients as &dyn Normalization<D>, &SquaredGradient::default()] {
                let fit = NormalizedFit::new(&*basis, &data).normalization(normalization);
                let fitted = fit.run().unwrap();
                assert_eq!(fitted.diagnosis.unconstrained, free, "D {D}, degree {degree}");
                let warning = Warning::Unconstrained { count: free.len(), first: free[0] };
                assert!(fitted.diagnosis.warnings.contains(&warning), "{:?}", fitted.diagnosis.warnings);
                let f = fitted.function(&*basis);
                for simplex in 0..mesh.len() {
                    let middle = 1.0 / (D + 1) as f64;
                    let barycentric = std::array::from_fn(|c| if c <= D { middle } else { 0.0 });
                    let position = mesh.position(simplex, &barycentric);
                    let place = Place { simplex, barycentric, position };
                    basis.evaluate(&place, Derivatives::None, &mut terms);
                    let known = terms.indices.iter().all(|&j| touched[j as usize]);
                    assert_eq!(f.is_defined(simplex), known);
                    assert_eq!(f.value(position).is_some(), known);
                    assert_eq!(f.gradient(position).is_some(), known);
                }
                assert!(places.iter().all(|p| f.is_defined(p.simplex)));
                // Smoothness constrains all.
                let smooth = fit.smoothness(&Order1 { weight: 1e-3 }).run().unwrap();
                assert!(smooth.diagnosis.unconstrained.is_empty() && !smooth.unconstrained.contains(&true));
            }
        }
    }
    check(&SimplicialMesh::lattice([0.0; 2], [1.0; 2], [9, 8]).unwrap(), &curve(30));
    check(&SimplicialMesh::lattice([0.0; 3], [1.0; 3], [5, 5, 6]).unwrap(), &surface(60));
}

#[test]
fn too_few_points_leave_f_not_unique() {
    let basis = P1::new(SimplicialMesh::four_triangles([0.0; 2], [1.0; 2]).unwrap());
    // In opposite triangles first, so that they touch all five functions.
    let points = [[0.5, 0.2], [0.55, 0.8], [0.2, 0.6], [0.8, 0.45], [0.4, 0.15]];
    for normalization in [&Coefficients as &dyn Normalization<2>, &SquaredGradient::default()] {
        for count in 2..=5 {
            let mut data = Data::new();
            data.points(&points[..count], 1.0).unwrap();
            let fitted = NormalizedFit::new(&basis, &data).normalization(normalization).run().unwrap();
            let zeros = 5 - count;
            assert_eq!(fitted.diagnosis.zero_values, zeros, "{count} points: {:?}", fitted.spectrum);
            let named = fitted.diagnosis.warnings.contains(&Warning::NotUnique { count: zeros });
            // One zero is an F that vanishes on the data: there is no better one.
            assert_eq!(named, zeros > 1, "{count} points: {:?}", fitted.diagnosis);
        }
    }
}

/// Points on a sphere in the unit cube.
fn sphere(count: usize) -> Vec<[f64; 3]> {
    let mut chance = Chance::new(61, 306, 0);
    (0..count).map(|_| chance.direction().map(|c| 0.5 + 0.33 * c)).collect()
}

#[test]
fn f_on_one_function_is_named() {
    // The paper's normalisation on many cells, some of which data hardly touch.
    let basis = P1::new(SimplicialMesh::lattice([0.0; 3], [1.0; 3], [10; 3]).unwrap());
    let mut data = Data::new();
    data.points(&sphere(3000), 1.0).unwrap();
    let diagnosis = NormalizedFit::new(&basis, &data).run().unwrap().diagnosis;
    let constrained = basis.len() - diagnosis.unconstrained.len();
    assert!(diagnosis.participation_ratio * (constrained as f64) < 1.01, "{diagnosis:?}");
    let localised = diagnosis.warnings.iter().find_map(|w| match w {
        Warning::Localised { nodes, functions } => Some((*nodes, *functions)),
        _ => None,
    });
    let (nodes, functions) = localised.expect("F sits on one function");
    assert!(nodes < 1.01 && functions == constrained && functions > 300, "{nodes} {functions}");
    // There F is steep at the few points near the function, too.
    assert!(diagnosis.gradient_participation < 0.01);
    assert!(diagnosis.warnings.iter().any(|w| matches!(w, Warning::Uneven { .. })), "{:?}", diagnosis.warnings);
}

#[test]
fn nothing_is_named_where_f_is_healthy() {
    for cells in [6, 8] {
        let basis = P1::new(SimplicialMesh::lattice([0.0; 3], [1.0; 3], [cells; 3]).unwrap());
        let mut data = Data::new();
        data.points(&sphere(3000), 1.0).unwrap();
        let order = Order2 { weight: 0.03 };
        let fit = NormalizedFit::new(&basis, &data).smoothness(&order);
        let fitted = fit.normalization(&SquaredGradient::default()).run().unwrap();
        assert!(fitted.diagnosis.warnings.is_empty(), "{:?}", fitted.diagnosis);
        assert!(fitted.diagnosis.gradient_participation > 0.95, "{:?}", fitted.diagnosis);
        // The signs are right wherever the sphere is more than half a cell away.
        for (&f, v) in fitted.coefficients.iter().zip(basis.domain().vertices()) {
            let distance = v.iter().map(|c| (c - 0.5).powi(2)).sum::<f64>().sqrt() - 0.33;
            assert!(distance.abs() < 0.5 / f64::from(cells) || (f < 0.0) == (distance < 0.0), "{v:?}: {f}");
        }
    }
}

#[test]
fn ratios_and_warnings_follow_their_definitions() {
    let minimum = |coefficients: &[f64], spectrum: &[f64], at_rest: bool| Minimum {
        coefficients: coefficients.to_vec(),
        spectrum: spectrum.to_vec(),
        scale: 2.0,
        steps: Vec::new(),
        at_rest,
        rayleigh_quotient: 0.0,
    };
    let even = [(1.0, 3.0), (5.0, 3.0)];
    let all = Diagnosis::of(&minimum(&[0.5, -0.5, 0.5, 0.5, -0.5], &[0.1, 0.2], true), &[false; 5], &even);
    assert!((all.participation_ratio - 1.0).abs() < 1e-15 && (all.gradient_participation - 1.0).abs() < 1e-15);
    assert_eq!((all.zero_values, all.warnings), (0, vec![]));

    // One function rules; one of 99 equal weights has all of the gradient; two values are zero; and so on.
    let mut uneven = vec![(0.1, 0.0); 99];
    uneven[30].1 = 7.0;
    let free = [false, true, false, true, false, false, false];
    let none = Diagnosis::of(&minimum(&[0.0, 0.0, -4.0, 0.0, 0.0], &[1e-12, 1.9e-12, 2.1e-12], false), &free, &uneven);
    assert!((none.participation_ratio - 0.2).abs() < 1e-15);
    assert!((none.gradient_participation - 1.0 / 99.0).abs() < 1e-12);
    assert_eq!((&none.unconstrained, none.zero_values), (&vec![1, 3], 2));
    assert_eq!(
        none.warnings,
        [
            Warning::Unconstrained { count: 2, first: 1 },
            Warning::NotUnique { count: 2 },
            Warning::Localised { nodes: 1.0, functions: 5 },
            Warning::Uneven { share: none.gradient_participation },
            Warning::NotAtRest,
        ]
    );
}

#[test]
fn f_is_negative_inside_and_positive_on_the_rim() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>, points: &[[f64; D]]) {
        let mut data = Data::new();
        data.points(points, 1.0).unwrap();
        let smoothness = Order2 { weight: 1e-3 };
        let mean = MeanGradient { max_steps: 5000, ..MeanGradient::default() };
        let normalizations: [&dyn Normalization<D>; 3] = [&Coefficients, &SquaredGradient::default(), &mean];
        for (degree, basis) in bases(mesh) {
            for (k, normalization) in normalizations.into_iter().enumerate() {
                let fit = NormalizedFit::new(&*basis, &data).smoothness(&smoothness).normalization(normalization);
                let fitted = fit.run().unwrap();
                let f = fitted.function(&*basis);
                let label = format!("D {D}, degree {degree}, normalisation {k}: {:?}", fitted.diagnosis);
                assert!(f.value([0.5; D]).unwrap() < 0.0, "{label}");
                for &v in &mesh.rim() {
                    assert!(f.value(mesh.vertices()[v as usize]).unwrap() > 0.0, "{label}");
                }
                assert!(fitted.diagnosis.warnings.is_empty(), "{label}");
            }
        }
    }
    check(&SimplicialMesh::lattice([0.0; 2], [1.0; 2], [6, 6]).unwrap(), &curve(200));
    check(&SimplicialMesh::lattice([0.0; 3], [1.0; 3], [4, 5, 4]).unwrap(), &surface(600));
}
