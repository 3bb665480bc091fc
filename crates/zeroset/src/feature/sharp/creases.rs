//! Creases where at least one side is curved: found point by point, and joined to polylines.
//!
//! # What
//! Around each point whose neighbourhood is not flat, two flats are fitted to the nearest points, as NEWE does from a good start: the
//! normals of those neighbours that are flat themselves fall into two groups, and points and flats are matched until both rest. Where both
//! flats hold their points, each on one side of the line in which they meet, and the surface turns there by the sharp angle at least, the
//! foot of the point on that line lies on a crease. Such feet are thinned and joined along their directions.
//!
//! # Not guaranteed
//! A rounding narrower than about four grains is taken for a crease, and one that is wider is none. Where a crease turns sharply, or
//! three of them meet, two flats do not suffice and a gap of some grains stays.

use rayon::prelude::*;

use crate::feature::model::FeatureKind;
use crate::feature::moments::Moments;
use crate::feature::planes::regions::{NONE, Partition};
use crate::spatial::{PointTree, TriangleTree};
use crate::vec3::{self, Vec3};

/// A place on a crease.
#[derive(Debug, Clone, Copy)]
struct Foot {
    position: Vec3,
    /// Unit direction of the crease; either of the two.
    direction: Vec3,
    /// The angle by which the surface turns.
    angle: f64,
    /// From the crease into the open angle between the two sides, not of unit length: outward where the crease is concave.
    opening: Vec3,
    /// The planes that bear either side, if any.
    planes: [u32; 2],
}

/// A polyline along a crease.
#[derive(Debug, Clone)]
pub(in crate::feature) struct Crease {
    pub(in crate::feature) polyline: Vec<Vec3>,
    pub(in crate::feature) kind: FeatureKind,
    /// Mean angle by which the surface turns.
    pub(in crate::feature) angle: f64,
    /// The planes along it.
    pub(in crate::feature) planes: Vec<u32>,
}

impl Crease {
    /// Draws the first (0) or the last (1) end on to a position.
    pub(super) fn draw_to(&mut self, end: usize, position: Vec3) {
        let place = if end == 0 { 0 } else { self.polyline.len() };
        self.polyline.insert(place, position);
    }
}

/// What creases are looked for with.
pub(in crate::feature) struct CreaseSearch<'a> {
    pub(in crate::feature) partition: &'a Partition<'a>,
    /// The least angle by which the surface turns.
    pub(in crate::feature) angle: f64,
    /// The length at which the points tell directions.
    pub(in crate::feature) grain: f64,
    /// Points around a place that are looked at.
    pub(in crate::feature) around: usize,
    pub(in crate::feature) noise: f64,
    /// Edges that are known already.
    pub(in crate::feature) known: &'a [[Vec3; 2]],
}

/// Neighbourhoods that deviate from a plane by more than so many deviations of the noise may hold a crease.
const BENT: f64 = 1.5;
/// Neighbours that deviate by less than this are flat enough to tell a direction.
const FLAT: f64 = 1.35;
/// The fewest points of a side.
const LEAST_SIDE: usize = 7;
/// The largest deviation of the points of a side from its flat, over the noise.
const SIDE_NOISE: f64 = 1.5;
/// The largest share of points on neither side.
const STRAYS: f64 = 0.15;
/// The least share of a side's points on its own side of the crease.
const PURE: f64 = 0.85;
/// The farthest that a place lies from its foot, over the grain.
const NEAR: f64 = 1.5;
/// Feet within this distance of a known edge, over the grain, belong to it.
const KNOWN: f64 = 2.5;
/// Feet nearer than this, over the grain, are one.
const THIN: f64 = 1.2;
/// Feet farther apart than this, over the grain, are not joined.
const JOIN: f64 = 4.5;
/// Cosine of the largest turn of a polyline from foot to foot.
const BEND: f64 = 0.6;
/// The shortest crease, over the grain.
const SHORTEST: f64 = 6.0;

