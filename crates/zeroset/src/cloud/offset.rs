//! The offset between world and local coordinates.

/// Coordinates up to this size stay as they are: f32 still resolves them to a tenth of a millimetre if they are metres.
const LARGE: f64 = 1000.0;

/// The offset to subtract from world coordinates: zero for clouds near the origin, else the centre of the box rounded to
/// whole hundreds, so that local coordinates are short and a person can add the offset back by hand.
///
/// Non-finite coordinates are passed over. Axes are treated alike: either all are shifted or none.
#[must_use]
pub fn choose_offset(world: impl Iterator<Item = [f64; 3]>) -> [f64; 3] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for point in world.filter(|p| p.iter().all(|c| c.is_finite())) {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    if low[0] > high[0] || (0..3).all(|a| low[a].abs() <= LARGE && high[a].abs() <= LARGE) {
        return [0.0; 3];
    }
    std::array::from_fn(|a| {
        let centre = (0.5 * low[a] + 0.5 * high[a]) / 100.0;
        centre.round() * 100.0
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_coordinates_are_left_alone() {
        assert_eq!(choose_offset([[0.0, 1.0, -999.0], [5.0, 6.0, 7.0]].into_iter()), [0.0; 3]);
        assert_eq!(choose_offset(std::iter::empty()), [0.0; 3]);
    }

    #[test]
    fn georeferenced_coordinates_are_centred_on_whole_hundreds() {
        let offset = choose_offset([[84_810.3, 447_412.8, 1.0], [84_910.3, 447_512.8, 9.0]].into_iter());
        assert_eq!(offset, [84_900.0, 447_500.0, 0.0]);
    }

    #[test]
    fn non_finite_points_do_not_rule() {
        let offset = choose_offset([[f64::NAN, 0.0, 0.0], [2_600_000.1, 1_200_000.4, f64::INFINITY]].into_iter());
        assert_eq!(offset, [0.0; 3]);
    }
}
