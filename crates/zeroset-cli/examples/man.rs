//! Writes the manual pages, one for the command and one for each subcommand, into a folder: `cargo xtask man DIR`.

use std::path::PathBuf;
use std::process::ExitCode;

use clap::CommandFactory;
use zeroset_cli::args::Args;

fn main() -> ExitCode {
    let Some(folder) = std::env::args_os().nth(1).map(PathBuf::from) else {
        eprintln!("Usage: man DIR");
        return ExitCode::from(2);
    };
    let written = std::fs::create_dir_all(&folder).and_then(|()| clap_mangen::generate_to(Args::command(), &folder));
    match written {
        Ok(()) => ExitCode::SUCCESS,
        Err(why) => {
            eprintln!("error: {}: {why}", folder.display());
            ExitCode::FAILURE
        }
    }
}
