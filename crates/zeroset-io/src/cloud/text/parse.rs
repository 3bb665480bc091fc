//! Lines of numbers.

use std::path::Path;

use super::layout::{Convention, Layout, is_count, parse_count};
use crate::IoError;
use crate::format::sniff;

/// The values of some whole lines.
#[derive(Debug, Default)]
pub(super) struct Block {
    pub(super) points: Vec<[f64; 3]>,
    pub(super) colors: Vec<[f32; 3]>,
    pub(super) intensities: Vec<f32>,
    pub(super) classes: Vec<f32>,
    /// Counts in front of further scans of a PTS file.
    pub(super) counts: Vec<u64>,
}

/// Why a line cannot be read; lines count from 0 at the start of the block.
#[derive(Debug)]
pub(super) enum Problem {
    Columns { line: u64, found: usize, needed: usize },
    Number { line: u64, column: usize, text: String },
    DecimalComma { line: u64 },
}

impl Problem {
    pub(super) fn at(self, path: &Path, before: u64) -> IoError {
        match self {
            Self::Columns { line, found, needed } => IoError::malformed(
                path,
                format!("line {} has {found} columns, {needed} are needed", before + line + 1),
                "the file may be cut short: copy it again, or remove the line",
            ),
            Self::Number { line, column, text } => IoError::malformed(
                path,
                format!("line {}, column {}: `{text}` is not a number", before + line + 1, column + 1),
                "correct or remove the line",
            ),
            Self::DecimalComma { line } => IoError::malformed(
                path,
                format!("line {} has decimal commas", before + line + 1),
                "write numbers with a decimal point",
            ),
        }
    }

    /// A first line that does not parse in a file that looks like another format is best explained by that.
    pub(super) fn into_error(self, path: &Path, before: u64, text: &[u8], expected: &'static str) -> IoError {
        match sniff(text) {
            Some(looks) if before < 2 => IoError::WrongMagic { path: path.to_path_buf(), expected, looks: Some(looks) },
            _ => self.at(path, before),
        }
    }
}

pub(super) fn parse_block(
    piece: &[u8],
    line_end: u8,
    layout: &Layout,
    convention: Convention,
) -> Result<Block, Problem> {
    // A line of three numbers of two digits each is about the shortest that real files have.
    const SHORT_LINE: usize = 16;
    let mut block = Block { points: Vec::with_capacity(piece.len() / SHORT_LINE), ..Block::default() };
    let width = layout.width();
    let mut tokens: Vec<&[u8]> = Vec::with_capacity(width);
    let mut values = vec![0.0; width];
    for (line, whole) in piece.split(|b| *b == line_end).enumerate() {
        let content = trimmed(whole);
        if content.is_empty() || is_comment(content) {
            continue;
        }
        if layout.separator != Some(b'\t') && plain_numbers(content, &mut values) {
            block.push(layout, &values);
            continue;
        }
        let line = line as u64;
        tokens.clear();
        tokens.extend(Tokens::new(whole, layout.separator).take(width));
        if tokens.len() < width {
            if convention == Convention::Pts && tokens.len() == 1 && is_count(tokens[0]) {
                block.counts.extend(parse_count(tokens[0]));
                continue;
            }
            return Err(Problem::Columns { line, found: tokens.len(), needed: width });
        }
        if has_decimal_commas(content, 3) {
            return Err(Problem::DecimalComma { line });
        }
        let number = |column: usize| {
            let token = tokens[column];
            fast_float2::parse::<f64, _>(token).map_err(|_| Problem::Number {
                line,
                column,
                text: String::from_utf8_lossy(&token[..token.len().min(30)]).into_owned(),
            })
        };
        // Beside the position an empty field or a word is only a missing value.
        for (column, value) in values.iter_mut().enumerate() {
            *value = if layout.position.contains(&column) { number(column)? } else { number(column).unwrap_or(0.0) };
        }
        block.push(layout, &values);
    }
    Ok(block)
}

