//! Where a function of one variable passes through zero between 0 and 1. Zero counts as positive.

/// Whether a value counts as negative. Zero of either sign does not.
pub(super) fn is_negative(value: f64) -> bool {
    value < 0.0
}

/// The root of the linear function with end values of different signs.
pub(super) fn linear([first, last]: [f64; 2]) -> f64 {
    first / (first - last)
}

/// The roots of the quadratic with the given values at 0, 1/2 and 1, in ascending order: one if the ends differ in sign, none or two
/// otherwise. A double root is none.
pub(super) fn quadratic(values: [f64; 3]) -> ([f64; 2], usize) {
    let [first, _, last] = values;
    match (is_negative(first), is_negative(last)) {
        (true, false) => ([rising(values), 1.0], 1),
        (false, true) => ([rising(values.map(|v| -v)), 1.0], 1),
        (false, false) => dip(values),
        (true, true) => dip(values.map(|v| -v)),
    }
}

/// The middle coefficient of the Bernstein form; the outer ones are the end values.
fn bernstein_middle([first, middle, last]: [f64; 3]) -> f64 {
    2.0 * middle - 0.5 * (first + last)
}

/// The root at which a quadratic turns from negative to positive; its end values are at most and at least zero.
fn rising(values: [f64; 3]) -> f64 {
    let [first, _, last] = values;
    let control = bernstein_middle(values);
    let slope = control - first;
    let root = (control * control - first * last).max(0.0).sqrt();
    // Each form is used where its denominator does not cancel.
    let t = if slope >= 0.0 { -first / (slope + root) } else { (root - slope) / (first - 2.0 * control + last) };
    if t.is_finite() { t.clamp(0.0, 1.0) } else { linear([first, last]) }
}

/// The two roots of a quadratic between end values that are not negative, if it is negative somewhere between them.
fn dip(values: [f64; 3]) -> ([f64; 2], usize) {
    let [first, _, last] = values;
    let control = bernstein_middle(values);
    let discriminant = control * control - first * last;
    // The least value lies between the ends only if the control value lies below both.
    if control >= first || control >= last || control >= 0.0 || discriminant <= 0.0 {
        return ([0.0, 1.0], 0);
    }
    let root = discriminant.sqrt();
    let low = first / (first - control + root);
    let high = 1.0 - last / (last - control + root);
    ([low.clamp(0.0, 1.0), high.clamp(low, 1.0)], 2)
}

/// A root of a continuous function between 0 and 1 with end values of different signs: the secant rule of Illinois (Dowell and Jarratt
/// 1971), with a bisection wherever it is slow.
pub(super) fn bracketed(ends: [f64; 2], value: impl Fn(f64) -> f64) -> f64 {
    const MOST_STEPS: usize = 200;
    let (mut low, mut high) = (0.0, 1.0);
    let [mut at_low, mut at_high] = ends;
    if at_low == 0.0 {
        return 0.0;
    }
    if at_high == 0.0 {
        return 1.0;
    }
    for step in 0..MOST_STEPS {
        let width: f64 = high - low;
        if width <= f64::EPSILON * high {
            break;
        }
        let secant = low + width * linear([at_low, at_high]);
        let inside = secant > low && secant < high;
        let t = if inside && step % 4 != 3 { secant } else { 0.5 * (low + high) };
        let at = value(t);
        if at == 0.0 || !at.is_finite() || t <= low || t >= high {
            return t;
        }
        if is_negative(at) == is_negative(at_low) {
            (low, at_low) = (t, at);
            at_high *= 0.5;
        } else {
            (high, at_high) = (t, at);
            at_low *= 0.5;
        }
    }
    0.5 * (low + high)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::Chance;

    #[test]
    fn roots_of_quadratics_are_found_wherever_they_are() {
        let mut chance = Chance::new(1, 71, 0);
        for _ in 0..10_000 {
            let (r, s) = (chance.between(-0.5, 1.5), chance.between(-0.5, 1.5));
            let factor = chance.between(-3.0, 3.0);
            let q = |t: f64| factor * (t - r) * (t - s);
            let ([first, second], count) = quadratic([q(0.0), q(0.5), q(1.0)]);
            let mut expected: Vec<f64> = [r, s].into_iter().filter(|t| (0.0..1.0).contains(t)).collect();
            expected.sort_by(f64::total_cmp);
            let found = &[first, second][..count];
            // A double root is none, and near one the roots are as uncertain as the root of the rounding.
            if (r - s).abs() > 1e-5 {
                assert_eq!(found.len(), expected.len(), "{r} {s} {factor}");
                assert!(found.iter().zip(&expected).all(|(f, e)| (f - e).abs() < 1e-9), "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn zero_counts_as_positive() {
        assert_eq!(quadratic([0.0, 0.5, 1.0]).1, 0);
        assert_eq!(quadratic([0.0, -0.5, -1.0]), ([0.0, 1.0], 1));
        assert_eq!(quadratic([-1.0, -0.5, 0.0]), ([1.0, 1.0], 1));
        assert_eq!(quadratic([0.0, -1.0, 0.0]), ([0.0, 1.0], 2));
        assert_eq!(quadratic([0.0; 3]).1, 0);
        assert_eq!(quadratic([1.0, 0.0, 1.0]).1, 0);
    }

    #[test]
    fn a_bracket_closes_on_the_root() {
        for power in [1, 3, 9] {
            let f = |t: f64| (t - 0.3).powi(power) + 1e-9 * (t - 0.3);
            assert!((bracketed([f(0.0), f(1.0)], f) - 0.3).abs() < 1e-12);
        }
        let step = |t: f64| if t < 0.7 { 5.0 } else { -1e-3 };
        assert!((bracketed([5.0, -1e-3], step) - 0.7).abs() < 1e-12);
    }
}
