//! What is drawn: layers of points, surfaces and lines.

mod measure;

pub use measure::{Reference, curvatures, distances, heights, plane_of_points, variations};

use zeroset::cloud::Cloud;
use zeroset::feature::{Features, triangulate};
use zeroset::mesh::Mesh;

use crate::color::{Legend, PLAIN_CORNER, PLAIN_EDGE, Rgb, plane_color};
use crate::vector::{self, Vec3};

/// Everything in a picture.
#[derive(Debug, Clone, Default)]
pub struct Scene {
    /// Of what lies in one place, the first layer is seen.
    pub layers: Vec<Layer>,
    /// What the colours stand for.
    pub legend: Option<Legend>,
}

/// One thing that is drawn.
#[derive(Debug, Clone)]
pub struct Layer {
    /// What to add to a position for the world's, in the unit of the file.
    pub world_from_local: [f64; 3],
    /// Local positions.
    pub positions: Vec<[f64; 3]>,
    /// What lies at them.
    pub shape: Shape,
    /// Colours.
    pub paint: Paint,
    /// Whether it is seen through what lies a little before it: a 500th of the diagonal of the scene. For lines that lie on a surface.
    pub lifted: bool,
}

/// What lies at the positions of a layer.
#[derive(Debug, Clone)]
pub enum Shape {
    /// A disc at each.
    Points {
        /// Its diameter in pixels; `None`: so that points of an even cloud about cover the picture.
        diameter: Option<f32>,
    },
    /// Triangles, counter-clockwise from outside.
    Surface {
        /// Three positions each.
        triangles: Vec<[u32; 3]>,
    },
    /// Straight lines.
    Lines {
        /// Two positions each.
        segments: Vec<[u32; 2]>,
        /// Their width in pixels.
        width: f32,
    },
}

impl Shape {
    /// Points, triangles or segments, at so many positions.
    #[must_use]
    pub fn count(&self, positions: usize) -> usize {
        match self {
            Self::Points { .. } => positions,
            Self::Surface { triangles } => triangles.len(),
            Self::Lines { segments, .. } => segments.len(),
        }
    }
}

/// The colours of a layer.
#[derive(Debug, Clone)]
pub enum Paint {
    /// One for all.
    Plain(Rgb),
    /// One for each position.
    Each(Vec<Rgb>),
}

/// Pixels across the lines and corners of features.
const LINE_WIDTH: f32 = 2.0;
const CORNER_DIAMETER: f32 = 7.0;

impl Layer {
    /// The points of a cloud.
    #[must_use]
    pub fn points(cloud: Cloud, paint: Paint, diameter: Option<f32>) -> Self {
        let Cloud { world_from_local, points, .. } = cloud;
        Self { world_from_local, positions: points, shape: Shape::Points { diameter }, paint, lifted: false }
    }

    /// A mesh.
    #[must_use]
    pub fn surface(mesh: Mesh, paint: Paint) -> Self {
        let Mesh { world_from_local, vertices, triangles, .. } = mesh;
        Self { world_from_local, positions: vertices, shape: Shape::Surface { triangles }, paint, lifted: false }
    }

    /// The planes of features as surfaces, each in a colour of its own. `None` without planes.
    #[must_use]
    pub fn planes(features: &Features) -> Option<Self> {
        let (mut positions, mut triangles, mut colors) = (Vec::new(), Vec::new(), Vec::new());
        for (i, plane) in features.planes.iter().enumerate() {
            let first = positions.len();
            positions.extend(plane.rings.iter().flatten());
            colors.resize(positions.len(), plane_color(i));
            triangles.extend(triangulate(plane).into_iter().map(|corners| corners.map(|c| (first + c) as u32)));
        }
        let layer = Self {
            world_from_local: features.world_from_local,
            positions,
            shape: Shape::Surface { triangles },
            paint: Paint::Each(colors),
            lifted: false,
        };
        (!layer.is_empty()).then_some(layer)
    }

    /// The edges and the corners of features, lifted over the surface that they lie on; nothing for what there is none of.
    #[must_use]
    pub fn edges_and_corners(features: &Features) -> Vec<Self> {
        let world_from_local = features.world_from_local;
        let corners = Self {
            world_from_local,
            positions: features.corners.iter().map(|corner| corner.position).collect(),
            shape: Shape::Points { diameter: Some(CORNER_DIAMETER) },
            paint: Paint::Plain(PLAIN_CORNER),
            lifted: true,
        };
        let (mut positions, mut segments) = (Vec::new(), Vec::new());
        for edge in &features.edges {
            let first = positions.len() as u32;
            positions.extend_from_slice(&edge.polyline);
            segments.extend((first + 1..positions.len() as u32).map(|end| [end - 1, end]));
        }
        let edges = Self {
            world_from_local,
            positions,
            shape: Shape::Lines { segments, width: LINE_WIDTH },
            paint: Paint::Plain(PLAIN_EDGE),
            lifted: true,
        };
        [corners, edges].into_iter().filter(|layer| !layer.is_empty()).collect()
    }

    /// Things to draw: points, triangles or segments.
    #[must_use]
    pub fn count(&self) -> usize {
        self.shape.count(self.positions.len())
    }

    /// Whether it names positions that it has, and has as many colours.
    pub(crate) fn check(&self) -> Result<(), ()> {
        let n = self.positions.len();
        let is_there = |v: &u32| (*v as usize) < n;
        let named = match &self.shape {
            Shape::Points { .. } => true,
            Shape::Surface { triangles } => triangles.iter().flatten().all(is_there),
            Shape::Lines { segments, .. } => segments.iter().flatten().all(is_there),
        };
        let painted = match &self.paint {
            Paint::Plain(_) => true,
            Paint::Each(colors) => colors.len() == n,
        };
        if named && painted { Ok(()) } else { Err(()) }
    }

    /// Whether there is nothing to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.count() == 0
    }
}

impl Scene {
    /// Lowest and highest corner of all positions in world coordinates; `None` without finite ones.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let mut bounds: Option<[Vec3; 2]> = None;
        for layer in self.layers.iter().filter(|layer| !layer.is_empty()) {
            for p in layer.positions.iter().filter(|p| p.iter().all(|c| c.is_finite())) {
                let p = vector::add(*p, layer.world_from_local);
                let [low, high] = bounds.get_or_insert([p; 2]);
                for a in 0..3 {
                    (low[a], high[a]) = (low[a].min(p[a]), high[a].max(p[a]));
                }
            }
        }
        bounds
    }
}