impl Block {
    #[inline]
    fn push(&mut self, layout: &Layout, values: &[f64]) {
        self.points.push(layout.position.map(|at| values[at]));
        self.colors.extend(layout.color.map(|color| color.map(|at| values[at] as f32)));
        self.intensities.extend(layout.intensity.map(|at| values[at] as f32));
        self.classes.extend(layout.class.map(|at| values[at] as f32));
    }
}

/// The quick way for the most common lines: numbers with one kind of separator. `false` if there is anything unusual.
#[inline]
fn plain_numbers(mut line: &[u8], values: &mut [f64]) -> bool {
    let last = values.len() - 1;
    let mut separator = None;
    for (i, value) in values.iter_mut().enumerate() {
        let Ok((number, length)) = fast_float2::parse_partial::<f64, _>(line) else { return false };
        *value = number;
        line = &line[length..];
        let found = match line.first() {
            None => return i == last,
            Some(b' ' | b'\t') => {
                line = line.trim_ascii_start();
                b' '
            }
            Some(mark @ (b',' | b';')) => {
                line = &line[1..];
                *mark
            }
            Some(_) => return false,
        };
        // Two kinds may mean a decimal comma, and two in a row an empty field: the slow way knows.
        let double = matches!(line.first(), Some(b',' | b';' | b' ' | b'\t'));
        if double || separator.is_some_and(|separator| separator != found) {
            return false;
        }
        separator = Some(found);
    }
    true
}

/// A line without the space around it.
pub(super) fn trimmed(line: &[u8]) -> &[u8] {
    line.trim_ascii()
}

pub(crate) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//") || line.starts_with(b"%")
}

/// Whether the first fields between spaces or semicolons, as many as there are coordinates, are numbers, one of them at least like `1,5`.
pub(crate) fn has_decimal_commas(line: &[u8], coordinates: usize) -> bool {
    if !line.contains(&b',') {
        return false;
    }
    let mut fields = line.split(|b| *b == b';' || b.is_ascii_whitespace()).filter(|field| !field.is_empty());
    let mut commas = 0;
    for _ in 0..coordinates {
        let Some(field) = fields.next() else { return false };
        let field = field.strip_prefix(b"-").unwrap_or(field);
        let mut parts = field.split(|b| *b == b',');
        if !parts.all(|part| !part.is_empty() && part.iter().all(u8::is_ascii_digit)) {
            return false;
        }
        match field.iter().filter(|b| **b == b',').count() {
            0 => {}
            1 => commas += 1,
            _ => return false,
        }
    }
    commas > 0
}

/// Fields of a line.
///
/// With one separator, that alone stands between fields, unless it is quoted. Without, it is space, commas or semicolons
/// in any mixture: space around a comma or semicolon belongs to it, and two of these in a row have an empty field between.
pub(crate) struct Tokens<'a> {
    rest: Option<&'a [u8]>,
    separator: Option<u8>,
}

impl<'a> Tokens<'a> {
    pub(crate) fn new(line: &'a [u8], separator: Option<u8>) -> Self {
        // A tab at the start has an empty field before it.
        let line = if separator == Some(b'\t') { line } else { line.trim_ascii() };
        Self { rest: (!line.is_empty()).then_some(line), separator }
    }

