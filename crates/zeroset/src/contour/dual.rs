//! One vertex in each active tetrahedron of a lattice, one polygon around each crossed edge.

use std::sync::atomic::{AtomicU8, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::active::{ActiveBlock, LatticeCells, activate, cell_in_block, corner_values};
use super::placement::{Placement, PlacementReport, Sector, place, sectors};
use super::rings::RINGS;
use super::seam::{OwnNodes, Seam, key_of};
use super::split::split_fans;
use super::triangulate::triangulate;
use crate::domain::{NONE, neighbor_code};
use crate::field::LatticeField;
use crate::mesh::Mesh;
use crate::vec3::Vec3;

/// How the zero set is extracted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ContourParams {
    /// Where in its tetrahedron a vertex goes.
    pub placement: Placement,
}

/// What the extraction did.
#[derive(Debug, Clone, PartialEq, Serialize, Default)]
pub struct ContourReport {
    /// Tetrahedra on which F has both signs.
    pub active_tetrahedra: usize,
    /// Polygons left out by the trim.
    pub trimmed_polygons: usize,
    /// Vertices split because two fans met in them after the trim.
    pub split_vertices: usize,
    /// The sweeps of the placement; `None` where vertices are means of crossings.
    pub placement: Option<PlacementReport>,
}

/// Blocks whose triangles are made at once: enough for all threads, and few against a large field.
const BLOCKS_AT_ONCE: usize = 2048;

/// Extracts the zero set, with vertices at the means of the crossings. `keep` is asked at the middle of each crossed edge whether its
/// polygon stays.
///
/// Positions of the mesh are in the coordinates of the lattice, `world_from_local` is zero.
#[must_use]
pub fn contour(field: &LatticeField, keep: impl Fn([f64; 3]) -> bool + Sync) -> (Mesh, ContourReport) {
    contour_with(field, &ContourParams::default(), keep)
}

/// Extracts the zero set as [`contour`] does, with a choice of where vertices go.
///
/// For a segmentation give values of -1 and 1.
#[must_use]
pub fn contour_with(
    field: &LatticeField,
    params: &ContourParams,
    keep: impl Fn([f64; 3]) -> bool + Sync,
) -> (Mesh, ContourReport) {
    let (mesh, _, report) = extract(field, params, None, keep);
    (mesh, report)
}

/// Extracts a part of the zero set as [`contour`] does, together with what is known around it.
pub(crate) fn contour_part(
    field: &LatticeField,
    own: OwnNodes<'_>,
    keep: impl Fn([f64; 3]) -> bool + Sync,
) -> (Mesh, Seam, ContourReport) {
    extract(field, &ContourParams::default(), Some(own), keep)
}

/// A vertex of this kind loses a polygon,
const RIM: u8 = 1;
/// has polygons of the part's own, whether they stay or not,
const OWN: u8 = 2;
/// and has others.
const OTHER: u8 = 4;

/// Without own nodes all polygons are the part's own, and there is no seam.
fn extract(
    field: &LatticeField,
    params: &ContourParams,
    own: Option<OwnNodes<'_>>,
    keep: impl Fn([f64; 3]) -> bool + Sync,
) -> (Mesh, Seam, ContourReport) {
    let active: Vec<Option<ActiveBlock>> =
        (0..field.blocks.len()).into_par_iter().with_min_len(8).map(|b| activate(field, b)).collect();
    let mut first_vertex = Vec::with_capacity(active.len());
    let mut total = 0_u32;
    for block in &active {
        first_vertex.push(total);
        total += block.as_ref().map_or(0, |a| a.count);
    }
    let mut vertices = place_vertices(field, &active, total);
    let marks: Vec<AtomicU8> = (0..total).into_par_iter().map(|_| AtomicU8::new(0)).collect();
    let rings = Rings { field, active: &active, first_vertex: &first_vertex, marks: &marks, own };
    let placement = match &params.placement {
        Placement::MeanOfCrossings => None,
        Placement::LeastCurvature(least) => {
            let cells = LatticeCells::new(field, &active);
            Some(place(&mut vertices, &rings.sectors(), &cells, least))
        }
    };
    let (mut triangles, mut seam) = (Vec::new(), Seam::default());
    let mut trimmed_polygons = 0;
    for first in (0..active.len()).step_by(BLOCKS_AT_ONCE) {
        let parts: Vec<Polygons> = (first..active.len().min(first + BLOCKS_AT_ONCE))
            .into_par_iter()
            .with_min_len(8)
            .map(|b| rings.polygons(b, &vertices, &keep))
            .collect();
        for part in parts {
            triangles.extend_from_slice(&part.triangles);
            seam.own.extend_from_slice(&part.own);
            trimmed_polygons += part.trimmed;
        }
    }
    drop(first_vertex);
    let marks: Vec<u8> = marks.into_iter().map(AtomicU8::into_inner).collect();
    let mut mesh = Mesh { vertices, triangles, ..Mesh::default() };
    let rim: Vec<bool> = marks.iter().map(|mark| mark & RIM != 0).collect();
    let (split_vertices, old) = split_fans(&mut mesh, &rim);
    if own.is_some() {
        let cells = LatticeCells::new(field, &active);
        let is_held = |&(_, old): &(usize, &u32)| marks[*old as usize] & (OWN | OTHER) == OWN | OTHER;
        let key = |(new, old): (usize, &u32)| {
            let (cell, t) = cells.place(*old as usize);
            (new as u32, key_of(cell, t))
        };
        seam.keys = old.iter().enumerate().filter(is_held).map(key).collect();
    }
    (mesh, seam, ContourReport { active_tetrahedra: total as usize, trimmed_polygons, split_vertices, placement })
}

