//! Arrays of NumPy.
//!
//! A file is a magic word, a version, the length of a header, the header, and the values. The header is a dictionary in
//! the notation of Python: `{'descr': '<f8', 'fortran_order': False, 'shape': (5, 3), }`. Only what that needs of the
//! notation is understood. Source: `numpy.lib.format`, versions 1.0 to 3.0.

use std::path::Path;

use rayon::prelude::*;

use crate::IoError;
use crate::format::sniff;
use crate::input::Fields;

const MAGIC: &[u8] = b"\x93NUMPY";
/// No sound header is longer, even of an array with many columns.
const LONGEST_HEADER: usize = 1 << 16;
/// Values start at a multiple of this.
const ALIGNMENT: usize = 64;

/// Reads an array of positions, one a row.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Vec<[f64; 3]>, IoError> {
    let (text, values) = split(path, bytes)?;
    let header = Header::parse(text).map_err(|problem| problem.at(path))?;
    let (rows, width) = header.check(path)?;
    if rows == 0 {
        return Err(IoError::NoPoints { path: path.to_path_buf() });
    }
    let stride = 3 * width;
    let found = (values.len() / stride) as u64;
    if rows > found {
        return Err(IoError::CountMismatch { path: path.to_path_buf(), items: "points", declared: rows, found });
    }
    // No more than there are, so it fits into usize.
    let (values, rest) = values.split_at(rows as usize * stride);
    if !rest.is_empty() {
        return Err(IoError::damaged(path, format!("{} bytes follow the NPY array", rest.len())));
    }
    let rows = values.par_chunks_exact(stride);
    Ok(match width {
        4 => rows.map(|row| axes(|a| f32::from_le_bytes(item(row, a)).into())).collect(),
        _ => rows.map(|row| axes(|a| f64::from_le_bytes(item(row, a)))).collect(),
    })
}

fn axes(value: impl Fn(usize) -> f64) -> [f64; 3] {
    std::array::from_fn(value)
}

/// The bytes of a value of a row that is long enough.
fn item<const N: usize>(row: &[u8], axis: usize) -> [u8; N] {
    std::array::from_fn(|i| row[N * axis + i])
}

/// The header's text and the values.
fn split<'a>(path: &Path, bytes: &'a [u8]) -> Result<(&'a [u8], &'a [u8]), IoError> {
    if !bytes.starts_with(MAGIC) && !MAGIC.starts_with(bytes) {
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "NPY", looks: sniff(bytes) });
    }
    let cut = |needed: usize| IoError::truncated(path, "header", needed as u64, bytes.len() as u64);
    let mut fields = Fields::at(bytes, MAGIC.len());
    let (major, minor) = fields.u8().zip(fields.u8()).ok_or_else(|| cut(MAGIC.len() + 4))?;
    let length = match major {
        1 => fields.u16().map(usize::from),
        2 | 3 => fields.u32().map(|length| length as usize),
        _ => {
            let feature = format!("version {major}.{minor} of NPY");
            let remedy = "save the array again with numpy.save";
            return Err(IoError::Unsupported { path: path.to_path_buf(), feature, remedy });
        }
    };
    let length = length.ok_or_else(|| cut(MAGIC.len() + 6))?;
    if length > LONGEST_HEADER {
        return Err(IoError::damaged(path, format!("the NPY header states a length of {length} bytes")));
    }
    let text = fields.take(length).ok_or_else(|| cut(fields.position + length))?;
    Ok((text, &bytes[fields.position..]))
}

/// What a header states.
#[derive(Debug, Clone, PartialEq)]
struct Header {
    kind: String,
    fortran: bool,
    shape: Vec<u64>,
}

/// Why a header cannot be used.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Problem {
    /// Its type is a list of fields.
    Structured,
    /// It is not as NumPy writes it.
    Damaged,
}

impl Problem {
    fn at(self, path: &Path) -> IoError {
        match self {
            Self::Structured => unsupported(path, "an NPY array with named fields".into(), PLAIN),
            Self::Damaged => IoError::damaged(path, "the NPY header is not one that NumPy writes"),
        }
    }
}

const PLAIN: &str = "save the positions as an array of shape (n, 3) with .astype('<f8')";

fn unsupported(path: &Path, feature: String, remedy: &'static str) -> IoError {
    IoError::Unsupported { path: path.to_path_buf(), feature, remedy }
}

impl Header {
    fn parse(text: &[u8]) -> Result<Self, Problem> {
        let (mut kind, mut fortran, mut shape) = (None, None, None);
        let mut text = Literal(text);
        text.expect(b'{')?;
        while !text.take(b'}') {
            let key = text.string()?;
            text.expect(b':')?;
            match key {
                b"descr" if text.next() == Some(b'[') => return Err(Problem::Structured),
                b"descr" => kind = Some(String::from_utf8_lossy(text.string()?).into_owned()),
                b"fortran_order" => fortran = Some(text.truth()?),
                b"shape" => shape = Some(text.counts()?),
                _ => return Err(Problem::Damaged),
            }
            if !text.take(b',') && text.next() != Some(b'}') {
                return Err(Problem::Damaged);
            }
        }
        match (kind, fortran, shape, text.next()) {
            (Some(kind), Some(fortran), Some(shape), None) => Ok(Self { kind, fortran, shape }),
            _ => Err(Problem::Damaged),
        }
    }

