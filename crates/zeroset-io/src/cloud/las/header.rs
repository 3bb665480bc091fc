//! The public header block and the variable length records.

use std::ops::Range;
use std::path::Path;

use crate::IoError;
use crate::format::sniff;
use crate::input::{Fields, Source, fixed_text};

/// A variable length record, ordinary or extended.
#[derive(Debug)]
pub(super) struct VariableRecord {
    pub(super) user: String,
    pub(super) id: u16,
    pub(super) data: Vec<u8>,
}

/// What of the header matters here.
#[derive(Debug)]
pub(super) struct Header {
    version: (u8, u8),
    system: String,
    software: String,
    /// Day of the year and year.
    created: (u16, u16),
    pub(super) points_at: u64,
    /// 0 to 10.
    pub(super) point_format: u8,
    pub(super) compressed: bool,
    pub(super) record_length: usize,
    pub(super) point_count: u64,
    pub(super) scale: [f64; 3],
    pub(super) offset: [f64; 3],
    /// Lowest and highest coordinates, as stated.
    pub(super) bounds: [[f64; 3]; 2],
    /// Those that say something about the points.
    pub(super) records: Vec<VariableRecord>,
}

/// Bytes of the longest header.
const LONGEST: u64 = 375;
/// Bytes in front of the data of a record, ordinary and extended.
const RECORD_HEADS: [u64; 2] = [54, 60];
/// Users whose records matter here. Others may be as large as the points.
const USERS: [&str; 3] = ["LASF_Projection", "laszip encoded", "copc"];

/// Bytes of a record of each point format, without extra bytes.
const RECORD_LENGTHS: [u16; 11] = [20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67];

