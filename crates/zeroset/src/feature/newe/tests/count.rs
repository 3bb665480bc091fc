//! The number of flats.

use super::scenes::roof;
use super::{NOISE, NeweParams, rates, up_to};

#[test]
fn the_right_number_of_planes_is_chosen() {
    for planes in 1..=4 {
        let name = format!("a roof of {planes}, noise measured");
        let rates = rates(&name, 200, 5.0, &up_to(5), |chance, _| roof(chance, planes, 400, NOISE));
        assert!(rates.count >= 0.97, "{planes}: {rates:?}");
    }
}

#[test]
fn the_right_number_is_chosen_from_a_hundred_points_of_known_noise() {
    let params = NeweParams { noise: Some(NOISE), ..up_to(5) };
    for planes in 1..=4 {
        let name = format!("a roof of {planes}, 100 points, noise known");
        let rates = rates(&name, 200, 5.0, &params, |chance, _| roof(chance, planes, 100, NOISE));
        assert!(rates.count >= 0.97, "{planes}: {rates:?}");
    }
}

#[test]
fn outliers_are_no_planes() {
    for planes in 1..=4 {
        let name = format!("a roof of {planes}, a fifth outliers, noise measured");
        let rates =
            rates(&name, 60, 5.0, &up_to(5), |chance, _| roof(chance, planes, 400, NOISE).with_outliers(0.2, chance));
        // Little is lost against clean roofs.
        assert!(rates.count >= 0.95, "{planes}: {rates:?}");
    }
}
