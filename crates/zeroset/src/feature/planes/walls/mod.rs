//! Walls that hold a few points only, as in clouds from the air: found where roofs end.
//!
//! # What
//! A scanner that looks down leaves walls almost bare, but it sees each roof up to its rim. Where the outline of a roof runs straight and
//! the next points beyond it lie lower, there is a wall under the rim. Its plane is upright; its line is the one that touches the roof
//! from outside, and the few points on the wall itself correct it.
//!
//! # Formula
//! In plan, outlines are cut into straight sides ([`outline`](super::outline)). The line of a side is the supporting line of the roof's
//! rim with the least mean distance from it: the edge of the rim's convex hull over the mean of its abscissas. Under uniform points it
//! lies within the wall by a share of the spacing only. Points of no other plane near it, y_i across and x_i along the line, then give
//! the correction a + b x that minimises sum_i (y_i - a - b x_i)^2 / noise^2 + (a^2 + (b L)^2 / 12) / trust^2, with residuals over three
//! deviations left out; `trust` is how well the rim is known.
//!
//! # Not guaranteed
//! Eaves that overhang put the wall under the rim, not where it stands. A side shorter than four spacings makes no wall. Where a roof is
//! hidden by trees, its outline ends at them, and no wall is made, as the points beyond are not lower.

mod trace;

use rayon::prelude::*;

use trace::{
    Piece, Planar, STRAIGHT, TRUST, Trace, along, dot, drop_doubles, meet, merged, minus, profile, rim, square,
};

use super::outline::{Ring, crossed_by_ray, outline, signed_area, simplified};
use super::polygons::PlaneFrame;
use super::regions::{NONE, Partition};
use crate::feature::sharp::support::Flat;
use crate::reconstruct::Up;
use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// A wall that was inferred.
#[derive(Debug, Clone)]
pub(in crate::feature) struct Wall {
    /// Its plane; the normal points away from the roof.
    pub(in crate::feature) flat: Flat,
    /// Its outline, counter-clockwise seen from outside.
    pub(in crate::feature) ring: Vec<Vec3>,
    /// Points that lie on it.
    pub(in crate::feature) points: Vec<u32>,
}

impl Wall {
    fn frame(&self) -> (PlaneFrame, Ring) {
        let frame = PlaneFrame::new(&self.flat, self.ring[0]);
        let ring = self.ring.iter().map(|&p| frame.flatten(p)).collect();
        (frame, ring)
    }

    /// Its area.
    pub(in crate::feature) fn area(&self) -> f64 {
        signed_area(&self.frame().1).abs()
    }

    /// Positions spread over it on a lattice.
    pub(in crate::feature) fn spread(&self, spacing: f64) -> Vec<Vec3> {
        let (frame, ring) = self.frame();
        let low = [0, 1].map(|c| ring.iter().map(|p| p[c]).fold(f64::INFINITY, f64::min));
        let high = [0, 1].map(|c| ring.iter().map(|p| p[c]).fold(f64::NEG_INFINITY, f64::max));
        let count = [0, 1].map(|c| ((high[c] - low[c]) / spacing).ceil().max(1.0) as usize);
        let place = |c: usize, i: usize| low[c] + (i as f64 + 0.5) * (high[c] - low[c]) / count[c] as f64;
        let all = (0..count[1]).flat_map(|j| (0..count[0]).map(move |i| [place(0, i), place(1, j)]));
        all.filter(|&p| is_inside(&ring, p)).map(|p| frame.lift(p)).collect()
    }
}

/// Whether a position lies inside a ring.
fn is_inside(ring: &[Planar], p: Planar) -> bool {
    let sides = ring.iter().zip(ring.iter().cycle().skip(1));
    sides.filter(|(a, b)| crossed_by_ray(p, [**a, **b])).count() % 2 == 1
}

