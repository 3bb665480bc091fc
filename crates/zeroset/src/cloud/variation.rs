//! How much the points of a cloud bend around each of them.

use nalgebra::{Matrix3, Vector3};
use rayon::prelude::*;

use super::Cloud;
use crate::spatial::PointTree;

/// The surface variation of each point: the share of the least eigenvalue in the covariance of the point and its nearest neighbours, so many in all.
/// 0 on a plane, up to 1/3 where points fill space alike in all directions. It grows with curvature, with noise, and at edges; no normals are needed.
/// `None` where fewer than four points are there, or all of them share a place.
///
/// Source: Pauly, Gross, Kobbelt 2002.
///
/// ```
/// use zeroset::cloud::{Cloud, surface_variation};
/// use zeroset::spatial::PointTree;
/// let points = (0..100).map(|i| [f64::from(i % 10), f64::from(i / 10), 0.0]).collect();
/// let flat = Cloud { points, ..Cloud::default() };
/// let found = surface_variation(&flat, &PointTree::new(&flat.points), 16);
/// assert!(found.iter().all(|value| value.is_some_and(|v| v.abs() < 1e-12)));
/// ```
#[must_use]
pub fn surface_variation(cloud: &Cloud, tree: &PointTree, neighbours: usize) -> Vec<Option<f64>> {
    let around = |found: &mut Vec<_>, &point: &[f64; 3]| {
        tree.k_nearest(point, neighbours, found);
        let near: Vec<Vector3<f64>> =
            found.iter().map(|n| Vector3::from(cloud.points[n.index]) - Vector3::from(point)).collect();
        if near.len() < 4 {
            return None;
        }
        let mean = near.iter().sum::<Vector3<f64>>() / near.len() as f64;
        let scatter: Matrix3<f64> = near.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
        let values = scatter.symmetric_eigenvalues();
        (values.sum() > 0.0).then(|| values.min().max(0.0) / values.sum())
    };
    cloud.points.par_iter().map_init(Vec::new, around).collect()
}
