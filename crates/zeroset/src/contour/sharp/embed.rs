//! Takes vertices back towards F where triangles cut through each other.
//!
//! The surface of F does not meet itself, and each vertex has its place there. So going back far enough helps; the surface is a little
//! rounder there, but stays embedded.

use rayon::prelude::*;

use crate::mesh::{Mesh, self_intersections_with};
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Triangles with an inserted vertex, or one that moved farther than this, in cells, are looked at.
const MOVED: f64 = 0.2;
/// Rings of triangles around these that are, too.
const RINGS: usize = 2;
/// Rounds of taking back.
const ROUNDS: usize = 20;
/// How far triangles may be from those that changed and still be met by them, in cells.
const REACH: f64 = 1.5;
/// The first time a vertex goes half the way, the next time the whole.
const SHARES: [f64; 2] = [0.5, 1.0];

/// Takes vertices back until no triangles that moved cut through each other or have no area, with coordinates in single precision as
/// files hold them; the number of vertices taken back, and of pairs that are left.
///
/// The vertices from `inserted` on were put in; `origins` are the places on F.
pub(super) fn embed(mesh: &mut Mesh, inserted: usize, origins: &[Vec3], cell: f64) -> (usize, u64) {
    let has_moved =
        |v: usize| v >= inserted || vec3::distance_squared(mesh.vertices[v], origins[v]) > (MOVED * cell).powi(2);
    let mut is_near: Vec<bool> = (0..mesh.vertices.len()).into_par_iter().map(has_moved).collect();
    for _ in 0..RINGS {
        let touches = |corners: &&[u32; 3]| corners.iter().any(|&v| is_near[v as usize]);
        let beside: Vec<u32> = mesh.triangles.par_iter().filter(touches).flatten().copied().collect();
        beside.into_iter().for_each(|v| is_near[v as usize] = true);
    }
    let triangles: Vec<[u32; 3]> =
        mesh.triangles.par_iter().copied().filter(|corners| corners.iter().any(|&v| is_near[v as usize])).collect();
    let rounded = |v: Vec3| v.map(|c| f64::from(c as f32));
    let vertices = mesh.vertices.par_iter().map(|&v| rounded(v)).collect();
    let mut part = Mesh { vertices, triangles, ..Mesh::default() };
    let tree = TriangleTree::new(&part);
    let all = part.triangles.clone();
    let mut times = vec![0_u8; part.vertices.len()];
    let mut pairs = 0;
    for round in 0..=ROUNDS {
        let own = (round > 0).then(|| TriangleTree::new(&part));
        let found = self_intersections_with(&part, own.as_ref().unwrap_or(&tree), usize::MAX, &());
        let found = found.expect("no one cancels");
        let flat: Vec<u32> = part.triangles.par_iter().filter(|t| is_flat(&part, t)).flatten().copied().collect();
        pairs = found.pairs;
        if pairs == 0 && flat.is_empty() || round == ROUNDS {
            break;
        }
        let mut vertices: Vec<u32> = found.listed.iter().flatten().flat_map(|&t| part.triangles[t as usize]).collect();
        vertices.extend(flat);
        vertices.sort_unstable();
        vertices.dedup();
        if vertices.iter().all(|&v| usize::from(times[v as usize]) == SHARES.len()) {
            // All of them are on F: their neighbours stand in the way.
            let is_near = |corners: &&[u32; 3]| corners.iter().any(|v| vertices.binary_search(v).is_ok());
            vertices = part.triangles.iter().filter(is_near).flatten().copied().collect();
            vertices.sort_unstable();
            vertices.dedup();
        }
        let mut goes_on = false;
        for &v in &vertices {
            let v = v as usize;
            if let Some(share) = SHARES.get(usize::from(times[v])) {
                mesh.vertices[v] = vec3::lerp(mesh.vertices[v], origins[v], *share);
                part.vertices[v] = rounded(mesh.vertices[v]);
                times[v] += 1;
                goes_on = true;
            }
        }
        if !goes_on {
            break;
        }
        let mut near: Vec<u32> = Vec::new();
        for &v in &vertices {
            let p = part.vertices[v as usize];
            let reach = [REACH * cell; 3];
            tree.visit_meeting(vec3::sub(p, reach), vec3::add(p, reach), &mut |t| near.push(t as u32));
        }
        near.sort_unstable();
        near.dedup();
        part.triangles = near.into_iter().map(|t| all[t as usize]).collect();
    }
    (times.iter().filter(|&&times| times > 0).count(), pairs)
}

/// Whether a triangle has no area.
fn is_flat(mesh: &Mesh, corners: &[u32; 3]) -> bool {
    let [a, b, c] = corners.map(|v| mesh.vertices[v as usize]);
    vec3::cross(vec3::sub(b, a), vec3::sub(c, a)) == [0.0; 3]
}
