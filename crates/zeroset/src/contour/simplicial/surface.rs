//! The zero set in space: marching tetrahedra on a refined mesh.

use super::Branches;
use super::branches::{Component, kept};
use super::refine::{Refinement, Weights};
use super::roots::{bracketed, is_negative, linear, quadratic};
use crate::basis::Expansion;
use crate::domain::Place;
use crate::mesh::Mesh;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};
use rustc_hash::FxHashMap;

/// Most halvings of the edges: 2 million parts a tetrahedron.
const MOST_SUBDIVISIONS: u32 = 7;

/// The zero set of F as triangles, counter-clockwise seen from F > 0.
///
/// Each tetrahedron is cut into 8^`subdivisions` parts first, at most 8^7, unless F is linear on it. Positions are local;
/// `world_from_local` of the mesh is zero.
#[must_use]
pub fn zero_surface(f: &Expansion<'_, 3>, subdivisions: u32, branches: Branches<'_, 3>) -> Mesh {
    let subdivisions = if f.basis().degree() == Some(1) { 0 } else { subdivisions.min(MOST_SUBDIVISIONS) };
    let mut march = March::new(f, Refinement::new(subdivisions));
    let mut patches = Vec::new();
    for simplex in (0..f.domain().len()).filter(|&s| f.is_defined(s)) {
        let pieces = march.cell(simplex);
        march.add_patches(simplex, pieces, &mut patches);
    }
    let kept = kept(f.domain(), &patches, branches);
    let triangles = patches.iter().zip(kept).filter(|(_, kept)| *kept).flat_map(|(patch, _)| &patch.triangles);
    compacted(&march.vertices, triangles.copied())
}

/// A connected part of the zero set in one tetrahedron of the domain.
struct Patch {
    simplex: usize,
    triangles: Vec<[u32; 3]>,
    corners: Vec<[Vec3; 3]>,
    /// Its edges on the faces of the tetrahedron.
    links: Vec<u64>,
}

impl Component for Patch {
    fn cell(&self) -> usize {
        self.simplex
    }

    fn links(&self) -> &[u64] {
        &self.links
    }

    fn tree(&self) -> TriangleTree {
        let vertices = self.corners.as_flattened().to_vec();
        let triangles = (0..self.corners.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        TriangleTree::new(&Mesh { vertices, triangles, ..Mesh::default() })
    }
}

/// A node of the refined mesh: vertices of the domain with their weights, ascending; unused entries have no weight.
type NodeKey = [(u32, u32); 4];

#[derive(Clone, Copy)]
struct Node {
    value: f64,
    position: Vec3,
}

/// A vertex of the surface in one tetrahedron.
#[derive(Clone, Copy)]
struct Corner {
    vertex: u32,
    /// One bit for each corner of the tetrahedron that the vertex does not lie opposite to.
    support: u8,
}

/// Cuts cell by cell. What belongs to nodes and edges is computed once, so that all cells around agree on it.
struct March<'a> {
    f: &'a Expansion<'a, 3>,
    refinement: Refinement,
    node_of: FxHashMap<NodeKey, u32>,
    nodes: Vec<Node>,
    vertex_of: FxHashMap<[u32; 2], u32>,
    vertices: Vec<Vec3>,
}

impl<'a> March<'a> {
    fn new(f: &'a Expansion<'a, 3>, refinement: Refinement) -> Self {
        let (node_of, vertex_of) = (FxHashMap::default(), FxHashMap::default());
        Self { f, refinement, node_of, nodes: Vec::new(), vertex_of, vertices: Vec::new() }
    }

