//! Plain tables and numbers for people.

use serde::Serialize;
use zeroset_io::LinearUnit;

/// Rows of words in columns: the first column to the left, all others to the right.
pub(crate) fn columns(rows: &[Vec<String>]) -> String {
    let count = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).map(|w| w.chars().count()).max().unwrap_or(0);
    let widths: Vec<usize> = (0..count).map(width).collect();
    let mut out = String::new();
    for row in rows {
        let mut line = String::new();
        for (c, word) in row.iter().enumerate() {
            let width = widths[c];
            line += &if c == 0 { format!("{word:<width$}") } else { format!("  {word:>width$}") };
        }
        out += line.trim_end();
        out.push('\n');
    }
    out
}

/// A row of words.
pub(crate) fn words(row: &[&str]) -> Vec<String> {
    row.iter().map(|word| (*word).to_owned()).collect()
}

/// Wall seconds of each stage.
pub(crate) fn stages(seconds: &[(&str, f64)]) -> String {
    let rows = seconds.iter().map(|(stage, seconds)| vec![(*stage).to_owned(), clock(*seconds)]);
    columns(&std::iter::once(words(&["stage", "seconds"])).chain(rows).collect::<Vec<_>>())
}

/// Seconds to the millisecond.
pub(crate) fn clock(seconds: f64) -> String {
    format!("{seconds:.3}")
}

/// Names and values below each other.
pub(crate) fn pairs(rows: &[(&str, String)]) -> String {
    let width = rows.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    rows.iter().map(|(name, value)| format!("{name:<width$}  {value}\n")).collect()
}

/// A whole number with its thousands set apart.
pub(crate) fn count(n: impl TryInto<u64>) -> String {
    let digits = n.try_into().unwrap_or(u64::MAX).to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// A number with so many significant digits, without zeros at the end.
pub(crate) fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return value.to_string();
    }
    let magnitude = value.abs().log10().floor();
    if !(-6.0..15.0).contains(&magnitude) {
        return format!("{value:.*e}", digits.saturating_sub(1));
    }
    let decimals = (digits as f64 - 1.0 - magnitude).max(0.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
}

/// Bytes in the largest decimal unit that leaves a whole number before the point.
pub(crate) fn bytes(n: u64) -> String {
    let (value, unit) = match n {
        1_000_000_000.. => (n as f64 / 1e9, "GB"),
        1_000_000.. => (n as f64 / 1e6, "MB"),
        1000.. => (n as f64 / 1e3, "kB"),
        _ => return format!("{n} bytes"),
    };
    format!("{} {unit}", significant(value, 3))
}

/// A position with the decimals that a length asks for.
pub(crate) fn position(p: [f64; 3], decimals: usize) -> String {
    p.map(|c| format!("{c:.decimals$}")).join(", ")
}

/// Decimals that show a thousandth of a length.
pub(crate) fn decimals_for(length: f64) -> usize {
    if length > 0.0 && length.is_finite() { (3.0 - length.log10()).floor().clamp(0.0, 9.0) as usize } else { 3 }
}

/// The name under which a choice is typed.
pub(crate) fn name(choice: impl Serialize) -> String {
    let typed = serde_json::to_value(choice).ok();
    typed.as_ref().and_then(serde_json::Value::as_str).unwrap_or("?").replace("minus_", "-")
}

/// A length with its unit, where that is known.
pub(crate) fn length(value: f64, unit: Option<LinearUnit>) -> String {
    let unit = match unit {
        Some(LinearUnit::Metre) => " m",
        Some(LinearUnit::Foot) => " ft",
        Some(LinearUnit::UsSurveyFoot) => " US survey ft",
        _ => "",
    };
    format!("{}{unit}", significant(value, 4))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_for_people() {
        assert_eq!(count(0_u64), "0");
        assert_eq!(count(999_u64), "999");
        assert_eq!(count(1_234_567_usize), "1,234,567");
        assert_eq!(significant(0.000_123_456, 3), "0.000123");
        assert_eq!(significant(1234.5, 3), "1234");
        assert_eq!(significant(2.0, 4), "2");
        assert_eq!(significant(-0.25, 2), "-0.25");
        assert_eq!(bytes(2_500_000_000), "2.5 GB");
        assert_eq!(bytes(12), "12 bytes");
        assert_eq!(decimals_for(0.5), 3);
        assert_eq!(decimals_for(100.0), 1);
    }

    #[test]
    fn columns_line_up() {
        let rows = [vec!["a".into(), "10".into()], vec!["long".into(), "9".into()]];
        assert_eq!(columns(&rows), "a     10\nlong   9\n");
    }
}
