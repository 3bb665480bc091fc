//! Where in its tetrahedron a vertex goes.
//!
//! # What
//! The polygons of the dual mesh do not depend on where in its tetrahedron a vertex lies. Two rules choose:
//!
//! - the mean of the places where F vanishes on the tetrahedron's edges. It is the default, and right where the size of F means something;
//! - least curvature: the place where the mesh bends least. It is for marks, where only the sign of F is known and every crossing lies in the
//!   middle of its edge, which makes terraces.
//!
//! # Formula
//! The ring of a vertex is the three or four vertices across the faces of its tetrahedron: the polygons' own edges, whatever diagonals cut
//! them into triangles. Over the triangles from the vertex to its ring, with e the edges at the vertex, beta the bends along them and A
//! their area,
//!
//! ```text
//! K = 3 (2 pi - sum of angles) / A      |H| = 0.75 sum |e| |beta| / A      k1^2 + k2^2 = 4 H^2 - 2 K
//! ```
//!
//! What is made least is (4 H^2 - 2 K) A. It does not change with scale, and grows without bound as a vertex leaves its ring; the norm as
//! printed, without A, does neither ([`Norm::Printed`]). Candidates are the places (a, b, c, d) / N of a tetrahedron, a + b + c + d = N, all whole and
//! above zero. The first sweep tries all candidates at each vertex, against its ring as it is then. Each later sweep moves a vertex to the
//! best of the twelve candidates next to it, and on while that helps. `halvings` double N, with one sweep each; no barycentric coordinate
//! falls below 1/50.
//!
//! # Cost
//! Some 100 norms a vertex, of three or four triangles each: 56 in the first sweep, then twelve for each vertex that moved, or whose ring did.
//!
//! # Guaranteed
//! Every vertex lies inside its tetrahedron, so the mesh stays the same manifold, and none coincide. After the first sweep, no step raises the norm of
//! the vertex that takes it. Vertices move class by class, and no class holds neighbours, so the result does not depend on the
//! number of threads. Vertices without a whole ring, on the rim of the domain, stay at the mean of the crossings.
//!
//! # Not guaranteed
//! That movement stops: each vertex lowers its own norm, not a sum, and some step to and fro for ever. The sweeps are therefore
//! limited. Halvings end all movement, but only because steps shrink. Triangles can cross each other.
//!
//! # Source
//! G. M. Nielson, Dual Marching Tetrahedra, ISVC 2008, LNCS 5358. Ours: the factor A, steps between neighbouring candidates, halvings.

mod chart;
mod curvature;
mod stars;

pub(super) use stars::{Sector, sectors};

use super::cells::Cells;
use crate::vec3::{self, Vec3};
use chart::{Chart, Weights, lattice_points};
use curvature::curvature_norm;
use rayon::prelude::*;
use serde::Serialize;
use stars::Stars;

/// Where in its tetrahedron a vertex goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Placement {
    /// To the mean of the places where F vanishes on the edges.
    #[default]
    MeanOfCrossings,
    /// To where the mesh bends least.
    LeastCurvature(LeastCurvature),
}

/// Among which places least curvature chooses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Candidates {
    /// All over the tetrahedron: for marks.
    #[default]
    Tetrahedron,
    /// On the zero set of F in the tetrahedron, a triangle or a quadrangle, which is F's to a hundredth of an edge.
    ZeroSet,
}

/// What least curvature makes least at each vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Norm {
    /// The curvature norm times the area of the ring.
    #[default]
    TimesArea,
    /// The curvature norm as printed in the paper: a vertex can lower it by blowing up its ring, and makes its neighbours' larger.
    Printed,
}

/// How least curvature is looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LeastCurvature {
    /// Among which places.
    pub candidates: Candidates,
    /// What is made least.
    pub norm: Norm,
    /// N, the number of parts that an edge is cut into; 4 to 16, others are clamped. Barycentric coordinates are at least 1 / N, so more parts
    /// allow smoother meshes.
    pub divisions: u32,
    /// Most sweeps over candidates, the first included; at least 1.
    pub most_sweeps: usize,
    /// Further sweeps, each with twice the N of the one before; at most 24. The first two make the mesh of marks smoother; more only settle
    /// digits.
    pub halvings: u32,
}

impl Default for LeastCurvature {
    fn default() -> Self {
        Self { candidates: Candidates::Tetrahedron, norm: Norm::TimesArea, divisions: 9, most_sweeps: 8, halvings: 2 }
    }
}

/// What a sweep over all vertices did. Movements are parts of the longest edge of the vertex's tetrahedron.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Sweep {
    /// The largest movement.
    pub largest_rel: f64,
    /// The mean over all vertices that may move.
    pub mean_rel: f64,
    /// Number of vertices that moved.
    pub moved: usize,
}

/// What the placement did.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PlacementReport {
    /// Vertices with a whole ring, which may move.
    pub movable: usize,
    /// The sweeps, in order.
    pub sweeps: Vec<Sweep>,
}

/// Steps that a vertex takes at most in one sweep.
const MOST_STEPS: usize = 3;
/// No barycentric coordinate is less than one over this: vertices of neighbouring tetrahedra must not come so close that triangles vanish.
const MOST_PARTS: u32 = 50;
/// Vertices that one thread takes at least.
const LEAST_SHARE: usize = 256;

