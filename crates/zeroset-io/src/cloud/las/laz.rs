//! LASzip chunks.
//!
//! Every chunk can be decompressed alone, so each is one parallel job that writes straight into the columns. All sizes
//! in the file are held against the file's true size first, because the `laz` crate allocates what they say.

use std::io::{Cursor, Seek, SeekFrom};
use std::path::Path;

use laz::las::selective::DecompressionSelection;
use laz::laszip::ChunkTable;
use laz::record::{LayeredPointRecordDecompressor, RecordDecompressor, SequentialPointRecordDecompressor};
use laz::{LazItemType, LazVlr};
use rayon::prelude::*;

use super::header::Header;
use super::points::{Record, Rows, Table};
use crate::IoError;
use crate::guard::without_panic;
use crate::input::Fields;

/// Real scans take over half a byte a point, so a file that claims more than this many points a byte lies. Without the
/// bound a few bytes that repeat one point could fill the memory.
const MOST_POINTS_PER_BYTE: u64 = 64;
/// Clouds up to this size are taken even if they are all one point.
const ALWAYS_ALLOWED: u64 = 1 << 20;

struct Chunk<'a> {
    bytes: &'a [u8],
    points: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum Scheme {
    /// One stream from the first point to the last, without a table of chunks.
    Stream,
    /// Chunks whose points are coded one after another.
    Chunked,
    /// Chunks whose fields are coded in separate layers.
    Layered,
}

pub(super) fn decompress(
    path: &Path,
    header: &Header<'_>,
    record: &Record,
    bytes: &[u8],
    table: &mut Table,
) -> Result<(), IoError> {
    let failed = |message: String| IoError::Decode { path: path.to_path_buf(), format: "LAZ", message };
    let settings = header.records.iter().find(|r| r.user == LazVlr::USER_ID && r.id == LazVlr::RECORD_ID);
    let settings = settings.ok_or_else(|| failed("the LASzip record is missing".into()))?.data;
    let vlr = without_panic(|| LazVlr::from_buffer(settings)).map_err(failed)?.map_err(|e| failed(e.to_string()))?;
    let scheme = match Fields::new(settings).u16() {
        Some(1) => Scheme::Stream,
        Some(2) => Scheme::Chunked,
        Some(3) => Scheme::Layered,
        _ => return Err(failed("its compression scheme is unknown".into())),
    };
    // The sum as the crate takes it, but without the overflow.
    let item_bytes: usize = vlr.items().iter().map(|item| usize::from(item.size())).sum();
    if vlr.items().is_empty() || item_bytes != record.length {
        return Err(failed(format!("its records have {item_bytes} bytes, the header says {}", record.length)));
    }

    let lying = |found: u64| IoError::CountMismatch {
        path: path.to_path_buf(),
        items: "points",
        declared: header.point_count,
        found,
    };
    let most = ALWAYS_ALLOWED.max(MOST_POINTS_PER_BYTE.saturating_mul(bytes.len() as u64));
    if header.point_count > most {
        return Err(lying(most));
    }
    let count = usize::try_from(header.point_count).map_err(|_| lying(most))?;

    let chunks = if scheme == Scheme::Stream {
        vec![Chunk { bytes: &bytes[header.points_at..], points: count }]
    } else {
        without_panic(|| read_chunks(path, header, &vlr, bytes, count)).map_err(failed)??
    };
    let found: u64 = chunks.iter().map(|chunk| chunk.points as u64).sum();
    if found < header.point_count {
        return Err(lying(found));
    }
    if scheme == Scheme::Layered {
        let layers = layer_count(&vlr);
        if let Some(bad) = chunks.iter().position(|chunk| !layers_fit(chunk, item_bytes, layers)) {
            return Err(failed(format!("chunk {bad} is cut short")));
        }
    }

    table.resize(count, record);
    let runs = table.split(chunks.iter().map(|chunk| chunk.points));
    // All results are looked at in order, so the message does not depend on which thread was first.
    let results: Vec<Result<(), String>> = runs
        .into_par_iter()
        .zip(chunks.par_iter())
        .map(|(rows, chunk)| {
            without_panic(|| decode_chunk(&vlr, scheme, chunk, record, rows)).and_then(|result| result)
        })
        .collect();
    results.into_iter().collect::<Result<(), String>>().map_err(failed)
}

