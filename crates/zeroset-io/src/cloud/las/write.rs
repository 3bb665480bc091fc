//! Writing LAS 1.4 and LAZ.

use std::ops::Range;

use laz::{LazItemRecordBuilder, LazVlr, ParLasZipCompressor};
use rayon::prelude::*;
use zeroset::cloud::Cloud;

use crate::CloudFormat;
use crate::mesh::{WriteOptions, tolerance, world};
use crate::number::decimals_for;
use crate::output::Sink;

const HEADER: u16 = 375;
/// Bytes in front of the data of a variable length record.
const RECORD_HEAD: usize = 54;

/// How coordinates become 32 bit integers.
struct Grid {
    scale: f64,
    offset: [f64; 3],
    low: [f64; 3],
    high: [f64; 3],
}

impl Grid {
    fn of(cloud: &Cloud, options: &WriteOptions) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
        for i in 0..cloud.len() {
            let point = cloud.world(i);
            for axis in 0..3 {
                low[axis] = low[axis].min(point[axis]);
                high[axis] = high[axis].max(point[axis]);
            }
        }
        if cloud.is_empty() {
            (low, high) = ([0.0; 3], [0.0; 3]);
        }
        // A whole number in the middle, so that the offset itself is exact.
        let offset: [f64; 3] = std::array::from_fn(|axis| (0.5 * low[axis] + 0.5 * high[axis]).floor());
        let reach = (0..3).map(|a| (high[a] - offset[a]).abs().max((offset[a] - low[a]).abs())).fold(0.0, f64::max);
        // Millimetres unless the resolution asks for more, and as coarse as the extent forces.
        let mut exponent = -i32::try_from(decimals_for(tolerance(options, &cloud.points)).clamp(3, 9)).unwrap_or(3);
        while reach / power_of_ten(exponent) > f64::from(i32::MAX - 1) {
            exponent += 1;
        }
        Self { scale: power_of_ten(exponent), offset, low, high }
    }

    fn raw(&self, value: f64, axis: usize) -> i32 {
        ((value - self.offset[axis]) / self.scale).round() as i32
    }
}

/// The f64 nearest to the power, which `powi` does not always give.
fn power_of_ten(exponent: i32) -> f64 {
    if exponent < 0 { 1.0 / 10_f64.powi(-exponent) } else { 10_f64.powi(exponent) }
}

/// Points that are encoded at a time.
const RUN: usize = 1 << 18;

/// Writes the whole file, run by run.
pub(crate) fn write(
    sink: &mut dyn Sink,
    format: CloudFormat,
    cloud: &Cloud,
    options: &WriteOptions,
) -> std::io::Result<()> {
    let attributes = &cloud.attributes;
    let codes = cloud.crs.as_deref().and_then(epsg_codes);
    let small_classes = attributes.classes.as_ref().is_none_or(|classes| classes.iter().all(|c| *c < 32));
    // The standard wants WKT with the formats from 6, so codes alone go with an old format if the classes fit there.
    let legacy = codes.is_some() && small_classes;
    let point_format = match (legacy, attributes.colors.is_some()) {
        (true, false) => 0_u8,
        (true, true) => 2,
        (false, false) => 6,
        (false, true) => 7,
    };
    let length: u16 = match point_format {
        0 => 20,
        2 => 26,
        6 => 30,
        _ => 36,
    };
    let grid = Grid::of(cloud, options);

    let mut records = Vec::new();
    match (&codes, &cloud.crs) {
        (Some(codes), _) => records.push(record("LASF_Projection", 34735, &geo_keys(codes))),
        (None, Some(wkt)) => {
            let text: Vec<u8> = wkt.bytes().chain([0]).collect();
            records.push(record("LASF_Projection", 2112, &text));
        }
        (None, None) => {}
    }
    let settings = if format == CloudFormat::Laz {
        let items = LazItemRecordBuilder::default_for_point_format_id(point_format, 0);
        let settings = LazVlr::from_laz_items(items.map_err(std::io::Error::other)?);
        let mut data = Vec::new();
        settings.write_to(&mut data).map_err(std::io::Error::other)?;
        records.push(record(LazVlr::USER_ID, LazVlr::RECORD_ID, &data));
        Some(settings)
    } else {
        None
    };

    let points_at = usize::from(HEADER) + records.iter().map(Vec::len).sum::<usize>();
    sink.write_all(&header(&HeaderFields {
        point_format: point_format | if settings.is_some() { 0x80 } else { 0 },
        length,
        points_at: points_at as u32,
        records: records.len() as u32,
        points: cloud.len() as u64,
        legacy,
        generator: &options.generator,
        grid: &grid,
    }))?;
    records.iter().try_for_each(|record| sink.write_all(record))?;
    let points = Points { cloud, grid: &grid, point_format, length: usize::from(length), stretch: stretch(cloud) };
    let runs = (0..cloud.len()).step_by(RUN).map(|start| points.encode(start..cloud.len().min(start + RUN)));
    let Some(settings) = settings else {
        return runs.into_iter().try_for_each(|run| sink.write_all(&run));
    };
    let mut compressor = ParLasZipCompressor::new(sink, settings).map_err(std::io::Error::other)?;
    for run in runs {
        compressor.compress_many(&run).map_err(std::io::Error::other)?;
    }
    compressor.done().map_err(std::io::Error::other)
}

