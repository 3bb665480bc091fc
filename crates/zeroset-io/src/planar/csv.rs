//! Points in the plane as text, a point a line.

use std::path::Path;

use super::json::weighted;
use super::{PlanarData, WeightedPoint, in_range};
use crate::IoError;
use crate::cloud::text::{Tokens, has_decimal_commas, is_comment};
use crate::format::sniff;

/// Columns beyond this are not looked at.
const MOST_COLUMNS: usize = 256;

/// Index of the column of each value.
#[derive(Debug, Clone, Copy)]
struct Layout {
    position: [usize; 2],
    weight: Option<usize>,
    /// Columns that a line must have.
    width: usize,
}

impl Layout {
    fn from_names(line: &[u8]) -> Option<Self> {
        let names: Vec<String> = Tokens::new(line, None)
            .take(MOST_COLUMNS)
            .map(|name| String::from_utf8_lossy(name).trim().to_ascii_lowercase())
            .collect();
        let find = |wanted: &[&str]| wanted.iter().find_map(|wanted| names.iter().position(|name| name == wanted));
        let position = [find(&["x", "easting", "east"])?, find(&["y", "northing", "north"])?];
        let weight = find(&["weight", "w"]);
        let width = position.into_iter().chain(weight).max().map_or(0, |last| last + 1);
        Some(Self { position, weight, width })
    }

    /// Of a first point without names above it.
    fn by_count(columns: usize) -> Option<Self> {
        let weight = (columns == 3).then_some(2);
        (2..=3).contains(&columns).then_some(Self { position: [0, 1], weight, width: columns })
    }
}

pub(super) fn read(path: &Path, text: &[u8]) -> Result<PlanarData, IoError> {
    if text.iter().take(4096).any(|b| *b == 0) {
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "CSV text", looks: sniff(text) });
    }
    let line_end = if text.contains(&b'\n') || !text.contains(&b'\r') { b'\n' } else { b'\r' };
    let mut layout = None;
    let mut points = Vec::new();
    for (number, line) in (1_u64..).zip(text.split(|b| *b == line_end)) {
        let line = line.trim_ascii();
        if line.is_empty() || is_comment(line) {
            continue;
        }
        let tokens: Vec<&[u8]> = Tokens::new(line, None).take(MOST_COLUMNS).collect();
        let known = match layout {
            Some(layout) => layout,
            None => {
                let is_header = tokens.iter().all(|token| fast_float2::parse::<f64, _>(token).is_err());
                let found = if is_header { Layout::from_names(line) } else { Layout::by_count(tokens.len()) };
                let found = found.ok_or_else(|| no_layout(path, text, number, line, is_header, tokens.len()))?;
                layout = Some(found);
                if is_header {
                    continue;
                }
                found
            }
        };
        points.push(point(path, number, line, &tokens, known, points.len())?);
    }
    if points.is_empty() {
        return Err(IoError::NoPoints { path: path.to_path_buf() });
    }
    Ok(PlanarData { points, ..PlanarData::default() })
}

/// Why the first line tells no columns.
fn no_layout(path: &Path, text: &[u8], number: u64, line: &[u8], is_header: bool, columns: usize) -> IoError {
    if let (Some(looks), true) = (sniff(text), is_header) {
        return IoError::WrongMagic { path: path.to_path_buf(), expected: "CSV text", looks: Some(looks) };
    }
    if has_decimal_commas(line, 2) {
        return decimal_commas(path, number);
    }
    if is_header {
        let shown = String::from_utf8_lossy(&line[..line.len().min(40)]).into_owned();
        let what = format!("line {number} is neither a point nor names of columns with x and y: `{shown}`");
        return IoError::malformed(path, what, "write x, y and perhaps a weight on each line");
    }
    let what = format!("line {number} has {columns} columns, and none above it names them");
    IoError::malformed(path, what, "write x, y and perhaps a weight, or a line of names such as `id,x,y` on top")
}

fn decimal_commas(path: &Path, number: u64) -> IoError {
    IoError::malformed(path, format!("line {number} has decimal commas"), "write numbers with a decimal point")
}

fn point(
    path: &Path,
    number: u64,
    line: &[u8],
    tokens: &[&[u8]],
    layout: Layout,
    index: usize,
) -> Result<WeightedPoint, IoError> {
    if has_decimal_commas(line, 2) {
        return Err(decimal_commas(path, number));
    }
    if tokens.len() < layout.width {
        let what = format!("line {number} has {} columns, {} are needed", tokens.len(), layout.width);
        return Err(IoError::malformed(path, what, "the file may be cut short: copy it again, or remove the line"));
    }
    let value = |column: usize| {
        let token = tokens[column];
        fast_float2::parse::<f64, _>(token).map_err(|_| {
            let shown = String::from_utf8_lossy(&token[..token.len().min(30)]).into_owned();
            let what = format!("line {number}, column {}: `{shown}` is not a number", column + 1);
            IoError::malformed(path, what, "correct or remove the line")
        })
    };
    let position = [value(layout.position[0])?, value(layout.position[1])?];
    in_range(path, "point", index, &position)?;
    let weight = layout.weight.map_or(Ok(1.0), value)?;
    weighted(path, index, position, weight)
}
