//! What was found, for the caller.

use rayon::prelude::*;

use super::params::{FeatureReport, FeatureSeconds};
use super::planes::Flats;
use super::prepare::{Fitted, Resolved, Sorted};
use super::sharp::Sharp;
use super::sharp::corners::{Meeting, kind};
use super::{Corner, Edge, FeatureClass, Features, Plane, PointFeature};
use crate::cloud::Cloud;
use crate::spatial::{PointTree, TriangleTree};
use crate::vec3::{self, Vec3};

/// Points nearer than this to an edge or a corner, over the spacing, are of its class.
const NEAR: f64 = 1.5;

/// Numbers everything for the caller, in the coordinates of the cloud.
pub(super) fn assemble(
    cloud: &Cloud,
    sorted: &Sorted,
    flats: &Flats,
    sharp: &Sharp,
    mut planes: Vec<Plane>,
    spacing: f64,
) -> Features {
    let back = |p: Vec3| vec3::add(p, sorted.centre);
    for plane in &mut planes {
        plane.offset += vec3::dot(plane.normal, sorted.centre);
        plane.rings.iter_mut().flatten().for_each(|p| *p = back(*p));
    }
    let mut order: Vec<usize> = (0..planes.len()).collect();
    order.sort_by(|&a, &b| planes[b].area.total_cmp(&planes[a].area).then(a.cmp(&b)));
    let mut new = vec![0_u32; planes.len()];
    for (place, &old) in order.iter().enumerate() {
        new[old] = place as u32;
    }
    let renumbered = |old: &[u32]| {
        let mut planes: Vec<usize> = old.iter().map(|&p| new[p as usize] as usize).collect();
        planes.sort_unstable();
        planes
    };
    let mut at_ends = vec![[None; 2]; sharp.straight.len()];
    for corner in &sharp.meetings {
        for &(edge, end) in &corner.ends {
            at_ends[edge][end] = Some(corner.position);
        }
    }
    let straight = sharp.straight.iter().zip(at_ends).map(|(edge, corners)| Edge {
        kind: edge.kind,
        planes: renumbered(&edge.planes),
        polyline: [0, 1].map(|end| back(corners[end].unwrap_or_else(|| edge.end(end)))).to_vec(),
        angle: edge.angle,
    });
    let curved = sharp.creases.iter().map(|crease| Edge {
        kind: crease.kind,
        planes: renumbered(&crease.planes),
        polyline: crease.polyline.iter().map(|&p| back(p)).collect(),
        angle: crease.angle,
    });
    let edges: Vec<Edge> = straight.chain(curved).collect();
    let corner = |meeting: &Meeting| {
        let creases = meeting.creases.iter().map(|crease| sharp.straight.len() + crease);
        let mut own: Vec<usize> = meeting.ends.iter().map(|&(edge, _)| edge).chain(creases).collect();
        own.sort_unstable();
        own.dedup();
        Corner {
            kind: kind(own.iter().map(|&edge| edges[edge].kind)),
            position: back(meeting.position),
            planes: renumbered(&meeting.planes),
            edges: own,
        }
    };
    let corners: Vec<Corner> = sharp.meetings.iter().map(corner).collect();
    let segments: Vec<[Vec3; 2]> =
        edges.iter().flat_map(|edge| edge.polyline.windows(2).map(|w| [w[0], w[1]])).collect();
    let edge_tree = TriangleTree::from_segments(&segments);
    let corner_tree = PointTree::new(&corners.iter().map(|c| c.position).collect::<Vec<_>>());
    let near = NEAR * spacing;
    let points = cloud
        .points
        .par_iter()
        .zip(&sorted.place)
        .map(|(&p, place)| {
            let plane = place.and_then(|place| flats.labels[place as usize]).map(|old| new[old as usize]);
            let class = if corner_tree.nearest_within(p, near).is_some() {
                FeatureClass::Corner
            } else if edge_tree.closest_within(p, near).is_some() {
                FeatureClass::Edge
            } else if plane.is_some() {
                FeatureClass::Flat
            } else {
                FeatureClass::Unstructured
            };
            PointFeature { plane, class }
        })
        .collect();
    let planes = order.into_iter().map(|old| std::mem::take(&mut planes[old])).collect();
    Features { world_from_local: cloud.world_from_local, crs: cloud.crs.clone(), planes, edges, corners, points }
}

/// The figures of what was found.
pub(super) fn report(
    features: &Features,
    fitted: &Fitted<'_>,
    resolved: &Resolved,
    seconds: FeatureSeconds,
) -> FeatureReport {
    let squares: f64 = features.planes.iter().filter_map(|p| Some(p.rms?.powi(2) * p.points as f64)).sum();
    let bearing: usize = features.planes.iter().map(|p| p.points).sum();
    let on_planes: usize = features.points.iter().filter(|p| p.plane.is_some()).count();
    FeatureReport {
        points: features.points.len(),
        spacing: resolved.spacing,
        noise: resolved.noise,
        scene: fitted.plan.scene,
        scene_reason: fitted.plan.scene_reason.clone(),
        min_area: resolved.min_area,
        max_distance: resolved.max_distance,
        max_angle_deg: resolved.max_angle.to_degrees(),
        sharp_angle_deg: resolved.sharp_angle.to_degrees(),
        points_on_planes: on_planes,
        plane_area: features.planes.iter().map(|p| p.area).sum(),
        plane_rms: (bearing > 0).then(|| (squares / bearing as f64).sqrt()),
        edge_length: features.edges.iter().map(Edge::length).sum(),
        seconds,
    }
}
