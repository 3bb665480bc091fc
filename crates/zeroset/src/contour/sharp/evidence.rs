//! Whether the points bear out that the surface is sharp where F is round.

use rayon::prelude::*;

use super::Known;
use super::sheets::{CREASE, Sheet};
use super::stars::Stars;
use crate::feature::Flat;
use crate::mesh::Mesh;
use crate::spatial::PointTree;
use crate::vec3;

/// Vertices that their sheet moves by less than this, in cells, need no evidence.
const MOVED: f64 = 0.35;
/// Of the way from the sheets to F the share from which on the points speak for F.
const SHARE: f64 = 0.6;
/// Rounds in which vertices share what their points say.
const ROUNDS: usize = 20;

/// The vertices whose points lie nearer to F than to the sheets: a rounded edge, not a sharp one.
///
/// Each point speaks for the vertex nearest to it, and is held against all sheets that meet there: their farthest outside of a convex edge,
/// their nearest at a concave one. Noise at the edge itself then moves points away from F, never towards it.
pub(super) fn unproven(
    mesh: &Mesh,
    stars: &Stars,
    known: &Known,
    sheets: &[Sheet],
    rivals: impl Fn(usize) -> Vec<Flat> + Sync,
) -> Vec<bool> {
    let offset = |v: usize| sheets[v].flat.distance(mesh.vertices[v]) / known.cell;
    let moved: Vec<bool> = (0..sheets.len()).into_par_iter().map(|v| offset(v).abs() > MOVED).collect();
    let tree = PointTree::new(&mesh.vertices);
    let said: Vec<Option<(usize, [f64; 2])>> = known
        .positions
        .par_iter()
        .map(|&q| {
            let v = tree.nearest_within(q, 2.0 * known.cell)?.index;
            if !moved[v] {
                return None;
            }
            // F lies on this side of the sheet.
            let side = offset(v).signum();
            let own = -side * sheets[v].flat.distance(q);
            let outermost = rivals(v).iter().map(|flat| -side * flat.distance(q)).fold(own, f64::max);
            Some((v, [-outermost / known.cell, offset(v).abs()]))
        })
        .collect();
    let mut sums = vec![[0.0; 2]; sheets.len()];
    for (v, said) in said.into_iter().flatten() {
        sums[v] = [sums[v][0] + said[0], sums[v][1] + said[1]];
    }
    let alike = |a: &Sheet, b: &Sheet| a.plane == b.plane && vec3::dot(a.flat.normal, b.flat.normal) > CREASE;
    for _ in 0..ROUNDS {
        sums = (0..sheets.len())
            .into_par_iter()
            .map(|v| {
                if !moved[v] {
                    return [0.0; 2];
                }
                let (mut sum, mut count) = (sums[v], 1.0);
                for &u in stars.around(v) {
                    let u = u as usize;
                    if moved[u] && alike(&sheets[v], &sheets[u]) {
                        sum = [sum[0] + sums[u][0], sum[1] + sums[u][1]];
                        count += 1.0;
                    }
                }
                sum.map(|s| s / count)
            })
            .collect();
    }
    (0..sheets.len()).into_par_iter().map(|v| moved[v] && sums[v][0] > SHARE * sums[v][1]).collect()
}
