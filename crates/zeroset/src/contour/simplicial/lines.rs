//! The zero set in the plane: arcs in triangles, joined to polylines.

use super::branches::{Component, kept};
use super::conic::{Conic, Frame, Point};
use super::follow::Follower;
use super::roots::{bracketed, is_negative, linear, quadratic};
use super::{Branches, Polyline};
use crate::basis::Expansion;
use crate::domain::Place;
use crate::spatial::TriangleTree;
use rustc_hash::FxHashMap;

/// A tolerance below this share of the longest side of a triangle is raised to it: curves then have some 10,000 points in each.
const LEAST_TOLERANCE_REL: f64 = 1e-9;

/// The local edges along the outline of a triangle, counter-clockwise from corner 0, as indices into the edges 01, 02, 12.
const OUTLINE: [usize; 3] = [0, 2, 1];

/// The zero set of F as polylines.
///
/// Each lies within `tolerance`, a length, of the zero set, where the page of [the room](super) says so. The order is
/// that of the triangles.
#[must_use]
pub fn zero_lines(f: &Expansion<'_, 2>, tolerance: f64, branches: Branches<'_, 2>) -> Vec<Polyline> {
    let mut tracer = Tracer::new(f, tolerance);
    let mut arcs = Vec::new();
    for simplex in (0..f.domain().len()).filter(|&s| f.is_defined(s)) {
        tracer.trace(simplex, &mut arcs);
    }
    let kept = kept(f.domain(), &arcs, branches);
    join(arcs.into_iter().zip(kept).filter_map(|(arc, kept)| kept.then_some(arc)).collect())
}

/// A connected part of the zero set in one triangle, with F < 0 on its left.
struct Arc {
    simplex: usize,
    points: Vec<[f64; 2]>,
    /// The crossings that it leads from and to; none if it is closed.
    links: Vec<u64>,
}

impl Component for Arc {
    fn cell(&self) -> usize {
        self.simplex
    }

    fn links(&self) -> &[u64] {
        &self.links
    }

    fn tree(&self) -> TriangleTree {
        let lifted = |p: [f64; 2]| [p[0], p[1], 0.0];
        let mut segments: Vec<_> = self.points.windows(2).map(|p| [lifted(p[0]), lifted(p[1])]).collect();
        if let (true, [first, .., last]) = (self.links.is_empty(), self.points.as_slice()) {
            segments.push([lifted(*last), lifted(*first)]);
        }
        TriangleTree::from_segments(&segments)
    }
}

/// F along an edge of the mesh, from its lower vertex to the higher one.
#[derive(Clone, Copy, Default)]
struct Edge {
    middle: f64,
    count: usize,
    parameters: [f64; 2],
    positions: [[f64; 2]; 2],
}

/// A crossing of the zero set and the outline of a triangle.
#[derive(Clone, Copy)]
struct Crossing {
    link: u64,
    side: usize,
    /// In 0..3 along the outline.
    along: f64,
    point: Point,
}

/// Traces F triangle by triangle. What belongs to vertices and edges is computed once, so that all triangles around agree on it.
struct Tracer<'a> {
    f: &'a Expansion<'a, 2>,
    tolerance: f64,
    values: Vec<Option<f64>>,
    edges: Vec<Option<Edge>>,
}

impl<'a> Tracer<'a> {
    fn new(f: &'a Expansion<'a, 2>, tolerance: f64) -> Self {
        let domain = f.domain();
        let (values, edges) = (vec![None; domain.vertices().len()], vec![None; domain.edges().len()]);
        Self { f, tolerance, values, edges }
    }

    /// Adds the arcs of a triangle.
    fn trace(&mut self, simplex: usize, arcs: &mut Vec<Arc>) {
        let corners: [f64; 3] = std::array::from_fn(|corner| self.corner_value(simplex, corner));
        let edges: [Edge; 3] = std::array::from_fn(|edge| self.edge(simplex, edge));
        if !corners.iter().chain(edges.iter().map(|e| &e.middle)).all(|v| v.is_finite()) {
            return;
        }
        let frame = self.frame(simplex);
        let crossings = self.crossings(simplex, &edges);
        let first_sign = if is_negative(corners[0]) { -1.0 } else { 1.0 };
        let tracing = Tracing { simplex, frame, crossings, tolerance: self.tolerance_in(&frame) };
        match self.f.basis().degree() {
            Some(2) => tracing.conic(Conic::new(corners, edges.map(|e| e.middle)), first_sign, arcs),
            Some(1) => tracing.segment(first_sign, |_| Vec::new(), arcs),
            _ => {
                let follower = Follower { f: self.f, simplex, tolerance: tracing.tolerance };
                tracing.segment(first_sign, |ends| follower.between(ends), arcs);
            }
        }
    }

