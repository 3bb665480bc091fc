//! Sharp meshes of fields that know their sheets.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::insert::{Inserted, insert_creases};
use super::sheets::{Sheet, Sheets};
use super::stars::Stars;
use super::{Finish, Known, Raster, Seat, SharpReport, embed};
use crate::contour::clip::drop_unused;
use crate::feature::Flat;
use crate::field::Field;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// A vertex goes no farther than this, in cells: the lattice loses the tip of a wedge of 15 degrees eight cells before its edge.
const REACH: f64 = 8.0;
/// Steps of Newton's method.
const STEPS: usize = 20;
/// It is there when the next step would be shorter than this, in cells.
const NEAR: f64 = 1e-9;

/// Puts the vertices of a mesh on the sheets of its field, and mesh edges along the lines in which they meet. What is known of fitted operands is given by
/// their tags: there the sheets come from the points.
pub(crate) fn sharpen_field(mesh: &mut Mesh, field: &dyn Field, known: &[Option<Known>], cell: f64) -> SharpReport {
    let raster = Raster::new(mesh);
    let first = mesh.vertices.len();
    let numbers: Vec<u32> = mesh.vertices.par_iter().map(|&p| field.sheet(p)).collect();
    let OnSheets { sheets, feet, places } = OnSheets::new(mesh, field, &numbers, known, cell);
    let on_planes = (0..first as u32).filter(|&v| sheets.of(v).is_flat).count();
    let mut inserted = insert_creases(mesh, &sheets, REACH * cell, None);
    drop(sheets);
    for (v, foot) in mesh.vertices.iter_mut().zip(&feet) {
        *v = foot.unwrap_or(*v);
    }
    follow_lines(mesh, field, &places, &mut inserted, cell);
    let is_fitted = known.iter().any(Option::is_some);
    let everywhere = known.iter().flatten().any(|known| known.curved_creases);
    let moved = if is_fitted { embed::MOVED * cell } else { 0.0 };
    let finish = Finish { first, cell, settle: is_fitted.then_some(everywhere), moved };
    // Vertices on curved sheets have left them a little.
    let refine = |mesh: &mut Mesh, seats: &[Seat]| {
        mesh.vertices[..first].par_iter_mut().enumerate().for_each(|(v, p)| {
            if let (Seat::Loose, Some(_)) = (seats[v], feet[v]) {
                *p = meet(field, &[Place::OnField(numbers[v])], *p, cell).unwrap_or(*p);
            }
        });
    };
    let report = SharpReport { on_planes, ..finish.run(mesh, &mut inserted, raster, refine) };
    drop_unused(mesh);
    report
}

/// What a vertex lies on.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    /// A sheet of the field.
    OnField(u32),
    /// A plane that the points show, or the tangent plane of a curved part.
    OnPlane(Option<u32>, Flat),
}

/// What the vertices of a mesh lie on.
struct OnSheets {
    sheets: Sheets,
    /// The foot of each vertex on its sheet, where that is one of the field's own and not of a fitted operand.
    feet: Vec<Option<Vec3>>,
    places: Vec<Place>,
}

impl OnSheets {
    /// `numbers` are the field's sheets at the vertices.
    fn new(mesh: &Mesh, field: &dyn Field, numbers: &[u32], known: &[Option<Known>], cell: f64) -> Self {
        let operands = operands(field, numbers, known);
        let beside = operands.iter().any(|&operand| operand != 0).then(|| beside_others(&operands, &Stars::new(mesh)));
        // Where the mesh is blunt, beside another operand, it is away from the sheet.
        let is_beside = |v: usize| beside.as_ref().is_some_and(|beside| beside[v]);
        let foot = |v: usize| {
            let p = mesh.vertices[v];
            let is_own = operands[v] == 0 || is_beside(v);
            is_own.then(|| meet(field, &[Place::OnField(numbers[v])], p, cell).unwrap_or(p))
        };
        let feet: Vec<Option<Vec3>> = (0..numbers.len()).into_par_iter().map(foot).collect();
        let own = |v: usize| {
            let (number, foot) = (numbers[v], feet[v].unwrap_or(mesh.vertices[v]));
            let (_, gradient) = field.on_sheet(number, foot);
            let flat = Flat::through(vec3::normalized(gradient).unwrap_or([0.0, 0.0, 1.0]), foot);
            Sheet { plane: Some(number), is_flat: field.is_flat(number), flat }
        };
        let mut of: Vec<Sheet> = (0..numbers.len()).into_par_iter().map(own).collect();
        if beside.is_some() {
            let apart = apart(mesh, &feet, &operands);
            let stars = Stars::new(&apart);
            // Planes that points show are numbered after the field's sheets.
            let mut next = field.sheets();
            for (tag, known) in known.iter().enumerate() {
                let Some(known) = known else { continue };
                let shown = super::sheets::sheets(&apart, &stars, known);
                let is_of_it = |v: &usize| operands[*v] == tag as u32 + 1;
                of.par_iter_mut().enumerate().filter(|(v, _)| is_of_it(v)).for_each(|(v, sheet)| {
                    let shown = shown.of(v as u32);
                    *sheet = match shown.plane {
                        Some(plane) => Sheet { plane: Some(next + plane), ..*shown },
                        None if is_beside(v) => Sheet { plane: None, is_flat: false, flat: sheet.flat },
                        None => *shown,
                    };
                });
                next += known.facets.flats.len() as u32;
            }
        }
        let place = |v: usize| match (feet[v], of[v].plane) {
            (Some(_), None) => Place::OnField(numbers[v]),
            (Some(_), Some(_)) if operands[v] == 0 => Place::OnField(numbers[v]),
            (_, plane) => Place::OnPlane(plane, of[v].flat),
        };
        let places = (0..numbers.len()).into_par_iter().map(place).collect();
        let feet = feet.iter().zip(&operands).map(|(foot, &operand)| foot.filter(|_| operand == 0)).collect();
        let curved_creases = known.iter().map(|known| known.as_ref().is_some_and(|known| known.curved_creases));
        let curved_creases = std::iter::once(true).chain(curved_creases).collect();
        Self { sheets: Sheets::given(of, operands, curved_creases), feet, places }
    }
}

