//! Loose ends: those of creases, and those of straight edges that no third plane ends.
//!
//! Ends near a corner go there. Where three or more come near one another they make a corner. Two that meet at an angle make one, too; two
//! that continue each other are joined end to end.

use nalgebra::{Matrix3, Vector3};

use super::corners::{Meeting, drop_reversed};
use super::creases::Crease;
use super::straight::StraightEdge;
use super::support::Flat;
use crate::spatial::PointTree;
use crate::vec3::{self, Vec3};

/// Cosine of the angle under which two ends that meet continue each other: 30 degrees.
const CONTINUES: f64 = 0.866;

/// An end of an edge that lies at no corner yet.
struct Loose {
    position: Vec3,
    /// Unit direction of the edge there, out of the edge.
    outward: Vec3,
    edge: LooseEdge,
    end: usize,
}

#[derive(Clone, Copy, PartialEq)]
enum LooseEdge {
    Straight(usize),
    Crease(usize),
}

impl Loose {
    /// Whether the edge may end at a position: creases may, straight edges only near their line.
    fn passes(&self, p: Vec3, edges: &[StraightEdge], tolerance: f64) -> bool {
        let LooseEdge::Straight(number) = self.edge else { return true };
        let (edge, d) = (&edges[number], vec3::sub(p, edges[number].origin));
        vec3::norm(vec3::cross(d, edge.direction)) <= tolerance
    }
}

/// What loose ends are joined by.
pub(in crate::feature) struct Joints<'a> {
    pub(in crate::feature) flats: &'a [Flat],
    pub(in crate::feature) edges: &'a mut Vec<StraightEdge>,
    pub(in crate::feature) creases: &'a mut [Crease],
    pub(in crate::feature) meetings: &'a mut Vec<Meeting>,
    /// How far apart ends that meet may lie.
    pub(in crate::feature) reach: f64,
    /// How far from a corner its planes and straight edges may pass.
    pub(in crate::feature) off: f64,
}

