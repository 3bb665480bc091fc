//! One vertex in each active tetrahedron, one polygon around each crossed edge.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;
use serde::Serialize;

use super::rings::RINGS;
use super::split::split_fans;
use super::triangulate::triangulate;
use crate::domain::{NONE, TETRAHEDRA, mask_get, neighbor_code};
use crate::field::LatticeField;
use crate::mesh::Mesh;

/// Crossings are kept this far from the ends of their edges, in parts of an edge, so that vertices of different tetrahedra never
/// coincide where F vanishes at a node. A hundredth of a cell is far below noise, and far above the rounding of
/// f32 formats.
const END: f64 = 0.01;

/// What the extraction did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Default)]
pub struct ContourReport {
    /// Tetrahedra on which F has both signs.
    pub active_tetrahedra: usize,
    /// Polygons left out by the trim.
    pub trimmed_polygons: usize,
    /// Vertices split because two fans met in them after the trim.
    pub split_vertices: usize,
}

/// Values at nodes 0..=8 of a block; NaN where unknown.
type Corner9 = [f32; 729];

/// A corner of the cell is unknown.
const CUT: u32 = 1 << 22;
/// Blocks whose triangles are made at once: enough for all threads, and few against a large field.
const BLOCKS_AT_ONCE: usize = 2048;

/// A block with cells that are active or cut.
struct ActiveBlock {
    /// For each cell the number of vertices before it in the block (low 16 bits), its six active tetrahedra (above), or [`CUT`].
    cells: Box<[u32; 512]>,
    /// Number of vertices of the block.
    count: u32,
}

/// Extracts the zero set. `keep` is asked at the middle of each crossed edge whether its polygon stays.
///
/// Positions of the mesh are in the coordinates of the lattice, `world_from_local` is zero.
#[must_use]
pub fn contour(field: &LatticeField, keep: impl Fn([f64; 3]) -> bool + Sync) -> (Mesh, ContourReport) {
    let active: Vec<Option<ActiveBlock>> =
        (0..field.blocks.len()).into_par_iter().with_min_len(8).map(|b| activate(field, b)).collect();
    let mut first_vertex = Vec::with_capacity(active.len());
    let mut total = 0_u32;
    for block in &active {
        first_vertex.push(total);
        total += block.as_ref().map_or(0, |a| a.count);
    }
    let vertices = place_vertices(field, &active, total);
    let rim: Vec<AtomicBool> = (0..total).into_par_iter().map(|_| AtomicBool::new(false)).collect();
    let rings = Rings { field, active: &active, first_vertex: &first_vertex, vertices: &vertices, rim: &rim };
    let mut triangles = Vec::new();
    let mut trimmed_polygons = 0;
    for first in (0..active.len()).step_by(BLOCKS_AT_ONCE) {
        let parts: Vec<(Vec<[u32; 3]>, usize)> = (first..active.len().min(first + BLOCKS_AT_ONCE))
            .into_par_iter()
            .with_min_len(8)
            .map(|b| rings.polygons(b, &keep))
            .collect();
        for (part, trimmed) in parts {
            triangles.extend_from_slice(&part);
            trimmed_polygons += trimmed;
        }
    }
    drop((active, first_vertex));
    let rim: Vec<bool> = rim.into_iter().map(AtomicBool::into_inner).collect();
    let mut mesh = Mesh { vertices, triangles, ..Mesh::default() };
    let split_vertices = split_fans(&mut mesh, &rim);
    (mesh, ContourReport { active_tetrahedra: total as usize, trimmed_polygons, split_vertices })
}

/// The values around block `b`, or `None` if they have one sign.
fn corner_values(field: &LatticeField, b: usize) -> Option<Box<Corner9>> {
    let mut values = Box::new([f32::NAN; 729]);
    let (mut negative, mut positive) = (false, false);
    for after in 0..8_usize {
        let step: [i32; 3] = std::array::from_fn(|a| (after >> a & 1) as i32);
        let other = field.blocks.neighbors[b][neighbor_code(step)];
        if other == NONE {
            continue;
        }
        let (known, from) = (&field.known[other as usize], other as usize * 512);
        let range = |a: usize| if after >> a & 1 == 1 { 8..9_usize } else { 0..8 };
        for z in range(2) {
            for y in range(1) {
                for x in range(0) {
                    let local = (x & 7) | (y & 7) << 3 | (z & 7) << 6;
                    if mask_get(known, local) {
                        let value = field.values[from + local];
                        values[x + 9 * y + 81 * z] = value;
                        negative |= value < 0.0;
                        positive |= value >= 0.0;
                    }
                }
            }
        }
    }
    (negative && positive).then_some(values)
}

/// The corners of a cell as bits, set where F < 0; `None` if a corner is unknown.
fn corner_signs(values: &Corner9, local: usize) -> Option<usize> {
    let origin = (local & 7) + 9 * (local >> 3 & 7) + 81 * (local >> 6);
    let mut signs = 0;
    for corner in 0..8_usize {
        let value = values[origin + (corner & 1) + 9 * (corner >> 1 & 1) + 81 * (corner >> 2)];
        if value.is_nan() {
            return None;
        }
        signs |= usize::from(value < 0.0) << corner;
    }
    Some(signs)
}

