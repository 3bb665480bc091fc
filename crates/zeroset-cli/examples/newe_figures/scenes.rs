//! Corners with a known truth.

use zeroset::feature::newe::Flat;

/// Standard deviation of the points; the flats have size 1.
const NOISE: f64 = 0.012;

/// Points and the flats they were drawn from.
pub(crate) struct Scene<const D: usize> {
    pub(crate) points: Vec<[f64; D]>,
    pub(crate) flats: Vec<Flat<D>>,
}

impl<const D: usize> Scene<D> {
    /// The largest angle between a true flat and the nearest one of those found.
    pub(crate) fn angle(&self, found: &[Flat<D>]) -> f64 {
        let nearest = |flat: &Flat<D>| found.iter().map(|f| f.angle(flat)).fold(f64::INFINITY, f64::min);
        self.flats.iter().map(nearest).fold(0.0, f64::max)
    }
}

/// Two arms at 75 degrees, and outliers in their box until they are this share of all.
pub(crate) fn corner_in_plane(outliers: f64) -> Scene<2> {
    const POINTS: usize = 120;
    let mut chance = Chance(5);
    let arms = [0.25_f64, 0.25 + 75_f64.to_radians()].map(|a| [a.cos(), a.sin()]);
    let mut points: Vec<[f64; 2]> = (0..POINTS)
        .map(|i| {
            let (arm, t) = (arms[usize::from(i % 5 > 2)], chance.uniform());
            arm.map(|c| t * c + NOISE * chance.normal())
        })
        .collect();
    let ends = |a: usize| points.iter().fold([0.0_f64, 0.0_f64], |[l, h], p| [l.min(p[a]), h.max(p[a])]);
    let ends = [ends(0), ends(1)];
    let added = (POINTS as f64 * outliers / (1.0 - outliers)).round() as usize;
    points.extend((0..added).map(|_| ends.map(|[low, high]| low + (high - low) * chance.uniform())));
    Scene { points, flats: arms.iter().filter_map(|a| Flat::through([0.0; 2], [-a[1], a[0]])).collect() }
}

const X: [f64; 3] = [1.0, 0.0, 0.0];
const Y: [f64; 3] = [0.0, 1.0, 0.0];
const UP: [f64; 3] = [0.0, 0.0, 1.0];

fn back(v: [f64; 3]) -> [f64; 3] {
    v.map(|c| -c)
}

/// Three quadrants that face the viewer.
pub(crate) fn outside_corner() -> Scene<3> {
    scatter(4, &[[back(X), Y], [Y, back(UP)], [back(UP), back(X)]])
}

/// A floor with its far quadrant cut away, and two walls that rise at the cut.
pub(crate) fn notch() -> Scene<3> {
    scatter(4, &[[X, Y], [X, back(Y)], [back(X), back(Y)], [UP, back(X)], [UP, Y]])
}

/// 600 points on squares at the origin.
fn scatter(seed: u64, squares: &[[[f64; 3]; 2]]) -> Scene<3> {
    let mut chance = Chance(seed);
    let points = (0..600)
        .map(|i| {
            let [a, b] = squares[i % squares.len()];
            let (s, t) = (chance.uniform(), chance.uniform());
            std::array::from_fn(|c| s * a[c] + t * b[c] + NOISE * chance.normal())
        })
        .collect();
    Scene { points, flats: [X, Y, UP].into_iter().filter_map(|axis| Flat::through([0.0; 3], axis)).collect() }
}

/// Random numbers by SplitMix64 (Steele, Lea, Flood, OOPSLA 2014): the same everywhere and for ever.
struct Chance(u64);

impl Chance {
    /// At least 0, less than 1.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Mean 0, deviation 1.
    fn normal(&mut self) -> f64 {
        let radius = (-2.0 * (1.0 - self.uniform()).ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}
