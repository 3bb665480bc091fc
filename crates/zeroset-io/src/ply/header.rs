//! The header of a PLY file.

use std::path::Path;

use crate::IoError;
use crate::format::sniff;

/// How the values of the body are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Encoding {
    Ascii,
    Little,
    Big,
}

/// Type of a value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn parse(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    pub(crate) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value at the start of `bytes`, which must be long enough; zero if it is not.
    #[inline]
    pub(crate) fn decode(self, bytes: &[u8], encoding: Encoding) -> f64 {
        fn array<const N: usize>(bytes: &[u8], encoding: Encoding) -> [u8; N] {
            let mut out = [0; N];
            if let Some(bytes) = bytes.get(..N) {
                out.copy_from_slice(bytes);
            }
            if encoding == Encoding::Big {
                out.reverse();
            }
            out
        }
        match self {
            Self::I8 => f64::from(i8::from_le_bytes(array(bytes, encoding))),
            Self::U8 => f64::from(u8::from_le_bytes(array(bytes, encoding))),
            Self::I16 => f64::from(i16::from_le_bytes(array(bytes, encoding))),
            Self::U16 => f64::from(u16::from_le_bytes(array(bytes, encoding))),
            Self::I32 => f64::from(i32::from_le_bytes(array(bytes, encoding))),
            Self::U32 => f64::from(u32::from_le_bytes(array(bytes, encoding))),
            Self::F32 => f64::from(f32::from_le_bytes(array(bytes, encoding))),
            Self::F64 => f64::from_le_bytes(array(bytes, encoding)),
        }
    }
}

/// One value of an element, or a counted list of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Property {
    Single { name: String, kind: Scalar },
    List { name: String, count: Scalar, item: Scalar },
}

impl Property {
    pub(crate) fn name(&self) -> &str {
        match self {
            Self::Single { name, .. } | Self::List { name, .. } => name,
        }
    }
}

/// A group of equal records: vertices, faces, and so on.
#[derive(Debug, Clone)]
pub(crate) struct Element {
    pub(crate) name: String,
    pub(crate) count: u64,
    pub(crate) properties: Vec<Property>,
}

impl Element {
    /// Bytes of a binary record, if none of its properties is a list.
    pub(crate) fn stride(&self) -> Option<usize> {
        self.properties.iter().try_fold(0_usize, |sum, property| match property {
            Property::Single { kind, .. } => sum.checked_add(kind.size()),
            Property::List { .. } => None,
        })
    }

    /// The fewest bytes that a record can take: the room in the file divided by it bounds the true count.
    pub(crate) fn least_bytes(&self, encoding: Encoding) -> u64 {
        let binary = |property: &Property| match property {
            Property::Single { kind, .. } => kind.size() as u64,
            Property::List { count, .. } => count.size() as u64,
        };
        match encoding {
            // A digit and a separator a value; the very last separator may be missing.
            Encoding::Ascii => 2 * self.properties.len() as u64,
            Encoding::Little | Encoding::Big => self.properties.iter().map(binary).sum(),
        }
    }

    /// Index and type of the property of the first of `names` that exists.
    pub(crate) fn find(&self, names: &[&str]) -> Option<(usize, Scalar)> {
        names.iter().find_map(|wanted| {
            self.properties.iter().enumerate().find_map(|(i, property)| match property {
                Property::Single { name, kind } if name.eq_ignore_ascii_case(wanted) => Some((i, *kind)),
                _ => None,
            })
        })
    }
}

/// Everything before the body.
#[derive(Debug, Clone)]
pub(crate) struct Header {
    pub(crate) encoding: Encoding,
    pub(crate) comments: Vec<String>,
    pub(crate) elements: Vec<Element>,
    /// Where the body starts.
    pub(crate) length: usize,
}

/// More than this is no header that a program of good will writes, and would only cost memory.
const MAX_PROPERTIES: usize = 4096;

