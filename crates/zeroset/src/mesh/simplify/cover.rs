//! Both surfaces held near to each other: points of the original, each held by a triangle that is near to it, and the vertices of
//! the simplified one, held against the original.

use super::surface::{Change, Surface};
use crate::spatial::{TriangleTree, closest_on_triangle};
use crate::vec3::{self, Vec3};

/// The most points for each triangle of the original, on average, and what any mesh may have.
const POINTS_A_TRIANGLE: f64 = 3.0;
const POINTS_AT_LEAST: f64 = 1e5;
/// The most places on a new edge that are looked at.
const MOST_PLACES: f64 = 63.0;
/// The most pieces that an edge of the original is cut into.
const MOST_PIECES: f64 = 64.0;

/// How closely the two are held together.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Care {
    /// Enough for most meshes of small triangles.
    Usual,
    /// Points and places on edges are closer together, and the middles of new triangles are held against the original, too.
    Great,
}

/// How near the two are held together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Tolerance {
    /// The largest distance of the points that are watched, now.
    bound: f64,
    /// What it may grow to.
    most: f64,
    care: Care,
}

impl Tolerance {
    /// The bound on the points that are watched over the one that holds everywhere, as the surfaces bend away between them.
    const CAUTION: f64 = 0.9;
    /// The first bound for a number of triangles, over the side of an equal triangle of which so many make the area.
    const FIRST_REL: f64 = 1.0 / 64.0;
    /// What a bound grows by.
    const GROWTH: f64 = 1.5;

    /// What should keep a bound everywhere. For a number of triangles the bound grows until they are reached, from one that
    /// suits a surface of moderate curvature.
    pub(super) fn new(surface: &Surface, triangles: Option<usize>, max: Option<f64>) -> Self {
        // Nothing is farther away than this.
        let far = || surface.extent();
        let most = max.map_or_else(far, |max| Self::CAUTION * max);
        let first = triangles.map_or(most, |n| Self::FIRST_REL * (surface.area() / (0.433 * n.max(1) as f64)).sqrt());
        Self { bound: first.min(most), most, care: Care::Usual }
    }

    /// The next to try where an error was measured that is over the bound.
    pub(super) fn tighten(&mut self, max: f64, measured: f64) {
        match self.care {
            Care::Usual => self.care = Care::Great,
            Care::Great => self.most *= Self::CAUTION * max / measured,
        }
        self.bound = self.bound.min(self.most);
    }

    /// Lets the bound grow; whether it may.
    fn grow(&mut self) -> bool {
        let grows = self.bound < self.most;
        self.bound = (Self::GROWTH * self.bound).min(self.most);
        grows
    }
}

impl Care {
    /// The spacing of the points over the error that is allowed. Two: between points so far apart, the simplified surface
    /// mostly bends away by no more than a tenth of the error.
    fn spacing_rel(self) -> f64 {
        match self {
            Self::Usual => 2.0,
            Self::Great => 0.5,
        }
    }

    /// The same for places on new edges, whose ends lie near the original.
    fn step_rel(self) -> f64 {
        2.0 * self.spacing_rel()
    }
}

/// Which points each triangle holds. None is farther from its triangle than the bound.
#[derive(Debug)]
pub(super) struct Cover<'a> {
    original: &'a TriangleTree,
    tolerance: Tolerance,
    held: Vec<Vec<Vec3>>,
}

/// Where a change would put the points: each with the place of its triangle in `Change::changing`.
pub(super) type Moves = Vec<(u32, Vec3)>;

impl<'a> Cover<'a> {
    /// Points over a surface: its vertices, and a grid on each triangle whose edges are long against the bound.
    pub(super) fn new(surface: &Surface, original: &'a TriangleTree, tolerance: Tolerance) -> Self {
        let live = (0..surface.triangles.len() as u32).filter(|&t| surface.is_alive(t));
        let squares: f64 = live.map(|t| longest(surface.corners(t)).powi(2)).sum();
        // A triangle cut into m pieces along each edge has about m^2 / 2 points.
        let affordable = (squares / (2.0 * (POINTS_A_TRIANGLE * surface.live() as f64 + POINTS_AT_LEAST))).sqrt();
        let spacing = (tolerance.care.spacing_rel() * tolerance.bound).max(affordable);
        let mut held = vec![Vec::new(); surface.triangles.len()];
        for (t, points) in held.iter_mut().enumerate().filter(|(t, _)| surface.is_alive(*t as u32)) {
            let corners = surface.corners(t as u32);
            let pieces = (longest(corners) / spacing).round().clamp(1.0, MOST_PIECES) as u32;
            let owns = [0, 1, 2].map(|side| surface.is_first_at(t as u32, side));
            grid(pieces, owns, |weights| points.push(blend(corners, weights)));
        }
        for v in 0..surface.vertices.len() as u32 {
            if let Some(&first) = surface.star(v).first() {
                held[first as usize].push(surface.vertices[v as usize]);
            }
        }
        Self { original, tolerance, held }
    }

