//! Collapses edges, the cheapest first.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::cover::{Cover, Moves};
use super::features::Features;
use super::surface::{Change, Surface};
use crate::mesh::Facet;
use crate::monitor::{Cancelled, Monitor, check};
use crate::spatial::MovingBoxes;
use crate::vec3::{self, Vec3};

/// Cosine of the most that a collapse may turn a triangle: 75 degrees.
const LEAST_COSINE: f64 = 0.26;
/// A triangle whose height is a smaller share of its longest side may only come from one that was as slim.
const LEAST_HEIGHT_REL: f64 = 2e-3;
/// What a squared length counts against a squared distance. In planes all collapses are free, and short edges go first.
const LENGTH_WEIGHT: f64 = 1e-6;
/// What was refused is tried again when this share of the triangles is left.
const RETRY: f64 = 0.75;
/// At the end it is tried as long as this share of the triangles goes, and no more often than this.
const LEAST_YIELD: f64 = 1e-3;
const MOST_ROUNDS: usize = 20;
/// Edges between two looks at the monitor.
const STRIDE: usize = 1 << 10;

/// A surface under simplification.
pub(super) struct Collapser<'a> {
    surface: Surface,
    features: Features,
    /// Changes whenever a vertex moves, so that what waits in the queue can be told to be stale.
    versions: Vec<u32>,
    cover: Cover<'a>,
    boxes: MovingBoxes,
    /// Triangles that the boxes were built over.
    boxed: usize,
}

/// An edge that waits.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Waiting {
    cost: f64,
    edge: [u32; 2],
    versions: [u32; 2],
}

impl Eq for Waiting {}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Waiting {
    /// The cheapest is the greatest; of equals, the one with the lowest vertices.
    fn cmp(&self, other: &Self) -> Ordering {
        other.cost.total_cmp(&self.cost).then(other.edge.cmp(&self.edge)).then(other.versions.cmp(&self.versions))
    }
}

/// Where an edge may collapse to.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: Vec3,
    cost: f64,
}

impl<'a> Collapser<'a> {
    pub(super) fn new(surface: Surface, features: Features, cover: Cover<'a>) -> Self {
        let versions = vec![0; surface.vertices.len()];
        let boxes = MovingBoxes::new(surface.triangles.len(), &|t| box_of(&surface, t));
        let boxed = surface.live();
        Self { surface, features, versions, cover, boxes, boxed }
    }

    /// Collapses until no more than `least` triangles are left or nothing more may go.
    ///
    /// What was refused is tried again whenever a quarter of the triangles has gone, as other collapses make room, so that no dear
    /// collapse is made for want of a cheap one; and again when nothing else is left, as long as that yields some. Then the bound
    /// on the error may grow.
    pub(super) fn run(mut self, least: usize, monitor: &dyn Monitor) -> Result<Surface, Cancelled> {
        let start = self.surface.live();
        let goal = (start - least.min(start)).max(1) as f64;
        let mut queue: BinaryHeap<Waiting> = self.all_edges().into();
        let mut refused = Vec::new();
        let (mut tried_again, mut rounds, mut looked_at) = (start, 0, 0_usize);
        while self.surface.live() > least {
            looked_at += 1;
            if looked_at % STRIDE == 0 {
                check(monitor)?;
                monitor.share((start - self.surface.live()) as f64 / goal);
            }
            let live = self.surface.live() as f64;
            let is_empty = queue.is_empty();
            if is_empty || live < RETRY * tried_again as f64 {
                rounds += usize::from(is_empty);
                let is_stuck = is_empty && (live > (1.0 - LEAST_YIELD) * tried_again as f64 || rounds > MOST_ROUNDS);
                if is_stuck && !self.cover.grow() {
                    break;
                }
                rounds = if is_stuck { 0 } else { rounds };
                queue.extend(refused.drain(..).filter(|waiting| self.is_fresh(waiting)));
                tried_again = self.surface.live();
            }
            let Some(next) = queue.pop() else { break };
            if !self.is_fresh(&next) {
                continue;
            }
            if !self.collapse(next.edge) {
                refused.push(next);
                continue;
            }
            if 2 * self.surface.live() < self.boxed {
                self.build_boxes();
                queue.retain(|waiting| self.is_fresh(waiting));
            }
            let keep = next.edge[0];
            let neighbours = self.surface.neighbours(keep);
            queue.extend(neighbours.iter().filter_map(|&other| self.waiting([keep.min(other), keep.max(other)])));
        }
        Ok(self.surface)
    }

    /// Whether nothing has moved an end of the edge since it was put in the queue.
    fn is_fresh(&self, waiting: &Waiting) -> bool {
        waiting.edge.map(|v| self.versions[v as usize]) == waiting.versions
    }

    fn build_boxes(&mut self) {
        self.boxes = MovingBoxes::new(self.surface.triangles.len(), &|t| box_of(&self.surface, t));
        self.boxed = self.surface.live();
    }

    fn all_edges(&self) -> Vec<Waiting> {
        let vertices = 0..self.surface.vertices.len() as u32;
        let upward = |v: u32| {
            self.surface.neighbours(v).into_iter().filter(move |&other| other > v).map(move |other| [v, other])
        };
        vertices.flat_map(upward).filter_map(|edge| self.waiting(edge)).collect()
    }

    fn waiting(&self, edge: [u32; 2]) -> Option<Waiting> {
        let [place, ..] = self.places(edge);
        let versions = edge.map(|v| self.versions[v as usize]);
        place.cost.is_finite().then_some(Waiting { cost: place.cost, edge, versions })
    }

