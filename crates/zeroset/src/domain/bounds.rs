//! The box around points.

/// The lowest and the highest value on each axis; infinite, the wrong way round, for no points.
pub(crate) fn bounds<const D: usize>(points: impl Iterator<Item = [f64; D]>) -> ([f64; D], [f64; D]) {
    points.fold(([f64::INFINITY; D], [f64::NEG_INFINITY; D]), |(low, high), p| {
        (std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a])))
    })
}
