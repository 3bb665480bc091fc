//! The sheet of each vertex: the smooth part of the surface that it belongs to.

use rayon::prelude::*;

use super::Known;
use super::curved;
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
pub(super) const DISAGREEMENT: f64 = 0.3;
/// A vertex that has one plane near, and that at less than this cost, is on it.
const CERTAIN: f64 = 0.01;
/// How many of the nearest points tell whether a vertex is on a plane at all.
const POINTS: usize = 8;
/// Rings of vertices in which a plane goes over into a curved part.
const BLENDED: usize = 4;
/// Vertices that one task looks at.
const CHUNK: usize = 1 << 12;

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
    /// The plane, or another sheet with a number; `None` on a curved part.
    pub(super) plane: Option<u32>,
    /// Whether it lies in a plane.
    pub(super) is_flat: bool,
    /// The plane, or the tangent plane of the curved part.
    pub(super) flat: Flat,
}

/// Two neighbouring vertices on curved parts have a crease between them from this angle on; its cosine: 25 degrees.
pub(super) const CREASE: f64 = 0.906;

impl Sheet {
    /// Whether a crease lies between this and another.
    pub(super) fn meets(&self, other: &Self) -> bool {
        match (self.plane, other.plane) {
            (Some(a), Some(b)) => a != b,
            _ => vec3::dot(self.flat.normal, other.flat.normal) < CREASE,
        }
    }
}

/// The sheets of all vertices.
pub(super) struct Sheets {
    of: Vec<Sheet>,
    /// The operand that each vertex belongs to; none are told where there is only one.
    operands: Vec<u32>,
    /// Whether curved parts of an operand may have creases.
    curved_creases: Vec<bool>,
}

impl Sheets {
    /// Sheets that are known, and the operands that they belong to. Between two operands there may always be a crease.
    pub(super) fn given(of: Vec<Sheet>, operands: Vec<u32>, curved_creases: Vec<bool>) -> Self {
        Self { of, operands, curved_creases }
    }

    /// The sheet of a vertex.
    pub(super) fn of(&self, v: u32) -> &Sheet {
        &self.of[v as usize]
    }

    /// Whether a crease runs between two neighbouring vertices.
    pub(super) fn meet(&self, a: u32, b: u32) -> bool {
        let operand = |v: u32| self.operands.get(v as usize).copied().unwrap_or(0);
        let may = operand(a) != operand(b) || self.curved_creases[operand(a) as usize];
        let (a, b) = (self.of(a), self.of(b));
        (may || a.plane.is_some() && b.plane.is_some()) && a.meets(b)
    }
}

/// A vertex that may be on several sheets.
struct Contested {
    vertex: u32,
    candidates: Vec<Candidate>,
}

/// Finds the sheets of all vertices.
pub(super) fn sheets(mesh: &Mesh, stars: &Stars, known: &Known) -> Sheets {
    let normals = normals(mesh);
    let (mut planes, contested) = candidates(mesh, &normals, known);
    agree(&mut planes, &contested, stars);
    let flat_of = |i: u32| known.facets.flats[i as usize];
    let sheet = |v: usize, normal: Vec3| match planes[v] {
        Some(i) => Sheet { plane: Some(i), is_flat: true, flat: flat_of(i) },
        None => Sheet { plane: None, is_flat: false, flat: Flat::through(normal, mesh.vertices[v]) },
    };
    let of = if known.curved_creases {
        let own = |v: u32| match contested.binary_search_by_key(&v, |c| c.vertex) {
            Ok(i) => contested[i].candidates.clone(),
            Err(_) => planes[v as usize].map(|i| Candidate { plane: Some(i), cost: 0.0 }).into_iter().collect(),
        };
        curved::sheets(mesh, stars, &normals, &planes, own, known)
    } else {
        (0..planes.len()).into_par_iter().map(|v| sheet(v, normals[v])).collect()
    };
    drop((planes, contested));
    let mut sheets = Sheets { of, operands: Vec::new(), curved_creases: vec![known.curved_creases] };
    let borders = borders(stars, &sheets);
    for (v, share) in unproven(mesh, stars, known, &sheets) {
        let (p, normal) = (mesh.vertices[v as usize], normals[v as usize]);
        let position = vec3::lerp(p, sheets.of(v).flat.foot(p), share);
        sheets.of[v as usize] = Sheet { plane: None, is_flat: false, flat: Flat::through(normal, position) };
    }
    blend(mesh, stars, &mut sheets, borders);
    sheets
}

