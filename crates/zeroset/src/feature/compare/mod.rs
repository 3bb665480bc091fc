//! How well features agree with the truth.
//!
//! # What
//! Planes, edges and corners that were found are held against the faces, creases and corners of a mesh that is known to
//! be true. With the cloud that they were found in, only those parts of the truth count that the cloud has points of.
//!
//! # Definitions
//! - *Vertices* of the truth at equal positions are one, so that a truth need not be welded.
//! - *True faces*: maximal sets of triangles, connected over edges, whose normals are within 0.1 degree of that of the
//!   seed; seeds are taken by falling area. Each point of the cloud belongs to the nearest triangle. A face *counts* with
//!   at least `min_points` points and `min_face_area`; without a cloud the points are not asked.
//! - *Matching*: a found plane can match a true face if the angle between them is at most `max_angle`, signs aside; the
//!   area centre of the face is within `offset_tolerance` of the plane; and of the plane's polygon, laid on the face along
//!   the face's normal, more than half lies in the face, or of a face that counts more than half lies in the polygon.
//!   Among all such pairs those with the largest common area are taken first, and each plane and each face once. So a
//!   doubled plane is a false one, and of a face found in two halves one half is found and the other is false.
//! - *Recall of faces*: share of the counted faces that are matched, by count and by area. *Walls* are the faces whose
//!   normal is within 10 degrees of level, with z up. *Precision*: share of the found planes that are matched, with any
//!   face, counted or not.
//! - *Errors of planes*: over the matches with counted faces, the angle, and the distance of the face's centre from the
//!   plane. *Orientation*: share of the oriented ones among them whose normal points to the true side.
//! - *True creases*: the edges of [`creases`](crate::mesh::creases), sampled evenly by length; boundaries are none. With a
//!   cloud a sample counts if within 4 times the spacing of the points there are at least two points on each side of the
//!   crease: a point is on a side if the normal of its nearest triangle is nearer to that side's than to the other's, by
//!   no more than half of the angle of the crease.
//! - *Recall of edges*: share of the counted samples within `edge_tolerance` of a found edge. *Precision*: share of the
//!   length of the found edges within `edge_tolerance` of a crease, counted or not, of at least 0.8 times `sharp_angle`:
//!   so an edge that is found just under the limit is not false. *Kind*: of the length that is right and whose kind is
//!   convex or concave, the share that is so at the nearest crease.
//! - *True corners*: vertices where three or more creases meet, or two that turn by more than 30 degrees. With a cloud
//!   a corner counts if there are points on both sides of each of its creases close to it.
//! - *Recall, precision, distance and kind of corners*: the same with `corner_tolerance`; the distance is the mean from
//!   the true corners that are found to the nearest found corner.
//!
//! # Cost
//! A search in a tree for each point of the cloud and each sample: under a second for 100,000 points.
//!
//! # Guaranteed
//! The same report, bit for bit, on any number of threads. Features, truth and cloud may carry different world offsets:
//! all are compared in the truth's local frame.
//!
//! # Not guaranteed
//! Common areas are sampled with some 500 positions, so a pair whose common share is one half to a few percent may fall
//! either way. A curved truth has thousands of small facets, each a face of its own: without a cloud, or a
//! `min_face_area`, the recall of faces says little there.
//!
//! ```
//! use zeroset::feature::{CompareFeaturesParams, Features, compare_features};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let truth = Scene::new(SceneKind::Box, 0).truth;
//! let report = compare_features(&Features::default(), &truth, None, &CompareFeaturesParams::default(), &()).unwrap();
//! assert_eq!((report.planes.all.faces, report.corners.counted), (6, 8));
//! assert_eq!(report.planes.all.by_count, Some(0.0));
//! assert_eq!(report.planes.precision, None);
//! ```

mod data;
mod edges;
mod overlap;
mod planes;
mod truth;

#[cfg(test)]
mod tests;

use serde::{Deserialize, Serialize};

use super::Features;
use crate::cloud::Cloud;
use crate::mesh::{Mesh, MeshError, SHARP_ANGLE};
use crate::monitor::{Cancelled, Monitor, check};
use crate::vec3;
use data::Data;
use truth::Truth;

