//! The points made ready: in an order of their own, with F fitted to them, and every default resolved.

use std::cmp::Ordering;

use rayon::prelude::*;

use super::params::{FeatureError, FeatureParams, Posture};
use super::planes::flatness::Bend;
use super::planes::regions::{LEAST_POINTS, Limits};
use super::surroundings::Surroundings;
use crate::cloud::Cloud;
use crate::domain::{block_key, bounds};
use crate::field::LatticeField;
use crate::fit::Frame;
use crate::fit::cascade::Scene;
use crate::monitor::{Cancelled, Monitor, Steps};
use crate::reconstruct::{
    AttributeChoice, Plan, PlanReport, ReconstructError, ReconstructParams, Resolution, Trim, plan,
};
use crate::spatial::PointTree;
use crate::vec3::{self, Vec3};

/// The points in an order that does not depend on the order of the cloud, each position once, near the origin.
pub(super) struct Sorted {
    pub(super) centre: Vec3,
    pub(super) points: Vec<Vec3>,
    /// For each point of the cloud its place, unless it is not finite.
    pub(super) place: Vec<Option<u32>>,
}

impl Sorted {
    pub(super) fn new(cloud: &Cloud) -> Self {
        let finite = |p: &&Vec3| vec3::is_finite(**p);
        let (low, high) = bounds(cloud.points.iter().filter(finite).copied());
        let centre = vec3::scale(vec3::add(low, high), 0.5);
        let side = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
        let scale = if side > 0.0 { f64::from((1_u32 << 20) - 1) / side } else { 0.0 };
        let mut order: Vec<(u64, u32)> = cloud
            .points
            .par_iter()
            .enumerate()
            .filter(|(_, p)| vec3::is_finite(**p))
            .map(|(i, p)| (block_key(std::array::from_fn(|a| ((p[a] - low[a]) * scale) as u32)), i as u32))
            .collect();
        let total = |a: Vec3, b: Vec3| (0..3).fold(Ordering::Equal, |o, c| o.then(a[c].total_cmp(&b[c])));
        order.par_sort_unstable_by(|a, b| {
            let by_position = || total(cloud.points[a.1 as usize], cloud.points[b.1 as usize]);
            a.0.cmp(&b.0).then_with(by_position).then(a.1.cmp(&b.1))
        });
        let mut points: Vec<Vec3> = Vec::with_capacity(order.len());
        let mut place = vec![None; cloud.len()];
        let mut last = None;
        for (_, i) in order {
            let p = cloud.points[i as usize];
            if last != Some(p) {
                points.push(vec3::sub(p, centre));
                last = Some(p);
            }
            place[i as usize] = Some(points.len() as u32 - 1);
        }
        Self { centre, points, place }
    }
}

/// F fitted to the points, for the side of a surface that is outside: a fit as for a mesh, with coarse cells.
pub(super) fn fit(
    sorted: &Sorted,
    params: &FeatureParams,
    monitor: &dyn Monitor,
) -> Result<(PlanReport, LatticeField), FeatureError> {
    let cloud = Cloud { points: sorted.points.clone(), ..Cloud::default() };
    let wanted = ReconstructParams {
        scene: params.scene,
        up: params.up,
        resolution: Resolution::Spacings { terrain: RESOLUTION_OF_TERRAIN_REL, body: RESOLUTION_REL },
        trim: Trim::Off,
        attributes: AttributeChoice::Off,
        memory: params.memory,
        ..ReconstructParams::default()
    };
    let Plan { report, prepared, .. } = plan(&cloud, &wanted, monitor)?;
    let (field, _) = prepared.fit(monitor).map_err(ReconstructError::from)?;
    Ok((report, field))
}

/// A fit that is there: what was measured for it, and F in its frame.
#[derive(Clone, Copy)]
pub(super) struct Fitted<'a> {
    pub(super) plan: &'a PlanReport,
    field: &'a LatticeField,
    frame: Frame,
    /// The origin of the positions that are asked for, in the coordinates that were fitted.
    origin: Vec3,
}

impl<'a> Fitted<'a> {
    /// `origin` is that of the positions that will be asked for, in the coordinates of the cloud that was fitted.
    pub(super) fn new(plan: &'a PlanReport, field: &'a LatticeField, origin: Vec3) -> Self {
        Self { plan, field, frame: Frame::new(plan.up, plan.scene), origin }
    }

    /// The direction out of the body at a position, not of unit length.
    pub(super) fn outward(&self, p: Vec3) -> Option<Vec3> {
        Some(self.frame.leave(self.field.gradient(self.frame.enter(vec3::add(p, self.origin)))?))
    }
}

