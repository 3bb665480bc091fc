//! The box of a cloud.

use zeroset::cloud::Cloud;

/// The lowest and the highest corner in world coordinates; `None` without points.
pub(crate) fn bounds(cloud: &Cloud) -> Option<[[f64; 3]; 2]> {
    let (mut low, mut high) = (*cloud.points.first()?, *cloud.points.first()?);
    for point in &cloud.points {
        for axis in 0..3 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    let o = cloud.world_from_local;
    Some([low, high].map(|p| std::array::from_fn(|a| p[a] + o[a])))
}