/// What walls are inferred from.
pub(in crate::feature) struct Roofs<'a> {
    pub(in crate::feature) partition: &'a Partition<'a>,
    pub(in crate::feature) members: &'a [Vec<u32>],
    pub(in crate::feature) flats: &'a [Flat],
    pub(in crate::feature) spacing: f64,
    pub(in crate::feature) noise: f64,
    pub(in crate::feature) up: Up,
}

/// Rise of the normal over which a plane can be a roof, or ground.
const ROOF_RISE: f64 = 0.3;
/// Longest side of a triangle of the outline, over the spacing.
const REACH: f64 = 4.0;
/// The shortest side, over the spacing.
const SHORTEST: f64 = 4.0;
/// The least drop beyond a side, in spacings and in deviations of the noise.
const DROP_SPACINGS: f64 = 2.5;
const DROP_NOISES: f64 = 6.0;
/// Distances beyond a side at which the lower surface is looked for, over the spacing. Far ones cross the shadow that a building throws
/// when it is scanned aslant.
const AHEAD: [f64; 6] = [2.0, 4.0, 8.0, 16.0, 32.0, 64.0];
/// A surface that rises by no more than this over its distance goes on without a wall.
const GENTLE: f64 = 1.7;
/// A surface next to a rim that falls by no more than this over its distance may be the next roof.
const STEEPEST: f64 = 1.0;
/// The share of the places along a side that must drop.
const DROPPING: f64 = 0.6;
/// The share of all places along a side that must be seen to drop.
const SEEN: f64 = 0.3;
/// How many of these distances are looked at beyond a side of a single roof. The farther ones tell the outline of a building only.
const NEXT: usize = 2;

/// The walls under the rims of all roofs, by falling length.
pub(in crate::feature) fn walls(roofs: &Roofs<'_>) -> Vec<Wall> {
    let upright: Vec<Vec3> = roofs.partition.points.par_iter().map(|&p| roofs.up.upright(p)).collect();
    let plan = PointTree::new(&upright.iter().map(|p| [p[0], p[1], 0.0]).collect::<Vec<_>>());
    let site = Site { roofs, upright: &upright, plan: &plan };
    let (blobs, blob_of) = site.blobs();
    let mut traces: Vec<Trace> = blobs
        .par_iter()
        .enumerate()
        .flat_map_iter(|(number, members)| site.traces(members, &AHEAD, &|i| blob_of[i as usize] == number as u32))
        .chain((0..roofs.flats.len()).into_par_iter().flat_map_iter(|roof| {
            let is_roof = site.rise(roof) >= ROOF_RISE;
            let members: &[u32] = if is_roof { &roofs.members[roof] } else { &[] };
            site.traces(members, &AHEAD[..NEXT], &move |i| roofs.partition.labels[i as usize] == roof as u32)
        }))
        .collect();
    traces.sort_by(|a, b| b.length().total_cmp(&a.length()).then(a.origin.partial_cmp(&b.origin).expect("finite")));
    let mut walls = merged(traces, roofs.spacing);
    square(&mut walls, roofs.spacing);
    walls.par_iter_mut().for_each(|wall| site.correct(wall));
    walls.retain(|wall| !site.is_known(wall));
    drop_doubles(&mut walls, roofs.spacing);
    meet(&mut walls, roofs.spacing);
    walls.into_iter().map(|wall| site.finished(&wall)).collect()
}

struct Site<'a> {
    roofs: &'a Roofs<'a>,
    /// Points with z up.
    upright: &'a [Vec3],
    /// The points in plan.
    plan: &'a PointTree,
}