/// Cells of the fit over the spacing. F tells the sides of planes only, so terrain takes coarse cells. For a body the finest level would then
/// be dense, which is slower than the fine ones.
const RESOLUTION_REL: f64 = 1.5;
const RESOLUTION_OF_TERRAIN_REL: f64 = 2.0;

/// Every default resolved.
pub(super) struct Resolved {
    pub(super) spacing: f64,
    /// The length at which the points tell directions; see [`grain`].
    pub(super) grain: f64,
    pub(super) noise: f64,
    pub(super) min_area: f64,
    pub(super) max_distance: f64,
    pub(super) max_angle: f64,
    pub(super) sharp_angle: f64,
}

/// Noise up to this share of the spacing leaves directions clear with [`NEIGHBOURS`](super::surroundings::NEIGHBOURS) points.
const CLEAR: f64 = 0.3;
/// Under more noise, this share of the grain is noise. With 0.3 a tenth of the creases of the test bodies are lost, with 0.2 small faces are.
const OF_GRAIN: f64 = 0.25;
/// The grain is at most so many spacings: what is smaller than the surroundings of a point is not seen.
const COARSEST: f64 = 2.0;

/// The length at which points tell directions: their spacing, or under much noise a multiple of the noise. Seen with this grain, the noise is
/// about as small as ever, so that one set of limits serves.
pub(super) fn grain(spacing: f64, noise: f64) -> f64 {
    if noise > CLEAR * spacing { (noise / OF_GRAIN).min(COARSEST * spacing) } else { spacing }
}

/// The smallest plane, in squares of the grain. With noise of half the spacing the plane of least squares through that many points is wrong by
/// 1.5 degrees.
const LEAST_GRAINS: f64 = 16.0;
/// The farthest that a point lies from its plane, in deviations of the noise.
const FARTHEST: f64 = 3.0;
/// The noise is at most so many times that of the flattest tenth of the points. Vegetation, where it is half of the points, more than
/// doubles the median over all points.
const MOST_NOISE: f64 = 3.2;
/// Noise under this share of the spacing is not believed: the surface itself is not flat to more.
const LEAST_NOISE: f64 = 0.02;
/// The largest angle between a plane and the surface around its points. Near an edge of 90 degrees the normals turn by half of it.
const MAX_ANGLE_DEG: f64 = 40.0;

/// The noise of what is flat: the noise of all points, but no more than some times that of the flattest of them.
fn noise_of_planes(plan: &PlanReport, around: &Surroundings) -> f64 {
    let flattest = around.flattest().map_or(f64::INFINITY, |noise| MOST_NOISE * noise);
    plan.noise.min(flattest).max(LEAST_NOISE * plan.spacing)
}

/// How far a point lies from its plane at most, as it is measured on a cloud. Where planes are looked for in parts of it, all of them are to use the same.
pub(crate) fn farthest_from_planes(cloud: &Cloud, plan: &PlanReport, monitor: &dyn Monitor) -> Result<f64, Cancelled> {
    let sorted = Sorted::new(cloud);
    let tree = PointTree::new(&sorted.points);
    let steps = Steps::new(monitor, 0.0..1.0, sorted.points.len());
    let around = Surroundings::new(&sorted.points, &tree, grain(plan.spacing, plan.noise) / plan.spacing, &steps)?;
    Ok(FARTHEST * noise_of_planes(plan, &around))
}

impl Resolved {
    pub(super) fn new(params: &FeatureParams, fitted: &Fitted<'_>, around: &Surroundings) -> Self {
        let spacing = fitted.plan.spacing;
        let noise = noise_of_planes(fitted.plan, around);
        let grain = grain(spacing, fitted.plan.noise);
        Self {
            spacing,
            grain,
            noise: params.max_distance.map_or(noise, |distance| distance / FARTHEST),
            min_area: params.min_area.unwrap_or(LEAST_GRAINS * grain * grain),
            max_distance: params.max_distance.unwrap_or(FARTHEST * noise),
            max_angle: params.max_angle.unwrap_or(MAX_ANGLE_DEG.to_radians()),
            sharp_angle: params.sharp_angle,
        }
    }

    pub(super) fn limits(&self, fitted: &Fitted<'_>, posture: Posture) -> Limits {
        let is_terrain = matches!(fitted.plan.scene, Scene::Terrain | Scene::Airborne);
        let stands = posture == Posture::Upright && is_terrain;
        Limits {
            noise: self.noise,
            distance: self.max_distance,
            cosine: self.max_angle.cos(),
            least: LEAST_POINTS,
            bend: if is_terrain { Bend::OF_TERRAIN } else { Bend::OF_BODIES },
            up: stands.then(|| fitted.plan.up.restore([0.0, 0.0, 1.0])),
        }
    }
}