/// Finds the chunks that hold the first `count` points.
fn read_chunks<'a>(
    path: &Path,
    header: &Header<'_>,
    vlr: &LazVlr,
    bytes: &'a [u8],
    count: usize,
) -> Result<Vec<Chunk<'a>>, IoError> {
    let failed = |message: String| IoError::Decode { path: path.to_path_buf(), format: "LAZ", message };
    let cut = || IoError::truncated(path, "table of chunks", header.points_at as u64 + 16, bytes.len() as u64);
    let first = header.points_at + 8;
    let stated = Fields::at(bytes, header.points_at).i64().ok_or_else(cut)?;
    // A writer that could not go back leaves the place at the end of the file.
    let at_end = || bytes.len().checked_sub(8).and_then(|end| Fields::at(bytes, end).i64());
    let place = [Some(stated), at_end()].into_iter().flatten().find_map(|place| {
        let place = usize::try_from(place).ok()?;
        (place >= first && place + 8 <= bytes.len()).then_some(place)
    });
    let Some(place) = place else {
        let needed = u64::try_from(stated).unwrap_or(0).saturating_add(8);
        return Err(IoError::truncated(path, "points", needed.max(first as u64), bytes.len() as u64));
    };

    // A chunk starts with a point that is not compressed: that bounds their number.
    let stated = Fields::at(bytes, place + 4).u32().ok_or_else(cut)? as usize;
    if stated > (place - first) / header.record_length {
        return Err(failed(format!("its table states {stated} chunks, more than the file has room for")));
    }
    let mut cursor = Cursor::new(bytes);
    let table = cursor
        .seek(SeekFrom::Start(place as u64))
        .and_then(|_| ChunkTable::read(&mut cursor, vlr.uses_variable_size_chunks()))
        .map_err(|e| failed(format!("its table of chunks: {e}")))?;

    let (mut chunks, mut at, mut left) = (Vec::with_capacity(stated), first, count);
    for entry in &table {
        if left == 0 {
            break;
        }
        let points = if vlr.uses_variable_size_chunks() { entry.point_count } else { u64::from(vlr.chunk_size()) };
        let points = usize::try_from(points).unwrap_or(usize::MAX).min(left);
        let end = usize::try_from(entry.byte_count).ok().and_then(|length| at.checked_add(length));
        let data = end.and_then(|end| bytes[..place].get(at..end));
        let Some(data) = data else {
            return Err(failed(format!("chunk {} reaches beyond the points", chunks.len())));
        };
        at += data.len();
        left -= points;
        if points > 0 {
            chunks.push(Chunk { bytes: data, points });
        }
    }
    Ok(chunks)
}

/// How many layers a chunk has, each with its size in front.
fn layer_count(vlr: &LazVlr) -> usize {
    let layers = |kind: LazItemType| match kind {
        // Channel and XY, Z, class, flags, intensity, angle, user data, source, time.
        LazItemType::Point14 => 9,
        LazItemType::RGBNIR14 => 2,
        LazItemType::Byte14(bytes) => usize::from(bytes),
        _ => 1,
    };
    vlr.items().iter().map(|item| layers(item.item_type())).sum()
}

/// Whether the sizes of the layers add up to no more than the chunk has.
fn layers_fit(chunk: &Chunk<'_>, record_bytes: usize, layers: usize) -> bool {
    let mut fields = Fields::at(chunk.bytes, record_bytes);
    let mut sum = || {
        fields.u32()?;
        let mut sum = 0_u64;
        for _ in 0..layers {
            sum += u64::from(fields.u32()?);
        }
        Some(sum + fields.position as u64)
    };
    sum().is_some_and(|end| end <= chunk.bytes.len() as u64)
}

fn decode_chunk(
    vlr: &LazVlr,
    scheme: Scheme,
    chunk: &Chunk<'_>,
    record: &Record,
    mut rows: Rows<'_>,
) -> Result<(), String> {
    let source = Cursor::new(chunk.bytes);
    let mut decoder: Box<dyn RecordDecompressor<_>> = match scheme {
        Scheme::Layered => Box::new(LayeredPointRecordDecompressor::new(source)),
        _ => Box::new(SequentialPointRecordDecompressor::new(source)),
    };
    decoder.set_fields_from(vlr.items()).map_err(|e| e.to_string())?;
    // Layers that nobody asks for are not even unpacked.
    decoder.set_selection(
        DecompressionSelection::xy_returns_channel()
            .decompress_z()
            .decompress_classification()
            .decompress_flags()
            .decompress_intensity()
            .decompress_rgb(),
    );
    let mut buffer = vec![0; record.length];
    for row in 0..rows.len() {
        decoder.decompress_next(&mut buffer).map_err(|e| format!("point {row} of a chunk: {e}"))?;
        rows.set(row, record, &buffer);
    }
    Ok(())
}
