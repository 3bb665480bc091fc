//! How far apart the points of a cloud are on its surface.
//!
//! # What
//! The side of the square that one point has to itself. A lattice, a random sample and a scan with points ten times
//! denser along its lines than across them have the same spacing if they have the same number of points an area.
//!
//! # Formula
//! For up to 20,000 points of the cloud, chosen by a fixed seed: r_k is the distance to the k-th nearest other point,
//! so pi r_k^2 / k is the area a point. Its mean over k = 8 to 16 is taken, and the root of that is the spacing here.
//! The median over the chosen points is the estimate. One k alone would show the shells of a lattice: a tenth to a
//! quarter off.
//!
//! Points closer together than 1/1000 of the spacing are one point. As the spacing is not known beforehand, it is found
//! from above: it starts at thirty times the spacing that the points would have on a square as wide as the box's
//! diagonal, and is measured again with points merged at 1/1000 of the last value until it falls no more. So of all
//! values that agree with themselves the largest is found: a cloud in which every point stands ten times, or has an
//! echo a micrometre away, has the spacing of the places.
//!
//! # Cost
//! Building a [`PointTree`], and a search for 32 to 256 neighbours of 20,000 points, and of a tenth of these three or
//! four times before.
//!
//! # Guaranteed
//! The same value on any number of threads, and finite and positive for every cloud with two different places.
//!
//! # Not guaranteed
//! On random points the median lies 2 % under the root of the mean area. Noise in the order of the spacing, and points
//! that fill a volume, lower it. Points of a line have an area only by name: about three times their
//! distance comes out. On lattices the estimate is 5 to 10 % high, and a third low where points are twenty times denser
//! along lines than across. Where places hold more than fifteen points each, fewer neighbours make up the area, and it
//! may be off by 40 %. A cloud where over half of the points belong to clusters a thousand times denser than the rest
//! has the spacing of the clusters.

use super::Cloud;
use crate::sample::Chance;
use crate::spatial::{Neighbour, PointTree};
use crate::vec3::{self, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Most points that are examined.
const EXAMINED: usize = 20_000;
/// One point in this many finds the scale at which points are merged.
const SCOUTS: usize = 10;
/// The fewest and the most neighbours that make up the area.
const NEIGHBOURS: [usize; 2] = [8, 16];
/// Points closer than this share of the spacing are one.
const SAME: f64 = 1e-3;
/// Most neighbours that are looked through for different places. Where one place holds more points than that, a point
/// of it says nothing.
const MOST_SEARCHED: usize = 256;
/// The first guess over the spacing of as many points on a square as wide as the diagonal. Large, as many points may
/// share a place; not larger, as points are merged at a thousandth of it, and merging many is slow.
const FIRST_GUESS: f64 = 30.0;

/// How far apart points are.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Spacing {
    /// The median over the points examined. The figure to use.
    pub median: f64,
    /// The mean over the points examined.
    pub mean: f64,
    /// A tenth of the points examined have at most this spacing.
    pub p10: f64,
    /// Nine tenths of the points examined have at most this spacing.
    pub p90: f64,
    /// Number of points examined.
    pub examined: usize,
}

impl Spacing {
    /// Measures a cloud; `None` if it has fewer than two different places. Points that are not finite do not count.
    #[must_use]
    pub fn of(cloud: &Cloud) -> Option<Self> {
        Self::with_tree(cloud, &PointTree::new(&cloud.points))
    }

