//! Lets the loose vertices settle until the triangles face the way that their sheets do.

use rayon::prelude::*;

use super::Seat;
use super::insert::Inserted;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// Rounds of settling.
const ROUNDS: usize = 8;

/// Moves each loose vertex across the mean plane of its triangles: each is turned to face the way its sheet does, about its own middle.
///
/// Sheets are smoother than the vertices that F gives, as their normals are means over many. Vertices on planes, creases and the rim stay.
///
/// Source: the vertex update of two-step mesh denoising, Sun et al. 2007.
pub(super) fn settle(mesh: &mut Mesh, inserted: &Inserted) {
    let corners = corners_of(mesh);
    let loose: Vec<u32> = (0..mesh.vertices.len() as u32)
        .filter(|&v| inserted.seats[v as usize] == Seat::Loose && !is_rim(mesh, &corners, v))
        .collect();
    for _ in 0..ROUNDS {
        let old = &mesh.vertices;
        let moved: Vec<Vec3> = loose
            .par_iter()
            .map(|&v| {
                let p = old[v as usize];
                let star = corners.of(v);
                let sum = star.iter().fold([0.0; 3], |sum, &t| {
                    let facing = inserted.facing[t as usize];
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

/// The triangles at each vertex.
struct Corners {
    starts: Vec<u32>,
    triangles: Vec<u32>,
}

impl Corners {
    fn of(&self, v: u32) -> &[u32] {
        &self.triangles[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }
}

fn corners_of(mesh: &Mesh) -> Corners {
    let mut starts = vec![0_u32; mesh.vertices.len() + 1];
    mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize] += 1);
    let mut total = 0;
    for start in &mut starts {
        total += std::mem::replace(start, total);
    }
    let mut places = starts.clone();
    let mut triangles = vec![0_u32; total as usize];
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for &v in corners {
            triangles[places[v as usize] as usize] = t as u32;
            places[v as usize] += 1;
        }
    }
    Corners { starts, triangles }
}

/// Whether the triangles round a vertex leave a gap: then some vertex follows it that none goes before.
fn is_rim(mesh: &Mesh, corners: &Corners, v: u32) -> bool {
    let sum: i64 = corners
        .of(v)
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
