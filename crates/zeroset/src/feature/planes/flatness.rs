//! Which regions are flat, and not parts of something curved or of clutter.

use nalgebra::{Matrix6, Vector6};
use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::regions::{NONE, Partition};
use super::settle::STRAY;
use crate::feature::moments::{Fit, Moments};
use crate::feature::surroundings::NEIGHBOURS;
use crate::vec3::{self, Vec3};

/// When a surface counts as bent.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct Bend {
    /// A quadric that leaves so many times smaller residuals than the plane, around a region, explains the surface there better.
    ratio: f64,
    /// The residuals that it leaves, over those of the region's own points from their plane, at most: else it explains nothing.
    fits: f64,
    /// The sum of squares that it leaves, over that which the planes around leave, at most: else they explain the surface better. A quadric around a
    /// hip between roofs leaves 1.4 times as much, on spheres up to 1.25, on organic shapes up to 2.3.
    over_planes: f64,
    /// The mean square that it leaves around a plane hidden among others, in variances of the noise, at least. Around hips it is 2.1 to 4,
    /// on spheres and tori up to 1.7, on organic shapes up to 3.
    pub(super) around_hidden: f64,
    /// Whether the surface may be round: then it also counts what a quadric wins against the noise.
    may_be_round: bool,
}

impl Bend {
    /// For bodies, which are round as often as flat.
    pub(in crate::feature) const OF_BODIES: Self =
        Self { ratio: 1.2, fits: 1.8, over_planes: 2.5, around_hidden: 3.0, may_be_round: true };
    /// For terrain, where roofs are flat and what stands on them spoils the fit of any quadric. With the values for bodies a tenth of
    /// the roofs of a real town are lost.
    pub(in crate::feature) const OF_TERRAIN: Self =
        Self { ratio: 1.5, fits: 1.2, over_planes: 1.2, around_hidden: 2.0, may_be_round: false };
}

/// What a quadric must win for a region to be round.
#[derive(Debug, Clone, Copy)]
struct Evidence {
    /// Of the sum of squares of the region's own points, in variances that it leaves.
    by_itself: f64,
    /// Sum of squares of the plane over that of the quadric, on the region's own points.
    sagging: f64,
    /// The same in a window around the region.
    around: f64,
    /// The variance that it leaves in the window, over that of the noise, at most.
    noise_alone: f64,
}

impl Evidence {
    /// Of any region. Three more parameters win 16 variances once in a thousand times by chance, and a large face may be seen to sag by less
    /// than its noise.
    const ALONE: Self = Self { by_itself: 16.0, sagging: 1.1, around: 1.44, noise_alone: 1.35 };
    /// Of a region that borders on others that are round: it is likely to be round, too.
    const BESIDE_ROUND: Self = Self { by_itself: 6.0, sagging: 1.03, around: 1.1, noise_alone: 1.5 };
}

/// The share of a region's neighbours in other regions, or in none, that lie on what is round, from which the region borders on it.
const BESIDE: f64 = 0.2;

