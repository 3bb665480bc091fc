//! PCD, the Point Cloud Library's format: ascii, binary and binary_compressed.
//!
//! Points are taken as stored: the `VIEWPOINT` of the header says where the scanner stood, it is not a transform.

mod header;
mod lzf;

use std::path::Path;

use zeroset::cloud::Attributes;

use super::Columns;
use super::columns::class_from_value;
use crate::IoError;
use crate::input::Fields;
use header::{Data, Header, Kind};

pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Columns, IoError> {
    let header = Header::parse(path, bytes)?;
    if header.points == 0 {
        return Err(IoError::NoPoints { path: path.to_path_buf() });
    }
    let layout = Layout::of(path, &header)?;
    let body = &bytes[header.length..];
    let lying = |found: u64| IoError::CountMismatch {
        path: path.to_path_buf(),
        items: "points",
        declared: header.points,
        found,
    };
    let stride = header.stride();
    let room = |length: usize| (length / stride) as u64;
    let mut columns = match header.data {
        Data::Ascii => read_ascii(path, &header, &layout, body)?,
        Data::Binary => {
            if header.points > room(body.len()) {
                return Err(lying(room(body.len())));
            }
            // As many as there is room for fit into usize.
            layout.collect(header.points as usize, |point, field| &body[point * stride + field.offset..])
        }
        Data::Compressed => {
            let plain = unpack(path, body)?;
            if header.points > room(plain.len()) {
                return Err(lying(room(plain.len())));
            }
            // Compressed files hold one field after another, each for all points.
            let points = header.points as usize;
            layout.collect(points, |point, field| &plain[points * field.offset + point * field.size..])
        }
    };
    columns.declared = Some(header.points);
    Ok(columns)
}

fn unpack(path: &Path, body: &[u8]) -> Result<Vec<u8>, IoError> {
    let mut fields = Fields::new(body);
    let (Some(packed), Some(plain)) = (fields.u32(), fields.u32()) else {
        return Err(IoError::truncated(path, "points", 8, body.len() as u64));
    };
    let Some(data) = fields.take(packed as usize) else {
        return Err(IoError::truncated(path, "points", u64::from(packed) + 8, body.len() as u64));
    };
    lzf::decompress(data, plain as usize).ok_or_else(|| IoError::Decode {
        path: path.to_path_buf(),
        format: "PCD",
        message: "its compressed points are damaged".into(),
    })
}

/// A field of interest: where its first value is in a record, or in the sum of the fields before it.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// Bytes before it.
    offset: usize,
    /// Values before it, for text.
    column: usize,
    /// Bytes of the whole field.
    size: usize,
    kind: Kind,
}

#[derive(Debug)]
struct Layout {
    position: [Place; 3],
    /// Blue, green, red and a spare byte in one 32 bit value, which is often declared as a float.
    color: Option<Place>,
    intensity: Option<Place>,
    class: Option<Place>,
}

impl Layout {
    fn of(path: &Path, header: &Header) -> Result<Self, IoError> {
        let find = |names: &[&str]| {
            // The first name that is there wins: `i` may be a number of the point where `intensity` is the intensity.
            let place = |name: &&str| header.fields.iter().position(|field| field.name.eq_ignore_ascii_case(name));
            let index = names.iter().find_map(place)?;
            let before = &header.fields[..index];
            let field = &header.fields[index];
            Some(Place {
                offset: before.iter().map(header::Field::bytes).sum(),
                column: before.iter().map(|f| f.count).sum(),
                size: field.bytes(),
                kind: field.kind,
            })
        };
        let missing = || IoError::malformed(path, "the PCD header has no fields x, y and z", "export with x, y and z");
        Ok(Self {
            position: [
                find(&["x"]).ok_or_else(missing)?,
                find(&["y"]).ok_or_else(missing)?,
                find(&["z"]).ok_or_else(missing)?,
            ],
            color: find(&["rgb", "rgba"]).filter(|place| place.kind.size() == 4),
            intensity: find(&["intensity", "i", "scalar_intensity"]),
            class: find(&["classification", "label", "class", "scalar_classification"]),
        })
    }

    /// Gathers the columns out of binary values.
    fn collect<'a>(&self, points: usize, bytes: impl Fn(usize, &Place) -> &'a [u8]) -> Columns {
        let values = |place: &Place| (0..points).map(|i| place.kind.decode(bytes(i, place))).collect::<Vec<f64>>();
        let [x, y, z] = &self.position;
        let position = |i: usize| [x, y, z].map(|place| place.kind.decode(bytes(i, place)));
        let colors = self.color.map(|place| (0..points).map(|i| unpack_color(bytes(i, &place))).collect());
        let intensities = self.intensity.map(|place| values(&place).iter().map(|v| *v as f32).collect());
        let classes = self.class.map(|place| values(&place).iter().map(|v| class_from_value(*v)).collect());
        Columns {
            points: (0..points).map(position).collect(),
            attributes: Attributes { colors, intensities, classes },
            ..Columns::default()
        }
    }
}

fn unpack_color(bytes: &[u8]) -> [u8; 3] {
    [bytes[2], bytes[1], bytes[0]]
}

fn read_ascii(path: &Path, header: &Header, layout: &Layout, body: &[u8]) -> Result<Columns, IoError> {
    let width: usize = header.fields.iter().map(|field| field.count).sum();
    let lying = |found: usize| IoError::CountMismatch {
        path: path.to_path_buf(),
        items: "points",
        declared: header.points,
        found: found as u64,
    };
    // A digit and a separator a value, the last separator may be missing.
    let most = (body.len() + 1) / (2 * width);
    let points = usize::try_from(header.points).ok().filter(|points| *points <= most).ok_or_else(|| lying(most))?;
    let mut tokens = body.split(u8::is_ascii_whitespace).filter(|token| !token.is_empty());
    let mut columns = Columns { points: Vec::with_capacity(points), ..Columns::default() };
    let mut colors = layout.color.map(|_| Vec::new());
    let mut intensities = layout.intensity.map(|_| Vec::new());
    let mut classes = layout.class.map(|_| Vec::new());
    let mut row: Vec<&[u8]> = Vec::with_capacity(width);
    for i in 0..points {
        row.clear();
        row.extend(tokens.by_ref().take(width));
        if row.len() < width {
            return Err(lying(i));
        }
        let value = |place: &Place| {
            let token = row[place.column];
            fast_float2::parse::<f64, _>(token).map_err(|_| {
                let text = String::from_utf8_lossy(&token[..token.len().min(30)]).into_owned();
                IoError::malformed(
                    path,
                    format!("`{text}` in point {i} is not a number"),
                    "correct or remove the point",
                )
            })
        };
        let [x, y, z] = &layout.position;
        columns.points.push([value(x)?, value(y)?, value(z)?]);
        if let (Some(colors), Some(place)) = (&mut colors, &layout.color) {
            let value = value(place)?;
            let bits = if place.kind.is_float() { (value as f32).to_bits() } else { value as i64 as u32 };
            colors.push(unpack_color(&bits.to_le_bytes()));
        }
        if let (Some(intensities), Some(place)) = (&mut intensities, &layout.intensity) {
            intensities.push(value(place)? as f32);
        }
        if let (Some(classes), Some(place)) = (&mut classes, &layout.class) {
            classes.push(class_from_value(value(place)?));
        }
    }
    if tokens.next().is_some() {
        let what = format!("the PCD text has more values than {points} points of {width} take");
        return Err(IoError::damaged(path, what));
    }
    columns.attributes = Attributes { colors, intensities, classes };
    Ok(columns)
}
