//! Where a solid can be asked.

use std::sync::Arc;

use super::keep::Keep;
use super::solid::Leaf;
use super::{Fitted, ModelError, Solid};
use crate::cloud::choose_offset;
use crate::contour::FieldContourError;
use crate::field::{Field, Placed, Placement};
use crate::fit::cascade::Scene;
use crate::fit::{Frame, Up};
use crate::vec3::{self, Vec3};

/// The cells of a solid without a fitted model: the longest side of its box over this.
const CELLS_ACROSS: f64 = 128.0;

/// A solid in local coordinates, with where it is known.
pub(super) struct Local {
    /// World positions are local ones plus this.
    pub(super) origin: Vec3,
    /// F as a function of local positions.
    pub(super) field: Arc<dyn Field>,
    pub(super) leaves: Vec<Leaf>,
    /// The place among the leaves of the first fitted model that is neither turned nor moved. Open ground ends where its points do.
    base: Option<usize>,
}

impl Local {
    /// A solid about the origin of its first fitted model or mesh, else about a position near it.
    pub(super) fn new(solid: &Solid) -> Result<Self, ModelError> {
        let origin = origin(solid, &of_fitted).or_else(|| origin(solid, &of_mesh));
        if let Some(origin) = origin {
            return Self::at(solid, origin);
        }
        let there = Self::at(solid, [0.0; 3])?;
        let corners = there.field.extent().into_iter().flatten();
        let origin = choose_offset(corners.filter(|corner| vec3::is_finite(*corner)));
        if origin == [0.0; 3] { Ok(there) } else { Self::at(solid, origin) }
    }

    /// A solid about a given origin.
    pub(super) fn at(solid: &Solid, origin: Vec3) -> Result<Self, ModelError> {
        let mut leaves = Vec::new();
        let field = solid.with_leaves(origin, &mut leaves)?;
        let base = (0..leaves.len()).find(|&tag| is_in_place(&*field, tag));
        Ok(Self { origin, field, leaves, base })
    }

    pub(super) fn base(&self) -> Option<&Leaf> {
        Some(&self.leaves[self.base?])
    }

    /// The first fitted model.
    pub(super) fn fitted(&self) -> Option<&Arc<Fitted>> {
        self.base().map(|base| &base.fitted)
    }

    /// Axes to work along: those of the first fitted model.
    pub(super) fn frame(&self) -> Frame {
        self.fitted().map_or_else(|| Frame::new(Up::Z, Scene::Terrain), |fitted| fitted.frame())
    }

    /// A local position in the frame.
    pub(super) fn enter(&self, p: Vec3) -> Vec3 {
        self.frame().enter(vec3::sub(p, self.shift()))
    }

    /// A position of the frame in local coordinates.
    pub(super) fn leave(&self, p: Vec3) -> Vec3 {
        vec3::add(self.frame().leave(p), self.shift())
    }

    fn shift(&self) -> Vec3 {
        self.base().map_or([0.0; 3], |base| base.shift)
    }

    /// F as a function of positions in the frame.
    pub(super) fn turned(&self) -> Placed {
        Placed::new(Arc::clone(&self.field), self.frame().entry(self.shift()))
    }

    /// The box of the points of open ground in the frame, seen from above.
    pub(super) fn ground(&self) -> Option<[Vec3; 2]> {
        let fitted = self.fitted().filter(|fitted| fitted.is_ground())?;
        let frame = fitted.frame();
        let points = fitted.parts().points.iter().map(|p| frame.enter(p.map(f64::from)));
        Some(crate::domain::bounds(points).into())
    }

    /// What of the surface stays where the first fitted model has no points near; `None`: all.
    pub(super) fn keep(&self) -> Option<Keep> {
        self.fitted().and_then(|fitted| Keep::new(fitted))
    }

    /// The box in the frame that holds the surface, or its part in a box of world coordinates.
    pub(super) fn bounds(&self, given: Option<[Vec3; 2]>) -> Result<[Vec3; 2], ModelError> {
        if given.is_some() {
            let bounds = self.world_box(given)?;
            if !is_full(bounds) {
                return Err(FieldContourError::NoSurface.into());
            }
            let local = bounds.map(|corner| vec3::sub(corner, self.origin));
            return Ok(self.frame().entry(self.shift()).of_box(local));
        }
        let [mut low, mut high] = self.turned().extent().ok_or(FieldContourError::NoBounds)?;
        if let Some([first, last]) = self.ground() {
            for a in 0..2 {
                (low[a], high[a]) = (low[a].max(first[a]), high[a].min(last[a]));
            }
        }
        if !is_full([low, high]) {
            return Err(FieldContourError::NoSurface.into());
        }
        if !vec3::is_finite(low) || !vec3::is_finite(high) {
            return Err(FieldContourError::NoBounds.into());
        }
        Ok([low, high])
    }

    /// The box in local coordinates that holds the surface.
    pub(super) fn local_box(&self) -> Result<[Vec3; 2], ModelError> {
        Ok(self.frame().exit(self.shift()).of_box(self.bounds(None)?))
    }

    /// The box that holds the surface, or its part in a box that is given, which may be infinite; both in world coordinates.
    pub(super) fn world_box(&self, given: Option<[Vec3; 2]>) -> Result<[Vec3; 2], ModelError> {
        let given = checked(given)?;
        if let Some(given) = given.filter(is_finite) {
            return Ok(given);
        }
        let [low, high] = self.local_box()?.map(|corner| vec3::add(corner, self.origin));
        Ok(given.map_or([low, high], |given| [vec3::max(low, given[0]), vec3::min(high, given[1])]))
    }

    /// The cells that suit the solid.
    pub(super) fn cell(&self, [low, high]: [Vec3; 2]) -> f64 {
        let side = (0..3).map(|a| high[a] - low[a]).filter(|side| side.is_finite()).fold(f64::MIN_POSITIVE, f64::max);
        self.fitted().map_or(side / CELLS_ACROSS, |fitted| fitted.cell())
    }
}

/// A box that is given, if it holds something.
pub(super) fn checked(given: Option<[Vec3; 2]>) -> Result<Option<[Vec3; 2]>, ModelError> {
    if given.is_none_or(is_full) { Ok(given) } else { Err(FieldContourError::EmptyBounds.into()) }
}

/// Whether a box is finite along all axes.
pub(super) fn is_finite([low, high]: &[Vec3; 2]) -> bool {
    vec3::is_finite(*low) && vec3::is_finite(*high)
}

fn is_full([low, high]: [Vec3; 2]) -> bool {
    (0..3).all(|a| low[a] < high[a])
}

/// The offset of the first leaf of a kind that is neither turned nor scaled.
fn origin(solid: &Solid, of: &dyn Fn(&Solid) -> Option<Vec3>) -> Option<Vec3> {
    match solid {
        Solid::Placed { placement, .. } if placement.without_shift() != Placement::default() => None,
        _ => of(solid).or_else(|| solid.operands().iter().find_map(|operand| origin(operand, of))),
    }
}

fn of_fitted(solid: &Solid) -> Option<Vec3> {
    if let Solid::Fitted(fitted) = solid { Some(fitted.parts().world_from_local) } else { None }
}

fn of_mesh(solid: &Solid) -> Option<Vec3> {
    if let Solid::Mesh(mesh) = solid { Some(mesh.world_from_local) } else { None }
}

/// Whether an operand is neither turned nor moved.
fn is_in_place(field: &dyn Field, tag: usize) -> bool {
    let own = (0..field.sheets()).map(|sheet| field.operand(sheet)).find(|operand| operand.tag == Some(tag));
    own.is_some_and(|operand| operand.placement == Placement::default())
}