    /// Where an edge may collapse to, the best first: where the planes want it, or to one of its ends.
    fn places(&self, edge: [u32; 2]) -> [Place; 3] {
        let ends = edge.map(|v| self.surface.vertices[v as usize]);
        let marked = edge.map(|v| self.features.marked[v as usize]);
        // What the planes leave open is decided by a place between the ends, or at the one that has a crease to stay on.
        let start = match marked {
            [true, false] => ends[0],
            [false, true] => ends[1],
            _ => vec3::lerp(ends[0], ends[1], 0.5),
        };
        let around = |end: usize| self.features.quadrics[edge[end] as usize].around(vec3::sub(start, ends[end]));
        let sum = around(0).plus(&around(1));
        let length_squared = vec3::distance_squared(ends[0], ends[1]);
        let detour = LENGTH_WEIGHT * sum.area * length_squared;
        let step = sum.least();
        // A far place is one that the planes hardly decide.
        let step = if vec3::norm_squared(step) <= length_squared { step } else { [0.0; 3] };
        let place = |position: Vec3| Place { position, cost: sum.at(vec3::sub(position, start)) + detour };
        let mut places = [place(vec3::add(start, step)), place(ends[0]), place(ends[1])];
        // Stable, so the first stays in front among equals.
        places.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        places
    }

    /// Collapses an edge to the first place that breaks nothing; whether there is one.
    fn collapse(&mut self, edge: [u32; 2]) -> bool {
        let Some(change) = self.surface.change(edge) else { return false };
        let allowed = self
            .places(edge)
            .into_iter()
            .find_map(|place| self.moves(&change, place.position).map(|moves| (place.position, moves)));
        let Some((position, moves)) = allowed else { return false };
        self.apply(&change, position, &moves);
        true
    }

    /// What a collapse means for the points held; `None` if it may not be done.
    fn moves(&self, change: &Change, position: Vec3) -> Option<Moves> {
        if !self.keeps_normals(change, position) {
            return None;
        }
        let moves = self.cover.moves(&self.surface, change, position)?;
        self.stays_clear(change, position)?.then_some(moves)
    }

    /// Whether no triangle is turned over or made much slimmer.
    fn keeps_normals(&self, change: &Change, position: Vec3) -> bool {
        change.changing.iter().all(|&t| {
            let shape = |[a, b, c]: [Vec3; 3]| {
                let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
                let longest = [(a, b), (b, c), (c, a)].map(|(p, q)| vec3::distance_squared(p, q)).into_iter();
                (normal, vec3::norm(normal) / longest.fold(0.0, f64::max))
            };
            let (old, old_height) = shape(self.surface.corners(t));
            let (new, new_height) = shape(self.surface.corners_after(t, change, position));
            let turn = vec3::dot(old, new) >= LEAST_COSINE * vec3::norm(old) * vec3::norm(new);
            // Not a number without a longest side, which no comparison lets through.
            turn && (new_height >= LEAST_HEIGHT_REL || new_height >= old_height)
        })
    }

    /// Whether the changed triangles meet nothing but their neighbours at common corners and edges; `None` if one has no area.
    fn stays_clear(&self, change: &Change, position: Vec3) -> Option<bool> {
        let after = |&t: &u32| {
            let corners = self.surface.corners_after(t, change, position);
            Some((Facet::new(corners)?, bounds(corners)))
        };
        let after = change.changing.iter().map(after).collect::<Option<Vec<_>>>()?;
        let among = after.iter().enumerate().any(|(i, (a, _))| after[..i].iter().any(|(b, _)| a.overlaps(b)));
        if among {
            return Some(false);
        }
        let [low, high] =
            after.iter().fold(after[0].1, |[low, high], (_, b)| [vec3::min(low, b[0]), vec3::max(high, b[1])]);
        let mut clear = true;
        self.boxes.visit_near(low, high, &mut |t| {
            if !clear || !self.surface.is_alive(t) || change.changing.contains(&t) || change.dying.contains(&t) {
                return;
            }
            let corners = self.surface.corners(t);
            let own = bounds(corners);
            let meeting = |b: &[Vec3; 2]| (0..3).all(|a| own[0][a] <= b[1][a] && b[0][a] <= own[1][a]);
            let Some(facet) = Facet::new(corners) else { return };
            clear = !after.iter().any(|(other, b)| meeting(b) && facet.overlaps(other));
        });
        Some(clear)
    }

    fn apply(&mut self, change: &Change, position: Vec3, moves: &Moves) {
        let [keep, gone] = change.edge.map(|v| v as usize);
        let moved = |v: usize| self.features.quadrics[v].around(vec3::sub(position, self.surface.vertices[v]));
        self.features.quadrics[keep] = moved(keep).plus(&moved(gone));
        self.features.marked[keep] |= self.features.marked[gone];
        self.versions[keep] += 1;
        self.versions[gone] += 1;
        self.cover.apply(change, moves);
        self.surface.apply(change, position);
        for &t in change.changing.iter().chain(&change.dying) {
            self.boxes.update(t, &|t| box_of(&self.surface, t));
        }
    }
}

fn bounds([a, b, c]: [Vec3; 3]) -> [Vec3; 2] {
    [vec3::min(vec3::min(a, b), c), vec3::max(vec3::max(a, b), c)]
}

fn box_of(surface: &Surface, triangle: u32) -> Option<[Vec3; 2]> {
    surface.is_alive(triangle).then(|| bounds(surface.corners(triangle)))
}
