//! The polygon of each plane: the outline of its points, drawn out to the edges and corners that it borders on.

use super::outline::{Ring, outline, signed_area, simplified};
use crate::feature::sharp::corners::Meeting;
use crate::feature::sharp::straight::StraightEdge;
use crate::feature::sharp::support::Flat;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Longest side of a triangle of the outline, over the spacing of the region's points. Random points leave gaps of this width once in
/// some thousand.
const REACH: f64 = 4.0;
/// An outline's position this near to an edge, over the spacing, lies on it.
const SNAP: f64 = 2.2;
/// How far simplifying may move an outline, over the spacing.
const SIMPLIFY: f64 = 0.5;
/// Positions between two edges that a corner replaces, at most.
const ROUNDED: usize = 4;

/// A plane's frame: positions in it have two coordinates.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct PlaneFrame {
    origin: Vec3,
    u: Vec3,
    v: Vec3,
}

impl PlaneFrame {
    /// The frame of a plane, with its origin under `near`. Counter-clockwise in the frame is so seen from the tip of the normal.
    pub(in crate::feature) fn new(flat: &Flat, near: Vec3) -> Self {
        let [u, v] = vec3::axes_across(flat.normal);
        Self { origin: vec3::add_scaled(near, flat.normal, -flat.distance(near)), u, v }
    }

    pub(in crate::feature) fn flatten(&self, p: Vec3) -> [f64; 2] {
        let d = vec3::sub(p, self.origin);
        [vec3::dot(d, self.u), vec3::dot(d, self.v)]
    }

    pub(in crate::feature) fn lift(&self, [x, y]: [f64; 2]) -> Vec3 {
        vec3::add_scaled(vec3::add_scaled(self.origin, self.u, x), self.v, y)
    }
}

/// An edge in the frame of a plane.
struct Side {
    ends: [[f64; 2]; 2],
    /// The corner at each end.
    corners: [Option<usize>; 2],
}

/// What borders on a plane.
pub(in crate::feature) struct Borders<'a> {
    pub(in crate::feature) edges: &'a [StraightEdge],
    pub(in crate::feature) corners: &'a [Meeting],
    /// For each plane its edges.
    of_plane: Vec<Vec<usize>>,
    /// For each edge the corners at its ends.
    at_ends: Vec<[Option<usize>; 2]>,
}

impl<'a> Borders<'a> {
    pub(in crate::feature) fn new(planes: usize, edges: &'a [StraightEdge], corners: &'a [Meeting]) -> Self {
        let mut of_plane = vec![Vec::new(); planes];
        for (number, edge) in edges.iter().enumerate() {
            for plane in edge.planes {
                of_plane[plane as usize].push(number);
            }
        }
        let mut at_ends = vec![[None; 2]; edges.len()];
        for (number, corner) in corners.iter().enumerate() {
            for &(edge, end) in &corner.ends {
                at_ends[edge][end] = Some(number);
            }
        }
        Self { edges, corners, of_plane, at_ends }
    }

    fn sides(&self, plane: usize, frame: &PlaneFrame) -> Vec<Side> {
        let side = |&number: &usize| {
            let edge = &self.edges[number];
            let ends = [0, 1].map(|end| match self.at_ends[number][end] {
                Some(corner) => frame.flatten(self.corners[corner].position),
                None => frame.flatten(edge.end(end)),
            });
            Side { ends, corners: self.at_ends[number] }
        };
        self.of_plane[plane].iter().map(side).collect()
    }
}

/// Whether some points of a plane have an outline at all.
pub(in crate::feature) fn has_outline(flat: &Flat, points: &[Vec3], spacing: f64) -> bool {
    !outlines(&PlaneFrame::new(flat, points[0]), points, spacing).is_empty()
}

fn outlines(frame: &PlaneFrame, points: &[Vec3], spacing: f64) -> Vec<Ring> {
    let flattened: Vec<[f64; 2]> = points.iter().map(|&p| frame.flatten(p)).collect();
    outline(&flattened, REACH * spacing, (2.0 * spacing).powi(2))
}

