//! Chores of the repository: `cargo xtask CHORE`.
//!
//! | chore | does |
//! |---|---|
//! | `browser` | the tests of the page of `zeroset view`, in Chromium |
//! | `check` | formatting, lints and documentation, all with warnings as errors |
//! | `man DIR` | the manual pages of the command, written into a folder |
//! | `python` | the Python package: built in place, its types checked, its tests run |
//! | `stubs` | writes the types of the module `zeroset._core` |
//! | `web` | the page of `zeroset view`, built into the next build of the command; needs Node.js 20.19 or later |
//!
//! The exit code is 0 if all went well, 1 if a step failed, and 2 for wrong usage.

mod python;
mod web;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

const USAGE: &str = "\
Usage: cargo xtask CHORE

Chores:
  browser  the tests of the page of `zeroset view`, in Chromium
  check    formatting, lints and documentation, all with warnings as errors
  man DIR  the manual pages of the command, written into a folder
  python   the Python package: built in place, its types checked, its tests run
  stubs    writes the types of the module `zeroset._core`
  web      the page of `zeroset view`, for the next build of the command; needs Node.js 20.19 or later";

/// One run of cargo.
struct Step<'a> {
    arguments: &'a [&'a str],
    environment: &'a [(&'a str, &'a str)],
}

const CHECK: [Step<'static>; 3] = [
    Step { arguments: &["fmt", "--all", "--check"], environment: &[] },
    Step {
        arguments: &["clippy", "--locked", "--workspace", "--all-targets", "--", "-D", "warnings"],
        environment: &[],
    },
    Step {
        arguments: &["doc", "--locked", "--workspace", "--no-deps"],
        environment: &[("RUSTDOCFLAGS", "-D warnings")],
    },
];

fn main() -> ExitCode {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let words: Vec<_> = arguments.iter().map(|word| word.to_str()).collect();
    let outcome = match words[..] {
        [Some("browser")] => web::test(),
        [Some("check")] => CHECK.iter().try_for_each(run),
        [Some("man"), Some(folder)] => man(folder),
        [Some("python")] => python::test(),
        [Some("stubs")] => python::types(python::Types::Write),
        [Some("web")] => web::build(),
        [Some("help" | "-h" | "--help")] => {
            println!("{USAGE}");
            Ok(())
        }
        _ => {
            eprintln!("{USAGE}");
            return ExitCode::from(2);
        }
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {why}");
            ExitCode::FAILURE
        }
    }
}

/// Writes the manual pages. They are made by an example of the command's own crate, so that no other chore has to build it.
fn man(folder: &str) -> Result<(), String> {
    let folder = std::path::absolute(folder).map_err(|e| format!("`{folder}` is no folder: {e}"))?;
    let folder = folder.to_str().ok_or("the name of the current folder is not UTF-8")?;
    let arguments = ["run", "--locked", "--quiet", "-p", "zeroset-cli", "--example", "man", "--", folder];
    run(&Step { arguments: &arguments, environment: &[] })
}

/// Where cargo puts what it builds: xtask itself is there.
fn target() -> Result<PathBuf, String> {
    let own = std::env::current_exe().map_err(|why| format!("xtask does not know where it is: {why}"))?;
    Ok(own.parent().map(Path::to_path_buf).unwrap_or_default())
}

/// The root of the repository.
fn root() -> &'static Path {
    Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/.."))
}

/// Runs a step in the root of the repository; the error says which one failed.
fn run(step: &Step<'_>) -> Result<(), String> {
    // Cargo tells its children which cargo it is. A built xtask called by hand takes the one on the path.
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let line = format!("cargo {}", step.arguments.join(" "));
    eprintln!("> {line}");
    let status = Command::new(cargo)
        .args(step.arguments)
        .envs(step.environment.iter().copied())
        .current_dir(root())
        .status()
        .map_err(|e| format!("`{line}` cannot be started: {e}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{line}` failed: {status}")) }
}
