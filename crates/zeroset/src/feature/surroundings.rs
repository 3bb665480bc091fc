//! The neighbours of each point, and the plane through them.

use rayon::prelude::*;

use super::moments::Moments;
use crate::monitor::{Cancelled, Steps};
use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// Neighbours of each point, itself left out.
///
/// Sixteen span a disk of about 2.3 spacings. Fewer make seeds that fail, more blur faces that are a few points wide.
pub(super) const NEIGHBOURS: usize = 16;
/// Points of a part of the work.
const CHUNK: usize = 1 << 12;

/// What lies around each point.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// [`NEIGHBOURS`] for each point, nearest first; the point itself where there are fewer.
    neighbours: Vec<u32>,
    /// How many points, one more than this, bear the plane around each point: [`NEIGHBOURS`], or more under noise.
    width: usize,
    /// Normal of the plane of least squares through a point and the points around it; either of the two.
    pub(super) normals: Vec<Vec3>,
    /// Deviation of the points across that plane.
    pub(super) deviations: Vec<f32>,
    /// Distance to the farthest of the neighbours.
    pub(super) radii: Vec<f32>,
}

impl Surroundings {
    /// `grain_rel` is the length at which the points tell directions, over their spacing, and 1 or more.
    ///
    /// The planes around points are as wide: sixteen neighbours tell a direction to 3 degrees with noise of a quarter of the spacing, and an
    /// edge from noise; with twice the noise that takes a disk twice as wide.
    pub(super) fn new(points: &[Vec3], tree: &PointTree, grain_rel: f64, steps: &Steps<'_>) -> Result<Self, Cancelled> {
        let width = (NEIGHBOURS as f64 * grain_rel * grain_rel).round() as usize;
        let n = points.len();
        let mut neighbours = vec![0_u32; n * NEIGHBOURS];
        let (mut normals, mut deviations, mut radii) = (vec![[0.0; 3]; n], vec![0.0; n], vec![0.0; n]);
        let parts = neighbours
            .par_chunks_mut(CHUNK * NEIGHBOURS)
            .zip(normals.par_chunks_mut(CHUNK))
            .zip(deviations.par_chunks_mut(CHUNK))
            .zip(radii.par_chunks_mut(CHUNK))
            .enumerate();
        parts.try_for_each(|(part, (((neighbours, normals), deviations), radii))| {
            let mut found = Vec::with_capacity(width + 1);
            for (place, own) in neighbours.chunks_mut(NEIGHBOURS).enumerate() {
                let i = part * CHUNK + place;
                tree.k_nearest(points[i], width + 1, &mut found);
                let mut moments = Moments::default();
                for neighbour in &found {
                    moments.add(crate::vec3::sub(points[neighbour.index], points[i]));
                }
                let others = found.iter().filter(|f| f.index != i).map(|f| f.index as u32);
                let others = others.chain(std::iter::repeat(i as u32));
                own.iter_mut().zip(others).for_each(|(to, from)| *to = from);
                if let Some(fit) = moments.fit() {
                    (normals[place], deviations[place]) = (fit.normal, fit.deviations[0] as f32);
                }
                let farthest = found.get(NEIGHBOURS).or(found.last());
                radii[place] = farthest.map_or(0.0, |f| f.distance_squared.sqrt() as f32);
            }
            steps.advance(normals.len())
        })?;
        Ok(Self { neighbours, width, normals, deviations, radii })
    }

    /// The noise of the flattest tenth of the points; `None` without points.
    ///
    /// Of points with Gaussian noise in a plane, a tenth deviate from the plane of least squares by less than 0.677 of it with 16 neighbours:
    /// the root of the tenth percentile of chi squared with 14 degrees of freedom, over 17.
    pub(super) fn flattest(&self) -> Option<f64> {
        let mut deviations = self.deviations.clone();
        let place = deviations.len() / 10;
        (place < deviations.len())
            .then(|| f64::from(*deviations.select_nth_unstable_by(place, f32::total_cmp).1) / self.tenth())
    }

    /// The tenth percentile of the deviations of points in a plane, over their noise, by Wilson and Hilferty 1931.
    fn tenth(&self) -> f64 {
        let freedom = self.width as f64 - 2.0;
        let spread = 2.0 / (9.0 * freedom);
        let chi_squared = freedom * (1.0 - spread - 1.2816 * spread.sqrt()).powi(3);
        (chi_squared / (self.width as f64 + 1.0)).sqrt()
    }

    /// The neighbours of point `i`.
    #[inline]
    pub(super) fn of(&self, i: usize) -> &[u32] {
        &self.neighbours[i * NEIGHBOURS..][..NEIGHBOURS]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tenth_of_the_points_are_as_flat_as_the_law_says() {
        // The tenth percentiles of chi squared with 14 and 46 degrees of freedom are 7.790 and 34.22.
        for (width, percentile) in [(16, 7.790_f64), (48, 34.22)] {
            let around = Surroundings { width, neighbours: vec![], normals: vec![], deviations: vec![], radii: vec![] };
            let expected = (percentile / (width as f64 + 1.0)).sqrt();
            assert!((around.tenth() / expected - 1.0).abs() < 1e-3, "{} for {width}", around.tenth());
        }
    }
}
