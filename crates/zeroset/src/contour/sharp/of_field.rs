//! Sharp meshes of fields that know their sheets.

use rayon::prelude::*;

use super::insert::{Inserted, insert_creases};
use super::sheets::{Sheet, Sheets};
use super::stars::Fans;
use super::{Raster, Seat, embed, tidy};
use crate::feature::Flat;
use crate::field::Field;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A vertex goes no farther than this, in cells: the lattice loses the tip of a wedge of 30 degrees two cells before its edge.
const REACH: f64 = 4.0;
/// Steps of Newton's method.
const STEPS: usize = 20;
/// It is there when the next step would be shorter than this, in cells.
const NEAR: f64 = 1e-9;

/// What was made sharp.
pub(crate) struct Sharpened {
    pub(crate) on_creases: usize,
    pub(crate) at_corners: usize,
    pub(crate) folded: usize,
    pub(crate) taken_back: usize,
    pub(crate) intersections: u64,
}

/// Puts the vertices of a mesh on the sheets of its field, and mesh edges along the lines in which they meet.
pub(crate) fn sharpen_field(mesh: &mut Mesh, field: &dyn Field, cell: f64) -> Sharpened {
    let raster = Raster::new(mesh);
    let first = mesh.vertices.len();
    let numbers: Vec<u32> = mesh.vertices.par_iter().map(|&p| field.sheet(p)).collect();
    let foot = |(&p, &number): (&Vec3, &u32)| meet(field, &[number], p, cell).unwrap_or(p);
    let feet: Vec<Vec3> = mesh.vertices.par_iter().zip(&numbers).map(foot).collect();
    let tangent = |(&foot, &number): (&Vec3, &u32)| {
        let (_, gradient) = field.on_sheet(number, foot);
        let normal = vec3::normalized(gradient).unwrap_or([0.0, 0.0, 1.0]);
        Sheet { plane: Some(number), is_flat: field.is_flat(number), flat: Flat::through(normal, foot) }
    };
    let sheets = Sheets::given(feet.par_iter().zip(&numbers).map(tangent).collect());
    let mut inserted = insert_creases(mesh, &sheets, REACH * cell);
    drop(sheets);
    mesh.vertices[..first].copy_from_slice(&feet);
    follow_lines(mesh, field, first, &numbers, &mut inserted, cell);
    let on_creases = inserted.seats.iter().filter(|s| matches!(s, Seat::Along(..))).count();
    let at_corners = inserted.seats.iter().filter(|s| matches!(s, Seat::At)).count();
    inserted.origins.par_iter_mut().for_each(|origin| *origin = raster.nearest(*origin));
    let fans = Fans::new(mesh);
    let folded = tidy::tidy(mesh, fans, &mut inserted, cell);
    // Vertices on curved sheets have left them a little.
    let seats = &inserted.seats;
    mesh.vertices[..first].par_iter_mut().enumerate().for_each(|(v, p)| {
        if seats[v] == Seat::Loose {
            *p = meet(field, &[numbers[v]], *p, cell).unwrap_or(*p);
        }
    });
    let (taken_back, intersections) = embed::embed(mesh, first, &inserted.origins, raster, 0.0);
    super::super::clip::drop_unused(mesh);
    Sharpened { on_creases, at_corners, folded, taken_back, intersections }
}

/// Puts new vertices where their sheets meet, which tangent planes told to first order only.
fn follow_lines(mesh: &mut Mesh, field: &dyn Field, first: usize, numbers: &[u32], inserted: &mut Inserted, cell: f64) {
    let met: Vec<Option<Vec3>> = (first..mesh.vertices.len())
        .into_par_iter()
        .map(|v| {
            let mut sheets: Vec<u32> =
                inserted.between[v - first].iter().filter(|&&u| u != u32::MAX).map(|&u| numbers[u as usize]).collect();
            sheets.sort_unstable();
            sheets.dedup();
            let wanted = match inserted.seats[v] {
                Seat::Along(..) => 2,
                Seat::At => 3,
                _ => return None,
            };
            if sheets.len() != wanted {
                return None;
            }
            meet(field, &sheets, mesh.vertices[v], cell)
        })
        .collect();
    for (v, place) in (first..).zip(met) {
        let Some(place) = place else { continue };
        mesh.vertices[v] = place;
        if let Seat::Along(_, direction) = inserted.seats[v] {
            inserted.seats[v] = Seat::Along(place, direction);
        }
    }
}

/// The place near a position where one to three sheets are zero; `None` if it is too far away, or they hardly cross.
fn meet(field: &dyn Field, sheets: &[u32], from: Vec3, cell: f64) -> Option<Vec3> {
    use nalgebra::{DMatrix, DVector};
    let mut p = from;
    for _ in 0..STEPS {
        let all: Vec<(f64, Vec3)> = sheets.iter().map(|&sheet| field.on_sheet(sheet, p)).collect();
        let step: Vec3 = if let [(value, gradient)] = all[..] {
            vec3::scale(gradient, -value / vec3::norm_squared(gradient))
        } else {
            // The shortest step that makes all zero to first order: J^T (J J^T)^-1 of the values.
            let j = DMatrix::from_fn(all.len(), 3, |i, a| all[i].1[a]);
            let values = DVector::from_fn(all.len(), |i, _| -all[i].0);
            let products = &j * j.transpose();
            let step = j.transpose() * products.cholesky()?.solve(&values);
            [step[0], step[1], step[2]]
        };
        p = vec3::add(p, step);
        if !vec3::is_finite(p) || vec3::distance(p, from) > REACH * cell {
            return None;
        }
        if vec3::norm(step) < NEAR * cell {
            return Some(p);
        }
    }
    None
}
