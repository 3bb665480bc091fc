//! Bytes in: whole files, and fields of fixed size out of them.
//!
//! Files are read, not mapped: a map turns a file that somebody shortens meanwhile into a fault of the process, and
//! reading costs less than a tenth of the decoding of any format here.

use std::borrow::Cow;
use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

use crate::IoError;

/// The content of a file, or of standard input for `-`. Never empty.
pub(crate) fn read_file(path: &Path) -> Result<Vec<u8>, IoError> {
    let failed = |source| IoError::from_system(path, source);
    let mut bytes = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().lock().read_to_end(&mut bytes).map_err(failed)?;
    } else {
        let mut file = File::open(path).map_err(failed)?;
        let facts = file.metadata().map_err(failed)?;
        if facts.is_dir() {
            return Err(IoError::IsDirectory { path: path.to_path_buf() });
        }
        // A device may state any size: only a regular file's is worth a reservation.
        if facts.is_file() {
            let length = usize::try_from(facts.len()).unwrap_or(0);
            bytes
                .try_reserve_exact(length.saturating_add(1))
                .map_err(|_| failed(std::io::ErrorKind::OutOfMemory.into()))?;
        }
        file.read_to_end(&mut bytes).map_err(failed)?;
    }
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    Ok(bytes)
}

/// Where bytes are taken from: all of a file in memory, or a file that is read as far as it is needed.
pub(crate) trait Source {
    /// Bytes in all.
    fn length(&self) -> u64;

    /// Some of the bytes. The range must lie within the length; what is not there after all is an error.
    fn get(&mut self, range: Range<u64>) -> std::io::Result<Cow<'_, [u8]>>;
}

impl Source for &[u8] {
    fn length(&self) -> u64 {
        self.len() as u64
    }

    fn get(&mut self, range: Range<u64>) -> std::io::Result<Cow<'_, [u8]>> {
        let place = usize::try_from(range.start).ok().zip(usize::try_from(range.end).ok());
        let bytes = place.and_then(|(start, end)| <[u8]>::get(self, start..end));
        bytes.map(Cow::Borrowed).ok_or_else(|| std::io::ErrorKind::UnexpectedEof.into())
    }
}

/// A regular file, and its length when it was opened.
#[derive(Debug)]
pub(crate) struct OpenFile {
    file: File,
    length: u64,
}

impl OpenFile {
    /// Opens a file; `None` if it is none that can be read in any order.
    pub(crate) fn open(path: &Path) -> Result<Option<Self>, IoError> {
        if path == Path::new("-") {
            return Ok(None);
        }
        let failed = |source| IoError::from_system(path, source);
        let file = File::open(path).map_err(failed)?;
        let facts = file.metadata().map_err(failed)?;
        Ok(facts.is_file().then_some(Self { file, length: facts.len() }))
    }
}

impl Source for OpenFile {
    fn length(&self) -> u64 {
        self.length
    }

    fn get(&mut self, range: Range<u64>) -> std::io::Result<Cow<'_, [u8]>> {
        let length = usize::try_from(range.end - range.start).map_err(|_| std::io::ErrorKind::OutOfMemory)?;
        let mut bytes = Vec::new();
        bytes.try_reserve_exact(length).map_err(|_| std::io::ErrorKind::OutOfMemory)?;
        bytes.resize(length, 0);
        self.file.seek(SeekFrom::Start(range.start))?;
        self.file.read_exact(&mut bytes)?;
        Ok(Cow::Owned(bytes))
    }
}

/// Reads little-endian fields one after another out of a slice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Fields<'a> {
    bytes: &'a [u8],
    pub(crate) position: usize,
}

impl<'a> Fields<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, position: 0 }
    }

    pub(crate) fn at(bytes: &'a [u8], position: usize) -> Self {
        Self { bytes, position }
    }

    pub(crate) fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let end = self.position.checked_add(length)?;
        let slice = self.bytes.get(self.position..end)?;
        self.position = end;
        Some(slice)
    }

    pub(crate) fn array<const N: usize>(&mut self) -> Option<[u8; N]> {
        self.take(N)?.try_into().ok()
    }

    pub(crate) fn u8(&mut self) -> Option<u8> {
        self.array::<1>().map(|b| b[0])
    }

    pub(crate) fn u16(&mut self) -> Option<u16> {
        self.array().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Option<u32> {
        self.array().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Option<u64> {
        self.array().map(u64::from_le_bytes)
    }

    pub(crate) fn i64(&mut self) -> Option<i64> {
        self.array().map(i64::from_le_bytes)
    }

    pub(crate) fn f32(&mut self) -> Option<f32> {
        self.array().map(f32::from_le_bytes)
    }

    pub(crate) fn f64(&mut self) -> Option<f64> {
        self.array().map(f64::from_le_bytes)
    }
}

/// Text of a field of fixed length: up to the first NUL, trimmed.
pub(crate) fn fixed_text(bytes: &[u8]) -> String {
    let end = bytes.iter().position(|b| *b == 0).unwrap_or(bytes.len());
    String::from_utf8_lossy(&bytes[..end]).trim().to_string()
}
