//! Facets and lines cut along the tetrahedra of the lattice, with the exact integral of the square of F over each piece.

use rayon::prelude::*;

use super::cut::{in_pieces, in_tetrahedra, middle, slabs};
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

/// What F is to vanish on beside points, in the frame of the lattice.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Held<'a> {
    /// Facets of planes that were found.
    pub(crate) facets: &'a [OrientedTriangle],
    /// Triangles of which no side is known to be outside: F tells it where they lie.
    pub(crate) triangles: &'a [[Vec3; 3]],
    /// Lines.
    pub(crate) segments: &'a [[Vec3; 2]],
    /// A box in which F is polished even where there are no points.
    pub(crate) reach: Option<[Vec3; 2]>,
}

impl Held<'_> {
    /// The corners of all.
    pub(super) fn corners(&self) -> impl Iterator<Item = Vec3> + '_ {
        let facets = self.facets.iter().flat_map(|facet| facet.corners);
        facets.chain(self.triangles.iter().flatten().copied()).chain(self.segments.iter().flatten().copied())
    }
}

/// What is known of the side of a piece that is outside.
#[derive(Debug, Clone, Copy)]
enum Side {
    /// The unit normal points there.
    Outward(Vec3),
    /// The unit normal or its opposite does.
    Either(Vec3),
    /// A line has no sides.
    Line,
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

/// A facet or a line counts where F vanishes within so many cells.
const FARTHEST: f64 = 1.7;
/// A facet counts where it faces the way that F rises, within this cosine.
const FACING: f64 = 0.17;
/// The weight with which a facet tells a node its direction, for each squared cell of its area.
const PIN: f32 = 10.0;

/// The pieces of all facets and lines, and what they ask for.
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
    /// The outward normal of a facet.
    normal: Option<Vec3>,
}

impl Pieces {
    pub(super) fn new(
        field: &LatticeField,
        held: Held<'_>,
        directions: &Directions,
        d: &[f32],
        known: &[Mask],
    ) -> Self {
        let lattice = &field.lattice;
        let enter = |p: Vec3| vec3::scale(vec3::sub(p, lattice.origin), 1.0 / lattice.spacing);
        let facets = held.facets.par_iter().map(|facet| (facet.corners, Side::Outward(facet.normal)));
        let triangles = held.triangles.par_iter().filter_map(|&corners| {
            let [a, b, c] = corners;
            Some((corners, Side::Either(vec3::normalized(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))?)))
        });
        let strips: Vec<(Vec<Vec3>, Side)> = facets
            .chain(triangles)
            .flat_map_iter(|(corners, side)| {
                slabs(corners.map(enter).to_vec(), |p: &Vec3| p[0]).into_iter().map(move |slab| (slab, side))
            })
            .collect();
        let near = (field, directions, d, known);
        let mut parts: Vec<Vec<Placed>> = strips
            .into_par_iter()
            .map(|(slab, side)| {
                let mut placed = Vec::new();
                for column in slabs(slab, |p: &Vec3| p[1]) {
                    for cell in slabs(column, |p: &Vec3| p[2]) {
                        for part in in_tetrahedra(cell) {
                            placed.extend(place(&part, side, near));
                        }
                    }
                }
                placed
            })
            .collect();
        let lines = held
            .segments
            .par_iter()
            .map(|ends| in_pieces(ends.map(enter)).iter().filter_map(|part| place(part, Side::Line, near)).collect());
        parts.par_extend(lines);
        let mut all = Self {
            of_block: vec![Vec::new(); field.blocks.len()],
            pins: Pins { of_block: (0..field.blocks.len()).map(|_| None).collect() },
        };
        for Placed { block, piece, weights, normal } in parts.into_iter().flatten() {
            let b = block as usize;
            let corners = TETRAHEDRA[usize::from(piece.tetrahedron)].corners;
            for (corner, weight) in corners.into_iter().zip(weights) {
                if let (Some(normal), Some(node)) = (normal, node_of(field, b, piece.local, corner)) {
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

/// The piece of a polygon, or of a segment, within one tetrahedron; `None` where F does not follow it.
fn place(
    corners: &[Vec3],
    side: Side,
    (field, directions, d, known): (&LatticeField, &Directions, &[f32], &[Mask]),
) -> Option<Placed> {
    let centre = middle(corners);
    let cell = centre.map(f64::floor);
    if cell.iter().any(|c| *c < 0.0) {
        return None;
    }
    let fractions = |p: &Vec3| -> [f32; 3] { std::array::from_fn(|a| (p[a] - cell[a]).clamp(0.0, 1.0) as f32) };
    let t = tetrahedron_of(fractions(&centre));
    let node = cell.map(|c| c as u32);
    let b = field.blocks.find(node.map(|c| c / 8))?;
    let local = (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as u16;
    let (mut value, mut direction) = (0.0, [0.0; 3]);
    for (corner, weight) in TETRAHEDRA[t].corners.into_iter().zip(barycentric(t, fractions(&centre))) {
        let (other, place) = node_of(field, b, local, corner)?;
        if !mask_get(&known[other], place) {
            return None;
        }
        let index = other * 512 + place;
        value += f64::from(weight * d[index]);
        (0..3).for_each(|a| direction[a] += f64::from(weight * directions.0[a][index]));
    }
    let normal = match side {
        Side::Outward(normal) => Some(normal),
        Side::Either(normal) => Some(vec3::scale(normal, 1.0_f64.copysign(vec3::dot(direction, normal)))),
        Side::Line => None,
    };
    if value.abs() > FARTHEST || normal.is_some_and(|normal| vec3::dot(direction, normal) < FACING) {
        return None;
    }
    let at = |p: &Vec3| barycentric(t, fractions(p));
    let mut integrals = Integrals::default();
    if let [from, to] = corners {
        integrals.segment([at(from), at(to)], vec3::distance(*from, *to) as f32);
    } else {
        for pair in corners[1..].windows(2) {
            let spanned = vec3::cross(vec3::sub(pair[0], corners[0]), vec3::sub(pair[1], corners[0]));
            integrals.triangle([at(&corners[0]), at(&pair[0]), at(&pair[1])], 0.5 * vec3::norm(spanned) as f32);
        }
    }
    let Integrals { weights, moments } = integrals;
    Some(Placed { block: b as u32, piece: Piece { local, tetrahedron: t as u8, moments }, weights, normal })
}

/// Integrals of the barycentric weights and of their products, which are exact.
#[derive(Default)]
struct Integrals {
    weights: [f32; 4],
    moments: [[f32; 4]; 4],
}

impl Integrals {
    fn triangle(&mut self, values: [[f32; 4]; 3], area: f32) {
        let sum: [f32; 4] = std::array::from_fn(|k| values.iter().map(|v| v[k]).sum());
        for i in 0..4 {
            self.weights[i] += area / 3.0 * sum[i];
            for j in 0..4 {
                let products: f32 = values.iter().map(|v| v[i] * v[j]).sum();
                self.moments[i][j] += area / 12.0 * (products + sum[i] * sum[j]);
            }
        }
    }

    /// Simpson's rule.
    fn segment(&mut self, [from, to]: [[f32; 4]; 2], length: f32) {
        for i in 0..4 {
            self.weights[i] += length / 2.0 * (from[i] + to[i]);
            for j in 0..4 {
                let middle = (from[i] + to[i]) * (from[j] + to[j]);
                self.moments[i][j] += length / 6.0 * (from[i] * from[j] + middle + to[i] * to[j]);
            }
        }
    }
}