/// The vertices on planes that run into curved parts without a crease.
fn borders(stars: &Stars, sheets: &Sheets) -> Vec<u32> {
    let runs_on = |&v: &u32| {
        let own = sheets.of(v);
        let is_curved = |&u: &u32| sheets.of(u).plane.is_none() && !sheets.of(u).meets(own);
        own.plane.is_some() && stars.around(v).iter().any(is_curved)
    };
    (0..sheets.of.len() as u32).into_par_iter().filter(runs_on).collect()
}

/// Leads planes over into curved parts: from their borders on so many rings of vertices go to the plane by shares that rise. Else a plane
/// taken for a part of something round would stand out by a step.
fn blend(mesh: &Mesh, stars: &Stars, sheets: &mut Sheets, mut ring: Vec<u32>) {
    ring.retain(|&v| sheets.of(v).plane.is_some());
    let mut is_blended = vec![false; sheets.of.len()];
    for step in 1..=BLENDED {
        ring.retain(|&v| !std::mem::replace(&mut is_blended[v as usize], true));
        let mut next = Vec::new();
        for &v in &ring {
            let Sheet { plane, flat, .. } = *sheets.of(v);
            next.extend(stars.around(v).iter().copied().filter(|&u| sheets.of(u).plane == plane));
            let p = mesh.vertices[v as usize];
            let position = vec3::lerp(p, flat.foot(p), step as f64 / (BLENDED + 1) as f64);
            sheets.of[v as usize].flat = Flat::through(flat.normal, position);
        }
        ring = next;
    }
}

/// The cheapest plane of each vertex, and the vertices that have a choice, in their order.
fn candidates(mesh: &Mesh, normals: &[Vec3], known: &Known) -> (Vec<Option<u32>>, Vec<Contested>) {
    let parts: Vec<(Vec<Option<u32>>, Vec<Contested>)> = mesh
        .vertices
        .par_chunks(CHUNK)
        .enumerate()
        .map(|(chunk, vertices)| {
            let mut found = Vec::new();
            let (mut planes, mut contested) = (Vec::with_capacity(vertices.len()), Vec::new());
            for (i, &p) in vertices.iter().enumerate() {
                let v = chunk * CHUNK + i;
                let candidates = planes_near(p, normals[v], known, &mut found);
                planes.push(candidates.iter().min_by(|a, b| a.cost.total_cmp(&b.cost)).and_then(|c| c.plane));
                if candidates.len() > 1 {
                    contested.push(Contested { vertex: v as u32, candidates });
                }
            }
            (planes, contested)
        })
        .collect();
    let (planes, contested): (Vec<_>, Vec<_>) = parts.into_iter().unzip();
    (planes.concat(), contested.into_iter().flatten().collect())
}

/// Lets vertices with a choice agree with their neighbours, as it costs something to differ from them.
fn agree(planes: &mut [Option<u32>], contested: &[Contested], stars: &Stars) {
    for _ in 0..ROUNDS {
        let chosen: Vec<Option<u32>> = contested
            .par_iter()
            .map(|Contested { vertex, candidates }| {
                let around = stars.around(*vertex);
                let cost = |c: &Candidate| {
                    let others = around.iter().filter(|&&u| planes[u as usize] != c.plane).count();
                    c.cost + DISAGREEMENT * others as f64 / around.len().max(1) as f64
                };
                candidates.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).and_then(|c| c.plane)
            })
            .collect();
        for (Contested { vertex, .. }, plane) in contested.iter().zip(chosen) {
            planes[*vertex as usize] = plane;
        }
    }
}

/// The planes that a vertex may belong to, and what it costs to be on a curved part.
fn planes_near(p: Vec3, normal: Vec3, known: &Known, found: &mut Vec<NearFacet>) -> Vec<Candidate> {
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
        [] => return own,
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
