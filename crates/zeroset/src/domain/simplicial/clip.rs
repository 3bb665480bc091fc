//! Segments and facets cut at the faces of the mesh.

use super::SimplicialMesh;
use crate::domain::bounds;

/// A part of a segment that lies in one simplex.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SegmentPiece {
    /// The simplex.
    pub simplex: usize,
    /// Where the part begins and ends, as shares of the segment, 0..=1.
    pub range: [f64; 2],
}

/// A part of a triangle that lies in one simplex, itself a triangle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FacetPiece<const D: usize> {
    /// The simplex.
    pub simplex: usize,
    /// The corners, in the order of the whole triangle's.
    pub corners: [[f64; D]; 3],
}

/// Cuts of a segment that are nearer to each other are one cut: two simplices that share a face give it twice, rounded differently.
const SAME_CUT: f64 = 1e-14;

/// By how much a line may miss a simplex and still be cut there: a cut too many does no harm, one too few does.
const NEAR_MISS: f64 = 1e-9;

/// A simplex with a coordinate that cannot be told from zero within this is left to its neighbours, which hold its facets up to
/// rounding.
const TOO_FLAT: f64 = 1e-4;

/// Parts of a triangle below this share of its area count as none.
const NO_AREA: f64 = 1e-17;

impl<const D: usize> SimplicialMesh<D> {
    /// Cuts a segment at all faces. Pieces are in order along the segment, and disjoint; a part on a shared face belongs to the simplex of
    /// lowest index. What lies outside the mesh is left out.
    #[must_use]
    pub fn clip_segment(&self, ends: [[f64; D]; 2]) -> Vec<SegmentPiece> {
        let mut pieces: Vec<SegmentPiece> = Vec::new();
        if ends[0] == ends[1] || !ends.as_flattened().iter().all(|c| c.is_finite()) {
            return pieces;
        }
        let [from, to] = ends;
        for range in self.cuts(ends).windows(2).map(|cuts| [cuts[0], cuts[1]]) {
            let t = 0.5 * (range[0] + range[1]);
            let middle = std::array::from_fn(|a| (1.0 - t) * from[a] + t * to[a]);
            let Some(place) = self.locate(middle) else { continue };
            match pieces.last_mut() {
                Some(last) if last.simplex == place.simplex && last.range[1] == range[0] => last.range[1] = range[1],
                _ => pieces.push(SegmentPiece { simplex: place.simplex, range }),
            }
        }
        pieces
    }

    /// Where a segment enters and leaves simplices, with both of its ends; ascending.
    fn cuts(&self, ends: [[f64; D]; 2]) -> Vec<f64> {
        let mut cuts = vec![];
        for simplex in self.candidates_along(ends) {
            let [from, to] = ends.map(|end| self.barycentric(simplex as usize, end));
            let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
            for (&b, &c) in from.iter().zip(&to).take(Self::CORNERS) {
                if b < 0.0 && c < 0.0 {
                    // All of it lies beyond the face, or along it up to rounding; then nothing is cut by it.
                    let tolerance = self.tolerance(simplex as usize).max(NEAR_MISS);
                    enters = if b.max(c) < -tolerance { 2.0 } else { enters };
                } else if b < 0.0 {
                    enters = enters.max(b / (b - c));
                } else if c < 0.0 {
                    leaves = leaves.min(b / (b - c));
                }
            }
            if enters <= leaves + NEAR_MISS {
                cuts.extend([enters, leaves]);
            }
        }
        cuts.retain(|t| (SAME_CUT..=1.0 - SAME_CUT).contains(t));
        cuts.push(0.0);
        cuts.sort_unstable_by(f64::total_cmp);
        cuts.dedup_by(|next, kept| *next - *kept < SAME_CUT);
        cuts.push(1.0);
        cuts
    }

