//! What can go wrong between a file and memory.

use std::fmt;
use std::path::{Path, PathBuf};

/// Why a file could not be read or written.
///
/// Every message is one line that names the file and ends with what to do about it. Names of files and texts of
/// libraries are cleaned of control characters first, so that neither can break the line.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum IoError {
    /// The file does not exist.
    #[error("{}: no such file; check the path", shown(path))]
    NotFound {
        /// The file.
        path: PathBuf,
    },
    /// The system refused access.
    #[error("{}: permission denied; change the permissions or choose another file", shown(path))]
    PermissionDenied {
        /// The file.
        path: PathBuf,
    },
    /// A file was expected, a directory was given.
    #[error("{}: is a directory; name a file in it", shown(path))]
    IsDirectory {
        /// The directory.
        path: PathBuf,
    },
    /// The suffix of the name stands for no format that is known here.
    #[error("{}: unknown {kind} format{}; use one of: {known}", shown(path), suffix_text(suffix))]
    UnknownSuffix {
        /// The file.
        path: PathBuf,
        /// "cloud", "mesh" and so on.
        kind: &'static str,
        /// The suffix found, without its dot, if there is any.
        suffix: Option<String>,
        /// The suffixes that are known.
        known: String,
    },
    /// The format can be read but not written, or the reverse.
    #[error("{}: {format} cannot be {action} here; {remedy}", shown(path))]
    NotOffered {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// "read" or "written".
        action: &'static str,
        /// What to use instead.
        remedy: &'static str,
    },
    /// The file holds no bytes.
    #[error("{}: {}", shown(path), empty(path))]
    Empty {
        /// The file.
        path: PathBuf,
    },
    /// The content is not of the format that the suffix promises.
    #[error("{}: this is not a {expected} file{}; {}", shown(path), looks_like(*looks), rename(path))]
    WrongMagic {
        /// The file.
        path: PathBuf,
        /// The format that the suffix stands for.
        expected: &'static str,
        /// The format that the content looks like.
        looks: Option<&'static str>,
    },
    /// The file ends too early.
    #[error(
        "{}: the file is cut short in its {place}: {needed} bytes needed, {found} there; copy or download it again",
        shown(path)
    )]
    Truncated {
        /// The file.
        path: PathBuf,
        /// The part in which the end came: "header", "points" and so on.
        place: &'static str,
        /// Bytes that the part takes.
        needed: u64,
        /// Bytes that are there.
        found: u64,
    },
    /// The file states more items than it holds.
    #[error(
        "{}: the header promises {declared} {items} but the file has {found}; it is cut short or damaged, copy or export it again",
        shown(path)
    )]
    CountMismatch {
        /// The file.
        path: PathBuf,
        /// What is counted: "points", "vertices" and so on.
        items: &'static str,
        /// The count stated.
        declared: u64,
        /// How many there are, or how many the file's size has room for.
        found: u64,
    },
    /// A part of the file does not make sense.
    #[error("{}: {}; {remedy}", shown(path), clean(what))]
    Malformed {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        what: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The file uses a part of its format that is not supported.
    #[error("{}: {} is not supported; {remedy}", shown(path), clean(feature))]
    Unsupported {
        /// The file.
        path: PathBuf,
        /// The part in question.
        feature: String,
        /// What to do about it.
        remedy: &'static str,
    },
    /// The file is sound but holds no point.
    #[error("{}: the file holds no points; check the program that wrote it", shown(path))]
    NoPoints {
        /// The file.
        path: PathBuf,
    },
    /// Not one point has usable coordinates.
    #[error(
        "{}: none of the {points} points has finite coordinates (all are NaN or infinite); export the cloud without invalid points",
        shown(path)
    )]
    NoFinitePoints {
        /// The file.
        path: PathBuf,
        /// Points read.
        points: u64,
    },
    /// Every point is marked as deleted.
    #[error("{}: all {points} points are marked as withheld; clear the flag to use them", shown(path))]
    AllWithheld {
        /// The file.
        path: PathBuf,
        /// Points read.
        points: u64,
    },
    /// A coordinate is beyond [`MAX_COORDINATE`](crate::MAX_COORDINATE).
    #[error(
        "{}: coordinate {value:e} of {item} {index} is too large (limit {limit:e}); remove the point, or shift or scale the data",
        shown(path)
    )]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// "point" or "vertex".
        item: &'static str,
        /// Number of the point, from 0.
        index: u64,
        /// The coordinate.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// A vertex or point to be written or read has a coordinate that is NaN or infinite.
    #[error("{}: {item} {index} has a coordinate that is NaN or infinite; remove it first", shown(path))]
    NonFinite {
        /// The file.
        path: PathBuf,
        /// "point" or "vertex".
        item: &'static str,
        /// Number of the point, from 0.
        index: u64,
    },
    /// A face names a vertex that does not exist.
    #[error("{}: face {face} uses vertex {vertex} of {vertices}; repair or export the mesh again", shown(path))]
    BadIndex {
        /// The file.
        path: PathBuf,
        /// Number of the face, from 0.
        face: u64,
        /// The vertex it names, from 0.
        vertex: i64,
        /// How many vertices there are.
        vertices: u64,
    },
    /// A list of values has another length than the points that it belongs to.
    #[error("{}: {values} {attribute} for {points} points; give one for each point or none", shown(path))]
    AttributeLength {
        /// The file.
        path: PathBuf,
        /// Name of the attribute.
        attribute: &'static str,
        /// Values given.
        values: usize,
        /// Points or vertices given.
        points: usize,
    },
    /// A line or polygon cannot be a constraint.
    #[error("{}: {item} {index} {source}", shown(path))]
    Constraint {
        /// The file.
        path: PathBuf,
        /// What it is in the file.
        item: &'static str,
        /// Its number there.
        index: u64,
        /// Why.
        source: zeroset::constraint::ConstraintError,
    },
    /// A list of files to read is empty.
    #[error("no input file was given; name at least one point cloud")]
    NoInput,
    /// The folder to write to does not exist.
    #[error("{}: the folder {} does not exist; create it first", shown(path), shown(folder))]
    FolderMissing {
        /// The file.
        path: PathBuf,
        /// The folder.
        folder: PathBuf,
    },
    /// No space is left for the output.
    #[error("{}: the disk is full; free some space or write elsewhere", shown(path))]
    DiskFull {
        /// The file.
        path: PathBuf,
    },
    /// A library that decodes the format gave up.
    #[error("{}: {format} data cannot be decoded: {}; copy or export the file again", shown(path), clean(message))]
    Decode {
        /// The file.
        path: PathBuf,
        /// Name of the format.
        format: &'static str,
        /// What the library says.
        message: String,
    },
    /// Any other failure of the operating system.
    #[error("{}: {}; check the disk and the connection to it", shown(path), clean(&source.to_string()))]
    System {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: std::io::Error,
    },
}

