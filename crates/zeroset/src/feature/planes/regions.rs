//! Flat regions, grown from the flattest seeds.

use rayon::prelude::*;

use super::flatness::Bend;
use crate::feature::moments::{Fit, Moments};
use crate::feature::sharp::support::Flat;
use crate::feature::surroundings::Surroundings;
use crate::vec3::{self, Vec3};

/// The fewest points that a region grows to. A plane through fewer has no direction to speak of.
pub(in crate::feature) const LEAST_POINTS: usize = 15;
/// The fewest points that a region keeps. With 8, the stumps of walls that are seen from the air stand for whole walls.
const FEWEST: usize = 12;
/// The least evidence for a region: that of nine points which no other plane explains. With 30, false planes of 20 points across the edges of a
/// city stay; with 60, hips of 20 points go.
const LEAST_EVIDENCE: f64 = 50.0;
/// No region.
pub(in crate::feature) const NONE: u32 = u32::MAX;

/// Lengths and angles that decide what belongs to a region.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct Limits {
    /// Deviation of the points across the surface.
    pub(in crate::feature) noise: f64,
    /// The farthest that a point lies from its plane.
    pub(in crate::feature) distance: f64,
    /// Cosine of the largest angle between a plane and the surface around its points.
    pub(in crate::feature) cosine: f64,
    /// The fewest points of a region.
    pub(in crate::feature) least: usize,
    /// The direction to the sky, in scenes where walls stand upright and flats lie level unless their points say otherwise.
    pub(in crate::feature) up: Option<Vec3>,
    /// When a surface counts as bent.
    pub(in crate::feature) bend: Bend,
}

/// A plane is upright, or level, if its points do not contradict: the sum of squares grows by less than this many variances. By chance
/// alone, an upright plane loses more once in 400 times.
const CONTRADICTION: f64 = 9.0;

impl Limits {
    /// The plane of least squares; upright or level where that is as good.
    pub(in crate::feature) fn best_fit(&self, moments: &Moments) -> Option<Fit> {
        let free = moments.fit()?;
        let Some(up) = self.up else { return Some(free) };
        let variance = self.noise.max(free.deviations[0]).powi(2);
        let rise = vec3::dot(free.normal, up).abs();
        let least = moments.squares_off(free.normal, free.offset);
        let regular = if rise > 0.9 {
            Fit { normal: up, offset: vec3::dot(up, free.centre), ..free }
        } else if rise < 0.2 {
            moments.fit_along(up).unwrap_or(free)
        } else {
            return Some(free);
        };
        let gone = moments.squares_off(regular.normal, regular.offset) - least;
        Some(if gone < CONTRADICTION * variance { regular } else { free })
    }
}

/// Points that share a plane.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct Region {
    /// Unit normal; either of the two.
    pub(in crate::feature) normal: Vec3,
    /// `normal . x` on the plane.
    pub(in crate::feature) offset: f64,
    /// Number of points.
    pub(in crate::feature) count: usize,
    /// The logarithm of the likelihood of the points with it over that without it; known once it has been settled.
    pub(in crate::feature) evidence: f64,
}

impl Region {
    /// Signed distance from the plane.
    #[inline]
    pub(in crate::feature) fn distance(&self, p: Vec3) -> f64 {
        vec3::dot(self.normal, p) - self.offset
    }

    /// Its plane, without sides.
    pub(in crate::feature) fn flat(&self) -> Flat {
        Flat { normal: self.normal, offset: self.offset, oriented: false }
    }

    pub(in crate::feature) fn from_fit(fit: &Fit, count: usize) -> Self {
        Self { normal: fit.normal, offset: fit.offset, count, evidence: 0.0 }
    }

    /// Whether the points tell that it is there, and its direction.
    pub(in crate::feature) fn is_borne_out(&self, points: usize) -> bool {
        points >= FEWEST && self.evidence >= LEAST_EVIDENCE
    }
}

/// Which region each point belongs to.
#[derive(Debug)]
pub(in crate::feature) struct Partition<'a> {
    pub(in crate::feature) points: &'a [Vec3],
    pub(in crate::feature) around: &'a Surroundings,
    pub(in crate::feature) limits: Limits,
    /// The region of each point, or [`NONE`].
    pub(in crate::feature) labels: Vec<u32>,
    pub(in crate::feature) regions: Vec<Region>,
}

