//! Which simplex holds a point.

use super::predicates::holds;
use super::{Barycentric, Place, SimplicialMesh};
use crate::domain::bounds;

/// A barycentric coordinate that differs from zero by less counts as zero: the point lies on the face.
///
/// Coordinates are computed from differences to a corner, so their error is a few times 1e-16 over the flatness of the simplex, plus that
/// of the coordinates themselves where the mesh lies far from the origin for its cells.
pub(super) const ON_FACE: f64 = 1e-12;

/// A simplex whose tolerance exceeds this is too flat for rounded coordinates to say whether it holds a point. Exact signs do.
const TOO_FLAT: f64 = 1e-6;

impl<const D: usize> SimplicialMesh<D> {
    /// The simplex that holds a position: of those it lies on, the one of lowest index. `None` outside the mesh.
    #[must_use]
    pub fn locate(&self, position: [f64; D]) -> Option<Place<D>> {
        if !position.iter().all(|c| c.is_finite()) {
            return None;
        }
        self.locator.near(position).iter().find_map(|&s| {
            let simplex = s as usize;
            let barycentric = self.barycentric(simplex, position);
            self.accepts(simplex, &barycentric, position).then_some(Place { simplex, barycentric, position })
        })
    }

    /// Whether a position lies in a simplex or, up to rounding, on its faces.
    fn accepts(&self, simplex: usize, barycentric: &Barycentric, position: [f64; D]) -> bool {
        let tolerance = self.tolerance(simplex);
        if tolerance <= TOO_FLAT {
            return barycentric.iter().all(|&b| b >= -tolerance);
        }
        if holds(&self.corner_positions(simplex), position) {
            return true;
        }
        // Up to rounding it does if a point that is surely in the simplex lies so near.
        let sum: f64 = barycentric.iter().map(|b| b.max(0.0)).sum();
        let within = self.position(simplex, &barycentric.map(|b| b.max(0.0) / sum));
        let near = 8.0 * f64::EPSILON * self.reach(simplex);
        (0..D).all(|a| (within[a] - position[a]).abs() <= near)
    }

    /// The simplices that touch a box, and some near it, in ascending order.
    pub(crate) fn candidates(&self, low: [f64; D], high: [f64; D]) -> Vec<u32> {
        let mut found = Vec::new();
        self.locator.collect(low, high, &mut found);
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The simplices that touch a segment, and some near it, in ascending order.
    pub(super) fn candidates_along(&self, [from, to]: [[f64; D]; 2]) -> Vec<u32> {
        // A box around the whole of a long segment would hold most of the mesh.
        let parts = self.locator.buckets_along(from, to);
        let at = |k: usize| -> [f64; D] {
            let t = k as f64 / parts as f64;
            std::array::from_fn(|a| from[a] + t * (to[a] - from[a]))
        };
        let mut found = Vec::new();
        for part in 0..parts {
            let (low, high) = bounds([at(part), at(part + 1)].into_iter());
            self.locator.collect(low, high, &mut found);
        }
        found.sort_unstable();
        found.dedup();
        found
    }

    /// The positions of the corners of a simplex; the last is unused in the plane.
    pub(super) fn corner_positions(&self, simplex: usize) -> [[f64; D]; 4] {
        super::positions(&self.vertices, self.simplex(simplex))
    }

    /// What counts as zero among the barycentric coordinates of a simplex.
    pub(crate) fn tolerance(&self, simplex: usize) -> f64 {
        let steepest = self.gradients[simplex].iter().flatten().fold(0.0_f64, |m, g| m.max(g.abs()));
        ON_FACE.max(8.0 * f64::EPSILON * self.reach(simplex) * steepest)
    }

    /// The largest magnitude among the coordinates of a simplex, which is what they are rounded to.
    fn reach(&self, simplex: usize) -> f64 {
        let corners = self.corner_positions(simplex);
        corners[..=D].iter().flatten().fold(0.0_f64, |m, c| m.max(c.abs()))
    }
}
