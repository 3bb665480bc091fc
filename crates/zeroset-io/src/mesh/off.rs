//! Object file format, with normals (passed over) and colours at the vertices: OFF, COFF, NOFF, CNOFF, STOFF.

use std::path::Path;

use zeroset::cloud::Attributes;
use zeroset::mesh::Mesh;

use super::options::{WriteOptions, tolerance, world};
use super::text::{integer, lines, number, tokens};
use super::{Polygons, shares_to_colors};
use crate::IoError;
use crate::cloud::colors_from_values;
use crate::number::{decimals_for, push_fixed, push_integer};
use crate::output::Sink;

/// The values of a vertex after its coordinates, by the first word of the file.
struct Kind {
    normal: bool,
    color: bool,
}

impl Kind {
    fn parse(path: &Path, word: &[u8]) -> Result<Option<Self>, IoError> {
        let Some(prefix) = word.strip_suffix(b"OFF") else { return Ok(None) };
        let known = [&b""[..], b"ST", b"C", b"STC", b"N", b"STN", b"CN", b"STCN"];
        if known.contains(&prefix) {
            return Ok(Some(Self { normal: prefix.ends_with(b"N"), color: prefix.contains(&b'C') }));
        }
        if prefix.len() <= 6 && prefix.iter().all(|b| b"STCN4n".contains(b)) {
            let feature =
                format!("{} (vertices of more or fewer than three dimensions)", String::from_utf8_lossy(word));
            return Err(IoError::Unsupported { path: path.to_path_buf(), feature, remedy: "export as plain OFF" });
        }
        Ok(None)
    }
}

/// Reads in world coordinates.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let mut crs = None;
    let mut content = lines(bytes).filter_map(|(at, line)| {
        let (line, comment) =
            line.iter().position(|b| *b == b'#').map_or((line, None), |i| (&line[..i], Some(&line[i + 1..])));
        if let Some(comment) = comment.map(String::from_utf8_lossy) {
            crs = crs.take().or_else(|| comment.trim_start().strip_prefix("crs ").map(str::to_string));
        }
        let line = line.trim_ascii();
        (!line.is_empty()).then_some((at, line))
    });
    let wrong = || IoError::WrongMagic {
        path: path.to_path_buf(),
        expected: "OFF",
        looks: crate::format::sniff(bytes).filter(|looks| *looks != "OFF"),
    };
    let (at, first) = content.next().ok_or_else(wrong)?;
    let mut words = tokens(first);
    let Some(kind) = Kind::parse(path, words.next().unwrap_or_default())? else {
        let short = first.len() < 3 && b"OFF".starts_with(first);
        return Err(if short { IoError::truncated(path, "header", 3, first.len() as u64) } else { wrong() });
    };
    // The counts follow on the next line, or on the same.
    let mut rest: Vec<&[u8]> = words.collect();
    let mut counts_at = at;
    if rest.first() == Some(&&b"BINARY"[..]) {
        let (path, feature) = (path.to_path_buf(), "binary OFF".into());
        return Err(IoError::Unsupported { path, feature, remedy: "export as text" });
    }
    if rest.is_empty() {
        let (at, line) = content.next().ok_or_else(|| IoError::truncated(path, "header", 6, first.len() as u64))?;
        counts_at = at;
        rest = tokens(line).collect();
    }
    let count = |i: usize| {
        let value = integer(path, counts_at, rest.get(i).copied())?;
        u64::try_from(value).map_err(|_| IoError::damaged(path, format!("line {counts_at} states a count of {value}")))
    };
    let (vertex_count, face_count) = (count(0)?, count(1)?);

    let lying = |items, declared, found: usize| IoError::CountMismatch {
        path: path.to_path_buf(),
        items,
        declared,
        found: found as u64,
    };
    // The shortest vertex is `0 0 0` and a line's end: a count that lies reserves nothing.
    let room = bytes.len() / 6 + 1;
    let capacity = usize::try_from(vertex_count).unwrap_or(usize::MAX).min(room);
    let mut vertices = Vec::with_capacity(capacity);
    let mut colors = Vec::with_capacity(if kind.color { capacity } else { 0 });
    for i in 0..vertex_count {
        let (at, line) = content.next().ok_or_else(|| lying("vertices", vertex_count, i as usize))?;
        let mut words = tokens(line);
        vertices.push([
            number(path, at, words.next())?,
            number(path, at, words.next())?,
            number(path, at, words.next())?,
        ]);
        if kind.normal {
            words.by_ref().take(3).for_each(drop);
        }
        if kind.color {
            let mut channel = || number(path, at, words.next()).map(|v| v as f32);
            colors.push([channel()?, channel()?, channel()?]);
        }
    }
    let mut polygons = Polygons::default();
    for i in 0..face_count {
        let (at, line) = content.next().ok_or_else(|| lying("faces", face_count, i as usize))?;
        let mut words = tokens(line);
        let corners = integer(path, at, words.next())?;
        for _ in 0..corners {
            polygons.corner(integer(path, at, words.next())?);
        }
        polygons.close();
    }
    drop(content);
    let colors = (kind.color && !colors.is_empty()).then(|| {
        // Whole numbers are of 255, shares have a point: a mesh of pure black and white can only be told by that.
        if colors.iter().flatten().any(|v| *v > 1.0) { colors_from_values(&colors) } else { shares_to_colors(&colors) }
    });
    let triangles = polygons.into_triangles(path, vertices.len())?;
    Ok(Mesh { vertices, triangles, attributes: Attributes { colors, ..Attributes::default() }, crs, ..Mesh::default() })
}

/// Lines that are gathered before they go out.
const RUN: usize = 1 << 12;

/// Writes world coordinates; colours make it COFF.
pub(super) fn write(sink: &mut dyn Sink, mesh: &Mesh, options: &WriteOptions) -> std::io::Result<()> {
    let colors = mesh.attributes.colors.as_deref();
    writeln!(sink, "{}", if colors.is_some() { "COFF" } else { "OFF" })?;
    for line in options.comment_lines(mesh.crs.as_deref()) {
        writeln!(sink, "# {line}")?;
    }
    writeln!(sink, "{} {} 0", mesh.vertices.len(), mesh.triangles.len())?;
    let decimals = decimals_for(tolerance(options, &mesh.vertices));
    let mut run = Vec::with_capacity(64 * RUN);
    for (start, vertices) in mesh.vertices.chunks(RUN).enumerate() {
        run.clear();
        for (i, vertex) in (start * RUN..).zip(vertices) {
            for (axis, coordinate) in world(*vertex, mesh.world_from_local).into_iter().enumerate() {
                if axis > 0 {
                    run.push(b' ');
                }
                push_fixed(&mut run, coordinate, decimals);
            }
            if let Some(colors) = colors {
                for channel in colors[i].into_iter().chain([255]) {
                    run.push(b' ');
                    push_integer(&mut run, u64::from(channel));
                }
            }
            run.push(b'\n');
        }
        sink.write_all(&run)?;
    }
    for triangles in mesh.triangles.chunks(RUN) {
        run.clear();
        for triangle in triangles {
            run.push(b'3');
            for corner in triangle {
                run.push(b' ');
                push_integer(&mut run, u64::from(*corner));
            }
            run.push(b'\n');
        }
        sink.write_all(&run)?;
    }
    Ok(())
}