impl Joints<'_> {
    /// Ends creases at the corners near their ends, and joins what is loose then.
    pub(in crate::feature) fn join(mut self) {
        let loose = loose_ends(self.meetings, self.edges, self.creases);
        let free = self.at_corners(loose);
        let tree = PointTree::new(&free.iter().map(|l| l.position).collect::<Vec<_>>());
        let mut used = vec![false; free.len()];
        self.meet(&free, &tree, &mut used);
        self.pair(&free, &tree, &mut used);
        for meeting in self.meetings.iter_mut() {
            meeting.planes.sort_unstable();
            meeting.planes.dedup();
            let position = meeting.position;
            meeting.planes.retain(|&plane| self.flats[plane as usize].distance(position).abs() <= self.off);
        }
        drop_reversed(self.meetings, self.edges);
    }

    /// Draws creases to corners near their ends; returns the ends that are near none.
    fn at_corners(&mut self, loose: Vec<Loose>) -> Vec<Loose> {
        let corners = PointTree::new(&self.meetings.iter().map(|m| m.position).collect::<Vec<_>>());
        let mut free = Vec::new();
        for end in loose {
            match (corners.nearest_within(end.position, self.reach), end.edge) {
                (None, _) => free.push(end),
                (Some(nearest), LooseEdge::Crease(_)) => {
                    attach(&mut self.meetings[nearest.index], &end, self.edges, self.creases);
                }
                (Some(_), LooseEdge::Straight(_)) => {}
            }
        }
        free
    }

    /// Makes corners where three ends or more come near one another.
    fn meet(&mut self, free: &[Loose], tree: &PointTree, used: &mut [bool]) {
        let reach = self.reach;
        let mut found = Vec::new();
        for i in 0..free.len() {
            if used[i] {
                continue;
            }
            tree.k_nearest(free[i].position, MOST_ENDS, &mut found);
            let mut near: Vec<usize> = Vec::new();
            for n in found.iter().filter(|n| n.distance_squared <= reach * reach && !used[n.index]) {
                // Of a short edge only the nearer end.
                if near.iter().all(|&known| free[known].edge != free[n.index].edge) {
                    near.push(n.index);
                }
            }
            if near.len() >= 3 {
                self.corner(free, near, 3, used);
            }
        }
    }

    /// Makes a corner of some ends, unless fewer than `least` pass its position.
    fn corner(&mut self, free: &[Loose], mut near: Vec<usize>, least: usize, used: &mut [bool]) {
        let Some(position) = nearest_to_lines(near.iter().map(|&n| &free[n]), self.reach) else { return };
        // A straight edge ends where its line passes.
        near.retain(|&n| free[n].passes(position, self.edges, self.off));
        if near.len() < least {
            return;
        }
        let mut meeting = Meeting { position, planes: Vec::new(), ends: Vec::new(), creases: Vec::new() };
        for n in near {
            used[n] = true;
            attach(&mut meeting, &free[n], self.edges, self.creases);
        }
        self.meetings.push(meeting);
    }

    /// Joins ends two by two, the nearest first.
    fn pair(&mut self, free: &[Loose], tree: &PointTree, used: &mut [bool]) {
        let reach = self.reach;
        let (mut found, mut pairs) = (Vec::new(), Vec::new());
        for i in (0..free.len()).filter(|&i| !used[i]) {
            tree.k_nearest(free[i].position, MOST_ENDS, &mut found);
            let near = found.iter().filter(|n| n.index > i && !used[n.index] && n.distance_squared <= reach * reach);
            pairs.extend(near.filter(|n| free[n.index].edge != free[i].edge).map(|n| (n.distance_squared, i, n.index)));
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        for (_, i, j) in pairs {
            if used[i] || used[j] {
                continue;
            }
            if -vec3::dot(free[i].outward, free[j].outward) < CONTINUES {
                self.corner(free, vec![i, j], 2, used);
            } else {
                (used[i], used[j]) = (true, true);
                self.continued(&free[i], &free[j]);
            }
        }
    }

    /// Draws two ends that continue each other together: a crease to the end of a straight edge, two creases to the middle between them.
    fn continued(&mut self, a: &Loose, b: &Loose) {
        let place = match (a.edge, b.edge) {
            (LooseEdge::Straight(_), LooseEdge::Straight(_)) => return,
            (LooseEdge::Straight(_), _) => a.position,
            (_, LooseEdge::Straight(_)) => b.position,
            _ => vec3::scale(vec3::add(a.position, b.position), 0.5),
        };
        for end in [a, b] {
            if let LooseEdge::Crease(number) = end.edge {
                self.creases[number].draw_to(end.end, place);
            }
        }
    }
}

/// The most ends that meet in a corner.
const MOST_ENDS: usize = 8;

fn loose_ends(meetings: &[Meeting], edges: &[StraightEdge], creases: &[Crease]) -> Vec<Loose> {
    let mut taken = vec![[false; 2]; edges.len()];
    for &(edge, end) in meetings.iter().flat_map(|m| &m.ends) {
        taken[edge][end] = true;
    }
    let mut loose = Vec::new();
    for (number, edge) in edges.iter().enumerate() {
        for end in (0..2).filter(|&end| !taken[number][end]) {
            let sign = if end == 0 { -1.0 } else { 1.0 };
            let (position, outward) = (edge.end(end), vec3::scale(edge.direction, sign));
            loose.push(Loose { position, outward, edge: LooseEdge::Straight(number), end });
        }
    }
    for (number, crease) in creases.iter().enumerate() {
        let line = &crease.polyline;
        let n = line.len();
        if n < 2 || line[0] == line[n - 1] {
            continue;
        }
        for (end, from, to) in [(0, 2.min(n - 1), 0), (1, n - 1 - 2.min(n - 1), n - 1)] {
            if let Some(outward) = vec3::normalized(vec3::sub(line[to], line[from])) {
                loose.push(Loose { position: line[to], outward, edge: LooseEdge::Crease(number), end });
            }
        }
    }
    loose
}