    /// The same, with a tree over `cloud.points` that is already there.
    #[must_use]
    pub fn with_tree(cloud: &Cloud, tree: &PointTree) -> Option<Self> {
        let chosen = spread(tree, EXAMINED);
        let queries: Vec<Vec3> = chosen.into_iter().map(|i| cloud.points[i]).collect();
        let (mut low, mut high) = (*queries.first()?, *queries.first()?);
        for point in cloud.points.iter().filter(|p| vec3::is_finite(**p)) {
            (low, high) = (vec3::min(low, *point), vec3::max(high, *point));
        }
        let first_guess = FIRST_GUESS * vec3::distance(low, high) / (tree.len() as f64).sqrt();
        // One query in ten is enough to find the scale; all of them measure it once it is known.
        let few: Vec<Vec3> = queries.iter().copied().step_by(SCOUTS).collect();
        let mut scale = first_guess;
        loop {
            let next = Self::measure(cloud, tree, &few, SAME * scale)?.median;
            let at_rest = next >= 0.9 * scale;
            scale = next;
            // A tenth less moves the limit of merging by a ten-thousandth of the spacing.
            if at_rest {
                break;
            }
        }
        Self::measure(cloud, tree, &queries, SAME * scale).filter(|s| s.median > 0.0 && s.median.is_finite())
    }

    /// The spacing around the queries, with points no farther apart than `same` taken as one.
    fn measure(cloud: &Cloud, tree: &PointTree, queries: &[Vec3], same: f64) -> Option<Self> {
        let mut values: Vec<f64> = queries.par_iter().filter_map(|q| local(cloud, tree, *q, same)).collect();
        if values.is_empty() {
            // Every place examined is crowded beyond the search: one plain look at all points settles it.
            values.extend(nearest_other_place(cloud, *queries.first()?));
        }
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| values.get((share * values.len() as f64) as usize).copied();
        Some(Self {
            median: at(0.5)?,
            mean: values.iter().sum::<f64>() / values.len() as f64,
            p10: at(0.1)?,
            p90: at(0.9)?,
            examined: values.len(),
        })
    }
}

/// At most `most` of the points: one at random from each of equal runs of them in spatial order, so that they are spread
/// well.
pub(super) fn spread(tree: &PointTree, most: usize) -> Vec<usize> {
    let count = tree.len().min(most);
    let mut chance = Chance::new(0, 8, 0);
    let step = tree.len() as f64 / count as f64;
    let mut places: Vec<usize> = (0..count).map(|i| ((i as f64 + chance.uniform()) * step) as usize).collect();
    places.dedup();
    let mut places = places.into_iter().peekable();
    let numbered = tree.spatial_order().enumerate();
    numbered.filter(|(place, _)| places.next_if_eq(place).is_some()).map(|(_, index)| index).collect()
}

/// The distance to the nearest point that is not at `q` itself.
fn nearest_other_place(cloud: &Cloud, q: Vec3) -> Option<f64> {
    let distances = cloud.points.iter().filter(|p| vec3::is_finite(**p)).map(|p| vec3::distance(*p, q));
    distances.filter(|d| *d > 0.0).min_by(f64::total_cmp)
}

/// The root of the area a point around `q`, with points no farther apart than `same` taken as one. `None` if there is
/// no other place, or none among the most neighbours that are searched.
fn local(cloud: &Cloud, tree: &PointTree, q: Vec3, same: f64) -> Option<f64> {
    let mut found = Vec::new();
    let mut searched = 2 * NEIGHBOURS[1];
    loop {
        tree.k_nearest(q, searched, &mut found);
        let places = places(cloud, &found, q, same);
        if places.len() == NEIGHBOURS[1] || 2 * searched > MOST_SEARCHED || found.len() < searched {
            if places.is_empty() {
                // All that was seen is within `same`. Its extent is below the limit, which sinks with it in the next
                // round.
                let farthest = found.last()?.distance_squared.sqrt();
                return (farthest > 0.0).then_some(farthest);
            }
            let areas = (1..).zip(&places).map(|(k, squared)| std::f64::consts::PI * squared / f64::from(k));
            let (sum, count) =
                areas.skip(places.len().min(NEIGHBOURS[0]) - 1).fold((0.0, 0.0), |s, a| (s.0 + a, s.1 + 1.0));
            return Some((sum / count).sqrt());
        }
        searched *= 2;
    }
}