/// How to compare. Angles are in radians, lengths in the unit of the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareFeaturesParams {
    /// The largest angle between a plane and its true face.
    pub max_angle: f64,
    /// The largest distance of a true face's centre from its plane. `None`: 0.002 of the diagonal of the truth's box.
    pub offset_tolerance: Option<f64>,
    /// The distance within which an edge is right. `None`: 0.005 of the diagonal.
    pub edge_tolerance: Option<f64>,
    /// The distance within which a corner is right. `None`: 0.01 of the diagonal.
    pub corner_tolerance: Option<f64>,
    /// The fewest points of the cloud with which a true face counts.
    pub min_points: usize,
    /// The smallest area with which a true face counts.
    pub min_face_area: f64,
    /// The angle from which an edge of the truth is a crease.
    pub sharp_angle: f64,
    /// Number of samples on the true creases, and on the found edges.
    pub edge_samples: usize,
}

impl Default for CompareFeaturesParams {
    fn default() -> Self {
        Self {
            max_angle: 5_f64.to_radians(),
            offset_tolerance: None,
            edge_tolerance: None,
            corner_tolerance: None,
            min_points: 50,
            min_face_area: 0.0,
            sharp_angle: SHARP_ANGLE,
            edge_samples: 20_000,
        }
    }
}

/// Why features were not compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareFeaturesError {
    /// A truth whose triangles have no area.
    #[error("the truth has no surface ({faces} triangles, no area): nothing to compare with")]
    NoSurface {
        /// Number of its triangles.
        faces: usize,
    },
    /// A truth that can't be examined.
    #[error("the truth is broken: {0}")]
    Broken(#[from] MeshError),
    /// A cloud without two different places.
    #[error("the cloud has {points} points but not two different places; leave it out to count all of the truth")]
    NoPoints {
        /// Number of its points.
        points: usize,
    },
    /// A parameter that is zero, negative or not finite.
    #[error("{name} is {value}; it must be positive")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// What [`compare_features`] finds. Lengths are in the unit of the truth. A share of nothing is `None`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareFeaturesReport {
    /// The diagonal of the truth's box.
    pub truth_diagonal: f64,
    /// The largest angle between a plane and its true face, in degrees.
    pub max_angle_deg: f64,
    /// The largest distance of a true face's centre from its plane.
    pub offset_tolerance: f64,
    /// The distance within which an edge is right.
    pub edge_tolerance: f64,
    /// The distance within which a corner is right.
    pub corner_tolerance: f64,
    /// The spacing of the cloud's points; `None` without a cloud.
    pub spacing: Option<f64>,
    /// Planes against faces.
    pub planes: PlaneAgreement,
    /// Edges against creases.
    pub edges: EdgeAgreement,
    /// Corners.
    pub corners: CornerAgreement,
}

/// How many of some true faces were found.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct FaceRecall {
    /// Number of faces that count.
    pub faces: usize,
    /// Number of these that were found.
    pub found: usize,
    /// Area of the faces that count.
    pub area: f64,
    /// Area of these that were found.
    pub found_area: f64,
    /// Share found, by count.
    pub by_count: Option<f64>,
    /// Share found, by area.
    pub by_area: Option<f64>,
}

/// Errors over many matches.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct ErrorSummary {
    /// The mean.
    pub mean: f64,
    /// Half are no larger.
    pub median: f64,
    /// 95 % are no larger.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// Planes against the faces of the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PlaneAgreement {
    /// Number of planes found.
    pub found: usize,
    /// Number of these that match a true face.
    pub matched: usize,
    /// Share of the found planes that match.
    pub precision: Option<f64>,
    /// All faces that count.
    pub all: FaceRecall,
    /// Upright faces.
    pub walls: FaceRecall,
    /// All others.
    pub roofs_and_ground: FaceRecall,
    /// Angles between planes and their faces, in degrees.
    pub angle_error_deg: Option<ErrorSummary>,
    /// Distances of the faces' centres from their planes.
    pub offset_error: Option<ErrorSummary>,
    /// Share of the oriented planes that point to the true side.
    pub orientation: Option<f64>,
}

/// Edges against the creases of the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EdgeAgreement {
    /// Number of edges found.
    pub found: usize,
    /// Their length.
    pub found_length: f64,
    /// Length of all creases of the truth.
    pub true_length: f64,
    /// Length of the creases that count.
    pub counted_length: f64,
    /// Share of the counted length that was found.
    pub recall: Option<f64>,
    /// Share of the found length that is at a crease.
    pub precision: Option<f64>,
    /// Share of that length whose kind is right.
    pub kind: Option<f64>,
}

