//! How many threads work.

use std::num::NonZeroUsize;

use crate::error::CliError;

/// Starts as many threads as were asked for; all, if none were.
pub(crate) fn start(threads: Option<NonZeroUsize>) -> Result<(), CliError> {
    if let Some(threads) = threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global()?;
    }
    Ok(())
}
