//! Whether a fit can be trusted.

use super::Minimum;

/// What may be wrong with a fit, with the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Warning {
    /// Functions that no datum and no smoothness says anything about. They were left out.
    #[error(
        "{count} of the functions touch no data and were left out, the first of them {first}: F is not known there; take fewer cells, or smoothness of order 1 or 2"
    )]
    Unconstrained {
        /// How many.
        count: usize,
        /// The first of them.
        first: usize,
    },
    /// The least value is zero more than once: the Gram matrix is not positive definite, and F is any of many.
    #[error(
        "F is not unique: the {count} least values of the spectrum are zero, so the matrix of the energy is not positive definite; take fewer cells, or fewer or narrower radial functions, or smoothness of order 1 or 2"
    )]
    NotUnique {
        /// How many of those computed.
        count: usize,
    },
    /// F lives on one or two functions.
    #[error(
        "F sits on {nodes:.1} of {functions} functions, where data are few, and is almost zero elsewhere; take fewer cells, smoothness of order 2, or the normalisation by gradients"
    )]
    Localised {
        /// Effective number of functions, 1 / sum of fourth powers of the unit coefficients.
        nodes: f64,
        /// Number of functions.
        functions: usize,
    },
    /// F is steep at a small part of the data only.
    #[error(
        "F is steep at {share:.3} of the data only, and almost zero at the rest; take fewer cells, more smoothness of order 2, or the normalisation by the mean gradient"
    )]
    Uneven {
        /// (mean |grad F|)^2 / mean |grad F|^2 over the data.
        share: f64,
    },
    /// The steps, or the solver, did not come to rest.
    #[error(
        "the steps did not come to rest, so F may be wrong; allow more of them, take another solver, or less smoothness"
    )]
    NotAtRest,
}

/// Whether a fit can be trusted.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// (sum F_j^2)^2 / (M sum F_j^4) over the M functions that are constrained: 1 where all are equal, 1 / M where one rules.
    pub participation_ratio: f64,
    /// (mean |grad F|)^2 / mean |grad F|^2 over the data: 1 where F is equally steep at all, near 0 where it is steep at a few.
    pub gradient_participation: f64,
    /// Functions that nothing constrains, ascending.
    pub unconstrained: Vec<usize>,
    /// How many of the values computed are zero.
    pub zero_values: usize,
    /// What may be wrong.
    pub warnings: Vec<Warning>,
}

/// Values below this share of the size of E over that of N count as zero.
const ZERO: f64 = 1e-12;
/// F is localised if it sits on fewer functions than this.
const NODES: f64 = 1.5;
/// Gradients are uneven if their participation is less than this.
const UNEVEN: f64 = 0.05;

impl Diagnosis {
    /// Looks at the minimum, and at the weights and lengths of the gradients at the samples.
    pub(super) fn of(minimum: &Minimum, unconstrained: &[bool], gradients: &[(f64, f64)]) -> Self {
        let coefficients = &minimum.coefficients;
        let largest = coefficients.iter().fold(0.0_f64, |m, f| m.max(f.abs())).max(f64::MIN_POSITIVE);
        let moment = |power: i32| coefficients.iter().map(|f| (f / largest).powi(power)).sum::<f64>();
        let nodes = moment(2).powi(2) / moment(4);
        let functions = coefficients.len();
        let sums = gradients.iter().fold([0.0; 3], |[w, g, gg], &(weight, length)| {
            [w + weight, g + weight * length, gg + weight * length * length]
        });
        let gradient_participation = if sums[2] > 0.0 { sums[1] * sums[1] / (sums[0] * sums[2]) } else { 0.0 };
        let unconstrained: Vec<usize> =
            unconstrained.iter().enumerate().filter(|(_, free)| **free).map(|(j, _)| j).collect();
        let zero_values = minimum.spectrum.iter().filter(|&&v| v <= ZERO * minimum.scale).count();
        let mut warnings = Vec::new();
        if let Some(&first) = unconstrained.first() {
            warnings.push(Warning::Unconstrained { count: unconstrained.len(), first });
        }
        if zero_values > 1 {
            warnings.push(Warning::NotUnique { count: zero_values });
        }
        if nodes < NODES && functions > 4 {
            warnings.push(Warning::Localised { nodes, functions });
        }
        if gradient_participation < UNEVEN {
            warnings.push(Warning::Uneven { share: gradient_participation });
        }
        if !minimum.at_rest {
            warnings.push(Warning::NotAtRest);
        }
        let participation_ratio = nodes / functions.max(1) as f64;
        Self { participation_ratio, gradient_participation, unconstrained, zero_values, warnings }
    }
}
