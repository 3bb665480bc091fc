//! Whether a file holds points or triangles.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use zeroset::cloud::Cloud;
use zeroset::mesh::Mesh;
use zeroset_io::{CloudFormat, IoError, MeshFormat, ReadReport, read_cloud, read_mesh};

/// Bytes at the start of a PLY file in which its header is looked for.
const LONGEST_HEADER: u64 = 1 << 16;

/// What a file holds.
#[derive(Debug)]
pub(crate) enum CloudOrMesh {
    /// Points, the format, and what reading them found out; nothing of a mesh without triangles.
    Cloud(Cloud, &'static str, Option<ReadReport>),
    /// Triangles, and the format.
    Mesh(Mesh, &'static str),
}

/// The mesh format to read a file in; `None` for clouds. `what` names all kinds of files that are possible, `further` the suffixes of those that are neither.
pub(crate) fn cloud_or_mesh(
    path: &Path,
    what: &'static str,
    further: &[&'static str],
) -> Result<Option<MeshFormat>, IoError> {
    let (cloud, mesh) = (CloudFormat::from_path(path), MeshFormat::from_path(path));
    match (cloud, mesh) {
        (Ok(_), Ok(mesh)) => Ok(has_faces(path)?.then_some(mesh)),
        (Ok(_), Err(_)) => Ok(None),
        (Err(_), Ok(mesh)) => Ok(Some(mesh)),
        (Err(_), Err(mesh)) => Err(unknown(mesh, what, further)),
    }
}

/// Reads a file of a format that [`cloud_or_mesh`] told.
pub(crate) fn read_cloud_or_mesh(path: &Path, format: Option<MeshFormat>) -> Result<CloudOrMesh, IoError> {
    let Some(format) = format else {
        let file = read_cloud(path)?;
        return Ok(CloudOrMesh::Cloud(file.cloud, file.report.format.name(), Some(file.report)));
    };
    let mesh = read_mesh(path)?;
    if !mesh.triangles.is_empty() {
        return Ok(CloudOrMesh::Mesh(mesh, format.name()));
    }
    let Mesh { world_from_local, vertices: points, attributes, crs, .. } = mesh;
    Ok(CloudOrMesh::Cloud(Cloud { world_from_local, points, attributes, crs }, format.name(), None))
}

/// An unknown suffix, with those of all kinds to choose from.
fn unknown(error: IoError, kind: &'static str, further: &[&'static str]) -> IoError {
    let mut known: Vec<&str> = CloudFormat::KNOWN.iter().map(|(suffix, _)| *suffix).collect();
    let meshes = MeshFormat::KNOWN.iter().map(|(suffix, _)| *suffix);
    for suffix in meshes.chain(further.iter().copied()) {
        if !known.contains(&suffix) {
            known.push(suffix);
        }
    }
    match error {
        IoError::UnknownSuffix { path, suffix, .. } => {
            IoError::UnknownSuffix { path, kind, suffix, known: known.join(", ") }
        }
        other => other,
    }
}

/// Whether the header of a PLY file promises faces.
fn has_faces(path: &Path) -> Result<bool, IoError> {
    let mut start = Vec::new();
    let file = File::open(path).map_err(|source| IoError::from_system(path, source))?;
    file.take(LONGEST_HEADER).read_to_end(&mut start).map_err(|source| IoError::from_system(path, source))?;
    let lines = start.split(|b| *b == b'\n').map(<[u8]>::trim_ascii);
    let mut header = lines.take_while(|line| *line != b"end_header");
    Ok(header.any(|line| line.strip_prefix(b"element face ").is_some_and(|count| count.trim_ascii() != b"0")))
}
