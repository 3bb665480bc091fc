//! Lines on standard error and text on standard output.

use std::io::{IsTerminal, Write};

use crate::args::RunArgs;
use crate::error::CliError;

/// How much to say beside results and errors.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Console {
    /// Nothing.
    Quiet,
    /// What was decided and done.
    Normal,
    /// Every figure.
    Verbose,
}

impl Console {
    /// As much as the user asked for.
    pub(crate) fn of(args: &RunArgs) -> Self {
        match (args.quiet, args.verbose) {
            (true, _) => Self::Quiet,
            (_, true) => Self::Verbose,
            _ => Self::Normal,
        }
    }

    /// What was decided and done, unless the user asked for quiet.
    pub(crate) fn unless(quiet: bool) -> Self {
        if quiet { Self::Quiet } else { Self::Normal }
    }

    /// A line for a user who did not ask for quiet.
    pub(crate) fn say(self, line: &str) {
        if self >= Self::Normal {
            Self::complain(line);
        }
    }

    /// A line for a user who asked for all of it.
    pub(crate) fn detail(self, line: &str) {
        if self >= Self::Verbose {
            Self::complain(line);
        }
    }

    /// A line for every user.
    pub(crate) fn complain(line: &str) {
        // Nobody is left to tell if standard error is closed.
        let _ = writeln!(std::io::stderr().lock(), "{line}");
    }

    /// Text that was asked for, to standard output.
    pub(crate) fn print(text: &str) -> Result<(), CliError> {
        let mut out = std::io::stdout().lock();
        out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)
    }
}

/// Lines about work that may still fail.
///
/// People at a terminal see each at once, and so does a user who asked for all figures. Elsewhere they wait for
/// [`release`](Self::release), so that a failure is one line and nothing else.
#[derive(Debug)]
pub(crate) struct Lines {
    console: Console,
    at_once: bool,
    held: Vec<String>,
}

impl Lines {
    pub(crate) fn new(console: Console) -> Self {
        let at_once = console == Console::Verbose || std::io::stderr().is_terminal();
        Self { console, at_once, held: Vec::new() }
    }

    /// A line for a user who did not ask for quiet.
    pub(crate) fn say(&mut self, line: String) {
        if self.at_once {
            self.console.say(&line);
        } else {
            self.held.push(line);
        }
    }

    /// The work is done: says what was held back.
    pub(crate) fn release(&mut self) {
        for line in self.held.drain(..) {
            self.console.say(&line);
        }
    }
}
