//! What a section must be like before it is written.

use std::path::Path;

use super::{Section, SectionLine};
use crate::mesh::world;
use crate::{IoError, MAX_COORDINATE};

/// How far the length of a normal may be from 1, and the sine of the angle between parallel planes from 0.
const NEAR: f64 = 1e-6;

/// Looks at every number.
pub(super) fn sound(path: &Path, section: &Section) -> Result<(), IoError> {
    let wrong = |what: String| Err(IoError::malformed(path, what, "correct the section first"));
    let in_range = |c: f64| c.abs() <= MAX_COORDINATE;
    let usable = |p: &[f64; 3]| world(*p, section.world_from_local).into_iter().all(in_range);
    for (number, level) in (1..).zip(&section.levels) {
        let length = level.plane.normal.iter().map(|c| c * c).sum::<f64>().sqrt();
        if length.is_nan() || (length - 1.0).abs() > NEAR {
            return wrong(format!("plane {number} has a normal of length {length}, not 1"));
        }
        if !usable(&level.plane.point) || !level.height.is_none_or(in_range) {
            return wrong(format!("plane {number} is not at a finite place within {MAX_COORDINATE:e}"));
        }
        for line in &level.lines {
            if line.positions.len() < least(line) {
                let positions = line.positions.len();
                return wrong(format!(
                    "a line in plane {number} has {positions} positions, fewer than {}",
                    least(line)
                ));
            }
            if let Some(position) = line.positions.iter().find(|p| !usable(p)) {
                return wrong(format!("a line in plane {number} has the position {position:?}"));
            }
        }
    }
    Ok(())
}

fn least(line: &SectionLine) -> usize {
    if line.closed { 3 } else { 2 }
}

/// Refuses planes that no single picture can show.
pub(super) fn parallel(path: &Path, section: &Section) -> Result<(), IoError> {
    let Some(first) = section.levels.first() else { return Ok(()) };
    let [x, y, z] = first.plane.normal;
    let turned = |[a, b, c]: [f64; 3]| [y * c - z * b, z * a - x * c, x * b - y * a].iter().any(|s| s.abs() > NEAR);
    match section.levels.iter().position(|level| turned(level.plane.normal)) {
        Some(other) => {
            let what = format!("planes 1 and {} are not parallel", other + 1);
            Err(IoError::malformed(path, what, "write an SVG for each, or DXF or GeoJSON for all"))
        }
        None => Ok(()),
    }
}
