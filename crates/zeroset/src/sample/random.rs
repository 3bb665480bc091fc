//! Random numbers that do not depend on the number of threads.

use crate::vec3::Vec3;
use rand::RngExt;
use rand_pcg::Pcg64;

/// How many random points share one generator. Work is cut into chunks of this size whatever the number of threads.
pub(super) const CHUNK: usize = 1 << 15;

/// A generator of uniform and normal numbers, one for each chunk of work.
pub(crate) struct Chance {
    rng: Pcg64,
    spare: Option<f64>,
}

impl Chance {
    /// The generator of a chunk. `purpose` keeps the streams of different uses of one seed apart.
    pub(crate) fn new(seed: u64, purpose: u64, chunk: usize) -> Self {
        // Neighbouring seeds and chunks must not give neighbouring states, so each is scattered over all bits first.
        let a = scatter(seed ^ scatter(purpose));
        let b = scatter(a ^ scatter(chunk as u64));
        let state = u128::from(a) << 64 | u128::from(b);
        let stream = u128::from(scatter(b)) << 64 | u128::from(scatter(!a));
        Self { rng: Pcg64::new(state, stream), spare: None }
    }

    /// Uniform in 0..1.
    pub(crate) fn uniform(&mut self) -> f64 {
        self.rng.random()
    }

    /// Uniform between two values.
    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.uniform()
    }

    /// Normal with mean 0 and deviation 1 (Box and Muller 1958).
    pub(crate) fn normal(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        // 1 - u lies in (0, 1], so the logarithm is finite.
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        self.spare = Some(radius * sin);
        radius * cos
    }

    /// Three independent normal numbers of the given deviation.
    pub(crate) fn normal3(&mut self, deviation: f64) -> Vec3 {
        [deviation * self.normal(), deviation * self.normal(), deviation * self.normal()]
    }

    /// A uniform direction.
    pub(crate) fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = (std::f64::consts::TAU * self.uniform()).sin_cos();
        let across = (1.0 - z * z).max(0.0).sqrt();
        [across * cos, across * sin, z]
    }
}

/// Scatters a number over all 64 bits, one to one: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
fn scatter(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normal_numbers_have_the_moments_of_the_normal_law() {
        let mut chance = Chance::new(1, 0, 0);
        let n = 200_000;
        let draws: Vec<_> = (0..n).map(|_| chance.normal()).collect();
        let moment = |power| draws.iter().map(|x: &f64| x.powi(power)).sum::<f64>() / f64::from(n);
        // Deviations of these averages: 0.0022, 0.0032, 0.0087, 0.022.
        assert!(moment(1).abs() < 0.01 && (moment(2) - 1.0).abs() < 0.015);
        assert!(moment(3).abs() < 0.04 && (moment(4) - 3.0).abs() < 0.1);
    }

    #[test]
    fn streams_differ_by_seed_purpose_and_chunk() {
        let first = |s, p, c| Chance::new(s, p, c).uniform().to_bits();
        let mut all = vec![first(1, 0, 0), first(2, 0, 0), first(1, 1, 0), first(1, 0, 1), first(0, 1, 1)];
        all.sort_unstable();
        all.dedup();
        assert_eq!(all.len(), 5);
    }
}
