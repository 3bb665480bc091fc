//! Intervals of numbers.

/// All numbers from `low` to `high`, both included.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Interval {
    /// The lowest.
    pub low: f64,
    /// The highest.
    pub high: f64,
}

impl Interval {
    /// All numbers.
    pub const ALL: Self = Self { low: f64::NEG_INFINITY, high: f64::INFINITY };

    /// The numbers no farther than `radius` from `middle`; all where either is not a number.
    #[must_use]
    pub fn around(middle: f64, radius: f64) -> Self {
        // Differences round by half a bit of the result.
        let (low, high) = ((middle - radius).next_down(), (middle + radius).next_up());
        if low <= high { Self { low, high } } else { Self::ALL }
    }

    /// Whether a number is among them.
    #[must_use]
    pub fn contains(self, x: f64) -> bool {
        self.low <= x && x <= self.high
    }

    /// The least of one number from each.
    #[must_use]
    pub fn min(self, other: Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.min(other.high) }
    }

    /// The greatest of one number from each.
    #[must_use]
    pub fn max(self, other: Self) -> Self {
        Self { low: self.low.max(other.low), high: self.high.max(other.high) }
    }

    /// All numbers times a positive one.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        Self { low: (self.low * factor).next_down(), high: (self.high * factor).next_up() }
    }

    /// All numbers plus one.
    #[must_use]
    pub fn plus(self, x: f64) -> Self {
        Self { low: (self.low + x).next_down(), high: (self.high + x).next_up() }
    }
}

impl std::ops::Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self { low: -self.high, high: -self.low }
    }
}
