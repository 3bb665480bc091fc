//! The whole of detection in one call.

use std::time::Instant;

use rayon::prelude::*;

use super::assemble::{assemble, report};
use super::params::{FeatureError, FeatureParams, FeatureReport, FeatureSeconds};
use super::planes::Flats;
use super::planes::polygons::{Borders, polygon};
use super::planes::regions::Partition;
use super::prepare::{Fitted, Resolved, Sorted, fit, grain};
use super::sharp::Sharp;
use super::surroundings::Surroundings;
use super::{Features, Plane};
use crate::cloud::Cloud;
use crate::field::LatticeField;
use crate::monitor::{Monitor, Part, Steps, check};
use crate::reconstruct::PlanReport;
use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// The share of the whole that the fit takes.
const FIT: f64 = 0.5;
/// Shares of the rest that are done after the neighbours, the planes and the edges.
const SHARES: [f64; 3] = [0.4, 0.7, 0.9];

/// Finds planes, edges and corners.
///
/// Points that are not finite are passed over. Equal positions count once.
///
/// # Errors
/// [`FeatureError`] if the points bear no surface, a parameter makes no sense, or the monitor asks to stop.
pub fn detect(
    cloud: &Cloud,
    params: &FeatureParams,
    monitor: &dyn Monitor,
) -> Result<(Features, FeatureReport), FeatureError> {
    params.check()?;
    let clock = Clock::start();
    let sorted = Sorted::new(cloud);
    let (plan, field) = fit(&sorted, params, &Part::new(monitor, 0.0..FIT))?;
    let seconds = clock.total();
    let fitted = Fitted::new(&plan, &field, [0.0; 3]);
    let (features, mut report) = find(cloud, &sorted, &fitted, params, &Part::new(monitor, FIT..1.0))?;
    report.seconds.fit = seconds;
    report.seconds.total += seconds;
    Ok((features, report))
}

/// The same with a fit that is there already: `field` is F in the frame of the plan, fitted to the cloud in its own coordinates.
///
/// The scene, which way is up and the memory are those of the plan. The seconds of the fit are zero.
///
/// # Errors
/// [`FeatureError`] if a parameter makes no sense, or the monitor asks to stop.
pub(crate) fn detect_with(
    cloud: &Cloud,
    (plan, field): (&PlanReport, &LatticeField),
    params: &FeatureParams,
    monitor: &dyn Monitor,
) -> Result<(Features, FeatureReport), FeatureError> {
    params.check()?;
    let sorted = Sorted::new(cloud);
    let fitted = Fitted::new(plan, field, sorted.centre);
    find(cloud, &sorted, &fitted, params, monitor)
}

/// Everything after the fit.
fn find(
    cloud: &Cloud,
    sorted: &Sorted,
    fitted: &Fitted<'_>,
    params: &FeatureParams,
    monitor: &dyn Monitor,
) -> Result<(Features, FeatureReport), FeatureError> {
    let mut clock = Clock::start();
    let mut seconds = FeatureSeconds::default();
    monitor.stage("looking around each point");
    let points = &sorted.points;
    let tree = PointTree::new(points);
    let grain_rel = grain(fitted.plan.spacing, fitted.plan.noise) / fitted.plan.spacing;
    let around = Surroundings::new(points, &tree, grain_rel, &Steps::new(monitor, 0.0..SHARES[0], points.len()))?;
    drop(tree);
    let resolved = Resolved::new(params, fitted, &around);
    seconds.neighbours = clock.lap();

    monitor.stage("growing flat regions");
    let mut partition = Partition::new(points, &around, resolved.limits(fitted, params.posture));
    let flats = Flats::find(&mut partition, fitted, &resolved, monitor)?;
    monitor.share(SHARES[1]);
    seconds.planes = clock.lap();

    monitor.stage("finding edges and corners");
    let sharp = Sharp::find(&partition, &flats, fitted, &resolved, monitor)?;
    monitor.share(SHARES[2]);
    seconds.edges = clock.lap();

    monitor.stage("drawing polygons");
    let borders = Borders::new(flats.flats.len(), &sharp.straight, &sharp.meetings);
    let planes: Vec<Plane> =
        (0..flats.flats.len()).into_par_iter().map(|number| plane(number, points, &flats, &borders)).collect();
    check(monitor)?;
    let features = assemble(cloud, sorted, &flats, &sharp, planes, resolved.spacing);
    seconds.polygons = clock.lap();
    seconds.total = clock.total();
    monitor.share(1.0);
    let report = report(&features, fitted, &resolved, seconds);
    Ok((features, report))
}

/// Measures the stages.
struct Clock {
    start: Instant,
    last: Instant,
}

impl Clock {
    fn start() -> Self {
        let now = Instant::now();
        Self { start: now, last: now }
    }

    /// Seconds since the last lap.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = (now - self.last).as_secs_f64();
        self.last = now;
        seconds
    }

    fn total(&self) -> f64 {
        self.start.elapsed().as_secs_f64()
    }
}

/// A plane with its figures and its polygon.
fn plane(number: usize, points: &[Vec3], flats: &Flats, borders: &Borders<'_>) -> Plane {
    let flat = &flats.flats[number];
    let own: Vec<Vec3> = flats.members[number].iter().map(|&i| points[i as usize]).collect();
    let (rings, area) = match flats.wall(number) {
        Some(wall) => (vec![wall.ring.clone()], wall.area()),
        None => polygon(number, flat, &own, flats.spacings[number], borders),
    };
    let squares = own.iter().map(|&p| flat.distance(p).powi(2)).sum::<f64>();
    Plane {
        normal: flat.normal,
        offset: flat.offset,
        oriented: flat.oriented,
        points: own.len(),
        rms: (!own.is_empty()).then(|| (squares / own.len() as f64).sqrt()),
        area,
        rings,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::FeatureKind;
    use crate::reconstruct::{Plan, ReconstructParams, plan};
    use crate::sample::{Scene, SceneKind};

    #[test]
    fn a_fit_that_is_there_serves() {
        // Far from the origin and out of order, where positions that were sorted differ from those that were fitted.
        let mut cloud = Scene::new(SceneKind::Box, 0).points(20_000, 0.001, 0);
        cloud.points.iter_mut().for_each(|p| *p = crate::vec3::add(*p, [30.0, -20.0, 10.0]));
        let (features, report) = {
            let Plan { report, prepared, .. } = plan(&cloud, &ReconstructParams::default(), &()).expect("a surface");
            let (field, _) = prepared.fit(&()).expect("a surface");
            detect_with(&cloud, (&report, &field), &FeatureParams::default(), &()).expect("features")
        };
        assert_eq!((features.planes.len(), features.edges.len(), features.corners.len()), (6, 12, 8));
        assert!(features.planes.iter().all(|plane| plane.oriented));
        assert!(features.edges.iter().all(|edge| edge.kind == FeatureKind::Convex));
        assert_eq!(report.seconds.fit, 0.0);
    }
}
