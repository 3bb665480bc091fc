//! LASzip chunks.
//!
//! Every chunk can be decompressed alone, so each is one parallel job that writes straight into the columns. All sizes
//! in the file are held against the file's true size first, because the `laz` crate allocates what they say.

use std::io::Cursor;
use std::ops::Range;
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
use crate::input::{Fields, Source};

/// Real scans take over half a byte a point, so a file that claims more than this many points a byte lies. Without the
/// bound a few bytes that repeat one point could fill the memory.
const MOST_POINTS_PER_BYTE: u64 = 64;
/// Clouds up to this size are taken even if they are all one point.
const ALWAYS_ALLOWED: u64 = 1 << 20;
/// Two numbers of 32 bits, coded, take at most that.
const MOST_BYTES_PER_ENTRY: u64 = 32;

struct Chunk {
    bytes: Range<u64>,
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

/// The compressed points of a file.
pub(super) struct Compressed {
    vlr: LazVlr,
    scheme: Scheme,
    chunks: Vec<Chunk>,
    /// Chunks that are read.
    done: usize,
}

impl Compressed {
    pub(super) fn open(path: &Path, header: &Header, source: &mut dyn Source) -> Result<Self, IoError> {
        let failed = |message: String| undecodable(path, message);
        let settings = header.records.iter().find(|r| r.user == LazVlr::USER_ID && r.id == LazVlr::RECORD_ID);
        let settings = &settings.ok_or_else(|| failed("the LASzip record is missing".into()))?.data[..];
        let vlr =
            without_panic(|| LazVlr::from_buffer(settings)).map_err(failed)?.map_err(|e| failed(e.to_string()))?;
        let scheme = match Fields::new(settings).u16() {
            Some(1) => Scheme::Stream,
            Some(2) => Scheme::Chunked,
            Some(3) => Scheme::Layered,
            _ => return Err(failed("its compression scheme is unknown".into())),
        };
        // The sum as the crate takes it, but without the overflow.
        let item_bytes: usize = vlr.items().iter().map(|item| usize::from(item.size())).sum();
        if vlr.items().is_empty() || item_bytes != header.record_length {
            return Err(failed(format!(
                "its records have {item_bytes} bytes, the header says {}",
                header.record_length
            )));
        }

        let lying = |found: u64| IoError::CountMismatch {
            path: path.to_path_buf(),
            items: "points",
            declared: header.point_count,
            found,
        };
        let most = ALWAYS_ALLOWED.max(MOST_POINTS_PER_BYTE.saturating_mul(source.length()));
        if header.point_count > most {
            return Err(lying(most));
        }
        let count = usize::try_from(header.point_count).map_err(|_| lying(most))?;
        let chunks = if scheme == Scheme::Stream {
            vec![Chunk { bytes: header.points_at..source.length(), points: count }]
        } else {
            find_chunks(path, header, &vlr, source, count)?
        };
        let found: u64 = chunks.iter().map(|chunk| chunk.points as u64).sum();
        if found < header.point_count {
            return Err(lying(found));
        }
        Ok(Self { vlr, scheme, chunks, done: 0 })
    }

    pub(super) fn rewind(&mut self) {
        self.done = 0;
    }

