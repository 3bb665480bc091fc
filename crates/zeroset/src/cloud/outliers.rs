//! Points that belong to no surface: birds, low noise, stray echoes.
//!
//! # Rule
//! Let r(i) be the distance from point i to its k-th nearest other point, g the median of all r(i) > 0, and m(i) the
//! median of r(j) over the 2 k nearest other points j of i (the lower one, so that k - 1 strays do not outvote them).
//! Point i is isolated if
//!
//! ```text
//! r(i) > 12 max(g, m(i))
//! ```
//!
//! that is, if its surroundings are twelve times emptier than is usual in the cloud and twelve times emptier than at
//! the places that are nearest to it. Points that are not finite are isolated.
//!
//! The second part keeps sparse surfaces: the neighbours of a point in a sparse region are in it, too. The first keeps
//! a few points between dense ones. A wall with 3 % of the density of the roof above has r six times larger than the
//! roof, so twelve leaves it room for gaps of twice its own spacing.
//!
//! # Cost
//! A search for k + 1 neighbours for every point, and for 2 k + 1 for those with r(i) > 12 g: O(n log n), on all
//! threads.
//!
//! # Guaranteed
//! The same answer on any number of threads. No point is isolated in a cloud of k points or fewer. Clouds of any
//! density: only ratios count.
//!
//! # Not guaranteed
//! On the bare walls of `airborne-city` chance gaps cost a few points in 400,000 at k = 8, and one at most at k = 16.
//! A flock of more than k points stays, since its points are near each other. So does a single point closer to a
//! surface than about twelve times r on it. Where a surface's spacing jumps to over twelve times, the first points of
//! the sparse side may be taken for strays of the dense one. Where points stand in one place more than k times over, r
//! is 0 and g is taken over the others.

use super::Cloud;
use crate::monitor::{Cancelled, Monitor, Steps};
use crate::spatial::{Neighbour, PointTree};
use crate::vec3;
use rayon::prelude::*;

/// How much emptier than usual. See the module's page for the reason.
const EMPTIER: f64 = 12.0;
/// Points that one task looks at.
const CHUNK: usize = 1 << 12;

/// For each point whether it is isolated: whether its `k`-th nearest other point is much farther than is usual around
/// there.
///
/// `k` is the number of stray points that may stand together and still be found; 0 is taken as 1. Choose 4 or more:
/// with 2, chance gaps in a sparse wall are enough to lose a point of it now and then.
///
/// # Errors
/// [`Cancelled`] if the monitor asked to stop.
pub fn isolated_points(cloud: &Cloud, k: usize, monitor: &dyn Monitor) -> Result<Vec<bool>, Cancelled> {
    isolated_with_tree(cloud, &PointTree::new(&cloud.points), k.max(1), monitor)
}

fn isolated_with_tree(
    cloud: &Cloud,
    tree: &PointTree,
    k: usize,
    monitor: &dyn Monitor,
) -> Result<Vec<bool>, Cancelled> {
    let mut isolated: Vec<bool> = cloud.points.par_iter().map(|p| !vec3::is_finite(*p)).collect();
    if tree.len() <= k {
        return Ok(isolated);
    }
    // In spatial order the searches of a task touch the same memory.
    let order: Vec<usize> = tree.spatial_order().collect();
    // The few candidates take the last tenth at most.
    let steps = Steps::new(monitor, 0.0..0.9, order.len());
    let reaches = order.par_chunks(CHUNK).map(|chunk| {
        let mut found = Vec::with_capacity(k + 1);
        let reach = |&i: &usize| {
            tree.k_nearest(cloud.points[i], k + 1, &mut found);
            found[k].distance_squared.sqrt()
        };
        let reaches: Vec<f64> = chunk.iter().map(reach).collect();
        steps.advance(chunk.len()).map(|()| reaches)
    });
    let in_order = reaches.collect::<Result<Vec<_>, _>>()?.concat();
    let mut reach = vec![0.0; cloud.len()];
    for (&i, r) in order.iter().zip(&in_order) {
        reach[i] = *r;
    }
    let Some(usual) = median(in_order.into_iter().filter(|r| *r > 0.0).collect()) else {
        return Ok(isolated);
    };
    let candidates: Vec<usize> = order.into_iter().filter(|&i| reach[i] > EMPTIER * usual).collect();
    let steps = Steps::new(monitor, 0.9..1.0, candidates.len());
    let apart = |i: usize| {
        let mut found: Vec<Neighbour> = Vec::with_capacity(2 * k + 1);
        tree.k_nearest(cloud.points[i], 2 * k + 1, &mut found);
        let others = found.iter().filter(|n| n.index != i).take(2 * k).map(|n| reach[n.index]).collect();
        median(others).is_some_and(|around| reach[i] > EMPTIER * around)
    };
    let found = candidates.par_chunks(CHUNK).map(|chunk| {
        let found: Vec<usize> = chunk.iter().copied().filter(|&i| apart(i)).collect();
        steps.advance(chunk.len()).map(|()| found)
    });
    for i in found.collect::<Result<Vec<_>, _>>()?.concat() {
        isolated[i] = true;
    }
    Ok(isolated)
}

