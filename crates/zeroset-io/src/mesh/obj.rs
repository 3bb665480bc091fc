//! Wavefront OBJ: vertices, with colours after the coordinates where present, and faces.
//!
//! Everything else (normals, texture coordinates, materials, groups, lines, curves) is passed over.

use std::borrow::Cow;
use std::path::Path;

use zeroset::cloud::Attributes;
use zeroset::mesh::Mesh;

use super::options::{WriteOptions, tolerance, world};
use super::text::{integer, lines, number, tokens};
use super::{Polygons, shares_to_colors};
use crate::IoError;
use crate::number::{decimals_for, push_fixed, push_integer};
use crate::output::Sink;

/// Reads in world coordinates.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    if bytes.iter().take(4096).any(|b| *b == 0) {
        let looks = crate::format::sniff(bytes);
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "OBJ", looks });
    }
    let text = joined_lines(bytes);
    let (mut vertices, mut colors, mut polygons) = (Vec::new(), Vec::new(), Polygons::default());
    let (mut crs, mut known) = (None, 0_u64);
    // Faces may only name vertices that came before, but files with the faces first exist and are clear enough.
    for (at, line) in lines(&text) {
        let mut words = tokens(line);
        match words.next() {
            Some(b"v") => {
                known += 1;
                vertices.push([
                    number(path, at, words.next())?,
                    number(path, at, words.next())?,
                    number(path, at, words.next())?,
                ]);
                // Three more values are a colour; one more, or the first of four, is a weight.
                let rest: Vec<&[u8]> = words.take(4).collect();
                if let Some(channels) = rest.len().checked_sub(3).map(|skip| &rest[skip..]) {
                    let mut color = [0.0; 3];
                    for (to, token) in color.iter_mut().zip(channels) {
                        *to = number(path, at, Some(token))? as f32;
                    }
                    colors.push(color);
                }
            }
            Some(b"f") => {
                known += 1;
                for word in words {
                    let index = word.split(|b| *b == b'/').next();
                    let index = integer(path, at, index)?;
                    // Negative indices count back from the newest vertex.
                    let vertex =
                        if index < 0 { index.saturating_add(vertices.len() as i64) } else { index.saturating_sub(1) };
                    polygons.corner(vertex);
                }
                polygons.close();
            }
            Some(b"#") => {
                let rest = String::from_utf8_lossy(&line[1..]);
                crs = crs.or_else(|| rest.trim_start().strip_prefix("crs ").map(str::to_string));
            }
            Some(b"vn" | b"vt" | b"o" | b"g" | b"s" | b"usemtl" | b"mtllib") => known += 1,
            _ => {}
        }
    }
    if known == 0 {
        let looks = crate::format::sniff(bytes);
        return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "OBJ", looks });
    }
    let colors = (!vertices.is_empty() && colors.len() == vertices.len()).then(|| shares_to_colors(&colors));
    let triangles = polygons.into_triangles(path, vertices.len())?;
    Ok(Mesh { vertices, triangles, attributes: Attributes { colors, ..Attributes::default() }, crs, ..Mesh::default() })
}

/// A backslash at the end of a line joins it with the next.
pub(crate) fn joined_lines(bytes: &[u8]) -> Cow<'_, [u8]> {
    if !bytes.contains(&b'\\') {
        return Cow::Borrowed(bytes);
    }
    let mut out = bytes.to_vec();
    for i in 0..out.len() {
        if out[i] == b'\\' && matches!(out.get(i + 1), Some(b'\r' | b'\n')) {
            out[i] = b' ';
            let pair = out[i + 1] == b'\r' && out.get(i + 2) == Some(&b'\n');
            out[i + 1] = b' ';
            if pair {
                out[i + 2] = b' ';
            }
        }
    }
    Cow::Owned(out)
}

/// Lines that are gathered before they go out.
const RUN: usize = 1 << 12;

/// Writes world coordinates.
pub(super) fn write(sink: &mut dyn Sink, mesh: &Mesh, options: &WriteOptions) -> std::io::Result<()> {
    for line in options.comment_lines(mesh.crs.as_deref()) {
        writeln!(sink, "# {line}")?;
    }
    let decimals = decimals_for(tolerance(options, &mesh.vertices));
    let colors = mesh.attributes.colors.as_deref();
    let mut run = Vec::with_capacity(64 * RUN);
    for (start, vertices) in mesh.vertices.chunks(RUN).enumerate() {
        run.clear();
        for (i, vertex) in (start * RUN..).zip(vertices) {
            run.push(b'v');
            for coordinate in world(*vertex, mesh.world_from_local) {
                run.push(b' ');
                push_fixed(&mut run, coordinate, decimals);
            }
            for channel in colors.iter().flat_map(|colors| colors[i]) {
                run.push(b' ');
                // Four decimals tell all 256 values apart.
                push_fixed(&mut run, f64::from(channel) / 255.0, 4);
            }
            run.push(b'\n');
        }
        sink.write_all(&run)?;
    }
    for triangles in mesh.triangles.chunks(RUN) {
        run.clear();
        for triangle in triangles {
            run.push(b'f');
            for corner in triangle {
                run.push(b' ');
                push_integer(&mut run, u64::from(*corner) + 1);
            }
            run.push(b'\n');
        }
        sink.write_all(&run)?;
    }
    Ok(())
}