    /// Decompresses whole chunks with at least so many points, or all that are left.
    pub(super) fn next(
        &mut self,
        path: &Path,
        record: &Record,
        source: &mut dyn Source,
        points: usize,
        table: &mut Table,
    ) -> Result<(), IoError> {
        let failed = |message: String| undecodable(path, message);
        let left = &self.chunks[self.done..];
        let (mut count, mut taken) = (0, 0);
        while let Some(chunk) = left.get(taken).filter(|_| count < points) {
            count += chunk.points;
            taken += 1;
        }
        let chunks = &left[..taken];
        let place = match chunks {
            [first, .., last] => first.bytes.start..last.bytes.end,
            [only] => only.bytes.clone(),
            [] => 0..0,
        };
        let start = place.start;
        let bytes = source.get(place).map_err(|e| IoError::from_system(path, e))?;
        // Chunks lie one after another, so their places in what was read fit into usize.
        let data = |chunk: &Chunk| &bytes[(chunk.bytes.start - start) as usize..(chunk.bytes.end - start) as usize];
        if self.scheme == Scheme::Layered {
            let layers = layer_count(&self.vlr);
            if let Some(bad) = chunks.iter().position(|chunk| !layers_fit(data(chunk), record.length, layers)) {
                return Err(failed(format!("chunk {} is cut short", self.done + bad)));
            }
        }
        table.resize(count, record);
        let runs = table.split(chunks.iter().map(|chunk| chunk.points));
        // All results are looked at in order, so the message does not depend on which thread was first.
        let results: Vec<Result<(), String>> = runs
            .into_par_iter()
            .zip(chunks.par_iter())
            .map(|(rows, chunk)| {
                let decode = || decode_chunk(&self.vlr, self.scheme, data(chunk), record, rows);
                without_panic(decode).and_then(|result| result)
            })
            .collect();
        results.into_iter().collect::<Result<(), String>>().map_err(failed)?;
        self.done += taken;
        Ok(())
    }
}

fn undecodable(path: &Path, message: String) -> IoError {
    IoError::Decode { path: path.to_path_buf(), format: "LAZ", message }
}

/// Finds the chunks that hold the first `count` points.
fn find_chunks(
    path: &Path,
    header: &Header,
    vlr: &LazVlr,
    source: &mut dyn Source,
    count: usize,
) -> Result<Vec<Chunk>, IoError> {
    let failed = |message: String| undecodable(path, message);
    let unread = |error| IoError::from_system(path, error);
    let length = source.length();
    let cut = || IoError::truncated(path, "table of chunks", header.points_at + 16, length);
    let first = header.points_at + 8;
    let mut number_at = |at: Option<u64>| -> Result<Option<i64>, IoError> {
        let Some(at) = at.filter(|at| at.checked_add(8).is_some_and(|end| end <= length)) else { return Ok(None) };
        Ok(Fields::new(&source.get(at..at + 8).map_err(unread)?).i64())
    };
    let stated = number_at(Some(header.points_at))?.ok_or_else(cut)?;
    // A writer that could not go back leaves the place at the end of the file.
    let at_end = number_at(length.checked_sub(8))?;
    let place = [Some(stated), at_end].into_iter().flatten().find_map(|place| {
        let place = u64::try_from(place).ok()?;
        (place >= first && place.checked_add(8)? <= length).then_some(place)
    });
    let Some(place) = place else {
        let needed = u64::try_from(stated).unwrap_or(0).saturating_add(8);
        return Err(IoError::truncated(path, "points", needed.max(first), length));
    };

    // A chunk starts with a point that is not compressed: that bounds their number.
    let stated = Fields::at(&source.get(place..place + 8).map_err(unread)?, 4).u32().ok_or_else(cut)?;
    if u64::from(stated) > (place - first) / header.record_length as u64 {
        return Err(failed(format!("its table states {stated} chunks, more than the file has room for")));
    }
    let end = length.min(place + 1024 + MOST_BYTES_PER_ENTRY * u64::from(stated));
    let bytes = source.get(place..end).map_err(unread)?;
    let table = without_panic(|| ChunkTable::read(&mut Cursor::new(&bytes), vlr.uses_variable_size_chunks()));
    let table = table.map_err(failed)?.map_err(|e| failed(format!("its table of chunks: {e}")))?;

    let (mut chunks, mut at, mut left) = (Vec::with_capacity(stated as usize), first, count);
    for entry in &table {
        if left == 0 {
            break;
        }
        let points = if vlr.uses_variable_size_chunks() { entry.point_count } else { u64::from(vlr.chunk_size()) };
        let points = usize::try_from(points).unwrap_or(usize::MAX).min(left);
        let Some(end) = at.checked_add(entry.byte_count).filter(|end| *end <= place) else {
            return Err(failed(format!("chunk {} reaches beyond the points", chunks.len())));
        };
        left -= points;
        if points > 0 {
            chunks.push(Chunk { bytes: at..end, points });
        }
        at = end;
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
fn layers_fit(chunk: &[u8], record_bytes: usize, layers: usize) -> bool {
    let mut fields = Fields::at(chunk, record_bytes);
    let mut sum = || {
        fields.u32()?;
        let mut sum = 0_u64;
        for _ in 0..layers {
            sum += u64::from(fields.u32()?);
        }
        Some(sum + fields.position as u64)
    };
    sum().is_some_and(|end| end <= chunk.len() as u64)
}

fn decode_chunk(vlr: &LazVlr, scheme: Scheme, chunk: &[u8], record: &Record, mut rows: Rows<'_>) -> Result<(), String> {
    let source = Cursor::new(chunk);
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