impl Header {
    pub(super) fn parse(path: &Path, format: &'static str, source: &mut dyn Source) -> Result<Self, IoError> {
        let failed = |error| IoError::from_system(path, error);
        let length_of_file = source.length();
        let front = source.get(0..LONGEST.min(length_of_file)).map_err(failed)?.into_owned();
        let bytes = &front[..];
        if !bytes.starts_with(b"LASF") {
            if b"LASF".starts_with(bytes) {
                return Err(IoError::truncated(path, "header", 227, bytes.len() as u64));
            }
            return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: format, looks: sniff(bytes) });
        }
        let short = |needed: usize| move || IoError::truncated(path, "header", needed as u64, bytes.len() as u64);
        // Field by field as the specification lists them; the numbers are byte offsets from its table.
        let version = Fields::at(bytes, 24).array::<2>().ok_or_else(short(227))?;
        let mut rest = Fields::at(bytes, 26);
        let mut read = || {
            let system = fixed_text(rest.take(32)?);
            let software = fixed_text(rest.take(32)?);
            let created = (rest.u16()?, rest.u16()?);
            let header_size = rest.u16()?;
            let points_at = rest.u32()?;
            let record_count = rest.u32()?;
            let point_format = rest.u8()?;
            let record_length = rest.u16()?;
            let legacy_count = rest.u32()?;
            rest.take(20)?;
            let mut six = [0.0; 6];
            for value in &mut six {
                *value = rest.f64()?;
            }
            // The highest comes before the lowest of each axis.
            let (mut low, mut high) = ([0.0; 3], [0.0; 3]);
            for (low, high) in low.iter_mut().zip(&mut high) {
                (*high, *low) = (rest.f64()?, rest.f64()?);
            }
            let bounds = [low, high];
            Some((
                system,
                software,
                created,
                header_size,
                points_at,
                record_count,
                point_format,
                record_length,
                legacy_count,
                six,
                bounds,
            ))
        };
        let (system, software, created, header_size, points_at, record_count, raw_format, length, legacy, six, bounds) =
            read().ok_or_else(short(227))?;

        if version[0] != 1 || version[1] > 4 {
            return Err(IoError::Unsupported {
                path: path.to_path_buf(),
                feature: format!("LAS version {}.{}", version[0], version[1]),
                remedy: "convert the file to LAS 1.4",
            });
        }
        // LASzip marks compression in the two high bits of the format.
        let (point_format, compressed) = (raw_format & 0x3F, raw_format & 0xC0 != 0);
        let Some(least) = RECORD_LENGTHS.get(usize::from(point_format)) else {
            return Err(IoError::Unsupported {
                path: path.to_path_buf(),
                feature: format!("LAS point format {point_format}"),
                remedy: "convert the file to a point format from 0 to 10",
            });
        };
        if length < *least {
            let what = format!("LAS records of {length} bytes are too short for point format {point_format}");
            return Err(IoError::damaged(path, what));
        }
        let (scale, offset) = ([six[0], six[1], six[2]], [six[3], six[4], six[5]]);
        if scale.iter().any(|s| !s.is_finite() || *s == 0.0) || offset.iter().any(|o| !o.is_finite()) {
            return Err(IoError::damaged(path, "the LAS header has an unusable scale or offset"));
        }

        let is_1_4 = version == [1, 4];
        let (mut point_count, mut extended) = (u64::from(legacy), None);
        if is_1_4 {
            let mut rest = Fields::at(bytes, 235);
            let mut read = || Some((rest.u64()?, rest.u32()?, rest.u64()?));
            let (first, count, points) = read().ok_or_else(short(375))?;
            extended = Some((first, count));
            // The legacy field is zero for formats from 6 and for large files; the wide one rules unless it is unset.
            if points != 0 {
                point_count = points;
            }
        }

        let points_at = u64::from(points_at);
        let least_header = if is_1_4 { 375 } else { 227 };
        if header_size < least_header || points_at < u64::from(header_size) {
            return Err(IoError::damaged(path, "the LAS header states an impossible size of itself"));
        }
        if points_at > length_of_file {
            return Err(IoError::truncated(path, "header", points_at, length_of_file));
        }
        let mut header = Self {
            version: (version[0], version[1]),
            system,
            software,
            created,
            points_at,
            point_format,
            compressed,
            record_length: usize::from(length),
            point_count,
            scale,
            offset,
            bounds,
            records: Vec::new(),
        };
        let ordinary = u64::from(header_size)..points_at;
        header.read_records(source, ordinary, record_count, Kind::Ordinary).map_err(failed)?;
        if let Some((first, count)) = extended.filter(|(first, _)| *first >= points_at) {
            header.read_records(source, first..length_of_file, count, Kind::Extended).map_err(failed)?;
        }
        Ok(header)
    }

    /// Collects records until the count or the bytes end. They only carry additions to the points, so records that are
    /// damaged are passed over; the ones that decoding needs are asked for where they are needed.
    fn read_records(
        &mut self,
        source: &mut dyn Source,
        place: Range<u64>,
        count: u32,
        kind: Kind,
    ) -> std::io::Result<()> {
        let (mut at, head_length) = (place.start, RECORD_HEADS[kind as usize]);
        for _ in 0..count {
            let Some(data_at) = at.checked_add(head_length).filter(|end| *end <= place.end) else { break };
            let head = source.get(at..data_at)?;
            let mut fields = Fields::new(&head);
            let mut read = || {
                fields.take(2)?;
                let user = fixed_text(fields.take(16)?);
                let id = fields.u16()?;
                let length = match kind {
                    Kind::Ordinary => u64::from(fields.u16()?),
                    Kind::Extended => fields.u64()?,
                };
                Some((user, id, data_at.checked_add(length).filter(|end| *end <= place.end)?))
            };
            let Some((user, id, end)) = read() else { break };
            if USERS.contains(&user.as_str()) {
                self.records.push(VariableRecord { user, id, data: source.get(data_at..end)?.into_owned() });
            }
            at = end;
        }
        Ok(())
    }

    pub(super) fn point_format_has_rgb(&self) -> bool {
        matches!(self.point_format, 2 | 3 | 5 | 7 | 8 | 10)
    }

    /// What a user may want to know about the file's origin.
    pub(super) fn facts(&self) -> Vec<(&'static str, String)> {
        let mut facts = vec![
            ("version", format!("LAS {}.{}", self.version.0, self.version.1)),
            ("point format", self.point_format.to_string()),
        ];
        if self.records.iter().any(|r| r.user == "copc" && r.id == 1) {
            facts.push(("layout", "cloud-optimised (COPC)".into()));
        }
        if !self.system.is_empty() {
            facts.push(("system", crate::error::clean(&self.system)));
        }
        if !self.software.is_empty() {
            facts.push(("software", crate::error::clean(&self.software)));
        }
        let (day, year) = self.created;
        if (1..=366).contains(&day) && year > 0 {
            facts.push(("created", format!("day {day} of {year}")));
        }
        facts
    }
}

#[derive(Clone, Copy)]
enum Kind {
    Ordinary,
    Extended,
}
