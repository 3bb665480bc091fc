//! The mesh edges that cross a crease.

use rayon::prelude::*;

use super::Seat;
use super::sheets::Sheets;
use crate::mesh::Mesh;
use crate::vec3;

/// Edges between vertices of creases that turn by less, in degrees, cross a face.
const LEAST_ANGLE: f64 = 5.0;

/// A mesh edge whose ends are on different sheets.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Crossing {
    /// The ends, the lower first.
    pub(super) ends: [u32; 2],
    /// The sides of triangles that are this edge: side i of triangle t, from its corner i to the next, is 3 t + i. The second is that of a rim
    /// twice.
    pub(super) sides: [u32; 2],
}

/// The mesh edges that cross a crease, by their ends.
pub(super) fn crossings(mesh: &Mesh, sheets: &Sheets) -> Vec<Crossing> {
    let mut all: Vec<Crossing> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(t, corners)| {
            (0..3).filter_map(move |i| {
                let (a, b) = (corners[i], corners[(i + 1) % 3]);
                let side = (3 * t + i) as u32;
                sheets.meet(a, b).then(|| Crossing { ends: [a.min(b), a.max(b)], sides: [side; 2] })
            })
        })
        .collect();
    all.par_sort_unstable();
    // The mesh is a manifold: an edge has at most two sides.
    all.dedup_by(|next, kept| {
        let same = next.ends == kept.ends;
        if same {
            kept.sides[1] = next.sides[1];
        }
        same
    });
    all
}

/// The length of the mesh edges that run along creases, and the mean angle in degrees by which the surface turns there, weighted by length.
pub(super) fn measure(mesh: &Mesh, seats: &[Seat]) -> (f64, Option<f64>) {
    let is_on = |v: u32| matches!(seats[v as usize], Seat::Along(..) | Seat::At);
    let mut sides: Vec<([u32; 2], u32)> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(t, corners)| {
            let sides = (0..3).map(move |i| [corners[i], corners[(i + 1) % 3]]);
            sides.filter(|ends| ends.iter().all(|&v| is_on(v))).map(move |[a, b]| ([a.min(b), a.max(b)], t as u32))
        })
        .collect();
    sides.par_sort_unstable();
    let normal = |t: u32| {
        let [a, b, c] = mesh.triangles[t as usize].map(|v| mesh.vertices[v as usize]);
        vec3::cross(vec3::sub(b, a), vec3::sub(c, a))
    };
    let (mut length, mut sum) = (0.0, 0.0);
    for pair in sides.chunk_by(|a, b| a.0 == b.0) {
        let &[([a, b], s), (_, t)] = pair else { continue };
        let (m, n) = (normal(s), normal(t));
        let angle = vec3::norm(vec3::cross(m, n)).atan2(vec3::dot(m, n)).to_degrees();
        let own = vec3::distance(mesh.vertices[a as usize], mesh.vertices[b as usize]);
        if angle > LEAST_ANGLE {
            length += own;
            sum += own * angle;
        }
    }
    (length, (length > 0.0).then(|| sum / length))
}