    fn tolerance_in(&self, frame: &Frame) -> f64 {
        let longest = frame.sides.iter().map(|s| s[0].hypot(s[1])).fold(0.0, f64::max);
        self.tolerance.max(LEAST_TOLERANCE_REL * longest)
    }

    fn frame(&self, simplex: usize) -> Frame {
        let domain = self.f.domain();
        let [origin, p, q] = [0, 1, 2].map(|c| domain.vertices()[domain.simplex(simplex)[c] as usize]);
        let gradients = domain.barycentric_gradients(simplex);
        let sides = [p, q].map(|corner| [corner[0] - origin[0], corner[1] - origin[1]]);
        Frame { origin, sides, gradients: [gradients[1], gradients[2]] }
    }

    fn corner_value(&mut self, simplex: usize, corner: usize) -> f64 {
        let f = self.f;
        let vertex = f.domain().simplex(simplex)[corner] as usize;
        *self.values[vertex].get_or_insert_with(|| {
            let mut barycentric = [0.0; 4];
            barycentric[corner] = 1.0;
            f.value_at(&Place { simplex, barycentric, position: f.domain().vertices()[vertex] })
        })
    }

    fn edge(&mut self, simplex: usize, edge: usize) -> Edge {
        let index = self.f.domain().edges_of(simplex)[edge] as usize;
        if let Some(known) = self.edges[index] {
            return known;
        }
        let ends = self.f.domain().edges()[index];
        let corner = |v: u32| self.f.domain().simplex(simplex).iter().position(|&c| c == v);
        let [Some(low), Some(high)] = ends.map(corner) else { unreachable!("the ends of an edge are corners") };
        let values = [low, high].map(|corner| self.corner_value(simplex, corner));
        let [p, q] = ends.map(|v| self.f.domain().vertices()[v as usize]);
        let position = |t: f64| [0, 1].map(|a| if t == 1.0 { q[a] } else { p[a] + t * (q[a] - p[a]) });
        let value = |t: f64| {
            let mut barycentric = [0.0; 4];
            (barycentric[low], barycentric[high]) = (1.0 - t, t);
            self.f.value_at(&Place { simplex, barycentric, position: position(t) })
        };
        let changes = is_negative(values[0]) != is_negative(values[1]);
        let degree = self.f.basis().degree();
        let middle = if degree == Some(2) { value(0.5) } else { 0.0 };
        let (parameters, count) = match degree {
            Some(2) => quadratic([values[0], middle, values[1]]),
            Some(1) if changes => ([linear(values), 1.0], 1),
            _ if changes => ([bracketed(values, value), 1.0], 1),
            _ => ([0.0, 1.0], 0),
        };
        let known = Edge { middle, count, parameters, positions: parameters.map(position) };
        self.edges[index] = Some(known);
        known
    }

    /// The crossings along the outline of a triangle, counter-clockwise.
    fn crossings(&self, simplex: usize, edges: &[Edge; 3]) -> Vec<Crossing> {
        let corners = self.f.domain().simplex(simplex);
        let mut crossings = Vec::new();
        for (side, local) in OUTLINE.into_iter().enumerate() {
            let (edge, index) = (edges[local], self.f.domain().edges_of(simplex)[local]);
            let forward = corners[side] < corners[(side + 1) % 3];
            for k in 0..edge.count {
                let root = if forward { k } else { edge.count - 1 - k };
                let t = edge.parameters[root];
                let along = if forward { t } else { 1.0 - t };
                let reference = match side {
                    0 => [along, 0.0],
                    1 => [1.0 - along, along],
                    _ => [0.0, 1.0 - along],
                };
                let point = Point { reference, position: edge.positions[root] };
                crossings.push(Crossing {
                    link: 2 * u64::from(index) + root as u64,
                    side,
                    along: side as f64 + along,
                    point,
                });
            }
        }
        crossings
    }
}

/// One triangle, and how it is crossed.
struct Tracing {
    simplex: usize,
    frame: Frame,
    crossings: Vec<Crossing>,
    tolerance: f64,
}

