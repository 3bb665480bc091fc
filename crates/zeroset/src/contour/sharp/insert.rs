//! New vertices where sheets meet: on the mesh edges that cross a crease, and in the triangles that hold a corner.

use super::Seat;
use super::sheets::Sheet;
use crate::feature::Flat;
use crate::mesh::{Edges, Mesh};
use crate::vec3::{self, Vec3};

/// Sheets meet in a crease from this angle on; its sine.
const LEAST_SINE: f64 = 0.12;
/// How far from its edge a vertex may come to lie, in cells.
const REACH: f64 = 1.8;

/// A mesh with its creases: the seat of each vertex, and the normal of the sheet of each triangle.
pub(super) struct Inserted {
    pub(super) seats: Vec<Seat>,
    pub(super) facing: Vec<Vec3>,
}

/// Puts vertices on their sheets and makes mesh edges along the creases.
pub(super) fn insert_creases(mesh: &mut Mesh, sheets: &[Sheet], cell: f64) -> Inserted {
    let mut seats: Vec<Seat> =
        sheets.iter().map(|sheet| if sheet.plane.is_some() { Seat::On(sheet.flat) } else { Seat::Loose }).collect();
    let mut vertices: Vec<Vec3> = sheets.iter().map(|sheet| sheet.position).collect();
    let mut inserted: Vec<Option<u32>> = vec![None; 3 * mesh.triangles.len()];
    let edges = Edges::new(mesh).expect("a mesh of our own is sound");
    for edge in edges.iter() {
        let ends = [edge.low, edge.high].map(|v| v as usize);
        if !sheets[ends[0]].meets(&sheets[ends[1]]) {
            continue;
        }
        let Some((position, direction)) = crossing(ends.map(|v| mesh.vertices[v]), ends.map(|v| sheets[v].flat), cell)
        else {
            continue;
        };
        let number = vertices.len() as u32;
        vertices.push(position);
        seats.push(Seat::Along(position, direction));
        edge.corners().for_each(|corner| inserted[corner as usize] = Some(number));
    }
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    let mut facing: Vec<Vec3> = Vec::with_capacity(mesh.triangles.len());
    let normal_of = |v: u32| sheets[v as usize].flat.normal;
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let cut: [Option<u32>; 3] = std::array::from_fn(|side| inserted[3 * t + side]);
        match cut.iter().flatten().count() {
            0 => {
                triangles.push(*corners);
                let sum = corners.iter().fold([0.0; 3], |sum, &v| vec3::add(sum, normal_of(v)));
                facing.push(vec3::normalized(sum).unwrap_or(normal_of(corners[0])));
            }
            1 => split_in_two(*corners, cut, |t, v| {
                triangles.push(t);
                facing.push(normal_of(v));
            }),
            2 => split_in_three(*corners, cut, &vertices, sheets, |t, v| {
                triangles.push(t);
                facing.push(normal_of(v));
            }),
            _ => {
                let flats = corners.map(|v| sheets[v as usize].flat);
                let middle = vec3::scale(
                    corners.iter().fold([0.0; 3], |sum, &v| vec3::add(sum, mesh.vertices[v as usize])),
                    1.0 / 3.0,
                );
                let centre = vertices.len() as u32;
                match corner(flats, middle, cell) {
                    Some(position) => {
                        vertices.push(position);
                        seats.push(Seat::At);
                    }
                    None => {
                        let sum = cut.iter().flatten().fold([0.0; 3], |s, &v| vec3::add(s, vertices[v as usize]));
                        vertices.push(vec3::scale(sum, 1.0 / 3.0));
                        seats.push(Seat::Loose);
                    }
                }
                for side in 0..3 {
                    if let (Some(before), Some(after)) = (cut[(side + 2) % 3], cut[side]) {
                        triangles.push([before, corners[side], centre]);
                        triangles.push([corners[side], after, centre]);
                        facing.extend([normal_of(corners[side]); 2]);
                    }
                }
            }
        }
    }
    mesh.vertices = vertices;
    mesh.triangles = triangles;
    Inserted { seats, facing }
}

/// Where a mesh edge meets the line of two sheets, and the line's direction.
fn crossing(ends: [Vec3; 2], flats: [Flat; 2], cell: f64) -> Option<(Vec3, Vec3)> {
    let across = vec3::cross(flats[0].normal, flats[1].normal);
    let sine = vec3::norm(across);
    if sine < LEAST_SINE {
        return None;
    }
    // The place on the edge that is equally far from both planes.
    let excess = ends.map(|p| flats[0].distance(p).abs() - flats[1].distance(p).abs());
    let t = if excess[0] < 0.0 && excess[1] > 0.0 { excess[0] / (excess[0] - excess[1]) } else { 0.5 };
    let middle = vec3::lerp(ends[0], ends[1], t);
    let position = meet(&flats, middle, 0.01);
    (vec3::distance(position, middle) < REACH * cell).then(|| (position, vec3::scale(across, 1.0 / sine)))
}

/// The position nearest to `from` that lies on all planes, as far as they differ enough for their common normals to count.
fn meet(flats: &[Flat], from: Vec3, least: f64) -> Vec3 {
    use nalgebra::{Matrix3, SymmetricEigen, Vector3};
    let (mut a, mut b) = (Matrix3::zeros(), Vector3::zeros());
    for flat in flats {
        let n = Vector3::from(flat.normal);
        a += n * n.transpose();
        b -= n * flat.distance(from);
    }
    let eigen = SymmetricEigen::new(a);
    let mut step = Vector3::zeros();
    for (value, vector) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least {
            step += vector * (vector.dot(&b) / value);
        }
    }
    vec3::add(from, step.into())
}

/// Where three sheets meet.
fn corner(flats: [Flat; 3], middle: Vec3, cell: f64) -> Option<Vec3> {
    let [a, b, c] = flats.map(|f| f.normal);
    if vec3::dot(a, vec3::cross(b, c)).abs() < 0.05 {
        return None;
    }
    let position = meet(&flats, middle, 1e-4);
    (vec3::distance(position, middle) < REACH * cell).then_some(position)
}

fn split_in_two(corners: [u32; 3], cut: [Option<u32>; 3], mut emit: impl FnMut([u32; 3], u32)) {
    for side in 0..3 {
        if let Some(middle) = cut[side] {
            let [a, b, c] = [corners[side], corners[(side + 1) % 3], corners[(side + 2) % 3]];
            emit([a, middle, c], a);
            emit([middle, b, c], b);
        }
    }
}

fn split_in_three(
    corners: [u32; 3],
    cut: [Option<u32>; 3],
    vertices: &[Vec3],
    sheets: &[Sheet],
    mut emit: impl FnMut([u32; 3], u32),
) {
    for side in 0..3 {
        // The corner between the two cut sides stands alone.
        let (Some(before), Some(after)) = (cut[(side + 2) % 3], cut[side]) else { continue };
        let [a, b, c] = [corners[side], corners[(side + 1) % 3], corners[(side + 2) % 3]];
        emit([before, a, after], a);
        let normal = sheets[b as usize].flat.normal;
        let quadrangle = [before, after, b, c].map(|v| vertices[v as usize]);
        super::super::triangulate::triangulate(&quadrangle, normal, |t| {
            emit(t.map(|i| [before, after, b, c][i]), b);
        });
    }
}