/// The rings of a plane with these points, and its area.
pub(in crate::feature) fn polygon(
    plane: usize,
    flat: &Flat,
    points: &[Vec3],
    spacing: f64,
    borders: &Borders<'_>,
) -> (Vec<Vec<Vec3>>, f64) {
    let Some(&first) = points.first() else { return (Vec::new(), 0.0) };
    let frame = PlaneFrame::new(flat, first);
    let rings = outlines(&frame, points, spacing);
    let sides = Sides::new(borders.sides(plane, &frame));
    let drawn: Vec<Ring> = rings.iter().map(|ring| drawn_ring(ring, &sides, &frame, borders, spacing)).collect();
    // Rings that cross one another are better left at the points.
    let simplified = || rings.iter().map(|ring| simplified(ring, SIMPLIFY * spacing)).collect::<Vec<Ring>>();
    let best = [drawn, simplified()].into_iter().find(|rings| !cross(rings)).unwrap_or(rings);
    let best: Vec<Ring> = best.into_iter().filter(|ring| ring.len() >= 3).collect();
    let area: f64 = best.iter().map(|ring| signed_area(ring)).sum();
    let lifted = best.into_iter().map(|ring| ring.into_iter().map(|p| frame.lift(p)).collect()).collect();
    (lifted, area.max(0.0))
}

/// A ring drawn out to its sides and simplified; only simplified where the sides turn it over, swell it, or cross it.
fn drawn_ring(ring: &Ring, sides: &Sides, frame: &PlaneFrame, borders: &Borders<'_>, spacing: f64) -> Ring {
    let plain = simplified(ring, SIMPLIFY * spacing);
    let drawn = simplified(&drawn_out(ring, sides, frame, borders, spacing), SIMPLIFY * spacing);
    let grown = signed_area(&drawn) / signed_area(ring);
    if drawn.len() >= 3 && (0.5..2.5).contains(&grown) && !cross(std::slice::from_ref(&drawn)) { drawn } else { plain }
}

/// Whether two sides of some rings cross. Sides that touch do not.
fn cross(rings: &[Ring]) -> bool {
    let segments: Vec<[[f64; 2]; 2]> =
        rings.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])).collect();
    // Sorted by their left ends, a segment meets only those that begin before it ends.
    let left = |s: &[[f64; 2]; 2]| s[0][0].min(s[1][0]);
    let right = |s: &[[f64; 2]; 2]| s[0][0].max(s[1][0]);
    let mut sorted = segments;
    sorted.sort_by(|a, b| left(a).total_cmp(&left(b)));
    sorted.iter().enumerate().any(|(i, a)| {
        sorted[i + 1..].iter().take_while(|b| left(b) <= right(a)).any(|b| {
            let turn =
                |p: [f64; 2], [q, r]: [[f64; 2]; 2]| (r[0] - q[0]) * (p[1] - q[1]) - (r[1] - q[1]) * (p[0] - q[0]);
            turn(a[0], *b) * turn(a[1], *b) < 0.0 && turn(b[0], *a) * turn(b[1], *a) < 0.0
        })
    })
}

/// The edges of a plane, with a tree over them: the ground of a town borders on every house.
struct Sides {
    all: Vec<Side>,
    tree: TriangleTree,
}

impl Sides {
    fn new(all: Vec<Side>) -> Self {
        let segments: Vec<[Vec3; 2]> = all.iter().map(|side| side.ends.map(|[x, y]| [x, y, 0.0])).collect();
        Self { all, tree: TriangleTree::from_segments(&segments) }
    }

    /// The nearest side within a reach, and the position on it.
    fn nearest(&self, p: [f64; 2], reach: f64) -> Option<(usize, [f64; 2])> {
        let closest = self.tree.closest_within([p[0], p[1], 0.0], reach)?;
        Some((closest.triangle, [closest.position[0], closest.position[1]]))
    }
}

