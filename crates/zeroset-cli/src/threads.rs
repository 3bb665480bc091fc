//! How many threads work.

use crate::args::RunArgs;
use crate::error::CliError;

/// Starts as many threads as were asked for; all, if none were.
pub(crate) fn start(args: &RunArgs) -> Result<(), CliError> {
    if let Some(threads) = args.threads {
        rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build_global()?;
    }
    Ok(())
}
