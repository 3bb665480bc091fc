//! Solids out of solids, with the checks that both expressions and trees need.

use zeroset::field::{FieldError, Placement};
use zeroset::model::Solid;

use super::{DEEPEST, Fault};
use crate::constraints::Footprint;

/// Refuses a primitive without volume.
pub(super) fn primitive(solid: Solid) -> Result<Solid, Fault> {
    solid.field([0.0; 3])?;
    Ok(solid)
}

/// Footprints between two heights.
pub(super) fn extruded(footprints: Vec<Footprint>, heights: [f64; 2]) -> Result<Solid, Fault> {
    let prism = |rings| primitive(Solid::Prism { rings, heights });
    Ok(one_or_union(footprints.into_iter().map(prism).collect::<Result<_, _>>()?))
}

/// The first less all others.
pub(super) fn difference(mut of: Vec<Solid>) -> Solid {
    let others = of.split_off(1);
    match of.pop() {
        Some(first) => Solid::Difference(Box::new([first, one_or_union(others)])),
        None => one_or_union(others),
    }
}

fn one_or_union(mut of: Vec<Solid>) -> Solid {
    if of.len() == 1 { of.remove(0) } else { Solid::Union(of) }
}

pub(super) fn smooth_union(a: Solid, b: Solid, radius: f64) -> Result<Solid, Fault> {
    positive("the radius of a smooth union", radius)?;
    Ok(Solid::SmoothUnion { of: Box::new([a, b]), radius })
}

pub(super) fn shell(of: Solid, thickness: f64) -> Result<Solid, Fault> {
    positive("the thickness of a shell", thickness)?;
    Ok(Solid::Shell { of: Box::new(of), thickness })
}

pub(super) fn offset(of: Solid, distance: f64) -> Solid {
    Solid::Offset { of: Box::new(of), distance }
}

pub(super) fn complement(of: Solid) -> Solid {
    Solid::Complement(Box::new(of))
}

/// The solid elsewhere. Steps that follow one another become one.
pub(super) fn placed(
    solid: Solid,
    step: impl FnOnce(Placement) -> Result<Placement, FieldError>,
) -> Result<Solid, Fault> {
    Ok(match solid {
        Solid::Placed { of, placement } => Solid::Placed { of, placement: within_range(step(placement)?)? },
        of => Solid::Placed { of: Box::new(of), placement: within_range(step(Placement::default())?)? },
    })
}

/// Many steps can leave the range of numbers, each of them being in it.
fn within_range(placement: Placement) -> Result<Placement, FieldError> {
    Placement::new(placement.rotation(), placement.scale(), placement.shift())
}

fn positive(what: &'static str, value: f64) -> Result<(), FieldError> {
    if value > 0.0 { Ok(()) } else { Err(FieldError::NotPositive { what, value }) }
}

/// Refuses what has too many levels: work on it goes from level to level, and would run out of stack.
pub(super) fn shallow(solid: Solid) -> Result<Solid, Fault> {
    if levels(&solid) > DEEPEST { Err(Fault::TooDeep) } else { Ok(solid) }
}

fn levels(solid: &Solid) -> usize {
    let most = |of: &[Solid]| of.iter().map(levels).max().unwrap_or(0);
    1 + match solid {
        Solid::Union(of) | Solid::Intersection(of) => most(of),
        Solid::Difference(of) | Solid::SmoothUnion { of, .. } => most(&**of),
        Solid::Complement(of) | Solid::Offset { of, .. } | Solid::Shell { of, .. } | Solid::Placed { of, .. } => {
            levels(of)
        }
        _ => 0,
    }
}
