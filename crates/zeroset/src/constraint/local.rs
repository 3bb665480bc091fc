//! Constraints in the frame of a fit, cut to the box of its points.

use rayon::prelude::*;

use super::{ConstraintPlan, ConstraintReport, Constraints};
use crate::domain::polygon_area;
use crate::mesh::Mesh;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// How far beyond the box of the points constraints count, relative to its longest side: half of what the lattice is padded by.
const MARGIN_REL: f64 = 0.05;

/// Lines and polygons, as far as they take part.
#[derive(Debug, Clone, Default)]
pub(crate) struct Local {
    /// The segments of each line, in order.
    pub(crate) lines: Vec<Vec<[Vec3; 2]>>,
    pub(crate) polygons: Vec<LocalPolygon>,
    pub(crate) plan: ConstraintPlan,
}

/// The part of a polygon that takes part.
#[derive(Debug, Clone)]
pub(crate) struct LocalPolygon {
    pub(crate) triangles: Vec<[Vec3; 3]>,
    /// Unit normal of either side.
    pub(crate) normal: Vec3,
    pub(crate) area: f64,
}

impl Local {
    /// Takes the offset off, turns what is left with `enter`, and cuts it to the box of the points in that frame.
    pub(crate) fn new(
        constraints: &Constraints,
        world_from_local: Vec3,
        enter: impl Fn(Vec3) -> Vec3,
        (low, high): (Vec3, Vec3),
    ) -> Self {
        let margin = MARGIN_REL * (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
        let (low, high) = (low.map(|c| c - margin), high.map(|c| c + margin));
        let at = |p: &Vec3| enter(vec3::sub(*p, world_from_local));
        let origin = enter([0.0; 3]);
        let lines: Vec<Vec<[Vec3; 2]>> = constraints
            .lines
            .iter()
            .map(|line| {
                let line: Vec<Vec3> = line.iter().map(at).collect();
                line.windows(2).filter_map(|ends| cut_segment([ends[0], ends[1]], low, high)).collect()
            })
            .filter(|segments: &Vec<_>| !segments.is_empty())
            .collect();
        let polygons: Vec<LocalPolygon> = constraints
            .polygons
            .iter()
            .map(|polygon| {
                let triangles: Vec<[Vec3; 3]> =
                    polygon.triangles.iter().flat_map(|t| cut_triangle(t.each_ref().map(at), low, high)).collect();
                let area = triangles.iter().map(|t| polygon_area(t)).sum();
                LocalPolygon { triangles, normal: vec3::sub(enter(polygon.normal), origin), area }
            })
            .filter(|polygon| polygon.area > 0.0)
            .collect();
        let plan = ConstraintPlan {
            lines: constraints.lines.len(),
            polygons: constraints.polygons.len(),
            lines_used: lines.len(),
            polygons_used: polygons.len(),
            length: lines.iter().flatten().map(|[a, b]| vec3::distance(*a, *b)).sum(),
            area: polygons.iter().map(|polygon| polygon.area).sum(),
        };
        Self { lines, polygons, plan }
    }

    /// In the frame that `leave` leads to.
    pub(crate) fn moved(&self, leave: impl Fn(Vec3) -> Vec3) -> Self {
        let triangle = |t: &[Vec3; 3]| t.map(&leave);
        let polygons = self.polygons.iter().map(|polygon| LocalPolygon {
            triangles: polygon.triangles.iter().map(triangle).collect(),
            normal: vec3::sub(leave(polygon.normal), leave([0.0; 3])),
            area: polygon.area,
        });
        let lines = self.lines.iter().map(|line| line.iter().map(|ends| ends.map(&leave)).collect());
        Self { lines: lines.collect(), polygons: polygons.collect(), plan: self.plan }
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.polygons.is_empty()
    }

    pub(crate) fn segments(&self) -> impl Iterator<Item = [Vec3; 2]> + '_ {
        self.lines.iter().flatten().copied()
    }

