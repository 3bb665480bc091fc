//! What the points show the surface to be made of: planes, and the rest.

use rayon::prelude::*;
use serde::Serialize;

use super::patches::{join, patches};
use super::{PlanReport, ReconstructError};
use crate::cloud::Cloud;
use crate::constraint::Local;
use crate::feature::{Facets, FeatureError, FeatureParams, detect_with};
use crate::field::LatticeField;
use crate::fit::Frame;
use crate::fit::cascade::{Held, OrientedTriangle, PolishParams, PolishReport, Scene, polish};
use crate::model;
use crate::monitor::{Cancelled, Monitor};
use crate::vec3::Vec3;

/// Points so near a plane of the user, in cells or in deviations of the noise, whichever is more, lie on it.
const BESIDE: f64 = 0.25;
const DEVIATIONS: f64 = 3.0;

/// The planes of a surface, and which points lie on them.
pub(super) struct Found {
    facets: Facets,
    /// The plane of each point.
    plane_of: Vec<Option<u32>>,
    /// In terrain what is curved is ground and vegetation, whose creases are noise.
    curved_creases: bool,
    pub(super) report: StructureReport,
}

/// What was found before the surface was made sharp.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct StructureReport {
    /// Planes.
    pub planes: usize,
    /// Points on them.
    pub points_on_planes: usize,
    /// Root of the mean square distance of these points from their planes; `None` without any.
    pub plane_rms: Option<f64>,
}

impl Found {
    /// Finds planes with the fit that is there. `known`, in the coordinates of the cloud, adds planes of the user; `max_distance` is that of a point from its
    /// plane, where it is not to be measured here.
    pub(super) fn find(
        cloud: &Cloud,
        plan: &PlanReport,
        field: &LatticeField,
        known: &Local,
        max_distance: Option<f64>,
        monitor: &dyn Monitor,
    ) -> Result<Self, ReconstructError> {
        let params = FeatureParams { scene: Some(plan.scene), up: plan.up, max_distance, ..FeatureParams::default() };
        let (features, found) = match detect_with(cloud, (plan, field), &params, monitor) {
            Ok(found) => found,
            Err(FeatureError::Cancelled(cancelled)) => return Err(cancelled.into()),
            Err(FeatureError::Surface(error)) => return Err(error),
            Err(FeatureError::Parameter { .. }) => unreachable!("the usual parameters are possible"),
        };
        let report = StructureReport {
            planes: features.planes.len(),
            points_on_planes: found.points_on_planes,
            plane_rms: found.plane_rms,
        };
        let mut plane_of: Vec<Option<u32>> = features.points.iter().map(|point| point.plane).collect();
        let curved_creases = matches!(plan.scene, Scene::Object | Scene::Free);
        let frame = Frame::new(plan.up, plan.scene);
        let patches =
            patches(&features, known, plan.resolution, |p| Some(frame.leave(field.gradient(frame.enter(p))?)));
        let facets = Facets::with_patches(&features, &patches);
        if !patches.is_empty() {
            let reach = (DEVIATIONS * plan.noise).max(BESIDE * plan.resolution);
            join(&mut plane_of, &facets, features.planes.len() as u32, &cloud.points, reach);
        }
        Ok(Self { facets, plane_of, curved_creases, report })
    }

    /// Polishes F: points on planes give way to their planes. `known` is in the frame of the fit, and so is `reach`, a box in which F is polished
    /// even where there are no points.
    pub(super) fn polish(
        &self,
        field: &LatticeField,
        cloud: &Cloud,
        known: &Local,
        reach: Option<[Vec3; 2]>,
        (frame, params): (Frame, PolishParams),
        monitor: &dyn Monitor,
    ) -> Result<(LatticeField, PolishReport), Cancelled> {
        let loose: Vec<Vec3> = cloud
            .points
            .par_iter()
            .zip(&self.plane_of)
            .filter(|(_, plane)| plane.is_none())
            .map(|(&p, _)| frame.enter(p))
            .collect();
        let turned = |(corners, normal): ([Vec3; 3], Vec3)| OrientedTriangle {
            corners: corners.map(|corner| frame.enter(corner)),
            normal: frame.enter(normal),
        };
        let facets: Vec<OrientedTriangle> = self.facets.oriented_triangles().map(turned).collect();
        let (triangles, segments): (Vec<_>, Vec<_>) = (known.triangles().collect(), known.segments().collect());
        let held = Held { facets: &facets, triangles: &triangles, segments: &segments, reach };
        polish(field, &loose, held, params, monitor)
    }

    /// The same to be kept.
    pub(super) fn keep(self) -> (model::Structure, StructureReport) {
        let (triangles, plane_of_triangle) = self.facets.triangles();
        let kept = model::Structure {
            planes: self.facets.flats.iter().map(|flat| (flat.normal, flat.offset)).collect(),
            triangles: triangles.to_vec(),
            plane_of_triangle: plane_of_triangle.to_vec(),
            plane_of_point: self.plane_of,
            curved_creases: self.curved_creases,
        };
        (kept, self.report)
    }
}
