//! Planes against the faces of the truth.

use rayon::prelude::*;

use super::super::{Features, Plane};
use super::data::Data;
use super::overlap::{Outline, Polygon};
use super::truth::{Face, Truth, angle_between};
use super::{CompareFeaturesParams, ErrorSummary, FaceRecall, PlaneAgreement, mean};
use crate::monitor::{Cancelled, Monitor, check};
use crate::vec3;

/// A face is a wall if its normal is within 10 degrees of level.
const WALL: f64 = std::f64::consts::PI / 18.0;
/// Planes and faces agree if they have more than this share in common.
const COMMON: f64 = 0.5;

/// A plane that may match a face.
struct Pair {
    plane: usize,
    face: usize,
    common_area: f64,
    angle: f64,
    offset: f64,
}

pub(super) fn compare(
    found: &Features,
    truth: &Truth,
    data: Option<&Data>,
    params: &CompareFeaturesParams,
    offset_tolerance: f64,
    monitor: &dyn Monitor,
) -> Result<PlaneAgreement, Cancelled> {
    let counts: Vec<bool> = (0..truth.faces.len())
        .map(|face| {
            truth.faces[face].area >= params.min_face_area
                && data.is_none_or(|data| data.points_of_face[face] >= params.min_points)
        })
        .collect();
    let search = Search { truth, counts: &counts, max_angle: params.max_angle, offset_tolerance };
    let pairs = found.planes.par_iter().enumerate().map(|(i, plane)| {
        check(monitor)?;
        Ok(search.pairs(i, plane))
    });
    let mut pairs = pairs.collect::<Result<Vec<_>, Cancelled>>()?.into_iter().flatten().collect::<Vec<_>>();
    pairs.sort_by(|a, b| b.common_area.total_cmp(&a.common_area).then((a.plane, a.face).cmp(&(b.plane, b.face))));
    let (mut plane_taken, mut face_taken) = (vec![false; found.planes.len()], vec![false; truth.faces.len()]);
    pairs.retain(|pair| {
        let free = !plane_taken[pair.plane] && !face_taken[pair.face];
        if free {
            (plane_taken[pair.plane], face_taken[pair.face]) = (true, true);
        }
        free
    });

    let recall = |wanted: &dyn Fn(&Face) -> bool| {
        let mut recall = FaceRecall::default();
        let faces = truth.faces.iter().enumerate();
        for (i, face) in faces.filter(|(i, face)| counts[*i] && wanted(face)) {
            recall.faces += 1;
            recall.area += face.area;
            if face_taken[i] {
                recall.found += 1;
                recall.found_area += face.area;
            }
        }
        recall.by_count = (recall.faces > 0).then(|| recall.found as f64 / recall.faces as f64);
        recall.by_area = (recall.area > 0.0).then(|| recall.found_area / recall.area);
        recall
    };
    let is_wall = |face: &Face| face.normal[2].abs() <= WALL.sin();
    let counted = || pairs.iter().filter(|pair| counts[pair.face]);
    let points_right = |pair: &Pair| {
        let plane = &found.planes[pair.plane];
        let right = vec3::dot(plane.normal, truth.faces[pair.face].normal) > 0.0;
        plane.oriented.then_some(f64::from(right))
    };
    Ok(PlaneAgreement {
        found: found.planes.len(),
        matched: pairs.len(),
        precision: (!found.planes.is_empty()).then(|| pairs.len() as f64 / found.planes.len() as f64),
        all: recall(&|_| true),
        walls: recall(&is_wall),
        roofs_and_ground: recall(&|face| !is_wall(face)),
        angle_error_deg: ErrorSummary::of(counted().map(|pair| pair.angle.to_degrees()).collect()),
        offset_error: ErrorSummary::of(counted().map(|pair| pair.offset).collect()),
        orientation: mean(counted().filter_map(points_right)),
    })
}

/// Looks for the faces that a plane may match.
struct Search<'a> {
    truth: &'a Truth,
    counts: &'a [bool],
    max_angle: f64,
    offset_tolerance: f64,
}

impl Search<'_> {
    fn pairs(&self, i: usize, plane: &Plane) -> Vec<Pair> {
        let (Some(normal), Some(polygon)) = (vec3::normalized(plane.normal), Polygon::new(plane)) else {
            return Vec::new();
        };
        // An allowed tilt lifts the far end of the polygon off its face.
        let extent = vec3::distance(polygon.bounds[0], polygon.bounds[1]);
        let slack = self.offset_tolerance + self.max_angle.sin() * extent;
        let faces = self.truth.faces.iter().enumerate().filter_map(|(number, face)| {
            let angle = angle_between(normal, face.normal);
            let angle = angle.min(std::f64::consts::PI - angle);
            let offset = (vec3::dot(normal, face.centre) - plane.offset).abs();
            if !(angle <= self.max_angle && offset <= self.offset_tolerance && meet(face.bounds, polygon.bounds, slack))
            {
                return None;
            }
            let overlap = Outline::new(self.truth, face).overlap(face, &polygon, self.offset_tolerance);
            let common = overlap.of_polygon > COMMON || (self.counts[number] && overlap.of_face > COMMON);
            common.then_some(Pair { plane: i, face: number, common_area: overlap.area, angle, offset })
        });
        faces.collect()
    }
}

/// Whether two boxes are no farther apart than `slack` along any axis.
fn meet(a: [vec3::Vec3; 2], b: [vec3::Vec3; 2], slack: f64) -> bool {
    (0..3).all(|axis| a[0][axis] <= b[1][axis] + slack && b[0][axis] <= a[1][axis] + slack)
}
