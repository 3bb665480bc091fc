//! Reading and writing triangle meshes.

mod glb;
mod obj;
mod off;
mod options;
mod ply;
mod polygons;
mod stl;
pub(crate) mod text;

use std::path::Path;

use zeroset::cloud::{Attributes, choose_offset};
use zeroset::mesh::Mesh;

pub(crate) use obj::joined_lines;
pub use options::{WriteOptions, WriteReport};
pub(crate) use options::{one_line, tolerance, world};
pub(crate) use ply::{Column, write_points as write_ply_points};
pub(crate) use polygons::Polygons;

use crate::input::read_file;
use crate::output::{Sink, write_file};
use crate::{IoError, MeshFormat};

/// Reads a mesh; the suffix tells the format. Polygons are cut into triangles, as a fan around their first vertex.
///
/// GLB is turned so that z is up (the format itself has y up) and its nodes' transforms are applied.
///
/// # Errors
/// Whatever keeps the mesh from being read in full: see [`IoError`].
pub fn read_mesh(path: &Path) -> Result<Mesh, IoError> {
    let format = MeshFormat::from_path(path)?;
    read_mesh_bytes(path, format, &read_file(path)?)
}

/// Reads a mesh from the content of a file. `path` only names it in messages.
///
/// # Errors
/// As [`read_mesh`].
pub fn read_mesh_bytes(path: &Path, format: MeshFormat, bytes: &[u8]) -> Result<Mesh, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    let world = match format {
        MeshFormat::Ply => ply::read(path, bytes)?,
        MeshFormat::Obj => obj::read(path, bytes)?,
        MeshFormat::Stl => stl::read(path, bytes)?,
        MeshFormat::Off => off::read(path, bytes)?,
        MeshFormat::Glb => glb::read(path, bytes)?,
    };
    finish(path, world)
}

/// Takes the offset off a mesh in world coordinates, after the last checks.
fn finish(path: &Path, mut mesh: Mesh) -> Result<Mesh, IoError> {
    if mesh.vertices.is_empty() {
        return Err(IoError::malformed(path, "the file holds no vertices", "check the program that wrote it"));
    }
    check_points(path, "vertex", &mesh.vertices)?;
    crate::cloud::check_size(path, "vertex", &mesh.vertices, 0)?;
    let offset = choose_offset(mesh.vertices.iter().copied());
    for vertex in &mut mesh.vertices {
        for axis in 0..3 {
            vertex[axis] -= offset[axis];
        }
    }
    mesh.world_from_local = offset;
    Ok(mesh)
}

/// Writes a mesh; the suffix tells the format. See [`crate::write_atomically`] for what happens to an old file.
///
/// | format | coordinates | attributes |
/// |---|---|---|
/// | PLY | world, float or double by [`WriteOptions::resolution`] | colours, intensity, class |
/// | OBJ | world, with the digits that this takes | colours, after the coordinates of each vertex |
/// | OFF | world, likewise | colours (as COFF) |
/// | STL | local, float; the offset is in the report | none |
/// | GLB | local, float; the offset is the translation of a node | colours, intensity, class |
///
/// # Errors
/// The mesh is not sound (a coordinate that is not finite, a triangle without its vertex, an attribute of another
/// length), or the file cannot be written.
pub fn write_mesh(path: &Path, mesh: &Mesh, options: &WriteOptions) -> Result<WriteReport, IoError> {
    let format = MeshFormat::from_path(path)?;
    check_mesh(path, mesh)?;
    let write = |fill: &dyn Fn(&mut dyn Sink) -> std::io::Result<()>| write_file(path, |sink| fill(sink));
    let mut report = WriteReport::default();
    report.bytes = match format {
        MeshFormat::Ply => write(&|sink| ply::write(sink, mesh, options))?,
        MeshFormat::Obj => {
            report.leave_out(mesh, &["colors"]);
            write(&|sink| obj::write(sink, mesh, options))?
        }
        MeshFormat::Off => {
            report.leave_out(mesh, &["colors"]);
            write(&|sink| off::write(sink, mesh, options))?
        }
        MeshFormat::Stl => {
            report.leave_out(mesh, &[]);
            report.local_offset = Some(mesh.world_from_local);
            check_stl(path, mesh)?;
            write(&|sink| stl::write(sink, mesh))?
        }
        MeshFormat::Glb => {
            report.local_offset = Some(mesh.world_from_local);
            glb::check(path, mesh)?;
            write(&|sink| glb::write(sink, mesh, options))?
        }
    };
    Ok(report)
}

fn check_stl(path: &Path, mesh: &Mesh) -> Result<(), IoError> {
    if u32::try_from(mesh.triangles.len()).is_err() {
        let what = format!("{} triangles are more than an STL file can count", mesh.triangles.len());
        return Err(IoError::malformed(path, what, "write PLY"));
    }
    Ok(())
}

/// Colours from shares of full brightness, 0 to 1.
fn shares_to_colors(values: &[[f32; 3]]) -> Vec<[u8; 3]> {
    // Some programs write 0 to 255 nevertheless.
    if values.iter().flatten().any(|v| *v > 1.0) {
        return crate::cloud::colors_from_values(values);
    }
    values.iter().map(|color| color.map(|c| (255.0 * c).round() as u8)).collect()
}

fn check_mesh(path: &Path, mesh: &Mesh) -> Result<(), IoError> {
    check_points(path, "vertex", &mesh.vertices)?;
    if !mesh.world_from_local.iter().all(|c| c.is_finite()) {
        return Err(IoError::NonFinite { path: path.to_path_buf(), item: "vertex", index: 0 });
    }
    check_attributes(path, mesh.vertices.len(), &mesh.attributes)?;
    let vertices = mesh.vertices.len() as u64;
    for (face, triangle) in mesh.triangles.iter().enumerate() {
        if let Some(vertex) = triangle.iter().find(|v| u64::from(**v) >= vertices) {
            let (path, face) = (path.to_path_buf(), face as u64);
            return Err(IoError::BadIndex { path, face, vertex: i64::from(*vertex), vertices });
        }
    }
    Ok(())
}

/// Refuses coordinates that are not finite.
pub(crate) fn check_points(path: &Path, item: &'static str, points: &[[f64; 3]]) -> Result<(), IoError> {
    match points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        Some(index) => Err(IoError::NonFinite { path: path.to_path_buf(), item, index: index as u64 }),
        None => Ok(()),
    }
}

/// Refuses attributes of another length than the points.
pub(crate) fn check_attributes(path: &Path, points: usize, attributes: &Attributes) -> Result<(), IoError> {
    let lengths = [
        ("colors", attributes.colors.as_ref().map(Vec::len)),
        ("intensities", attributes.intensities.as_ref().map(Vec::len)),
        ("classes", attributes.classes.as_ref().map(Vec::len)),
    ];
    for (attribute, length) in lengths {
        if let Some(values) = length.filter(|length| *length != points) {
            return Err(IoError::AttributeLength { path: path.to_path_buf(), attribute, values, points });
        }
    }
    Ok(())
}