/// What intensities are multiplied by. The field has 16 bits: shares of one are stretched, all else is taken as it is.
fn stretch(cloud: &Cloud) -> f32 {
    cloud.attributes.intensities.as_ref().map_or(1.0, |values| {
        let shares = values.iter().all(|v| (0.0..=1.0).contains(v)) && values.iter().any(|v| v.fract() != 0.0);
        if shares { 65535.0 } else { 1.0 }
    })
}

/// Points as records.
struct Points<'a> {
    cloud: &'a Cloud,
    grid: &'a Grid,
    point_format: u8,
    length: usize,
    stretch: f32,
}

impl Points<'_> {
    fn encode(&self, run: Range<usize>) -> Vec<u8> {
        let Self { cloud, grid, point_format, length, stretch } = *self;
        let attributes = &cloud.attributes;
        let mut bytes = vec![0; length * run.len()];
        let first = run.start;
        bytes.par_chunks_exact_mut(length).enumerate().with_min_len(1 << 12).for_each(|(row, out)| {
            let i = first + row;
            for (axis, value) in world(cloud.points[i], cloud.world_from_local).into_iter().enumerate() {
                out[4 * axis..4 * axis + 4].copy_from_slice(&grid.raw(value, axis).to_le_bytes());
            }
            if let Some(intensities) = &attributes.intensities {
                let value = (intensities[i] * stretch).round() as u16;
                out[12..14].copy_from_slice(&value.to_le_bytes());
            }
            let class = attributes.classes.as_ref().map_or(0, |classes| classes[i]);
            // The first of one return.
            let color_at = if point_format < 6 {
                out[14] = 1 | 1 << 3;
                out[15] = class;
                20
            } else {
                out[14] = 1 | 1 << 4;
                out[16] = class;
                30
            };
            if let Some(colors) = &attributes.colors {
                for (channel, value) in colors[i].into_iter().enumerate() {
                    let at = color_at + 2 * channel;
                    out[at..at + 2].copy_from_slice(&(u16::from(value) * 257).to_le_bytes());
                }
            }
        });
        bytes
    }
}

struct HeaderFields<'a> {
    point_format: u8,
    length: u16,
    points_at: u32,
    records: u32,
    points: u64,
    legacy: bool,
    generator: &'a str,
    grid: &'a Grid,
}