/// The squared distances to the nearest places other than `q`'s own, among the points found.
fn places(cloud: &Cloud, found: &[Neighbour], q: Vec3, same: f64) -> Vec<f64> {
    let mut known = vec![q];
    let mut squares = Vec::with_capacity(NEIGHBOURS[1]);
    for neighbour in found {
        let position = cloud.points[neighbour.index];
        if squares.len() < NEIGHBOURS[1] && known.iter().all(|p| vec3::distance(*p, position) > same) {
            known.push(position);
            squares.push(neighbour.distance_squared);
        }
    }
    squares
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Scene, SceneKind};

    fn of(points: Vec<Vec3>) -> Option<Spacing> {
        Spacing::of(&Cloud { points, ..Cloud::default() })
    }

    fn lattice(n: u32, dx: f64, dy: f64) -> Vec<Vec3> {
        (0..n * n).map(|i| [dx * f64::from(i % n), dy * f64::from(i / n), 0.0]).collect()
    }

    fn assert_ratio(value: Option<Spacing>, expected: f64, tolerance: f64) {
        let ratio = value.expect("two places or more").median / expected;
        assert!((ratio - 1.0).abs() < tolerance, "{ratio} times the expected");
    }

    #[test]
    fn a_random_sample_has_the_root_of_its_area_a_point() {
        let area = std::f64::consts::PI;
        for n in [1000, 30_000, 300_000] {
            let cloud = Scene::new(SceneKind::Sphere, 0).points(n, 0.0, 1);
            assert_ratio(Spacing::of(&cloud), (area / n as f64).sqrt(), 0.04);
        }
    }

    #[test]
    fn a_lattice_has_its_step_within_the_shells_of_counting() {
        assert_ratio(of(lattice(100, 0.5, 0.5)), 0.5, 0.06);
    }

    #[test]
    fn scan_lines_dense_along_count_by_area() {
        // Four times denser along than across: the area a point is 1 x 0.25.
        assert_ratio(of(lattice(120, 0.25, 1.0)), 0.5, 0.1);
        assert_ratio(of(lattice(200, 0.1, 1.0)), 0.1_f64.sqrt(), 0.1);
        // The sixteen nearest lie on one line, shorter than the lines are apart.
        assert_ratio(of(lattice(300, 0.05, 1.0)), 0.05_f64.sqrt(), 0.35);
    }

    #[test]
    fn doubled_points_are_one_place() {
        let once = lattice(30, 1.0, 1.0);
        let expected = of(once.clone()).expect("many places").median;
        for copies in [2, 10, 15] {
            let exact = once.iter().flat_map(|p| vec![*p; copies]).collect();
            assert_ratio(of(exact), expected, 1e-9);
            let jitter = |p: &Vec3| (0..copies).map(|c| [p[0], p[1], 1e-6 * c as f64]).collect::<Vec<_>>();
            assert_ratio(of(once.iter().flat_map(jitter).collect()), expected, 1e-3);
        }
    }

    #[test]
    fn a_far_stray_point_changes_nothing() {
        let mut points = lattice(100, 1.0, 1.0);
        let expected = of(points.clone()).expect("many places").median;
        points.push([1e7, 0.0, 0.0]);
        assert_ratio(of(points), expected, 1e-9);
    }

    #[test]
    fn too_few_places_have_no_spacing() {
        assert_eq!(of(vec![]), None);
        assert_eq!(of(vec![[1.0; 3]]), None);
        assert_eq!(of(vec![[1.0; 3]; 500]), None);
        assert_eq!(of(vec![[1.0; 3], [f64::NAN; 3]]), None);
        assert_ratio(of(vec![[0.0; 3], [2.0, 0.0, 0.0]]), 2.0 * std::f64::consts::PI.sqrt(), 1e-12);
        // Two places that hold more points than are searched.
        let crowded = [vec![[0.0; 3]; 1000], vec![[3.0, 0.0, 0.0]; 1000]].concat();
        assert_ratio(of(crowded), 3.0, 1e-12);
    }

    #[test]
    fn the_value_does_not_depend_on_threads() {
        let cloud = Scene::new(SceneKind::AirborneCity, 0).points(60_000, 0.001, 1);
        let on = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| Spacing::of(&cloud))
        };
        assert_eq!(on(1), on(3));
    }
}
