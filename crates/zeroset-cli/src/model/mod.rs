//! The commands about models: one module for each.

pub(crate) mod edit;
pub(crate) mod eval;
pub(crate) mod fit;
pub(crate) mod mesh;
pub(crate) mod raster;
pub(crate) mod slice;
pub(crate) mod volume;

mod open;

pub(crate) use open::open;

use std::path::Path;

use serde::Serialize;
use zeroset::model::ModelError;
use zeroset_io::{WriteReport, shown};

use crate::args::BriefRunArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::progress::{Progress, with_progress};
use crate::threads;

/// How much to say.
fn console(run: &BriefRunArgs) -> Console {
    Console::unless(run.quiet)
}

/// Does something that may take long, on the threads that were asked for. `what` names the model in messages.
fn work<T>(
    run: &BriefRunArgs,
    what: &str,
    work: impl FnOnce(&Progress) -> Result<T, ModelError>,
) -> Result<T, CliError> {
    with_progress(console(run), work)?.map_err(|source| CliError::Model { what: what.to_owned(), source })
}

/// Starts the threads that were asked for.
fn start(run: &BriefRunArgs) -> Result<(), CliError> {
    threads::start(run.threads)
}

/// A file that was written, for reports.
#[derive(Debug, Serialize)]
struct Written {
    path: String,
    bytes: u64,
}

impl Written {
    fn new(path: &Path, report: &WriteReport) -> Self {
        Self { path: shown(path), bytes: report.bytes }
    }
}
