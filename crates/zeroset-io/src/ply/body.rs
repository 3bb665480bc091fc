//! The records of a PLY file, one element after another.

use std::path::Path;

use super::header::{Element, Encoding, Header, Property, Scalar};
use crate::IoError;

/// Takes lists of whole numbers.
pub(crate) trait ListSink {
    fn item(&mut self, value: i64);
    fn end(&mut self);
}

/// Walks through the body. Whatever the counts claim, no more is touched than the file holds.
pub(crate) struct Body<'a> {
    path: &'a Path,
    bytes: &'a [u8],
    encoding: Encoding,
    position: usize,
}

impl<'a> Body<'a> {
    pub(crate) fn new(path: &'a Path, bytes: &'a [u8], header: &Header) -> Self {
        Self { path, bytes, encoding: header.encoding, position: header.length }
    }

    /// The count of an element as a number of records that the rest of the file has room for.
    ///
    /// A record of no bytes (no properties) is never worth anything: its count becomes zero.
    pub(crate) fn checked_count(&self, element: &Element, items: &'static str) -> Result<usize, IoError> {
        let least = element.least_bytes(self.encoding);
        if least == 0 {
            return Ok(0);
        }
        let room = (self.bytes.len() - self.position) as u64;
        // The last value of a text file needs no separator.
        let found = (room + u64::from(self.encoding == Encoding::Ascii)) / least;
        if element.count > found {
            return Err(self.short(items, element.count, found));
        }
        usize::try_from(element.count).map_err(|_| self.short(items, element.count, found))
    }

    /// The bytes of all records of an element without lists.
    pub(crate) fn records(&mut self, stride: usize, count: usize, items: &'static str) -> Result<&'a [u8], IoError> {
        let end = stride.checked_mul(count).and_then(|length| self.position.checked_add(length));
        let slice = end.and_then(|end| self.bytes.get(self.position..end));
        let Some(slice) = slice else {
            let room = (self.bytes.len() - self.position) as u64;
            return Err(self.short(items, count as u64, room / stride.max(1) as u64));
        };
        self.position += slice.len();
        Ok(slice)
    }

    /// Passes over an element.
    pub(crate) fn skip(&mut self, element: &Element) -> Result<(), IoError> {
        let count = self.checked_count(element, "records")?;
        match element.stride() {
            Some(stride) if self.encoding != Encoding::Ascii => self.records(stride, count, "records").map(drop),
            _ => {
                let mut values = Vec::new();
                for i in 0..count {
                    self.record(element, i, "records", &mut values, &mut |_, _| {})?;
                }
                Ok(())
            }
        }
    }

    /// Reads one record: single values go to `values` by property (zero for lists), list items to `list` with the
    /// index of their property.
    pub(crate) fn record(
        &mut self,
        element: &Element,
        index: usize,
        items: &'static str,
        values: &mut Vec<f64>,
        list: &mut dyn FnMut(usize, f64),
    ) -> Result<(), IoError> {
        values.clear();
        for (i, property) in element.properties.iter().enumerate() {
            let missing = |body: &Self| body.short(items, element.count, index as u64);
            match property {
                Property::Single { kind, .. } => {
                    let value = self.value(*kind)?.ok_or_else(|| missing(self))?;
                    values.push(value);
                }
                Property::List { count, item, .. } => {
                    values.push(0.0);
                    let length = self.value(*count)?.ok_or_else(|| missing(self))?;
                    if !(length >= 0.0 && length.fract() == 0.0) {
                        let what = format!("a list of {items} {index} has {length} entries");
                        return Err(IoError::damaged(self.path, what));
                    }
                    // The loop ends with the file, so a length that lies costs nothing.
                    for _ in 0..length as u64 {
                        let value = self.value(*item)?.ok_or_else(|| missing(self))?;
                        list(i, value);
                    }
                }
            }
        }
        Ok(())
    }

    /// The common form of faces, binary lists of 32 bit numbers counted by a byte, without a detour through f64.
    ///
    /// `item` gets every number, `end` is called after each list. Returns whether the element has this form at all.
    pub(crate) fn byte_counted_lists(
        &mut self,
        element: &Element,
        count: usize,
        items: &'static str,
        list: &mut impl ListSink,
    ) -> Result<bool, IoError> {
        let [Property::List { count: Scalar::U8, item: item @ (Scalar::I32 | Scalar::U32), .. }] =
            element.properties.as_slice()
        else {
            return Ok(false);
        };
        if self.encoding == Encoding::Ascii {
            return Ok(false);
        }
        for i in 0..count {
            let rest = &self.bytes[self.position..];
            let length = rest.first().map_or(0, |length| 4 * usize::from(*length));
            let numbers = rest.get(1..=length).ok_or_else(|| self.short(items, element.count, i as u64))?;
            for number in numbers.chunks_exact(4) {
                let mut bytes = [number[0], number[1], number[2], number[3]];
                if self.encoding == Encoding::Big {
                    bytes.reverse();
                }
                list.item(match item {
                    Scalar::I32 => i64::from(i32::from_le_bytes(bytes)),
                    _ => i64::from(u32::from_le_bytes(bytes)),
                });
            }
            list.end();
            self.position += 1 + length;
        }
        Ok(true)
    }

    /// The next value; `None` at the end of the file.
    fn value(&mut self, kind: Scalar) -> Result<Option<f64>, IoError> {
        if self.encoding == Encoding::Ascii {
            let Some(token) = self.token() else { return Ok(None) };
            let value = fast_float2::parse::<f64, _>(token);
            return value.map(Some).map_err(|_| {
                let text = String::from_utf8_lossy(token);
                IoError::damaged(self.path, format!("`{text}` at byte {} is not a number", self.position - token.len()))
            });
        }
        let Some(bytes) = self.bytes.get(self.position..self.position + kind.size()) else { return Ok(None) };
        self.position += kind.size();
        Ok(Some(kind.decode(bytes, self.encoding)))
    }

    /// Refuses text that goes on after the last element: then lines have more values than the header says, and all
    /// that was read may be out of step.
    pub(crate) fn end(&mut self) -> Result<(), IoError> {
        if self.encoding == Encoding::Ascii && self.token().is_some() {
            return Err(IoError::damaged(self.path, "the PLY text has more values than its header says"));
        }
        Ok(())
    }

    fn token(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.position..)?;
        let start = rest.iter().position(|b| !b.is_ascii_whitespace())?;
        let rest = &rest[start..];
        let length = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.position += start + length;
        Some(&rest[..length])
    }

    fn short(&self, items: &'static str, declared: u64, found: u64) -> IoError {
        IoError::CountMismatch { path: self.path.to_path_buf(), items, declared, found }
    }
}