    pub(crate) fn triangles(&self) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        self.polygons.iter().flat_map(|polygon| &polygon.triangles).copied()
    }

    /// Number of samples, known before they are made.
    pub(crate) fn count(&self, step: f64) -> usize {
        let on_lines = self.segments().map(|ends| steps(vec3::distance(ends[0], ends[1]), step) + 1);
        on_lines.chain(self.triangles().map(|t| Rows::of(&t, step).count())).fold(0, usize::saturating_add)
    }

    /// Positions on all lines and polygons, no farther apart than a step, in order.
    pub(crate) fn samples(&self, step: f64) -> Vec<Vec3> {
        let mut samples = Vec::new();
        for [from, to] in self.segments() {
            let n = steps(vec3::distance(from, to), step);
            samples.extend((0..=n).map(|i| vec3::lerp(from, to, i as f64 / n as f64)));
        }
        self.triangles().for_each(|t| Rows::of(&t, step).visit(|p| samples.push(p)));
        samples
    }

    /// How far a mesh in the same frame lies from them; `None` if there are none.
    pub(crate) fn measure(&self, mesh: &Mesh, step: f64, on_lines: usize) -> Option<ConstraintReport> {
        if self.is_empty() {
            return None;
        }
        let tree = TriangleTree::new(mesh);
        let mut distances: Vec<f64> =
            self.samples(step).into_par_iter().filter_map(|p| Some(tree.closest(p)?.distance_squared.sqrt())).collect();
        let mean_distance = distances.iter().sum::<f64>() / distances.len() as f64;
        distances.par_sort_unstable_by(f64::total_cmp);
        let max_distance = *distances.last()?;
        let p95_distance = distances[((distances.len() - 1) as f64 * 0.95) as usize];
        Some(ConstraintReport { mean_distance, p95_distance, max_distance, on_lines })
    }
}

/// Into how many parts a length is cut.
fn steps(length: f64, step: f64) -> usize {
    (length / step).ceil().max(1.0) as usize
}

/// Rows of positions in a triangle, along its longest side.
struct Rows {
    /// Beginning and end of the longest side, and the corner across.
    corners: [Vec3; 3],
    rows: usize,
    step: f64,
}

impl Rows {
    fn of(&[a, b, c]: &[Vec3; 3], step: f64) -> Self {
        let sides = [[a, b, c], [b, c, a], [c, a, b]];
        let length = |side: &[Vec3; 3]| vec3::distance(side[0], side[1]);
        let corners =
            sides.into_iter().fold(sides[0], |best, side| if length(&side) > length(&best) { side } else { best });
        let height = 2.0 * polygon_area(&corners) / length(&corners).max(f64::MIN_POSITIVE);
        Self { corners, rows: steps(height, step), step }
    }

    /// Positions in each row.
    fn row(&self, i: usize) -> (f64, usize) {
        let up = (i as f64 + 0.5) / self.rows as f64;
        (up, steps((1.0 - up) * vec3::distance(self.corners[0], self.corners[1]), self.step))
    }

    /// About how many there are, and no fewer.
    fn count(&self) -> usize {
        let longest = steps(vec3::distance(self.corners[0], self.corners[1]), self.step);
        self.rows.saturating_mul(longest.saturating_add(2)) / 2 + 1
    }

    fn visit(&self, mut visit: impl FnMut(Vec3)) {
        let [from, to, apex] = self.corners;
        for i in 0..self.rows {
            let (up, n) = self.row(i);
            let ends = [vec3::lerp(from, apex, up), vec3::lerp(to, apex, up)];
            (0..n).for_each(|k| visit(vec3::lerp(ends[0], ends[1], (k as f64 + 0.5) / n as f64)));
        }
    }
}

/// The part of a segment in a box.
fn cut_segment([from, to]: [Vec3; 2], low: Vec3, high: Vec3) -> Option<[Vec3; 2]> {
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for a in 0..3 {
        for (p, q) in [(from[a] - low[a], to[a] - low[a]), (high[a] - from[a], high[a] - to[a])] {
            match (p < 0.0, q < 0.0) {
                (true, true) => return None,
                (true, false) => enters = enters.max(p / (p - q)),
                (false, true) => leaves = leaves.min(p / (p - q)),
                (false, false) => {}
            }
        }
    }
    let at = |t: f64| if t == 1.0 { to } else { vec3::lerp(from, to, t) };
    (enters < leaves).then(|| [at(enters), at(leaves)]).filter(|[a, b]| a != b)
}

/// The part of a triangle in a box, as triangles.
fn cut_triangle(corners: [Vec3; 3], low: Vec3, high: Vec3) -> Vec<[Vec3; 3]> {
    let mut polygon = corners.to_vec();
    for (axis, sign, limit) in (0..3).flat_map(|a| [(a, 1.0, low[a]), (a, -1.0, high[a])]) {
        let height = |p: &Vec3| sign * (p[axis] - limit);
        if polygon.iter().all(|p| height(p) >= 0.0) {
            continue;
        }
        let whole = std::mem::take(&mut polygon);
        for (i, p) in whole.iter().enumerate() {
            let q = &whole[(i + 1) % whole.len()];
            let (here, there) = (height(p), height(q));
            if here >= 0.0 {
                polygon.push(*p);
            }
            if (here < 0.0) != (there < 0.0) {
                polygon.push(vec3::lerp(*p, *q, here / (here - there)));
            }
        }
    }
    (1..polygon.len().saturating_sub(1)).map(|i| [polygon[0], polygon[i], polygon[i + 1]]).collect()
}
