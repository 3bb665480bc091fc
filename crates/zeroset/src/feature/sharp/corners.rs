//! Corners: where edges of three planes or more meet.

use nalgebra::{Matrix3, Vector3};
use rustc_hash::FxHashMap;

use super::straight::StraightEdge;
use super::support::{Flat, Support};
use crate::feature::model::FeatureKind;
use crate::vec3::{self, Vec3};

/// A corner in the making.
#[derive(Debug, Clone)]
pub(in crate::feature) struct Meeting {
    pub(in crate::feature) position: Vec3,
    pub(in crate::feature) planes: Vec<u32>,
    /// Straight edges with the end, 0 or 1, that lies here.
    pub(in crate::feature) ends: Vec<(usize, usize)>,
    /// Creases that end here.
    pub(in crate::feature) creases: Vec<usize>,
}

/// How far the end of an edge may lie from its corner, over the spacing. An edge ends where the last part of its line with data on both
/// sides ends, mostly within two spacings of the corner.
pub(super) const SNAP: f64 = 4.0;
/// Corners nearer to each other than this, over the spacing, are one if one position lies on all their planes.
const SAME: f64 = 2.0;
/// The least product of three normals: under it the position is not known well.
const LEAST_PRODUCT: f64 = 0.05;
/// A plane belongs to a corner if it passes within so many deviations of the noise.
pub(super) const ON_PLANE: f64 = 4.0;

/// The corners, and the edges cut or drawn out to them.
pub(in crate::feature) fn corners(
    support: &Support<'_>,
    flats: &[Flat],
    edges: &mut Vec<StraightEdge>,
    spacing: f64,
    noise: f64,
) -> Vec<Meeting> {
    let mut meetings: Vec<Meeting> = Vec::new();
    let mut cells = Cells::default();
    let mut of_plane = vec![Vec::new(); flats.len()];
    for (number, edge) in edges.iter().enumerate() {
        edge.planes.iter().for_each(|&plane| of_plane[plane as usize].push(number));
    }
    for (number, edge) in edges.iter().enumerate() {
        for end in 0..2 {
            let found = corner_at(support, flats, edges, &of_plane, (number, end), spacing);
            let Some((position, third)) = found else { continue };
            let mut planes = edge.planes.to_vec();
            planes.push(third);
            planes.sort_unstable();
            join(
                &mut meetings,
                &mut cells,
                flats,
                Meeting { position, planes, ends: vec![(number, end)], creases: Vec::new() },
                spacing,
                noise,
            );
        }
    }
    meetings.retain(|meeting| meeting.ends.len() >= 2);
    for meeting in &meetings {
        for &(edge, end) in &meeting.ends {
            let edge = &mut edges[edge];
            edge.ends[end] = vec3::dot(vec3::sub(meeting.position, edge.origin), edge.direction);
        }
    }
    drop_reversed(&mut meetings, edges);
    meetings
}

/// The nearest position to the end of an edge in which a third plane crosses it that has an edge with one of its planes there.
fn corner_at(
    support: &Support<'_>,
    flats: &[Flat],
    edges: &[StraightEdge],
    of_plane: &[Vec<usize>],
    (number, end): (usize, usize),
    spacing: f64,
) -> Option<(Vec3, u32)> {
    let edge = &edges[number];
    let place = edge.end(end);
    let mut best: Option<(f64, Vec3, u32)> = None;
    let mut near = support.planes_within(place);
    let outside = vec3::add_scaled(place, edge.direction, if end == 0 { -support.reach } else { support.reach });
    near.extend(support.planes_within(outside));
    near.sort_unstable();
    near.dedup();
    for third in near.into_iter().filter(|plane| !edge.planes.contains(plane)) {
        let flat = &flats[third as usize];
        let slope = vec3::dot(flat.normal, edge.direction);
        let [a, b] = edge.planes.map(|p| flats[p as usize].normal);
        if (slope * vec3::norm(vec3::cross(a, b))).abs() < LEAST_PRODUCT {
            continue;
        }
        let along = -flat.distance(edge.origin) / slope;
        let gap = (along - edge.ends[end]).abs();
        if gap > SNAP * spacing || best.as_ref().is_some_and(|b| b.0 <= gap) {
            continue;
        }
        let position = vec3::add_scaled(edge.origin, edge.direction, along);
        let continues = of_plane[third as usize].iter().map(|&other| (other, &edges[other])).any(|(other, e)| {
            other != number
                && e.planes.iter().any(|plane| edge.planes.contains(plane))
                && reaches(e, position, SNAP * spacing)
        });
        if continues {
            best = Some((gap, position, third));
        }
    }
    best.map(|(_, position, third)| (position, third))
}