/// The ring with its positions near edges moved onto them, and with the corners between.
fn drawn_out(ring: &Ring, sides: &Sides, frame: &PlaneFrame, borders: &Borders<'_>, spacing: f64) -> Ring {
    let mut placed: Vec<(Option<usize>, [f64; 2])> = ring
        .iter()
        .map(|&p| match sides.nearest(p, SNAP * spacing) {
            Some((side, on)) => (Some(side), on),
            None => (None, p),
        })
        .collect();
    // Start where the side changes, so that no run is cut in two.
    if let Some(start) = (1..placed.len()).find(|&i| placed[i].0 != placed[i - 1].0) {
        placed.rotate_left(start);
    }
    let mut runs: Vec<(Option<usize>, Vec<[f64; 2]>)> = Vec::new();
    for (side, p) in placed {
        match runs.last_mut() {
            Some(run) if run.0 == side => run.1.push(p),
            _ => runs.push((side, vec![p])),
        }
    }
    let shared = |a: usize, b: usize| {
        let corner =
            sides.all[a].corners.iter().flatten().find(|c| sides.all[b].corners.iter().flatten().any(|d| d == *c));
        corner.map(|&c| frame.flatten(borders.corners[c].position))
    };
    let mut drawn = Vec::new();
    for (number, (side, run)) in runs.iter().enumerate() {
        let ahead = |steps: usize| &runs[(number + steps) % runs.len()];
        match side {
            Some(side) => {
                drawn.push(run[0]);
                drawn.push(run[run.len() - 1]);
                // A corner stands directly after this side, or after a few positions that it has rounded off.
                let (next, after) = (ahead(1), ahead(2));
                let other = match (next.0, after.0) {
                    (Some(other), _) => Some(other),
                    (None, Some(other)) if next.1.len() <= ROUNDED => Some(other),
                    _ => None,
                };
                if let Some(corner) = other.and_then(|other| shared(*side, other)) {
                    drawn.push(corner);
                }
            }
            None => {
                let (before, after) = (&runs[(number + runs.len() - 1) % runs.len()], ahead(1));
                let is_replaced =
                    run.len() <= ROUNDED && matches!((before.0, after.0), (Some(a), Some(b)) if shared(a, b).is_some());
                if !is_replaced {
                    drawn.extend_from_slice(run);
                }
            }
        }
    }
    drawn.dedup();
    drawn
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::model::FeatureKind;

    /// A square on z = 0 with corners at 0 and 10, whose points end half a spacing inside.
    fn square() -> (Flat, Vec<Vec3>) {
        let flat = Flat { normal: [0.0, 0.0, 1.0], offset: 0.0, oriented: true };
        let points = (0..400).map(|i| [0.25 + 0.5 * f64::from(i % 20), 0.25 + 0.5 * f64::from(i / 20), 0.0]).collect();
        (flat, points)
    }

    fn side(plane: u32, from: Vec3, to: Vec3) -> StraightEdge {
        let d = vec3::sub(to, from);
        let length = vec3::norm(d);
        let direction = vec3::scale(d, 1.0 / length);
        let kind = FeatureKind::Convex;
        StraightEdge { planes: [0, plane], origin: from, direction, ends: [0.0, length], kind, angle: 1.5 }
    }

    #[test]
    fn an_outline_without_edges_ends_on_points() {
        let (flat, points) = square();
        let borders = Borders::new(1, &[], &[]);
        let (rings, area) = polygon(0, &flat, &points, 0.5, &borders);
        assert_eq!((rings.len(), rings[0].len()), (1, 4));
        assert!((area - 9.5 * 9.5).abs() < 1e-9, "{area}");
    }

    #[test]
    fn an_outline_is_drawn_out_to_edges_and_corners() {
        let (flat, points) = square();
        let at = [[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0]];
        let edges: Vec<StraightEdge> = (0..4).map(|i| side(1 + i as u32, at[i], at[(i + 1) % 4])).collect();
        let corner = |i: usize| Meeting {
            position: at[i],
            planes: vec![0],
            ends: vec![(i, 0), ((i + 3) % 4, 1)],
            creases: Vec::new(),
        };
        let corners: Vec<Meeting> = (0..4).map(corner).collect();
        let borders = Borders::new(5, &edges, &corners);
        let (rings, area) = polygon(0, &flat, &points, 0.5, &borders);
        assert!((area - 100.0).abs() < 1e-9, "{area} {rings:?}");
        assert_eq!(rings[0].len(), 4);
        // Edges on two sides only: the others stay at the points.
        let borders = Borders::new(5, &edges[..2], &corners[1..2]);
        let (_, area) = polygon(0, &flat, &points, 0.5, &borders);
        assert!((area - 9.75 * 9.75).abs() < 0.3, "{area}");
    }
}