    /// The number of rows and the bytes of a value, if rows are positions.
    fn check(&self, path: &Path) -> Result<(u64, usize), IoError> {
        let width = match self.kind.as_str() {
            "<f4" => 4,
            "<f8" => 8,
            other => return Err(unsupported(path, format!("an NPY array of the type `{other}`"), PLAIN)),
        };
        let [rows, 3] = self.shape[..] else {
            let shape: Vec<String> = self.shape.iter().map(u64::to_string).collect();
            let what = format!("the NPY array has the shape ({}), not (n, 3)", shape.join(", "));
            return Err(IoError::malformed(path, what, "save an array with a row of x, y and z for each point"));
        };
        if self.fortran {
            let remedy = "save it with numpy.ascontiguousarray";
            return Err(unsupported(path, "an NPY array in Fortran order".into(), remedy));
        }
        Ok((rows, width))
    }
}

/// The rest of a text in the notation of Python.
struct Literal<'a>(&'a [u8]);

impl<'a> Literal<'a> {
    /// The next byte that is not space, which stays there.
    fn next(&mut self) -> Option<u8> {
        self.0 = self.0.trim_ascii_start();
        self.0.first().copied()
    }

    fn take(&mut self, byte: u8) -> bool {
        let there = self.next() == Some(byte);
        if there {
            self.0 = &self.0[1..];
        }
        there
    }

    fn expect(&mut self, byte: u8) -> Result<(), Problem> {
        if self.take(byte) { Ok(()) } else { Err(Problem::Damaged) }
    }

    /// The bytes up to the first that does not belong.
    fn run(&mut self, belongs: impl Fn(u8) -> bool) -> &'a [u8] {
        let length = self.0.iter().position(|b| !belongs(*b)).unwrap_or(self.0.len());
        let (run, rest) = self.0.split_at(length);
        self.0 = rest;
        run
    }

    fn string(&mut self) -> Result<&'a [u8], Problem> {
        let quote = self.next().filter(|quote| matches!(quote, b'\'' | b'"')).ok_or(Problem::Damaged)?;
        self.expect(quote)?;
        let text = self.run(|b| b != quote && b != b'\\');
        // Space inside the quotes is text, so the closing one must be right here.
        if self.0.first() == Some(&quote) { self.expect(quote).map(|()| text) } else { Err(Problem::Damaged) }
    }

    fn truth(&mut self) -> Result<bool, Problem> {
        self.next();
        match self.run(|b| b.is_ascii_alphabetic()) {
            b"True" => Ok(true),
            b"False" => Ok(false),
            _ => Err(Problem::Damaged),
        }
    }

    /// A tuple of counts. NumPy knows no more than 64 axes.
    fn counts(&mut self) -> Result<Vec<u64>, Problem> {
        let mut counts = Vec::new();
        self.expect(b'(')?;
        while !self.take(b')') {
            self.next();
            let digits = self.run(|b| b.is_ascii_digit());
            let count = std::str::from_utf8(digits).ok().and_then(|digits| digits.parse().ok());
            counts.push(count.ok_or(Problem::Damaged)?);
            // Old versions of Python mark long numbers.
            self.take(b'L');
            if counts.len() > 64 || !self.take(b',') && self.next() != Some(b')') {
                return Err(Problem::Damaged);
            }
        }
        Ok(counts)
    }
}

/// Everything before the values of an array of doubles in C order.
pub(super) fn header(rows: usize, columns: usize) -> Vec<u8> {
    const BEFORE: usize = MAGIC.len() + 4;
    let mut text = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, {columns}), }}");
    let length = (BEFORE + text.len() + 1).next_multiple_of(ALIGNMENT) - BEFORE;
    text.extend(std::iter::repeat_n(' ', length - 1 - text.len()));
    text.push('\n');
    // Two numbers of at most 20 digits keep the length far below what 16 bits hold.
    [MAGIC, &[1, 0], &(length as u16).to_le_bytes(), text.as_bytes()].concat()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headers_are_read_as_python_reads_them() {
        let sound = Header { kind: "<f8".into(), fortran: false, shape: vec![5, 3] };
        for text in [
            "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 3), }    \n",
            "{\"shape\":(5,3,),\"fortran_order\":False,\"descr\":\"<f8\"}",
            " { 'descr' : '<f8' , 'shape' : ( 5L , 3L ) , 'fortran_order' : False } ",
        ] {
            assert_eq!(Header::parse(text.as_bytes()).as_ref(), Ok(&sound), "{text}");
        }
        let structured = "{'descr': [('x', '<f8')], 'fortran_order': False, 'shape': (5,), }";
        assert_eq!(Header::parse(structured.as_bytes()), Err(Problem::Structured));
        for text in [
            "",
            "{",
            "{}",
            "{'descr': '<f8', 'fortran_order': False}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (-5, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (5 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999999999, 3)}",
            "{'descr': '<f8', 'fortran_order': false, 'shape': (5, 3)}",
            "{'descr': '<f8' 'fortran_order': False, 'shape': (5, 3)}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 3), 'more': 1}",
            "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 3)} more",
            "{'descr': '<f8",
        ] {
            assert_eq!(Header::parse(text.as_bytes()), Err(Problem::Damaged), "{text}");
        }
    }

    #[test]
    fn values_are_aligned() {
        for rows in [0, 1, 999, usize::MAX] {
            let header = header(rows, 8);
            assert_eq!(header.len() % ALIGNMENT, 0);
            let (text, values) = split(Path::new("a.npy"), &header).unwrap();
            assert_eq!(Header::parse(text).unwrap().shape, [rows as u64, 8]);
            assert!(values.is_empty());
        }
    }
}