fn place_vertices(field: &LatticeField, active: &[Option<ActiveBlock>], total: u32) -> Vec<[f64; 3]> {
    let mut vertices = vec![[0.0; 3]; total as usize];
    let mut rest = vertices.as_mut_slice();
    let mut places = Vec::with_capacity(active.len());
    for (b, block) in active.iter().enumerate() {
        let Some(block) = block else { continue };
        let (own, after) = rest.split_at_mut(block.count as usize);
        places.push((b, block, own));
        rest = after;
    }
    places.into_par_iter().with_min_len(8).for_each(|(b, block, own)| {
        let Some(values) = corner_values(field, b) else { return };
        let corner = field.blocks.coordinates[b].map(|c| f64::from(8 * c));
        let mut own = own.iter_mut();
        for (local, cell) in block.cells.iter().enumerate() {
            let origin = [local & 7, local >> 3 & 7, local >> 6];
            for (t, vertex) in (0..6).filter(|t| cell >> (16 + t) & 1 == 1).zip(&mut own) {
                let p = cell_in_block(&values, origin, t).mean_of_crossings();
                let node = std::array::from_fn(|a| corner[a] + p[a]);
                *vertex = field.lattice.position(field.lattice.finest, node);
            }
        }
    });
    vertices
}

/// What the polygons are made from.
struct Rings<'a> {
    field: &'a LatticeField,
    active: &'a [Option<ActiveBlock>],
    first_vertex: &'a [u32],
    /// What is known of each vertex.
    marks: &'a [AtomicU8],
    /// Whose polygons are the part's own; `None`: all are.
    own: Option<OwnNodes<'a>>,
}

/// What is made of the edges of a block.
#[derive(Default)]
struct Polygons {
    triangles: Vec<[u32; 3]>,
    /// For each triangle whether it is the part's own; empty without own nodes.
    own: Vec<bool>,
    /// Polygons left out by the trim.
    trimmed: usize,
}

/// A lattice edge along which F changes sign.
struct Crossing {
    /// Its first node.
    node: [u32; 3],
    /// The axes that it runs along, as bits.
    subset: usize,
    /// Whether F < 0 at its first node.
    outward: bool,
    /// Where F vanishes on it, in nodes of the finest level.
    place: Vec3,
    ring: Ring,
}

impl Crossing {
    /// Whether all tetrahedra around the edge are known.
    fn is_whole(&self) -> bool {
        self.ring.len == RINGS[self.subset].len()
    }
}