/// Whether an edge passes a position, or ends there.
fn reaches(edge: &StraightEdge, p: Vec3, tolerance: f64) -> bool {
    let d = vec3::sub(p, edge.origin);
    let along = vec3::dot(d, edge.direction);
    let across = (vec3::norm_squared(d) - along * along).max(0.0).sqrt();
    across <= tolerance && along >= edge.ends[0] - tolerance && along <= edge.ends[1] + tolerance
}

/// The meetings that were first seen in each cell.
type Cells = FxHashMap<[i64; 3], Vec<usize>>;

/// Adds a meeting to one that it is the same as, or to the list.
fn join(meetings: &mut Vec<Meeting>, cells: &mut Cells, flats: &[Flat], new: Meeting, spacing: f64, noise: f64) {
    let side = SAME * spacing;
    let cell = new.position.map(|c| (c / side).floor() as i64);
    let around = |code: i64| [cell[0] + code % 3 - 1, cell[1] + code / 3 % 3 - 1, cell[2] + code / 9 - 1];
    let near: Vec<usize> = (0..27).filter_map(|code| cells.get(&around(code))).flatten().copied().collect();
    for number in near {
        let known = &mut meetings[number];
        if vec3::distance(known.position, new.position) > side {
            continue;
        }
        let mut planes = known.planes.clone();
        planes.extend(&new.planes);
        planes.sort_unstable();
        planes.dedup();
        let Some(position) = meeting_point(flats, &planes, known.position) else { continue };
        let off = planes.iter().map(|&p| flats[p as usize].distance(position).abs()).fold(0.0, f64::max);
        if planes.len() == 3 || off <= ON_PLANE * noise {
            (known.position, known.planes) = (position, planes);
            known.ends.extend(new.ends);
            known.ends.sort_unstable();
            known.ends.dedup();
            return;
        }
    }
    cells.entry(cell).or_default().push(meetings.len());
    meetings.push(new);
}

/// The position nearest to all planes by least squares; of several, the one nearest to `near`.
fn meeting_point(flats: &[Flat], planes: &[u32], near: Vec3) -> Option<Vec3> {
    let (mut gram, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for &plane in planes {
        let flat = &flats[plane as usize];
        let n = Vector3::from(flat.normal);
        gram += n * n.transpose();
        right -= n * flat.distance(near);
    }
    let step = gram.symmetric_eigen();
    let largest = step.eigenvalues.max();
    let mut moved = Vector3::zeros();
    for (value, vector) in step.eigenvalues.iter().zip(step.eigenvectors.column_iter()) {
        if *value > 1e-3 * largest {
            moved += vector * (vector.dot(&right) / value);
        }
    }
    let position = vec3::add(near, moved.into());
    vec3::is_finite(position).then_some(position)
}

/// Leaves out edges that their corners turned around or left without length, and corners where fewer than two edges stay.
pub(super) fn drop_reversed(meetings: &mut Vec<Meeting>, edges: &mut Vec<StraightEdge>) {
    let mut next = 0;
    let new: Vec<Option<usize>> = edges
        .iter()
        .map(|edge| {
            (edge.ends[0] < edge.ends[1]).then(|| {
                next += 1;
                next - 1
            })
        })
        .collect();
    for meeting in meetings.iter_mut() {
        meeting.ends = meeting.ends.iter().filter_map(|&(edge, end)| Some((new[edge]?, end))).collect();
    }
    meetings.retain(|meeting| meeting.ends.len() + meeting.creases.len() >= 2);
    let mut place = 0;
    edges.retain(|_| {
        place += 1;
        new[place - 1].is_some()
    });
}

/// The kind of a corner from those of its edges.
pub(in crate::feature) fn kind(kinds: impl Iterator<Item = FeatureKind>) -> FeatureKind {
    let (mut convex, mut concave, mut unknown) = (false, false, false);
    for kind in kinds {
        match kind {
            FeatureKind::Convex => convex = true,
            FeatureKind::Concave => concave = true,
            FeatureKind::Mixed => (convex, concave) = (true, true),
            FeatureKind::Unknown => unknown = true,
        }
    }
    match (convex, concave, unknown) {
        (true, true, _) => FeatureKind::Mixed,
        (true, false, false) => FeatureKind::Convex,
        (false, true, false) => FeatureKind::Concave,
        _ => FeatureKind::Unknown,
    }
}