/// The creases, longest first.
pub(in crate::feature) fn creases(
    search: &CreaseSearch<'_>,
    outward: &(dyn Fn(Vec3) -> Option<Vec3> + Sync),
) -> Vec<Crease> {
    let partition = search.partition;
    let known = TriangleTree::from_segments(search.known);
    let limit = BENT * search.noise;
    let candidates: Vec<u32> = (0..partition.points.len() as u32)
        .into_par_iter()
        .filter(|&i| f64::from(partition.around.deviations[i as usize]) > limit)
        .collect();
    let feet: Vec<Foot> = candidates
        .par_iter()
        .map_init(Vec::new, |window, &i| search.foot(i as usize, window))
        .flatten_iter()
        .filter(|foot| known.closest_within(foot.position, KNOWN * search.grain).is_none())
        .collect();
    let feet = search.smoothed(&feet);
    let feet = search.thinned(feet);
    let mut creases: Vec<Crease> = search
        .chains(&feet)
        .into_iter()
        .map(|chain| search.crease(&feet, &chain, outward))
        .filter(|crease| length(&crease.polyline) >= SHORTEST * search.grain)
        .collect();
    creases.sort_by(|a, b| {
        length(&b.polyline)
            .total_cmp(&length(&a.polyline))
            .then_with(|| a.polyline[0].partial_cmp(&b.polyline[0]).expect("finite"))
    });
    creases
}

fn length(polyline: &[Vec3]) -> f64 {
    polyline.windows(2).map(|ends| vec3::distance(ends[0], ends[1])).sum()
}

/// One of two flats.
#[derive(Clone, Copy, Default)]
struct Side {
    normal: Vec3,
    offset: f64,
    deviation: f64,
    centre: Vec3,
    count: f64,
}

impl Side {
    fn distance(&self, p: Vec3) -> f64 {
        vec3::dot(self.normal, p) - self.offset
    }

    fn fitted(moments: &Moments) -> Option<Self> {
        let fit = moments.fit()?;
        let (deviation, centre) = (fit.deviations[0], fit.centre);
        Some(Self { normal: fit.normal, offset: fit.offset, deviation, centre, count: moments.count })
    }
}

