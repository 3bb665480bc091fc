//! LAS 1.0 to 1.4, and LAZ.
//!
//! The header, the variable length records and the uncompressed points are read here, so that every count and offset is
//! held against the true size of the file before it is used; the `laz` crate decompresses. A cloud-optimised file
//! (COPC) is a LAZ file whose chunks have different sizes, and needs no more than that.
//!
//! A file is read from memory as a whole, or from the disk part by part: the same code does both.

mod crs;
mod header;
mod laz;
mod points;
mod write;

use std::path::Path;

use super::{CloudSize, Columns};
use crate::input::Source;
use crate::{CloudFormat, IoError};
use crs::System;
use header::Header;
use laz::Compressed;
use points::Record;
pub(crate) use points::{Table, Values};
pub(crate) use write::write;

/// Reads a file that is in memory.
pub(crate) fn read(path: &Path, format: CloudFormat, bytes: &[u8]) -> Result<Columns, IoError> {
    let mut parts = Parts::open(path, format, bytes)?;
    let mut table = Table::default();
    parts.next(usize::MAX, &mut table)?;
    let values = table.values();
    Ok(parts.columns(table, values))
}

/// A file that is read part by part, from the first point to the last.
pub(crate) struct Parts<'a, S> {
    path: &'a Path,
    source: S,
    header: Header,
    record: Record,
    layout: Layout,
    system: System,
    /// Points that are read.
    done: u64,
}

enum Layout {
    Plain,
    Compressed(Compressed),
}

impl<'a, S: Source> Parts<'a, S> {
    pub(crate) fn open(path: &'a Path, format: CloudFormat, mut source: S) -> Result<Self, IoError> {
        let header = Header::parse(path, format.name(), &mut source)?;
        if header.point_count == 0 {
            return Err(IoError::NoPoints { path: path.to_path_buf() });
        }
        let layout = if header.compressed {
            Layout::Compressed(Compressed::open(path, &header, &mut source)?)
        } else {
            let found = (source.length() - header.points_at) / header.record_length as u64;
            if found < header.point_count {
                return Err(IoError::CountMismatch {
                    path: path.to_path_buf(),
                    items: "points",
                    declared: header.point_count,
                    found,
                });
            }
            Layout::Plain
        };
        let (record, system) = (Record::of(&header), crs::find(&header.records));
        Ok(Self { path, source, header, record, layout, system, done: 0 })
    }

    /// What the header states.
    pub(crate) fn size(&self) -> CloudSize {
        CloudSize { points: self.header.point_count, bounds: self.header.bounds, unit: self.system.unit }
    }

    /// Points that are read.
    pub(crate) fn done(&self) -> u64 {
        self.done
    }

    /// Begins anew.
    pub(crate) fn rewind(&mut self) {
        self.done = 0;
        if let Layout::Compressed(compressed) = &mut self.layout {
            compressed.rewind();
        }
    }

    /// Fills the table with the next points: about as many as asked for, as chunks are read as a whole. None at the end.
    pub(crate) fn next(&mut self, points: usize, table: &mut Table) -> Result<(), IoError> {
        let Self { path, source, header, record, layout, .. } = self;
        match layout {
            Layout::Plain => {
                let count = (header.point_count - self.done).min(points as u64);
                let length = record.length as u64;
                let start = header.points_at + self.done * length;
                let data = source.get(start..start + count * length).map_err(|e| IoError::from_system(path, e))?;
                // At most as many as fit into the slice, so the count fits into usize.
                table.resize(count as usize, record);
                table.fill(record, &data);
            }
            Layout::Compressed(compressed) => compressed.next(path, record, source, points, table)?,
        }
        self.done += table.len() as u64;
        Ok(())
    }

    /// The rows with what the file tells of them.
    pub(crate) fn columns(&self, table: Table, values: Values) -> Columns {
        let mut columns = table.into_columns(values);
        columns.declared = Some(self.header.point_count);
        columns.crs.clone_from(&self.system.text);
        columns.unit = self.system.unit;
        columns.facts = self.header.facts();
        columns.notes.extend(self.system.note.clone());
        if self.header.point_format_has_rgb() && columns.attributes.colors.is_none() {
            columns.notes.push("all colours are black and were left out".into());
        }
        columns
    }
}
