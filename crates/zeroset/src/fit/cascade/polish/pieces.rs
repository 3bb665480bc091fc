//! Facets cut along the tetrahedra of the lattice, with the exact integral of the square of F over each piece.

use rayon::prelude::*;

use super::directions::Directions;
use crate::domain::{Mask, TETRAHEDRA, barycentric, mask_get, tetrahedron_of};
use crate::field::LatticeField;
use crate::vec3::{self, Vec3};

/// A triangle of a facet, in the frame of the lattice.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OrientedTriangle {
    pub(crate) corners: [Vec3; 3],
    /// Unit normal, which points outward.
    pub(crate) normal: Vec3,
}

/// The matrix of one piece: the integral of F^2 over it is `b' moments b` for the values b at the corners of its tetrahedron.
#[derive(Debug, Clone, Copy)]
pub(in super::super) struct Piece {
    /// Place of the cell in its block, `x | y << 3 | z << 6`.
    pub(in super::super) local: u16,
    pub(in super::super) tetrahedron: u8,
    pub(in super::super) moments: [[f32; 4]; 4],
}

/// The directions that facets ask for at nodes.
#[derive(Debug, Default)]
pub(super) struct Pins {
    /// For each block 512 vectors, or none.
    of_block: Vec<Option<Box<[[f32; 3]]>>>,
}

impl Pins {
    /// What a node is asked to point along; its length is the weight.
    pub(super) fn at(&self, b: usize, local: usize) -> Option<[f32; 3]> {
        self.of_block[b].as_ref().map(|vectors| vectors[local])
    }

    fn add(&mut self, (b, local): (usize, usize), vector: [f32; 3]) {
        let vectors = self.of_block[b].get_or_insert_with(|| vec![[0.0; 3]; 512].into_boxed_slice());
        (0..3).for_each(|a| vectors[local][a] += vector[a]);
    }
}

/// A facet counts where F vanishes within so many cells.
const FARTHEST: f64 = 1.7;
/// A facet counts where it faces the way that F rises, within this cosine.
const FACING: f64 = 0.17;
/// The weight with which a facet tells a node its direction, for each squared cell of its area.
const PIN: f32 = 10.0;

/// The pieces of all facets, and what they ask for.
pub(super) struct Pieces {
    /// For each block those in its cells.
    pub(super) of_block: Vec<Vec<Piece>>,
    pub(super) pins: Pins,
}

/// A piece with where it lies.
struct Placed {
    block: u32,
    piece: Piece,
    /// The integral of each corner's barycentric weight.
    weights: [f32; 4],
    normal: Vec3,
}

impl Pieces {
    pub(super) fn new(
        field: &LatticeField,
        facets: &[OrientedTriangle],
        directions: &Directions,
        d: &[f32],
        known: &[Mask],
    ) -> Self {
        let lattice = &field.lattice;
        let enter = |p: Vec3| vec3::scale(vec3::sub(p, lattice.origin), 1.0 / lattice.spacing);
        let strips: Vec<(Vec<Vec3>, Vec3)> = facets
            .par_iter()
            .flat_map_iter(|facet| {
                let normal = facet.normal;
                slabs(facet.corners.map(enter).to_vec(), |p: &Vec3| p[0]).into_iter().map(move |slab| (slab, normal))
            })
            .collect();
        let parts: Vec<Vec<Placed>> = strips
            .into_par_iter()
            .map(|(slab, normal)| {
                let mut placed = Vec::new();
                for column in slabs(slab, |p: &Vec3| p[1]) {
                    for cell in slabs(column, |p: &Vec3| p[2]) {
                        for part in in_tetrahedra(cell) {
                            placed.extend(place(&part, normal, (field, directions, d, known)));
                        }
                    }
                }
                placed
            })
            .collect();
        let mut all = Self {
            of_block: vec![Vec::new(); field.blocks.len()],
            pins: Pins { of_block: (0..field.blocks.len()).map(|_| None).collect() },
        };
        for Placed { block, piece, weights, normal } in parts.into_iter().flatten() {
            let b = block as usize;
            let corners = TETRAHEDRA[usize::from(piece.tetrahedron)].corners;
            for (corner, weight) in corners.into_iter().zip(weights) {
                if let Some(node) = node_of(field, b, piece.local, corner) {
                    all.pins.add(node, normal.map(|n| PIN * weight * n as f32));
                }
            }
            all.of_block[b].push(piece);
        }
        all
    }
}

/// Block and place of a corner of a cell.
fn node_of(field: &LatticeField, b: usize, local: u16, corner: usize) -> Option<(usize, usize)> {
    let node: [usize; 3] = std::array::from_fn(|a| usize::from(local >> (3 * a) & 7) + (corner >> a & 1));
    let step = node.map(|c| i32::from(c > 7));
    let other = field.blocks.neighbors[b][crate::domain::neighbor_code(step)];
    let place = node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6;
    (other != crate::domain::NONE).then_some((other as usize, place))
}