impl CreaseSearch<'_> {
    /// The foot of a point on the crease through its surroundings.
    fn foot(&self, i: usize, window: &mut Vec<u32>) -> Option<Foot> {
        let partition = self.partition;
        self.gather(i, window);
        let sides = self.two_sides(window)?;
        let [a, b] = sides;
        let cross = vec3::cross(a.normal, b.normal);
        let direction = vec3::normalized(cross)?;
        let sine = vec3::norm(cross);
        if sine < 0.2 {
            return None;
        }
        // The foot: the point of both planes nearest to the place.
        let p = partition.points[i];
        let (da, db, cos) = (a.distance(p), b.distance(p), vec3::dot(a.normal, b.normal));
        let (s, t) = ((cos * db - da) / (sine * sine), (cos * da - db) / (sine * sine));
        let position = vec3::add_scaled(vec3::add_scaled(p, a.normal, s), b.normal, t);
        if vec3::distance(p, position) > NEAR * self.grain {
            return None;
        }
        // From the crease into either side.
        let into = sides.map(|side| {
            let d = vec3::sub(side.centre, position);
            vec3::normalized(vec3::add_scaled(d, direction, -vec3::dot(d, direction)))
        });
        let [u, v] = [into[0]?, into[1]?];
        let angle = std::f64::consts::PI - vec3::dot(u, v).clamp(-1.0, 1.0).acos();
        if angle < self.angle || !self.is_clean(window, &sides, position, [u, v]) {
            return None;
        }
        let planes = [0, 1].map(|side| self.plane_of(window, &sides, side));
        Some(Foot { position, direction, angle, opening: vec3::add(u, v), planes })
    }

    /// The point and those around it.
    fn gather(&self, i: usize, window: &mut Vec<u32>) {
        let around = self.partition.around;
        window.clear();
        window.push(i as u32);
        window.extend_from_slice(around.of(i));
        let mut head = 1;
        while window.len() < self.around && head < window.len() {
            for &j in around.of(window[head] as usize) {
                if !window.contains(&j) {
                    window.push(j);
                }
            }
            head += 1;
        }
    }

    /// Two flats that share the points of a window.
    fn two_sides(&self, window: &[u32]) -> Option<[Side; 2]> {
        let (points, around) = (self.partition.points, self.partition.around);
        let flat = FLAT * self.noise;
        let tellers: Vec<u32> =
            window.iter().copied().filter(|&j| f64::from(around.deviations[j as usize]) < flat).collect();
        if tellers.len() < 4 {
            return None;
        }
        // The two that differ most start the groups.
        let first = tellers[0];
        let cosine = |i: u32, j: u32| vec3::dot(around.normals[i as usize], around.normals[j as usize]).abs();
        let farthest = |from: u32| tellers.iter().copied().min_by(|&i, &j| cosine(from, i).total_cmp(&cosine(from, j)));
        let a = farthest(first)?;
        let b = farthest(a)?;
        if cosine(a, b) > 0.5 * (1.0 + self.angle.cos()) {
            return None;
        }
        let mut sums = [Moments::default(); 2];
        for &j in &tellers {
            sums[usize::from(cosine(a, j) < cosine(b, j))].add(points[j as usize]);
        }
        let start = |teller: u32, sum: &Moments| {
            let normal = around.normals[teller as usize];
            let centre = if sum.count > 0.0 { sum.centre() } else { points[teller as usize] };
            Side { normal, offset: vec3::dot(normal, centre), ..Side::default() }
        };
        let mut sides = [start(a, &sums[0]), start(b, &sums[1])];
        for _ in 0..6 {
            let mut sums = [Moments::default(); 2];
            for &j in window {
                let d = sides.map(|side| side.distance(points[j as usize]).abs());
                let nearer = usize::from(d[1] < d[0]);
                if d[nearer] < 3.0 * self.noise {
                    sums[nearer].add(points[j as usize]);
                }
            }
            if sums.iter().any(|s| (s.count as usize) < LEAST_SIDE) {
                return None;
            }
            sides = [Side::fitted(&sums[0])?, Side::fitted(&sums[1])?];
        }
        Some(sides)
    }

    /// Whether both flats hold their points, each on its own side of the crease.
    fn is_clean(&self, window: &[u32], sides: &[Side; 2], position: Vec3, into: [Vec3; 2]) -> bool {
        let held: f64 = sides.iter().map(|s| s.count).sum();
        if window.len() as f64 - held > STRAYS * window.len() as f64 {
            return false;
        }
        if sides.iter().any(|s| s.deviation > SIDE_NOISE * self.noise) {
            return false;
        }
        let mut wrong = [0.0; 2];
        for &j in window {
            let p = self.partition.points[j as usize];
            let d = sides.map(|side| side.distance(p).abs());
            let nearer = usize::from(d[1] < d[0]);
            if d[nearer] < 3.0 * self.noise && vec3::dot(vec3::sub(p, position), into[nearer]) < -self.noise {
                wrong[nearer] += 1.0;
            }
        }
        (0..2).all(|side| wrong[side] <= (1.0 - PURE) * sides[side].count)
    }

    /// The plane that most points of a side lie on.
    fn plane_of(&self, window: &[u32], sides: &[Side; 2], side: usize) -> u32 {
        let mut labels: Vec<u32> = window
            .iter()
            .filter(|&&j| {
                let p = self.partition.points[j as usize];
                let d = sides.map(|side| side.distance(p).abs());
                usize::from(d[1] < d[0]) == side && d[side] < 3.0 * self.noise
            })
            .map(|&j| self.partition.labels[j as usize])
            .collect();
        labels.sort_unstable();
        let most = labels.chunk_by(|a, b| a == b).max_by_key(|run| run.len());
        most.filter(|run| 2 * run.len() > labels.len()).map_or(NONE, |run| run[0])
    }

    /// Each foot moved, across its direction, to the mean of those around it with about its direction.
    fn smoothed(&self, feet: &[Foot]) -> Vec<Foot> {
        let tree = PointTree::new(&feet.iter().map(|f| f.position).collect::<Vec<_>>());
        let reach = (2.0 * self.grain).powi(2);
        feet.par_iter()
            .map_init(Vec::new, |found, foot| {
                tree.k_nearest(foot.position, 16, found);
                let (mut sum, mut direction, mut opening, mut angle) = ([0.0; 3], [0.0; 3], [0.0; 3], 0.0);
                let mut count = 0.0;
                for near in found.iter().filter(|n| n.distance_squared <= reach) {
                    let other = &feet[near.index];
                    let cos = vec3::dot(foot.direction, other.direction);
                    if cos.abs() < 0.8 {
                        continue;
                    }
                    sum = vec3::add(sum, vec3::sub(other.position, foot.position));
                    direction = vec3::add_scaled(direction, other.direction, cos.signum());
                    opening = vec3::add(opening, other.opening);
                    angle += other.angle;
                    count += 1.0;
                }
                let direction = vec3::normalized(direction).unwrap_or(foot.direction);
                let shift = vec3::scale(sum, 1.0 / count);
                let across = vec3::add_scaled(shift, direction, -vec3::dot(shift, direction));
                let position = vec3::add(foot.position, across);
                (Foot { position, direction, opening, angle: angle / count, ..*foot }, count)
            })
            // A crease leaves more than one mark.
            .filter(|(_, count)| *count >= 2.0)
            .map(|(foot, _)| foot)
            .collect()
    }

    /// Feet that are not nearer to one another than the thinning distance; sharper ones first.
    fn thinned(&self, mut feet: Vec<Foot>) -> Vec<Foot> {
        feet.sort_by(|a, b| {
            b.angle.total_cmp(&a.angle).then_with(|| a.position.partial_cmp(&b.position).expect("finite"))
        });
        let side = THIN * self.grain;
        let cell = |p: Vec3| p.map(|c| (c / side).floor() as i64);
        let mut cells: rustc_hash::FxHashMap<[i64; 3], Vec<usize>> = rustc_hash::FxHashMap::default();
        let mut kept: Vec<Foot> = Vec::new();
        for foot in feet {
            let [x, y, z] = cell(foot.position);
            let crowded = (0..27).any(|code| {
                let near = [x + code % 3 - 1, y + code / 3 % 3 - 1, z + code / 9 - 1];
                cells
                    .get(&near)
                    .is_some_and(|list| list.iter().any(|&k| vec3::distance(kept[k].position, foot.position) < side))
            });
            if !crowded {
                cells.entry([x, y, z]).or_default().push(kept.len());
                kept.push(foot);
            }
        }
        kept
    }

    /// Feet joined along their directions, each to at most one ahead and one behind: the nearest pairs first.
    fn chains(&self, feet: &[Foot]) -> Vec<Vec<usize>> {
        let tree = PointTree::new(&feet.iter().map(|f| f.position).collect::<Vec<_>>());
        let mut found = Vec::new();
        let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
        for (i, foot) in feet.iter().enumerate() {
            tree.k_nearest(foot.position, 10, &mut found);
            for near in found.iter().filter(|n| n.index != i) {
                let (i, j) = (near.index.min(i), near.index.max(i));
                let distance = near.distance_squared.sqrt();
                let Some(step) = vec3::normalized(vec3::sub(feet[j].position, feet[i].position)) else { continue };
                let cos = [i, j].map(|k| vec3::dot(feet[k].direction, step).abs());
                if distance <= JOIN * self.grain && cos[0].min(cos[1]) >= BEND {
                    pairs.push((distance * (3.0 - cos[0] - cos[1]), i, j));
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1, a.2).cmp(&(b.1, b.2))));
        pairs.dedup_by_key(|pair| (pair.1, pair.2));
        // Neighbours behind and ahead.
        let mut joined: Vec<[Option<usize>; 2]> = vec![[None; 2]; feet.len()];
        for (_, i, j) in pairs {
            let step = vec3::sub(feet[j].position, feet[i].position);
            let ahead = usize::from(vec3::dot(feet[i].direction, step) > 0.0);
            let behind = usize::from(vec3::dot(feet[j].direction, step) < 0.0);
            if joined[i][ahead].is_none() && joined[j][behind].is_none() {
                joined[i][ahead] = Some(j);
                joined[j][behind] = Some(i);
            }
        }
        let mut seen = vec![false; feet.len()];
        let mut chains = Vec::new();
        // From the ends of open chains first; what is left are rings.
        for rings in [false, true] {
            for start in 0..feet.len() {
                let links = joined[start].iter().flatten().count();
                if seen[start] || links == 0 || (!rings && links == 2) {
                    continue;
                }
                let mut chain = vec![start];
                seen[start] = true;
                let mut at = start;
                while let Some(next) = joined[at].iter().flatten().copied().find(|&n| !seen[n]) {
                    seen[next] = true;
                    chain.push(next);
                    at = next;
                }
                if rings && chain.len() > 2 {
                    chain.push(start);
                }
                chains.push(chain);
            }
        }
        chains
    }

    fn crease(&self, feet: &[Foot], chain: &[usize], outward: &dyn Fn(Vec3) -> Option<Vec3>) -> Crease {
        let polyline: Vec<Vec3> = chain.iter().map(|&f| feet[f].position).collect();
        let (mut votes, mut angle) = (0.0, 0.0);
        let mut planes: Vec<u32> = Vec::new();
        for foot in chain.iter().map(|&f| &feet[f]) {
            if let Some(direction) = outward(foot.position).and_then(vec3::normalized) {
                votes += vec3::dot(direction, foot.opening).signum();
            }
            angle += foot.angle;
            planes.extend(foot.planes.iter().filter(|&&plane| plane != NONE));
        }
        planes.sort_unstable();
        let n = chain.len();
        let planes = planes.chunk_by(|a, b| a == b).filter(|run| 2 * run.len() > n).map(|run| run[0]).collect();
        let kind = match votes {
            v if v > 0.2 * n as f64 => FeatureKind::Concave,
            v if v < -0.2 * n as f64 => FeatureKind::Convex,
            _ => FeatureKind::Unknown,
        };
        Crease { polyline, kind, angle: angle / n as f64, planes }
    }
}
