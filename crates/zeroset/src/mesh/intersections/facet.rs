//! Whether two triangles have more in common than their corners.

use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::vec3::{self, Vec3};

/// A triangle with an area, ready for exact tests.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Facet {
    /// Counter-clockwise in the projection.
    corners: [Vec3; 3],
    /// The two axes of a projection that leaves the triangle an area.
    axes: [usize; 2],
}

/// Pairs of axes, by the axis that they leave out.
const PROJECTIONS: [[usize; 2]; 3] = [[1, 2], [2, 0], [0, 1]];

/// Positive if three positions turn to the left in a projection; the sign is exact.
fn turn(axes: [usize; 2], [a, b, c]: [Vec3; 3]) -> f64 {
    let flat = |p: Vec3| Coord { x: p[axes[0]], y: p[axes[1]] };
    orient2d(flat(a), flat(b), flat(c))
}

/// Zero if `p` lies in the plane of three positions, else a sign for each of its sides; exact.
fn side([a, b, c]: [Vec3; 3], p: Vec3) -> f64 {
    let solid = |p: Vec3| Coord3D { x: p[0], y: p[1], z: p[2] };
    orient3d(solid(a), solid(b), solid(c), solid(p))
}

/// A projection that leaves a triangle an area.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Projection {
    /// The axis that it leaves out.
    across: u8,
    /// Whether the triangle is clockwise there.
    clockwise: bool,
}

impl Projection {
    /// `None` if the corners lie on one line, exactly.
    pub(crate) fn new([a, b, c]: [Vec3; 3]) -> Option<Self> {
        let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a)).map(f64::abs);
        let longest = (0..3).fold(0, |best, axis| if normal[axis] > normal[best] { axis } else { best });
        (0..3).find_map(|step| {
            let across = (longest + step) % 3;
            let turn = turn(PROJECTIONS[across], [a, b, c]);
            (turn != 0.0).then_some(Self { across: across as u8, clockwise: turn < 0.0 })
        })
    }
}

impl Facet {
    /// `None` if the corners lie on one line, exactly.
    pub(crate) fn new(corners: [Vec3; 3]) -> Option<Self> {
        Some(Self::projected(corners, Projection::new(corners)?))
    }

    /// The triangle of which `projection` was found.
    pub(crate) fn projected([a, b, c]: [Vec3; 3], projection: Projection) -> Self {
        let corners = if projection.clockwise { [a, c, b] } else { [a, b, c] };
        Self { corners, axes: PROJECTIONS[projection.across as usize] }
    }

    /// Whether the two have more in common than corners, or an edge, that lie at the same places in both. Exact.
    pub(crate) fn overlaps(&self, other: &Self) -> bool {
        let shared = self.corners.map(|corner| other.corners.contains(&corner));
        match shared.iter().filter(|shared| **shared).count() {
            3 => true,
            _ if self.apart_in_projection(other) => false,
            2 => self.folded_onto(other, shared),
            _ => self.cuts(other),
        }
    }

    fn has(&self, corner: Vec3) -> bool {
        self.corners.contains(&corner)
    }

    /// Its edges, counter-clockwise.
    fn edges(&self) -> [[Vec3; 2]; 3] {
        let [a, b, c] = self.corners;
        [[a, b], [b, c], [c, a]]
    }

    /// Whether a line along an edge, in the projection of this triangle, has the two on different sides, with nothing of one of
    /// them on the line but corners of both. This settles most pairs, neighbours in one plane among them, without a look at space.
    fn apart_in_projection(&self, other: &Self) -> bool {
        let axes = self.axes;
        let outside = |[from, to]: [Vec3; 2], sign: f64, of: &Self, owner: &Self| {
            of.corners.iter().all(|&corner| {
                let turn = sign * turn(axes, [from, to, corner]);
                turn < 0.0 || (turn == 0.0 && owner.has(corner))
            })
        };
        if self.edges().into_iter().any(|edge| outside(edge, 1.0, other, self)) {
            return true;
        }
        let sign = turn(axes, other.corners);
        sign != 0.0 && other.edges().into_iter().any(|edge| outside(edge, sign.signum(), self, other))
    }

    /// Whether two triangles with an edge in common lie in one plane on the same side of it.
    fn folded_onto(&self, other: &Self, shared: [bool; 3]) -> bool {
        // The corner that is not shared, and the edge opposite to it.
        let own = shared.iter().position(|shared| !shared).unwrap_or_default();
        let [from, to] = [(own + 1) % 3, (own + 2) % 3].map(|corner| self.corners[corner]);
        let Some(&apex) = other.corners.iter().find(|corner| !self.has(**corner)) else { return true };
        side(self.corners, apex) == 0.0 && turn(self.axes, [from, to, apex]) > 0.0
    }

    /// Whether an edge of one meets the other, for triangles with at most one corner in common: then the edge opposite to that
    /// corner is the one that counts, as a segment from the corner to another common position leaves one of the two there.
    fn cuts(&self, other: &Self) -> bool {
        let sides = |of: &Self, plane: &Self| {
            of.corners.map(|corner| if plane.has(corner) { 0.0 } else { side(plane.corners, corner) })
        };
        let one_side = |sides: [f64; 3]| sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0);
        let own = sides(self, other);
        if one_side(own) {
            return false;
        }
        let others = sides(other, self);
        !one_side(others) && (self.pierces(own, other) || other.pierces(others, self))
    }

    /// Whether an edge without a corner of `plane` meets it; `sides` tells where the corners lie.
    fn pierces(&self, sides: [f64; 3], plane: &Self) -> bool {
        (0..3).any(|from| {
            let to = (from + 1) % 3;
            let edge = [self.corners[from], self.corners[to]];
            !edge.iter().any(|end| plane.has(*end)) && plane.meets(edge, [sides[from], sides[to]])
        })
    }

    /// Whether a segment, the sides of whose ends are known, meets the triangle.
    fn meets(&self, [p, q]: [Vec3; 2], sides: [f64; 2]) -> bool {
        if sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0) {
            return false;
        }
        if sides == [0.0; 2] {
            return self.meets_in_plane([p, q]);
        }
        let turns = self.edges().map(|[from, to]| side([p, q, from], to));
        turns.iter().all(|t| *t >= 0.0) || turns.iter().all(|t| *t <= 0.0)
    }

    /// The same for a segment in the plane: no line along an edge or the segment has them on different sides.
    fn meets_in_plane(&self, [p, q]: [Vec3; 2]) -> bool {
        let beyond = |[from, to]: [Vec3; 2]| [p, q].iter().all(|&end| turn(self.axes, [from, to, end]) < 0.0);
        let turns = self.corners.map(|corner| turn(self.axes, [p, q, corner]));
        let one_side = turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0);
        !one_side && !self.edges().into_iter().any(beyond)
    }
}
