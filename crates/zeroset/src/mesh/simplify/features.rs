//! What a surface must keep: planes, creases, borders.

use rayon::prelude::*;

use crate::mesh::Mesh;
use crate::mesh::edges::Edges;
use crate::mesh::quadric::Quadric;
use crate::vec3::{self, Vec3};

/// Rounds in which the normals are smoothed before creases are looked for.
const ROUNDS: usize = 5;
/// The angle, in radians, at which a neighbour's normal counts a fraction 1/e: 15 degrees. Noise turns neighbours by less than
/// a crease, so that smoothing takes the one and leaves the other.
const ALIKE: f64 = 0.26;
/// The angle, in radians, below which two triangles lie in one plane: then there is no noise to smooth.
const EXACT: f64 = 1e-7;
/// Weight of the planes that stand on creases and on borders, over the squared length of the edge. A triangle of equal sides
/// has 0.14 in the same measure at each of its corners.
const CREASE_WEIGHT: f64 = 0.25;
const BORDER_WEIGHT: f64 = 1.0;

/// The quadric of each vertex, and whether it lies on a crease or a border.
#[derive(Debug)]
pub(super) struct Features {
    pub(super) quadrics: Vec<Quadric>,
    pub(super) marked: Vec<bool>,
}

/// A triangle's normal and area.
#[derive(Debug, Clone, Copy)]
struct Face {
    /// `None` without area.
    normal: Option<Vec3>,
    centre: Vec3,
    area: f64,
}

impl Features {
    /// Each triangle gives its plane to its corners, by a third of its area. Each edge of a crease or a border gives, to both
    /// ends, the planes through it that stand upright on its triangles.
    pub(super) fn new(mesh: &Mesh, edges: &Edges, sharp_angle: f64) -> Self {
        let faces: Vec<Face> =
            mesh.triangles.par_iter().map(|t| Face::of(t.map(|v| mesh.vertices[v as usize]))).collect();
        let mut quadrics = vec![Quadric::default(); mesh.vertices.len()];
        let mut marked = vec![false; mesh.vertices.len()];
        let neighbours = neighbours(mesh, edges);
        let smooth = smoothed(&neighbours, &faces);
        for (t, (triangle, face)) in mesh.triangles.iter().zip(&faces).enumerate() {
            let is_exact = neighbours[t].iter().flatten().any(|&other| faces[other as usize].continues(face));
            let Some(normal) = (if is_exact { face.normal } else { smooth[t] }) else { continue };
            for &v in triangle {
                let quadric = &mut quadrics[v as usize];
                let height = vec3::dot(normal, vec3::sub(mesh.vertices[v as usize], face.centre));
                quadric.add_plane(normal, if is_exact { 0.0 } else { height }, face.area / 3.0);
                quadric.area += face.area / 3.0;
            }
        }
        for edge in edges.iter() {
            let ends = [edge.low, edge.high];
            let [low, high] = ends.map(|v| mesh.vertices[v as usize]);
            let along = vec3::sub(high, low);
            let weight = match edge.pair() {
                None => BORDER_WEIGHT,
                Some(pair) if is_sharp(pair.map(|c| smooth[c as usize / 3]), sharp_angle) => CREASE_WEIGHT,
                Some(_) => continue,
            };
            for corner in edge.corners() {
                let across = faces[corner as usize / 3].normal.map(|normal| vec3::cross(normal, along));
                let Some(across) = across.and_then(vec3::normalized) else { continue };
                for v in ends {
                    quadrics[v as usize].add_plane(across, 0.0, weight * vec3::norm_squared(along));
                    marked[v as usize] = true;
                }
            }
        }
        Self { quadrics, marked }
    }
}

impl Face {
    fn of([a, b, c]: [Vec3; 3]) -> Self {
        let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
        let centre = vec3::scale(vec3::add(vec3::add(a, b), c), 1.0 / 3.0);
        Self { normal: vec3::normalized(normal), centre, area: 0.5 * vec3::norm(normal) }
    }

    /// Whether two triangles lie in one plane but for rounding.
    fn continues(&self, other: &Self) -> bool {
        self.normal.zip(other.normal).is_some_and(|(m, n)| vec3::norm(vec3::cross(m, n)) < EXACT)
    }
}

fn is_sharp([a, b]: [Option<Vec3>; 2], angle: f64) -> bool {
    let (Some(a), Some(b)) = (a, b) else { return false };
    vec3::norm(vec3::cross(a, b)).atan2(vec3::dot(a, b)) > angle
}

/// The triangles across the three sides of each, where there is just one.
fn neighbours(mesh: &Mesh, edges: &Edges) -> Vec<[Option<u32>; 3]> {
    let mut neighbours = vec![[None; 3]; mesh.triangles.len()];
    for [a, b] in edges.iter().filter_map(|edge| edge.pair()) {
        neighbours[a as usize / 3][a as usize % 3] = Some(b / 3);
        neighbours[b as usize / 3][b as usize % 3] = Some(a / 3);
    }
    neighbours
}

/// Normals averaged over neighbours that look alike, so that what noise turned is turned back and creases stay.
fn smoothed(neighbours: &[[Option<u32>; 3]], faces: &[Face]) -> Vec<Option<Vec3>> {
    let mut normals: Vec<Option<Vec3>> = faces.iter().map(|face| face.normal).collect();
    for _ in 0..ROUNDS {
        let next = neighbours.par_iter().enumerate().map(|(t, around)| {
            let own = normals[t]?;
            let sum = around.iter().flatten().fold(vec3::scale(own, faces[t].area), |sum, &other| {
                let Some(normal) = normals[other as usize] else { return sum };
                // For unit vectors the squared distance is the squared angle, nearly.
                let likeness = (-vec3::distance_squared(own, normal) / (ALIKE * ALIKE)).exp();
                vec3::add_scaled(sum, normal, likeness * faces[other as usize].area)
            });
            vec3::normalized(sum)
        });
        normals = next.collect();
    }
    normals
}
