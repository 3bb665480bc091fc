//! Polygons and segments cut along the faces of the lattice's tetrahedra. Lengths are in cells.

use crate::vec3::{self, Vec3};

/// Cuts a convex polygon where a linear function takes whole values.
pub(super) fn slabs(mut rest: Vec<Vec3>, value: impl Fn(&Vec3) -> f64) -> Vec<Vec<Vec3>> {
    let (low, high) =
        rest.iter().map(&value).fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(v), h.max(v)));
    let mut parts = Vec::new();
    let mut level = low.floor() + 1.0;
    while level < high {
        let [below, above] = cut(&rest, |p| value(p) - level);
        parts.push(below);
        rest = above;
        level += 1.0;
    }
    parts.push(rest);
    parts.retain(|part| part.len() > 2);
    parts
}

/// The parts of a convex polygon where a linear function is negative, and where it is not.
fn cut(polygon: &[Vec3], value: impl Fn(&Vec3) -> f64) -> [Vec<Vec3>; 2] {
    let mut parts = [Vec::with_capacity(polygon.len() + 1), Vec::with_capacity(polygon.len() + 1)];
    for (i, p) in polygon.iter().enumerate() {
        let q = &polygon[(i + 1) % polygon.len()];
        let (here, there) = (value(p), value(q));
        parts[usize::from(here >= 0.0)].push(*p);
        if (here < 0.0) != (there < 0.0) {
            let crossing = vec3::lerp(*p, *q, here / (here - there));
            parts.iter_mut().for_each(|part| part.push(crossing));
        }
    }
    parts
}

/// Cuts a polygon that lies in one cell along the faces of the cell's tetrahedra.
pub(super) fn in_tetrahedra(polygon: Vec<Vec3>) -> Vec<Vec<Vec3>> {
    let centre = middle(&polygon).map(f64::floor);
    let mut parts = vec![polygon];
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let difference = |p: &Vec3| (p[a] - centre[a]) - (p[b] - centre[b]);
        parts = parts.iter().flat_map(|part| cut(part, difference)).filter(|part| part.len() > 2).collect();
    }
    parts
}

pub(super) fn middle(polygon: &[Vec3]) -> Vec3 {
    vec3::scale(polygon.iter().fold([0.0; 3], |sum, p| vec3::add(sum, *p)), 1.0 / polygon.len() as f64)
}

/// Cuts a segment along the faces of all tetrahedra: there a coordinate, or the difference of two, is a whole number.
pub(super) fn in_pieces([from, to]: [Vec3; 2]) -> Vec<[Vec3; 2]> {
    let values = |p: Vec3| [p[0], p[1], p[2], p[0] - p[1], p[0] - p[2], p[1] - p[2]];
    let mut cuts = vec![0.0, 1.0];
    for (here, there) in values(from).into_iter().zip(values(to)) {
        let mut level = here.min(there).floor() + 1.0;
        while level < here.max(there) {
            cuts.push((level - here) / (there - here));
            level += 1.0;
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
    cuts.dedup();
    cuts.windows(2).map(|w| [w[0], w[1]].map(|t| vec3::lerp(from, to, t))).collect()
}
