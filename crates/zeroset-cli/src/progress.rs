//! Progress on a terminal.

use std::io::IsTerminal;
use std::sync::Once;
use std::time::{Duration, Instant};

use indicatif::style::ProgressTracker;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};
use zeroset::monitor::Monitor;

use crate::console::Console;
use crate::error::CliError;
use crate::interrupt;

/// Steps of the bar.
const STEPS: u64 = 1000;

/// Shows stage, share and time left on standard error, and passes Ctrl-C on.
///
/// Until the first share comes there is no bar, which would stand still, but the time that has passed.
///
/// Nothing is shown unless standard error is a terminal and the user may be spoken to.
#[derive(Debug)]
pub(crate) struct Progress {
    bar: ProgressBar,
    /// Done when the first share has come.
    measured: Once,
}

/// The time left, from the last share that came and the time since then.
#[derive(Debug, Clone, Default)]
struct TimeLeft {
    share: f64,
    /// When it came, after the start.
    spent: Duration,
}

impl ProgressTracker for TimeLeft {
    fn clone_box(&self) -> Box<dyn ProgressTracker> {
        Box::new(self.clone())
    }

    fn tick(&mut self, state: &ProgressState, _now: Instant) {
        let share = state.pos() as f64 / STEPS as f64;
        if share != self.share {
            *self = Self { share, spent: state.elapsed() };
        }
    }

    fn reset(&mut self, _state: &ProgressState, _now: Instant) {
        *self = Self::default();
    }

    fn write(&self, state: &ProgressState, out: &mut dyn std::fmt::Write) {
        let since = state.elapsed().saturating_sub(self.spent);
        // The terminal's own buffer takes any text.
        let _ = out.write_str(&time_left(self.share, self.spent, since));
    }
}

impl Progress {
    pub(crate) fn new(console: Console) -> Self {
        if console == Console::Quiet || !std::io::stderr().is_terminal() {
            return Self { bar: ProgressBar::hidden(), measured: Once::new() };
        }
        let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:32} {elapsed}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        Self { bar, measured: Once::new() }
    }

    /// Takes the bar away, so that lines can follow.
    pub(crate) fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

impl Monitor for Progress {
    fn stage(&self, name: &str) {
        self.bar.set_message(name.to_owned());
    }

    fn share(&self, done: f64) {
        self.measured.call_once(|| {
            if let Ok(style) = ProgressStyle::with_template("{spinner} {msg:32} [{bar:24}] {percent:>3} % {left}") {
                self.bar.set_style(style.progress_chars("=> ").with_key("left", TimeLeft::default()));
            }
        });
        self.bar.set_position((done.clamp(0.0, 1.0) * STEPS as f64) as u64);
    }

    fn cancelled(&self) -> bool {
        interrupt::requested()
    }
}

/// Does work that shows its progress and looks often whether the user wants to stop.
///
/// # Errors
/// [`CliError::Interrupted`] if the user wants to stop, whatever the work returned.
pub(crate) fn with_progress<T>(console: Console, work: impl FnOnce(&Progress) -> T) -> Result<T, CliError> {
    let progress = Progress::new(console);
    interrupt::watched(|| work(&progress))
}

/// The time left, in words, if `share` was done after `spent`, and `since` has passed then.
fn time_left(share: f64, spent: Duration, since: Duration) -> String {
    // The first hundredth says too little about the rest.
    if share < 0.01 {
        return String::new();
    }
    let left = spent.as_secs_f64() * (1.0 / share - 1.0) - since.as_secs_f64();
    match left.ceil() {
        s if s < 1.0 => "almost done".to_owned(),
        s if s < 90.0 => format!("{s:.0} s left"),
        s => format!("{:.0} min left", (s / 60.0).ceil()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_counts_down_between_shares() {
        let seconds = Duration::from_secs;
        assert_eq!(time_left(0.0, seconds(1), seconds(0)), "");
        assert_eq!(time_left(0.25, seconds(10), seconds(0)), "30 s left");
        assert_eq!(time_left(0.25, seconds(10), seconds(12)), "18 s left");
        assert_eq!(time_left(0.25, seconds(10), seconds(40)), "almost done");
        assert_eq!(time_left(0.01, seconds(6), seconds(0)), "10 min left");
    }
}
