//! How far the points of a cloud lie off their surface.
//!
//! # What
//! The standard deviation of the points across the surface: the noise of the scanner, with what detail is too fine for the
//! spacing of the points.
//!
//! # Formula
//! For up to 4,000 points of the cloud, chosen by a fixed seed: the plane of least squares through the point and its nearest
//! neighbours, k = 8, 12, 16 and 24 points in all. The residuals' sum of squares over k - 3 estimates the variance; the least of
//! the four is taken, because a neighbourhood that is too wide sees the curvature of the surface or the far side of a thin
//! wall. The median over the chosen points, times 1.16 (see below), is the estimate.
//!
//! # Not guaranteed
//! The least of four estimates is low by a seventh on a plane with Gaussian noise; the factor makes up for it. Noise of half
//! the spacing is measured a quarter low: neighbours are then chosen by their noise. A wall thinner than about 1.5 times the
//! spacing is taken for noise, and so are points that fill a volume, such as trees.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::Cloud;
use super::spacing::spread;
use crate::spatial::PointTree;

/// Most points that are examined.
const EXAMINED: usize = 4_000;
/// Sizes of the neighbourhoods, the point itself included.
const NEIGHBOURHOODS: [usize; 4] = [8, 12, 16, 24];
/// What the median of the least of the four estimates lacks on a plane.
const CORRECTION: f64 = 1.16;

/// Standard deviation of the points across their surface, in their unit. `None` for fewer points than a neighbourhood.
#[must_use]
pub fn noise(cloud: &Cloud, tree: &PointTree) -> Option<f64> {
    if tree.len() < NEIGHBOURHOODS[0] {
        return None;
    }
    let mut variances: Vec<f64> = spread(tree, EXAMINED)
        .into_par_iter()
        .map_init(Vec::new, |found, i| {
            tree.k_nearest(cloud.points[i], NEIGHBOURHOODS[3], found);
            let near: Vec<Vector3<f64>> =
                found.iter().map(|n| Vector3::from(cloud.points[n.index]) - Vector3::from(cloud.points[i])).collect();
            NEIGHBOURHOODS
                .into_iter()
                .filter(|&k| k <= near.len())
                .map(|k| off_plane(&near[..k]))
                .fold(f64::INFINITY, f64::min)
        })
        .collect();
    let middle = variances.len() / 2;
    let (_, median, _) = variances.select_nth_unstable_by(middle, f64::total_cmp);
    Some(CORRECTION * median.max(0.0).sqrt())
}

/// Variance of the points across the plane of least squares through them.
fn off_plane(points: &[Vector3<f64>]) -> f64 {
    let mean = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    let scatter: Matrix3<f64> = points.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
    scatter.symmetric_eigenvalues().min() / (points.len() - 3) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::{Scene, SceneKind};

    fn of(cloud: &Cloud) -> f64 {
        noise(cloud, &PointTree::new(&cloud.points)).expect("enough points")
    }

    #[test]
    fn gaussian_noise_on_flat_faces_is_measured() {
        // The spacing is 0.011.
        for (noise, tolerance) in [(1e-4, 0.06), (1e-3, 0.06), (5e-3, 0.25)] {
            let measured = of(&Scene::new(SceneKind::Box, 0).points(50_000, noise, 1));
            assert!((measured / noise - 1.0).abs() < tolerance, "{measured} for {noise}");
        }
    }

    #[test]
    fn a_thin_wall_is_not_taken_for_noise() {
        // Walls of 0.01 at a spacing of 0.004.
        let noise = 1e-3;
        let measured = of(&Scene::new(SceneKind::PocketPlate, 0).points(200_000, noise, 1));
        assert!((0.9..1.2).contains(&(measured / noise)), "{measured}");
    }

    #[test]
    fn a_few_points_and_points_in_one_place_have_none() {
        let cloud = |points| Cloud { points, ..Cloud::default() };
        let few = cloud(vec![[1.0, 2.0, 3.0]; 5]);
        assert_eq!(noise(&few, &PointTree::new(&few.points)), None);
        assert_eq!(of(&cloud(vec![[1.0, 2.0, 3.0]; 50])), 0.0);
    }
}