impl IoError {
    /// Puts an error of the operating system into its place.
    #[must_use]
    pub fn from_system(path: &Path, source: std::io::Error) -> Self {
        use std::io::ErrorKind;
        let path = path.to_path_buf();
        match source.kind() {
            ErrorKind::NotFound => Self::NotFound { path },
            ErrorKind::PermissionDenied | ErrorKind::ReadOnlyFilesystem => Self::PermissionDenied { path },
            ErrorKind::IsADirectory => Self::IsDirectory { path },
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => Self::DiskFull { path },
            _ => Self::System { path, source },
        }
    }

    /// Whether the reader at the other end of a pipe has gone, which a command treats as a quiet end.
    #[must_use]
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::System { source, .. } if source.kind() == std::io::ErrorKind::BrokenPipe)
    }

    pub(crate) fn malformed(path: &Path, what: impl Into<String>, remedy: &'static str) -> Self {
        Self::Malformed { path: path.to_path_buf(), what: what.into(), remedy }
    }

    pub(crate) fn damaged(path: &Path, what: impl Into<String>) -> Self {
        Self::malformed(path, what, "copy or export the file again")
    }

    pub(crate) fn truncated(path: &Path, place: &'static str, needed: u64, found: u64) -> Self {
        Self::Truncated { path: path.to_path_buf(), place, needed, found }
    }
}

/// A path as one line of text without control characters; `-` is shown as what it stands for among inputs.
#[must_use]
pub fn shown(path: &Path) -> String {
    if is_stream(path) { "standard input".into() } else { clean(&path.display().to_string()) }
}

fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

fn empty(path: &Path) -> &'static str {
    if is_stream(path) {
        "nothing came in; check the command in front of the pipe"
    } else {
        "the file is empty; check that it was written or copied completely"
    }
}

/// What to do about content of another format than the name says.
fn rename(path: &Path) -> &'static str {
    if is_stream(path) {
        "pipe in lines of x y z, or name the file instead"
    } else {
        "give it the suffix of its true format"
    }
}

/// A text without control characters, and cut to a length that a person reads.
pub(crate) fn clean(text: &str) -> String {
    const LONGEST: usize = 400;
    let mut out: String =
        text.trim().chars().take(LONGEST).map(|c| if c.is_control() { '\u{FFFD}' } else { c }).collect();
    if text.chars().nth(LONGEST).is_some() {
        out.push_str("...");
    }
    out
}

fn suffix_text(suffix: &Option<String>) -> impl fmt::Display {
    match suffix {
        Some(suffix) => format!(" `.{}`", clean(suffix)),
        None => " (the name has no suffix)".into(),
    }
}

fn looks_like(looks: Option<&'static str>) -> String {
    looks.map_or_else(String::new, |format| format!(" (it looks like {format})"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hostile_name_cannot_break_the_line() {
        let error = IoError::NotFound { path: PathBuf::from("a\nb\r\u{1b}[31m.ply") };
        let text = error.to_string();
        assert_eq!(text.lines().count(), 1);
        assert!(!text.contains('\u{1b}'));
    }

    #[test]
    fn long_library_texts_are_cut() {
        let error = IoError::Decode { path: PathBuf::from("a.laz"), format: "LAZ", message: "x".repeat(10_000) };
        assert!(error.to_string().len() < 600);
    }
}
