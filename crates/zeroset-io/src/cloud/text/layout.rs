//! What the columns of a text file mean.

use std::path::Path;

use super::parse::{Problem, Tokens, is_comment, trimmed};
use crate::IoError;

/// How columns without names are understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Convention {
    /// x, y, z; further columns are passed over.
    Plain,
    /// A line with the number of points, then x, y, z and intensity, or colours, or both.
    Pts,
}

/// Index of the column of each value.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Layout {
    pub(super) position: [usize; 3],
    pub(super) color: Option<[usize; 3]>,
    pub(super) intensity: Option<usize>,
    pub(super) class: Option<usize>,
    /// The only byte between fields, where the header tells; then fields may hold spaces, or nothing.
    pub(super) separator: Option<u8>,
}

/// A header line: the names of all columns, and what stands between them if that is not just space.
#[derive(Debug)]
struct Names {
    names: Vec<String>,
    separator: Option<u8>,
}

impl Names {
    fn of(line: &[u8]) -> Self {
        let doubled_tabs = line.windows(2).any(|pair| pair == b"\t\t");
        let separator = [b',', b';', b'\t'].into_iter().find(|mark| line.contains(mark));
        let separator = separator.filter(|mark| *mark != b'\t' || !doubled_tabs);
        let mut names: Vec<String> = Tokens::new(line, separator).take(MOST_COLUMNS).map(name_of).collect();
        if separator.is_none() {
            // What stands in brackets after a space is a unit, not a column.
            names.retain(|name| !name.is_empty());
        }
        Self { names, separator }
    }

    fn layout(&self) -> Option<Layout> {
        Some(Layout { separator: self.separator, ..Layout::from_names(&self.names)? })
    }
}

impl Layout {
    /// By names, if they tell where x, y and z are. Of several names for one thing the first in the list wins: a column
    /// `n` beside `y` is a number of something.
    fn from_names(names: &[String]) -> Option<Self> {
        let find = |wanted: &[&str]| wanted.iter().find_map(|wanted| names.iter().position(|name| name == wanted));
        let three = |x: &[&str], y: &[&str], z: &[&str]| Some([find(x)?, find(y)?, find(z)?]);
        let position = three(
            &["x", "easting", "east", "e"],
            &["y", "northing", "north", "n"],
            &["z", "height", "elevation", "altitude", "h"],
        )?;
        Some(Self {
            position,
            color: three(&["red", "r"], &["green", "g"], &["blue", "b"]),
            intensity: find(&["intensity", "scalar_intensity", "i", "reflectance", "scalar_reflectance"]),
            class: find(&["classification", "scalar_classification", "class", "label"]),
            separator: None,
        })
    }

    fn by_convention(convention: Convention, columns: usize) -> Self {
        let plain = Self { position: [0, 1, 2], color: None, intensity: None, class: None, separator: None };
        match (convention, columns) {
            (Convention::Pts, 4 | 5) => Self { intensity: Some(3), ..plain },
            (Convention::Pts, 6) => Self { color: Some([3, 4, 5]), ..plain },
            (Convention::Pts, 7..) => Self { intensity: Some(3), color: Some([4, 5, 6]), ..plain },
            _ => plain,
        }
    }

    /// This, if the fields of a line are split as the header's are; else with any separators.
    fn split_as(self, line: &[u8]) -> Self {
        let separator = self.separator.filter(|mark| line.contains(mark));
        Self { separator, ..self }
    }

    /// Whether a line has numbers where the position is.
    fn is_point(&self, line: &[u8]) -> bool {
        let tokens: Vec<&[u8]> = Tokens::new(line, self.separator).take(MOST_COLUMNS).collect();
        self.position.iter().all(|at| tokens.get(*at).is_some_and(|token| is_number(token)))
    }

    /// How many columns a line must have.
    pub(super) fn width(&self) -> usize {
        let all = self.position.iter().chain(self.color.iter().flatten()).chain(&self.intensity).chain(&self.class);
        all.max().map_or(0, |last| last + 1)
    }
}

/// Everything before the first point.
#[derive(Debug)]
pub(super) struct Prelude {
    pub(super) layout: Layout,
    /// Bytes before the first point's line.
    pub(super) skip: usize,
    /// Lines before it.
    pub(super) lines: u64,
    /// The count that a PTS file starts with.
    pub(super) declared: Option<u64>,
    /// From a comment `crs ...`, as the writer here leaves it.
    pub(super) crs: Option<String>,
    pub(super) notes: Vec<String>,
}

/// Lines of words at the start that may belong to a header; after more than this the file is something else.
const MOST_HEADER_LINES: u64 = 64;
/// Columns beyond this have no names.
const MOST_COLUMNS: usize = 256;