/// That much of the sum of squares must be won, in variances of the noise, for the quadric not to win by chance: with three more
/// parameters, 25 is won once in 10^5 times.
const BY_CHANCE: f64 = 25.0;
/// In deviations of a mean of squares: how much worse the region's own points may lie on it than the others.
const NO_WORSE: f64 = 2.5;
/// On the region's own points the quadric of the wider surroundings may leave so many times the residuals of the plane. A flat face
/// that runs into a round one is not explained by the quadric of both.
const AS_GOOD: f64 = 1.08;
/// So many variances of the points from the plane are allowed besides: the plane was chosen to suit these points.
const SELECTED: f64 = 40.0;
/// The surroundings that are looked at hold so many times the points of the region: narrow ones, as no quadric suits a wide part of an
/// organic shape, and wide ones, as a patch of a sphere is told from flat only when its height is some deviations of the noise.
const WIDER: [f64; 3] = [1.5, 2.5, 4.0];
/// Where only noise is left, wider ones tell more.
const WIDEST: f64 = 8.0;
/// Points of the windows on a region.
const WINDOWS: [usize; 3] = [100, 200, 400];
/// Regions of more points are wide by themselves.
const WIDE_ENOUGH: usize = 20_000;
/// A larger region is looked at in one window for so many of its points, up to a number of windows.
const WINDOW_SHARE: usize = 150;
const MOST_WINDOWS: usize = 12;
/// Cosine of the angle from the region's normal up to which the surface goes on smoothly.
const SMOOTH: f64 = 0.87;
/// The largest share of the neighbours of a region that belong to none.
const CLUTTER: f64 = 0.35;
/// The least mean cosine between the normals around the points and that of the plane.
const ALIGNED: f64 = 0.8;
/// The deviation along the shorter axis of a region over that across it. A strip that is one noise wide has no direction.
const LEAST_WIDTH: f64 = 3.0;

/// For each region whether it is flat.
pub(in crate::feature) fn flat_regions(partition: &Partition<'_>) -> Vec<bool> {
    let members = members(partition);
    let mut keep: Vec<bool> =
        members.par_iter().enumerate().map(|(region, points)| is_flat(partition, region, points)).collect();
    if partition.limits.bend.may_be_round {
        give_up_beside_round(partition, &members, &mut keep);
    }
    keep
}

/// Under much noise each strip of a narrow cylinder alone is nearly flat: some are found out, and then those beside them.
fn give_up_beside_round(partition: &Partition<'_>, members: &[Vec<u32>], keep: &mut [bool]) {
    loop {
        let round: Vec<bool> = (0..members.len())
            .into_par_iter()
            .map(|region| keep[region] && continues_round(partition, region, &members[region], keep))
            .collect();
        if !round.contains(&true) {
            return;
        }
        keep.iter_mut().zip(round).for_each(|(keep, round)| *keep &= !round);
    }
}

/// Whether a region borders on regions that are given up, and may be round as well.
fn continues_round(partition: &Partition<'_>, region: usize, members: &[u32], keep: &[bool]) -> bool {
    let (mut others, mut round) = (0, 0);
    for &j in members.iter().flat_map(|&i| partition.around.of(i as usize)) {
        let label = partition.labels[j as usize];
        if label != region as u32 {
            others += 1;
            round += usize::from(label != NONE && !keep[label as usize]);
        }
    }
    if (round as f64) < BESIDE * f64::from(others) {
        return false;
    }
    let mut moments = Moments::default();
    members.iter().for_each(|&i| moments.add(partition.points[i as usize]));
    moments.fit().is_none_or(|fit| is_round(partition, &fit, members, &Evidence::BESIDE_ROUND))
}

/// The points of each region, ascending.
pub(in crate::feature) fn members(partition: &Partition<'_>) -> Vec<Vec<u32>> {
    let mut members: Vec<Vec<u32>> = partition.regions.iter().map(|r| Vec::with_capacity(r.count)).collect();
    for (i, &label) in partition.labels.iter().enumerate() {
        if label != NONE {
            members[label as usize].push(i as u32);
        }
    }
    members
}

fn is_flat(partition: &Partition<'_>, region: usize, members: &[u32]) -> bool {
    let normal = partition.regions[region].normal;
    let mut moments = Moments::default();
    let mut aligned = 0.0;
    for &i in members {
        moments.add(partition.points[i as usize]);
        aligned += vec3::dot(partition.around.normals[i as usize], normal).abs();
    }
    let Some(fit) = moments.fit() else { return false };
    fit.deviations[1] > LEAST_WIDTH * fit.deviations[0]
        && aligned > ALIGNED * members.len() as f64
        && !is_curved(partition, region, &fit, members)
        && !(partition.limits.bend.may_be_round && is_round(partition, &fit, members, &Evidence::ALONE))
}