    /// The triangles in a tetrahedron of the domain.
    fn cell(&mut self, simplex: usize) -> Vec<[Corner; 3]> {
        let nodes: Vec<u32> = (0..self.refinement.nodes.len()).map(|n| self.node(simplex, n)).collect();
        let value = |n: u32| self.nodes[nodes[n as usize] as usize].value;
        let crossed = |part: &&[u32; 4]| {
            let negative = part.iter().filter(|&&n| is_negative(value(n))).count();
            negative % 4 != 0 && part.iter().all(|&n| value(n).is_finite())
        };
        let crossed: Vec<[u32; 4]> = self.refinement.parts.iter().filter(crossed).copied().collect();
        let mut triangles = Vec::new();
        for part in crossed {
            self.part(simplex, part, &nodes, &mut triangles);
        }
        triangles
    }

    /// Adds the triangles in a part, which has nodes of both signs.
    fn part(&mut self, simplex: usize, part: [u32; 4], nodes: &[u32], triangles: &mut Vec<[Corner; 3]>) {
        let negative = part.map(|n| is_negative(self.nodes[nodes[n as usize] as usize].value));
        let mut order = [0, 1, 2, 3];
        order.sort_by_key(|&c| !negative[c]);
        let count = negative.iter().filter(|n| **n).count();
        // An even order of the corners keeps their orientation; which of those of equal sign comes first is free.
        if is_odd(order) {
            if count == 3 { order.swap(0, 1) } else { order.swap(2, 3) }
        }
        let [a, b, c, d] = order.map(|c| part[c]);
        let mut between = |p: u32, q: u32| self.corner(simplex, [p, q], nodes);
        match count {
            1 => triangles.push([between(a, b), between(a, c), between(a, d)]),
            3 => triangles.push([between(a, d), between(b, d), between(c, d)]),
            _ => {
                let [p, q, r, s] = [between(a, c), between(a, d), between(b, d), between(b, c)];
                let squared = |u: Corner, v: Corner| {
                    vec3::distance_squared(self.vertices[u.vertex as usize], self.vertices[v.vertex as usize])
                };
                if squared(p, r) <= squared(q, s) {
                    triangles.extend([[p, q, r], [p, r, s]]);
                } else {
                    triangles.extend([[q, r, s], [q, s, p]]);
                }
            }
        }
    }

    /// A node of a cell.
    fn node(&mut self, simplex: usize, node: usize) -> u32 {
        let weights = self.refinement.nodes[node];
        let corners = self.f.domain().simplex(simplex);
        let mut key: NodeKey = [(u32::MAX, 0); 4];
        let mut used = 0;
        for c in (0..4).filter(|&c| weights[c] > 0) {
            key[used] = (corners[c], weights[c]);
            used += 1;
        }
        key.sort_unstable();
        if let Some(&known) = self.node_of.get(&key) {
            return known;
        }
        let whole = f64::from(self.refinement.whole);
        let mut position = [0.0; 3];
        for (vertex, weight) in &key[..used] {
            position =
                vec3::add_scaled(position, self.f.domain().vertices()[*vertex as usize], f64::from(*weight) / whole);
        }
        let barycentric = weights.map(|w| f64::from(w) / whole);
        let value = self.f.value_at(&Place { simplex, barycentric, position });
        self.nodes.push(Node { value, position });
        let new = self.nodes.len() as u32 - 1;
        self.node_of.insert(key, new);
        new
    }

    /// The vertex of the surface between two nodes of a cell.
    fn corner(&mut self, simplex: usize, ends: [u32; 2], nodes: &[u32]) -> Corner {
        let weights = ends.map(|n| self.refinement.nodes[n as usize]);
        let support = (0..4).filter(|&c| weights.iter().any(|w| w[c] > 0)).fold(0, |bits, c| bits | 1 << c);
        let mut ends = [(nodes[ends[0] as usize], weights[0]), (nodes[ends[1] as usize], weights[1])];
        ends.sort_unstable();
        let key = ends.map(|(node, _)| node);
        let vertex = if let Some(&known) = self.vertex_of.get(&key) {
            known
        } else {
            let position = self.root(simplex, ends);
            self.vertices.push(position);
            self.vertex_of.insert(key, self.vertices.len() as u32 - 1);
            self.vertices.len() as u32 - 1
        };
        Corner { vertex, support }
    }

