//! Small planes hidden among their neighbours: found where the planes around explain the points badly.
//!
//! # What
//! On the hip of a small roof no point has all of its neighbours on the hip, so nothing grows there; and the planes around, which run on
//! beyond their edges, hold half of its points by chance, so that too few are left over. But they hold them badly. Where a point and its
//! neighbours cost the planes much more than noise does, planes through three of the badly explained points are tried, and the one that
//! explains the points best is kept if it gains enough, and if no smooth surface would do as well.
//!
//! # Formula
//! A point at the distance d from the nearest plane around costs min(d^2 / 2 sigma^2, c), with c the cost of a stray. A plane gains what it
//! saves on the points that it explains better: the logarithm of a ratio of likelihoods.
//!
//! # Cost
//! Proportional to the number of places that are explained badly.
//!
//! # Not guaranteed
//! What lies among strays is passed over as clutter: a small plane under a tree is not found. Nor is any looked for where the noise is over 0.3 of the
//! spacing.
//!
//! # Source
//! Planes through three points: Fischler and Bolles 1981. Gains against the other models, not counts of points: Isack and Boykov, "Energy-based
//! geometric multi-model fitting", 2012.

use rayon::prelude::*;
use rustc_hash::FxHashSet;

use super::flatness::variance_off_quadric;
use super::regions::{NONE, Partition, Region};
use crate::feature::moments::Moments;
use crate::vec3::{self, Vec3};

/// What a point and its neighbours cost beyond the mean of noise, for a plane to be looked for among them. Noise costs them as much once in
/// 10^5 times.
const SUSPICIOUS: f64 = 20.0;
/// Points that are looked at around a place.
const WINDOW: usize = 64;
/// The largest share of the points around that belongs to no plane.
const CLUTTER: f64 = 0.15;
/// A point that costs more is explained badly; one in ten is by chance.
const BADLY: f64 = 1.35;
/// Planes that are tried at a place. If half of the badly explained points lie on a plane, one trial in ten hits it.
const TRIALS: usize = 150;
/// Times that the best of them is fitted again.
const REFITS: usize = 4;
/// The least gain of a plane. Hips of 20 to 40 points gain 45 to 90; with 15, planes that are not there appear.
const LEAST_GAIN: f64 = 30.0;

/// A plane that would explain some points better.
struct Proposal {
    region: Region,
    gain: f64,
    /// The points around the place, which comes first.
    window: Vec<u32>,
}

impl Partition<'_> {
    /// Adds planes where they explain the points much better than those that are there.
    pub(in crate::feature) fn add_hidden(&mut self) {
        let mut costs = self.costs();
        let places = self.suspicious(&costs);
        let mut found: Vec<Proposal> = places.into_par_iter().filter_map(|place| self.propose(place, &costs)).collect();
        found.sort_by(|a, b| b.gain.total_cmp(&a.gain).then(a.window[0].cmp(&b.window[0])));
        for Proposal { mut region, window, .. } in found {
            // What a better one explains does not count again.
            if self.gain(&region, &window, &costs) < LEAST_GAIN {
                continue;
            }
            let label = self.regions.len() as u32;
            for i in window.into_iter().map(|i| i as usize) {
                let cost = self.cost(&region, i);
                if cost < costs[i] {
                    (costs[i], self.labels[i]) = (cost, label);
                    region.count += 1;
                }
            }
            self.regions.push(region);
        }
    }

    /// What a plane saves on some points.
    fn gain(&self, region: &Region, window: &[u32], costs: &[f64]) -> f64 {
        window.iter().map(|&i| (costs[i as usize] - self.cost(region, i as usize)).max(0.0)).sum()
    }

    /// The points around which more is explained badly than around any of their neighbours.
    fn suspicious(&self, costs: &[f64]) -> Vec<u32> {
        let around = |i: usize| std::iter::once(i).chain(self.around.of(i).iter().map(|&j| j as usize));
        let n = self.points.len();
        let excess: Vec<f64> = (0..n).into_par_iter().map(|i| around(i).map(|j| costs[j] - 0.5).sum()).collect();
        let is_worst = |i: usize| around(i).all(|j| (excess[j], i) <= (excess[i], j));
        (0..n).into_par_iter().filter(|&i| excess[i] >= SUSPICIOUS && is_worst(i)).map(|i| i as u32).collect()
    }

    /// The plane that gains most around a place.
    fn propose(&self, place: u32, costs: &[f64]) -> Option<Proposal> {
        let window = self.window(place);
        let strays = window.iter().filter(|&&i| self.labels[i as usize] == NONE).count();
        if strays as f64 > CLUTTER * window.len() as f64 {
            return None;
        }
        let least = self.limits.bend.around_hidden * self.limits.noise.powi(2);
        if variance_off_quadric(self, &window)? < least {
            return None;
        }
        let (_, mut region) = self.best_of_trials(&window, costs)?;
        for _ in 0..REFITS {
            let mut moments = Moments::default();
            for i in window.iter().map(|&i| i as usize) {
                moments.add_weighted(self.points[i], 1.0 / (1.0 + (self.cost(&region, i) - costs[i]).exp()));
            }
            region = Region::from_fit(&moments.fit()?, 0);
        }
        let gain = self.gain(&region, &window, costs);
        (gain >= LEAST_GAIN).then_some(Proposal { region, gain, window })
    }

    /// Of planes through three badly explained points the one that gains most, with its gain.
    fn best_of_trials(&self, window: &[u32], costs: &[f64]) -> Option<(f64, Region)> {
        let badly: Vec<u32> = window.iter().copied().filter(|&i| costs[i as usize] > BADLY).collect();
        if badly.len() < 3 {
            return None;
        }
        let mut state = 1_u64;
        let mut draw = || {
            // Knuth's congruential generator; its high bits are the good ones.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            self.points[badly[((state >> 33) as usize * badly.len()) >> 31] as usize]
        };
        let mut best: Option<(f64, Region)> = None;
        for _ in 0..TRIALS {
            let [p, q, r]: [Vec3; 3] = std::array::from_fn(|_| draw());
            let Some(normal) = vec3::normalized(vec3::cross(vec3::sub(q, p), vec3::sub(r, p))) else { continue };
            let region = Region { normal, offset: vec3::dot(normal, p), count: 0, evidence: 0.0 };
            let gain = self.gain(&region, window, costs);
            if best.as_ref().is_none_or(|best| gain > best.0) {
                best = Some((gain, region));
            }
        }
        best
    }

    /// The points around a point, itself first.
    fn window(&self, place: u32) -> Vec<u32> {
        let mut window = vec![place];
        let mut known: FxHashSet<u32> = window.iter().copied().collect();
        let mut head = 0;
        while head < window.len() && window.len() < WINDOW {
            let around = self.around.of(window[head] as usize);
            window.extend(around.iter().filter(|&&j| known.insert(j)));
            head += 1;
        }
        window
    }
}