/// For each region whether its points are neighbours of one another, and not scattered among points of no region.
pub(in crate::feature) fn dense_regions(partition: &Partition<'_>) -> Vec<bool> {
    let is_dense = |members: Vec<u32>| {
        let mut strangers = 0;
        for &i in &members {
            let around = partition.around.of(i as usize);
            strangers += around.iter().filter(|&&j| partition.labels[j as usize] == NONE).count();
        }
        (strangers as f64) < CLUTTER * (members.len() * NEIGHBOURS) as f64
    };
    members(partition).into_par_iter().map(is_dense).collect()
}

/// Whether a quadric explains the region, and the surface that goes on around it, better than the plane: as a whole, or in most of
/// the windows on a larger one. A ring around the top of a torus is no quadric, but its pieces are.
fn is_curved(partition: &Partition<'_>, region: usize, fit: &Fit, members: &[u32]) -> bool {
    let n = members.len();
    let whole = |wanted: usize| {
        curves(partition, region, fit, &surroundings(partition, fit.normal, members.to_vec(), wanted.max(n)))
    };
    if n <= WIDE_ENOUGH && WIDER.iter().any(|times| whole((times * n as f64) as usize)) {
        return true;
    }
    let count = (n / WINDOW_SHARE).clamp(1, MOST_WINDOWS);
    WINDOWS.iter().any(|&points| {
        let seeds = (0..count).map(|w| members[(2 * w + 1) * n / (2 * count)]);
        let curved = seeds
            .filter(|&seed| curves(partition, region, fit, &surroundings(partition, fit.normal, vec![seed], points)))
            .count();
        2 * curved > count
    })
}

/// Whether a quadric explains the region's own points better than the plane, or leaves no more than noise in its wider surroundings.
fn is_round(partition: &Partition<'_>, fit: &Fit, members: &[u32], evidence: &Evidence) -> bool {
    let n = members.len();
    let height = Heights::new(fit, partition);
    let own = height.sums(members.iter().copied());
    let Some(quadric) = own.quadric() else { return false };
    let (flat, curved) = (own.flat_squares(), own.squares(&quadric));
    let variance = curved / (n as f64 - 6.0);
    if flat - curved > evidence.by_itself * variance && flat > evidence.sagging * curved {
        return true;
    }
    let variance = partition.limits.noise.powi(2);
    n <= WIDE_ENOUGH
        && WIDER.into_iter().chain([WIDEST]).any(|times| {
            let window = surroundings(partition, fit.normal, members.to_vec(), (times * n as f64) as usize);
            let all = height.sums(window.into_iter());
            let Some(quadric) = all.quadric() else { return false };
            let (flat, curved) = (all.flat_squares(), all.squares(&quadric));
            let mean = curved / all.gram[(0, 0)];
            let no_worse = (1.0 + NO_WORSE * (2.0 / n as f64).sqrt()) * mean * n as f64;
            mean < evidence.noise_alone * variance
                && flat > evidence.around * curved
                && flat - curved > BY_CHANCE * variance
                && own.squares(&quadric) < no_worse
        })
}

/// Whether a quadric explains the surface in a window better than a plane does, and the region's points there about as well.
fn curves(partition: &Partition<'_>, region: usize, fit: &Fit, window: &[u32]) -> bool {
    let height = Heights::new(fit, partition);
    let all = height.sums(window.iter().copied());
    let Some(quadric) = all.quadric() else { return false };
    let (flat, curved) = (all.flat_squares(), all.squares(&quadric));
    let noise = partition.limits.noise;
    let Bend { ratio, fits, over_planes, .. } = partition.limits.bend;
    if flat < ratio * ratio * curved
        || flat - curved < BY_CHANCE * noise * noise
        || curved > over_planes * squares_of_planes(partition, window)
    {
        return false;
    }
    let own = height.sums(window.iter().copied().filter(|&i| partition.labels[i as usize] == region as u32));
    let (flat, count) = (own.flat_squares(), own.gram[(0, 0)]);
    if curved * count > fits * fits * flat * all.gram[(0, 0)] {
        return false;
    }
    own.squares(&quadric) < (AS_GOOD * AS_GOOD + SELECTED / count) * flat
}

