//! How a mesh hangs together.
//!
//! # What
//! Components, boundary, defects, Euler characteristic, genus, area and volume of a triangle mesh as it is stored: two
//! vertices at one place are two vertices.
//!
//! # Definitions
//! - *Component*: triangles that are connected through shared edges. Two pieces that touch at one vertex only are two.
//! - *Boundary edge*: an edge of exactly one triangle. *Non-manifold edge*: of three or more.
//! - *Fan*: the triangles round a vertex that are connected through edges at that vertex. A vertex with more than one
//!   fan is a *non-manifold vertex* (a bow-tie).
//! - *Inconsistent edge*: an edge whose two triangles run along it in the same direction, so that one of them is turned
//!   over.
//! - *Euler characteristic*: V - E + F. Of the whole mesh with vertices as stored; of a component with one vertex for
//!   each fan, so that a bow-tie does not change what its two sides are.
//! - *Genus* of a component that is closed, manifold and consistently oriented: 1 - (V - E + F) / 2.
//! - *Signed volume*: sum over triangles of a . (b x c) / 6 about the middle of the box; positive if the triangles are
//!   counter-clockwise from outside.
//!
//! Triangles that repeat a vertex are counted as degenerate and otherwise left out; triangles of three collinear
//! vertices are counted as degenerate, too, but take part, as they hold their neighbours together.
//!
//! # Cost
//! O(V + F log d), d the number of neighbours of a vertex; 10 million triangles take a few seconds and about 65 bytes
//! each.
//!
//! # Guaranteed
//! The same result, sums of areas included, on any number of threads. Area and volume are summed in chunks of fixed
//! size.
//!
//! # Not guaranteed
//! Nothing is said about triangles that cut through each other.

use super::edges::{Edges, next, repeats};
use super::{Mesh, MeshError};
use crate::vec3::{self, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Triangles whose area one task sums.
const CHUNK: usize = 1 << 14;

/// A piece of a mesh that is connected through edges.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Component {
    /// Its lowest triangle.
    pub first_triangle: usize,
    /// Number of triangles, those that repeat a vertex aside.
    pub faces: usize,
    /// Sum of the triangles' areas.
    pub area: f64,
    /// V - E + F with one vertex for each fan.
    pub euler_characteristic: i64,
    /// Number of boundary edges.
    pub boundary_edges: usize,
    /// Number of handles; `None` unless the component is closed, manifold and consistently oriented.
    pub genus: Option<u64>,
}

/// What [`topology`] finds.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Topology {
    /// Number of vertices stored.
    pub vertices: usize,
    /// Number of vertices that no triangle uses.
    pub unused_vertices: usize,
    /// Number of triangles stored.
    pub faces: usize,
    /// Number of different edges.
    pub edges: usize,
    /// The components, most faces first; of equals, the one with the lowest triangle first.
    pub components: Vec<Component>,
    /// Number of components with over 1 % of all faces.
    pub large_components: usize,
    /// Edges of one triangle.
    pub boundary_edges: usize,
    /// Closed chains of boundary edges: the number of holes and outer borders.
    pub boundary_loops: usize,
    /// Edges of three or more triangles.
    pub nonmanifold_edges: usize,
    /// Vertices with more than one fan of triangles.
    pub nonmanifold_vertices: usize,
    /// Edges that their two triangles run along in the same direction.
    pub inconsistent_edges: usize,
    /// Triangles with the same three vertices as an earlier one, in any order.
    pub duplicate_triangles: usize,
    /// Triangles that repeat a vertex or have no area.
    pub degenerate_triangles: usize,
    /// V - E + F with vertices as stored, unused ones aside.
    pub euler_characteristic: i64,
    /// Every edge has exactly two triangles, which run along it in opposite directions; there is at least one triangle.
    pub closed: bool,
    /// Sum of the genus of all components; `None` unless the mesh is closed.
    pub genus: Option<u64>,
    /// Sum of the triangles' areas.
    pub area: f64,
    /// Volume inside, negative if the mesh is turned inside out; `None` unless the mesh is closed.
    pub volume: Option<f64>,
    /// The lowest and the highest corner of the box around the used vertices, local; `None` without any.
    pub bounds: Option<[[f64; 3]; 2]>,
}

/// Groups of numbers that are merged step by step; a group's root is its lowest number.
pub(super) struct Groups(Vec<u32>);

