//! Named arrays behind a header.

use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

use rayon::prelude::*;

use super::header::{Entry, Header};
use crate::IoError;
use crate::input::Fields;

/// The first bytes. The line ends show whether a transfer took the file for text.
const MAGIC: [u8; 8] = *b"\x89ZSET\r\n\x1a";
/// The version that is written, and the only one that is read.
const VERSION: u32 = 1;
/// Bytes before the header.
const PREFIX: usize = 24;
/// Arrays begin at multiples of this.
const ALIGNMENT: usize = 64;

/// An entry of an array: a number, little-endian and named as NumPy does, or a row of entries.
pub(super) trait Item: Copy + Send + Sync {
    const DTYPE: &'static str;
    const SIZE: usize;
    /// The shape of an entry.
    fn shape() -> Vec<usize>;
    fn from_bytes(bytes: &[u8]) -> Self;
    fn append(self, to: &mut Vec<u8>);
}

macro_rules! number {
    ($type:ty, $dtype:literal) => {
        impl Item for $type {
            const DTYPE: &'static str = $dtype;
            const SIZE: usize = size_of::<$type>();
            fn shape() -> Vec<usize> {
                Vec::new()
            }
            fn from_bytes(bytes: &[u8]) -> Self {
                let mut own = [0; size_of::<$type>()];
                own.copy_from_slice(bytes);
                <$type>::from_le_bytes(own)
            }
            fn append(self, to: &mut Vec<u8>) {
                to.extend_from_slice(&self.to_le_bytes());
            }
        }
    };
}

number!(u8, "|u1");
number!(u32, "<u4");
number!(i32, "<i4");
number!(u64, "<u8");
number!(f32, "<f4");
number!(f64, "<f8");

impl<T: Item, const N: usize> Item for [T; N] {
    const DTYPE: &'static str = T::DTYPE;
    const SIZE: usize = N * T::SIZE;
    fn shape() -> Vec<usize> {
        [vec![N], T::shape()].concat()
    }
    fn from_bytes(bytes: &[u8]) -> Self {
        std::array::from_fn(|i| T::from_bytes(&bytes[i * T::SIZE..(i + 1) * T::SIZE]))
    }
    fn append(self, to: &mut Vec<u8>) {
        self.into_iter().for_each(|item| item.append(to));
    }
}

/// Collects arrays.
#[derive(Debug, Default)]
pub(super) struct Writer {
    arrays: BTreeMap<String, (Entry, Vec<u8>)>,
}

impl Writer {
    /// Adds an array.
    pub(super) fn add<T: Item>(&mut self, name: String, values: &[T]) {
        let mut bytes = Vec::with_capacity(values.len() * T::SIZE);
        values.iter().for_each(|&value| value.append(&mut bytes));
        let shape = [vec![values.len()], T::shape()].concat();
        let entry = Entry { dtype: T::DTYPE.to_owned(), shape, offset: 0, crc32: crc32fast::hash(&bytes) };
        self.arrays.insert(name, (entry, bytes));
    }

    /// Writes the header, to which it adds the list of arrays, and all arrays.
    pub(super) fn write(mut self, header: Header, sink: &mut (impl Write + ?Sized)) -> io::Result<()> {
        let mut offset = 0;
        for (entry, bytes) in self.arrays.values_mut() {
            entry.offset = offset;
            offset += bytes.len().next_multiple_of(ALIGNMENT);
        }
        let arrays = self.arrays.iter().map(|(name, (entry, _))| (name.clone(), entry.clone())).collect();
        let mut text = serde_json::to_vec(&Header { arrays, ..header })?;
        let length = (PREFIX + text.len()).next_multiple_of(ALIGNMENT) - PREFIX;
        text.resize(length, b' ');
        sink.write_all(&MAGIC)?;
        sink.write_all(&VERSION.to_le_bytes())?;
        sink.write_all(&crc32fast::hash(&text).to_le_bytes())?;
        sink.write_all(&(length as u64).to_le_bytes())?;
        sink.write_all(&text)?;
        for (_, bytes) in self.arrays.values() {
            sink.write_all(bytes)?;
            sink.write_all(&[0; ALIGNMENT][..bytes.len().next_multiple_of(ALIGNMENT) - bytes.len()])?;
        }
        Ok(())
    }
}

/// The arrays of a file.
#[derive(Debug)]
pub(super) struct Reader<'a> {
    arrays: BTreeMap<String, Entry>,
    data: &'a [u8],
}

