//! All planes of a cloud: those that the points bear, and the walls under the rims of roofs.

pub(in crate::feature) mod flatness;
mod hidden;
mod leftovers;
pub(in crate::feature) mod outline;
pub(in crate::feature) mod polygons;
pub(in crate::feature) mod regions;
mod settle;
mod walls;

use rayon::prelude::*;

use self::flatness::{dense_regions, flat_regions, members};
use self::leftovers::recover;
use self::polygons::has_outline;
use self::regions::{NONE, Partition, Region};
use self::walls::{Roofs, Wall, walls};
use crate::feature::params::FeatureError;
use crate::feature::prepare::{Fitted, Resolved};
use crate::feature::sharp::support::Flat;
use crate::feature::surroundings::NEIGHBOURS;
use crate::fit::cascade::Scene;
use crate::monitor::{Monitor, check};
use crate::vec3::{self, Vec3};

/// The planes with their points.
pub(in crate::feature) struct Flats {
    /// Those that the points bear, and then the walls.
    pub(in crate::feature) flats: Vec<Flat>,
    /// The points of each.
    pub(in crate::feature) members: Vec<Vec<u32>>,
    /// The plane of each point.
    pub(in crate::feature) labels: Vec<Option<u32>>,
    /// The spacing of the points of each plane that they bear.
    pub(in crate::feature) spacings: Vec<f64>,
    /// The walls that were inferred.
    pub(in crate::feature) walls: Vec<Wall>,
}

impl Flats {
    /// Fills the partition and finds the walls.
    pub(in crate::feature) fn find(
        partition: &mut Partition<'_>,
        fitted: &Fitted<'_>,
        resolved: &Resolved,
        monitor: &dyn Monitor,
    ) -> Result<Self, FeatureError> {
        let spacings = find_regions(partition, resolved, monitor)?;
        let mut flats = oriented(partition, fitted);
        let mut members = members(partition);
        let mut walls = if fitted.plan.scene == Scene::Airborne {
            let (spacing, noise, up) = (resolved.spacing, resolved.noise, fitted.plan.up);
            walls(&Roofs { partition, members: &members, flats: &flats, spacing, noise, up })
        } else {
            Vec::new()
        };
        let mut labels: Vec<Option<u32>> = partition.labels.par_iter().map(|&l| (l != NONE).then_some(l)).collect();
        walls.retain(|wall| wall.area() >= resolved.min_area);
        for wall in &mut walls {
            // A point between two walls belongs to the longer one, which comes first.
            wall.points.retain(|&i| labels[i as usize].is_none());
            for &i in &wall.points {
                labels[i as usize] = Some(flats.len() as u32);
            }
            flats.push(wall.flat);
            members.push(wall.points.clone());
        }
        Ok(Self { flats, members, labels, spacings, walls })
    }

    /// The wall that a plane is, if it was inferred.
    pub(in crate::feature) fn wall(&self, plane: usize) -> Option<&Wall> {
        self.walls.get(plane.checked_sub(self.spacings.len())?)
    }

    /// The points with their planes, and points spread over the walls, so that these have edges, too.
    pub(in crate::feature) fn bearing(&self, points: &[Vec3], spacing: f64) -> (Vec<Vec3>, Vec<Option<u32>>) {
        let (mut points, mut labels) = (points.to_vec(), self.labels.clone());
        for (number, wall) in (self.spacings.len()..).zip(&self.walls) {
            points.extend(wall.spread(spacing));
            labels.resize(points.len(), Some(number as u32));
        }
        (points, labels)
    }
}

/// Times that points are given to regions anew.
const ROUNDS: usize = 5;
/// The round before which the points left over are looked at.
const RECOVERY: usize = 2;
/// The rounds before which hidden planes are looked for, unless noise makes the grain coarser than the spacing: so few points then tell no plane
/// from a round strip. The second time finds those beside the first.
const HIDDEN: std::ops::RangeInclusive<usize> = 1..=2;

/// Fills the partition; returns the spacing of the points of each region.
fn find_regions(
    partition: &mut Partition<'_>,
    resolved: &Resolved,
    monitor: &dyn Monitor,
) -> Result<Vec<f64>, FeatureError> {
    partition.grow();
    check(monitor)?;
    for round in 0..ROUNDS {
        if round == RECOVERY {
            recover(partition);
        }
        if HIDDEN.contains(&round) && resolved.grain <= resolved.spacing {
            partition.add_hidden();
        }
        partition.settle();
        let keep: Vec<bool> = partition.regions.iter().map(|r| r.is_borne_out(r.count)).collect();
        partition.retain(&keep);
        check(monitor)?;
    }
    let keep = dense_regions(partition);
    partition.retain(&keep);
    let keep = flat_regions(partition);
    partition.retain(&keep);
    check(monitor)?;
    // A layer of stray points over a round surface is seen as such once the surface itself has been given up.
    loop {
        let keep = dense_regions(partition);
        partition.retain(&keep);
        if keep.iter().all(|&keep| keep) {
            break;
        }
    }
    let members = members(partition);
    let spacings: Vec<f64> = members.par_iter().map(|members| spacing_of(partition, members)).collect();
    let keep: Vec<bool> = members
        .par_iter()
        .zip(&partition.regions)
        .zip(&spacings)
        .map(|((members, region), &spacing)| {
            let is_large = region.count as f64 * spacing * spacing >= resolved.min_area;
            let points = || -> Vec<Vec3> { members.iter().map(|&i| partition.points[i as usize]).collect() };
            // What has no outline is no face.
            is_large && region.is_borne_out(members.len()) && has_outline(&region.flat(), &points(), spacing)
        })
        .collect();
    partition.retain(&keep);
    Ok(spacings.into_iter().zip(keep).filter(|(_, keep)| *keep).map(|(spacing, _)| spacing).collect())
}

/// The side of the square that one point has to itself: the median over the points.
fn spacing_of(partition: &Partition<'_>, members: &[u32]) -> f64 {
    let mut radii: Vec<f32> = members.iter().map(|&i| partition.around.radii[i as usize]).collect();
    if radii.is_empty() {
        return 0.0;
    }
    let middle = radii.len() / 2;
    let (_, median, _) = radii.select_nth_unstable_by(middle, f32::total_cmp);
    f64::from(*median) * (std::f64::consts::PI / NEIGHBOURS as f64).sqrt()
}

/// Points of a region that tell its sides, at most.
const VOTERS: usize = 400;
/// The least mean cosine between a plane's normal and the gradient of F for its sides to be known.
const CLEAR: f64 = 0.3;

/// The planes with their normals turned outward.
fn oriented(partition: &Partition<'_>, fitted: &Fitted<'_>) -> Vec<Flat> {
    let flat = |(region, members): (&Region, &Vec<u32>)| {
        let (mut cosine, mut count) = (0.0, 0.0);
        for &i in members.iter().step_by(members.len().div_ceil(VOTERS).max(1)) {
            if let Some(outward) = fitted.outward(partition.points[i as usize]).and_then(vec3::normalized) {
                cosine += vec3::dot(outward, region.normal);
                count += 1.0;
            }
        }
        let oriented = count > 0.0 && (cosine / count).abs() > CLEAR;
        let up = fitted.plan.up.restore([0.0, 0.0, 1.0]);
        let turned = if oriented { cosine < 0.0 } else { vec3::dot(region.normal, up) < 0.0 };
        let sign = if turned { -1.0 } else { 1.0 };
        Flat { normal: vec3::scale(region.normal, sign), offset: sign * region.offset, oriented }
    };
    partition.regions.par_iter().zip(members(partition).par_iter()).map(flat).collect()
}
