//! `zeroset view`.

mod layers;

use zeroset_view::serve::Viewer;

use self::layers::Files;
use crate::args::ViewArgs;
use crate::console::Console;
use crate::content::{is_input, is_possible};
use crate::error::CliError;
use crate::input::{check_is_file, is_stream, up_axis, up_name};
use crate::{interrupt, threads};

pub(crate) fn run(args: &ViewArgs) -> Result<(), CliError> {
    let console = Console::unless(args.quiet);
    for file in args.files.iter().chain(&args.distance_to) {
        if is_stream(file) {
            return Err(CliError::Usage("standard input is not shown; write it into a file first".into()));
        }
        check_is_file(file)?;
        is_possible(file)?;
    }
    threads::start(args.threads)?;
    let loader = Files::new(up_axis(args.up), args.distance_to.clone());
    let viewer = Viewer::bind(args.port, up_name(args.up), loader)?;
    let address = viewer.address();
    Console::print(&format!("{address}\n"))?;
    if !args.no_open && open::that_detached(&address).is_err() {
        console.say("no browser could be opened; open the address in one");
    }
    console.say("the page is for this machine alone; Ctrl-C ends it");
    // What others are coloured by comes first.
    let mut files = args.files.clone();
    files.sort_by_key(|file| is_input(file));
    match interrupt::watched(|| viewer.run(files, interrupt::requested)) {
        // That is how it ends.
        Err(CliError::Interrupted) => Ok(()),
        other => Ok(other??),
    }
}
