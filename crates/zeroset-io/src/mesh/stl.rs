//! Stereolithography: loose triangles, in binary or text.
//!
//! Corners with the same coordinates become one vertex, and triangles with two equal corners are passed over. The same
//! are coordinates that single precision could not tell apart at the largest coordinate of that axis: programs write
//! zeros as -2.7e-16 here and as 0 there. Everything else stays apart, and no vertex moves. Normals are not read: the
//! order of the corners says the same.

use std::path::Path;

use rustc_hash::FxHashMap;
use zeroset::mesh::Mesh;

use super::text::{lines, number, tokens};
use crate::IoError;
use crate::output::Sink;

const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Reads in world coordinates.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let count = bytes.get(80..HEADER).map(|b| u64::from(u32::from_le_bytes([b[0], b[1], b[2], b[3]])));
    let body = bytes.len().saturating_sub(HEADER) as u64;
    let exact = count.is_some_and(|count| count * TRIANGLE as u64 == body);
    let text = bytes.trim_ascii_start();
    // Binary files may start with "solid" too; only their length gives them away.
    if !exact && text.starts_with(b"solid") && !text.iter().take(4096).any(|b| *b == 0) {
        return read_text(path, text);
    }
    let Some(count) = count else {
        let cut = b"solid".starts_with(text) || text.starts_with(b"solid");
        return Err(if cut || bytes.contains(&0) {
            IoError::truncated(path, "header", HEADER as u64, bytes.len() as u64)
        } else {
            IoError::WrongMagic { path: path.to_path_buf(), expected: "STL", looks: crate::format::sniff(bytes) }
        });
    };
    if count * TRIANGLE as u64 > body {
        // A header of readable text without the word `solid` is more likely another format than a lie.
        if let Some(looks) = crate::format::sniff(bytes).filter(|looks| *looks != "ASCII STL") {
            return Err(IoError::WrongMagic { path: path.to_path_buf(), expected: "STL", looks: Some(looks) });
        }
        let found = body / TRIANGLE as u64;
        return Err(IoError::CountMismatch { path: path.to_path_buf(), items: "triangles", declared: count, found });
    }
    let records = bytes[HEADER..].chunks_exact(TRIANGLE).take(count as usize);
    let triangles = records.map(|record| {
        std::array::from_fn(|corner| {
            std::array::from_fn(|axis| {
                let at = 12 + 12 * corner + 4 * axis;
                f64::from(f32::from_le_bytes([record[at], record[at + 1], record[at + 2], record[at + 3]]))
            })
        })
    });
    Ok(weld(&triangles.collect::<Vec<_>>()))
}

fn read_text(path: &Path, text: &[u8]) -> Result<Mesh, IoError> {
    let mut triangles = Vec::new();
    let (mut corners, mut last) = (Vec::with_capacity(3), 0);
    for (at, line) in lines(text) {
        last = at;
        let mut words = tokens(line);
        match words.next().unwrap_or_default() {
            b"vertex" => corners.push([
                number(path, at, words.next())?,
                number(path, at, words.next())?,
                number(path, at, words.next())?,
            ]),
            b"endloop" => {
                let [a, b, c] = corners[..] else {
                    let what = format!("line {at}: a facet has {} corners", corners.len());
                    return Err(IoError::damaged(path, what));
                };
                triangles.push([a, b, c]);
                corners.clear();
            }
            _ => {}
        }
    }
    if !corners.is_empty() {
        return Err(IoError::damaged(path, format!("the text ends in line {last}, within a facet")));
    }
    Ok(weld(&triangles))
}

/// Joins equal corners; vertices are in the order of their first use.
fn weld(triangles: &[[[f64; 3]; 3]]) -> Mesh {
    let mut largest = [0.0_f64; 3];
    for corner in triangles.iter().flatten() {
        for axis in 0..3 {
            largest[axis] = largest[axis].max(corner[axis].abs());
        }
    }
    // A quarter of the distance of neighbouring f32 numbers at the largest coordinate.
    let cells_per_unit = largest.map(|largest| if largest > 0.0 { 2_f64.powi(26) / largest } else { 1.0 });
    let mut mesh = Mesh::default();
    let mut known: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    known.reserve(triangles.len() / 2);
    mesh.triangles.reserve(triangles.len());
    for corners in triangles {
        let [a, b, c] = corners.map(|position| {
            // Adding zero makes -0 and 0 the same. Not a cast: NaN must not become a place.
            let key = std::array::from_fn(|axis| ((position[axis] * cells_per_unit[axis]).round() + 0.0).to_bits());
            let next = mesh.vertices.len() as u32;
            let index = *known.entry(key).or_insert(next);
            if index == next {
                mesh.vertices.push(position.map(|c| c + 0.0));
            }
            index
        });
        if a != b && b != c && c != a {
            mesh.triangles.push([a, b, c]);
        }
    }
    mesh
}

/// Writes local coordinates in binary.
pub(super) fn write(sink: &mut dyn Sink, mesh: &Mesh) -> std::io::Result<()> {
    const RUN: usize = 1 << 12;
    // A text that does not start with "solid", which would announce the other kind.
    let mut header = [0; HEADER];
    header[..31].copy_from_slice(b"binary stl, counter-clockwise  ");
    header[80..].copy_from_slice(&(mesh.triangles.len() as u32).to_le_bytes());
    sink.write_all(&header)?;
    let mut run = Vec::with_capacity(TRIANGLE * RUN);
    for triangles in mesh.triangles.chunks(RUN) {
        run.clear();
        for triangle in triangles {
            let corners = triangle.map(|v| mesh.vertices[v as usize]);
            for vector in std::iter::once(normal(corners)).chain(corners) {
                for coordinate in vector {
                    run.extend_from_slice(&(coordinate as f32).to_le_bytes());
                }
            }
            run.extend_from_slice(&[0; 2]);
        }
        sink.write_all(&run)?;
    }
    Ok(())
}

/// Unit normal; zero for a triangle without area, which the format allows.
fn normal([a, b, c]: [[f64; 3]; 3]) -> [f64; 3] {
    let difference = |p: [f64; 3]| [p[0] - a[0], p[1] - a[1], p[2] - a[2]];
    let (u, v) = (difference(b), difference(c));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let length = (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt();
    if length > 0.0 { n.map(|c| c / length) } else { [0.0; 3] }
}
