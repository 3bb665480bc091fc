//! The neighbours of each point, and the plane through them.

use rayon::prelude::*;

use super::moments::Moments;
use crate::monitor::{Cancelled, Steps};
use crate::spatial::PointTree;
use crate::vec3::Vec3;

/// Neighbours of each point, itself left out.
///
/// Sixteen span a disk of about 2.3 spacings: with noise of a quarter of the spacing the normal is right to 3 degrees. Fewer
/// make seeds that fail, more blur faces that are a few points wide.
pub(super) const NEIGHBOURS: usize = 16;
/// See [`Surroundings::flattest`].
const FLATTEST: f64 = 0.677;
/// Points of a part of the work.
const CHUNK: usize = 1 << 12;

/// What lies around each point.
#[derive(Debug)]
pub(super) struct Surroundings {
    /// [`NEIGHBOURS`] for each point, nearest first; the point itself where there are fewer.
    neighbours: Vec<u32>,
    /// Normal of the plane of least squares through a point and its neighbours; either of the two.
    pub(super) normals: Vec<Vec3>,
    /// Deviation of the points across that plane.
    pub(super) deviations: Vec<f32>,
    /// Distance to the farthest of the neighbours.
    pub(super) radii: Vec<f32>,
}

impl Surroundings {
    pub(super) fn new(points: &[Vec3], tree: &PointTree, steps: &Steps<'_>) -> Result<Self, Cancelled> {
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
            let mut found = Vec::with_capacity(NEIGHBOURS + 1);
            for (place, own) in neighbours.chunks_mut(NEIGHBOURS).enumerate() {
                let i = part * CHUNK + place;
                tree.k_nearest(points[i], NEIGHBOURS + 1, &mut found);
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
                radii[place] = found.last().map_or(0.0, |f| f.distance_squared.sqrt() as f32);
            }
            steps.advance(normals.len())
        })?;
        Ok(Self { neighbours, normals, deviations, radii })
    }

    /// The noise of the flattest tenth of the points; `None` without points.
    ///
    /// Of points with Gaussian noise in a plane, a tenth deviate from the plane of least squares by less than 0.677 of it: the root of the
    /// tenth percentile of chi squared with 14 degrees of freedom, over 17.
    pub(super) fn flattest(&self) -> Option<f64> {
        let mut deviations = self.deviations.clone();
        let place = deviations.len() / 10;
        (place < deviations.len())
            .then(|| f64::from(*deviations.select_nth_unstable_by(place, f32::total_cmp).1) / FLATTEST)
    }

    /// The neighbours of point `i`.
    #[inline]
    pub(super) fn of(&self, i: usize) -> &[u32] {
        &self.neighbours[i * NEIGHBOURS..][..NEIGHBOURS]
    }
}
