//! Fewer triangles for the same surface.
//!
//! # What
//! Edges are collapsed to points, the cheapest first, until a number of triangles or an error is reached. Planes come down to the
//! triangles that their outlines need; creases, corners and borders stay where they are, within the error.
//!
//! # Formula
//! Each vertex carries Q(x) = sum w (n . (x - p))^2 over planes: of the triangles that it stands for, w a third of their area; and
//! of the creases and borders that it stands for, upright on their triangles, w in proportion to the squared length of the edge. A
//! collapse adds the two sums and costs their value at the new vertex. The vertex is put where Q is least. Directions whose
//! eigenvalue is below a thousandth of the largest are left open, and there it keeps to the middle of the edge, or to the end that
//! lies on a crease: on a plane it stays in the plane, on a crease on the crease, at a corner in the corner.
//!
//! An edge is a crease where the normals on both sides, smoothed over neighbours that look alike, differ by more than
//! [`SimplifyParams::sharp_angle`]. Creases only add planes to Q and forbid nothing, so one that noise made costs little.
//!
//! A collapse is refused if
//! - the surface would be no manifold, or of another shape: the link condition;
//! - a triangle would turn by more than 75 degrees, or become a needle;
//! - a triangle would meet another one anywhere but in common corners and edges, by exact predicates, against all triangles near it;
//! - a point of the original would be farther than a bound from the triangles that replace its own, or the new vertex and its edges
//!   farther than that from the original. The points are the vertices, and a grid on triangles whose edges are long against the
//!   bound.
//!
//! For a largest error the bound is a tenth smaller than it. For a number of triangles it grows by halves, from what suits a
//! surface of moderate curvature, until they are reached: the sum Q alone holds the noise of a wide plane dearer than a small
//! house, as it looks at planes far from where they were measured.
//!
//! Both surfaces are then held against each other, at their vertices and at 100,000 to 1,000,000 samples each. If that finds a
//! distance over the largest error, the work is done again: with more points and with the middles of new triangles held against
//! the original, too; then with smaller bounds. In the end the original is returned.
//!
//! # Cost
//! O(F log F), on one thread but for the measurement. A million triangles take about a minute on a shared core.
//!
//! # Guaranteed
//! - The result follows from the mesh and the parameters alone, bit for bit, on any number of threads.
//! - A manifold stays one, with the same components, genus and number of borders. Where the input is no manifold it stays as it is.
//! - No two triangles of the result meet that did not before. Where the input cuts through itself, nothing there is changed.
//! - [`SimplifyReport::deviation`] is measured, and its maximum is at most [`SimplifyParams::max_error`].
//! - Vertices on exact planes and creases stay on them but for rounding.
//!
//! # Not guaranteed
//! - The least number of triangles. That with this error is hard to find; this is a good one.
//! - The number of triangles asked for: fewer by one is possible, and more where nothing more may be collapsed, as on a tetrahedron.
//! - The bound between samples.
//! - Vertices that no triangle uses, and triangles that repeat a vertex, are dropped.
//! - A mesh whose triangles share no vertices has nothing to collapse.
//!
//! # Held vertices
//! [`simplify_held`] keeps some vertices where they are, bit for bit, with their values and the edges between them: meshes that share these go on sharing them.
//! Edges that end at one are not collapsed.
//!
//! # Attributes
//! Each vertex of the result gets the values of the place on the original that is nearest to it: colours and intensities
//! interpolated in the triangle there, the class of its weightiest corner.
//!
//! # Source
//! Garland and Heckbert, Surface Simplification Using Quadric Error Metrics, 1997. Link condition: Dey, Edelsbrunner, Guha and
//! Nekhayev, Topology Preserving Edge Contraction, 1999. Points that hold the error: after Cohen and others, Simplification Envelopes,
//! 1996, who bound it by offset surfaces. Ours: quadrics around their own vertex, so that planes lose no digits; the exact test
//! against all triangles near; the measured bound.
//!
//! ```
//! use zeroset::mesh::{SimplifyParams, simplify};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let sphere = Scene::new(SceneKind::Sphere, 0).truth;
//! let params = SimplifyParams { max_error: Some(0.01), ..SimplifyParams::default() };
//! let (light, report) = simplify(&sphere, &params, &())?;
//! assert!(light.triangles.len() < 600 && report.deviation.max() <= 0.01);
//! # Ok::<(), zeroset::mesh::SimplifyError>(())
//! ```

