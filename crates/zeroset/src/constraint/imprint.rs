//! Mesh edges along lines.
//!
//! A line stands upright on the mesh as a curtain: the plane along the line and the mesh's normal there. Mesh edges that cross a curtain near
//! the line get a vertex there, which goes onto the line, and triangles are cut between them. A vertex that is next to the curtain goes onto the line
//! itself, so that no slivers arise. The mesh stays a manifold; a triangle that would fold over is left where it was.

use rayon::prelude::*;

use crate::mesh::{Edges, Mesh};
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Curtains are at most so many cells long: the normal of the mesh is the same all along one.
const LENGTH: f64 = 4.0;
/// How far the mesh may be from a line, in cells.
const REACH: f64 = 0.6;
/// A crossing within this share of an edge from its end is that end.
const AT_END: f64 = 0.2;
/// A triangle keeps at least this share of its area, seen along its normal.
const THINNEST: f64 = 0.02;
/// Rounds in which vertices are taken back whose triangles fold over.
const ROUNDS: usize = 4;

/// A piece of a line with the plane that stands on the mesh along it.
struct Curtain {
    from: Vec3,
    along: Vec3,
    length: f64,
    /// Unit normal of the plane.
    across: Vec3,
}

impl Curtain {
    fn new([from, to]: [Vec3; 2], normal: Vec3) -> Option<Self> {
        let along = vec3::normalized(vec3::sub(to, from))?;
        let across = vec3::normalized(vec3::cross(along, normal))?;
        Some(Self { from, along, length: vec3::distance(from, to), across })
    }

    fn side(&self, p: Vec3) -> f64 {
        vec3::dot(vec3::sub(p, self.from), self.across)
    }

    /// The position of the line below one of the curtain; `None` beyond its ends or its reach.
    fn foot(&self, p: Vec3, reach: f64) -> Option<Vec3> {
        let t = vec3::dot(vec3::sub(p, self.from), self.along);
        let foot = vec3::add_scaled(self.from, self.along, t);
        ((0.0..=self.length).contains(&t) && vec3::distance(foot, p) < reach).then_some(foot)
    }
}

/// Where a mesh edge crosses a curtain.
#[derive(Clone, Copy)]
struct Crossing {
    /// The share of the edge before it.
    share: f64,
    /// On the mesh.
    position: Vec3,
    /// On the line.
    foot: Vec3,
}

/// Puts vertices in along lines, each given by its segments; returns how many lie on lines. Vertices for which `is_held` says so stay, and so do the
/// edges between them.
pub(crate) fn imprint(
    mesh: &mut Mesh,
    lines: &[Vec<[Vec3; 2]>],
    cell: f64,
    is_held: impl Fn(u32) -> bool + Sync,
) -> usize {
    let curtains = curtains(mesh, lines, cell);
    if curtains.is_empty() {
        return 0;
    }
    let ends: Vec<[Vec3; 2]> = curtains.iter().map(|c| [c.from, vec3::add_scaled(c.from, c.along, c.length)]).collect();
    let tree = TriangleTree::from_segments(&ends);
    let edges = Edges::new(mesh).expect("a mesh of our own is sound");
    let all: Vec<_> = edges.iter().collect();
    let crossings: Vec<Option<Crossing>> = all
        .par_iter()
        .map(|edge| {
            if is_held(edge.low) && is_held(edge.high) {
                return None;
            }
            let [p, q] = [edge.low, edge.high].map(|v| mesh.vertices[v as usize]);
            let near = tree.closest_within(vec3::lerp(p, q, 0.5), REACH * cell + 0.5 * vec3::distance(p, q))?;
            let curtain = &curtains[near.triangle];
            let (here, there) = (curtain.side(p), curtain.side(q));
            if (here < 0.0) == (there < 0.0) {
                return None;
            }
            let share = here / (here - there);
            let position = vec3::lerp(p, q, share);
            Some(Crossing { share, position, foot: curtain.foot(position, REACH * cell)? })
        })
        .collect();

    let mut moves = Moves::new(mesh);
    for (edge, crossing) in all.iter().zip(&crossings) {
        match crossing {
            Some(c) if c.share < AT_END && !is_held(edge.low) => moves.offer(edge.low, *c),
            Some(c) if c.share > 1.0 - AT_END && !is_held(edge.high) => moves.offer(edge.high, *c),
            _ => {}
        }
    }
    moves.keep_triangles(&mesh.triangles);
    let mut cuts: Vec<Option<u32>> = vec![None; 3 * mesh.triangles.len()];
    for (edge, crossing) in all.iter().zip(&crossings) {
        if let Some(crossing) = crossing
            && [edge.low, edge.high].iter().all(|&v| moves.of[v as usize].is_none())
        {
            let number = moves.insert(*crossing);
            edge.corners().for_each(|corner| cuts[corner as usize] = Some(number));
        }
    }
    let (triangles, origins) = cut(&mesh.triangles, &cuts, &moves.stays);
    let on_lines = moves.settle(mesh, &triangles, &origins);
    mesh.triangles = triangles;
    on_lines
}

/// The curtains of all lines where the mesh is near.
fn curtains(mesh: &Mesh, lines: &[Vec<[Vec3; 2]>], cell: f64) -> Vec<Curtain> {
    if lines.is_empty() {
        return Vec::new();
    }
    let surface = TriangleTree::new(mesh);
    let pieces: Vec<[Vec3; 2]> = lines
        .iter()
        .flatten()
        .flat_map(|&[from, to]| {
            let n = (vec3::distance(from, to) / (LENGTH * cell)).ceil().max(1.0);
            (0..n as usize).map(move |i| [i, i + 1].map(|k| vec3::lerp(from, to, k as f64 / n)))
        })
        .collect();
    let curtain = |piece: &[Vec3; 2]| {
        let samples = 4.0 * LENGTH;
        let normal = (0..samples as usize).fold([0.0; 3], |sum, i| {
            let p = vec3::lerp(piece[0], piece[1], (i as f64 + 0.5) / samples);
            let near = surface.closest_within(p, REACH * cell);
            near.map_or(sum, |near| vec3::add(sum, normal(mesh, mesh.triangles[near.triangle])))
        });
        Curtain::new(*piece, normal)
    };
    pieces.par_iter().filter_map(curtain).collect()
}