impl Tracing {
    /// Adds the one curve through a triangle that is crossed twice or not at all.
    fn segment(&self, first_sign: f64, between: impl Fn([[f64; 2]; 2]) -> Vec<[f64; 2]>, arcs: &mut Vec<Arc>) {
        let [a, b] = self.crossings.as_slice() else { return };
        // The way from the end of the negative part of the outline back to its beginning.
        let (from, to) = if first_sign < 0.0 { (a, b) } else { (b, a) };
        let ends = [from.point.position, to.point.position];
        let mut points = vec![ends[0]];
        points.extend(between(ends));
        points.push(ends[1]);
        arcs.push(Arc { simplex: self.simplex, points, links: vec![from.link, to.link] });
    }

    /// Adds the arcs of a conic.
    fn conic(&self, mut conic: Conic, first_sign: f64, arcs: &mut Vec<Arc>) {
        if self.crossings.is_empty() {
            // An ellipse with the triangle inside it has no crossings either.
            if conic.convex_sign() != first_sign {
                arcs.extend(self.ellipse(&conic));
            }
            return;
        }
        let along: Vec<f64> = self.crossings.iter().map(|c| c.along).collect();
        conic.settle(&along, first_sign);
        for [from, to] in conic.arcs(&along, first_sign) {
            let [a, b] = [from, to].map(|c| self.crossings[c]);
            let inner = conic.flatten(&self.frame, [a.point, b.point], self.across(from, to), self.tolerance);
            let mut points = vec![a.point.position];
            points.extend(inner);
            points.push(b.point.position);
            arcs.push(oriented(&conic, Arc { simplex: self.simplex, points, links: vec![a.link, b.link] }));
        }
    }

    /// The direction of the chord of an arc that returns to the edge it comes from: back along the edge.
    fn across(&self, from: usize, to: usize) -> Option<[f64; 2]> {
        let [u, v] = self.frame.sides;
        let side = self.crossings[from].side;
        (from > to && side == self.crossings[to].side).then(|| match side {
            0 => u.map(|c| -c),
            1 => [u[0] - v[0], u[1] - v[1]],
            _ => v,
        })
    }

    /// An ellipse inside the triangle.
    fn ellipse(&self, conic: &Conic) -> Option<Arc> {
        let ends = conic.ellipse(&self.frame)?;
        let mut points = Vec::new();
        for k in 0..4 {
            points.push(ends[k].position);
            points.extend(conic.flatten(&self.frame, [ends[k], ends[(k + 1) % 4]], None, self.tolerance));
        }
        Some(oriented(conic, Arc { simplex: self.simplex, points, links: Vec::new() }))
    }
}

/// Turns an arc with a convex set on its left so that F < 0 is there.
fn oriented(conic: &Conic, mut arc: Arc) -> Arc {
    if conic.convex_sign() > 0.0 {
        arc.points.reverse();
        arc.links.reverse();
    }
    arc
}

/// Joins arcs where they share a crossing.
fn join(arcs: Vec<Arc>) -> Vec<Polyline> {
    let first: FxHashMap<u64, usize> =
        arcs.iter().enumerate().filter_map(|(i, arc)| Some((*arc.links.first()?, i))).collect();
    let ends: FxHashMap<u64, usize> =
        arcs.iter().enumerate().filter_map(|(i, arc)| Some((*arc.links.last()?, i))).collect();
    let mut used = vec![false; arcs.len()];
    let mut lines = Vec::new();
    // Open curves from their beginnings, then what is left: closed ones.
    let begins = |arc: &Arc| arc.links.first().is_some_and(|link| !ends.contains_key(link));
    let starts = (0..arcs.len()).filter(|&i| begins(&arcs[i])).chain(0..arcs.len());
    for start in starts {
        let mut line = Polyline { points: Vec::new(), closed: true };
        let mut next = Some(start).filter(|&i| !used[i]);
        if next.is_none() {
            continue;
        }
        while let Some(arc) = next.filter(|&i| !used[i]) {
            used[arc] = true;
            line.points.extend_from_slice(&arcs[arc].points);
            next = arcs[arc].links.last().and_then(|link| first.get(link)).copied();
            line.closed = next.is_some() || arcs[arc].links.is_empty();
        }
        line.points.dedup();
        if line.closed && line.points.first() == line.points.last() {
            line.points.pop();
        }
        // Where F touches zero in a vertex only, nothing but that vertex is left.
        if line.points.len() > if line.closed { 2 } else { 1 } {
            lines.push(line);
        }
    }
    lines
}
