//! LAS 1.0 to 1.4, and LAZ.
//!
//! The header, the variable length records and the uncompressed points are read here, so that every count and offset is
//! held against the true size of the file before it is used; the `laz` crate decompresses. A cloud-optimised file
//! (COPC) is a LAZ file whose chunks have different sizes, and needs no more than that.

mod crs;
mod header;
mod laz;
mod points;
mod write;

use std::path::Path;

use super::Columns;
use crate::{CloudFormat, IoError};
use header::Header;
use points::{Record, Table};
pub(crate) use write::encode;

pub(crate) fn read(path: &Path, format: CloudFormat, bytes: &[u8]) -> Result<Columns, IoError> {
    let header = Header::parse(path, format.name(), bytes)?;
    if header.point_count == 0 {
        return Err(IoError::NoPoints { path: path.to_path_buf() });
    }
    let record = Record::of(&header);
    let mut table = Table::default();
    if header.compressed {
        laz::decompress(path, &header, &record, bytes, &mut table)?;
    } else {
        let data = bytes.get(header.points_at..).unwrap_or_default();
        let found = (data.len() / header.record_length) as u64;
        if found < header.point_count {
            return Err(IoError::CountMismatch {
                path: path.to_path_buf(),
                items: "points",
                declared: header.point_count,
                found,
            });
        }
        // At most as many as fit into the slice, so the count fits into usize.
        let count = header.point_count as usize;
        table.resize(count, &record);
        table.fill(&record, &data[..count * header.record_length]);
    }

    let system = crs::find(&header.records);
    let mut columns = table.into_columns();
    columns.declared = Some(header.point_count);
    columns.crs = system.text;
    columns.unit = system.unit;
    columns.facts = header.facts();
    columns.notes.extend(system.note);
    if header.point_format_has_rgb() && columns.attributes.colors.is_none() {
        columns.notes.push("all colours are black and were left out".into());
    }
    Ok(columns)
}
