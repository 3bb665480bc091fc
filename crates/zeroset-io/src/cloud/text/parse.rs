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
    let simple = width == 3 && layout.position == [0, 1, 2];
    let mut tokens: Vec<&[u8]> = Vec::with_capacity(width);
    for (line, content) in piece.split(|b| *b == line_end).enumerate() {
        let content = trimmed(content);
        if content.is_empty() || is_comment(content) {
            continue;
        }
        if simple && let Some(point) = three_numbers(content) {
            block.points.push(point);
            continue;
        }
        let line = line as u64;
        tokens.clear();
        tokens.extend(Tokens::new(content).take(width));
        if tokens.len() < width {
            if convention == Convention::Pts && tokens.len() == 1 && is_count(tokens[0]) {
                block.counts.extend(parse_count(tokens[0]));
                continue;
            }
            return Err(Problem::Columns { line, found: tokens.len(), needed: width });
        }
        if has_decimal_commas(content) {
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
        let optional = |column: usize| number(column).unwrap_or(0.0) as f32;
        let [x, y, z] = layout.position;
        block.points.push([number(x)?, number(y)?, number(z)?]);
        block.colors.extend(layout.color.map(|color| color.map(optional)));
        block.intensities.extend(layout.intensity.map(optional));
        block.classes.extend(layout.class.map(optional));
    }
    Ok(block)
}

/// The quick way for the most common line: three numbers and separators. `None` if there is anything unusual.
#[inline]
fn three_numbers(mut line: &[u8]) -> Option<[f64; 3]> {
    let mut point = [0.0; 3];
    for (axis, value) in point.iter_mut().enumerate() {
        let (number, length) = fast_float2::parse_partial::<f64, _>(line).ok()?;
        *value = number;
        line = &line[length..];
        match line.first() {
            None if axis == 2 => {}
            Some(b' ' | b'\t') => line = line.trim_ascii_start(),
            _ => return None,
        }
        // A comma or semicolon here belongs to an empty field or a mixed separator: the slow way knows.
        if matches!(line.first(), Some(b',' | b';')) {
            return None;
        }
    }
    Some(point)
}

/// A line without the space around it.
pub(super) fn trimmed(line: &[u8]) -> &[u8] {
    line.trim_ascii()
}

pub(super) fn is_comment(line: &[u8]) -> bool {
    line.starts_with(b"#") || line.starts_with(b"//") || line.starts_with(b"%")
}

/// Whether the first three fields between spaces or semicolons all look like `1,5`.
fn has_decimal_commas(line: &[u8]) -> bool {
    if !line.contains(&b',') {
        return false;
    }
    let mut fields = line.split(|b| *b == b';' || b.is_ascii_whitespace()).filter(|field| !field.is_empty());
    let mut with_comma = || {
        fields.next().is_some_and(|field| {
            let digits = |part: &[u8]| !part.is_empty() && part.iter().all(u8::is_ascii_digit);
            let field = field.strip_prefix(b"-").unwrap_or(field);
            let mut parts = field.split(|b| *b == b',');
            matches!((parts.next(), parts.next(), parts.next()), (Some(a), Some(b), None) if digits(a) && digits(b))
        })
    };
    with_comma() && with_comma() && with_comma()
}

/// Fields of a line. Space around a comma or semicolon belongs to it; two of these in a row have an empty field between.
pub(super) struct Tokens<'a> {
    rest: Option<&'a [u8]>,
}

impl<'a> Tokens<'a> {
    pub(super) fn new(line: &'a [u8]) -> Self {
        let line = line.trim_ascii();
        Self { rest: (!line.is_empty()).then_some(line) }
    }
}

impl<'a> Iterator for Tokens<'a> {
    type Item = &'a [u8];

    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.rest?;
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
        let quoted = token.strip_prefix(b"\"").and_then(|token| token.strip_suffix(b"\""));
        Some(quoted.unwrap_or(token))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(line: &str) -> Vec<String> {
        Tokens::new(line.as_bytes()).map(|t| String::from_utf8_lossy(t).into_owned()).collect()
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
    fn the_quick_way_agrees_or_declines() {
        assert_eq!(three_numbers(b"1 2\t3"), Some([1.0, 2.0, 3.0]));
        assert_eq!(three_numbers(b"1  2.5e3  -3 junk"), Some([1.0, 2500.0, -3.0]));
        for line in ["1,2,3", "1 2", "1 2 x", "1 ,2 3", "1 2 3x", "1 2 3;4"] {
            assert_eq!(three_numbers(line.as_bytes()), None, "{line}");
        }
    }

    #[test]
    fn decimal_commas_are_told_from_separators() {
        assert!(has_decimal_commas(b"1,5;-2,5;3,5"));
        assert!(has_decimal_commas(b"1,5 2,5 3,5 7"));
        assert!(!has_decimal_commas(b"1,2,3"));
        assert!(!has_decimal_commas(b"1, 2, 3"));
        assert!(!has_decimal_commas(b"1.5 2.5 3.5"));
    }
}