/// Corners against those of the truth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CornerAgreement {
    /// Number of corners found.
    pub found: usize,
    /// Number of corners of the truth.
    pub truth: usize,
    /// Number of these that count.
    pub counted: usize,
    /// Share of the counted corners that were found.
    pub recall: Option<f64>,
    /// Share of the found corners that are at a true one.
    pub precision: Option<f64>,
    /// Mean distance of the counted corners that were found from the nearest found corner.
    pub mean_distance: Option<f64>,
    /// Share of the right corners whose kind is that of the nearest true one, unknown kinds aside.
    pub kind: Option<f64>,
}

/// Compares features with the truth; with the cloud that they were found in, only what it has points of counts.
///
/// # Errors
/// [`CompareFeaturesError`] if the truth has no surface or is broken, the cloud has no points, a parameter makes no
/// sense, or the monitor asks to stop.
pub fn compare_features(
    found: &Features,
    truth: &Mesh,
    cloud: Option<&Cloud>,
    params: &CompareFeaturesParams,
    monitor: &dyn Monitor,
) -> Result<CompareFeaturesReport, CompareFeaturesError> {
    check_params(params)?;
    monitor.stage("examining the truth");
    let found = moved(found, vec3::sub(found.world_from_local, truth.world_from_local));
    let world_from_local = truth.world_from_local;
    let truth = Truth::new(truth, params)?;
    check(monitor)?;
    monitor.share(0.1);
    let data = match cloud {
        None => None,
        Some(cloud) => {
            monitor.stage("looking where there are points");
            let shift = vec3::sub(cloud.world_from_local, world_from_local);
            Some(Data::new(cloud, shift, &truth, monitor)?)
        }
    };
    monitor.share(0.5);
    monitor.stage("comparing planes");
    let tolerance = |given: Option<f64>, rel: f64| given.unwrap_or(rel * truth.diagonal);
    let offset_tolerance = tolerance(params.offset_tolerance, 0.002);
    let planes = planes::compare(&found, &truth, data.as_ref(), params, offset_tolerance, monitor)?;
    monitor.share(0.8);
    monitor.stage("comparing edges and corners");
    let edge_tolerance = tolerance(params.edge_tolerance, 0.005);
    let corner_tolerance = tolerance(params.corner_tolerance, 0.01);
    let edges = edges::compare(&found, &truth, data.as_ref(), params.edge_samples, edge_tolerance);
    check(monitor)?;
    let corners = edges::compare_corners(&found, &truth, data.as_ref(), corner_tolerance);
    monitor.share(1.0);
    Ok(CompareFeaturesReport {
        truth_diagonal: truth.diagonal,
        max_angle_deg: params.max_angle.to_degrees(),
        offset_tolerance,
        edge_tolerance,
        corner_tolerance,
        spacing: data.as_ref().map(|data| data.spacing),
        planes,
        edges,
        corners,
    })
}

fn check_params(params: &CompareFeaturesParams) -> Result<(), CompareFeaturesError> {
    let given = [
        ("offset_tolerance", params.offset_tolerance),
        ("edge_tolerance", params.edge_tolerance),
        ("corner_tolerance", params.corner_tolerance),
        ("max_angle", Some(params.max_angle)),
        ("sharp_angle", Some(params.sharp_angle)),
        ("edge_samples", Some(params.edge_samples as f64)),
    ];
    for (name, value) in given.into_iter().filter_map(|(name, value)| Some((name, value?))) {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompareFeaturesError::Parameter { name, value });
        }
    }
    Ok(())
}

/// The planes, edges and corners with every position moved; without the points.
fn moved(features: &Features, shift: [f64; 3]) -> Features {
    let mut moved = Features {
        planes: features.planes.clone(),
        edges: features.edges.clone(),
        corners: features.corners.clone(),
        ..Features::default()
    };
    for plane in &mut moved.planes {
        plane.offset += vec3::dot(plane.normal, shift);
        plane.rings.iter_mut().flatten().for_each(|p| *p = vec3::add(*p, shift));
    }
    moved.edges.iter_mut().flat_map(|edge| &mut edge.polyline).for_each(|p| *p = vec3::add(*p, shift));
    moved.corners.iter_mut().for_each(|corner| corner.position = vec3::add(corner.position, shift));
    moved
}

/// The mean; `None` of nothing.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    (count > 0.0).then(|| sum / count)
}

impl ErrorSummary {
    /// `None` without errors.
    fn of(mut errors: Vec<f64>) -> Option<Self> {
        errors.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| errors.get(((share * errors.len() as f64).ceil() as usize).max(1) - 1).copied();
        Some(Self { mean: mean(errors.iter().copied())?, median: at(0.5)?, p95: at(0.95)?, max: at(1.0)? })
    }
}