/// Looks at the header of a file.
pub(super) fn open<'a>(path: &Path, bytes: &'a [u8]) -> Result<(Header, Reader<'a>), IoError> {
    let mut fields = Fields::new(bytes);
    let magic: Option<[u8; 8]> = fields.array();
    if magic != Some(MAGIC) {
        let found = bytes.len().min(MAGIC.len());
        if bytes[..found] == MAGIC[..found] {
            return Err(IoError::truncated(path, "header", PREFIX as u64, bytes.len() as u64));
        }
        let looks = crate::format::sniff(bytes);
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "ZSET", looks });
    }
    let prefix = (|| Some((fields.u32()?, fields.u32()?, fields.u64()?)))();
    let Some((version, sum, length)) = prefix else {
        return Err(IoError::truncated(path, "header", PREFIX as u64, bytes.len() as u64));
    };
    if version != VERSION {
        return Err(IoError::Unsupported {
            path: path.to_path_buf(),
            feature: format!("version {version} of the format"),
            remedy: "it is of another version of zeroset; use that, or make the model again",
        });
    }
    let rest = &bytes[PREFIX..];
    let Some(text) = usize::try_from(length).ok().and_then(|length| rest.get(..length)) else {
        return Err(IoError::truncated(path, "header", length.saturating_add(PREFIX as u64), bytes.len() as u64));
    };
    if crc32fast::hash(text) != sum {
        return Err(IoError::damaged(path, "the checksum of its header does not fit"));
    }
    let mut header: Header =
        serde_json::from_slice(text).map_err(|error| IoError::damaged(path, format!("its header: {error}")))?;
    let reader = Reader { arrays: std::mem::take(&mut header.arrays), data: &rest[text.len()..] };
    reader.check(path)?;
    Ok((header, reader))
}

impl<'a> Reader<'a> {
    /// Holds every array against the size of the file, and its checksum.
    ///
    /// Arrays do not overlap, so that all of them together are no larger than the file.
    fn check(&self, path: &Path) -> Result<(), IoError> {
        let mut places = Vec::with_capacity(self.arrays.len());
        for (name, entry) in &self.arrays {
            let end =
                entry.bytes().and_then(|size| entry.offset.checked_add(size)?.checked_next_multiple_of(ALIGNMENT));
            let Some(end) = end.filter(|_| entry.offset.is_multiple_of(ALIGNMENT)) else {
                let what = format!("the type, size or place of its array {name} is not possible");
                return Err(IoError::damaged(path, what));
            };
            places.push((entry.offset, end));
        }
        places.sort_unstable();
        if places.windows(2).any(|pair| pair[0].1 > pair[1].0) {
            return Err(IoError::damaged(path, "its arrays overlap"));
        }
        let (needed, found) = (places.last().map_or(0, |place| place.1), self.data.len());
        if needed > found {
            return Err(IoError::truncated(path, "arrays", needed as u64, found as u64));
        }
        if needed < found {
            return Err(IoError::damaged(path, format!("{} bytes follow its last array", found - needed)));
        }
        let wrong = self.arrays.par_iter().find_map_first(|(name, entry)| {
            let own = &self.data[entry.offset..entry.offset + entry.bytes()?];
            (crc32fast::hash(own) != entry.crc32).then_some(name)
        });
        wrong.map_or(Ok(()), |name| {
            Err(IoError::damaged(path, format!("the checksum of its array {name} does not fit")))
        })
    }

    /// An array; `None` if there is none of that name.
    pub(super) fn optional<T: Item>(&self, name: &str) -> Result<Option<Vec<T>>, String> {
        let Some(entry) = self.arrays.get(name) else { return Ok(None) };
        if entry.dtype != T::DTYPE || entry.shape.get(1..) != Some(&T::shape()) {
            return Err(format!("its array {name} is of type {} and shape {:?}", entry.dtype, entry.shape));
        }
        let size = entry.bytes().unwrap_or(0);
        let own = &self.data[entry.offset..entry.offset + size];
        Ok(Some(own.par_chunks_exact(T::SIZE).with_min_len((1 << 16) / T::SIZE).map(T::from_bytes).collect()))
    }

    /// The same for an array that must be there.
    pub(super) fn array<T: Item>(&self, name: &str) -> Result<Vec<T>, String> {
        self.optional(name)?.ok_or_else(|| format!("it has no array {name}"))
    }
}

impl Entry {
    /// The size of the array in bytes; `None` if that is beyond all bounds, or the type not known.
    fn bytes(&self) -> Option<usize> {
        let size = match self.dtype.as_str() {
            u8::DTYPE => 1,
            u32::DTYPE | i32::DTYPE | f32::DTYPE => 4,
            u64::DTYPE | f64::DTYPE => 8,
            _ => return None,
        };
        self.shape.iter().try_fold(size, |all, &count: &usize| count.checked_mul(all))
    }
}
