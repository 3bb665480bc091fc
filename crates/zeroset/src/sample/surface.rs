//! Points spread over a mesh by area.

use super::random::{CHUNK, Chance};
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};
use rayon::prelude::*;

/// Points on a mesh.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SurfaceSamples {
    /// Local positions.
    pub points: Vec<[f64; 3]>,
    /// The triangle that each point lies on.
    pub triangles: Vec<u32>,
}

/// `n` points on a mesh, the same expected number on any two pieces of equal area. `None` if the mesh has no area, or
/// an area that is not finite, or names vertices that are not there.
///
/// The area, with the triangles in a row, is cut into `n` equal strata with one point in each (so a piece of area A
/// holds n A / total points to within 2), and the points come in the order of the triangles: neighbours in the list are
/// often neighbours in space, which makes searches with them fast. Within its triangle a point is uniform.
///
/// The same seed gives the same points on any number of threads. O(triangles + n).
#[must_use]
pub fn sample_surface(mesh: &Mesh, n: usize, seed: u64) -> Option<SurfaceSamples> {
    let corner = |v: u32| mesh.vertices.get(v as usize).copied();
    let areas: Option<Vec<f64>> = mesh
        .triangles
        .par_iter()
        .map(|&[a, b, c]| {
            let (a, b, c) = (corner(a)?, corner(b)?, corner(c)?);
            Some(0.5 * vec3::norm(vec3::cross(vec3::sub(b, a), vec3::sub(c, a))))
        })
        .collect();
    let mut cumulative = areas?;
    let last = cumulative.iter().rposition(|&area| area > 0.0)?;
    let mut total = 0.0;
    for area in &mut cumulative {
        total += *area;
        *area = total;
    }
    if !total.is_finite() || u32::try_from(last).is_err() {
        return None;
    }

    let mut samples = SurfaceSamples { points: vec![[0.0; 3]; n], triangles: vec![0; n] };
    let chunks = samples.points.par_chunks_mut(CHUNK).zip(samples.triangles.par_chunks_mut(CHUNK)).enumerate();
    chunks.for_each(|(chunk, (points, triangles))| {
        let mut chance = Chance::new(seed, 1, chunk);
        let begin = chunk * CHUNK;
        let mut t = cumulative.partition_point(|&sum| sum <= begin as f64 / n as f64 * total);
        for (i, (point, triangle)) in points.iter_mut().zip(triangles).enumerate() {
            let area = ((begin + i) as f64 + chance.uniform()) / n as f64 * total;
            while t < last && cumulative[t] <= area {
                t += 1;
            }
            // Rounding may carry the start of a chunk past the end.
            t = t.min(last);
            *triangle = t as u32;
            *point = on_triangle(mesh.triangles[t].map(|v| mesh.vertices[v as usize]), &mut chance);
        }
    });
    Some(samples)
}

/// A uniform point of a triangle: a uniform point of the parallelogram, folded over the diagonal.
fn on_triangle([a, b, c]: [Vec3; 3], chance: &mut Chance) -> Vec3 {
    let (mut s, mut t) = (chance.uniform(), chance.uniform());
    if s + t > 1.0 {
        (s, t) = (1.0 - s, 1.0 - t);
    }
    vec3::add_scaled(vec3::add_scaled(a, vec3::sub(b, a), s), vec3::sub(c, a), t)
}
