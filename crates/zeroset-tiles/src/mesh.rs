//! The surface of a tile as a file between steps.

use std::path::Path;

use zeroset::cloud::Attributes;
use zeroset::mesh::Mesh;
use zeroset::tile::TileMesh;

use crate::TilesError;
use crate::binary::{In, Out, read};

pub(crate) fn write_tile_mesh(path: &Path, tile: &TileMesh) -> Result<(), TilesError> {
    let mut out = Out::default();
    let TileMesh { mesh, shared } = tile;
    out.value(mesh.world_from_local);
    out.list(&mesh.vertices);
    out.list(&mesh.triangles);
    out.option(mesh.attributes.colors.as_ref());
    out.option(mesh.attributes.intensities.as_ref());
    out.option(mesh.attributes.classes.as_ref());
    out.list(&shared.iter().map(|(v, _)| *v).collect::<Vec<u32>>());
    out.list(&shared.iter().map(|(_, key)| *key).collect::<Vec<[u64; 3]>>());
    out.write(path)
}

pub(crate) fn read_tile_mesh(path: &Path) -> Result<TileMesh, TilesError> {
    let bytes = read(path)?;
    parse(&bytes).ok_or_else(|| TilesError::damaged(path))
}

fn parse(bytes: &[u8]) -> Option<TileMesh> {
    let mut rest = In::new(bytes);
    let world_from_local = rest.value()?;
    let (vertices, triangles) = (rest.list::<[f64; 3]>()?, rest.list::<[u32; 3]>()?);
    let attributes = Attributes { colors: rest.option()?, intensities: rest.option()?, classes: rest.option()? };
    let shared: Vec<(u32, [u64; 3])> = rest.list::<u32>()?.into_iter().zip(rest.list::<[u64; 3]>()?).collect();
    let is_there = |v: u32| (v as usize) < vertices.len();
    let is_sound = triangles.iter().flatten().all(|&v| is_there(v)) && shared.iter().all(|(v, _)| is_there(*v));
    if !is_sound || !rest.is_at_end() {
        return None;
    }
    Some(TileMesh { mesh: Mesh { vertices, triangles, attributes, world_from_local, crs: None }, shared })
}
