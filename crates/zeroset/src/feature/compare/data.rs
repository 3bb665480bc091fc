//! Where a cloud has points of the truth.

use rayon::prelude::*;

use super::CompareFeaturesError;
use super::truth::{Creases, TrueCorner, Truth, angle_between};
use crate::cloud::{Cloud, Spacing};
use crate::mesh::Crease;
use crate::monitor::{Monitor, Steps};
use crate::spatial::{PointTree, TriangleTree};
use crate::vec3::{self, Vec3};

/// Points that are searched between two looks at the monitor.
const CHUNK: usize = 1 << 12;
/// Points this many spacings from a crease are beside it.
const REACH: f64 = 4.0;
/// Points that a side of a crease needs.
const POINTS_A_SIDE: usize = 2;

/// A cloud, held against the truth.
pub(super) struct Data {
    pub(super) spacing: f64,
    /// Number of points of each true face.
    pub(super) points_of_face: Vec<usize>,
    tree: PointTree,
    /// The normal of the triangle that each point belongs to.
    normals: Vec<Option<Vec3>>,
}

impl Data {
    /// `shift` leads from the cloud's local frame to the truth's.
    pub(super) fn new(
        cloud: &Cloud,
        shift: Vec3,
        truth: &Truth,
        monitor: &dyn Monitor,
    ) -> Result<Self, CompareFeaturesError> {
        let points: Vec<Vec3> = cloud.points.par_iter().map(|p| vec3::add(*p, shift)).collect();
        let tree = PointTree::new(&points);
        let spacing = Spacing::with_tree(&Cloud { points: points.clone(), ..Cloud::default() }, &tree);
        let spacing = spacing.ok_or(CompareFeaturesError::NoPoints { points: points.len() })?.median;
        let triangles = TriangleTree::new(&truth.mesh);
        let steps = Steps::new(monitor, 0.15..0.5, points.len());
        let nearest = points.par_chunks(CHUNK).map(|chunk| {
            steps.advance(chunk.len())?;
            Ok(chunk.iter().map(|p| Some(triangles.closest(*p)?.triangle)).collect::<Vec<_>>())
        });
        let nearest = nearest.collect::<Result<Vec<_>, CompareFeaturesError>>()?.concat();
        let mut points_of_face = vec![0; truth.faces.len()];
        for face in nearest.iter().filter_map(|t| truth.face_of[(*t)?]) {
            points_of_face[face] += 1;
        }
        let normals = nearest.iter().map(|t| truth.normals[(*t)?]).collect();
        Ok(Self { spacing, points_of_face, tree, normals })
    }

    /// Whether there are points on both sides of a crease, at a position on it.
    pub(super) fn beside(&self, crease: &Crease, position: Vec3) -> bool {
        let radius = REACH * self.spacing;
        let Some(sides) = crease.sides else {
            return self.tree.count_within(position, radius) >= 2 * POINTS_A_SIDE;
        };
        let mut counts = [0, 0];
        self.tree.visit_within(position, radius, |point| {
            let Some(normal) = self.normals[point] else {
                return;
            };
            let angles = sides.normals.map(|side| angle_between(normal, side));
            let nearer = usize::from(angles[1] < angles[0]);
            if angles[nearer] <= 0.5 * sides.angle {
                counts[nearer] += 1;
            }
        });
        counts.into_iter().all(|count| count >= POINTS_A_SIDE)
    }

    /// Whether there are points on both sides of each crease of a corner, close to it.
    pub(super) fn around(&self, corner: &TrueCorner, creases: &Creases) -> bool {
        corner.creases.iter().all(|&i| {
            let [low, high] = creases.segments[i];
            let far = if creases.edges[i].vertices[0] == corner.vertex { high } else { low };
            // Half the reach from the corner, or the middle of a short crease.
            let along = (0.5 * REACH * self.spacing / vec3::distance(corner.position, far)).min(0.5);
            self.beside(&creases.edges[i], vec3::lerp(corner.position, far, along))
        })
    }
}