/// Sum of the squared distances of some points from the planes that they belong to.
fn squares_of_planes(partition: &Partition<'_>, window: &[u32]) -> f64 {
    let off = |&i: &u32| match partition.labels[i as usize] {
        NONE => STRAY * partition.limits.noise,
        label => partition.regions[label as usize].distance(partition.points[i as usize]),
    };
    window.iter().map(|i| off(i).powi(2)).sum()
}

/// The variance that the quadric of least squares leaves of some points.
pub(super) fn variance_off_quadric(partition: &Partition<'_>, window: &[u32]) -> Option<f64> {
    let mut moments = Moments::default();
    window.iter().for_each(|&i| moments.add(partition.points[i as usize]));
    let sums = Heights::new(&moments.fit()?, partition).sums(window.iter().copied());
    Some(sums.squares(&sums.quadric()?) / window.len() as f64)
}

/// The points and those around them that the surface reaches without a sharp turn, up to a number.
fn surroundings(partition: &Partition<'_>, normal: Vec3, mut window: Vec<u32>, wanted: usize) -> Vec<u32> {
    let mut known: FxHashSet<u32> = window.iter().copied().collect();
    let mut head = 0;
    while head < window.len() && window.len() < wanted {
        for &j in partition.around.of(window[head] as usize) {
            if vec3::dot(partition.around.normals[j as usize], normal).abs() > SMOOTH && known.insert(j) {
                window.push(j);
            }
        }
        head += 1;
    }
    window
}

/// Sums over points from which the quadric of least squares follows: the height over a plane as a polynomial of degree 2.
struct HeightSums {
    gram: Matrix6<f64>,
    right: Vector6<f64>,
    total: f64,
}

/// Measures heights over the plane of a region.
struct Heights<'a> {
    points: &'a [Vec3],
    frame: [Vec3; 3],
    centre: Vec3,
    scale: f64,
}

impl<'a> Heights<'a> {
    fn new(fit: &Fit, partition: &Partition<'a>) -> Self {
        let [u, v] = vec3::axes_across(fit.normal);
        let scale = fit.deviations[2].max(f64::MIN_POSITIVE);
        Self { points: partition.points, frame: [u, v, fit.normal], centre: fit.centre, scale }
    }

    fn sums(&self, members: impl Iterator<Item = u32>) -> HeightSums {
        let mut sums = HeightSums { gram: Matrix6::zeros(), right: Vector6::zeros(), total: 0.0 };
        let [u, v, normal] = self.frame;
        for i in members {
            let d = vec3::sub(self.points[i as usize], self.centre);
            let (x, y, z) = (vec3::dot(d, u) / self.scale, vec3::dot(d, v) / self.scale, vec3::dot(d, normal));
            let row = Vector6::new(1.0, x, y, x * x, x * y, y * y);
            sums.gram += row * row.transpose();
            sums.right += row * z;
            sums.total += z * z;
        }
        sums
    }
}

impl HeightSums {
    fn quadric(&self) -> Option<Vector6<f64>> {
        Some(self.gram.cholesky()?.solve(&self.right))
    }

    /// Sum of the squared residuals of a quadric.
    fn squares(&self, quadric: &Vector6<f64>) -> f64 {
        (self.total - 2.0 * self.right.dot(quadric) + quadric.dot(&(self.gram * quadric))).max(0.0)
    }

    /// Sum of the squared residuals of the plane of least squares.
    fn flat_squares(&self) -> f64 {
        let gram = self.gram.fixed_view::<3, 3>(0, 0).into_owned();
        let right = self.right.fixed_rows::<3>(0).into_owned();
        gram.cholesky().map_or(self.total, |c| (self.total - right.dot(&c.solve(&right))).max(0.0))
    }
}
