//! All edges and corners of a cloud.

pub(in crate::feature) mod corners;
mod creases;
mod joints;
pub(in crate::feature) mod straight;
pub(in crate::feature) mod support;

use self::corners::{Meeting, ON_PLANE, SNAP, corners};
use self::creases::{Crease, CreaseSearch, creases};
use self::joints::Joints;
use self::straight::{EdgeLimits, StraightEdge, straight_edges};
use self::support::Support;
use crate::feature::params::FeatureError;
use crate::feature::planes::Flats;
use crate::feature::planes::regions::Partition;
use crate::feature::prepare::{Fitted, Resolved};
use crate::monitor::{Monitor, check};
use crate::vec3::Vec3;

/// How far data may lie from the line of an edge, over the spacing.
const REACH: f64 = 2.5;

/// Points around a place that show a crease, if the grain is the spacing.
const AROUND: f64 = 48.0;

/// The edges and where they meet. Straight edges are numbered first, then creases.
pub(in crate::feature) struct Sharp {
    /// Where two planes meet.
    pub(in crate::feature) straight: Vec<StraightEdge>,
    /// Where at least one side is curved.
    pub(in crate::feature) creases: Vec<Crease>,
    /// Corners.
    pub(in crate::feature) meetings: Vec<Meeting>,
}

impl Sharp {
    pub(in crate::feature) fn find(
        partition: &Partition<'_>,
        flats: &Flats,
        fitted: &Fitted<'_>,
        resolved: &Resolved,
        monitor: &dyn Monitor,
    ) -> Result<Self, FeatureError> {
        let (spacing, grain, noise, angle) = (resolved.spacing, resolved.grain, resolved.noise, resolved.sharp_angle);
        let (points, labels) = flats.bearing(partition.points, spacing);
        let support = Support::new(&points, &labels, REACH * spacing);
        let limits = EdgeLimits { angle, spacing, noise };
        let mut straight = straight_edges(&support, &flats.flats, limits);
        check(monitor)?;
        let mut meetings = corners(&support, &flats.flats, &mut straight, spacing, noise);
        check(monitor)?;
        let known: Vec<[Vec3; 2]> = straight.iter().map(|edge| [edge.end(0), edge.end(1)]).collect();
        let around = (AROUND * (grain / spacing).powi(2)).round() as usize;
        let search = CreaseSearch { partition, angle, grain, around, noise, known: &known };
        let mut creases = creases(&search, &|p| fitted.outward(p));
        let joints = Joints {
            flats: &flats.flats,
            edges: &mut straight,
            creases: &mut creases,
            meetings: &mut meetings,
            reach: SNAP * grain,
            off: ON_PLANE * noise,
        };
        joints.join();
        check(monitor)?;
        Ok(Self { straight, creases, meetings })
    }
}
