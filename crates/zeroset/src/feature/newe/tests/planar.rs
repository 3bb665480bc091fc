//! 1,000 random corners of two lines.

use super::scenes::planar_corner;
use super::{NOISE, exactly, rates};

#[test]
fn both_lines_of_a_corner_are_found() {
    let rates = rates("corner in the plane", 1000, 2.0, &exactly(2), |chance, _| planar_corner(chance, 100, NOISE));
    assert!(rates.fit >= 0.995, "{rates:?}");
    // What one start does: the reading of the damaged exponents rests on it.
    assert!(rates.printed.iter().all(|p| (0.92..0.97).contains(p)), "{rates:?}");
}

#[test]
fn both_lines_are_found_among_outliers() {
    let rates = rates("corner in the plane, a fifth outliers", 1000, 2.0, &exactly(2), |chance, _| {
        planar_corner(chance, 100, NOISE).with_outliers(0.2, chance)
    });
    assert!(rates.fit >= 0.97, "{rates:?}");
    assert!(rates.printed.iter().all(|p| *p < 0.1), "{rates:?}");
}
