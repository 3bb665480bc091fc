//! The `zeroset` command. All it does is in the library of the same package.

use std::process::ExitCode;

fn main() -> ExitCode {
    zeroset_cli::main(std::env::args_os())
}
