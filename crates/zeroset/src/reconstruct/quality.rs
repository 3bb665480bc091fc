//! How much is done for the surface.

use serde::{Deserialize, Serialize};

use crate::fit::cascade::PolishParams;

/// How much is done for the surface after the fit.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quality {
    /// Nothing: the zero set of the cascade. The fastest look.
    Draft,
    /// Planes are found, F is polished, and the mesh is made sharp at edges and corners.
    #[default]
    Normal,
    /// The same on cells two thirds as wide, with more rounds of polish: for few or precious points.
    Fine,
}

/// Rounds of polish. On smooth bodies the second halves what is left to do, and a fourth changes distances to the truth by less than a
/// hundredth.
const ROUNDS: usize = 3;
const FINE_ROUNDS: usize = 5;
/// The usual weight of smoothness. With a third of it the surface follows the noise a little more; three times as much changes little, as the
/// weight of the data then decides.
const SMOOTHNESS: f64 = 3.0;
/// The weight of the data in the polish over that in the cascade. The order-2 energy of the polish needs less weight for the same trust: a sphere with
/// noise of a quarter of a cell lies .00040, .00033 and .00027 from the truth with weights of 4, 2 and 0.5, but thin parts shrink
/// below 1.
const SCREENING_REL: f64 = 0.7;

impl Quality {
    /// The automatic resolution over that of the other qualities.
    pub(super) fn resolution_rel(self) -> f64 {
        if self == Self::Fine { 2.0 / 3.0 } else { 1.0 }
    }

    /// How F is polished, given the weight of the data in the cascade; `smoothness` replaces the usual weight.
    pub(super) fn polish(self, screening: f64, smoothness: Option<f64>) -> Option<PolishParams> {
        let rounds = match self {
            Self::Draft => return None,
            Self::Normal => ROUNDS,
            Self::Fine => FINE_ROUNDS,
        };
        let smoothness = smoothness.unwrap_or(SMOOTHNESS);
        Some(PolishParams { screening: SCREENING_REL * screening, smoothness, rounds })
    }
}