    /// The next field up to the only separator.
    fn split(&mut self, rest: &'a [u8], separator: u8) -> &'a [u8] {
        let start = rest.len() - rest.trim_ascii_start().len();
        let quoted = rest[start..].strip_prefix(b"\"").and_then(|inside| inside.iter().position(|b| *b == b'"'));
        let from = quoted.map_or(0, |length| start + length + 2);
        let end = rest[from..].iter().position(|b| *b == separator).map(|at| from + at);
        self.rest = end.map(|end| &rest[end + 1..]);
        rest[..end.unwrap_or(rest.len())].trim_ascii()
    }
}

fn unquoted(token: &[u8]) -> &[u8] {
    token.strip_prefix(b"\"").and_then(|token| token.strip_suffix(b"\"")).unwrap_or(token)
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
        if let Some(separator) = self.separator {
            return Some(unquoted(self.split(rest, separator)));
        }
        let separator = |b: &u8| matches!(b, b' ' | b'\t' | b',' | b';' | b'\r');
        let length = rest.iter().position(separator).unwrap_or(rest.len());
        let (token, after) = rest.split_at(length);
        let after = after.trim_ascii_start();
        self.rest = match after.split_first() {
            None => None,
            Some((b',' | b';', more)) => Some(more.trim_ascii_start()),
            Some(_) => Some(after),
        };
        // A separator at the end of the line ends it; it does not open another field.
        if self.rest.is_some_and(<[u8]>::is_empty) {
            self.rest = None;
        }
        Some(unquoted(token))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(line: &str) -> Vec<String> {
        Tokens::new(line.as_bytes(), None).map(|t| String::from_utf8_lossy(t).into_owned()).collect()
    }

    #[test]
    fn any_mixture_of_separators() {
        for line in ["1 2 3", "1,2,3", "1;2;3", "1\t2\t3", " 1 , 2 ;\t3 \r", "1, 2, 3,", "\"1\",\"2\",\"3\""] {
            assert_eq!(tokens(line), ["1", "2", "3"], "{line}");
        }
        assert_eq!(tokens("1,,3"), ["1", "", "3"]);
        assert_eq!(tokens(",2"), ["", "2"]);
        assert!(tokens("   ").is_empty());
    }

    #[test]
    fn one_separator_alone() {
        let strict = |line: &str, separator| -> Vec<String> {
            let tokens = Tokens::new(line.as_bytes(), Some(separator));
            tokens.map(|t| String::from_utf8_lossy(t).into_owned()).collect()
        };
        assert_eq!(strict("New York, 1 ,2020-01-01 12:00,", b','), ["New York", "1", "2020-01-01 12:00", ""]);
        assert_eq!(strict(",1,,\"a, b\",3", b','), ["", "1", "", "a, b", "3"]);
        assert_eq!(strict("\t1\t\t3", b'\t'), ["", "1", "", "3"]);
        assert_eq!(strict("\"open,1", b','), ["\"open", "1"]);
        assert_eq!(strict("\"a\"b,1", b','), ["\"a\"b", "1"]);
    }

    #[test]
    fn the_quick_way_agrees_or_declines() {
        let quick = |line: &str| {
            let mut values = [0.0; 3];
            plain_numbers(line.as_bytes(), &mut values).then_some(values)
        };
        assert_eq!(quick("1 2\t3"), Some([1.0, 2.0, 3.0]));
        assert_eq!(quick("1  2.5e3  -3 junk"), Some([1.0, 2500.0, -3.0]));
        assert_eq!(quick("1,2,3"), Some([1.0, 2.0, 3.0]));
        assert_eq!(quick("1;2;3;x"), Some([1.0, 2.0, 3.0]));
        for line in ["1, 2, 3", "1 2", "1 2 x", "1 ,2 3", "1 2 3x", "1 2 3;4", "1,5 2,5 3,5", "1,5;2,5;3,5", "1,,3"] {
            assert_eq!(quick(line), None, "{line}");
        }
    }

    #[test]
    fn decimal_commas_are_told_from_separators() {
        assert!(has_decimal_commas(b"1,5;-2,5;3,5", 3));
        assert!(has_decimal_commas(b"1,5 2,5 3,5 7", 3));
        // Whole numbers among them.
        assert!(has_decimal_commas(b"100 200,25 3", 3));
        assert!(has_decimal_commas(b"-100,5;200;3", 3));
        assert!(!has_decimal_commas(b"1,2,3", 3));
        assert!(!has_decimal_commas(b"1, 2, 3", 3));
        assert!(!has_decimal_commas(b"1,2 3", 3));
        assert!(!has_decimal_commas(b"1,2,3 4 5", 3));
        assert!(!has_decimal_commas(b"1.5 2.5 3.5", 3));
        assert!(has_decimal_commas(b"1,5;2,5", 2));
        assert!(!has_decimal_commas(b"1,5", 2));
    }
}
