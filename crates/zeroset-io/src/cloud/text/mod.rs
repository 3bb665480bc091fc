//! Clouds as text, a point a line: XYZ, TXT, CSV, ASC and PTS.
//!
//! Values are separated by spaces, tabs, commas or semicolons, in any mixture. A header line names the columns if it
//! is there, with or without a comment mark (`//X Y Z R G B`); without one the first three columns are x, y and z. Where
//! the names stand between commas, semicolons or tabs, so do the values: then a field may hold spaces, or nothing.
//! Only PTS has a convention for the rest: intensity, red, green, blue. Lines that are empty or start with `#`, `//` or
//! `%` are passed over.

mod layout;
mod parse;

use std::path::Path;

use rayon::prelude::*;
use zeroset::cloud::Attributes;

use super::Columns;
use super::columns::{class_from_value, colors_from_values};
use crate::IoError;
use crate::format::sniff;
pub(crate) use layout::Convention;
use layout::{Layout, Prelude};
use parse::{Block, Problem, parse_block};
pub(crate) use parse::{Tokens, has_decimal_commas, is_comment};

/// Text is cut into pieces of about this size, whatever the number of threads: the result cannot depend on it.
const PIECE: usize = 1 << 20;

pub(crate) fn read(path: &Path, bytes: &[u8], convention: Convention) -> Result<Columns, IoError> {
    let name = if convention == Convention::Pts { "PTS text" } else { "XYZ text" };
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    if [b"\xFF\xFE", b"\xFE\xFF"].iter().any(|mark| text.starts_with(*mark)) {
        return Err(IoError::malformed(path, "the text is UTF-16", "save it as UTF-8"));
    }
    if text.iter().take(4096).any(|b| *b == 0) {
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: name, looks: sniff(bytes) });
    }
    // Files of old systems end lines with CR alone; with any LF about, a CR is just space at the end of a line.
    let line_end = if text.contains(&b'\n') || !text.contains(&b'\r') { b'\n' } else { b'\r' };

    let Prelude { layout, skip, lines, declared, crs, notes } = Prelude::scan(path, text, line_end, convention)?;
    let pieces = cut(&text[skip..], line_end);
    let blocks: Vec<Result<Block, Problem>> =
        pieces.par_iter().map(|piece| parse_block(piece, line_end, &layout, convention)).collect();

    // Only at the first bad line is its number of interest, so lines are counted here.
    let mut before = lines;
    let mut parsed = Vec::with_capacity(blocks.len());
    for (block, piece) in blocks.into_iter().zip(&pieces) {
        match block {
            Ok(block) => parsed.push(block),
            Err(problem) => return Err(problem.into_error(path, before, text, name)),
        }
        before += piece.iter().filter(|b| **b == line_end).count() as u64;
    }

    let declared = parsed
        .iter()
        .flat_map(|block| &block.counts)
        .fold(declared, |sum, count| Some(sum.unwrap_or(0).saturating_add(*count)));
    let columns = join(parsed, &layout);
    let found = columns.points.len() as u64;
    if let Some(declared) = declared.filter(|declared| *declared > found) {
        return Err(IoError::CountMismatch { path: path.to_path_buf(), items: "points", declared, found });
    }
    Ok(Columns { declared, crs, notes, ..columns })
}

/// Pieces of whole lines.
fn cut(text: &[u8], line_end: u8) -> Vec<&[u8]> {
    let (mut pieces, mut rest) = (Vec::new(), text);
    while rest.len() > PIECE {
        let end = rest[PIECE..].iter().position(|b| *b == line_end).map_or(rest.len(), |at| PIECE + at + 1);
        let (piece, after) = rest.split_at(end);
        pieces.push(piece);
        rest = after;
    }
    pieces.push(rest);
    pieces
}

fn join(blocks: Vec<Block>, layout: &Layout) -> Columns {
    let count = blocks.iter().map(|block| block.points.len()).sum();
    let mut points = Vec::with_capacity(count);
    let mut colors = layout.color.map(|_| Vec::with_capacity(count));
    let mut intensities = layout.intensity.map(|_| Vec::with_capacity(count));
    let mut classes = layout.class.map(|_| Vec::with_capacity(count));
    for block in blocks {
        points.extend_from_slice(&block.points);
        if let Some(colors) = &mut colors {
            colors.extend_from_slice(&block.colors);
        }
        if let Some(intensities) = &mut intensities {
            intensities.extend_from_slice(&block.intensities);
        }
        if let Some(classes) = &mut classes {
            classes.extend(block.classes.iter().map(|class| class_from_value(f64::from(*class))));
        }
    }
    let colors = colors.map(|colors| colors_from_values(&colors));
    Columns { points, attributes: Attributes { colors, intensities, classes }, ..Columns::default() }
}
