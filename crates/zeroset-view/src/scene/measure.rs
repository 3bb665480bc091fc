//! What the colours of a layer can tell: values for each of its positions.

use rayon::prelude::*;
use zeroset::cloud::{Cloud, surface_variation};
use zeroset::feature::{Features, triangulate};
use zeroset::mesh::{Mesh, MeshError, mean_curvature};
use zeroset::reconstruct::Up;
use zeroset::spatial::{PointTree, TriangleTree};

use crate::vector::{self, Vec3};

/// Points around each by which variation is measured.
const NEIGHBOURS: usize = 24;
/// A point belongs to a plane within so many times the root of the mean square of the plane's own points.
const ON_PLANE_REL: f64 = 3.0;

/// Heights in world coordinates.
#[must_use]
pub fn heights(positions: &[[f64; 3]], world_from_local: [f64; 3], up: Up) -> Vec<Option<f64>> {
    positions.iter().map(|&p| Some(up.upright(vector::add(p, world_from_local))[2])).collect()
}

/// The mean curvature at the vertices of a mesh: see [`mean_curvature`].
///
/// # Errors
/// If the mesh is not sound.
pub fn curvatures(mesh: &Mesh) -> Result<Vec<Option<f64>>, MeshError> {
    mean_curvature(mesh)
}

/// The surface variation of the points of a cloud, among 24 of them: see [`surface_variation`].
#[must_use]
pub fn variations(cloud: &Cloud) -> Vec<Option<f64>> {
    surface_variation(cloud, &PointTree::new(&cloud.points), NEIGHBOURS)
}

/// What distances are measured to.
#[derive(Debug)]
pub enum Reference {
    /// A surface.
    Surface {
        /// Offset of the mesh.
        world_from_local: [f64; 3],
        /// Its triangles.
        tree: TriangleTree,
    },
    /// Points.
    Points {
        /// Offset of the cloud.
        world_from_local: [f64; 3],
        /// Its points.
        tree: PointTree,
    },
}

impl Reference {
    /// The surface of a mesh.
    #[must_use]
    pub fn surface(mesh: &Mesh) -> Self {
        Self::Surface { world_from_local: mesh.world_from_local, tree: TriangleTree::new(mesh) }
    }

    /// The points of a cloud.
    #[must_use]
    pub fn points(cloud: &Cloud) -> Self {
        Self::Points { world_from_local: cloud.world_from_local, tree: PointTree::new(&cloud.points) }
    }

    fn distance(&self, world: Vec3) -> Option<f64> {
        match self {
            Self::Surface { world_from_local, tree } => {
                Some(tree.closest(vector::sub(world, *world_from_local))?.distance_squared.sqrt())
            }
            Self::Points { world_from_local, tree } => {
                Some(tree.nearest(vector::sub(world, *world_from_local))?.distance_squared.sqrt())
            }
        }
    }
}

/// Distances to something else.
#[must_use]
pub fn distances(positions: &[[f64; 3]], world_from_local: [f64; 3], to: &Reference) -> Vec<Option<f64>> {
    positions.par_iter().map(|&p| to.distance(vector::add(p, world_from_local))).collect()
}

/// The plane on which each position lies: the nearest, if it is no farther than its own points mostly are.
#[must_use]
pub fn plane_of_points(positions: &[[f64; 3]], world_from_local: [f64; 3], features: &Features) -> Vec<Option<usize>> {
    let (mut mesh, mut plane_of) = (Mesh::default(), Vec::new());
    for (i, plane) in features.planes.iter().enumerate() {
        let first = mesh.vertices.len();
        mesh.vertices.extend(plane.rings.iter().flatten());
        mesh.triangles.extend(triangulate(plane).into_iter().map(|corners| corners.map(|c| (first + c) as u32)));
        plane_of.resize(mesh.triangles.len(), i);
    }
    let tree = TriangleTree::new(&mesh);
    let step = vector::sub(world_from_local, features.world_from_local);
    let of = |&p: &Vec3| {
        let closest = tree.closest(vector::add(p, step))?;
        let plane = plane_of[closest.triangle];
        let most = ON_PLANE_REL * features.planes[plane].rms?;
        (closest.distance_squared <= most * most).then_some(plane)
    };
    positions.par_iter().map(of).collect()
}