impl Prelude {
    pub(super) fn scan(path: &Path, text: &[u8], line_end: u8, convention: Convention) -> Result<Self, IoError> {
        let (mut skip, mut lines, mut declared, mut crs, mut notes) = (0, 0, None, None, Vec::new());
        let (mut named, mut words): (Option<Layout>, u64) = (None, 0);
        let mut first_words = None;
        while skip < text.len() {
            let rest = &text[skip..];
            let end = rest.iter().position(|b| *b == line_end);
            let whole = &rest[..end.unwrap_or(rest.len())];
            let line = trimmed(whole);
            let tokens: Vec<&[u8]> = Tokens::new(line, None).take(MOST_COLUMNS).collect();
            let layout = named.clone().map(|layout| layout.split_as(whole));
            if line.is_empty() || is_comment(line) {
                // A comment that names the columns is a header all the same.
                let comment = uncommented(line);
                if let Some(text) = comment.strip_prefix(b"crs ") {
                    crs = crs.or_else(|| Some(String::from_utf8_lossy(text).trim().to_string()));
                }
                named = Names::of(comment).layout().or(named);
            } else if tokens.len() == 1 && declared.is_none() && is_count(tokens[0]) {
                declared = parse_count(tokens[0]);
                if convention == Convention::Plain {
                    notes.push(format!("line {} holds one number, taken as the count of points", lines + 1));
                }
            } else if starts_like_point(&tokens) || layout.as_ref().is_some_and(|layout| layout.is_point(whole)) {
                let by_convention = Layout::by_convention(convention, tokens.len());
                let columns =
                    layout.as_ref().map_or(tokens.len(), |layout| Tokens::new(whole, layout.separator).count());
                let unnamed = layout.is_none().then_some(first_words).flatten().map(|(line, _)| line);
                let layout = layout.unwrap_or(by_convention);
                let prelude = Self { layout, skip, lines, declared, crs, notes };
                return prelude.at_first_point(path, columns, named.is_some(), unnamed, convention);
            } else {
                // Words: a header, or no text of points at all.
                words += 1;
                first_words = first_words.or(Some((lines + 1, line)));
                named = Names::of(whole).layout().or(named);
                if words > MOST_HEADER_LINES {
                    break;
                }
            }
            skip += end.map_or(rest.len(), |end| end + 1);
            lines += 1;
        }
        if declared.is_some_and(|declared| declared > 0) && words == 0 {
            let (path, declared) = (path.to_path_buf(), declared.unwrap_or(0));
            return Err(IoError::CountMismatch { path, items: "points", declared, found: 0 });
        }
        match first_words {
            // Names of columns and nothing else: a sound file without points.
            Some((line, words)) if named.is_none() => {
                let shown = String::from_utf8_lossy(&words[..words.len().min(40)]).into_owned();
                Err(IoError::malformed(
                    path,
                    format!("no line with x y z was found; line {line} reads `{shown}`"),
                    "give it the suffix of its true format, or write one point a line as x y z",
                ))
            }
            _ => Err(IoError::NoPoints { path: path.to_path_buf() }),
        }
    }

    /// The last checks, at a point of `columns` fields; `unnamed` is a line of words before it that names no x, y and z.
    fn at_first_point(
        mut self,
        path: &Path,
        columns: usize,
        named: bool,
        unnamed: Option<u64>,
        convention: Convention,
    ) -> Result<Self, IoError> {
        let needed = self.layout.width().max(3);
        if columns < needed {
            return Err(Problem::Columns { line: 0, found: columns, needed }.at(path, self.lines));
        }
        if !named && convention == Convention::Plain && columns > 3 {
            self.notes.push(match unnamed {
                Some(line) => format!(
                    "line {line} names no x, y and z, so the first three of {columns} columns were taken; a header line \
                     such as `id x y z` tells"
                ),
                None => format!(
                    "{} columns after x y z were passed over; a header line such as `x y z red green blue` names them",
                    columns - 3
                ),
            });
        }
        Ok(self)
    }
}

/// A line of a point starts with a number; a decimal comma is a number too, and is told apart later.
fn starts_like_point(tokens: &[&[u8]]) -> bool {
    tokens.first().is_some_and(|token| is_number(token))
}

fn is_number(token: &[u8]) -> bool {
    fast_float2::parse::<f64, _>(token).is_ok()
}

/// A number of points: digits, perhaps with a sign, so that -1 is seen as the nonsense that it is.
pub(super) fn is_count(token: &[u8]) -> bool {
    let digits = token.strip_prefix(b"-").unwrap_or(token);
    !digits.is_empty() && digits.iter().all(u8::is_ascii_digit)
}

/// A count that is too large or negative is one that no file can meet.
pub(super) fn parse_count(token: &[u8]) -> Option<u64> {
    Some(std::str::from_utf8(token).ok()?.parse().unwrap_or(u64::MAX))
}

fn uncommented(line: &[u8]) -> &[u8] {
    trimmed(
        line.trim_ascii_start()
            .strip_prefix(b"//")
            .unwrap_or_else(|| line.strip_prefix(b"#").or_else(|| line.strip_prefix(b"%")).unwrap_or(line)),
    )
}

/// A name in lower case, without quotes and without a unit in brackets.
fn name_of(token: &[u8]) -> String {
    let text = String::from_utf8_lossy(token).to_ascii_lowercase();
    let text = text.trim_matches(['"', '\'']);
    text.split(['(', '[']).next().unwrap_or_default().trim().to_string()
}