/// Moves vertices, one in each of the cells, to where the mesh of polygons with these sectors bends least.
pub(super) fn place(
    vertices: &mut [Vec3],
    sectors: &[Sector],
    cells: &impl Cells,
    params: &LeastCurvature,
) -> PlacementReport {
    let stars = Stars::new(vertices.len(), sectors);
    let classes = stars.classes();
    let (divisions, count) = (params.divisions.clamp(4, 16), vertices.len());
    let mut descent = Descent {
        weights: vec![[0; 4]; vertices.len()],
        vertices,
        stars,
        cells,
        candidates: params.candidates,
        norm: params.norm,
        points: [lattice_points(3, divisions), lattice_points(4, divisions)],
        whole: divisions,
        least: 1,
        looked: vec![None; count],
        moved: vec![0; count],
        clock: 0,
    };
    let movable = classes.iter().map(Vec::len).sum();
    let mut sweeps = vec![descent.sweep(&classes, Step::Start)];
    while sweeps.len() < params.most_sweeps && sweeps[sweeps.len() - 1].moved > 0 {
        sweeps.push(descent.sweep(&classes, Step::Neighbors));
    }
    for _ in 0..params.halvings.min(24) {
        descent.halve();
        sweeps.push(descent.sweep(&classes, Step::Neighbors));
    }
    PlacementReport { movable, sweeps }
}

/// What a vertex looks at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Step {
    /// All candidates.
    Start,
    /// The candidates next to it.
    Neighbors,
}

/// The state between sweeps.
struct Descent<'a, C> {
    vertices: &'a mut [Vec3],
    /// Of each vertex that has moved; their sum is `whole`.
    weights: Vec<Weights>,
    stars: Stars,
    cells: &'a C,
    candidates: Candidates,
    norm: Norm,
    /// The candidates with three and with four generators.
    points: [Vec<Weights>; 2],
    whole: u32,
    /// The least weight of a place.
    least: u32,
    /// When each vertex last looked at the candidates next to it, by the clock.
    looked: Vec<Option<u32>>,
    /// When each vertex last moved.
    moved: Vec<u32>,
    /// Counts the classes that were swept.
    clock: u32,
}

impl<C: Cells> Descent<'_, C> {
    /// Halves the distance of candidates.
    fn halve(&mut self) {
        self.whole *= 2;
        self.least = self.whole.div_ceil(MOST_PARTS);
        self.weights.iter_mut().flatten().for_each(|w| *w *= 2);
        self.looked.fill(None);
    }

    /// Moves the vertices of one class after the other.
    fn sweep(&mut self, classes: &[Vec<u32>], step: Step) -> Sweep {
        let (mut largest, mut sum, mut moved) = (0.0_f64, 0.0, 0);
        for class in classes {
            self.clock += 1;
            let restless: Vec<u32> = class.par_iter().copied().filter(|&v| !self.is_settled(v as usize)).collect();
            let found: Vec<(Weights, Vec3, f64)> = restless
                .par_iter()
                .with_min_len(LEAST_SHARE)
                .map_init(Vec::new, |ring, &v| self.best(v as usize, step, ring))
                .collect();
            for (v, (weights, place, movement)) in restless.into_iter().map(|v| v as usize).zip(found) {
                self.weights[v] = weights;
                self.vertices[v] = place;
                self.looked[v] = (step == Step::Neighbors).then_some(self.clock);
                if movement > 0.0 {
                    self.moved[v] = self.clock;
                    moved += 1;
                }
                largest = largest.max(movement);
                sum += movement;
            }
        }
        let count: usize = classes.iter().map(Vec::len).sum();
        Sweep { largest_rel: largest, mean_rel: sum / count.max(1) as f64, moved }
    }

    /// Whether a vertex would find what it found before: it stayed when it looked, and so did its ring since.
    fn is_settled(&self, vertex: usize) -> bool {
        let stayed = |looked: u32| {
            self.moved[vertex] < looked && self.stars.ring(vertex).iter().all(|&n| self.moved[n as usize] < looked)
        };
        self.looked[vertex].is_some_and(stayed)
    }

    /// Where a vertex goes, and how far that is in parts of its tetrahedron's longest edge. `ring` is scratch.
    fn best(&self, vertex: usize, step: Step, ring: &mut Vec<Vec3>) -> (Weights, Vec3, f64) {
        ring.clear();
        ring.extend(self.stars.ring(vertex).iter().map(|&n| self.vertices[n as usize]));
        let cell = self.cells.cell(vertex);
        let chart = Chart::new(&cell, self.candidates);
        let norm = |weights: Weights| curvature_norm(chart.place(weights, self.whole), ring, self.norm);
        // Of equals the first stays.
        let better = |best: (Weights, f64), weights: Weights| {
            let norm = norm(weights);
            if norm < best.1 { (weights, norm) } else { best }
        };
        let weights = match step {
            Step::Start => {
                let points = &self.points[chart.count - 3];
                points.iter().fold((points[0], f64::INFINITY), |best, &w| better(best, w)).0
            }
            Step::Neighbors => {
                let mut best = (self.weights[vertex], norm(self.weights[vertex]));
                for _ in 0..MOST_STEPS {
                    let next = chart.neighbors(best.0, self.least).fold(best, better);
                    if next.0 == best.0 {
                        break;
                    }
                    best = next;
                }
                best.0
            }
        };
        if step == Step::Neighbors && weights == self.weights[vertex] {
            return (weights, self.vertices[vertex], 0.0);
        }
        let place = chart.place(weights, self.whole);
        (weights, place, vec3::distance(place, self.vertices[vertex]) / cell.longest_edge())
    }
}
