//! What cannot be fitted, and what can just so.

use super::{exactly, up_to};
use crate::feature::newe::{FlatCount, NeweError, NeweFitter, NeweParams, Normalization, fit, fit_as_printed};

fn ring(n: usize) -> Vec<[f64; 2]> {
    (0..n).map(|i| std::f64::consts::TAU * i as f64 / n as f64).map(|a| [a.cos(), a.sin()]).collect()
}

fn refused(params: NeweParams) -> NeweError {
    fit(&ring(20), &params).expect_err("not possible")
}

#[test]
fn impossible_parameters_are_named() {
    assert_eq!(refused(exactly(0)), NeweError::NoFlats);
    let range = FlatCount::Between { least: 3, most: 2 };
    assert_eq!(refused(NeweParams { flats: range, ..exactly(1) }), NeweError::EmptyRange { least: 3, most: 2 });
    assert_eq!(refused(NeweParams { schedule: vec![], ..exactly(1) }), NeweError::EmptySchedule);
    assert_eq!(refused(NeweParams { schedule: vec![2.0, 0.0], ..exactly(1) }), NeweError::Exponent(0.0));
    assert_eq!(refused(NeweParams { starts: 0, ..exactly(1) }), NeweError::NoStarts);
    assert_eq!(refused(NeweParams { noise: Some(-1.0), ..exactly(1) }), NeweError::Noise(-1.0));
    assert_eq!(fit_as_printed(&ring(20), 0, &[2.0], Normalization::Affine), Err(NeweError::NoFlats));
    assert_eq!(fit_as_printed(&ring(20), 2, &[], Normalization::Affine), Err(NeweError::EmptySchedule));
    let mut fitter = NeweFitter::new(exactly(2)).expect("parameters are sound");
    assert_eq!(fitter.fit_with_noise(&ring(20), -0.5), Err(NeweError::Noise(-0.5)));
}

#[test]
fn impossible_points_are_named() {
    assert_eq!(fit(&ring(5), &exactly(3)), Err(NeweError::TooFewPoints { given: 5, needed: 6 }));
    assert_eq!(fit::<2>(&[], &exactly(1)), Err(NeweError::TooFewPoints { given: 0, needed: 2 }));
    let mut points = ring(20);
    points[7][1] = f64::NAN;
    assert_eq!(fit(&points, &exactly(1)), Err(NeweError::NotFinite(7)));
    assert_eq!(fit(&[[]; 4], &exactly(1)), Err(NeweError::NoDimensions));
    let far = [[-1.7e308, 0.0], [1.7e308, 0.0], [0.0, 1.0]];
    assert_eq!(fit(&far, &exactly(1)), Err(NeweError::Extreme));
    assert_eq!(fit_as_printed(&far, 1, &[2.0], Normalization::Affine), Err(NeweError::Extreme));
}

#[test]
fn degenerate_points_are_fitted_without_harm() {
    for points in [vec![[3.0, 4.0]; 12], (0..12).map(|i| [f64::from(i), 2.0]).collect(), ring(4), ring(2)] {
        for normalization in [Normalization::Affine, Normalization::Homogeneous] {
            let params = NeweParams { normalization, ..up_to(3) };
            let found = fit(&points, &params).expect("one flat always fits");
            assert!(found.flats.iter().all(|f| f.offset.is_finite() && f.normal.iter().all(|c| c.is_finite())));
        }
    }
    let line: Vec<_> = (0..12).map(|i| [f64::from(i), 2.0]).collect();
    let found = fit(&line, &up_to(3)).expect("a line");
    assert_eq!(found.flats.len(), 1);
    assert!((found.flats[0].offset - 2.0).abs() < 1e-12 && found.assignment.iter().all(|a| *a == Some(0)));
}

#[test]
fn high_exponents_and_many_flats_leave_weights() {
    // The plain product of five errors of a hundredth to the power 200 would be 1e-2000.
    let params = NeweParams { schedule: vec![200.0, 150.5], ..exactly(6) };
    let found = fit(&ring(60), &params).expect("points and parameters are sound");
    assert_eq!(found.flats.len(), 6);
    let printed = fit_as_printed(&ring(60), 6, &params.schedule, Normalization::Affine).expect("as above");
    let last = printed.last().expect("there is the start");
    assert!(last.flats.len() == 6 && last.flats.iter().all(|f| f.offset.is_finite()));
}

#[test]
fn units_from_nanometres_to_light_years_serve() {
    for size in [1e-160, 1e-9, 1e16, 1e140] {
        let points: Vec<[f64; 2]> = (0..40)
            .map(|i| (f64::from(i / 2) / 20.0, i % 2))
            .map(|(t, arm)| if arm == 0 { [t * size, 0.0] } else { [0.0, t * size] })
            .collect();
        let found = fit(&points, &up_to(3)).expect("an L");
        assert_eq!(found.flats.len(), 2, "{size}");
    }
}
