//! Cuts a mesh along a plane.

use rustc_hash::FxHashMap;

use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A half-space: the positions x with `normal . x <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HalfSpace {
    /// Unit normal, which points out of it.
    normal: Vec3,
    offset: f64,
}

/// Keeps the part of a mesh in a half-space and cuts the triangles across its face. Vertices within `snap` of the face are moved onto
/// it, so that no needles are left. The mesh must have no attributes yet.
///
/// O(V + F). A manifold mesh stays manifold.
fn clip(mesh: &mut Mesh, half: HalfSpace, snap: f64) {
    let mut beyond: Vec<f64> = mesh.vertices.iter().map(|v| vec3::dot(half.normal, *v) - half.offset).collect();
    if beyond.iter().all(|b| *b < -snap) {
        return;
    }
    for (v, beyond) in mesh.vertices.iter_mut().zip(&mut beyond) {
        if beyond.abs() <= snap {
            *v = vec3::add_scaled(*v, half.normal, -*beyond);
            *beyond = 0.0;
        }
    }
    let mut crossings: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for corners in std::mem::take(&mut mesh.triangles) {
        let side = corners.map(|v| beyond[v as usize]);
        if side.iter().all(|s| *s <= 0.0) {
            // A triangle in the face itself has been flattened by the snap.
            if side.iter().any(|s| *s < 0.0) {
                triangles.push(corners);
            }
            continue;
        }
        let mut polygon: Vec<u32> = Vec::with_capacity(4);
        for i in 0..3 {
            let [from, to] = [corners[i], corners[(i + 1) % 3]];
            let [here, there] = [side[i], side[(i + 1) % 3]];
            if here <= 0.0 {
                polygon.push(from);
            }
            if here < 0.0 && there > 0.0 || here > 0.0 && there < 0.0 {
                let key = [from.min(to), from.max(to)];
                polygon.push(*crossings.entry(key).or_insert_with(|| {
                    let [low, high] = key.map(|v| v as usize);
                    let t = beyond[low] / (beyond[low] - beyond[high]);
                    mesh.vertices.push(vec3::lerp(mesh.vertices[low], mesh.vertices[high], t));
                    mesh.vertices.len() as u32 - 1
                }));
            }
        }
        for i in 2..polygon.len() {
            triangles.push([polygon[0], polygon[i - 1], polygon[i]]);
        }
    }
    mesh.triangles = triangles;
    drop_unused(mesh);
}

/// Keeps the part of a mesh within a box, seen along some axes.
pub(crate) fn clip_at_box(mesh: &mut Mesh, [low, high]: [Vec3; 2], axes: std::ops::Range<usize>, snap: f64) {
    for axis in axes {
        for (sign, offset) in [(1.0, high[axis]), (-1.0, -low[axis])] {
            let mut normal = [0.0; 3];
            normal[axis] = sign;
            clip(mesh, HalfSpace { normal, offset }, snap);
        }
    }
}

/// Drops vertices without triangles; the others keep their order.
pub(super) fn drop_unused(mesh: &mut Mesh) {
    let mut number = vec![None; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|&v| number[v as usize] = Some(0));
    let mut kept = Vec::with_capacity(mesh.vertices.len());
    for (v, number) in number.iter_mut().enumerate().filter(|(_, number)| number.is_some()) {
        *number = Some(kept.len() as u32);
        kept.push(mesh.vertices[v]);
    }
    mesh.vertices = kept;
    for v in mesh.triangles.iter_mut().flatten() {
        *v = number[*v as usize].expect("a vertex in use is kept");
    }
}
