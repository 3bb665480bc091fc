//! What the text formats have in common.

use std::path::Path;

use crate::IoError;

/// A value of a line, with the number of the line for messages.
pub(crate) fn number(path: &Path, line: u64, token: Option<&[u8]>) -> Result<f64, IoError> {
    let Some(token) = token else {
        return Err(IoError::damaged(path, format!("line {line} ends before its last value")));
    };
    fast_float2::parse(token).map_err(|_| not_a_number(path, line, token))
}

/// A whole number of a line.
pub(crate) fn integer(path: &Path, line: u64, token: Option<&[u8]>) -> Result<i64, IoError> {
    let Some(token) = token else {
        return Err(IoError::damaged(path, format!("line {line} ends before its last value")));
    };
    let parsed = std::str::from_utf8(token).ok().and_then(|text| text.parse().ok());
    parsed.ok_or_else(|| not_a_number(path, line, token))
}

fn not_a_number(path: &Path, line: u64, token: &[u8]) -> IoError {
    let text = String::from_utf8_lossy(&token[..token.len().min(30)]).into_owned();
    IoError::malformed(path, format!("line {line}: `{text}` is not a number"), "correct the line or export again")
}

/// Lines with their numbers from 1, ended by LF, CR LF or CR.
pub(crate) fn lines(bytes: &[u8]) -> impl Iterator<Item = (u64, &[u8])> {
    let end = if bytes.contains(&b'\n') || !bytes.contains(&b'\r') { b'\n' } else { b'\r' };
    (1..).zip(bytes.split(move |b| *b == end)).map(|(number, line)| (number, line.trim_ascii()))
}

/// Values of a line.
pub(crate) fn tokens(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    line.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty())
}