fn header(fields: &HeaderFields<'_>) -> Vec<u8> {
    let fixed = |text: &str| -> [u8; 32] {
        let mut out = [0; 32];
        // The last byte stays NUL; what is not ASCII has no place here.
        for (to, from) in out.iter_mut().take(31).zip(text.bytes().filter(|b| b.is_ascii_graphic() || *b == b' ')) {
            *to = from;
        }
        out
    };
    let mut out = Vec::with_capacity(usize::from(HEADER));
    out.extend_from_slice(b"LASF");
    out.extend_from_slice(&0_u16.to_le_bytes());
    // Bit 4: the reference system is WKT, which formats from 6 must say.
    out.extend_from_slice(&(if fields.legacy { 0_u16 } else { 1 << 4 }).to_le_bytes());
    out.extend_from_slice(&[0; 16]);
    out.extend_from_slice(&[1, 4]);
    out.extend_from_slice(&fixed("OTHER"));
    out.extend_from_slice(&fixed(fields.generator));
    // No date: equal clouds make equal files.
    out.extend_from_slice(&[0; 4]);
    out.extend_from_slice(&HEADER.to_le_bytes());
    out.extend_from_slice(&fields.points_at.to_le_bytes());
    out.extend_from_slice(&fields.records.to_le_bytes());
    out.push(fields.point_format);
    out.extend_from_slice(&fields.length.to_le_bytes());
    let legacy_count = if fields.legacy { u32::try_from(fields.points).unwrap_or(0) } else { 0 };
    // The count of all points, then of first returns, of which all are.
    out.extend_from_slice(&legacy_count.to_le_bytes());
    out.extend_from_slice(&legacy_count.to_le_bytes());
    out.extend_from_slice(&[0; 16]);
    for _ in 0..3 {
        out.extend_from_slice(&fields.grid.scale.to_le_bytes());
    }
    for axis in 0..3 {
        out.extend_from_slice(&fields.grid.offset[axis].to_le_bytes());
    }
    for axis in 0..3 {
        // The box of the points as they are stored.
        for bound in [fields.grid.high[axis], fields.grid.low[axis]] {
            let stored = f64::from(fields.grid.raw(bound, axis)) * fields.grid.scale + fields.grid.offset[axis];
            out.extend_from_slice(&stored.to_le_bytes());
        }
    }
    // No waveforms, no extended records.
    out.extend_from_slice(&[0; 8 + 8 + 4]);
    out.extend_from_slice(&fields.points.to_le_bytes());
    out.extend_from_slice(&fields.points.to_le_bytes());
    out.extend_from_slice(&[0; 14 * 8]);
    debug_assert_eq!(out.len(), usize::from(HEADER));
    out
}

fn record(user: &str, id: u16, data: &[u8]) -> Vec<u8> {
    // A reference system of over 64 kB is none; it is cut, as the field has no room for more.
    let data = &data[..data.len().min(usize::from(u16::MAX))];
    let mut out = Vec::with_capacity(RECORD_HEAD + data.len());
    out.extend_from_slice(&[0; 2]);
    let mut name = [0; 16];
    name[..user.len()].copy_from_slice(user.as_bytes());
    out.extend_from_slice(&name);
    out.extend_from_slice(&id.to_le_bytes());
    out.extend_from_slice(&(data.len() as u16).to_le_bytes());
    out.extend_from_slice(&[0; 32]);
    out.extend_from_slice(data);
    out
}

/// Horizontal and vertical code of `EPSG:h` or `EPSG:h+v`.
fn epsg_codes(crs: &str) -> Option<(u16, Option<u16>)> {
    let codes = crs.strip_prefix("EPSG:")?;
    match codes.split_once('+') {
        Some((horizontal, vertical)) => Some((horizontal.parse().ok()?, Some(vertical.parse().ok()?))),
        None => Some((codes.parse().ok()?, None)),
    }
}

fn geo_keys(codes: &(u16, Option<u16>)) -> Vec<u8> {
    let (horizontal, vertical) = *codes;
    let (model, key) = if crate::epsg::is_geographic(horizontal.into()) { (2, 2048) } else { (1, 3072) };
    let mut entries = vec![[1024, 0, 1, model], [key, 0, 1, horizontal]];
    entries.extend(vertical.map(|vertical| [4096, 0, 1, vertical]));
    let head = [1, 1, 0, entries.len() as u16];
    head.iter().chain(entries.iter().flatten()).flat_map(|value| value.to_le_bytes()).collect()
}
