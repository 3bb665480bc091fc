//! What holds for every fit.

use super::scenes::{Corner, planar_corner, spatial_corner};
use super::{NOISE, exactly, fit, fit_as_printed, up_to};
use crate::feature::newe::{
    Flat, FlatCount, NeweFitter, NeweParams, Normalization, Stage, corner, edge_line, halving_schedule,
};
use crate::sample::Chance;
use crate::vec3::{add, cross, dot, normalized, scale};

/// Points in another order, and where each of them was.
fn shuffled<const D: usize>(points: &[[f64; D]], seed: u64) -> (Vec<[f64; D]>, Vec<usize>) {
    let mut chance = Chance::new(seed, 78, 0);
    let mut order: Vec<usize> = (0..points.len()).collect();
    for i in (1..order.len()).rev() {
        order.swap(i, (chance.uniform() * (i + 1) as f64) as usize);
    }
    (order.iter().map(|&i| points[i]).collect(), order)
}

#[test]
fn the_order_of_the_points_does_not_matter_to_a_bit() {
    for seed in 0..10 {
        let truth = spatial_corner(&mut Chance::new(seed, 79, 0), Corner::Notch, 200, NOISE);
        let (points, order) = shuffled(&truth.points, seed);
        let (one, other) = (fit(&truth.points, &up_to(4)).expect("sound"), fit(&points, &up_to(4)).expect("sound"));
        assert_eq!(one.flats, other.flats);
        assert_eq!((one.noise, one.criterion), (other.noise, other.criterion));
        assert!(order.iter().zip(&other.assignment).all(|(&i, a)| one.assignment[i] == *a));
    }
}

#[test]
fn a_fit_repeats_itself_and_leaves_no_trace_in_the_fitter() {
    let mut fitter = NeweFitter::new(exactly(3)).expect("parameters are sound");
    for seed in 0..5 {
        let truth = spatial_corner(&mut Chance::new(seed, 80, 0), Corner::Outside, 100 + 50 * seed as usize, NOISE);
        let fresh = fit(&truth.points, &exactly(3)).expect("sound");
        assert_eq!(fitter.fit(&truth.points), Ok(fresh));
    }
}

#[test]
fn flats_move_turn_and_grow_with_the_points() {
    for seed in 0..20 {
        let mut chance = Chance::new(seed, 81, 0);
        let truth = spatial_corner(&mut chance, Corner::Notch, 300, NOISE);
        let z = chance.direction();
        let x = normalized(cross(z, chance.direction())).expect("directions differ");
        let axes = [x, cross(z, x), z];
        let (size, shift) = (chance.between(0.01, 100.0), chance.normal3(50.0));
        let turn = |v: [f64; 3]| std::array::from_fn(|a| (0..3).map(|c| v[c] * axes[c][a]).sum());
        let moved: Vec<[f64; 3]> = truth.points.iter().map(|p| add(shift, scale(turn(*p), size))).collect();
        let (one, other) = (fit(&truth.points, &up_to(4)).expect("sound"), fit(&moved, &up_to(4)).expect("sound"));
        assert_eq!(one.assignment, other.assignment);
        assert!((other.noise / (size * one.noise) - 1.0).abs() < 1e-9);
        for (flat, image) in one.flats.iter().zip(&other.flats) {
            let normal: [f64; 3] = turn(flat.normal);
            let sign = dot(normal, image.normal).signum();
            let offset = size * flat.offset + dot(normal, shift);
            // Coordinates are up to 1e4 sizes of the noise; 1e-16 of them, some thousand roundings.
            assert!((0..3).all(|a| (sign * normal[a] - image.normal[a]).abs() < 1e-9));
            assert!((sign * offset - image.offset).abs() < 1e-8 * size.max(1.0));
        }
    }
}

