//! Cuts a mesh along a plane.

use rustc_hash::FxHashMap;

use super::seam::Seam;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A half-space: the positions x with `normal . x <= offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
struct HalfSpace {
    /// Unit normal, which points out of it.
    normal: Vec3,
    offset: f64,
}

/// What a cut did to a mesh.
pub(super) struct Cut {
    /// For each triangle the one that it is part of.
    pub(super) source: Vec<u32>,
    /// Vertices before the cut.
    pub(super) first: usize,
    /// The ends of the edge on which each new vertex lies; these are numbered from `first` on.
    pub(super) crossings: Vec<[u32; 2]>,
    /// The number that each vertex had before those without triangles were dropped.
    pub(super) kept: Vec<u32>,
}

/// Keeps the part of a mesh in a half-space and cuts the triangles across its face. Vertices within `snap` of the face are moved onto
/// it, so that no needles are left. The mesh must have no attributes yet.
///
/// O(V + F). A manifold mesh stays manifold. Where an edge is cut does not depend on how vertices are numbered. `None` if nothing changes.
fn clip(mesh: &mut Mesh, half: HalfSpace, snap: f64) -> Option<Cut> {
    let mut beyond: Vec<f64> = mesh.vertices.iter().map(|v| vec3::dot(half.normal, *v) - half.offset).collect();
    if beyond.iter().all(|b| *b < -snap) {
        return None;
    }
    let first = mesh.vertices.len();
    for (v, beyond) in mesh.vertices.iter_mut().zip(&mut beyond) {
        if beyond.abs() <= snap {
            *v = vec3::add_scaled(*v, half.normal, -*beyond);
            *beyond = 0.0;
        }
    }
    let mut numbers: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let (mut crossings, mut source) = (Vec::new(), Vec::with_capacity(mesh.triangles.len()));
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    for (t, corners) in std::mem::take(&mut mesh.triangles).into_iter().enumerate() {
        let side = corners.map(|v| beyond[v as usize]);
        if side.iter().all(|s| *s <= 0.0) {
            // A triangle in the face itself has been flattened by the snap.
            if side.iter().any(|s| *s < 0.0) {
                triangles.push(corners);
                source.push(t as u32);
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
                polygon.push(*numbers.entry(key).or_insert_with(|| {
                    // From within outward.
                    let [inner, outer] = if here < 0.0 { [from, to] } else { [to, from] }.map(|v| v as usize);
                    let t = beyond[inner] / (beyond[inner] - beyond[outer]);
                    mesh.vertices.push(vec3::lerp(mesh.vertices[inner], mesh.vertices[outer], t));
                    crossings.push(key);
                    mesh.vertices.len() as u32 - 1
                }));
            }
        }
        for i in 2..polygon.len() {
            triangles.push([polygon[0], polygon[i - 1], polygon[i]]);
            source.push(t as u32);
        }
    }
    mesh.triangles = triangles;
    let kept = drop_unused(mesh);
    Some(Cut { source, first, crossings, kept })
}

/// Keeps the part of a mesh within a box, seen along some axes; a seam follows.
pub(crate) fn clip_at_box(
    mesh: &mut Mesh,
    [low, high]: [Vec3; 2],
    axes: std::ops::Range<usize>,
    snap: f64,
    mut seam: Option<&mut Seam>,
) {
    for axis in axes {
        for (sign, offset) in [(1.0, high[axis]), (-1.0, -low[axis])] {
            let mut normal = [0.0; 3];
            normal[axis] = sign;
            let cut = clip(mesh, HalfSpace { normal, offset }, snap);
            if let (Some(seam), Some(cut)) = (seam.as_deref_mut(), cut) {
                seam.follow(&cut, mesh);
            }
        }
    }
}

/// Drops vertices without triangles; the others keep their order. For each of these the number that it had.
pub(super) fn drop_unused(mesh: &mut Mesh) -> Vec<u32> {
    let mut number = vec![u32::MAX; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|&v| number[v as usize] = 0);
    let kept: Vec<u32> = (0..number.len() as u32).filter(|&v| number[v as usize] == 0).collect();
    kept.iter().enumerate().for_each(|(new, &old)| number[old as usize] = new as u32);
    mesh.vertices = kept.iter().map(|&v| mesh.vertices[v as usize]).collect();
    for v in mesh.triangles.iter_mut().flatten() {
        *v = number[*v as usize];
    }
    kept
}
