//! Small faces that no flat neighbourhood lies in: found by local models of several flats.
//!
//! A face a few points wide has no point whose neighbours all lie on it, so nothing grows there. The points left over around it are
//! few, and bear one to four flats: NEWE finds them.

use rayon::prelude::*;

use super::regions::{NONE, Partition};
use crate::feature::newe::{FlatCount, NeweFitter, NeweParams};
use crate::vec3::Vec3;

/// Groups of more points are clutter: what is flat in them has grown already.
const MOST: usize = 400;
/// The most flats of a group.
const FLATS: usize = 4;

/// Groups of neighbouring points without a region, of at least so many points.
fn groups(partition: &Partition<'_>, least: usize) -> Vec<Vec<u32>> {
    let mut seen = vec![false; partition.points.len()];
    let mut groups = Vec::new();
    for seed in 0..partition.points.len() {
        if seen[seed] || partition.labels[seed] != NONE {
            continue;
        }
        seen[seed] = true;
        let mut group = vec![seed as u32];
        let mut head = 0;
        while head < group.len() {
            for &j in partition.around.of(group[head] as usize) {
                if !seen[j as usize] && partition.labels[j as usize] == NONE {
                    seen[j as usize] = true;
                    group.push(j);
                }
            }
            head += 1;
        }
        if (least..=MOST).contains(&group.len()) {
            group.sort_unstable();
            groups.push(group);
        }
    }
    groups
}

/// Adds the flats of the points left over to the regions.
pub(in crate::feature) fn recover(partition: &mut Partition<'_>) {
    let least = partition.limits.least;
    let params = NeweParams { flats: FlatCount::Between { least: 1, most: FLATS }, ..NeweParams::default() };
    let noise = partition.limits.noise;
    let found: Vec<Vec<Vec<u32>>> = groups(partition, least)
        .into_par_iter()
        .map_init(
            || NeweFitter::<3>::new(params.clone()),
            |fitter, group| {
                let Ok(fitter) = fitter else { return Vec::new() };
                let points: Vec<Vec3> = group.iter().map(|&i| partition.points[i as usize]).collect();
                let Ok(model) = fitter.fit_with_noise(&points, noise) else { return Vec::new() };
                let of_flat = |flat: usize| {
                    let mine = group.iter().zip(&model.assignment).filter(|(_, own)| **own == Some(flat));
                    mine.map(|(&i, _)| i).collect::<Vec<u32>>()
                };
                (0..model.flats.len()).map(of_flat).filter(|members| members.len() >= least).collect()
            },
        )
        .collect();
    for members in found.into_iter().flatten() {
        partition.add(&members);
    }
}