#[test]
fn affine_flats_move_with_the_points_and_homogeneous_ones_do_not() {
    let truth = planar_corner(&mut Chance::new(1, 82, 0), 100, 0.05);
    let centre = truth.corner;
    let angle = |normalization, shift: f64| {
        let at = |shift: f64| -> Vec<[f64; 2]> {
            truth.points.iter().map(|p| [p[0] - centre[0] + shift, p[1] - centre[1]]).collect()
        };
        let flat = |points: &[[f64; 2]]| {
            fit_as_printed(points, 1, &[2.0], normalization).expect("sound").pop().expect("the start").flats[0]
        };
        flat(&at(0.0)).angle(&flat(&at(shift)))
    };
    assert!(angle(Normalization::Affine, 100.0) < 1e-10);
    assert!(angle(Normalization::Homogeneous, 1.0) > 1e-2);
}

#[test]
fn a_homogeneous_flat_has_the_least_quotient() {
    let truth = spatial_corner(&mut Chance::new(2, 83, 0), Corner::Outside, 100, 0.1);
    let flat = fit_as_printed(&truth.points, 1, &[2.0], Normalization::Homogeneous).expect("sound").remove(0).flats[0];
    let quotient = |c: [f64; 4]| {
        let errors = truth.points.iter().map(|p| (c[0] * p[0] + c[1] * p[1] + c[2] * p[2] + c[3]).powi(2));
        errors.sum::<f64>() / c.iter().map(|c| c * c).sum::<f64>()
    };
    let [a, b, c] = flat.normal;
    let found = [a, b, c, -flat.offset];
    for i in 0..4 {
        for step in [-1e-3, 1e-3] {
            let mut other = found;
            other[i] += step;
            assert!(quotient(other) > quotient(found));
        }
    }
}

#[test]
fn hyperplanes_of_four_dimensions_are_found() {
    let mut chance = Chance::new(3, 84, 0);
    let corner_at = [1.0, -2.0, 0.5, 3.0];
    let flats: Vec<Flat<4>> = (0..4)
        .map(|j| {
            let tilt: [f64; 4] = std::array::from_fn(|a| f64::from(a == j) + 0.2 * chance.normal());
            Flat::through(corner_at, tilt).expect("a normal")
        })
        .collect();
    let points: Vec<[f64; 4]> = (0..1200)
        .map(|i| {
            let point = std::array::from_fn(|a| corner_at[a] + chance.between(-1.0, 1.0));
            let flat = &flats[i % 4];
            let off = flat.signed_distance(&point) - NOISE * chance.normal();
            std::array::from_fn(|a| point[a] - off * flat.normal[a])
        })
        .collect();
    for params in [exactly(4), up_to(6)] {
        let found = fit(&points, &params).expect("sound");
        assert_eq!(found.flats.len(), 4);
        for flat in &flats {
            let nearest = found.flats.iter().map(|f| f.angle(flat)).fold(f64::INFINITY, f64::min);
            // Each has 300 points of noise 0.01 over a width of 1: some 0.1 degrees.
            assert!(nearest.to_degrees() < 0.5, "{nearest}");
        }
        let meeting = corner(&found.flats, [0.0; 4]);
        assert_eq!(meeting.rank, 4);
        assert!((0..4).all(|a| (meeting.position[a] - corner_at[a]).abs() < 2.0 * NOISE));
    }
}

#[test]
fn outliers_belong_to_no_flat() {
    let mut chance = Chance::new(4, 85, 0);
    let truth = planar_corner(&mut chance, 100, NOISE).with_outliers(0.2, &mut chance);
    let found = fit(&truth.points, &exactly(2)).expect("sound");
    let on = |i: &usize| found.assignment[*i].is_some();
    // One good point in 370 lies farther out than three deviations; an outlier lies within them by chance, one in twenty or so.
    assert!((0..100).filter(on).count() >= 97);
    assert!((100..125).filter(on).count() <= 6);
    assert!((0.7..1.4).contains(&(found.noise / NOISE)));
}

