//! The `zeroset` command as a library.
//!
//! What was typed ([`args`]) is resolved against files and clouds, then run: one module for each subcommand. Results go
//! to standard output, everything else to standard error.
//!
//! | exit code | meaning |
//! |---|---|
//! | 0 | done; also if the reader of a pipe has gone |
//! | 1 | failed: one line on standard error, `error: ...`, which names the file and the remedy |
//! | 2 | wrong usage |
//! | 130 | interrupted; no partial file is left |

pub mod args;

mod asprs;
mod compare;
mod completions;
mod console;
mod content;
mod error;
mod features;
mod fit2d;
mod info;
mod input;
mod interrupt;
pub mod memory;
mod model;
mod progress;
mod reconstruct;
mod render;
mod report;
mod sample;
mod simplify;
mod table;
mod threads;
mod view;

/// Compiles the examples of the README.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use args::{Args, Command};
use console::Console;
use error::CliError;

/// Exit code of a command that was interrupted: 128 and the number of SIGINT.
const INTERRUPTED: u8 = 130;

/// Exit code of a command that could not do what it was asked to.
const FAILED: u8 = 1;

/// Exit code for options that have no meaning together, as for those that the parser refuses.
const WRONG_USAGE: u8 = 2;

/// Runs the command with the given words, of which the first is the program's own name.
pub fn main(words: impl IntoIterator<Item = OsString>) -> ExitCode {
    ExitCode::from(exit_code(words))
}

/// The same for programs that end by themselves; returns the exit code. Listens for Ctrl-C from then on.
pub fn exit_code(words: impl IntoIterator<Item = OsString>) -> u8 {
    let args = match Args::try_parse_from(words) {
        Ok(args) => args,
        Err(message) => {
            // Help for a pager that has gone is no failure.
            let _ = message.print();
            return u8::try_from(message.exit_code()).unwrap_or(FAILED);
        }
    };
    interrupt::install();
    match run(args.command) {
        Ok(()) => 0,
        Err(error) if error.is_broken_pipe() => 0,
        Err(_) if interrupt::requested() => {
            zeroset_io::abandon_writes();
            Console::complain(interrupt::STOPPED);
            INTERRUPTED
        }
        Err(error) => {
            Console::complain(&format!("error: {error}"));
            if matches!(error, CliError::Usage(_)) { WRONG_USAGE } else { FAILED }
        }
    }
}

fn run(command: Command) -> Result<(), CliError> {
    match command {
        Command::Reconstruct(args) => reconstruct::run(&args),
        Command::Fit(args) => model::fit::run(&args),
        Command::Mesh(args) => model::mesh::run(&args),
        Command::Edit(args) => model::edit::run(&args),
        Command::Eval(args) => model::eval::run(&args),
        Command::Volume(args) => model::volume::run(&args),
        Command::Slice(args) => model::slice::run(&args),
        Command::Raster(args) => model::raster::run(&args),
        Command::Features(args) => features::run(&args),
        Command::Fit2d(args) => fit2d::run(&args),
        Command::Sample(args) => sample::run(&args),
        Command::Simplify(args) => simplify::run(&args),
        Command::Compare(args) => compare::run(&args),
        Command::Render(args) => render::run(&args),
        Command::View(args) => view::run(&args),
        Command::Info(args) => info::run(&args),
        Command::Completions(args) => completions::run(&args),
    }
}
