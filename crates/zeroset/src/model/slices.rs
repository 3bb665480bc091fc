//! Curves in which planes cut solids.

use super::domain::Local;
use super::{AttributeChoice, MeshParams, ModelError, Solid, mesh};
use crate::contour::FieldContourError;
use crate::mesh::{PlaneCurve, section};
use crate::monitor::{Monitor, Part};
use crate::vec3;

/// Where a solid is cut.
#[derive(Debug, Clone, PartialEq)]
pub enum Cuts {
    /// By planes: a position and a normal of any length each, in world coordinates.
    Planes(Vec<[[f64; 3]; 2]>),
    /// By level planes at all multiples of a height.
    Every(f64),
}

/// The curves in planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Slices {
    /// World positions are those of the curves plus this.
    pub world_from_local: [f64; 3],
    /// The planes, as local positions and unit normals, with their curves.
    pub levels: Vec<([[f64; 3]; 2], Vec<PlaneCurve>)>,
}

/// Cells around a plane in which the surface is looked for.
const SLAB: f64 = 4.0;
/// More planes than this are a mistake.
const MOST_PLANES: f64 = 1e5;

/// The curves in which planes cut a solid, sharp where it is. They are closed where the solid is, within `params.bounds`.
///
/// # Errors
/// As for [`mesh`](mesh()), or if a plane has no normal. A plane that misses the solid has no curves.
pub fn slices(solid: &Solid, cuts: &Cuts, params: &MeshParams, monitor: &dyn Monitor) -> Result<Slices, ModelError> {
    let local = Local::new(solid)?;
    let planes = match cuts {
        Cuts::Planes(planes) => planes
            .iter()
            .map(|&[point, normal]| {
                let normal = vec3::normalized(normal).filter(|_| vec3::is_finite(point));
                let normal = normal.ok_or(ModelError::Parameter("a plane needs a finite position and a normal"))?;
                Ok([vec3::sub(point, local.origin), normal])
            })
            .collect::<Result<Vec<_>, ModelError>>()?,
        Cuts::Every(step) => levels(&local, *step, params)?,
    };
    let params = MeshParams { attributes: AttributeChoice::Off, simplify: None, ..params.clone() };
    let surface = match planes.as_slice() {
        // One level or upright plane along an axis: only what is near it is needed.
        [[point, normal]] if normal.iter().filter(|c| **c != 0.0).count() == 1 => {
            let [mut low, mut high] = local.world_box(params.bounds)?;
            let axis = normal.iter().position(|c| *c != 0.0).unwrap_or(2);
            let cell = params.cell.unwrap_or_else(|| local.cell([low, high]));
            let at = point[axis] + local.origin[axis];
            low[axis] = low[axis].max(at - SLAB * cell);
            high[axis] = high[axis].min(at + SLAB * cell);
            if low[axis] >= high[axis] {
                return Ok(Slices { world_from_local: local.origin, levels: vec![(planes[0], Vec::new())] });
            }
            let params = MeshParams { cell: Some(cell), bounds: Some([low, high]), ..params };
            mesh(solid, &params, &Part::new(monitor, 0.0..0.95))
        }
        _ => mesh(solid, &params, &Part::new(monitor, 0.0..0.95)),
    };
    let surface = match surface {
        Ok((surface, _)) => surface,
        Err(ModelError::Contour(FieldContourError::NoSurface)) => Default::default(),
        Err(error) => return Err(error),
    };
    monitor.stage("cutting");
    let cut = |&[point, normal]: &[[f64; 3]; 2]| ([point, normal], section(&surface, point, normal));
    let levels = planes.iter().map(cut).collect();
    monitor.share(1.0);
    Ok(Slices { world_from_local: local.origin, levels })
}

/// Level planes at the multiples of a height that the solid reaches.
fn levels(local: &Local, step: f64, params: &MeshParams) -> Result<Vec<[[f64; 3]; 2]>, ModelError> {
    if !(step.is_finite() && step > 0.0) {
        return Err(ModelError::Parameter("the height between contour lines must be positive"));
    }
    let [low, high] = local.world_box(params.bounds)?;
    let (first, last) = ((low[2] / step).ceil(), (high[2] / step).floor());
    if last - first > MOST_PLANES {
        return Err(ModelError::Parameter("more than 100,000 contour lines: give a larger --every"));
    }
    let count = (last - first + 1.0).max(0.0) as usize;
    let at = |i: usize| [[0.0, 0.0, (first + i as f64) * step - local.origin[2]], [0.0, 0.0, 1.0]];
    Ok((0..count).map(at).collect())
}