impl Header {
    pub(crate) fn parse(path: &Path, bytes: &[u8]) -> Result<Self, IoError> {
        let bad = |line: usize, what: &str| IoError::damaged(path, format!("line {line} of the PLY header {what}"));
        let mut lines = Lines { bytes, position: 0 };
        if lines.next().is_none_or(|line| line.trim_ascii() != b"ply") {
            // A strict prefix of the magic word is a file cut short, not another format.
            if b"ply\n".starts_with(bytes) {
                return Err(IoError::truncated(path, "header", 4, bytes.len() as u64));
            }
            return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "PLY", looks: sniff(bytes) });
        }
        let (mut encoding, mut comments, mut elements) = (None, Vec::new(), Vec::<Element>::new());
        let (mut number, mut properties) = (1, 0);
        while let Some(line) = lines.next() {
            number += 1;
            let text = String::from_utf8_lossy(line);
            let mut words = text.split_ascii_whitespace();
            match words.next() {
                None => {}
                Some("comment" | "obj_info") => {
                    let rest = text.trim_start().split_once(char::is_whitespace).map_or("", |(_, rest)| rest);
                    comments.push(rest.trim().to_string());
                }
                Some("format") => {
                    encoding = Some(match words.next() {
                        Some("ascii") => Encoding::Ascii,
                        Some("binary_little_endian") => Encoding::Little,
                        Some("binary_big_endian") => Encoding::Big,
                        _ => return Err(bad(number, "names no known encoding")),
                    });
                }
                Some("element") => {
                    let name = words.next().ok_or_else(|| bad(number, "has an element without a name"))?;
                    let count = words.next().and_then(|word| word.parse().ok());
                    let count = count.ok_or_else(|| bad(number, "has an element without a valid count"))?;
                    elements.push(Element { name: name.to_string(), count, properties: Vec::new() });
                }
                Some("property") => {
                    let element =
                        elements.last_mut().ok_or_else(|| bad(number, "has a property before any element"))?;
                    let property = property(&mut words).ok_or_else(|| bad(number, "has an invalid property"))?;
                    properties += 1;
                    if properties > MAX_PROPERTIES {
                        return Err(bad(number, "has more properties than any real file"));
                    }
                    element.properties.push(property);
                }
                Some("end_header") => {
                    let encoding = encoding.ok_or_else(|| bad(number, "ends it without a `format` line"))?;
                    return Ok(Self { encoding, comments, elements, length: lines.position });
                }
                Some(_) => return Err(bad(number, "has an unknown keyword")),
            }
        }
        Err(IoError::malformed(path, "the PLY header has no end", "the file is cut short or damaged: copy it again"))
    }

    /// The text after the first comment that starts with `key` and a space.
    pub(crate) fn comment(&self, key: &str) -> Option<&str> {
        self.comments.iter().find_map(|comment| comment.strip_prefix(key)?.strip_prefix(' '))
    }
}

fn property<'a>(words: &mut impl Iterator<Item = &'a str>) -> Option<Property> {
    let kind = words.next()?;
    if kind == "list" {
        let count = Scalar::parse(words.next()?)?;
        let item = Scalar::parse(words.next()?)?;
        if matches!(count, Scalar::F32 | Scalar::F64) {
            return None;
        }
        return Some(Property::List { name: words.next()?.to_string(), count, item });
    }
    let kind = Scalar::parse(kind)?;
    Some(Property::Single { name: words.next()?.to_string(), kind })
}

/// Header lines, ended by LF, CR LF or CR.
struct Lines<'a> {
    bytes: &'a [u8],
    position: usize,
}

impl<'a> Lines<'a> {
    fn next(&mut self) -> Option<&'a [u8]> {
        let rest = self.bytes.get(self.position..)?;
        // Without a line's end the header cannot go on; and a binary body must not be searched for one for long.
        let end = rest.iter().take(1 << 16).position(|b| *b == b'\n' || *b == b'\r')?;
        let pair = rest[end] == b'\r' && rest.get(end + 1) == Some(&b'\n');
        self.position += end + 1 + usize::from(pair);
        Some(&rest[..end])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_line_ends() {
        for end in ["\n", "\r\n", "\r"] {
            let text = [
                "ply",
                "format binary_big_endian 1.0",
                "comment crs EPSG:7415",
                "element vertex 2",
                "property double x",
                "property list uchar int more",
                "end_header",
                "XYZ",
            ]
            .join(end);
            let header = Header::parse(Path::new("a.ply"), text.as_bytes()).unwrap();
            assert_eq!(&text.as_bytes()[header.length..], b"XYZ");
            assert_eq!(header.comment("crs"), Some("EPSG:7415"));
            assert_eq!(header.encoding, Encoding::Big);
            assert_eq!(header.elements[0].count, 2);
            assert_eq!(header.elements[0].stride(), None);
            assert_eq!(header.elements[0].least_bytes(header.encoding), 9);
        }
    }

    #[test]
    fn counts_must_be_counts() {
        for count in ["-1", "1e3", "18446744073709551616", ""] {
            let text = format!("ply\nformat ascii 1.0\nelement vertex {count}\nend_header\n");
            assert!(Header::parse(Path::new("a.ply"), text.as_bytes()).is_err(), "{count}");
        }
    }
}
