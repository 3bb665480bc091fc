//! The header of a PCD file.

use std::path::Path;

use crate::IoError;
use crate::format::sniff;

/// Type of the values of a field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Kind {
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
    F32,
    F64,
}

impl Kind {
    fn parse(letter: &str, size: &str) -> Option<Self> {
        Some(match (letter, size) {
            ("I", "1") => Self::I8,
            ("I", "2") => Self::I16,
            ("I", "4") => Self::I32,
            ("I", "8") => Self::I64,
            ("U", "1") => Self::U8,
            ("U", "2") => Self::U16,
            ("U", "4") => Self::U32,
            ("U", "8") => Self::U64,
            ("F", "4") => Self::F32,
            ("F", "8") => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    pub(super) fn is_float(self) -> bool {
        matches!(self, Self::F32 | Self::F64)
    }

    /// The value at the start of `bytes`, which must be long enough; zero if it is not.
    #[inline]
    pub(super) fn decode(self, bytes: &[u8]) -> f64 {
        fn array<const N: usize>(bytes: &[u8]) -> [u8; N] {
            bytes.first_chunk().copied().unwrap_or([0; N])
        }
        match self {
            Self::I8 => f64::from(i8::from_le_bytes(array(bytes))),
            Self::I16 => f64::from(i16::from_le_bytes(array(bytes))),
            Self::I32 => f64::from(i32::from_le_bytes(array(bytes))),
            Self::I64 => i64::from_le_bytes(array(bytes)) as f64,
            Self::U8 => f64::from(u8::from_le_bytes(array(bytes))),
            Self::U16 => f64::from(u16::from_le_bytes(array(bytes))),
            Self::U32 => f64::from(u32::from_le_bytes(array(bytes))),
            Self::U64 => u64::from_le_bytes(array(bytes)) as f64,
            Self::F32 => f64::from(f32::from_le_bytes(array(bytes))),
            Self::F64 => f64::from_le_bytes(array(bytes)),
        }
    }
}

#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) name: String,
    pub(super) kind: Kind,
    /// Values of the field in each point, at least one.
    pub(super) count: usize,
}

impl Field {
    pub(super) fn bytes(&self) -> usize {
        self.kind.size() * self.count
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Data {
    Ascii,
    Binary,
    Compressed,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) fields: Vec<Field>,
    pub(super) points: u64,
    pub(super) data: Data,
    /// Where the body starts.
    pub(super) length: usize,
}

/// Bounds that no file of good will reaches: histograms of features have some hundred values a point.
const MOST_FIELDS: usize = 1024;
const MOST_VALUES: usize = 1 << 16;

impl Header {
    /// Bytes of a point; at least those of x, y and z by the time that it is used.
    pub(super) fn stride(&self) -> usize {
        self.fields.iter().map(Field::bytes).sum::<usize>().max(1)
    }

    pub(super) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, IoError> {
        let bad = |what: &str| IoError::damaged(path, format!("the PCD header {what}"));
        let wrong = || IoError::WrongMagic { path: path.to_path_buf(), expected: "PCD", looks: sniff(bytes) };
        let (mut names, mut sizes, mut types, mut counts) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let (mut points, mut width, mut height) = (None, None, None);
        let (mut position, mut known) = (0, 0);
        loop {
            let rest = &bytes[position..];
            let Some(end) = rest.iter().take(1 << 16).position(|b| *b == b'\n') else {
                return Err(if known > 0 || rest.starts_with(b"#") || b"VERSION".starts_with(rest) {
                    IoError::malformed(path, "the PCD header has no end", "the file is cut short: copy it again")
                } else {
                    wrong()
                });
            };
            position += end + 1;
            let line = String::from_utf8_lossy(&rest[..end]);
            let mut words = line.split_ascii_whitespace();
            let Some(key) = words.next() else { continue };
            if key.starts_with('#') {
                continue;
            }
            let mut list = || words.by_ref().take(MOST_FIELDS).map(str::to_string).collect::<Vec<_>>();
            match key {
                "VERSION" | "VIEWPOINT" => {}
                "FIELDS" | "COLUMNS" => names = list(),
                "SIZE" => sizes = list(),
                "TYPE" => types = list(),
                "COUNT" => counts = list(),
                "WIDTH" => {
                    width = Some(
                        words.next().and_then(|w| w.parse::<u64>().ok()).ok_or_else(|| bad("has no valid WIDTH"))?,
                    )
                }
                "HEIGHT" => {
                    height = Some(
                        words.next().and_then(|w| w.parse::<u64>().ok()).ok_or_else(|| bad("has no valid HEIGHT"))?,
                    )
                }
                "POINTS" => {
                    points = Some(
                        words
                            .next()
                            .and_then(|w| w.parse::<u64>().ok())
                            .ok_or_else(|| bad("has no valid count of POINTS"))?,
                    )
                }
                "DATA" => {
                    let data = match words.next() {
                        Some("ascii") => Data::Ascii,
                        Some("binary") => Data::Binary,
                        Some("binary_compressed") => Data::Compressed,
                        _ => return Err(bad("names no known encoding of its DATA")),
                    };
                    let fields = fields(&names, &sizes, &types, &counts)
                        .ok_or_else(|| bad("describes its fields inconsistently"))?;
                    let grid = width.and_then(|w: u64| w.checked_mul(height.unwrap_or(1)));
                    let points = points.or(grid).ok_or_else(|| bad("states no count of points"))?;
                    return Ok(Self { fields, points, data, length: position });
                }
                _ if known == 0 => return Err(wrong()),
                _ => return Err(bad("has an unknown keyword")),
            }
            known += 1;
        }
    }
}

fn fields(names: &[String], sizes: &[String], types: &[String], counts: &[String]) -> Option<Vec<Field>> {
    if names.is_empty() || names.len() != sizes.len() || names.len() != types.len() {
        return None;
    }
    if !counts.is_empty() && counts.len() != names.len() {
        return None;
    }
    let mut values = 0_usize;
    let mut fields = Vec::with_capacity(names.len());
    for (i, name) in names.iter().enumerate() {
        let count = counts.get(i).map_or(Some(1), |count| count.parse().ok())?;
        values = values.checked_add(count)?;
        if count == 0 || values > MOST_VALUES {
            return None;
        }
        fields.push(Field { name: name.clone(), kind: Kind::parse(&types[i], &sizes[i])?, count });
    }
    Some(fields)
}