impl Site<'_> {
    /// How steeply the normal of a plane rises: the cosine of its slope.
    fn rise(&self, plane: usize) -> f64 {
        self.roofs.up.upright(self.roofs.flats[plane].normal)[2].abs()
    }

    /// Roofs that touch, as the points of all, and the number of that group for each point.
    ///
    /// The rim of a building is longer than the rims of its roofs, and so better known.
    fn blobs(&self) -> (Vec<Vec<u32>>, Vec<u32>) {
        let partition = self.roofs.partition;
        let is_roof: Vec<bool> = (0..self.roofs.flats.len()).map(|plane| self.rise(plane) >= ROOF_RISE).collect();
        let on_roof = |i: usize| partition.labels[i] != NONE && is_roof[partition.labels[i] as usize];
        let mut blob_of = vec![NONE; partition.points.len()];
        let mut blobs = Vec::new();
        for seed in 0..partition.points.len() {
            if blob_of[seed] != NONE || !on_roof(seed) {
                continue;
            }
            let number = blobs.len() as u32;
            blob_of[seed] = number;
            let mut members = vec![seed as u32];
            let mut head = 0;
            while head < members.len() {
                let i = members[head] as usize;
                head += 1;
                for &j in partition.around.of(i) {
                    let j = j as usize;
                    if blob_of[j] == NONE && on_roof(j) && self.is_gentle(i, j) {
                        blob_of[j] = number;
                        members.push(j as u32);
                    }
                }
            }
            blobs.push(members);
        }
        (blobs, blob_of)
    }

    /// Whether the surface may go on from one point to another without a wall.
    fn is_gentle(&self, i: usize, j: usize) -> bool {
        let d = crate::vec3::sub(self.upright[i], self.upright[j]);
        d[2].abs() <= GENTLE * d[0].hypot(d[1]) + 3.0 * self.roofs.noise
    }

    /// The sides of the outline of some points beyond which the surface drops.
    fn traces(&self, members: &[u32], aheads: &[f64], own: &dyn Fn(u32) -> bool) -> Vec<Trace> {
        let spacing = self.roofs.spacing;
        let points: Vec<Planar> = members.iter().map(|&i| self.upright[i as usize]).map(|p| [p[0], p[1]]).collect();
        let mut traces = Vec::new();
        for ring in outline(&points, REACH * spacing, (SHORTEST * spacing).powi(2)) {
            let corners = simplified(&ring, STRAIGHT * spacing);
            if corners.len() < 3 || signed_area(&corners) == 0.0 {
                continue;
            }
            for side in 0..corners.len() {
                traces.extend(self.trace(&ring, [corners[side], corners[(side + 1) % corners.len()]], aheads, own));
            }
        }
        traces
    }

    /// Height of the roof at a place of its rim: that of the plane of its nearest own point.
    fn height(&self, p: Planar, own: &dyn Fn(u32) -> bool) -> Option<f64> {
        let mut found = Vec::new();
        self.plan.k_nearest([p[0], p[1], 0.0], 12, &mut found);
        let nearest = found.iter().find(|n| own(n.index as u32))?;
        let flat = &self.roofs.flats[self.roofs.partition.labels[nearest.index] as usize];
        let normal = self.roofs.up.upright(flat.normal);
        Some((flat.offset - normal[0] * p[0] - normal[1] * p[1]) / normal[2])
    }

    fn trace(&self, ring: &[Planar], ends: [Planar; 2], aheads: &[f64], own: &dyn Fn(u32) -> bool) -> Option<Trace> {
        let spacing = self.roofs.spacing;
        let d = minus(ends[1], ends[0]);
        let length = d[0].hypot(d[1]);
        if length < SHORTEST * spacing {
            return None;
        }
        let (origin, direction) = rim(ring, ends, length, spacing)?;
        let mut trace = Trace { origin, direction, pieces: Vec::new() };
        let at = ends.map(|end| dot(minus(end, origin), direction));
        let places = ((at[1] - at[0]) / (1.5 * spacing)).ceil().max(2.0);
        let least = (DROP_SPACINGS * spacing).max(DROP_NOISES * self.roofs.noise);
        let (mut below, mut rim) = (Vec::new(), Vec::new());
        let (mut drops, mut seen) = (0.0, 0.0);
        for place in 0..places as usize {
            let t = at[0] + (place as f64 + 0.5) / places * (at[1] - at[0]);
            let foot = along(origin, direction, t);
            let Some(height) = self.height(foot, own) else { continue };
            rim.push((t, height));
            let Some((lower, reach)) = self.beyond(foot, trace.outward(), aheads, own) else { continue };
            seen += 1.0;
            if height - lower > least + STEEPEST * reach.min(AHEAD[1] * spacing) {
                drops += 1.0;
                below.push(lower);
            }
        }
        if drops < (DROPPING * seen).max(SEEN * places) || below.len() < 2 {
            return None;
        }
        let middle = below.len() / 2;
        let bottom = *below.select_nth_unstable_by(middle, f64::total_cmp).1;
        let tops = profile(&rim, at, self.roofs.noise.max(0.3 * spacing));
        trace.pieces.extend(tops.windows(2).map(|w| Piece { ends: [w[0].0, w[1].0], top: [w[0].1, w[1].1], bottom }));
        Some(trace)
    }

    /// Height of the nearest surface beyond a place of a rim, and how far out it was looked for.
    fn beyond(&self, foot: Planar, outward: Planar, aheads: &[f64], own: &dyn Fn(u32) -> bool) -> Option<(f64, f64)> {
        let mut found = Vec::new();
        for ahead in aheads {
            let reach = ahead * self.roofs.spacing;
            let q = along(foot, outward, reach);
            self.plan.k_nearest([q[0], q[1], 0.0], 6, &mut found);
            let mut heights: Vec<f64> = found
                .iter()
                .filter(|n| n.distance_squared <= (0.5 * reach).powi(2).max(self.roofs.spacing.powi(2)))
                .filter(|n| !own(n.index as u32))
                .map(|n| self.upright[n.index][2])
                .collect();
            if heights.len() >= 2 {
                let middle = heights.len() / 2;
                return Some((*heights.select_nth_unstable_by(middle, f64::total_cmp).1, reach));
            }
        }
        None
    }

    /// The points that no other plane explains and that may lie on a wall.
    fn candidates(&self, wall: &Trace) -> Vec<(u32, f64, f64)> {
        let spacing = self.roofs.spacing;
        let [low, high] = wall.ends();
        let (mut near, mut found) = (Vec::new(), Vec::new());
        let steps = ((high - low) / (2.0 * spacing)).ceil().max(1.0);
        for step in 0..=steps as usize {
            let q = along(wall.origin, wall.direction, low + step as f64 / steps * (high - low));
            self.plan.k_nearest([q[0], q[1], 0.0], 24, &mut found);
            near.extend(found.iter().map(|n| n.index as u32));
        }
        near.sort_unstable();
        near.dedup();
        let bottom = wall.pieces.iter().map(|p| p.bottom).fold(f64::INFINITY, f64::min);
        let top = wall.pieces.iter().flat_map(|p| p.top).fold(f64::NEG_INFINITY, f64::max);
        let margin = 3.0 * self.roofs.noise;
        near.into_iter()
            .filter(|&i| self.roofs.partition.labels[i as usize] == NONE)
            .filter_map(|i| {
                let [x, y, z] = self.upright[i as usize];
                let d = minus([x, y], wall.origin);
                let (t, off) = (dot(d, wall.direction), dot(d, wall.outward()));
                let is_near = off.abs() < spacing.max(margin) && t > low - spacing && t < high + spacing;
                (is_near && z > bottom + margin && z < top - margin).then_some((i, t, off))
            })
            .collect()
    }

    /// Moves a wall to the points on it.
    fn correct(&self, wall: &mut Trace) {
        let [low, high] = wall.ends();
        let (middle, length) = (0.5 * (low + high), high - low);
        let candidates = self.candidates(wall);
        if candidates.is_empty() {
            return;
        }
        let (trust, noise) = (TRUST * self.roofs.spacing, self.roofs.noise);
        let (mut a, mut b) = (0.0, 0.0);
        for _ in 0..5 {
            let (mut ata, mut atb, mut rhs) =
                ([1.0 / trust.powi(2), 0.0], length.powi(2) / 12.0 / trust.powi(2), [0.0; 2]);
            for &(_, t, off) in &candidates {
                let t = t - middle;
                if (off - a - b * t).abs() > 3.0 * noise.max(0.3 * trust) {
                    continue;
                }
                let w = 1.0 / noise.powi(2);
                ata[0] += w;
                ata[1] += w * t;
                atb += w * t * t;
                rhs[0] += w * off;
                rhs[1] += w * off * t;
            }
            let determinant = ata[0] * atb - ata[1] * ata[1];
            a = (atb * rhs[0] - ata[1] * rhs[1]) / determinant;
            b = (ata[0] * rhs[1] - ata[1] * rhs[0]) / determinant;
        }
        let outward = wall.outward();
        let origin = along(along(wall.origin, wall.direction, middle), outward, a);
        let turned = along(wall.direction, outward, b);
        let scale = 1.0 / turned[0].hypot(turned[1]);
        *wall = wall.clone().moved_to(origin, turned.map(|c| c * scale));
    }

    /// Whether a plane of the cloud stands there already.
    fn is_known(&self, wall: &Trace) -> bool {
        let spacing = self.roofs.spacing;
        let outward = wall.outward();
        let [low, high] = wall.ends();
        self.roofs.flats.iter().zip(self.roofs.members).any(|(flat, members)| {
            let normal = self.roofs.up.upright(flat.normal);
            if (normal[0] * outward[0] + normal[1] * outward[1]).abs() < 0.97 {
                return false;
            }
            let place = |t: f64| along(wall.origin, wall.direction, t);
            let off = |p: Planar| (normal[0] * p[0] + normal[1] * p[1] - flat.offset).abs();
            // The offset is that of an upright plane, up to its lean over the height of the wall.
            if off(place(low)).max(off(place(high))) > 2.0 * spacing {
                return false;
            }
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for &i in members {
                let [x, y, _] = self.upright[i as usize];
                let t = dot(minus([x, y], wall.origin), wall.direction);
                (least, most) = (least.min(t), most.max(t));
            }
            most.min(high) - least.max(low) > 0.5 * (high - low)
        })
    }

    fn finished(&self, wall: &Trace) -> Wall {
        let outward = wall.outward();
        let lift = |t: f64, z: f64| {
            let p = along(wall.origin, wall.direction, t);
            self.roofs.up.restore([p[0], p[1], z])
        };
        let (bottom, top) = wall.profiles();
        let mut ring: Vec<Vec3> = bottom.into_iter().map(|(t, z)| lift(t, z)).collect();
        ring.extend(top.into_iter().rev().map(|(t, z)| lift(t, z)));
        ring.dedup();
        let flat = Flat {
            normal: self.roofs.up.restore([outward[0], outward[1], 0.0]),
            offset: dot(wall.origin, outward),
            oriented: true,
        };
        let limit = 3.0 * self.roofs.noise;
        let points = self.candidates(wall).into_iter().filter(|c| c.2.abs() <= limit).map(|c| c.0).collect();
        Wall { flat, ring, points }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wall_spreads_points_over_its_ring_only() {
        let ring = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 0.0, 2.0], [2.0, 0.0, 4.0], [0.0, 0.0, 2.0]];
        let flat = Flat { normal: [0.0, -1.0, 0.0], offset: 0.0, oriented: true };
        let wall = Wall { flat, ring, points: Vec::new() };
        assert!((wall.area() - 12.0).abs() < 1e-12);
        let points = wall.spread(0.25);
        assert!((points.len() as f64 * 0.0625 / 12.0 - 1.0).abs() < 0.1, "{}", points.len());
        assert!(points.iter().all(|p| p[1] == 0.0 && p[2] < 4.0 - (p[0] - 2.0).abs() + 1e-9));
    }
}
