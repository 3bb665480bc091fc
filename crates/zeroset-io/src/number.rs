//! Numbers as text, fast.

use std::io::Write;

/// Appends `value` with exactly `decimals` digits after the point, rounded to the nearest.
///
/// Several times faster than the formatter of the standard library, which takes over for values that are too large for
/// it; `value` must be finite.
pub(crate) fn push_fixed(out: &mut Vec<u8>, value: f64, decimals: u32) {
    // Up to 2^53 the scaled value is a whole number that f64 still tells from its neighbours.
    const EXACT: f64 = 9_007_199_254_740_992.0;
    let scale = 10_u64.pow(decimals.min(18));
    let scaled = (value.abs() * scale as f64).round();
    if decimals > 18 || scaled.is_nan() || scaled >= EXACT {
        // Writing to a Vec cannot fail.
        let _ = write!(out, "{value:.*}", decimals as usize);
        return;
    }
    let scaled = scaled as u64;
    if value < 0.0 && scaled != 0 {
        out.push(b'-');
    }
    push_integer(out, scaled / scale);
    if decimals > 0 {
        out.push(b'.');
        let start = out.len();
        push_integer(out, scale + scaled % scale);
        // The leading 1 keeps the zeros after the point; its place is where the point goes.
        out.remove(start);
    }
}

/// Appends `value` with at most so many decimals, without zeros at its end.
pub(crate) fn push_trimmed(out: &mut Vec<u8>, value: f64, decimals: u32) {
    let start = out.len();
    push_fixed(out, value, decimals);
    if out[start..].contains(&b'.') {
        let kept = out.iter().rposition(|digit| *digit != b'0').unwrap_or(start);
        out.truncate(if out[kept] == b'.' { kept } else { kept + 1 });
    }
}

/// The same as a text.
pub(crate) fn trimmed(value: f64, decimals: u32) -> String {
    let mut out = Vec::new();
    push_trimmed(&mut out, value, decimals);
    String::from_utf8_lossy(&out).into_owned()
}

/// Appends a whole number.
pub(crate) fn push_integer(out: &mut Vec<u8>, mut value: u64) {
    let mut digits = [0_u8; 20];
    let mut at = digits.len();
    loop {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
        if value == 0 {
            break;
        }
    }
    out.extend_from_slice(&digits[at..]);
}

/// How many decimals keep coordinates of a box: enough that rounding adds less than `tolerance`.
pub(crate) fn decimals_for(tolerance: f64) -> u32 {
    if tolerance.is_nan() || tolerance <= 0.0 {
        return 17;
    }
    // Rounding to d decimals moves a value by up to half of 10^-d.
    (0..17).find(|d| 0.5 * 10_f64.powi(-d) <= tolerance).map_or(17, i32::unsigned_abs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fixed(value: f64, decimals: u32) -> String {
        let mut out = Vec::new();
        push_fixed(&mut out, value, decimals);
        String::from_utf8(out).unwrap()
    }

    #[test]
    fn known_values() {
        assert_eq!(fixed(0.0, 3), "0.000");
        assert_eq!(fixed(-0.0001, 3), "0.000");
        assert_eq!(fixed(-1.5, 0), "-2");
        assert_eq!(fixed(2_600_000.123, 4), "2600000.1230");
        assert_eq!(fixed(0.05, 2), "0.05");
        assert_eq!(fixed(1e15, 3), "1000000000000000.000");
    }

    #[test]
    fn zeros_at_the_end_go() {
        for (value, expected) in [(12.5, "12.5"), (100.0, "100"), (-0.0, "0"), (0.1 + 0.2, "0.3"), (-3.25, "-3.25")] {
            assert_eq!(trimmed(value, 6), expected);
        }
        assert_eq!(trimmed(100.0, 0), "100");
    }

    #[test]
    fn decimals_keep_the_tolerance() {
        assert_eq!(decimals_for(0.001), 3);
        assert_eq!(decimals_for(0.0005), 3);
        assert_eq!(decimals_for(0.0001), 4);
        assert_eq!(decimals_for(10.0), 0);
        assert_eq!(decimals_for(0.0), 17);
    }

    proptest! {
        #[test]
        fn reads_back_within_half_a_digit(value in -1e11_f64..1e11, decimals in 0_u32..9) {
            let back: f64 = fixed(value, decimals).parse().unwrap();
            let unit = 10_f64.powi(-(decimals as i32));
            prop_assert!((back - value).abs() <= 0.5 * unit + 4.0 * f64::EPSILON * value.abs());
        }

        #[test]
        fn integers(value: u64) {
            let mut out = Vec::new();
            push_integer(&mut out, value);
            prop_assert_eq!(String::from_utf8(out).unwrap(), value.to_string());
        }
    }
}
