//! 1,000 random corners of three planes.

use super::scenes::{Corner, spatial_corner};
use super::{NOISE, exactly, rates};

fn kind(run: usize) -> Corner {
    if run.is_multiple_of(2) { Corner::Outside } else { Corner::Notch }
}

#[test]
fn all_planes_and_the_point_of_a_corner_are_found() {
    let rates =
        rates("corner in space", 1000, 3.0, &exactly(3), |chance, run| spatial_corner(chance, kind(run), 600, NOISE));
    assert!(rates.fit >= 0.99 && rates.corner >= 0.99, "{rates:?}");
    assert!(rates.printed.iter().all(|p| (0.5..0.75).contains(p)), "{rates:?}");
}

#[test]
fn all_planes_are_found_among_outliers() {
    let rates = rates("corner in space, a fifth outliers", 300, 3.0, &exactly(3), |chance, run| {
        spatial_corner(chance, kind(run), 600, NOISE).with_outliers(0.2, chance)
    });
    assert!(rates.fit >= 0.97 && rates.corner >= 0.97, "{rates:?}");
}