mod collapse;
mod cover;
mod deviation;
mod features;
mod surface;

use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::edges::Edges;
use super::{Mesh, MeshError, SHARP_ANGLE};
use crate::monitor::{Cancelled, Monitor, Part};
use crate::spatial::TriangleTree;
use collapse::Collapser;
use cover::{Cover, Tolerance};
pub use deviation::Deviation;
use features::Features;
use surface::Surface;

/// When to stop: at the number of triangles or at the error, whichever comes first. One of them must be given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimplifyParams {
    /// The number of triangles wanted; `None`: as few as the error allows.
    pub triangles: Option<usize>,
    /// The largest distance between the original and the simplified surface, either way, in the mesh's unit; `None`: no bound.
    pub max_error: Option<f64>,
    /// The angle, in radians, from which an edge is a crease.
    pub sharp_angle: f64,
}

impl Default for SimplifyParams {
    /// Creases from [`SHARP_ANGLE`], and nothing wanted yet.
    fn default() -> Self {
        Self { triangles: None, max_error: None, sharp_angle: SHARP_ANGLE }
    }
}

/// Why a mesh was not simplified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SimplifyError {
    /// Neither a number nor an error to stop at.
    #[error("nothing says how far to simplify; give a number of triangles or a largest error")]
    NoTarget,
    /// A parameter that is zero, negative or not finite.
    #[error("{name} is {value}; it must be positive")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A mesh without triangles, or whose triangles have no area.
    #[error("there is no surface ({faces} triangles, no area): nothing to simplify")]
    NoSurface {
        /// Number of its triangles.
        faces: usize,
    },
    /// A mesh that can't be examined.
    #[error(transparent)]
    Broken(#[from] MeshError),
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What [`simplify`] did.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SimplifyReport {
    /// The number of triangles wanted.
    pub wanted_triangles: Option<usize>,
    /// The largest error allowed.
    pub max_error: Option<f64>,
    /// Triangles of the original.
    pub triangles_before: usize,
    /// Triangles of the simplified mesh.
    pub triangles_after: usize,
    /// Vertices of the original.
    pub vertices_before: usize,
    /// Vertices of the simplified mesh.
    pub vertices_after: usize,
    /// How far the two are apart, measured.
    pub deviation: Deviation,
    /// Times that the simplification was done: more than once if the measured error was over the bound.
    pub attempts: u32,
    /// Wall seconds.
    pub seconds: f64,
}

/// Attempts to keep the bound before the original is given back.
const MOST_ATTEMPTS: u32 = 4;
/// The share of an attempt after which the edges are collapsed, and only the measurement is left.
const COLLAPSED: f64 = 0.8;

/// Simplifies a mesh.
///
/// # Errors
/// [`SimplifyError`] if nothing says how far, a parameter makes no sense, the mesh is broken or has no surface, or the monitor
/// asks to stop.
pub fn simplify(
    mesh: &Mesh,
    params: &SimplifyParams,
    monitor: &dyn Monitor,
) -> Result<(Mesh, SimplifyReport), SimplifyError> {
    simplify_held(mesh, &[], params, monitor).map(|(mesh, _, report)| (mesh, report))
}

/// Simplifies a mesh around vertices that stay, and tells their numbers in the result, in the order in which they were given; `None` for those without a triangle.
///
/// # Errors
/// As for [`simplify`].
pub fn simplify_held(
    mesh: &Mesh,
    held: &[u32],
    params: &SimplifyParams,
    monitor: &dyn Monitor,
) -> Result<(Mesh, Vec<Option<u32>>, SimplifyReport), SimplifyError> {
    let start = Instant::now();
    params.check()?;
    monitor.stage("simplifying the mesh");
    let original = Original { mesh, held, edges: Edges::new(mesh)?, tree: TriangleTree::new(mesh) };
    let Simplified { mut mesh, number, deviation, attempts } = original.simplified(params, monitor)?;
    mesh.attributes = deviation::carried(original.mesh, &original.tree, &mesh.vertices);
    let held: Vec<Option<u32>> = held.iter().map(|&v| *number.get(v as usize)?).collect();
    original.keep_values(&held, &mut mesh);
    mesh.world_from_local = original.mesh.world_from_local;
    mesh.crs.clone_from(&original.mesh.crs);
    monitor.share(1.0);
    let report = SimplifyReport {
        wanted_triangles: params.triangles,
        max_error: params.max_error,
        triangles_before: original.mesh.triangles.len(),
        triangles_after: mesh.triangles.len(),
        vertices_before: original.mesh.vertices.len(),
        vertices_after: mesh.vertices.len(),
        deviation,
        attempts,
        seconds: start.elapsed().as_secs_f64(),
    };
    Ok((mesh, held, report))
}

impl SimplifyParams {
    /// Whether the parameters make sense.
    pub(crate) fn check(&self) -> Result<(), SimplifyError> {
        if self.triangles.is_none() && self.max_error.is_none() {
            return Err(SimplifyError::NoTarget);
        }
        let given = [
            ("the number of triangles", self.triangles.map(|n| n as f64)),
            ("the largest error", self.max_error),
            ("the sharp angle", Some(self.sharp_angle)),
        ];
        let mut given = given.into_iter().filter_map(|(name, value)| Some((name, value?)));
        let wrong = given.find(|(_, value)| !(*value > 0.0 && value.is_finite()));
        wrong.map_or(Ok(()), |(name, value)| Err(SimplifyError::Parameter { name, value }))
    }
}

/// A mesh with what finds its edges and places.
struct Original<'a> {
    mesh: &'a Mesh,
    held: &'a [u32],
    edges: Edges<'a>,
    tree: TriangleTree,
}

