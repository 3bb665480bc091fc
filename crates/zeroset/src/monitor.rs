//! Progress out, cancellation in.

use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Watches a long computation. The library calls it; the caller shows progress and says when to stop.
///
/// Every method has a default that does nothing, so `&()` is a monitor that watches nothing.
pub trait Monitor: Sync {
    /// A stage begins. `name` is a short verb phrase for people, such as "fitting level 3 of 6".
    fn stage(&self, _name: &str) {}

    /// The share of the whole computation that is done, in 0..=1. Never falls within one computation.
    fn share(&self, _done: f64) {}

    /// Whether the computation should end early. Asked often; must be cheap.
    fn cancelled(&self) -> bool {
        false
    }
}

impl Monitor for () {}

/// The computation ended early because the monitor asked for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

/// `Err(Cancelled)` once the monitor wants to stop, for use with `?` between steps.
///
/// # Errors
/// [`Cancelled`] if the monitor asked to stop.
pub fn check(monitor: &dyn Monitor) -> Result<(), Cancelled> {
    if monitor.cancelled() { Err(Cancelled) } else { Ok(()) }
}

/// Counts the steps of work on many threads and tells a monitor the share that is done.
///
/// ```
/// use zeroset::monitor::Steps;
/// let steps = Steps::new(&(), 0.5..0.75, 200);
/// steps.advance(100)?; // The monitor hears of 0.625.
/// # Ok::<(), zeroset::monitor::Cancelled>(())
/// ```
pub struct Steps<'a> {
    monitor: &'a dyn Monitor,
    shares: Range<f64>,
    total: usize,
    done: Mutex<usize>,
}

impl<'a> Steps<'a> {
    /// `total` steps, which take the whole from the share `shares.start` to `shares.end`. The total may be a guess: the
    /// share stays at the end if more steps come.
    #[must_use]
    pub fn new(monitor: &'a dyn Monitor, shares: Range<f64>, total: usize) -> Self {
        Self { monitor, shares, total: total.max(1), done: Mutex::new(0) }
    }

    /// `steps` more are done. Takes a lock: meant for some thousand steps of short work at a time.
    ///
    /// # Errors
    /// [`Cancelled`] if the monitor asked to stop.
    pub fn advance(&self, steps: usize) -> Result<(), Cancelled> {
        // The monitor is told under the lock, or a late thread could make the share fall.
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += steps;
        let part = (*done as f64 / self.total as f64).min(1.0);
        self.monitor.share(self.shares.start + part * (self.shares.end - self.shares.start));
        drop(done);
        check(self.monitor)
    }
}

/// A monitor of a part of a computation: its whole is a range of shares of the other's.
pub(crate) struct Part<'a> {
    monitor: &'a dyn Monitor,
    shares: Range<f64>,
}

impl<'a> Part<'a> {
    /// The part from the share `shares.start` to `shares.end`.
    pub(crate) fn new(monitor: &'a dyn Monitor, shares: Range<f64>) -> Self {
        Self { monitor, shares }
    }
}

impl Monitor for Part<'_> {
    fn stage(&self, name: &str) {
        self.monitor.stage(name);
    }

    fn share(&self, done: f64) {
        self.monitor.share(self.shares.start + done * (self.shares.end - self.shares.start));
    }

    fn cancelled(&self) -> bool {
        self.monitor.cancelled()
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use rayon::prelude::*;

    /// Keeps what it is told, and stops after so many shares.
    pub(crate) struct Log(pub(crate) Mutex<Vec<f64>>, pub(crate) usize);

    impl Monitor for Log {
        fn share(&self, done: f64) {
            self.0.lock().unwrap().push(done);
        }

        fn cancelled(&self) -> bool {
            self.0.lock().unwrap().len() >= self.1
        }
    }

    #[test]
    fn shares_of_many_threads_never_fall() {
        let log = Log(Mutex::default(), usize::MAX);
        let steps = Steps::new(&log, 0.2..0.6, 1000);
        (0..120).into_par_iter().try_for_each(|_| steps.advance(10)).unwrap();
        let shares = log.0.into_inner().unwrap();
        assert!(shares.is_sorted() && shares[0] > 0.2, "{shares:?}");
        // More steps than were announced.
        assert_eq!(shares[119], 0.6);
    }

    #[test]
    fn the_monitor_stops_the_steps() {
        let log = Log(Mutex::default(), 3);
        let steps = Steps::new(&log, 0.0..1.0, 10);
        assert_eq!([(); 4].map(|()| steps.advance(1).is_ok()), [true, true, false, false]);
    }
}
