//! Measures the tables of `docs/methods/newe.md`:
//! `cargo test --release -p zeroset --lib newe::tests::survey -- --ignored --nocapture`.

use std::time::Instant;

use super::scenes::{Corner, Truth, planar_corner, roof, spatial_corner};
use super::{NOISE, NeweParams, Rates, exactly, rates, up_to};
use crate::feature::newe::{NeweFitter, Normalization, fit_as_printed, halving_schedule};
use crate::sample::Chance;

fn corner(chance: &mut Chance, run: usize) -> Truth<3> {
    let kind = if run.is_multiple_of(2) { Corner::Outside } else { Corner::Notch };
    spatial_corner(chance, kind, 600, NOISE)
}

#[test]
#[ignore = "measures, and takes minutes"]
fn outliers() {
    for share in [0.1, 0.2, 0.3, 0.4, 0.5] {
        rates(&format!("plane, outliers {share}"), 500, 2.0, &exactly(2), |chance, _| {
            planar_corner(chance, 100, NOISE).with_outliers(share, chance)
        });
        rates(&format!("space, outliers {share}"), 500, 3.0, &exactly(3), |chance, run| {
            corner(chance, run).with_outliers(share, chance)
        });
    }
}

#[test]
#[ignore = "measures, and takes minutes"]
fn kinds_and_starts() {
    for kind in [Corner::Outside, Corner::Notch] {
        for starts in [1, 2, 3, 8] {
            let params = NeweParams { starts, ..exactly(3) };
            let make = |chance: &mut Chance| spatial_corner(chance, kind, 600, NOISE);
            rates(&format!("{kind:?}, {starts} starts"), 1000, 3.0, &params, |chance, _| make(chance));
            rates(&format!("{kind:?}, {starts} starts, a fifth outliers"), 1000, 3.0, &params, |chance, _| {
                make(chance).with_outliers(0.2, chance)
            });
        }
    }
}

#[test]
#[ignore = "measures, and takes minutes"]
fn counts() {
    for points in [50, 100, 200, 400, 800] {
        for noise in [None, Some(NOISE)] {
            let params = NeweParams { noise, ..up_to(5) };
            let one = |planes| -> Rates {
                let name = format!("{planes} planes, {points} points, noise {noise:?}");
                rates(&name, 500, 5.0, &params, |chance, _| roof(chance, planes, points, NOISE))
            };
            let counts = [1, 2, 3, 4].map(|planes| one(planes).count);
            println!("| {points} | {noise:?} | {counts:.3?}");
        }
    }
}

/// Two planes that turn by an angle at a ridge in the middle of a unit square.
fn crease(chance: &mut Chance, turn_deg: f64, points: usize) -> Vec<[f64; 3]> {
    let slope = (0.5 * turn_deg).to_radians().tan();
    (0..points)
        .map(|_| {
            let (x, y) = (chance.between(-0.5, 0.5), chance.uniform());
            [x, y, -slope * x.abs() + NOISE * chance.normal()]
        })
        .collect()
}

#[test]
#[ignore = "measures, and takes minutes"]
fn shallow_creases() {
    let mut fitter = NeweFitter::new(NeweParams { noise: Some(NOISE), ..up_to(4) }).expect("sound");
    for turn_deg in [4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0] {
        let share = |points| {
            let two = |run: &u64| {
                let points = crease(&mut Chance::new(*run, 90, 0), turn_deg, points);
                fitter.fit(&points).expect("sound").flats.len() == 2
            };
            (0..500).filter(two).count() as f64 / 500.0
        };
        println!("turn {turn_deg}: {:?}", [100, 400].map(share));
    }
}

#[test]
#[ignore = "measures, and takes minutes"]
fn schedules() {
    let quarter: Vec<f64> = halving_schedule(5).iter().map(|p| p / 4.0).collect();
    for schedule in [halving_schedule(5), quarter, halving_schedule(3), halving_schedule(7), vec![2.0; 10]] {
        for normalization in [Normalization::Affine, Normalization::Homogeneous] {
            let good = |within: f64, angle: f64| usize::from(angle < within);
            let [mut plane, mut space] = [0, 0];
            for run in 0..1000 {
                let chance = || Chance::new(run as u64, 77, 0);
                let truth = planar_corner(&mut chance(), 100, NOISE);
                let last = fit_as_printed(&truth.points, 2, &schedule, normalization).expect("sound").pop();
                plane += good(2.0, truth.angle_deg(&last.expect("the start").flats));
                let truth = corner(&mut chance(), run);
                let last = fit_as_printed(&truth.points, 3, &schedule, normalization).expect("sound").pop();
                space += good(3.0, truth.angle_deg(&last.expect("the start").flats));
            }
            println!("{schedule:?} {normalization:?}: plane {plane}, space {space} of 1000");
        }
    }
}

#[test]
#[ignore = "measures, and takes minutes"]
fn seconds() {
    for points in [50, 100, 400, 1600, 20_000] {
        for noise in [None, Some(NOISE)] {
            let mut fitter = NeweFitter::new(NeweParams { noise, ..up_to(4) }).expect("sound");
            let milliseconds = [1, 2, 3, 4].map(|planes| {
                let runs = (20_000 / points).clamp(5, 200) as u64;
                let truths = (0..runs).map(|run| roof(&mut Chance::new(run, 91, 0), planes, points, NOISE));
                let truths: Vec<Truth<3>> = truths.collect();
                let start = Instant::now();
                for truth in &truths {
                    fitter.fit(&truth.points).expect("sound");
                }
                1e3 * start.elapsed().as_secs_f64() / runs as f64
            });
            println!("{points} points, noise {noise:?}: {milliseconds:.3?} ms for 1 to 4 planes");
        }
    }
}
