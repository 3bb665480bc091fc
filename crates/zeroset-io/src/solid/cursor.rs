//! Where the reading of an expression stands, and its smallest parts.

use std::path::PathBuf;

use super::Fault;
use crate::MAX_COORDINATE;

/// What is wrong, and at which byte.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) at: usize,
    pub(super) fault: Fault,
}

pub(super) type Parsed<T> = Result<T, Failure>;

/// A place in a text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Cursor<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Cursor<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, at: 0 }
    }

    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    /// The next character that is no space; the cursor goes there.
    pub(super) fn peek(&mut self) -> Option<char> {
        self.at = self.text.len() - self.rest().trim_start().len();
        self.rest().chars().next()
    }

    /// The byte of the next character that is no space.
    pub(super) fn place(&mut self) -> usize {
        self.peek();
        self.at
    }

    /// Goes past a character if it is the next.
    pub(super) fn take(&mut self, wanted: char) -> bool {
        let found = self.peek() == Some(wanted);
        if found {
            self.at += wanted.len_utf8();
        }
        found
    }

    /// Goes past a character that must be the next; `and` tells what comes after it.
    pub(super) fn expect(&mut self, wanted: char, and: &str) -> Parsed<()> {
        if self.take(wanted) {
            return Ok(());
        }
        let and = if and.is_empty() { String::new() } else { format!(" and {and}") };
        Err(self.expected(format!("\"{wanted}\"{and}")))
    }

    /// The failure of something else being here.
    pub(super) fn expected(&mut self, expected: impl Into<String>) -> Failure {
        let found = match self.peek() {
            None => "the end".into(),
            Some(first) => {
                let word = run(self.rest(), is_part);
                format!("\"{}\"", if word.is_empty() { first.to_string() } else { word.chars().take(40).collect() })
            }
        };
        Failure { at: self.at, fault: Fault::Expected { expected: expected.into(), found } }
    }

    /// The next name, of letters, digits and `_`; empty if there is none.
    pub(super) fn name(&mut self) -> &'a str {
        self.peek();
        let name = run(self.rest(), |c| c.is_ascii_alphanumeric() || c == '_');
        if name.starts_with(|c: char| c.is_ascii_digit()) {
            return "";
        }
        self.at += name.len();
        name
    }

    /// The name of a call, and the cursor after its `(`; neither if none comes next.
    pub(super) fn call(&mut self) -> Option<&'a str> {
        let mut ahead = *self;
        let name = ahead.name();
        let found = !name.is_empty() && ahead.take('(');
        if found {
            *self = ahead;
        }
        found.then_some(name)
    }

    /// A number.
    pub(super) fn number(&mut self, what: &str) -> Parsed<f64> {
        let at = self.place();
        let word = run(self.rest(), is_part);
        match decimal(word) {
            Some(value) => {
                self.at += word.len();
                in_range(value, word).map_err(|fault| Failure { at, fault })
            }
            None => Err(self.expected(what)),
        }
    }

    /// Three numbers with commas between them.
    pub(super) fn position(&mut self) -> Parsed<[f64; 3]> {
        let x = self.number("a coordinate")?;
        self.expect(',', "a second coordinate")?;
        let y = self.number("a second coordinate")?;
        self.expect(',', "a third coordinate")?;
        Ok([x, y, self.number("a third coordinate")?])
    }

    /// An angle in radians.
    pub(super) fn angle(&mut self) -> Parsed<f64> {
        let at = self.place();
        let word = run(self.rest(), is_part);
        if decimal(word).is_some() {
            return Err(Failure { at, fault: Fault::NoUnit { number: word.chars().take(40).collect() } });
        }
        let degrees = word.strip_suffix("deg").and_then(decimal).map(f64::to_radians);
        match degrees.or_else(|| word.strip_suffix("rad").and_then(decimal)) {
            Some(value) => {
                self.at += word.len();
                in_range(value, word).map_err(|fault| Failure { at, fault })
            }
            None => Err(self.expected("an angle such as 30deg or 0.5rad")),
        }
    }

    /// The name of a file, in quotation marks or up to a space, `;` or a parenthesis.
    pub(super) fn file(&mut self) -> Parsed<PathBuf> {
        let at = self.place();
        let name = if self.take('"') {
            let end = self.rest().find('"').ok_or(Failure { at, fault: Fault::OpenQuotation })?;
            let name = &self.rest()[..end];
            self.at += end + 1;
            name
        } else {
            let name = run(self.rest(), |c| !c.is_whitespace() && !matches!(c, ';' | '(' | ')'));
            self.at += name.len();
            name
        };
        if name.is_empty() {
            self.at = at;
            return Err(self.expected("the name of a file"));
        }
        Ok(PathBuf::from(name))
    }
}

/// The characters at the start of a text that are of one kind.
fn run(text: &str, is_one: impl Fn(char) -> bool) -> &str {
    &text[..text.find(|c| !is_one(c)).unwrap_or(text.len())]
}

/// Whether a character can belong to a number or a name.
fn is_part(c: char) -> bool {
    !c.is_whitespace() && !matches!(c, ',' | ';' | '(' | ')' | '"')
}

fn decimal(word: &str) -> Option<f64> {
    fast_float2::parse(word).ok()
}

/// Refuses numbers beyond the largest coordinate; `word` is how it is written.
pub(super) fn in_range(value: f64, word: &str) -> Result<f64, Fault> {
    // Not a number compares as false.
    if value.abs() <= MAX_COORDINATE { Ok(value) } else { Err(Fault::OutOfRange { number: word.into() }) }
}