/// Draws an edge to a corner.
fn attach(meeting: &mut Meeting, loose: &Loose, edges: &mut [StraightEdge], creases: &mut [Crease]) {
    match loose.edge {
        LooseEdge::Straight(number) => {
            let edge = &mut edges[number];
            edge.ends[loose.end] = vec3::dot(vec3::sub(meeting.position, edge.origin), edge.direction);
            meeting.ends.push((number, loose.end));
            meeting.planes.extend(edge.planes);
        }
        LooseEdge::Crease(number) => {
            creases[number].draw_to(loose.end, meeting.position);
            meeting.creases.push(number);
            meeting.planes.extend(&creases[number].planes);
        }
    }
}

/// The position nearest to the lines of some ends by least squares, unless it is far from one of them.
fn nearest_to_lines<'a>(ends: impl Iterator<Item = &'a Loose> + Clone, reach: f64) -> Option<Vec3> {
    let (mut gram, mut right) = (Matrix3::zeros(), Vector3::zeros());
    let mut mean = Vector3::zeros();
    for end in ends.clone() {
        let (p, d) = (Vector3::from(end.position), Vector3::from(end.outward));
        let across = Matrix3::identity() - d * d.transpose();
        gram += across;
        right += across * p;
        mean += p;
    }
    mean /= ends.clone().count() as f64;
    let position: Vec3 = gram.lu().solve(&right).unwrap_or(mean).into();
    ends.clone().all(|end| vec3::distance(end.position, position) <= reach).then_some(position)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::feature::model::FeatureKind;

    fn crease(polyline: Vec<Vec3>) -> Crease {
        Crease { polyline, kind: FeatureKind::Convex, angle: 1.5, planes: Vec::new() }
    }

    fn joined(edges: &mut Vec<StraightEdge>, creases: &mut [Crease]) -> Vec<Meeting> {
        let mut meetings = Vec::new();
        Joints { flats: &[], edges, creases, meetings: &mut meetings, reach: 3.0, off: 0.5 }.join();
        meetings
    }

    /// Along x from 0, with positions a unit apart.
    fn along(n: u32) -> Vec<Vec3> {
        (0..n).map(|i| [f64::from(i), 0.0, 0.0]).collect()
    }

    #[test]
    fn two_ends_at_an_angle_make_a_corner_where_their_lines_meet() {
        let mut creases = [crease(along(10)), crease((1..10).map(|i| [10.0, f64::from(i), 0.0]).collect())];
        let meetings = joined(&mut Vec::new(), &mut creases);
        assert_eq!((meetings.len(), meetings[0].creases.len()), (1, 2));
        assert!(vec3::distance(meetings[0].position, [10.0, 0.0, 0.0]) < 1e-9, "{meetings:?}");
        assert_eq!(
            (creases[0].polyline.last(), creases[1].polyline.first()),
            (Some(&meetings[0].position), Some(&meetings[0].position))
        );
    }

    #[test]
    fn a_crease_continues_a_straight_edge_without_a_corner() {
        let (origin, direction) = ([11.0, 0.2, 0.0], [1.0, 0.0, 0.0]);
        let kind = FeatureKind::Convex;
        let straight = StraightEdge { planes: [0, 1], origin, direction, ends: [0.0, 20.0], kind, angle: 1.5 };
        let mut creases = [crease(along(10))];
        let mut edges = vec![straight];
        assert!(joined(&mut edges, &mut creases).is_empty());
        assert_eq!(creases[0].polyline.last(), Some(&origin));
        assert_eq!(edges[0].ends, [0.0, 20.0]);
    }

    #[test]
    fn ends_out_of_reach_stay_loose() {
        let mut creases = [crease(along(10)), crease((4..10).map(|i| [9.0, f64::from(i), 0.0]).collect())];
        assert!(joined(&mut Vec::new(), &mut creases).is_empty());
        assert_eq!((creases[0].polyline.len(), creases[1].polyline.len()), (10, 6));
    }
}
