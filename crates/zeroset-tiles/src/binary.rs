//! Files between steps: numbers one after another, little-endian.

use std::fs::OpenOptions;
use std::io::Write;
use std::path::Path;

use zeroset_io::{IoError, write_atomically};

use crate::TilesError;

/// A number that is written as it is.
pub(crate) trait Plain: Copy {
    const SIZE: usize;
    fn put(self, to: &mut Vec<u8>);
    fn get(bytes: &[u8]) -> Self;
}

macro_rules! plain {
    ($($number:ty),*) => {$(
        impl Plain for $number {
            const SIZE: usize = size_of::<Self>();
            fn put(self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }
            fn get(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<Self>()];
                own.copy_from_slice(bytes);
                Self::from_le_bytes(own)
            }
        }
    )*};
}
plain!(u8, u32, u64, f32, f64);

impl<T: Plain, const N: usize> Plain for [T; N] {
    const SIZE: usize = N * T::SIZE;
    fn put(self, to: &mut Vec<u8>) {
        self.into_iter().for_each(|value| value.put(to));
    }
    fn get(bytes: &[u8]) -> Self {
        std::array::from_fn(|i| T::get(&bytes[i * T::SIZE..(i + 1) * T::SIZE]))
    }
}

/// What is written.
#[derive(Debug, Default)]
pub(crate) struct Out(pub(crate) Vec<u8>);

impl Out {
    pub(crate) fn value<T: Plain>(&mut self, value: T) {
        value.put(&mut self.0);
    }

    /// A list with its length before it.
    pub(crate) fn list<T: Plain>(&mut self, values: &[T]) {
        self.value(values.len() as u64);
        self.0.reserve(values.len() * T::SIZE);
        values.iter().for_each(|value| value.put(&mut self.0));
    }

    /// A list that may not be there.
    pub(crate) fn option<T: Plain>(&mut self, values: Option<&Vec<T>>) {
        self.value(u8::from(values.is_some()));
        if let Some(values) = values {
            self.list(values);
        }
    }

    /// Adds it to a file that counts for nothing until all is written.
    pub(crate) fn append(&self, path: &Path) -> Result<(), TilesError> {
        let file = OpenOptions::new().append(true).create(true).open(path);
        file.and_then(|mut file| file.write_all(&self.0)).map_err(|source| TilesError::system(path, source))
    }

    pub(crate) fn write(&self, path: &Path) -> Result<(), TilesError> {
        write_atomically(path, |writer| writer.write_all(&self.0).map_err(|e| IoError::from_system(path, e)))?;
        Ok(())
    }
}

/// What is read. Every count is held against what is there.
pub(crate) struct In<'a> {
    bytes: &'a [u8],
}

impl<'a> In<'a> {
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub(crate) fn is_at_end(&self) -> bool {
        self.bytes.is_empty()
    }

    pub(crate) fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.bytes.split_at_checked(length)?;
        self.bytes = rest;
        Some(taken)
    }

    pub(crate) fn value<T: Plain>(&mut self) -> Option<T> {
        self.take(T::SIZE).map(T::get)
    }

    pub(crate) fn list<T: Plain>(&mut self) -> Option<Vec<T>> {
        let count = usize::try_from(self.value::<u64>()?).ok()?;
        let bytes = self.take(count.checked_mul(T::SIZE)?)?;
        Some(bytes.chunks_exact(T::SIZE).map(T::get).collect())
    }

    pub(crate) fn option<T: Plain>(&mut self) -> Option<Option<Vec<T>>> {
        if self.value::<u8>()? == 0 { Some(None) } else { self.list().map(Some) }
    }
}

/// The content of a file that an earlier step wrote.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, TilesError> {
    match std::fs::read(path) {
        Ok(bytes) => Ok(bytes),
        Err(source) if source.kind() == std::io::ErrorKind::NotFound => {
            Err(TilesError::Missing { path: path.to_path_buf() })
        }
        Err(source) => Err(TilesError::system(path, source)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_come_back_and_short_ones_are_refused() {
        let mut out = Out::default();
        out.value(7_u32);
        out.list(&[[1.5_f64, -0.0], [f64::MAX, 3.0]]);
        out.option::<u8>(None);
        out.option(Some(&vec![9_u8]));
        let mut back = In::new(&out.0);
        assert_eq!(back.value::<u32>(), Some(7));
        assert_eq!(back.list::<[f64; 2]>(), Some(vec![[1.5, -0.0], [f64::MAX, 3.0]]));
        assert_eq!((back.option::<u8>(), back.option::<u8>()), (Some(None), Some(Some(vec![9]))));
        assert!(back.is_at_end());
        assert!(In::new(&out.0[4..30]).list::<[f64; 2]>().is_none());
        assert!(In::new(&[255; 8]).list::<f64>().is_none());
    }
}
