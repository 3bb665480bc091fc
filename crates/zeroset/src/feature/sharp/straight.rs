//! Straight edges: where two planes meet, and both hold points.

use rayon::prelude::*;

use super::support::{Contact, Flat, Support};
use crate::feature::model::FeatureKind;
use crate::vec3::{self, Vec3};

/// A piece of the line in which two planes meet.
#[derive(Debug, Clone)]
pub(in crate::feature) struct StraightEdge {
    /// The planes, ascending.
    pub(in crate::feature) planes: [u32; 2],
    /// A point of the line.
    pub(in crate::feature) origin: Vec3,
    /// Unit direction of the line.
    pub(in crate::feature) direction: Vec3,
    /// Where it begins and ends, along the direction from the origin.
    pub(in crate::feature) ends: [f64; 2],
    /// Which way the surface bends.
    pub(in crate::feature) kind: FeatureKind,
    /// The angle by which the surface turns.
    pub(in crate::feature) angle: f64,
}

impl StraightEdge {
    /// The position at one of the ends.
    pub(in crate::feature) fn end(&self, which: usize) -> Vec3 {
        vec3::add_scaled(self.origin, self.direction, self.ends[which])
    }
}

/// What an edge takes.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct EdgeLimits {
    /// The least angle by which the surface turns.
    pub(in crate::feature) angle: f64,
    /// Spacing of the points.
    pub(in crate::feature) spacing: f64,
    /// Deviation of the points across the surface.
    pub(in crate::feature) noise: f64,
}

/// Length, over the spacing, of the parts of a line that must hold points of both planes. Parts of 1.5 by a reach of 2.5 spacings hold
/// nearly four points of either on the mean.
const PART: f64 = 1.5;
/// Empty parts that are bridged. A part of a line with data on both sides is empty on one of them once in 20 times.
const GAP: usize = 3;
/// The fewest parts of an edge.
const LEAST_PARTS: usize = 2;
/// Sine of the angle between planes under which their line is not known well.
const LEAST_SINE: f64 = 0.12;

/// All straight edges, by planes and then along their lines.
pub(in crate::feature) fn straight_edges(
    support: &Support<'_>,
    flats: &[Flat],
    limits: EdgeLimits,
) -> Vec<StraightEdge> {
    let contacts = support.contacts();
    let found: Vec<Vec<StraightEdge>> =
        contacts.par_iter().map(|contact| edges_of(support, flats, limits, contact)).collect();
    found.into_iter().flatten().collect()
}

/// The angle by which the surface turns from one plane to the other; the smaller of two where the sides are not known.
pub(in crate::feature) fn turn(a: &Flat, b: &Flat) -> f64 {
    let cos = vec3::dot(a.normal, b.normal);
    let cos = if a.oriented && b.oriented { cos } else { cos.abs() };
    vec3::norm(vec3::cross(a.normal, b.normal)).atan2(cos)
}

/// The line in which two planes meet: the point of it nearest to `near`, and its direction.
pub(in crate::feature) fn line_of(a: &Flat, b: &Flat, near: Vec3) -> Option<(Vec3, Vec3)> {
    let cross = vec3::cross(a.normal, b.normal);
    let squared = vec3::norm_squared(cross);
    if squared < LEAST_SINE * LEAST_SINE {
        return None;
    }
    // x = near + s a + t b with both distances zero.
    let (da, db, cos) = (a.distance(near), b.distance(near), vec3::dot(a.normal, b.normal));
    let (s, t) = ((cos * db - da) / squared, (cos * da - db) / squared);
    let origin = vec3::add_scaled(vec3::add_scaled(near, a.normal, s), b.normal, t);
    Some((origin, vec3::normalized(cross)?))
}

fn edges_of(support: &Support<'_>, flats: &[Flat], limits: EdgeLimits, contact: &Contact) -> Vec<StraightEdge> {
    let [a, b] = contact.planes.map(|plane| &flats[plane as usize]);
    let angle = turn(a, b);
    if angle < limits.angle {
        return Vec::new();
    }
    let first = support.point(contact.points[0][0]);
    let Some((origin, direction)) = line_of(a, b, first) else { return Vec::new() };
    let part = PART * limits.spacing;
    // For each side, the places along the line of the points near it.
    let mut places: [Vec<(i64, f64, f64)>; 2] = Default::default();
    for side in 0..2 {
        let other = [b, a][side];
        for &i in &contact.points[side] {
            let d = vec3::sub(support.point(i), origin);
            let along = vec3::dot(d, direction);
            if vec3::norm_squared(d) - along * along <= support.reach * support.reach {
                places[side].push(((along / part).floor() as i64, along, other.distance(support.point(i))));
            }
        }
        places[side].sort_by(|p, q| p.0.cmp(&q.0).then(p.1.total_cmp(&q.1)));
    }
    let occupied = |side: usize| {
        let mut parts: Vec<i64> = places[side].iter().map(|p| p.0).collect();
        parts.dedup();
        parts
    };
    let (ours, theirs) = (occupied(0), occupied(1));
    let both: Vec<i64> = ours.into_iter().filter(|part| theirs.binary_search(part).is_ok()).collect();
    both.chunk_by(|p, q| q - p <= GAP as i64 + 1)
        .filter(|run| run.len() >= LEAST_PARTS)
        .filter_map(|run| {
            let (first, last) = (run[0], run[run.len() - 1]);
            let within = [0, 1].map(|side| {
                let all = &places[side];
                let begin = all.partition_point(|p| p.0 < first);
                let end = all.partition_point(|p| p.0 <= last);
                &all[begin..end]
            });
            let low =
                within.iter().map(|w| w.iter().map(|p| p.1).fold(f64::INFINITY, f64::min)).fold(f64::MIN, f64::max);
            let high = within.iter().map(|w| w.iter().map(|p| p.1).fold(f64::MIN, f64::max)).fold(f64::MAX, f64::min);
            (high > low).then(|| StraightEdge {
                planes: contact.planes,
                origin,
                direction,
                ends: [low, high],
                kind: kind(a, b, within, limits),
                angle,
            })
        })
        .collect()
}

/// Convex if each plane's points lie behind the other plane.
fn kind(a: &Flat, b: &Flat, within: [&[(i64, f64, f64)]; 2], limits: EdgeLimits) -> FeatureKind {
    if !(a.oriented && b.oriented) {
        return FeatureKind::Unknown;
    }
    let mean = within.map(|w| w.iter().map(|p| p.2).sum::<f64>() / w.len().max(1) as f64);
    let clear = 0.25 * limits.spacing.max(limits.noise);
    match mean.map(|m| if m < -clear { -1 } else { i32::from(m > clear) }) {
        [x, y] if x + y < 0 => FeatureKind::Convex,
        [x, y] if x + y > 0 => FeatureKind::Concave,
        _ => FeatureKind::Unknown,
    }
}