/// The operand of each vertex: 0 for all that points tell nothing of, else 1 more than its tag.
fn operands(field: &dyn Field, numbers: &[u32], known: &[Option<Known>]) -> Vec<u32> {
    let tag = |number: u32| field.operand(number).tag.filter(|&tag| known.get(tag).is_some_and(Option::is_some));
    let mut operand_of: FxHashMap<u32, u32> = FxHashMap::default();
    for &number in numbers {
        operand_of.entry(number).or_insert_with(|| tag(number).map_or(0, |tag| tag as u32 + 1));
    }
    numbers.par_iter().map(|number| operand_of[number]).collect()
}

/// Rings of vertices around another operand in which the mesh is blunt.
const BLUNT: usize = 2;

/// Whether another operand is near each vertex.
fn beside_others(operands: &[u32], stars: &Stars) -> Vec<bool> {
    let differs = |v: usize| stars.around(v as u32).iter().any(|&u| operands[u as usize] != operands[v]);
    let mut beside: Vec<bool> = (0..operands.len()).into_par_iter().map(differs).collect();
    for _ in 1..BLUNT {
        let old = &beside;
        let grown = |v: usize| old[v] || stars.around(v as u32).iter().any(|&u| old[u as usize]);
        beside = (0..operands.len()).into_par_iter().map(grown).collect();
    }
    beside
}

/// The surfaces of the operands, each for itself: points tell nothing of the lines in which they meet.
fn apart(mesh: &Mesh, feet: &[Option<Vec3>], operands: &[u32]) -> Mesh {
    let vertices = mesh.vertices.iter().zip(feet).map(|(&v, foot)| foot.unwrap_or(v)).collect();
    let is_of_one = |t: &&[u32; 3]| t.iter().all(|&v| operands[v as usize] == operands[t[0] as usize]);
    Mesh { vertices, triangles: mesh.triangles.iter().filter(is_of_one).copied().collect(), ..Mesh::default() }
}

/// Puts new vertices where their sheets meet, which tangent planes told to first order only.
fn follow_lines(mesh: &mut Mesh, field: &dyn Field, places: &[Place], inserted: &mut Inserted, cell: f64) {
    let first = places.len();
    let met: Vec<Option<Vec3>> = (first..mesh.vertices.len())
        .into_par_iter()
        .map(|v| {
            let mut sheets: Vec<Place> = Vec::with_capacity(3);
            for &u in inserted.between[v - first].iter().filter(|&&u| u != u32::MAX) {
                if !sheets.contains(&places[u as usize]) {
                    sheets.push(places[u as usize]);
                }
            }
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
fn meet(field: &dyn Field, sheets: &[Place], from: Vec3, cell: f64) -> Option<Vec3> {
    use nalgebra::{DMatrix, DVector};
    let mut p = from;
    for _ in 0..STEPS {
        let on = |sheet: &Place| match sheet {
            Place::OnField(sheet) => field.on_sheet(*sheet, p),
            Place::OnPlane(_, flat) => (flat.distance(p), flat.normal),
        };
        let all: Vec<(f64, Vec3)> = sheets.iter().map(on).collect();
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
