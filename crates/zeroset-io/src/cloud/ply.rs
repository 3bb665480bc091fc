//! Clouds in PLY: the vertices of a file, whatever else it holds.
//!
//! Properties may come in any order and type. Lists and other elements are passed over. Names that other programs give
//! to the same thing are known: `intensity` or `scalar_Intensity`, `classification`, `class` or `label` and so on.

use std::path::Path;

use rayon::prelude::*;
use zeroset::cloud::Attributes;

use super::Columns;
use super::columns::{class_from_value, colors_from_u16, colors_from_values, is_wide};
use super::report::LinearUnit;
use crate::IoError;
use crate::ply::body::Body;
use crate::ply::header::{Element, Encoding, Header, Property, Scalar};

pub(crate) fn read(path: &Path, bytes: &[u8]) -> Result<Columns, IoError> {
    let header = Header::parse(path, bytes)?;
    let mut body = Body::new(path, bytes, &header);
    for (i, element) in header.elements.iter().enumerate() {
        if element.name != "vertex" {
            body.skip(element)?;
            continue;
        }
        let mut columns = vertices(path, &mut body, element, header.encoding)?;
        if i + 1 == header.elements.len() {
            body.end()?;
        }
        columns.declared = Some(element.count);
        columns.crs = header.comment("crs").map(str::to_string);
        columns.unit = header.comment("unit").and_then(LinearUnit::from_name);
        if let Some(program) = header.comment("generator") {
            columns.facts.push(("software", program.to_string()));
        }
        return Ok(columns);
    }
    Err(IoError::malformed(path, "the PLY header has no `vertex` element", "export points or a mesh with vertices"))
}

/// Where the values of interest are in a record.
pub(crate) struct VertexLayout {
    position: [(usize, Scalar); 3],
    color: Option<[(usize, Scalar); 3]>,
    intensity: Option<(usize, Scalar)>,
    class: Option<(usize, Scalar)>,
}

impl VertexLayout {
    pub(crate) fn of(path: &Path, element: &Element) -> Result<Self, IoError> {
        let three =
            |names: [&[&str]; 3]| Some([element.find(names[0])?, element.find(names[1])?, element.find(names[2])?]);
        let position = three([&["x"], &["y"], &["z"]]).ok_or_else(|| {
            IoError::malformed(path, "the PLY vertices have no x, y and z", "export with coordinates named x, y, z")
        })?;
        let color =
            three([&["red", "r", "diffuse_red"], &["green", "g", "diffuse_green"], &["blue", "b", "diffuse_blue"]]);
        Ok(Self {
            position,
            color,
            intensity: element.find(&["intensity", "scalar_intensity", "scalar_scalar_intensity", "reflectance"]),
            class: element.find(&["classification", "scalar_classification", "class", "scalar_class", "label"]),
        })
    }

    /// With byte offsets in place of the indices of properties.
    fn with_offsets(&self, element: &Element) -> Self {
        let offset = |(index, kind): (usize, Scalar)| {
            let before = &element.properties[..index];
            let size = |p: &Property| if let Property::Single { kind, .. } = p { kind.size() } else { 0 };
            (before.iter().map(size).sum(), kind)
        };
        Self {
            position: self.position.map(offset),
            color: self.color.map(|color| color.map(offset)),
            intensity: self.intensity.map(offset),
            class: self.class.map(offset),
        }
    }
}

/// Reads the vertex element, at which `body` must stand.
pub(crate) fn vertices(
    path: &Path,
    body: &mut Body<'_>,
    element: &Element,
    encoding: Encoding,
) -> Result<Columns, IoError> {
    let layout = VertexLayout::of(path, element)?;
    let count = body.checked_count(element, "points")?;
    match element.stride() {
        Some(stride) if encoding != Encoding::Ascii => {
            let records = body.records(stride, count, "points")?;
            Ok(decode(&layout.with_offsets(element), records, stride, encoding))
        }
        _ => walk(&layout, body, element, count),
    }
}

/// Records of fixed size: each column in one parallel pass.
fn decode(layout: &VertexLayout, records: &[u8], stride: usize, encoding: Encoding) -> Columns {
    // Long enough for a thread to be worth it; the result does not depend on it.
    const RUN: usize = 1 << 14;
    let rows = || records.par_chunks_exact(stride).with_min_len(RUN);
    let value = |row: &[u8], (offset, kind): (usize, Scalar)| kind.decode(&row[offset..], encoding);

    let position = layout.position;
    // The common cases get a loop of their own, without a choice for each value.
    let all = |wanted| position.iter().all(|(_, kind)| *kind == wanted);
    let points = if all(Scalar::F32) {
        rows().map(|row| position.map(|(at, _)| Scalar::F32.decode(&row[at..], encoding))).collect()
    } else if all(Scalar::F64) {
        rows().map(|row| position.map(|(at, _)| Scalar::F64.decode(&row[at..], encoding))).collect()
    } else {
        rows().map(|row| position.map(|place| value(row, place))).collect()
    };
    let colors = layout.color.map(|color| {
        if color.iter().all(|(_, kind)| *kind == Scalar::U8) {
            rows().map(|row| color.map(|(at, _)| row[at])).collect()
        } else if color.iter().all(|(_, kind)| *kind == Scalar::U16) {
            let wide: Vec<_> = rows().map(|row| color.map(|place| value(row, place) as u16)).collect();
            colors_from_u16(&wide, is_wide(wide.iter().flatten()))
        } else {
            let wide: Vec<_> = rows().map(|row| color.map(|place| value(row, place) as f32)).collect();
            colors_from_values(&wide)
        }
    });
    let intensities = layout.intensity.map(|place| rows().map(|row| value(row, place) as f32).collect());
    let classes = layout.class.map(|place| rows().map(|row| class_from_value(value(row, place))).collect());
    Columns { points, attributes: Attributes { colors, intensities, classes }, ..Columns::default() }
}

/// Text, and binary records with lists: one value after another.
fn walk(layout: &VertexLayout, body: &mut Body<'_>, element: &Element, count: usize) -> Result<Columns, IoError> {
    let mut points = Vec::with_capacity(count);
    let mut colors = layout.color.map(|_| Vec::with_capacity(count));
    let mut intensities = layout.intensity.map(|_| Vec::with_capacity(count));
    let mut classes = layout.class.map(|_| Vec::with_capacity(count));
    let mut values = Vec::with_capacity(element.properties.len());
    for i in 0..count {
        body.record(element, i, "points", &mut values, &mut |_, _| {})?;
        points.push(layout.position.map(|(at, _)| values[at]));
        if let (Some(colors), Some(color)) = (&mut colors, layout.color) {
            colors.push(color.map(|(at, _)| values[at] as f32));
        }
        if let (Some(intensities), Some((at, _))) = (&mut intensities, layout.intensity) {
            intensities.push(values[at] as f32);
        }
        if let (Some(classes), Some((at, _))) = (&mut classes, layout.class) {
            classes.push(class_from_value(values[at]));
        }
    }
    let eight_bits = layout.color.is_some_and(|color| color.iter().all(|(_, kind)| *kind == Scalar::U8));
    let colors = colors.map(|colors| {
        if eight_bits { colors.iter().map(|c| c.map(|v| v as u8)).collect() } else { colors_from_values(&colors) }
    });
    Ok(Columns { points, attributes: Attributes { colors, intensities, classes }, ..Columns::default() })
}
