//! Meshes in PLY.

use std::path::Path;

use zeroset::mesh::Mesh;

use super::Polygons;
use super::options::{WriteOptions, single_holds, tolerance, world};
use crate::IoError;
use crate::cloud::ply::vertices;
use crate::output::Sink;
use crate::ply::body::{Body, ListSink};
use crate::ply::header::{Header, Property};

/// Reads in world coordinates.
pub(super) fn read(path: &Path, bytes: &[u8]) -> Result<Mesh, IoError> {
    let header = Header::parse(path, bytes)?;
    let mut body = Body::new(path, bytes, &header);
    let (mut mesh, mut polygons) = (None, Polygons::default());
    for element in &header.elements {
        let corners = element
            .properties
            .iter()
            .position(|p| matches!(p, Property::List { .. }) && matches!(p.name(), "vertex_indices" | "vertex_index"));
        match (element.name.as_str(), corners) {
            ("vertex", _) => {
                let columns = vertices(path, &mut body, element, header.encoding)?;
                let crs = header.comment("crs").map(str::to_string);
                let (vertices, attributes) = (columns.points, columns.attributes);
                mesh = Some(Mesh { vertices, attributes, crs, ..Mesh::default() });
            }
            ("face", Some(corners)) => {
                let count = body.checked_count(element, "faces")?;
                if !body.byte_counted_lists(element, count, "faces", &mut polygons)? {
                    let mut values = Vec::new();
                    for i in 0..count {
                        body.record(element, i, "faces", &mut values, &mut |property, value| {
                            if property == corners {
                                polygons.corner(value as i64);
                            }
                        })?;
                        polygons.close();
                    }
                }
            }
            _ => body.skip(element)?,
        }
    }
    body.end()?;
    let mesh = mesh.ok_or_else(|| {
        IoError::malformed(path, "the PLY header has no `vertex` element", "export a mesh with vertices and faces")
    })?;
    let triangles = polygons.into_triangles(path, mesh.vertices.len())?;
    Ok(Mesh { triangles, ..mesh })
}

impl ListSink for Polygons {
    fn item(&mut self, value: i64) {
        self.corner(value);
    }

    fn end(&mut self) {
        self.close();
    }
}

/// Vertices and triangles that are gathered before they go out.
const RUN: usize = 1 << 12;

/// A value at each vertex beside those of the mesh, with its name.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Column<'a> {
    Int(&'static str, &'a [i32]),
    Byte(&'static str, &'a [u8]),
}

/// Writes binary little endian.
pub(super) fn write(sink: &mut dyn Sink, mesh: &Mesh, options: &WriteOptions) -> std::io::Result<()> {
    let single = write_vertices_header(sink, mesh, options, &[])?;
    writeln!(sink, "element face {}\nproperty list uchar int vertex_indices\nend_header", mesh.triangles.len())?;
    write_vertices(sink, mesh, single, &[])?;
    let mut run = Vec::with_capacity(13 * RUN);
    for triangles in mesh.triangles.chunks(RUN) {
        run.clear();
        for [a, b, c] in triangles {
            run.push(3);
            for corner in [a, b, c] {
                run.extend_from_slice(&corner.to_le_bytes());
            }
        }
        sink.write_all(&run)?;
    }
    Ok(())
}

/// Whether coordinates are single precision.
fn write_vertices_header(
    sink: &mut dyn Sink,
    mesh: &Mesh,
    options: &WriteOptions,
    columns: &[Column<'_>],
) -> std::io::Result<bool> {
    let single = single_holds(&mesh.vertices, mesh.world_from_local, tolerance(options, &mesh.vertices));
    let kind = if single { "float" } else { "double" };
    writeln!(sink, "ply\nformat binary_little_endian 1.0")?;
    for line in options.comment_lines(mesh.crs.as_deref()) {
        writeln!(sink, "comment {line}")?;
    }
    writeln!(sink, "element vertex {}", mesh.vertices.len())?;
    for axis in ["x", "y", "z"] {
        writeln!(sink, "property {kind} {axis}")?;
    }
    if mesh.attributes.colors.is_some() {
        sink.write_all(b"property uchar red\nproperty uchar green\nproperty uchar blue\n")?;
    }
    if mesh.attributes.intensities.is_some() {
        sink.write_all(b"property float intensity\n")?;
    }
    if mesh.attributes.classes.is_some() {
        sink.write_all(b"property uchar classification\n")?;
    }
    for column in columns {
        match column {
            Column::Int(name, _) => writeln!(sink, "property int {name}")?,
            Column::Byte(name, _) => writeln!(sink, "property uchar {name}")?,
        }
    }
    Ok(single)
}

fn write_vertices(sink: &mut dyn Sink, mesh: &Mesh, single: bool, columns: &[Column<'_>]) -> std::io::Result<()> {
    let attributes = &mesh.attributes;
    let mut run = Vec::with_capacity(32 * RUN);
    for (start, vertices) in mesh.vertices.chunks(RUN).enumerate() {
        run.clear();
        for (i, vertex) in (start * RUN..).zip(vertices) {
            for coordinate in world(*vertex, mesh.world_from_local) {
                if single {
                    run.extend_from_slice(&(coordinate as f32).to_le_bytes());
                } else {
                    run.extend_from_slice(&coordinate.to_le_bytes());
                }
            }
            if let Some(colors) = &attributes.colors {
                run.extend_from_slice(&colors[i]);
            }
            if let Some(intensities) = &attributes.intensities {
                run.extend_from_slice(&intensities[i].to_le_bytes());
            }
            if let Some(classes) = &attributes.classes {
                run.push(classes[i]);
            }
            for column in columns {
                match column {
                    Column::Int(_, values) => run.extend_from_slice(&values[i].to_le_bytes()),
                    Column::Byte(_, values) => run.push(values[i]),
                }
            }
        }
        sink.write_all(&run)?;
    }
    Ok(())
}

/// Writes the vertices alone, a cloud, with further columns.
pub(crate) fn write_points(
    sink: &mut dyn Sink,
    mesh: &Mesh,
    options: &WriteOptions,
    columns: &[Column<'_>],
) -> std::io::Result<()> {
    let single = write_vertices_header(sink, mesh, options, columns)?;
    sink.write_all(b"end_header\n")?;
    write_vertices(sink, mesh, single, columns)
}
