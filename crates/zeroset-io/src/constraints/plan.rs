//! Polygons and closed lines in plan, for what is drawn out along z.

use std::path::Path;

use zeroset::constraint::{ConstraintError, Constraints};

use super::{ConstraintFormat, gather, nothing};
use crate::IoError;
use crate::format::by_suffix;
use crate::input::read_file;

type Ring = Vec<[f64; 2]>;

/// A polygon in plan: its outline, then its holes. First positions are not repeated.
pub type Footprint = Vec<Vec<[f64; 2]>>;

/// Reads polygons in plan; the suffix tells the format. Heights are left out, and may be missing.
///
/// Polygons of the file keep their holes. Closed lines are polygons too: one that lies in an odd number of others is a hole. Open lines, and what
/// has no area in plan, are passed over.
///
/// # Errors
/// If the file cannot be read or is damaged, holds no polygons and no closed lines, or the sides of one cross.
pub fn read_footprints(path: &Path) -> Result<Vec<Footprint>, IoError> {
    let format = by_suffix(path, "polygon", ConstraintFormat::KNOWN)?;
    read_footprints_bytes(path, format, &read_file(path)?)
}

/// The same of a content in memory; `path` is for messages only.
///
/// # Errors
/// As [`read_footprints`].
pub fn read_footprints_bytes(path: &Path, format: ConstraintFormat, bytes: &[u8]) -> Result<Vec<Footprint>, IoError> {
    let gathered = gather(path, format, bytes, Some(Plan::default()))?;
    let Plan { mut polygons, lines } = gathered.plan.unwrap_or_default();
    polygons.append(&mut nested(lines));
    if polygons.is_empty() {
        return Err(nothing(path, "polygons or closed lines", gathered.file.passed_over));
    }
    Ok(polygons)
}

/// What was read so far.
#[derive(Debug, Default)]
pub(super) struct Plan {
    polygons: Vec<Footprint>,
    lines: Vec<Ring>,
}

impl Plan {
    pub(super) fn line(&mut self, positions: &[[f64; 3]]) -> Result<(), ConstraintError> {
        match positions {
            [first, .., last] if first[..2] == last[..2] => {
                self.lines.append(&mut checked(&[positions.to_vec()])?);
                Ok(())
            }
            _ => Err(ConstraintError::NoExtent),
        }
    }

    pub(super) fn polygon(&mut self, rings: &[Vec<[f64; 3]>]) -> Result<(), ConstraintError> {
        self.polygons.push(checked(rings)?);
        Ok(())
    }
}

/// Rings in plan, without repeated positions.
fn checked(rings: &[Vec<[f64; 3]>]) -> Result<Footprint, ConstraintError> {
    let flat = |ring: &Vec<[f64; 3]>| ring.iter().map(|p| [p[0], p[1], 0.0]).collect();
    Constraints::default().polygon(&rings.iter().map(flat).collect::<Vec<_>>())?;
    let plan = |ring: &Vec<[f64; 3]>| {
        let mut ring: Ring = ring.iter().map(|p| [p[0], p[1]]).collect();
        ring.dedup();
        if ring.len() > 1 && ring.first() == ring.last() {
            ring.pop();
        }
        ring
    };
    Ok(rings.iter().map(plan).collect())
}

/// Outlines, each with the holes in it.
fn nested(rings: Vec<Ring>) -> Vec<Footprint> {
    let areas: Vec<f64> = rings.iter().map(|ring| area(ring)).collect();
    let around: Vec<Vec<usize>> = rings
        .iter()
        .zip(&areas)
        .map(|(ring, own)| {
            let inside = inside(ring);
            (0..rings.len()).filter(|&j| areas[j] > *own && surrounds(&rings[j], inside)).collect()
        })
        .collect();
    let mut outlines: Vec<Footprint> = vec![Vec::new(); rings.len()];
    for (i, ring) in rings.iter().enumerate() {
        let smallest = around[i].iter().copied().min_by(|a, b| areas[*a].total_cmp(&areas[*b]));
        match smallest.filter(|_| around[i].len() % 2 == 1) {
            Some(outer) => outlines[outer].push(ring.clone()),
            None => outlines[i].insert(0, ring.clone()),
        }
    }
    outlines.retain(|outline| !outline.is_empty());
    outlines
}

fn sides(ring: &[[f64; 2]]) -> impl Iterator<Item = [[f64; 2]; 2]> {
    ring.iter().zip(ring.iter().cycle().skip(1)).map(|(a, b)| [*a, *b])
}

fn area(ring: &[[f64; 2]]) -> f64 {
    // Relative to one of the corners, as coordinates of maps are large.
    let [x, y] = ring.first().copied().unwrap_or_default();
    0.5 * sides(ring).map(|[a, b]| (a[0] - x) * (b[1] - y) - (a[1] - y) * (b[0] - x)).sum::<f64>().abs()
}

/// Where sides cross the horizontal line at `y`, in order.
fn crossings(ring: &[[f64; 2]], y: f64) -> Vec<f64> {
    let crossing =
        |[a, b]: [[f64; 2]; 2]| ((a[1] > y) != (b[1] > y)).then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    let mut all: Vec<f64> = sides(ring).filter_map(crossing).collect();
    all.sort_by(f64::total_cmp);
    all
}

/// A position in a ring.
fn inside(ring: &[[f64; 2]]) -> [f64; 2] {
    let lowest = ring.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    let next = ring.iter().map(|p| p[1]).filter(|y| *y > lowest).fold(f64::INFINITY, f64::min);
    let y = 0.5 * (lowest + next);
    match crossings(ring, y)[..] {
        [a, b, ..] => [0.5 * (a + b), y],
        _ => ring[0],
    }
}

fn surrounds(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    crossings(ring, y).iter().filter(|crossing| **crossing > x).count() % 2 == 1
}
