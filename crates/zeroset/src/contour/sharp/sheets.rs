//! The sheet of each vertex: the smooth part of the surface that it belongs to.

use rayon::prelude::*;

use super::Known;
use super::curved::Sides;
use super::evidence::unproven;
use super::stars::Stars;
use crate::feature::{Flat, NearFacet};
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// How far a polygon may be from its vertices, in cells: F rounds a corner off by less.
const REACH: f64 = 1.7;
/// A sheet faces the way that the mesh does, within this cosine: 80 degrees.
pub(super) const FACING: f64 = 0.17;
/// Polygons may end this many cells before their edge.
const GAP: f64 = 0.75;
/// The most planes that a vertex chooses from.
const MOST: usize = 4;
/// Rounds in which vertices look at their neighbours.
const ROUNDS: usize = 3;
/// What it costs, in squared cells, to be of another sheet than all neighbours.
const DISAGREEMENT: f64 = 0.3;
/// A vertex that has one plane near, and that at less than this cost, is on it.
const CERTAIN: f64 = 0.01;
/// How many of the nearest points tell whether a vertex is on a plane at all.
const POINTS: usize = 8;

/// A sheet that a vertex may belong to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Candidate {
    /// The plane, or a curved part.
    pub(super) plane: Option<u32>,
    /// What it costs to belong to it, in squared cells.
    pub(super) cost: f64,
}

/// The sheet of a vertex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sheet {
    /// The plane, unless the vertex is on a curved part.
    pub(super) plane: Option<u32>,
    /// The plane, or the tangent plane of the curved part.
    pub(super) flat: Flat,
    /// Where the vertex lies on it.
    pub(super) position: Vec3,
    /// Whether it may meet a curved part in a crease.
    pub(super) creased: bool,
}

/// Two neighbouring vertices on curved parts have a crease between them from this angle on; its cosine: 25 degrees.
pub(super) const CREASE: f64 = 0.906;

impl Sheet {
    /// Whether a crease runs between two neighbouring vertices.
    pub(super) fn meets(&self, other: &Self) -> bool {
        match (self.plane, other.plane) {
            (Some(a), Some(b)) => a != b,
            _ if !(self.creased && other.creased) => false,
            _ => vec3::dot(self.flat.normal, other.flat.normal) < CREASE,
        }
    }
}

/// The sheets of all vertices.
pub(super) fn sheets(mesh: &Mesh, known: &Known) -> Vec<Sheet> {
    let normals = normals(mesh);
    let stars = Stars::new(mesh);
    let candidates: Vec<Vec<Candidate>> = mesh
        .vertices
        .par_iter()
        .zip(&normals)
        .map_init(Vec::new, |found, (&p, &normal)| candidates(p, normal, known, found))
        .collect();
    let planes = agreed(&candidates, &stars);
    let sides = Sides::new(mesh, &stars, &normals, &planes, known);
    let mut sheets: Vec<Sheet> = (0..mesh.vertices.len())
        .into_par_iter()
        .map(|v| {
            let p = mesh.vertices[v];
            let on = |i: u32| {
                let flat = known.facets.flats[i as usize];
                Sheet { plane: Some(i), flat, position: flat.foot(p), creased: known.curved_creases }
            };
            match sides.best(v, &candidates[v], planes[v]) {
                Some(sheet) => sheet,
                None => match planes[v] {
                    Some(i) => on(i),
                    None => Sheet {
                        plane: None,
                        flat: Flat::through(sides.normals[v], p),
                        position: p,
                        creased: known.curved_creases,
                    },
                },
            }
        })
        .collect();
    let rivals = |v: usize| {
        let on_planes = candidates[v].iter().filter_map(|c| Some(known.facets.flats[c.plane? as usize]));
        on_planes.chain(sides.flats(v)).collect::<Vec<Flat>>()
    };
    let unproven = unproven(mesh, &stars, known, &sheets, rivals);
    sheets.par_iter_mut().zip(unproven).enumerate().filter(|(_, (_, unproven))| *unproven).for_each(
        |(v, (sheet, _))| {
            let p = mesh.vertices[v];
            *sheet = Sheet { plane: None, flat: Flat::through(normals[v], p), position: p, creased: sheet.creased };
        },
    );
    sheets
}

/// The cheapest candidate of each vertex, where it costs something to differ from one's neighbours.
fn agreed(candidates: &[Vec<Candidate>], stars: &Stars) -> Vec<Option<u32>> {
    let cheapest = |of: &Vec<Candidate>| of.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).and_then(|c| c.plane);
    let mut plane: Vec<Option<u32>> = candidates.par_iter().map(cheapest).collect();
    for _ in 0..ROUNDS {
        plane = candidates
            .par_iter()
            .enumerate()
            .map(|(v, own)| {
                let around = stars.around(v);
                let cost = |c: &Candidate| {
                    let others = around.iter().filter(|&&u| plane[u as usize] != c.plane).count();
                    c.cost + DISAGREEMENT * others as f64 / around.len().max(1) as f64
                };
                own.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).and_then(|c| c.plane)
            })
            .collect();
    }
    plane
}

/// The planes that a vertex may belong to, and what it costs to be on a curved part.
fn candidates(p: Vec3, normal: Vec3, known: &Known, found: &mut Vec<NearFacet>) -> Vec<Candidate> {
    let cell = known.cell;
    known.facets.near(p, REACH * cell, found);
    let mut own: Vec<Candidate> = found
        .iter()
        .filter_map(|facet| {
            let flat = &known.facets.flats[facet.plane as usize];
            if vec3::dot(flat.normal, normal) < FACING {
                return None;
            }
            let across = flat.distance(p) / cell;
            let aside = (facet.distance_squared / (cell * cell) - across * across).max(0.0).sqrt();
            let beyond = (aside - GAP).max(0.0);
            Some(Candidate { plane: Some(facet.plane), cost: across * across + beyond * beyond })
        })
        .collect();
    own.sort_by(|a, b| a.cost.total_cmp(&b.cost));
    own.truncate(MOST);
    match own.as_slice() {
        [] => return vec![Candidate { plane: None, cost: 0.0 }],
        [only] if only.cost < CERTAIN => return own,
        _ => {}
    }
    let mut near = Vec::new();
    known.points.k_nearest(p, POINTS, &mut near);
    let flat = near.iter().filter(|n| known.plane_of[n.index].is_some()).count();
    let share = flat as f64 / near.len().max(1) as f64;
    own.push(Candidate { plane: None, cost: (REACH * share).powi(2) });
    own
}

/// The unit normals of the vertices: of the areas around them.
fn normals(mesh: &Mesh) -> Vec<Vec3> {
    let mut sums = vec![[0.0; 3]; mesh.vertices.len()];
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        let area = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
        t.iter().for_each(|&v| sums[v as usize] = vec3::add(sums[v as usize], area));
    }
    sums.into_par_iter().map(|sum| vec3::normalized(sum).unwrap_or([0.0; 3])).collect()
}
