//! Polygons: rings in the plane, and plane polygons with holes in space, cut into triangles.

use spade::{ConstrainedDelaunayTriangulation, Point2, Triangulation};

use crate::vec3::{add, cross, dot, norm, normalized, scale, sub};

/// What is wrong with a polygon.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// Fewer than three positions.
    #[error("has a ring of {0} different positions; give at least 3")]
    TooFewPositions(usize),
    /// All positions lie in one line.
    #[error("has no area: its positions lie in one line; give a segment instead")]
    NoArea,
    /// A position lies out of the plane of the others.
    #[error(
        "is not plane: a position lies {distance} off the plane of the others, over a size of {size}; cut it into triangles"
    )]
    NotPlane {
        /// The largest distance from the plane.
        distance: f64,
        /// The largest distance from the middle of the polygon.
        size: f64,
    },
    /// Two sides cross.
    #[error("has sides that cross; cut it where they do")]
    Crossing,
}

/// A position may lie off the plane by this share of the polygon's size.
const PLANE: f64 = 1e-6;

/// A ring without repeated positions one after the other, and without its first position at the end.
pub(super) fn open_ring<const D: usize>(ring: &[[f64; D]]) -> Result<Vec<[f64; D]>, PolygonError> {
    let mut open = ring.to_vec();
    open.dedup();
    while open.len() > 1 && open.first() == open.last() {
        open.pop();
    }
    if open.len() < 3 { Err(PolygonError::TooFewPositions(open.len())) } else { Ok(open) }
}

/// The frame of a plane polygon: its middle, its size, its unit normal, and two directions in it.
struct Plane {
    middle: [f64; 3],
    size: f64,
    normal: [f64; 3],
    axes: [[f64; 3]; 2],
}

impl Plane {
    fn of(rings: &[Vec<[f64; 3]>], plane_rel: f64) -> Result<Self, PolygonError> {
        let positions = || rings.iter().flatten();
        let count = positions().count() as f64;
        let middle = scale(positions().fold([0.0; 3], |sum, &p| add(sum, p)), 1.0 / count);
        let size = positions().map(|&p| norm(sub(p, middle))).fold(0.0, f64::max);
        // Twice the vector area of the first ring (Newell): right for any simple ring, convex or not.
        let outer = &rings[0];
        let area = (0..outer.len())
            .fold([0.0; 3], |sum, i| add(sum, cross(sub(outer[i], middle), sub(outer[(i + 1) % outer.len()], middle))));
        // Where sides cross, parts that run either way round can cancel: then any two directions of the ring tell its plane, so that
        // the crossing is found.
        let farthest =
            outer.iter().map(|&p| sub(p, middle)).fold([0.0; 3], |u, v| if norm(v) > norm(u) { v } else { u });
        let spanned = outer
            .iter()
            .map(|&p| cross(farthest, sub(p, middle)))
            .fold([0.0; 3], |u, v| if norm(v) > norm(u) { v } else { u });
        let normal = [area, spanned].into_iter().find(|&v| norm(v) > 1e-12 * size * size).and_then(normalized);
        let normal = normal.ok_or(PolygonError::NoArea)?;
        let distance = positions().map(|&p| dot(sub(p, middle), normal).abs()).fold(0.0, f64::max);
        if distance > plane_rel * size {
            return Err(PolygonError::NotPlane { distance, size });
        }
        // The axis that the normal points along least gives the longest projection.
        let least = (0..3).fold(0, |best, a| if normal[a].abs() < normal[best].abs() { a } else { best });
        let mut along = [0.0; 3];
        along[least] = 1.0;
        let first = normalized(cross(normal, along)).ok_or(PolygonError::NoArea)?;
        Ok(Self { middle, size, normal, axes: [first, cross(normal, first)] })
    }

    /// Coordinates in the plane, in sizes of the polygon.
    fn project(&self, p: [f64; 3]) -> [f64; 2] {
        // Numbers that are all but zero would be refused by the triangulation.
        let snap = |x: f64| if x.abs() < 1e-30 { 0.0 } else { x };
        self.axes.map(|axis| snap(dot(sub(p, self.middle), axis) / self.size))
    }
}

/// A plane polygon as triangles.
pub(crate) struct Triangulated {
    pub(crate) triangles: Vec<[[f64; 3]; 3]>,
    /// Of unit length, on either side.
    pub(crate) normal: [f64; 3],
}

/// Cuts a plane polygon, its outer ring first, into triangles with corners at its positions.
pub(super) fn triangulate(rings: &[Vec<[f64; 3]>]) -> Result<Vec<[[f64; 3]; 3]>, PolygonError> {
    Ok(triangulate_polygon(rings, PLANE)?.triangles)
}

/// The same for a polygon that is plane to a share of its size, with a unit normal.
pub(crate) fn triangulate_polygon(rings: &[Vec<[f64; 3]>], plane_rel: f64) -> Result<Triangulated, PolygonError> {
    let rings: Vec<Vec<[f64; 3]>> = rings.iter().map(|ring| open_ring(ring)).collect::<Result<_, _>>()?;
    if rings.is_empty() {
        return Err(PolygonError::TooFewPositions(0));
    }
    let plane = Plane::of(&rings, plane_rel)?;
    let flat: Vec<Vec<[f64; 2]>> = rings.iter().map(|ring| ring.iter().map(|&p| plane.project(p)).collect()).collect();
    let mut mesh = ConstrainedDelaunayTriangulation::<Point2<f64>>::new();
    // The position in space of each vertex of the triangulation; positions that coincide share one.
    let mut spatial: Vec<[f64; 3]> = Vec::new();
    let mut handles = Vec::new();
    for (ring, flat) in rings.iter().zip(&flat) {
        for (&position, &[x, y]) in ring.iter().zip(flat) {
            let handle = mesh.insert(Point2::new(x, y)).map_err(|_| PolygonError::NoArea)?;
            if handle.index() == spatial.len() {
                spatial.push(position);
            }
            handles.push(handle);
        }
    }
    let mut first = 0;
    for ring in &rings {
        for i in 0..ring.len() {
            let (from, to) = (handles[first + i], handles[first + (i + 1) % ring.len()]);
            if from != to && !mesh.can_add_constraint(from, to) {
                return Err(PolygonError::Crossing);
            }
            if from != to {
                mesh.add_constraint(from, to);
            }
        }
        first += ring.len();
    }
    let triangles: Vec<_> = mesh
        .inner_faces()
        .filter(|face| {
            let middle = face.center();
            is_within([middle.x, middle.y], &flat)
        })
        .map(|face| face.vertices().map(|v| spatial[v.fix().index()]))
        .collect();
    if triangles.is_empty() { Err(PolygonError::NoArea) } else { Ok(Triangulated { triangles, normal: plane.normal }) }
}

/// Whether a position lies within an odd number of rings: a ray to the right crosses their sides an odd number of times.
fn is_within([x, y]: [f64; 2], rings: &[Vec<[f64; 2]>]) -> bool {
    let crosses =
        |[p, q]: [[f64; 2]; 2]| (p[1] > y) != (q[1] > y) && x < p[0] + (y - p[1]) / (q[1] - p[1]) * (q[0] - p[0]);
    let crossings = rings.iter().flat_map(|ring| {
        (0..ring.len()).map(move |i| [ring[i], ring[(i + 1) % ring.len()]]).filter(|&side| crosses(side))
    });
    crossings.count() % 2 == 1
}
