//! The whole of detection in one call.

use std::time::Instant;

use rayon::prelude::*;

use super::assemble::{assemble, report};
use super::params::{FeatureError, FeatureParams, FeatureReport, FeatureSeconds};
use super::planes::Flats;
use super::planes::polygons::{Borders, polygon};
use super::planes::regions::Partition;
use super::prepare::{Fitted, Resolved, Sorted};
use super::sharp::Sharp;
use super::surroundings::Surroundings;
use super::{Features, Plane};
use crate::cloud::Cloud;
use crate::monitor::{Monitor, Part, Steps, check};
use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// Shares of the whole that are done after the fit, the neighbours, the planes and the edges.
const SHARES: [f64; 4] = [0.5, 0.7, 0.85, 0.95];

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
    let mut clock = Clock::start();
    let mut seconds = FeatureSeconds::default();
    let sorted = Sorted::new(cloud);
    let fitted = Fitted::new(&sorted, params, &Part::new(monitor, 0.0..SHARES[0]))?;
    seconds.fit = clock.lap();

    monitor.stage("looking around each point");
    let points = &sorted.points;
    let tree = PointTree::new(points);
    let around = Surroundings::new(points, &tree, &Steps::new(monitor, SHARES[0]..SHARES[1], points.len()))?;
    drop(tree);
    let resolved = Resolved::new(params, &fitted, &around);
    seconds.neighbours = clock.lap();

    monitor.stage("growing flat regions");
    let mut partition = Partition::new(points, &around, resolved.limits(&fitted, params.posture));
    let flats = Flats::find(&mut partition, &fitted, &resolved, monitor)?;
    monitor.share(SHARES[2]);
    seconds.planes = clock.lap();

    monitor.stage("finding edges and corners");
    let sharp = Sharp::find(&partition, &flats, &fitted, &resolved, monitor)?;
    monitor.share(SHARES[3]);
    seconds.edges = clock.lap();

    monitor.stage("drawing polygons");
    let borders = Borders::new(flats.flats.len(), &sharp.straight, &sharp.meetings);
    let planes: Vec<Plane> =
        (0..flats.flats.len()).into_par_iter().map(|number| plane(number, points, &flats, &borders)).collect();
    check(monitor)?;
    let features = assemble(cloud, &sorted, &flats, &sharp, planes, resolved.spacing);
    seconds.polygons = clock.lap();
    seconds.total = clock.total();
    monitor.share(1.0);
    let report = report(&features, &fitted, &resolved, seconds);
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