/// Cuts a convex polygon where a linear function takes whole values.
fn slabs(mut rest: Vec<Vec3>, value: impl Fn(&Vec3) -> f64) -> Vec<Vec<Vec3>> {
    let (low, high) =
        rest.iter().map(&value).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let mut parts = Vec::new();
    let mut level = low.floor() + 1.0;
    while level < high {
        let [below, above] = cut(&rest, |p| value(p) - level);
        parts.push(below);
        rest = above;
        level += 1.0;
    }
    parts.push(rest);
    parts.retain(|part| part.len() > 2);
    parts
}

/// The parts of a convex polygon where a linear function is negative, and where it is not.
fn cut(polygon: &[Vec3], value: impl Fn(&Vec3) -> f64) -> [Vec<Vec3>; 2] {
    let mut parts = [Vec::with_capacity(polygon.len() + 1), Vec::with_capacity(polygon.len() + 1)];
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (here, there) = (value(p), value(q));
        parts[usize::from(here >= 0.0)].push(*p);
        if (here < 0.0) != (there < 0.0) {
            let crossing = vec3::lerp(*p, *q, here / (here - there));
            parts.iter_mut().for_each(|part| part.push(crossing));
        }
    }
    parts
}

/// Cuts a polygon that lies in one cell along the faces of the cell's tetrahedra.
fn in_tetrahedra(polygon: Vec<Vec3>) -> Vec<Vec<Vec3>> {
    let centre = middle(&polygon).map(f64::floor);
    let mut parts = vec![polygon];
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let difference = |p: &Vec3| (p[a] - centre[a]) - (p[b] - centre[b]);
        parts = parts.iter().flat_map(|part| cut(part, difference)).filter(|part| part.len() > 2).collect();
    }
    parts
}

fn middle(polygon: &[Vec3]) -> Vec3 {
    vec3::scale(polygon.iter().fold([0.0; 3], |sum, p| vec3::add(sum, *p)), 1.0 / polygon.len() as f64)
}

/// The piece of a polygon within one tetrahedron; `None` where F does not follow the facet.
fn place(
    polygon: &[Vec3],
    normal: Vec3,
    (field, directions, d, known): (&LatticeField, &Directions, &[f32], &[Mask]),
) -> Option<Placed> {
    let centre = middle(polygon);
    let cell = centre.map(f64::floor);
    if cell.iter().any(|c| *c < 0.0) {
        return None;
    }
    let fractions = |p: &Vec3| -> [f32; 3] { std::array::from_fn(|a| (p[a] - cell[a]).clamp(0.0, 1.0) as f32) };
    let t = tetrahedron_of(fractions(&centre));
    let node = cell.map(|c| c as u32);
    let b = field.blocks.find(node.map(|c| c / 8))?;
    let local = (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as u16;
    let (mut value, mut facing) = (0.0, 0.0);
    for (corner, weight) in TETRAHEDRA[t].corners.into_iter().zip(barycentric(t, fractions(&centre))) {
        let (other, place) = node_of(field, b, local, corner)?;
        if !mask_get(&known[other], place) {
            return None;
        }
        let index = other * 512 + place;
        value += f64::from(weight * d[index]);
        facing += (0..3).map(|a| f64::from(weight * directions.0[a][index]) * normal[a]).sum::<f64>();
    }
    if value.abs() > FARTHEST || facing < FACING {
        return None;
    }
    let mut moments = [[0.0_f32; 4]; 4];
    let mut weights = [0.0_f32; 4];
    let first = barycentric(t, fractions(&polygon[0]));
    for pair in polygon[1..].windows(2) {
        let area = 0.5 * vec3::norm(vec3::cross(vec3::sub(pair[0], polygon[0]), vec3::sub(pair[1], polygon[0]))) as f32;
        let values = [first, barycentric(t, fractions(&pair[0])), barycentric(t, fractions(&pair[1]))];
        let sum: [f32; 4] = std::array::from_fn(|k| values.iter().map(|v| v[k]).sum());
        for i in 0..4 {
            weights[i] += area / 3.0 * sum[i];
            for j in 0..4 {
                // The integral of a product of two linear functions over a triangle.
                let products: f32 = values.iter().map(|v| v[i] * v[j]).sum();
                moments[i][j] += area / 12.0 * (products + sum[i] * sum[j]);
            }
        }
    }
    Some(Placed { block: b as u32, piece: Piece { local, tetrahedron: t as u8, moments }, weights, normal })
}