#[test]
fn points_without_noise_give_exact_flats() {
    let points: Vec<[f64; 2]> = (0..60)
        .map(|i| (f64::from(i / 2) / 7.0, i % 2))
        .map(|(t, arm)| if arm == 0 { [t, 1.0] } else { [0.0, 1.0 + t] })
        .collect();
    let found = fit(&points, &up_to(4)).expect("sound");
    assert_eq!(found.flats.len(), 2);
    let at = corner(&found.flats, [5.0, 5.0]).position;
    assert!(at[0].abs() < 1e-12 && (at[1] - 1.0).abs() < 1e-12);
}

#[test]
fn iterates_lead_from_the_start_to_the_result() {
    let truth = spatial_corner(&mut Chance::new(5, 86, 0), Corner::Outside, 300, NOISE);
    let silent = fit(&truth.points, &exactly(3)).expect("sound");
    assert!(silent.iterates.is_empty());
    let told = fit(&truth.points, &NeweParams { keep_iterates: true, ..exactly(3) }).expect("sound");
    assert_eq!(told.flats, silent.flats);
    let weighted = |exponent| Stage::Weighted { exponent };
    assert_eq!(told.iterates[0].stage, Stage::Start);
    assert_eq!(told.iterates.last().expect("the last").flats, told.flats);

    let printed = fit_as_printed(&truth.points, 3, &halving_schedule(5), Normalization::Affine).expect("sound");
    let stages: Vec<Stage> = printed.iter().map(|i| i.stage).collect();
    assert_eq!(stages, [vec![Stage::Start], [32.0, 16.0, 8.0, 4.0, 2.0].map(weighted).to_vec()].concat());
}

#[test]
fn candidates_tell_how_the_number_was_chosen() {
    let truth = spatial_corner(&mut Chance::new(6, 87, 0), Corner::Outside, 300, NOISE);
    let found = fit(&truth.points, &up_to(5)).expect("sound");
    let least = found.candidates.iter().min_by(|a, b| a.criterion.total_cmp(&b.criterion)).expect("some");
    assert_eq!((least.flats, least.criterion), (3, found.criterion));
    assert!(found.candidates.windows(2).all(|c| c[1].objective <= c[0].objective));
    let range = FlatCount::Between { least: 1, most: 1000 };
    let found = fit(&truth.points[..9], &NeweParams { flats: range, ..NeweParams::default() }).expect("sound");
    assert!(found.candidates.iter().all(|c| c.flats <= 2));
}

#[test]
fn flats_meet_in_points_and_lines() {
    let flats = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 3.0]]
        .map(|normal| Flat::through([1.0, 2.0, 3.0], normal).expect("a normal"));
    let meeting = corner(&flats, [0.0; 3]);
    assert_eq!(meeting.rank, 3);
    assert!((0..3).all(|a| (meeting.position[a] - f64::from(a as u8 + 1)).abs() < 1e-12));
    let edge = corner(&flats[..2], [9.0, 9.0, 9.0]);
    assert_eq!((edge.rank, edge.position.map(|c| (c * 1e9).round() / 1e9)), (2, [1.0, 2.0, 9.0]));
    assert_eq!(corner::<3>(&[], [9.0; 3]).position, [9.0; 3]);

    let line = edge_line([flats[0], flats[1]], [0.0; 3]).expect("planes that meet");
    assert!(line.direction[2].abs() == 1.0 && (line.point[0] - 1.0).abs() < 1e-12 && line.point[2].abs() < 1e-12);
    let parallel = Flat::through([5.0, 0.0, 0.0], [1.0, 1e-4, 0.0]).expect("a normal");
    assert_eq!(edge_line([flats[0], parallel], [0.0; 3]), None);
    assert!((flats[0].angle(&parallel) - 1e-4).abs() < 1e-11);
    assert_eq!(Flat::through([0.0; 2], [0.0; 2]), None);
    assert_eq!(Flat::through([0.0; 2], [f64::NAN, 1.0]), None);
}
