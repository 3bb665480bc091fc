//! Meshes measured against closed forms.

mod cluster;
mod compare;
mod components;
mod creases;
mod intersections;
mod simplify;
mod topology;

use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A mesh from lists.
pub(super) fn mesh(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Mesh {
    Mesh { vertices: vertices.to_vec(), triangles: triangles.to_vec(), ..Mesh::default() }
}

/// The mesh with every vertex mapped.
pub(super) fn mapped(mesh: &Mesh, map: impl Fn(Vec3) -> Vec3) -> Mesh {
    Mesh { vertices: mesh.vertices.iter().map(|&v| map(v)).collect(), ..mesh.clone() }
}

/// The mesh moved.
pub(super) fn moved(mesh: &Mesh, by: Vec3) -> Mesh {
    mapped(mesh, |v| vec3::add(v, by))
}

/// The mesh turned inside out.
pub(super) fn turned_over(mesh: &Mesh) -> Mesh {
    Mesh { triangles: mesh.triangles.iter().map(|&[a, b, c]| [a, c, b]).collect(), ..mesh.clone() }
}

/// Several meshes as one, without welding.
pub(super) fn together(parts: &[Mesh]) -> Mesh {
    let mut all = Mesh::default();
    for part in parts {
        let base = all.vertices.len() as u32;
        all.vertices.extend_from_slice(&part.vertices);
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| v + base)));
    }
    all
}

/// A square sheet of n x n cells of two triangles, side 1, at z = 0, facing up.
pub(super) fn sheet(n: u32) -> Mesh {
    let at = |i: u32, j: u32| i * (n + 1) + j;
    let mut sheet = Mesh::default();
    for i in 0..=n {
        for j in 0..=n {
            sheet.vertices.push([f64::from(i) / f64::from(n), f64::from(j) / f64::from(n), 0.0]);
            if i < n && j < n {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                sheet.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    sheet
}
