//! The common area of a polygon and a face.

use super::super::Plane;
use super::truth::{Face, Truth, bounds};
use crate::mesh::Mesh;
use crate::sample::sample_surface;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Rows of samples over a polygon.
const ROWS: usize = 24;
/// Samples over a polygon, and over a face.
const SAMPLES: usize = 512;

/// The rings of a found plane, in coordinates of the plane.
pub(super) struct Polygon {
    origin: Vec3,
    axes: [Vec3; 2],
    rings: Vec<Vec<[f64; 2]>>,
    pub(super) area: f64,
    /// The box around it in space.
    pub(super) bounds: [Vec3; 2],
    /// Positions in space that are spread evenly over it.
    samples: Vec<Vec3>,
}

impl Polygon {
    /// `None` if the rings enclose nothing, or the normal has no direction.
    pub(super) fn new(plane: &Plane) -> Option<Self> {
        let normal = vec3::normalized(plane.normal)?;
        let origin = *plane.rings.iter().flatten().next()?;
        let axes = vec3::axes_across(normal);
        let in_plane = |p: &Vec3| axes.map(|axis| vec3::dot(vec3::sub(*p, origin), axis));
        let rings: Vec<Vec<_>> = plane.rings.iter().map(|ring| ring.iter().map(in_plane).collect()).collect();
        let bounds = bounds(plane.rings.iter().flatten().copied())?;
        let mut polygon = Self { origin, axes, rings, area: 0.0, bounds, samples: Vec::new() };
        polygon.fill()?;
        Some(polygon)
    }

    /// Cuts the polygon into rows along its first axis, and spreads samples over them. Even and odd crossings tell inside
    /// from outside, so rings may cross.
    fn fill(&mut self) -> Option<()> {
        let heights = || self.rings.iter().flatten().map(|p| p[1]);
        let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
        let step = (high - low) / ROWS as f64;
        let mut pieces = Vec::new();
        for row in 0..ROWS {
            let height = low + (row as f64 + 0.5) * step;
            let crossings = self.crossings(height);
            pieces.extend(crossings.chunks_exact(2).map(|ends| (height, ends[0], ends[1])));
        }
        let total: f64 = pieces.iter().map(|(_, from, to)| to - from).sum();
        if !(total > 0.0 && step > 0.0 && total.is_finite()) {
            return None;
        }
        self.area = total * step;
        let (gap, mut before) = (total / SAMPLES as f64, 0.0);
        for (height, from, to) in pieces {
            let mut next = (self.samples.len() as f64 + 0.5) * gap - before;
            while next <= to - from && self.samples.len() < SAMPLES {
                let place = vec3::add_scaled(self.origin, self.axes[0], from + next);
                self.samples.push(vec3::add_scaled(place, self.axes[1], height));
                next += gap;
            }
            before += to - from;
        }
        Some(())
    }

    /// Where the rings cross a height, in rising order.
    fn crossings(&self, height: f64) -> Vec<f64> {
        let mut crossings = Vec::new();
        for ring in &self.rings {
            for (i, &[x, y]) in ring.iter().enumerate() {
                let [next_x, next_y] = ring[(i + 1) % ring.len()];
                if (y > height) != (next_y > height) {
                    crossings.push(x + (height - y) / (next_y - y) * (next_x - x));
                }
            }
        }
        crossings.sort_unstable_by(f64::total_cmp);
        crossings
    }

    /// Whether a position lies inside, seen along the normal.
    fn contains(&self, position: Vec3) -> bool {
        let [x, y] = self.axes.map(|axis| vec3::dot(vec3::sub(position, self.origin), axis));
        self.crossings(y).iter().filter(|crossing| **crossing > x).count() % 2 == 1
    }
}

/// A true face with what the search for common areas needs.
pub(super) struct Outline {
    mesh: Mesh,
    tree: TriangleTree,
    samples: Vec<Vec3>,
}

/// What a polygon and a face have in common.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Overlap {
    /// Share of the polygon that lies in the face.
    pub(super) of_polygon: f64,
    /// Share of the face that lies in the polygon.
    pub(super) of_face: f64,
    pub(super) area: f64,
}

impl Outline {
    pub(super) fn new(truth: &Truth, face: &Face) -> Self {
        let triangles =
            face.triangles.iter().map(|&t| truth.mesh.triangles[t].map(|v| truth.mesh.vertices[v as usize]));
        let mut mesh = Mesh::default();
        for corners in triangles {
            let first = mesh.vertices.len() as u32;
            mesh.vertices.extend(corners);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        let samples = sample_surface(&mesh, SAMPLES, 0).map_or_else(Vec::new, |samples| samples.points);
        Self { tree: TriangleTree::new(&mesh), mesh, samples }
    }

    /// Whether a position, moved along the normal of its nearest triangle, lies in the face.
    fn contains(&self, position: Vec3, normal: Vec3, slack: f64) -> bool {
        let Some(corner) = self.mesh.vertices.first() else {
            return false;
        };
        let height = vec3::dot(vec3::sub(position, *corner), normal);
        self.tree.closest_within(vec3::add_scaled(position, normal, -height), slack).is_some()
    }

    /// The common area with a polygon. Rounding and the tenth of a degree by which triangles of a face may differ are
    /// forgiven up to `slack`.
    pub(super) fn overlap(&self, face: &Face, polygon: &Polygon, slack: f64) -> Overlap {
        let share = |inside: usize, all: usize| if all == 0 { 0.0 } else { inside as f64 / all as f64 };
        let inside = polygon.samples.iter().filter(|p| self.contains(**p, face.normal, slack)).count();
        let of_polygon = share(inside, polygon.samples.len());
        let inside = self.samples.iter().filter(|p| polygon.contains(**p)).count();
        let of_face = share(inside, self.samples.len());
        // The smaller one is sampled the more finely.
        let area = if polygon.area <= face.area { of_polygon * polygon.area } else { of_face * face.area };
        Overlap { of_polygon, of_face, area }
    }
}
