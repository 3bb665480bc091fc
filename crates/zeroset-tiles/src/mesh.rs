//! The surface of a tile, or of a square of them, as a file between steps.

use std::path::Path;

use zeroset::cloud::Attributes;
use zeroset::mesh::Mesh;
use zeroset::tile::{LevelMesh, Shared, TileMesh};

use crate::TilesError;
use crate::binary::{In, Out, read};

/// What shared vertices are called.
type Key = [u64; 3];

pub(crate) fn write_tile_mesh(path: &Path, tile: &TileMesh) -> Result<(), TilesError> {
    let mut out = Out::default();
    put_mesh(&mut out, &tile.mesh);
    out.list(&tile.shared.iter().map(|(v, _)| *v).collect::<Vec<u32>>());
    out.list(&tile.shared.iter().map(|(_, key)| *key).collect::<Vec<Key>>());
    out.write(path)
}

pub(crate) fn read_tile_mesh(path: &Path) -> Result<TileMesh, TilesError> {
    let parse = |rest: &mut In<'_>| {
        let mesh = get_mesh(rest)?;
        let shared: Vec<(u32, Key)> = rest.list::<u32>()?.into_iter().zip(rest.list::<Key>()?).collect();
        let is_sound = shared.iter().all(|(v, _)| (*v as usize) < mesh.vertices.len());
        is_sound.then_some(TileMesh { mesh, shared })
    };
    parsed(path, parse)
}

pub(crate) fn write_level_mesh(path: &Path, level: &LevelMesh) -> Result<(), TilesError> {
    let mut out = Out::default();
    put_mesh(&mut out, &level.mesh);
    out.list(&level.shared.iter().map(|s| s.vertex).collect::<Vec<u32>>());
    out.list(&level.shared.iter().map(|s| s.key).collect::<Vec<Key>>());
    out.list(&level.shared.iter().map(|s| s.tiles).collect::<Vec<[u32; 2]>>());
    out.value(level.error);
    out.write(path)
}

pub(crate) fn read_level_mesh(path: &Path) -> Result<LevelMesh, TilesError> {
    let parse = |rest: &mut In<'_>| {
        let mesh = get_mesh(rest)?;
        let (vertices, keys, tiles) = (rest.list::<u32>()?, rest.list::<Key>()?, rest.list::<[u32; 2]>()?);
        let together = vertices.into_iter().zip(keys).zip(tiles);
        let shared: Vec<Shared> = together.map(|((vertex, key), tiles)| Shared { vertex, key, tiles }).collect();
        let error = rest.value()?;
        let is_sound = shared.iter().all(|s| (s.vertex as usize) < mesh.vertices.len());
        is_sound.then_some(LevelMesh { mesh, shared, error })
    };
    parsed(path, parse)
}

fn parsed<T>(path: &Path, parse: impl FnOnce(&mut In<'_>) -> Option<T>) -> Result<T, TilesError> {
    let bytes = read(path)?;
    let mut rest = In::new(&bytes);
    parse(&mut rest).filter(|_| rest.is_at_end()).ok_or_else(|| TilesError::damaged(path))
}

fn put_mesh(out: &mut Out, mesh: &Mesh) {
    out.value(mesh.world_from_local);
    out.list(&mesh.vertices);
    out.list(&mesh.triangles);
    out.option(mesh.attributes.colors.as_ref());
    out.option(mesh.attributes.intensities.as_ref());
    out.option(mesh.attributes.classes.as_ref());
}

fn get_mesh(rest: &mut In<'_>) -> Option<Mesh> {
    let world_from_local = rest.value()?;
    let (vertices, triangles) = (rest.list::<[f64; 3]>()?, rest.list::<[u32; 3]>()?);
    let attributes = Attributes { colors: rest.option()?, intensities: rest.option()?, classes: rest.option()? };
    let is_sound = triangles.iter().flatten().all(|&v| (v as usize) < vertices.len());
    is_sound.then_some(Mesh { vertices, triangles, attributes, world_from_local, crs: None })
}
