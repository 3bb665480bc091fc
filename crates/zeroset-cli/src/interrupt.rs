//! Ctrl-C.
//!
//! The first one raises a flag, which a computation looks at through its
//! [`Monitor`](zeroset::monitor::Monitor). Reading and writing of files look at nothing, so there the process ends at
//! once. The second one ends the process at once wherever it is. Temporary files are removed each time.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use crate::INTERRUPTED;
use crate::console::Console;
use crate::error::CliError;

/// What the user is told.
pub(crate) const STOPPED: &str = "interrupted: no unfinished file is left";

static REQUESTED: AtomicBool = AtomicBool::new(false);
/// Number of computations under way that look at the flag.
static WATCHED: AtomicUsize = AtomicUsize::new(0);

/// Listens for Ctrl-C, and for the signals by which a system asks a process to end.
pub(crate) fn install() {
    let listening = ctrlc::set_handler(|| {
        let again = REQUESTED.swap(true, Ordering::SeqCst);
        if again || WATCHED.load(Ordering::SeqCst) == 0 {
            zeroset_io::abandon_writes();
            Console::complain(STOPPED);
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    // Without a handler the system ends the process, which may leave a temporary file: not worth refusing to work.
    drop(listening);
}

/// Whether the user wants to stop.
pub(crate) fn requested() -> bool {
    REQUESTED.load(Ordering::SeqCst)
}

/// Runs work that looks at [`requested`] often.
///
/// # Errors
/// [`CliError::Interrupted`] if the user wants to stop, whatever the work returned.
pub(crate) fn watched<T>(work: impl FnOnce() -> T) -> Result<T, CliError> {
    struct Watch;
    impl Drop for Watch {
        fn drop(&mut self) {
            WATCHED.fetch_sub(1, Ordering::SeqCst);
        }
    }
    WATCHED.fetch_add(1, Ordering::SeqCst);
    let watch = Watch;
    let result = work();
    // Only then the handler ends the process itself, so no request falls between.
    drop(watch);
    if requested() { Err(CliError::Interrupted) } else { Ok(result) }
}