/// The unit normal of a triangle, or zero.
fn normal(mesh: &Mesh, triangle: [u32; 3]) -> Vec3 {
    vec3::normalized(area(triangle.map(|v| mesh.vertices[v as usize]))).unwrap_or([0.0; 3])
}

/// Twice the vector area of a triangle.
fn area([a, b, c]: [Vec3; 3]) -> Vec3 {
    vec3::cross(vec3::sub(b, a), vec3::sub(c, a))
}

/// Where vertices, old and new, go, and where they stay if they may not.
struct Moves {
    of: Vec<Option<Vec3>>,
    stays: Vec<Vec3>,
}

impl Moves {
    fn new(mesh: &Mesh) -> Self {
        Self { of: vec![None; mesh.vertices.len()], stays: mesh.vertices.clone() }
    }

    /// An old vertex goes to the nearest place that it is offered.
    fn offer(&mut self, vertex: u32, crossing: Crossing) {
        let stays = self.stays[vertex as usize];
        let of = &mut self.of[vertex as usize];
        let distance = |p: Vec3| vec3::distance_squared(p, stays);
        if of.is_none_or(|old| distance(crossing.foot) < distance(old)) {
            *of = Some(crossing.foot);
        }
    }

    /// Of a triangle two corners may move: with three it would become a line.
    fn keep_triangles(&mut self, triangles: &[[u32; 3]]) {
        for t in triangles {
            if t.iter().all(|&v| self.of[v as usize].is_some()) {
                let step =
                    |v: u32| self.of[v as usize].map_or(0.0, |p| vec3::distance_squared(p, self.stays[v as usize]));
                let farthest = t.iter().copied().fold(t[0], |best, v| if step(v) > step(best) { v } else { best });
                self.of[farthest as usize] = None;
            }
        }
    }

    /// A new vertex; its number.
    fn insert(&mut self, crossing: Crossing) -> u32 {
        self.of.push(Some(crossing.foot));
        self.stays.push(crossing.position);
        self.of.len() as u32 - 1
    }

    /// Moves the vertices, but those whose triangles would fold over; returns how many were moved. `origins` are the old triangles that the new ones
    /// are parts of.
    fn settle(mut self, mesh: &mut Mesh, triangles: &[[u32; 3]], origins: &[u32]) -> usize {
        for _ in 0..ROUNDS {
            let place = |v: u32| self.of[v as usize].unwrap_or(self.stays[v as usize]);
            let folded: Vec<u32> = triangles
                .par_iter()
                .zip(origins)
                .filter(|(t, _)| t.iter().any(|&v| self.of[v as usize].is_some()))
                .filter(|(t, origin)| {
                    let whole = area(mesh.triangles[**origin as usize].map(|v| mesh.vertices[v as usize]));
                    let before = vec3::dot(area(t.map(|v| self.stays[v as usize])), whole);
                    vec3::dot(area(t.map(place)), whole) <= THINNEST * before
                })
                .flat_map_iter(|(t, _)| *t)
                .collect();
            if folded.is_empty() {
                break;
            }
            folded.into_iter().for_each(|v| self.of[v as usize] = None);
        }
        let moved = self.of.iter().flatten().count();
        mesh.vertices = self.of.into_iter().zip(self.stays).map(|(of, stays)| of.unwrap_or(stays)).collect();
        moved
    }
}

/// Cuts triangles between the new vertices on their sides; also tells which triangle each is a part of.
fn cut(triangles: &[[u32; 3]], cuts: &[Option<u32>], positions: &[Vec3]) -> (Vec<[u32; 3]>, Vec<u32>) {
    let distance = |a: u32, b: u32| vec3::distance_squared(positions[a as usize], positions[b as usize]);
    let (mut parts, mut origins) = (Vec::with_capacity(triangles.len()), Vec::with_capacity(triangles.len()));
    for (i, (&t, cut)) in triangles.iter().zip(cuts.as_chunks::<3>().0).enumerate() {
        // Turned so that what distinguishes the sides comes first.
        let turned = |first: usize| {
            let at = |k: usize| (first + k) % 3;
            ([t[at(0)], t[at(1)], t[at(2)]], [cut[at(0)], cut[at(1)], cut[at(2)]])
        };
        let first = match cut.iter().flatten().count() {
            1 => cut.iter().position(Option::is_some),
            // The side without one comes second, so that the corner between the other two comes first.
            2 => cut.iter().position(Option::is_none).map(|none| (none + 2) % 3),
            _ => None,
        };
        let ([a, b, c], sides) = turned(first.unwrap_or(0));
        match sides {
            [Some(x), None, None] => parts.extend([[a, x, c], [x, b, c]]),
            [Some(x), None, Some(y)] => {
                parts.push([a, x, y]);
                if distance(x, c) < distance(b, y) {
                    parts.extend([[x, b, c], [x, c, y]]);
                } else {
                    parts.extend([[x, b, y], [b, c, y]]);
                }
            }
            [Some(x), Some(y), Some(z)] => parts.extend([[a, x, z], [x, b, y], [z, y, c], [x, y, z]]),
            _ => parts.push(t),
        }
        origins.resize(parts.len(), i as u32);
    }
    (parts, origins)
}