impl Rings<'_> {
    /// Visits the crossed edges that begin at the nodes of block `b`.
    fn visit(&self, b: usize, mut visit: impl FnMut(&Crossing)) {
        let (Some(block), Some(values)) = (&self.active[b], corner_values(self.field, b)) else { return };
        let corner = self.field.blocks.coordinates[b].map(|c| f64::from(8 * c));
        // The cell itself is part of the ring of each edge that begins at its first corner.
        for (local, _) in block.cells.iter().enumerate().filter(|(_, entry)| *entry >> 16 != 0) {
            let origin = [local & 7, local >> 3 & 7, local >> 6];
            let here = values[origin[0] + 9 * origin[1] + 81 * origin[2]];
            for subset in 1..8_usize {
                let step: [usize; 3] = std::array::from_fn(|a| subset >> a & 1);
                let there = values[origin[0] + step[0] + 9 * (origin[1] + step[1]) + 81 * (origin[2] + step[2])];
                if here.is_nan() || there.is_nan() || (here < 0.0) == (there < 0.0) {
                    continue;
                }
                let s = f64::from(here) / (f64::from(here) - f64::from(there));
                let place = std::array::from_fn(|a| corner[a] + origin[a] as f64 + s * step[a] as f64);
                let node = std::array::from_fn(|a| 8 * self.field.blocks.coordinates[b][a] + origin[a] as u32);
                visit(&Crossing { node, subset, outward: here < 0.0, place, ring: self.ring(b, origin, subset) });
            }
        }
    }

    /// The sectors of all polygons that are whole, trimmed or not.
    fn sectors(&self) -> Vec<Sector> {
        let parts: Vec<Vec<Sector>> = (0..self.active.len())
            .into_par_iter()
            .with_min_len(8)
            .map(|b| {
                let mut part = Vec::new();
                self.visit(b, |crossing| {
                    if crossing.is_whole() {
                        part.extend(sectors(crossing.ring.facing(crossing.outward).as_slice()));
                    }
                });
                part
            })
            .collect();
        parts.concat()
    }

    /// What is made of the crossed edges that begin at the nodes of block `b`.
    fn polygons(&self, b: usize, vertices: &[Vec3], keep: &(impl Fn([f64; 3]) -> bool + Sync)) -> Polygons {
        let lattice = &self.field.lattice;
        let mut made = Polygons::default();
        self.visit(b, |crossing| {
            let is_own = self.own.is_none_or(|own| own([crossing.node[0], crossing.node[1]]));
            let mut mark = 0;
            if self.own.is_some() {
                mark = if is_own { OWN } else { OTHER };
            }
            if crossing.is_whole() && keep(lattice.position(lattice.finest, crossing.place)) {
                emit_polygon(crossing, vertices, &mut made.triangles);
                if self.own.is_some() {
                    made.own.resize(made.triangles.len(), is_own);
                }
            } else {
                made.trimmed += usize::from(crossing.is_whole());
                mark |= RIM;
            }
            if mark != 0 {
                crossing.ring.as_slice().iter().for_each(|&id| {
                    self.marks[id as usize].fetch_or(mark, Ordering::Relaxed);
                });
            }
        });
        made
    }

    /// The vertices around an edge; fewer than its tetrahedra where the ring is cut by the rim of what is known.
    fn ring(&self, b: usize, origin: [usize; 3], subset: usize) -> Ring {
        let mut ring = Ring { ids: [0; 6], len: 0 };
        for member in &RINGS[subset] {
            let cell: [i32; 3] = std::array::from_fn(|a| origin[a] as i32 + member.step[a]);
            let other = self.field.blocks.neighbors[b][neighbor_code(cell.map(|c| if c < 0 { -1 } else { 0 }))];
            if other == NONE {
                continue;
            }
            let Some(block) = &self.active[other as usize] else { continue };
            let entry = block.cells[(cell[0] & 7 | (cell[1] & 7) << 3 | (cell[2] & 7) << 6) as usize];
            let tetrahedra = entry >> 16;
            if tetrahedra >> member.tetrahedron & 1 == 1 {
                let before = (tetrahedra & ((1 << member.tetrahedron) - 1)).count_ones();
                ring.ids[ring.len] = self.first_vertex[other as usize] + (entry & 0xffff) + before;
                ring.len += 1;
            }
        }
        ring
    }
}

/// At most six vertices, counter-clockwise seen from the edge's far end.
#[derive(Clone, Copy)]
struct Ring {
    ids: [u32; 6],
    len: usize,
}

impl Ring {
    fn as_slice(&self) -> &[u32] {
        &self.ids[..self.len]
    }

    /// The ring as it is, or turned to be counter-clockwise seen from the near end.
    fn facing(mut self, outward: bool) -> Self {
        if !outward {
            self.ids[..self.len].reverse();
        }
        self
    }
}

/// Cuts the polygon of an edge into triangles that face from inside to outside.
fn emit_polygon(crossing: &Crossing, vertices: &[Vec3], triangles: &mut Vec<[u32; 3]>) {
    let &Crossing { subset, outward, .. } = crossing;
    let sign = if outward { 1.0 } else { -1.0 } / f64::from(subset.count_ones()).sqrt();
    let normal = std::array::from_fn(|a| sign * (subset >> a & 1) as f64);
    let ring = crossing.ring.facing(outward);
    let mut polygon = [[0.0; 3]; 6];
    for (p, &id) in polygon.iter_mut().zip(ring.as_slice()) {
        *p = vertices[id as usize];
    }
    triangulate(&polygon[..ring.len], normal, |t| triangles.push(t.map(|v| ring.ids[v])));
}