    /// Cuts a triangle at all faces, into triangles. A part on a shared face belongs to the simplex of lowest index. What lies outside
    /// the mesh is left out.
    ///
    /// Each simplex takes its part, in ascending order, from what those before it have left. So no part is counted twice, and none is
    /// lost between two simplices, whatever is rounded.
    #[must_use]
    pub fn clip_triangle(&self, corners: [[f64; D]; 3]) -> Vec<FacetPiece<D>> {
        let mut pieces = Vec::new();
        let whole = polygon_area(&corners);
        if whole.is_nan() || whole <= 0.0 || whole.is_infinite() {
            return pieces;
        }
        let (low, high) = bounds(corners.iter().copied());
        let mut simplices = self.candidates(low, high);
        simplices.retain(|&s| self.tolerance(s as usize) <= TOO_FLAT);
        let boxes: Vec<_> = simplices
            .iter()
            .map(|&s| bounds(self.simplex(s as usize).iter().map(|&v| self.vertices[v as usize])))
            .collect();
        // What is left, with the first simplex that has not yet taken from it.
        let mut left = vec![(corners.to_vec(), 0)];
        while let Some((polygon, first)) = left.pop() {
            let (low, high) = bounds(polygon.iter().copied());
            let near = |(l, h): &([f64; D], [f64; D])| {
                (0..D).all(|a| {
                    let rounding = ROUNDED * (h[a].abs().max(l[a].abs()) + (h[a] - l[a]));
                    l[a] <= high[a] + rounding && low[a] <= h[a] + rounding
                })
            };
            let taken = (first..simplices.len()).filter(|&k| near(&boxes[k])).find_map(|k| {
                let simplex = simplices[k] as usize;
                let (part, rest) = self.take(simplex, &polygon)?;
                (polygon_area(&part) > NO_AREA * whole).then_some((k, simplex, part, rest))
            });
            let Some((k, simplex, part, rest)) = taken else { continue };
            left.extend(rest.into_iter().rev().map(|polygon| (polygon, k + 1)));
            let fan = (1..part.len() - 1).map(|i| [part[0], part[i], part[i + 1]]);
            pieces.extend(
                fan.filter(|corners| polygon_area(corners) > 0.0).map(|corners| FacetPiece { simplex, corners }),
            );
        }
        pieces.sort_by_key(|piece| piece.simplex);
        pieces
    }

    /// The part of a convex polygon in a simplex, and what is left of it; `None` if they do not meet in an area.
    fn take(&self, simplex: usize, polygon: &[[f64; D]]) -> Option<(Polygon<D>, Vec<Polygon<D>>)> {
        let tolerance = self.tolerance(simplex);
        let mut part = polygon.to_vec();
        let mut rest = Vec::new();
        for corner in 0..Self::CORNERS {
            let heights: Vec<f64> = part
                .iter()
                .map(|&p| {
                    let height = self.barycentric(simplex, p)[corner];
                    if height.abs() <= tolerance { 0.0 } else { height }
                })
                .collect();
            if heights.iter().all(|&h| h >= 0.0) {
                continue;
            }
            if heights.iter().all(|&h| h <= 0.0) {
                return None;
            }
            let [inside, outside] = split(&part, &heights);
            part = inside;
            rest.push(outside);
        }
        Some((part, rest))
    }
}

/// How far beyond its box, relative to its coordinates, a simplex may take up.
const ROUNDED: f64 = 1e-10;

/// A convex polygon.
type Polygon<const D: usize> = Vec<[f64; D]>;

/// Splits a convex polygon where a linear function that is given at its corners vanishes: the part where it is positive first.
fn split<const D: usize>(polygon: &[[f64; D]], heights: &[f64]) -> [Polygon<D>; 2] {
    let mut parts = [Vec::new(), Vec::new()];
    for (i, (&p, &h)) in polygon.iter().zip(heights).enumerate() {
        let next = (i + 1) % polygon.len();
        let (q, g) = (polygon[next], heights[next]);
        for (part, sign) in parts.iter_mut().zip([1.0, -1.0]) {
            if sign * h >= 0.0 {
                part.push(p);
            }
        }
        if h * g < 0.0 {
            let t = h / (h - g);
            let cut = std::array::from_fn(|a| (1.0 - t) * p[a] + t * q[a]);
            parts.iter_mut().for_each(|part| part.push(cut));
        }
    }
    parts
}

/// The area of a polygon that is flat and convex.
pub(crate) fn polygon_area<const D: usize>(polygon: &[[f64; D]]) -> f64 {
    (1..polygon.len().saturating_sub(1))
        .map(|i| {
            let side = |k: usize| -> [f64; D] { std::array::from_fn(|a| polygon[k][a] - polygon[0][a]) };
            let (u, v) = (side(i), side(i + 1));
            let minors = (0..D).flat_map(|a| (a + 1..D).map(move |b| (a, b)));
            0.5 * minors.map(|(a, b)| (u[a] * v[b] - u[b] * v[a]).powi(2)).sum::<f64>().sqrt()
        })
        .sum()
}