impl Groups {
    pub(super) fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    pub(super) fn root(&mut self, mut of: u32) -> u32 {
        while self.0[of as usize] != of {
            let above = self.0[self.0[of as usize] as usize];
            self.0[of as usize] = above;
            of = above;
        }
        of
    }

    pub(super) fn merge(&mut self, a: u32, b: u32) {
        let (a, b) = (self.root(a), self.root(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}

/// Area and signed volume of triangles.
#[derive(Clone, Copy)]
struct Measure {
    area: f64,
    volume: f64,
}

/// Counts what the edges tell.
#[derive(Default)]
struct EdgeCounts {
    all: usize,
    boundary: usize,
    nonmanifold: usize,
    inconsistent: usize,
    duplicates: usize,
}

/// Examines a mesh.
///
/// # Errors
/// [`MeshError`] if a triangle names a vertex that is not there, a vertex is not finite, or there are 2^32 / 3
/// triangles or more.
pub fn topology(mesh: &Mesh) -> Result<Topology, MeshError> {
    let edges = Edges::new(mesh)?;
    let mut pieces = Groups::new(mesh.triangles.len());
    let mut fans = Groups::new(3 * mesh.triangles.len());
    let mut counts = EdgeCounts::default();
    let mut opposite = Vec::new();
    for edge in edges.iter() {
        counts.all += 1;
        let mut corners = edge.corners();
        let first = corners.next().unwrap_or_default();
        for corner in corners {
            pieces.merge(first / 3, corner / 3);
            for vertex in [edge.low, edge.high] {
                fans.merge(edges.corner_at(first, vertex), edges.corner_at(corner, vertex));
            }
        }
        match edge.count() {
            1 => counts.boundary += 1,
            2 => {}
            _ => counts.nonmanifold += 1,
        }
        if edge.pair().is_some_and(|[a, b]| edges.vertex(a) == edges.vertex(b)) {
            counts.inconsistent += 1;
        }
        if edge.count() > 1 {
            // Each triangle is looked at once: at the edge of its two lower vertices.
            opposite.clear();
            opposite.extend(edge.corners().map(|c| edges.vertex(next(next(c)))).filter(|&v| v > edge.high));
            opposite.sort_unstable();
            counts.duplicates += opposite.windows(2).filter(|pair| pair[0] == pair[1]).count();
        }
    }

    let (bounds, used) = bounds_of_used(mesh);
    let middle = bounds.map_or([0.0; 3], |[low, high]| vec3::lerp(low, high, 0.5));
    let measures = measure(mesh, middle);
    let degenerate = measures.iter().zip(&mesh.triangles).filter(|(m, t)| m.area == 0.0 || repeats(t)).count();
    let total = sum_up(&measures);

    let closed = counts.all > 0 && counts.boundary + counts.nonmanifold + counts.inconsistent == 0;
    let nonmanifold_vertices = bow_ties(mesh, &mut fans);
    let faces = mesh.triangles.iter().filter(|t| !repeats(t)).count();
    let components = components(mesh, &edges, &mut pieces, &mut fans, &measures);
    Ok(Topology {
        vertices: mesh.vertices.len(),
        unused_vertices: mesh.vertices.len() - used,
        faces: mesh.triangles.len(),
        edges: counts.all,
        large_components: components.iter().filter(|c| 100 * c.faces > mesh.triangles.len()).count(),
        boundary_edges: counts.boundary,
        boundary_loops: boundary_loops(&edges, &mut fans),
        nonmanifold_edges: counts.nonmanifold,
        nonmanifold_vertices,
        inconsistent_edges: counts.inconsistent,
        duplicate_triangles: counts.duplicates,
        degenerate_triangles: degenerate,
        euler_characteristic: used as i64 - counts.all as i64 + faces as i64,
        closed,
        genus: if closed { components.iter().map(|c| c.genus).sum() } else { None },
        area: total.area,
        volume: closed.then_some(total.volume),
        bounds,
        components,
    })
}

/// The box of the vertices of proper triangles, and their number.
fn bounds_of_used(mesh: &Mesh) -> (Option<[Vec3; 2]>, usize) {
    let mut used = vec![false; mesh.vertices.len()];
    for triangle in mesh.triangles.iter().filter(|t| !repeats(t)) {
        for &v in triangle {
            used[v as usize] = true;
        }
    }
    let (mut bounds, mut count) = (None, 0);
    for (&v, _) in mesh.vertices.iter().zip(&used).filter(|(_, used)| **used) {
        let [low, high] = bounds.unwrap_or([v, v]);
        bounds = Some([vec3::min(low, v), vec3::max(high, v)]);
        count += 1;
    }
    (bounds, count)
}

fn measure(mesh: &Mesh, middle: Vec3) -> Vec<Measure> {
    let of = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
        let (ab, ac) = (vec3::sub(b, a), vec3::sub(c, a));
        let normal = vec3::cross(ab, ac);
        Measure { area: 0.5 * vec3::norm(normal), volume: vec3::dot(vec3::sub(a, middle), normal) / 6.0 }
    };
    mesh.triangles.par_iter().map(of).collect()
}

/// The sum, in an order that does not depend on threads.
fn sum_up(measures: &[Measure]) -> Measure {
    let add = |a: Measure, b: &Measure| Measure { area: a.area + b.area, volume: a.volume + b.volume };
    let zero = Measure { area: 0.0, volume: 0.0 };
    let parts: Vec<Measure> = measures.par_chunks(CHUNK).map(|chunk| chunk.iter().fold(zero, add)).collect();
    parts.iter().fold(zero, add)
}

/// Number of vertices with more than one fan.
fn bow_ties(mesh: &Mesh, fans: &mut Groups) -> usize {
    let mut fan_of = vec![u32::MAX; mesh.vertices.len()];
    let mut torn = vec![false; mesh.vertices.len()];
    for (t, triangle) in mesh.triangles.iter().enumerate().filter(|(_, t)| !repeats(t)) {
        for (i, &v) in triangle.iter().enumerate() {
            let fan = fans.root((3 * t + i) as u32);
            let known = &mut fan_of[v as usize];
            torn[v as usize] |= *known != u32::MAX && *known != fan;
            *known = fan;
        }
    }
    torn.into_iter().filter(|torn| *torn).count()
}

/// Chains of boundary edges: they are linked where they meet in the same fan.
fn boundary_loops(edges: &Edges, fans: &mut Groups) -> usize {
    let mut ends = Vec::new();
    for edge in edges.iter().filter(|e| e.count() == 1) {
        ends.extend(edge.corners().map(|c| [fans.root(c), fans.root(next(c))]));
    }
    let mut names: Vec<u32> = ends.iter().flatten().copied().collect();
    names.sort_unstable();
    names.dedup();
    let number = |fan: u32| names.binary_search(&fan).unwrap_or_default() as u32;
    let mut loops = Groups::new(names.len());
    for [a, b] in ends {
        loops.merge(number(a), number(b));
    }
    (0..names.len() as u32).filter(|&i| loops.0[i as usize] == i).count()
}

fn components(
    mesh: &Mesh,
    edges: &Edges,
    pieces: &mut Groups,
    fans: &mut Groups,
    measures: &[Measure],
) -> Vec<Component> {
    // Triangles come in rising order, so a component is met first at its root.
    let mut number = vec![u32::MAX; mesh.triangles.len()];
    let mut all: Vec<Component> = Vec::new();
    let mut sound = Vec::new();
    for (t, _) in mesh.triangles.iter().enumerate().filter(|(_, t)| !repeats(t)) {
        let root = pieces.root(t as u32) as usize;
        if root == t {
            number[t] = all.len() as u32;
            all.push(Component {
                first_triangle: t,
                faces: 0,
                area: 0.0,
                euler_characteristic: 0,
                boundary_edges: 0,
                genus: None,
            });
            sound.push(true);
        }
        number[t] = number[root];
        let component = &mut all[number[t] as usize];
        component.faces += 1;
        component.area += measures[t].area;
        let own_fans = (0..3).filter(|i| fans.root(3 * t as u32 + i) == 3 * t as u32 + i).count();
        component.euler_characteristic += 1 + own_fans as i64;
    }
    for edge in edges.iter() {
        let first = edge.corners().next().unwrap_or_default();
        let at = number[first as usize / 3] as usize;
        all[at].euler_characteristic -= 1;
        all[at].boundary_edges += usize::from(edge.count() == 1);
        sound[at] &= edge.pair().is_some_and(|[a, b]| edges.vertex(a) != edges.vertex(b));
    }
    for (component, sound) in all.iter_mut().zip(sound) {
        // A closed oriented surface has an even characteristic of at most 2.
        component.genus = if sound { u64::try_from(1 - component.euler_characteristic / 2).ok() } else { None };
    }
    all.sort_by_key(|c| (std::cmp::Reverse(c.faces), c.first_triangle));
    all
}