impl<'a> Partition<'a> {
    pub(in crate::feature) fn new(points: &'a [Vec3], around: &'a Surroundings, limits: Limits) -> Self {
        Self { points, around, limits, labels: vec![NONE; points.len()], regions: Vec::new() }
    }

    /// Grows regions over the points that have none, from the flattest seeds.
    pub(in crate::feature) fn grow(&mut self) {
        let flat = SEED_DEVIATION * self.limits.noise;
        let mut seeds: Vec<u32> = (0..self.points.len() as u32)
            .filter(|&i| self.labels[i as usize] == NONE && f64::from(self.around.deviations[i as usize]) <= flat)
            .collect();
        let deviation = |i: u32| self.around.deviations[i as usize];
        seeds.par_sort_unstable_by(|&a, &b| deviation(a).total_cmp(&deviation(b)).then(a.cmp(&b)));
        let mut queue = Vec::new();
        for seed in seeds {
            if self.labels[seed as usize] == NONE {
                self.grow_from(seed as usize, &mut queue);
            }
        }
    }

    /// Grows one region; gives its points back if they are too few.
    fn grow_from(&mut self, seed: usize, queue: &mut Vec<u32>) {
        let label = self.regions.len() as u32;
        let mut start = Moments::default();
        start.add(self.points[seed]);
        for &j in self.around.of(seed) {
            start.add(self.points[j as usize]);
        }
        let Some(fit) = start.fit() else { return };
        let mut region = Region::from_fit(&fit, 0);
        queue.clear();
        queue.push(seed as u32);
        self.labels[seed] = label;
        let (mut head, mut refit) = (0, FIRST_REFIT);
        let mut moments = Moments::default();
        while head < queue.len() {
            let i = queue[head] as usize;
            head += 1;
            moments.add(self.points[i]);
            if head == refit {
                refit *= 2;
                if let Some(fit) = moments.fit() {
                    region = Region::from_fit(&fit, 0);
                }
            }
            for &j in self.around.of(i) {
                let j = j as usize;
                if self.labels[j] == NONE && self.accepts(&region, j) {
                    self.labels[j] = label;
                    queue.push(j as u32);
                }
            }
        }
        if queue.len() < self.limits.least {
            for &i in &*queue {
                self.labels[i as usize] = NONE;
            }
            return;
        }
        if let Some(fit) = moments.fit() {
            region = Region::from_fit(&fit, queue.len());
        }
        self.regions.push(region);
    }

    /// Makes a region of points that have none.
    pub(in crate::feature) fn add(&mut self, members: &[u32]) {
        let mut moments = Moments::default();
        members.iter().for_each(|&i| moments.add(self.points[i as usize]));
        let Some(fit) = moments.fit() else { return };
        let label = self.regions.len() as u32;
        members.iter().for_each(|&i| self.labels[i as usize] = label);
        self.regions.push(Region::from_fit(&fit, members.len()));
    }

    /// Whether a point may join.
    fn accepts(&self, region: &Region, i: usize) -> bool {
        region.distance(self.points[i]).abs() < self.limits.distance
            && vec3::dot(region.normal, self.around.normals[i]).abs() > self.limits.cosine
    }

    /// Leaves out the regions that are refused, and numbers the others anew.
    pub(in crate::feature) fn retain(&mut self, keep: &[bool]) {
        let mut next = 0;
        let new: Vec<u32> = keep
            .iter()
            .map(|&keep| {
                if keep {
                    next += 1;
                    next - 1
                } else {
                    NONE
                }
            })
            .collect();
        self.labels.par_iter_mut().for_each(|label| {
            if *label != NONE {
                *label = new[*label as usize];
            }
        });
        let mut place = 0;
        self.regions.retain(|_| {
            place += 1;
            keep[place - 1]
        });
    }
}

/// Seeds are points whose neighbourhood is flat to so many deviations of the noise. Flat ones have 0.8 to 1.1.
const SEED_DEVIATION: f64 = 1.4;
/// Points of a growing region at which it is fitted for the first time; again whenever they have doubled.
const FIRST_REFIT: usize = 32;
