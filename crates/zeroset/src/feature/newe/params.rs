//! What to fit, and what can be wrong with it.

/// What keeps the coefficients of a flat from being zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Normalization {
    /// Unit normal: weighted total least squares. The flats move with the points.
    #[default]
    Affine,
    /// The squares of all coefficients sum to 1, the constant one included, as the paper prints it. The flats depend on where the
    /// origin is and on the unit of length.
    Homogeneous,
}

/// How many flats.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum FlatCount {
    /// This many.
    Exactly(usize),
    /// Chosen by the criterion, both ends included. A number that would leave fewer than D + 1 points for each flat is not tried.
    Between {
        /// At least this many.
        least: usize,
        /// At most this many.
        most: usize,
    },
}

impl FlatCount {
    pub(super) fn ends(self) -> (usize, usize) {
        match self {
            Self::Exactly(count) => (count, count),
            Self::Between { least, most } => (least, most),
        }
    }
}

/// How to fit.
#[derive(Debug, Clone, PartialEq)]
pub struct NeweParams {
    /// How many flats.
    pub flats: FlatCount,
    /// What keeps the coefficients from being zero.
    pub normalization: Normalization,
    /// The exponents of the weights, one for each iteration.
    pub schedule: Vec<f64>,
    /// How many starts are tried for each number of flats.
    pub starts: usize,
    /// Standard deviation of the points across their flats, in their unit; `None` measures it.
    pub noise: Option<f64>,
    /// Seed of the random starts.
    pub seed: u64,
    /// Whether to keep every iterate of the start that won.
    pub keep_iterates: bool,
}

impl Default for NeweParams {
    /// One to four flats, affine, the schedule of the paper, eight starts, the noise measured.
    fn default() -> Self {
        Self {
            flats: FlatCount::Between { least: 1, most: 4 },
            normalization: Normalization::Affine,
            schedule: halving_schedule(5),
            starts: 8,
            noise: None,
            seed: 0,
            keep_iterates: false,
        }
    }
}

/// The exponents of the paper, P_i = 2^(n+1-i) for i = 1 to n: 32, 16, 8, 4, 2 for n = 5.
#[must_use]
pub fn halving_schedule(n: u32) -> Vec<f64> {
    (1..=n).rev().map(|power| 2.0_f64.powi(i32::try_from(power).unwrap_or(i32::MAX))).collect()
}

/// A fit that could not be made.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum NeweError {
    /// No flats are asked for.
    #[error("no flats are asked for: give 1 or more")]
    NoFlats,
    /// The least number of flats is over the most.
    #[error("between {least} and {most} flats is an empty range: give the smaller number first")]
    EmptyRange {
        /// At least this many.
        least: usize,
        /// At most this many.
        most: usize,
    },
    /// The schedule has no exponents.
    #[error("the schedule is empty: give one exponent for each iteration, such as 32, 16, 8, 4, 2")]
    EmptySchedule,
    /// An exponent is not positive, or not finite.
    #[error("an exponent of {0} is not possible: give positive numbers")]
    Exponent(f64),
    /// No starts are asked for.
    #[error("no starts are asked for: give 1 or more")]
    NoStarts,
    /// The noise is negative or not finite.
    #[error("a noise of {0} is not possible: give a number of 0 or more, or have it measured")]
    Noise(f64),
    /// The points do not determine the flats.
    #[error("{given} points do not determine the flats: give {needed} or more, or ask for fewer flats")]
    TooFewPoints {
        /// How many were given.
        given: usize,
        /// How many are needed: D for each flat.
        needed: usize,
    },
    /// A coordinate is infinite or not a number.
    #[error("point {0} is not finite; remove it")]
    NotFinite(usize),
    /// Sums of squares overflow.
    #[error("the coordinates are too large: bring them below 1e150")]
    Extreme,
    /// Space has no dimensions.
    #[error("points without coordinates bear no flats: give points of one dimension or more")]
    NoDimensions,
}

impl NeweParams {
    /// Whether the parameters make sense.
    pub(super) fn check(&self) -> Result<(), NeweError> {
        let (least, most) = self.flats.ends();
        check_count(least)?;
        if least > most {
            return Err(NeweError::EmptyRange { least, most });
        }
        check_schedule(&self.schedule)?;
        if self.starts == 0 {
            return Err(NeweError::NoStarts);
        }
        self.noise.map_or(Ok(()), check_noise)
    }
}

pub(super) fn check_count(flats: usize) -> Result<(), NeweError> {
    if flats == 0 { Err(NeweError::NoFlats) } else { Ok(()) }
}

pub(super) fn check_noise(noise: f64) -> Result<(), NeweError> {
    if noise >= 0.0 && noise.is_finite() { Ok(()) } else { Err(NeweError::Noise(noise)) }
}

pub(super) fn check_schedule(schedule: &[f64]) -> Result<(), NeweError> {
    if schedule.is_empty() {
        return Err(NeweError::EmptySchedule);
    }
    match schedule.iter().find(|p| !(p.is_finite() && **p > 0.0)) {
        Some(&exponent) => Err(NeweError::Exponent(exponent)),
        None => Ok(()),
    }
}

/// Whether points of a kind and number can be fitted.
pub(super) fn check_points<const D: usize>(points: &[[f64; D]], flats: usize) -> Result<(), NeweError> {
    if D == 0 {
        return Err(NeweError::NoDimensions);
    }
    if let Some(at) = points.iter().position(|p| !p.iter().all(|c| c.is_finite())) {
        return Err(NeweError::NotFinite(at));
    }
    let needed = flats.saturating_mul(D);
    if points.len() < needed { Err(NeweError::TooFewPoints { given: points.len(), needed }) } else { Ok(()) }
}
