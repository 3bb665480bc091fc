//! The page of `zeroset view`.

use std::env::consts::EXE_SUFFIX;
use std::path::PathBuf;
use std::process::Command;

use crate::{Step, run, target};

/// Fetches what the page is made of, at the versions of its lock file, and builds it.
pub(crate) fn build() -> Result<(), String> {
    npm(&["ci", "--no-audit", "--no-fund"], &[])?;
    npm(&["run", "build"], &[])
}

/// Clicks through the page of the command, as it is built for the tests, after [`build`].
pub(crate) fn test() -> Result<(), String> {
    if !page().join("node_modules").is_dir() {
        return Err("there is no page yet; run `cargo xtask web` first".to_owned());
    }
    run(&Step { arguments: &["build", "--locked", "--workspace", "--all-targets"], environment: &[] })?;
    let command = target()?.join(format!("zeroset{EXE_SUFFIX}"));
    let command = command.to_str().ok_or("the name of the folder is not UTF-8")?;
    npm(&["test"], &[("ZEROSET", command)])
}

fn page() -> PathBuf {
    crate::root().join("crates/zeroset-view/page")
}

fn npm(arguments: &[&str], environment: &[(&str, &str)]) -> Result<(), String> {
    let words = arguments.join(" ");
    let status = Command::new("npm").args(arguments).envs(environment.iter().copied()).current_dir(page()).status();
    let status = status.map_err(|e| format!("npm cannot be run: {e}; install Node.js 20.19 or later"))?;
    if status.success() { Ok(()) } else { Err(format!("`npm {words}` failed")) }
}
