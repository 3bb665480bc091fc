//! F at many places.

use rayon::prelude::*;

use super::domain::Local;
use super::{ModelError, Solid};
use crate::monitor::{Monitor, Steps};
use crate::vec3::{self, Vec3};

/// F at some positions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Values {
    /// F: negative inside.
    pub values: Vec<f64>,
    /// Its gradients, which point outward.
    pub gradients: Vec<[f64; 3]>,
}

/// Positions that one thread takes at a time.
const CHUNK: usize = 1 << 10;

/// F and its gradient at world positions, on all threads.
///
/// # Errors
/// If an operand cannot be, or the monitor stops.
///
/// ```
/// use zeroset::model::{Solid, evaluate};
/// let ball = Solid::Ball { center: [84810.0, 447412.0, 2.0], radius: 3.0 };
/// let found = evaluate(&ball, &[[84814.0, 447412.0, 2.0]], &())?;
/// assert_eq!((found.values[0], found.gradients[0]), (1.0, [1.0, 0.0, 0.0]));
/// # Ok::<(), zeroset::model::ModelError>(())
/// ```
pub fn evaluate(solid: &Solid, positions: &[[f64; 3]], monitor: &dyn Monitor) -> Result<Values, ModelError> {
    monitor.stage("evaluating");
    let local = Local::new(solid)?;
    let steps = Steps::new(monitor, 0.0..1.0, positions.len());
    let mut all = Values { values: vec![0.0; positions.len()], gradients: vec![[0.0; 3]; positions.len()] };
    let chunks = positions.par_chunks(CHUNK).zip(all.values.par_chunks_mut(CHUNK));
    chunks.zip(all.gradients.par_chunks_mut(CHUNK)).try_for_each(|((positions, values), gradients)| {
        let own: Vec<Vec3> = positions.iter().map(|&p| vec3::sub(p, local.origin)).collect();
        let mut found = vec![(0.0, [0.0; 3]); own.len()];
        local.field.evaluate(&own, &mut found);
        for ((found, value), gradient) in found.into_iter().zip(values).zip(gradients) {
            (*value, *gradient) = found;
        }
        steps.advance(positions.len())
    })?;
    Ok(all)
}