/// What came of it.
struct Simplified {
    mesh: Mesh,
    /// The number of each vertex of the original that is left.
    number: Vec<Option<u32>>,
    deviation: Deviation,
    attempts: u32,
}

impl Original<'_> {
    /// Tries until the measured error keeps the bound.
    fn simplified(&self, params: &SimplifyParams, monitor: &dyn Monitor) -> Result<Simplified, SimplifyError> {
        let surface = Surface::new(self.mesh, &self.edges, self.held);
        let mut tolerance = Tolerance::new(&surface, params.triangles, params.max_error);
        for attempt in 1..=MOST_ATTEMPTS {
            // The first gets most of the whole, and each of the others most of what is left.
            let [before, after] = [attempt - 1, attempt].map(|n| 1.0 - 0.1_f64.powi(n as i32));
            let part = Part::new(monitor, before..after);
            let cover = Cover::new(&surface, &self.tree, tolerance);
            let features = Features::new(self.mesh, &self.edges, params.sharp_angle);
            let collapser = Collapser::new(surface.clone(), features, cover);
            let collapsed = collapser.run(params.triangles.unwrap_or(0), &Part::new(&part, 0.0..COLLAPSED))?;
            let (mesh, number) = collapsed.to_mesh();
            let deviation = self.deviation(&mesh, &Part::new(&part, COLLAPSED..1.0))?;
            match params.max_error {
                Some(max) if deviation.max() > max => tolerance.tighten(max, deviation.max()),
                _ => return Ok(Simplified { mesh, number, deviation, attempts: attempt }),
            }
        }
        let Mesh { vertices, triangles, .. } = self.mesh;
        let mesh = Mesh { vertices: vertices.clone(), triangles: triangles.clone(), ..Mesh::default() };
        let deviation = self.deviation(&mesh, &())?;
        let number = (0..mesh.vertices.len() as u32).map(Some).collect();
        Ok(Simplified { mesh, number, deviation, attempts: MOST_ATTEMPTS })
    }

    /// Gives the held vertices the values they had: those found at their place may differ by a rounding.
    fn keep_values(&self, held: &[Option<u32>], mesh: &mut Mesh) {
        fn keep<T: Copy>(from: Option<&Vec<T>>, to: Option<&mut Vec<T>>, (old, new): (u32, u32)) {
            if let (Some(from), Some(to)) = (from, to) {
                to[new as usize] = from[old as usize];
            }
        }
        let (from, to) = (&self.mesh.attributes, &mut mesh.attributes);
        for pair in self.held.iter().zip(held).filter_map(|(&old, new)| Some((old, (*new)?))) {
            keep(from.colors.as_ref(), to.colors.as_mut(), pair);
            keep(from.intensities.as_ref(), to.intensities.as_mut(), pair);
            keep(from.classes.as_ref(), to.classes.as_mut(), pair);
        }
    }

    fn deviation(&self, simplified: &Mesh, monitor: &dyn Monitor) -> Result<Deviation, SimplifyError> {
        let measured = Deviation::between((self.mesh, &self.tree), simplified, monitor)?;
        measured.ok_or(SimplifyError::NoSurface { faces: self.mesh.triangles.len() })
    }
}
