//! Progress out, cancellation in.

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
