//! Edges and corners against the creases and corners of the truth.

use rayon::prelude::*;

use super::super::{FeatureKind, Features};
use super::data::Data;
use super::truth::Truth;
use super::{CornerAgreement, EdgeAgreement, mean};
use crate::spatial::{PointTree, TriangleTree};
use crate::vec3::{self, Vec3};

pub(super) fn compare(
    found: &Features,
    truth: &Truth,
    data: Option<&Data>,
    samples: usize,
    tolerance: f64,
) -> EdgeAgreement {
    let mut owners = Vec::new();
    let mut segments = Vec::new();
    for (i, edge) in found.edges.iter().enumerate() {
        segments.extend(edge.polyline.windows(2).map(|ends| [ends[0], ends[1]]));
        owners.resize(segments.len(), i);
    }
    let sharp = &truth.sharp;
    let true_length = length(&sharp.segments);
    let found_tree = TriangleTree::from_segments(&segments);
    let on_creases = spread(&sharp.segments, samples);
    let seen: Vec<bool> = on_creases
        .par_iter()
        .filter(|(crease, p)| data.is_none_or(|data| data.beside(&sharp.edges[*crease], *p)))
        .map(|(_, p)| found_tree.closest_within(*p, tolerance).is_some())
        .collect();
    let counted_length =
        if on_creases.is_empty() { 0.0 } else { true_length * seen.len() as f64 / on_creases.len() as f64 };

    let lenient = &truth.nearly_sharp;
    let true_tree = TriangleTree::from_segments(&lenient.segments);
    let on_found = spread(&segments, samples);
    let nearest: Vec<Option<FeatureKind>> = on_found
        .par_iter()
        .map(|(_, p)| Some(lenient.edges[true_tree.closest_within(*p, tolerance)?.triangle].kind()))
        .collect();
    let kinds = on_found.iter().zip(&nearest).filter_map(|((segment, _), nearest)| {
        let kind = found.edges[owners[*segment]].kind;
        let known = |kind: FeatureKind| matches!(kind, FeatureKind::Convex | FeatureKind::Concave);
        nearest.filter(|nearest| known(kind) && known(*nearest)).map(|nearest| f64::from(nearest == kind))
    });
    EdgeAgreement {
        found: found.edges.len(),
        found_length: length(&segments),
        true_length,
        counted_length,
        recall: mean(seen.iter().map(|seen| f64::from(*seen))),
        precision: mean(nearest.iter().map(|nearest| f64::from(nearest.is_some()))),
        kind: mean(kinds),
    }
}

pub(super) fn compare_corners(found: &Features, truth: &Truth, data: Option<&Data>, tolerance: f64) -> CornerAgreement {
    let sharp = &truth.sharp;
    let positions: Vec<Vec3> = found.corners.iter().map(|corner| corner.position).collect();
    let found_tree = PointTree::new(&positions);
    let counted = sharp.corners.iter().filter(|corner| data.is_none_or(|data| data.around(corner, sharp)));
    let distances: Vec<Option<f64>> = counted
        .map(|corner| Some(found_tree.nearest_within(corner.position, tolerance)?.distance_squared.sqrt()))
        .collect();

    let lenient = &truth.nearly_sharp;
    let true_tree = PointTree::new(&lenient.corners.iter().map(|corner| corner.position).collect::<Vec<_>>());
    let nearest: Vec<Option<FeatureKind>> =
        positions.iter().map(|p| Some(lenient.corners[true_tree.nearest_within(*p, tolerance)?.index].kind)).collect();
    let kinds = found.corners.iter().zip(&nearest).filter_map(|(corner, nearest)| {
        let known = |kind: &FeatureKind| *kind != FeatureKind::Unknown;
        let nearest = nearest.filter(|nearest| known(nearest) && known(&corner.kind))?;
        Some(f64::from(nearest == corner.kind))
    });
    CornerAgreement {
        found: found.corners.len(),
        truth: sharp.corners.len(),
        counted: distances.len(),
        recall: mean(distances.iter().map(|distance| f64::from(distance.is_some()))),
        precision: mean(nearest.iter().map(|nearest| f64::from(nearest.is_some()))),
        mean_distance: mean(distances.iter().copied().flatten()),
        kind: mean(kinds),
    }
}

fn length(segments: &[[Vec3; 2]]) -> f64 {
    segments.iter().map(|[a, b]| vec3::distance(*a, *b)).sum()
}

/// `n` positions at equal steps along the segments laid end to end, each with its segment.
fn spread(segments: &[[Vec3; 2]], n: usize) -> Vec<(usize, Vec3)> {
    let step = length(segments) / n as f64;
    let (mut places, mut before) = (Vec::new(), 0.0);
    for (i, [a, b]) in segments.iter().enumerate() {
        let length = vec3::distance(*a, *b);
        while length > 0.0 && places.len() < n && (places.len() as f64 + 0.5) * step <= before + length {
            let along = (places.len() as f64 + 0.5) * step - before;
            places.push((i, vec3::lerp(*a, *b, (along / length).clamp(0.0, 1.0))));
        }
        before += length;
    }
    places
}