    /// Where a change would put the points; `None` if one would be too far from the surface, or the new vertex from the original.
    ///
    /// A point whose foot lies within its own triangle stays there; the others go to the nearest of the changed triangles.
    pub(super) fn moves(&self, surface: &Surface, change: &Change, position: Vec3) -> Option<Moves> {
        let after: Vec<[Vec3; 3]> =
            change.changing.iter().map(|&t| surface.corners_after(t, change, position)).collect();
        if !self.lie_near(position, &after) {
            return None;
        }
        let bound_squared = self.tolerance.bound.powi(2);
        let mut moves = Moves::new();
        let near = |point: Vec3, place: usize| vec3::distance_squared(closest_on_triangle(after[place], point), point);
        for (own, &t) in change.changing.iter().chain(&change.dying).enumerate() {
            for &point in &self.held[t as usize] {
                let stays = own < after.len() && near(point, own) <= bound_squared && faces(after[own], point);
                let place = if stays {
                    own
                } else {
                    let rank = |place: usize| (near(point, place), place);
                    let best = (0..after.len()).map(rank).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
                    (best.0 <= bound_squared).then_some(best.1)?
                };
                moves.push((place as u32, point));
            }
        }
        Some(moves)
    }

    /// Whether new triangles around a position lie near the original: the position, places along the edges that end there,
    /// and if need be the middles.
    fn lie_near(&self, position: Vec3, triangles: &[[Vec3; 3]]) -> bool {
        let Tolerance { bound, care, .. } = self.tolerance;
        let near = |p: Vec3| self.original.closest_within(p, bound).is_some();
        let spoke = |&end: &Vec3| {
            let places = (vec3::distance(position, end) / (care.step_rel() * bound)).min(MOST_PLACES) as u32;
            (1..=places).all(|i| near(vec3::lerp(position, end, f64::from(i) / f64::from(places + 1))))
        };
        let middle = |corners: &[Vec3; 3]| near(blend(*corners, [1.0 / 3.0; 3]));
        // Most edges are those of two triangles.
        let mut ends: Vec<Vec3> = Vec::with_capacity(triangles.len() + 1);
        for &end in triangles.iter().flatten().filter(|end| **end != position) {
            if !ends.contains(&end) {
                ends.push(end);
            }
        }
        near(position) && ends.iter().all(spoke) && (care == Care::Usual || triangles.iter().all(middle))
    }

    /// Lets the points be farther away; whether they may.
    pub(super) fn grow(&mut self) -> bool {
        self.tolerance.grow()
    }

    /// Follows a change.
    pub(super) fn apply(&mut self, change: &Change, moves: &Moves) {
        for &t in change.changing.iter().chain(&change.dying) {
            self.held[t as usize].clear();
        }
        for &t in &change.dying {
            self.held[t as usize] = Vec::new();
        }
        for &(place, point) in moves {
            self.held[change.changing[place as usize] as usize].push(point);
        }
    }
}

fn longest([a, b, c]: [Vec3; 3]) -> f64 {
    vec3::distance(a, b).max(vec3::distance(b, c)).max(vec3::distance(c, a))
}

/// Weights of the corners for a grid on a triangle whose edges are cut into pieces: without the corners, and on the edges that it
/// owns only.
fn grid(pieces: u32, owns: [bool; 3], mut add: impl FnMut([f64; 3])) {
    for i in 0..=pieces {
        for j in 0..=pieces - i {
            let steps = [pieces - i - j, i, j];
            // Side s runs from corner s to the next, so the third corner has no weight on it.
            let left_out = (0..3).any(|side| steps[(side + 2) % 3] == 0 && !owns[side]);
            if !left_out && !steps.contains(&pieces) {
                add(steps.map(|s| f64::from(s) / f64::from(pieces)));
            }
        }
    }
}

fn blend(corners: [Vec3; 3], weights: [f64; 3]) -> Vec3 {
    let terms = corners.into_iter().zip(weights);
    terms.fold([0.0; 3], |sum, (corner, weight)| vec3::add_scaled(sum, corner, weight))
}

/// Whether the foot of a point on the plane of a triangle lies within it.
fn faces([a, b, c]: [Vec3; 3], point: Vec3) -> bool {
    let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
    [(a, b), (b, c), (c, a)]
        .into_iter()
        .all(|(from, to)| vec3::dot(vec3::cross(vec3::sub(to, from), vec3::sub(point, from)), normal) >= 0.0)
}
