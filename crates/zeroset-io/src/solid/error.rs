//! Why a solid cannot be read.

use std::path::PathBuf;

use zeroset::field::FieldError;

use super::DEEPEST;
use super::files::MOST_FILES;
use crate::error::{clean, shown};
use crate::{IoError, MAX_COORDINATE};

/// Why a solid cannot be read. Every message is one line that names the expression or the file, the place, and the remedy.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SolidError {
    /// An expression cannot be understood.
    #[error("{}: character {character}: {fault}", excerpt(expression, *character))]
    Expression {
        /// The whole text.
        expression: String,
        /// The place, counted in characters from 1; at the end of the text it is one more than there are.
        character: usize,
        /// What is wrong there.
        fault: Fault,
    },
    /// A TOML tree cannot be understood.
    #[error("{}: line {line}: {fault}", shown(path))]
    Tree {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What is wrong there.
        fault: Fault,
    },
    /// A file cannot be read.
    #[error(transparent)]
    File(#[from] IoError),
    /// A mesh surrounds nothing.
    #[error("{}: {source}", shown(path))]
    Mesh {
        /// The file.
        path: PathBuf,
        /// Why.
        source: FieldError,
    },
    /// A tree of solids names itself.
    #[error("{}: a tree must not name itself; take one of these names out", chain(files))]
    Cycle {
        /// The files in the order in which each names the next; the last is one of the others.
        files: Vec<PathBuf>,
    },
    /// Files are named too often.
    #[error("{}: files are named more than {MOST_FILES} times; join some of them into one mesh", shown(path))]
    TooManyFiles {
        /// The first that is too many.
        path: PathBuf,
    },
}

/// What is wrong at a place of an expression or a TOML tree.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// Something else was expected.
    #[error("expected {expected}, found {}", clean(found))]
    Expected {
        /// What is possible here.
        expected: String,
        /// What is there.
        found: String,
    },
    /// A name that is not known.
    #[error("there is no {what} \"{}\"; possible here: {known}", clean(name))]
    Unknown {
        /// What should be named here.
        what: &'static str,
        /// The name.
        name: String,
        /// The names that are known.
        known: String,
    },
    /// A word that is neither a shape nor the name of a file that can be a solid.
    #[error(
        "\"{}\" is no shape, no operation, and no file that ends in {known}; put names that hold spaces, ; or parentheses in quotation marks",
        clean(name)
    )]
    NoOperand {
        /// The word.
        name: String,
        /// The suffixes of files that can be solids.
        known: String,
    },
    /// A quotation mark without its partner.
    #[error("this quotation mark has no partner; add one after the name of the file")]
    OpenQuotation,
    /// A number that is not finite, or too large.
    #[error("{} is too large or not finite; numbers go up to {MAX_COORDINATE:e}", clean(number))]
    OutOfRange {
        /// The number as it is written.
        number: String,
    },
    /// An angle without its unit.
    #[error("the angle {0} has no unit; write {0}deg or {0}rad", clean(number))]
    NoUnit {
        /// The number as it is written.
        number: String,
    },
    /// A shape without volume, or a length that is not positive.
    #[error(transparent)]
    Shape(#[from] FieldError),
    /// Solids in solids in solids.
    #[error("more than {DEEPEST} solids are within one another here; nest them less")]
    TooDeep,
    /// The text is no TOML.
    #[error("this is no TOML: {}; correct it", clean(message))]
    NoToml {
        /// What the parser says.
        message: String,
    },
    /// What is named here cannot be read.
    #[error(transparent)]
    Within(Box<SolidError>),
}

impl From<SolidError> for Fault {
    fn from(error: SolidError) -> Self {
        Self::Within(Box::new(error))
    }
}

/// So much of an expression as a person reads, around a character counted from 1.
fn excerpt(expression: &str, character: usize) -> String {
    const REACH: usize = 60;
    let all = expression.chars().count();
    let (from, to) = (character.saturating_sub(REACH), character.saturating_add(REACH).min(all));
    let text: String = expression.chars().take(to).skip(from).map(|c| if c.is_control() { ' ' } else { c }).collect();
    let (before, after) = (if from > 0 { "..." } else { "" }, if to < all { "..." } else { "" });
    if text.trim().is_empty() { "empty expression".into() } else { format!("{before}{text}{after}") }
}

fn chain(files: &[PathBuf]) -> String {
    files.iter().map(|file| shown(file)).collect::<Vec<_>>().join(" -> ")
}