/// The lower median.
fn median(mut values: Vec<f64>) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = (values.len() - 1) / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Scene, SceneKind};

    fn count(mask: &[bool]) -> usize {
        mask.iter().filter(|m| **m).count()
    }

    #[test]
    fn nothing_is_isolated_in_scenes_not_even_on_bare_walls() {
        for kind in SceneKind::ALL {
            let cloud = Scene::new(kind, 2).points(30_000, 0.001, 1);
            for k in [4, 8, 16] {
                let n = count(&isolated_points(&cloud, k, &()).unwrap());
                assert_eq!(n, 0, "{kind}, k = {k}");
            }
        }
    }

    #[test]
    fn birds_and_low_noise_are_found_and_nothing_else() {
        let mut cloud = Scene::new(SceneKind::AirborneCity, 2).points(50_000, 0.001, 1);
        // Spacing 0.0045; the flock of three stands together, far from all else.
        let strays = [[0.5, 0.5, 0.6], [0.2, 0.8, -0.5], [0.7, 0.1, 0.9], [0.7, 0.1, 0.901], [0.701, 0.1, 0.9]];
        cloud.points.splice(1000..1000, strays);
        let mask = isolated_points(&cloud, 4, &()).unwrap();
        let found: Vec<usize> = (0..mask.len()).filter(|&i| mask[i]).collect();
        assert_eq!(found, [1000, 1001, 1002, 1003, 1004]);
        // With k = 2 the flock holds together.
        let mask = isolated_points(&cloud, 2, &()).unwrap();
        assert_eq!(mask[1000..1005], [true, true, false, false, false]);
    }

    #[test]
    fn a_sparse_half_beside_a_dense_one_stays() {
        let mut cloud = Cloud::default();
        for i in 0..200 {
            for j in 0..200 {
                cloud.points.push([f64::from(i) * 0.01, f64::from(j) * 0.01, 0.0]);
            }
        }
        for i in 0..20 {
            for j in 0..20 {
                // Eight times as far apart.
                cloud.points.push([2.0 + f64::from(i) * 0.08, f64::from(j) * 0.08, 0.0]);
            }
        }
        assert_eq!(count(&isolated_points(&cloud, 6, &()).unwrap()), 0);
        cloud.points.push([3.0, 1.0, 3.0]);
        assert_eq!(isolated_points(&cloud, 6, &()).unwrap().iter().rposition(|m| *m), Some(40_400));
    }

    #[test]
    fn few_equal_and_broken_points_are_legal() {
        assert!(isolated_points(&Cloud::default(), 4, &()).unwrap().is_empty());
        let points = vec![[0.0; 3], [1.0, 0.0, 0.0], [f64::NAN, 0.0, 0.0]];
        let cloud = Cloud { points, ..Cloud::default() };
        assert_eq!(isolated_points(&cloud, 4, &()).unwrap(), [false, false, true]);
        assert_eq!(isolated_points(&cloud, 0, &()).unwrap(), [false, false, true]);
        let equal = Cloud { points: vec![[1.0; 3]; 100], ..Cloud::default() };
        assert_eq!(count(&isolated_points(&equal, 4, &()).unwrap()), 0);
    }

    #[test]
    fn doubled_points_do_not_make_the_others_isolated() {
        let mut cloud = Scene::new(SceneKind::Sphere, 0).points(5000, 0.0, 1);
        let doubled: Vec<_> = cloud.points[..4000].iter().flat_map(|p| [*p; 9]).collect();
        cloud.points.extend(doubled);
        assert_eq!(count(&isolated_points(&cloud, 8, &()).unwrap()), 0);
    }

    #[test]
    fn the_monitor_sees_shares_and_can_stop_it() {
        use crate::monitor::tests::Log;
        use std::sync::Mutex;
        let mut cloud = Scene::new(SceneKind::Torus, 1).points(20_000, 0.001, 1);
        cloud.points.push([5.0, 0.0, 0.0]);
        let patient = Log(Mutex::default(), usize::MAX);
        let isolated = isolated_points(&cloud, 4, &patient).unwrap();
        assert_eq!(isolated.iter().rposition(|m| *m), Some(20_000));
        let shares = patient.0.into_inner().unwrap();
        assert!(shares.len() >= 6 && shares.is_sorted() && shares.last() == Some(&1.0), "{shares:?}");
        assert!(isolated_points(&cloud, 4, &Log(Mutex::default(), 2)).is_err());
    }
}
