//! The height of the highest surface over each place.

use rayon::prelude::*;

use super::columns::{Column, STEPS, TILE, spans};
use super::domain::Local;
use super::{ModelError, Solid};
use crate::monitor::{Monitor, Steps};
use crate::vec3;

/// A raster of heights, in world coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// The corner in the north-west: least x and greatest y.
    pub corner: [f64; 2],
    /// Side of a pixel.
    pub cell: f64,
    /// Pixels along x and y.
    pub size: [usize; 2],
    /// Heights at the middles of the pixels, in rows from the north; NaN where there is no surface.
    pub values: Vec<f32>,
}

/// More pixels than this are a mistake.
const MOST_PIXELS: f64 = 4e9;

/// The height of the highest surface at the middle of each pixel: a digital surface model. Pixels are squares of side `cell`, at multiples of it; `None` is a cell of
/// the model.
///
/// # Errors
/// If an operand cannot be, the solid has no end that is known and no bounds are given, or the monitor stops.
///
/// ```
/// use zeroset::model::{Solid, heights};
/// let cone = Solid::Frustum { ends: [[0.5, 0.5, 0.0], [0.5, 0.5, 2.0]], radii: [1.0, 0.0] };
/// let raster = heights(&cone, Some(0.1), None, &())?;
/// let middle = raster.values.iter().fold(0.0, |highest: f32, value| highest.max(*value));
/// assert!((middle - 1.858).abs() < 0.001, "{middle}");
/// # Ok::<(), zeroset::model::ModelError>(())
/// ```
pub fn heights(
    solid: &Solid,
    cell: Option<f64>,
    bounds: Option<[[f64; 3]; 2]>,
    monitor: &dyn Monitor,
) -> Result<Heights, ModelError> {
    let local = Local::new(solid)?;
    let found = local.bounds(bounds)?;
    let own = local.cell(found);
    let cell = cell.unwrap_or(own);
    if !(cell.is_finite() && cell > 0.0) {
        return Err(ModelError::Parameter("the side of a pixel must be a positive length"));
    }
    let [low, high] = local.world_box(bounds)?.map(|corner| vec3::sub(corner, local.origin));
    // Pixels at multiples of their side in the world, so that rasters of neighbours fit.
    let first = [0, 1].map(|a| ((low[a] + local.origin[a]) / cell).floor());
    let last = [0, 1].map(|a| ((high[a] + local.origin[a]) / cell).ceil());
    let size = [0, 1].map(|a| (last[a] - first[a]).max(1.0));
    if size[0] * size[1] > MOST_PIXELS {
        return Err(ModelError::Parameter(
            "the raster has more than 4 thousand million pixels: give larger ones, or --bounds",
        ));
    }
    let size = size.map(|n| n as usize);
    let keep = local.keep();
    let ground = local.ground();
    let is_kept = |p: [f64; 3]| {
        let own = local.enter(p);
        let within = ground.is_none_or(|[low, high]| (0..2).all(|a| low[a] <= own[a] && own[a] <= high[a]));
        within && keep.as_ref().is_none_or(|keep| keep.contains(own))
    };
    monitor.stage("looking down");
    let x = |i: usize| (first[0] + i as f64 + 0.5) * cell - local.origin[0];
    let y = |row: usize| (last[1] - row as f64 - 0.5) * cell - local.origin[1];
    let steps = Steps::new(monitor, 0.0..1.0, size[1]);
    let step = own / STEPS;
    let mut values = vec![f32::NAN; size[0] * size[1]];
    values.par_chunks_mut(size[0] * TILE).enumerate().try_for_each(|(strip, pixels)| {
        let rows = strip * TILE..strip * TILE + pixels.len() / size[0];
        steps.advance(rows.len())?;
        for begin in (0..size[0]).step_by(TILE) {
            let columns = begin..(begin + TILE).min(size[0]);
            let tile = [[x(columns.start), y(rows.end - 1), low[2]], [x(columns.end - 1), y(rows.start), high[2]]];
            let spans = spans(&*local.field, tile, step);
            for (row, i) in rows.clone().flat_map(|row| columns.clone().map(move |i| (row, i))) {
                let line = [x(i), y(row)];
                let column = Column::trace(&*local.field, line, [low[2], high[2]], &spans, step);
                let highest = column.crossings.last().copied().filter(|&z| is_kept([line[0], line[1], z]));
                if let Some(z) = highest {
                    pixels[(row - rows.start) * size[0] + i] = (z + local.origin[2]) as f32;
                }
            }
        }
        Ok::<(), ModelError>(())
    })?;
    Ok(Heights { corner: [first[0] * cell, last[1] * cell], cell, size, values })
}
