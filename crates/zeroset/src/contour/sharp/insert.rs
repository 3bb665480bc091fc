//! New vertices where sheets meet: on the mesh edges that cross a crease, and in the triangles that hold a corner.

use rayon::prelude::*;

use super::Seat;
use super::creases::{Crossing, crossings};
use super::sheets::Sheets;
use crate::contour::seam::Seam;
use crate::feature::Flat;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// Sheets meet in a crease from this angle on; its sine.
const LEAST_SINE: f64 = 0.12;

/// How far F rounds edges off at most, in cells.
pub(super) const REACH: f64 = 1.8;

/// A mesh with its creases.
pub(super) struct Inserted {
    /// How each vertex may move.
    pub(super) seats: Vec<Seat>,
    /// The normal of the sheet of each triangle.
    pub(super) facing: Vec<[f32; 3]>,
    /// Where each vertex is on the surface of F.
    pub(super) origins: Vec<Vec3>,
    /// The vertices between which each new one was put in, three at a corner; else the last is `u32::MAX`.
    pub(super) between: Vec<[u32; 3]>,
    /// For each triangle whether it is the part's own; empty without a seam.
    pub(super) own: Vec<bool>,
}

/// Puts vertices on their sheets and makes mesh edges along the creases, where these are no farther than `reach` from the mesh. Held vertices
/// and edges between them stay.
pub(super) fn insert_creases(mesh: &mut Mesh, sheets: &Sheets, reach: f64, seam: Option<&Seam>) -> Inserted {
    let count = mesh.vertices.len() as u32;
    let is_held = |v: u32| seam.is_some_and(|seam| seam.keys.contains_key(&v));
    let seat = |v: u32| {
        if is_held(v) {
            return Seat::Held;
        }
        let sheet = sheets.of(v);
        if sheet.is_flat { Seat::On(sheet.flat) } else { Seat::Loose }
    };
    let mut seats: Vec<Seat> = (0..count).into_par_iter().map(seat).collect();
    let foot = |v: u32| {
        let position = mesh.vertices[v as usize];
        if is_held(v) { position } else { sheets.of(v).flat.foot(position) }
    };
    let mut vertices: Vec<Vec3> = (0..count).into_par_iter().map(foot).collect();
    let mut origins = std::mem::take(&mut mesh.vertices);
    // The new vertex of each side of a triangle that crosses a crease.
    let mut cuts: Vec<(u32, u32)> = Vec::new();
    let mut between = Vec::new();
    for Crossing { ends, sides } in crossings(mesh, sheets) {
        if ends.into_iter().all(is_held) {
            continue;
        }
        let flats = ends.map(|v| sheets.of(v).flat);
        let Some((share, position, direction)) = crossing(ends.map(|v| origins[v as usize]), flats, reach) else {
            continue;
        };
        let number = vertices.len() as u32;
        vertices.push(position);
        between.push([ends[0], ends[1], u32::MAX]);
        origins.push(vec3::lerp(origins[ends[0] as usize], origins[ends[1] as usize], share));
        seats.push(Seat::Along(position, direction));
        cuts.extend([(sides[0], number), (sides[1], number)]);
    }
    cuts.par_sort_unstable();
    cuts.dedup();
    let mut cuts = cuts.into_iter().peekable();
    let mut triangles = Vec::with_capacity(mesh.triangles.len());
    let mut facing: Vec<[f32; 3]> = Vec::with_capacity(mesh.triangles.len());
    let mut own = Vec::new();
    let normal_of = |v: u32| sheets.of(v).flat.normal;
    for (t, corners) in mesh.triangles.iter().enumerate() {
        let mut cut = [None; 3];
        while let Some((side, number)) = cuts.next_if(|(side, _)| *side as usize / 3 == t) {
            cut[side as usize % 3] = Some(number);
        }
        let mut emit = |t: [u32; 3], v: u32| {
            triangles.push(t);
            facing.push(normal_of(v).map(|c| c as f32));
        };
        match cut.iter().flatten().count() {
            0 => {
                triangles.push(*corners);
                let sum = corners.iter().fold([0.0; 3], |sum, &v| vec3::add(sum, normal_of(v)));
                facing.push(vec3::normalized(sum).unwrap_or(normal_of(corners[0])).map(|c| c as f32));
            }
            1 => split_in_two(*corners, cut, emit),
            2 => split_in_three(*corners, cut, &vertices, sheets, emit),
            _ => {
                let mean = |of: [Vec3; 3]| vec3::scale(vec3::add(of[0], vec3::add(of[1], of[2])), 1.0 / 3.0);
                let origin = mean(corners.map(|v| origins[v as usize]));
                let centre = vertices.len() as u32;
                let (position, seat) = match corner(corners.map(|v| sheets.of(v).flat), origin, reach) {
                    Some(position) => (position, Seat::At),
                    None => (mean(cut.map(|v| v.map_or(origin, |v| vertices[v as usize]))), Seat::Loose),
                };
                vertices.push(position);
                between.push(*corners);
                origins.push(origin);
                seats.push(seat);
                for side in 0..3 {
                    if let (Some(before), Some(after)) = (cut[(side + 2) % 3], cut[side]) {
                        emit([before, corners[side], centre], corners[side]);
                        emit([corners[side], after, centre], corners[side]);
                    }
                }
            }
        }
        if let Some(seam) = seam {
            own.resize(triangles.len(), seam.own[t]);
        }
    }
    mesh.vertices = vertices;
    mesh.triangles = triangles;
    Inserted { seats, facing, origins, between, own }
}

/// Where a mesh edge meets the line of two sheets: the share of the edge before it, the position, and the line's direction.
pub(super) fn crossing(ends: [Vec3; 2], flats: [Flat; 2], reach: f64) -> Option<(f64, Vec3, Vec3)> {
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
    (vec3::distance(position, middle) < reach).then(|| (t, position, vec3::scale(across, 1.0 / sine)))
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
fn corner(flats: [Flat; 3], middle: Vec3, reach: f64) -> Option<Vec3> {
    let [a, b, c] = flats.map(|f| f.normal);
    if vec3::dot(a, vec3::cross(b, c)).abs() < 0.05 {
        return None;
    }
    let position = meet(&flats, middle, 1e-4);
    (vec3::distance(position, middle) < reach).then_some(position)
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
    sheets: &Sheets,
    mut emit: impl FnMut([u32; 3], u32),
) {
    for side in 0..3 {
        // The corner between the two cut sides stands alone.
        let (Some(before), Some(after)) = (cut[(side + 2) % 3], cut[side]) else { continue };
        let [a, b, c] = [corners[side], corners[(side + 1) % 3], corners[(side + 2) % 3]];
        emit([before, a, after], a);
        let normal = sheets.of(b).flat.normal;
        let quadrangle = [before, after, b, c].map(|v| vertices[v as usize]);
        super::super::triangulate::triangulate(&quadrangle, normal, |t| {
            emit(t.map(|i| [before, after, b, c][i]), b);
        });
    }
}