    /// Where F vanishes between two nodes of different signs.
    fn root(&self, simplex: usize, ends: [(u32, Weights); 2]) -> Vec3 {
        let [p, q] = ends.map(|(node, _)| self.nodes[node as usize]);
        let whole = f64::from(self.refinement.whole);
        let [from, to] = ends.map(|(_, weights)| weights.map(|w| f64::from(w) / whole));
        let value = |t: f64| {
            let barycentric = std::array::from_fn(|c| from[c] + t * (to[c] - from[c]));
            self.f.value_at(&Place { simplex, barycentric, position: vec3::lerp(p.position, q.position, t) })
        };
        let t = match self.f.basis().degree() {
            Some(1) => linear([p.value, q.value]),
            Some(2) => quadratic([p.value, value(0.5), q.value]).0[0],
            _ => bracketed([p.value, q.value], value),
        };
        if t == 1.0 { q.position } else { vec3::lerp(p.position, q.position, t) }
    }

    /// Sorts the triangles of a cell into patches that are connected through vertices.
    fn add_patches(&self, simplex: usize, pieces: Vec<[Corner; 3]>, patches: &mut Vec<Patch>) {
        let mut local: FxHashMap<u32, usize> = FxHashMap::default();
        let mut group: Vec<usize> = Vec::new();
        for corner in pieces.iter().flatten() {
            local.entry(corner.vertex).or_insert_with(|| {
                group.push(group.len());
                group.len() - 1
            });
        }
        for piece in &pieces {
            let [a, b, c] = piece.map(|corner| root_of(&mut group, local[&corner.vertex]));
            let lowest = a.min(b).min(c);
            for other in [a, b, c] {
                group[other] = lowest;
            }
        }
        let mut patch_of: FxHashMap<usize, usize> = FxHashMap::default();
        for piece in pieces {
            let root = root_of(&mut group, local[&piece[0].vertex]);
            let patch = *patch_of.entry(root).or_insert_with(|| {
                patches.push(Patch { simplex, triangles: Vec::new(), corners: Vec::new(), links: Vec::new() });
                patches.len() - 1
            });
            let vertices = piece.map(|corner| corner.vertex);
            patches[patch].triangles.push(vertices);
            patches[patch].corners.push(vertices.map(|v| self.vertices[v as usize]));
            for k in 0..3 {
                let (u, v) = (piece[k], piece[(k + 1) % 3]);
                // All in one face: there is a corner that neither lies towards.
                if u.support | v.support != 0b1111 {
                    patches[patch]
                        .links
                        .push(u64::from(u.vertex.min(v.vertex)) << 32 | u64::from(u.vertex.max(v.vertex)));
                }
            }
        }
    }
}

/// The lowest member of a group.
fn root_of(group: &mut [usize], mut of: usize) -> usize {
    while group[of] != of {
        group[of] = group[group[of]];
        of = group[of];
    }
    of
}

/// Whether an odd number of exchanges makes an order.
fn is_odd(order: [usize; 4]) -> bool {
    let inversions = (0..4).flat_map(|i| (i + 1..4).map(move |j| (i, j))).filter(|&(i, j)| order[i] > order[j]);
    inversions.count() % 2 == 1
}

/// The mesh of triangles, with the vertices that they use, in the order of first use.
fn compacted(vertices: &[Vec3], triangles: impl Iterator<Item = [u32; 3]>) -> Mesh {
    let mut new: Vec<Option<u32>> = vec![None; vertices.len()];
    let mut mesh = Mesh::default();
    for triangle in triangles {
        let renumbered = triangle.map(|v| {
            *new[v as usize].get_or_insert_with(|| {
                mesh.vertices.push(vertices[v as usize]);
                mesh.vertices.len() as u32 - 1
            })
        });
        mesh.triangles.push(renumbered);
    }
    mesh
}
