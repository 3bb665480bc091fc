//! The command, in this process.

use std::ffi::OsString;
use std::io::Write;

use pyo3::prelude::*;

/// Runs the command with the given words, of which the first is the program's own name. Returns the exit code.
#[pyfunction]
#[pyo3(signature = (words: "list[str]") -> "int")]
pub(crate) fn command(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| {
        let code = zeroset_cli::exit_code(words);
        // The runtime of Rust does this at the end of its own programs only. A reader that has gone is no failure.
        let _ = std::io::stdout().flush();
        code
    })
}

/// The version of the package.
#[pyfunction]
#[pyo3(signature = () -> "str")]
pub(crate) fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}