/// For each pattern of corner signs the active tetrahedra, as bits.
const ACTIVE: [u8; 256] = {
    let mut table = [0; 256];
    let mut signs = 0;
    while signs < 256 {
        let mut t = 0;
        while t < 6 {
            let c = TETRAHEDRA[t].corners;
            let inside = (signs >> c[0] & 1) + (signs >> c[1] & 1) + (signs >> c[2] & 1) + (signs >> c[3] & 1);
            if inside != 0 && inside != 4 {
                table[signs] |= 1 << t;
            }
            t += 1;
        }
        signs += 1;
    }
    table
};

fn activate(field: &LatticeField, b: usize) -> Option<ActiveBlock> {
    let values = corner_values(field, b)?;
    let mut cells = Box::new([0; 512]);
    let (mut count, mut cut) = (0, false);
    for local in 0..512 {
        let entry = corner_signs(&values, local).map_or(CUT, |signs| u32::from(ACTIVE[signs]) << 16);
        cells[local] = count | entry;
        count += (entry & !CUT).count_ones();
        cut |= entry == CUT;
    }
    (count > 0 || cut).then_some(ActiveBlock { cells, count })
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
                let p = vertex_in_tetrahedron(&values, origin, t);
                let node = std::array::from_fn(|a| corner[a] + origin[a] as f64 + p[a]);
                *vertex = field.lattice.position(field.lattice.finest, node);
            }
        }
    });
    vertices
}

/// The mean of the places where F vanishes on the tetrahedron's edges, relative to the cell.
fn vertex_in_tetrahedron(values: &Corner9, origin: [usize; 3], t: usize) -> [f64; 3] {
    let place = |corner: usize| -> [usize; 3] { std::array::from_fn(|a| corner >> a & 1) };
    let corners = TETRAHEDRA[t].corners;
    let f = corners.map(|c| {
        let p = place(c);
        f64::from(values[origin[0] + p[0] + 9 * (origin[1] + p[1]) + 81 * (origin[2] + p[2])])
    });
    let (mut sum, mut count) = ([0.0; 3], 0.0);
    for i in 0..4 {
        for j in i + 1..4 {
            if (f[i] < 0.0) == (f[j] < 0.0) {
                continue;
            }
            let s = (f[i] / (f[i] - f[j])).clamp(END, 1.0 - END);
            let (p, q) = (place(corners[i]), place(corners[j]));
            for a in 0..3 {
                sum[a] += (1.0 - s) * p[a] as f64 + s * q[a] as f64;
            }
            count += 1.0;
        }
    }
    sum.map(|s| s / count)
}

/// What the polygons are made from.
struct Rings<'a> {
    field: &'a LatticeField,
    active: &'a [Option<ActiveBlock>],
    first_vertex: &'a [u32],
    vertices: &'a [[f64; 3]],
    /// Set for each vertex that loses a polygon.
    rim: &'a [AtomicBool],
}

impl Rings<'_> {
    /// The triangles around the crossed edges that begin at the nodes of block `b`, and the number of polygons trimmed.
    fn polygons(&self, b: usize, keep: &(impl Fn([f64; 3]) -> bool + Sync)) -> (Vec<[u32; 3]>, usize) {
        let field = self.field;
        let (Some(block), Some(values)) = (&self.active[b], corner_values(field, b)) else { return (Vec::new(), 0) };
        let corner = field.blocks.coordinates[b].map(|c| f64::from(8 * c));
        let mut triangles = Vec::new();
        let mut trimmed = 0;
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
                let ring = self.ring(b, origin, subset);
                let whole = ring.len == RINGS[subset].len();
                let kept = whole && {
                    let s = f64::from(here) / (f64::from(here) - f64::from(there));
                    let node = std::array::from_fn(|a| corner[a] + origin[a] as f64 + s * step[a] as f64);
                    keep(field.lattice.position(field.lattice.finest, node))
                };
                if kept {
                    emit_polygon(&ring, subset, here < 0.0, self.vertices, &mut triangles);
                } else {
                    trimmed += usize::from(whole);
                    ring.ids[..ring.len].iter().for_each(|&id| self.rim[id as usize].store(true, Ordering::Relaxed));
                }
            }
        }
        (triangles, trimmed)
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

/// At most six vertices.
struct Ring {
    ids: [u32; 6],
    len: usize,
}

/// Cuts a ring into triangles that face from inside to outside.
fn emit_polygon(ring: &Ring, subset: usize, outward: bool, vertices: &[[f64; 3]], triangles: &mut Vec<[u32; 3]>) {
    let n = ring.len;
    let sign = if outward { 1.0 } else { -1.0 } / f64::from(subset.count_ones()).sqrt();
    let normal = std::array::from_fn(|a| sign * (subset >> a & 1) as f64);
    let mut ids = ring.ids;
    if !outward {
        ids[..n].reverse();
    }
    let mut polygon = [[0.0; 3]; 6];
    for (p, &id) in polygon.iter_mut().zip(&ids[..n]) {
        *p = vertices[id as usize];
    }
    triangulate(&polygon[..n], normal, |t| triangles.push(t.map(|v| ids[v])));
}
