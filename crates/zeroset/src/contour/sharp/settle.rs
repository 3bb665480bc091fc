//! Lets the loose vertices settle until the triangles face the way that their sheets do.

use rayon::prelude::*;

use super::Seat;
use super::insert::Inserted;
use super::stars::Fans;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// Rounds of settling.
const ROUNDS: usize = 8;

/// Moves each loose vertex across the mean plane of its triangles: each is turned to face the way its sheet does, about its own middle.
///
/// Sheets are smoother than the vertices that F gives, as their normals are means over many. Vertices on planes, creases and the rim stay.
///
/// Source: the vertex update of two-step mesh denoising, Sun et al. 2007.
/// Unless `everywhere`, only beside those.
pub(super) fn settle(mesh: &mut Mesh, fans: &Fans, inserted: &Inserted, everywhere: bool) {
    let is_loose = |v: u32| inserted.seats[v as usize] == Seat::Loose;
    let is_free = |v: u32| matches!(inserted.seats[v as usize], Seat::Loose | Seat::Held);
    let may =
        |&v: &u32| is_loose(v) && (everywhere || is_beside(mesh, fans.of(v), is_free)) && !is_rim(mesh, fans.of(v), v);
    let loose: Vec<u32> = (0..mesh.vertices.len() as u32).into_par_iter().filter(may).collect();
    for _ in 0..ROUNDS {
        let old = &mesh.vertices;
        let moved: Vec<Vec3> = loose
            .par_iter()
            .map(|&v| {
                let p = old[v as usize];
                let star = fans.of(v);
                let sum = star.iter().fold([0.0; 3], |sum, &t| {
                    let facing = inserted.facing[t as usize].map(f64::from);
                    let [a, b, c] = mesh.triangles[t as usize].map(|u| old[u as usize]);
                    let middle = vec3::scale(vec3::add(a, vec3::add(b, c)), 1.0 / 3.0);
                    vec3::add_scaled(sum, facing, vec3::dot(facing, vec3::sub(middle, p)))
                });
                vec3::add_scaled(p, sum, 1.0 / star.len().max(1) as f64)
            })
            .collect();
        for (&v, p) in loose.iter().zip(moved) {
            mesh.vertices[v as usize] = p;
        }
    }
}

/// Whether some of the triangles has a corner that is not loose.
fn is_beside(mesh: &Mesh, fan: &[u32], is_loose: impl Fn(u32) -> bool) -> bool {
    fan.iter().flat_map(|&t| mesh.triangles[t as usize]).any(|v| !is_loose(v))
}

/// Whether the triangles round a vertex leave a gap: then some vertex follows it that none goes before.
pub(super) fn is_rim(mesh: &Mesh, fan: &[u32], v: u32) -> bool {
    let sum: i64 = fan
        .iter()
        .map(|&t| {
            let [a, b, c] = mesh.triangles[t as usize];
            let (after, before) = if a == v {
                (b, c)
            } else if b == v {
                (c, a)
            } else {
                (a, b)
            };
            // Around a whole fan each neighbour comes once after and once before.
            i64::from(after) * i64::from(after) - i64::from(before) * i64::from(before)
        })
        .sum();
    sum != 0
}
