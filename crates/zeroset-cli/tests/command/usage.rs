//! What is typed: help, wrong usage, pipes.

use std::io::Read;
use std::process::Stdio;

use crate::common::{folder, line, run, zeroset};

#[test]
fn help_tells_what_there_is() {
    let folder = folder();
    let help = line(folder.path(), "--help").ok().stdout;
    for command in
        ["reconstruct", "features", "fit2d", "sample", "simplify", "compare", "render", "view", "info", "completions"]
    {
        assert!(help.contains(command), "{command}");
        let own = line(folder.path(), &format!("{command} --help")).ok().stdout;
        assert!(own.contains("Usage: zeroset"), "{own}");
        assert!(command == "completions" || own.contains("Examples:"), "{own}");
    }
    let own = line(folder.path(), "reconstruct --help").ok().stdout;
    for option in [
        "--scene",
        "--up",
        "--resolution",
        "--depth",
        "--classes",
        "--exclude",
        "--bounds",
        "--outliers",
        "--quality",
        "--smooth",
        "--screening",
        "--trim",
        "--min-component",
        "--triangles",
        "--max-error",
        "--attributes",
        "--threads",
        "--memory",
        "--report",
        "--quiet",
        "--verbose",
        "--dry-run",
    ] {
        assert!(own.contains(option), "{option}");
    }
    let own = line(folder.path(), "features --help").ok().stdout;
    for option in ["--scene", "--min-area", "--max-distance", "--max-angle", "--sharp-angle", "--bounds", "--report"] {
        assert!(own.contains(option), "{option}");
    }
    assert!(line(folder.path(), "-V").ok().stdout.contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_usage_exits_with_2() {
    let folder = folder();
    for words in [
        "",
        "fly",
        "reconstruct",
        "reconstruct in.xyz",
        "reconstruct in.xyz -o out.ply --resolution 0",
        "reconstruct in.xyz -o out.ply --resolution nan",
        "reconstruct in.xyz -o out.ply --resolution 1 --depth 5",
        "reconstruct in.xyz -o out.ply --scene moon",
        "reconstruct in.xyz -o out.ply --up w",
        "reconstruct in.xyz -o out.ply --classes 256",
        "reconstruct in.xyz -o out.ply --bounds 1,2,3",
        "reconstruct in.xyz -o out.ply --bounds 3,0,1,1",
        "reconstruct in.xyz -o out.ply --outliers some",
        "reconstruct in.xyz -o out.ply --min-component 0",
        "reconstruct in.xyz -o out.ply --threads 0",
        "reconstruct in.xyz -o out.ply --memory much",
        "reconstruct in.xyz -o out.ply --quiet --verbose",
        "reconstruct in.xyz -o out.ply --triangles 0",
        "reconstruct in.xyz -o out.ply --max-error 0",
        "simplify in.ply",
        "simplify in.ply -o out.ply",
        "simplify in.ply -o out.ply --triangles 0",
        "simplify in.ply -o out.ply --triangles some",
        "simplify in.ply -o out.ply --max-error -1",
        "simplify in.ply -o out.ply --max-error nan",
        "simplify in.ply -o out.ply --max-error 1 --sharp-angle 180",
        "simplify a.ply b.ply -o out.ply --triangles 5",
        "sample moon -o out.xyz",
        "sample torus",
        "sample torus -o out.xyz --points 0",
        "compare a.ply",
        "compare a.ply b.ply --sharp-angle 200",
        "compare --features a.json",
        "compare --features a.json b.ply c.ply",
        "compare --features a.json b.ply --samples 100",
        "compare --features a.json b.ply --min-points 3",
        "compare a.ply b.ply --cloud c.xyz",
        "compare a.ply b.ply --corner-tolerance 1",
        "features",
        "features in.xyz",
        "features in.xyz -o out.json --min-area 0",
        "features in.xyz -o out.json --max-distance -1",
        "features in.xyz -o out.json --max-angle 90",
        "features in.xyz -o out.json --sharp-angle 180",
        "features in.xyz -o out.json --scene moon",
        "features in.xyz -o out.json --classes 256",
        "features in.xyz -o out.json --memory much",
        "features in.xyz -o out.json --quiet --verbose",
        "features in.xyz -o out.json --resolution 1",
        "info",
    ] {
        let outcome = line(folder.path(), words);
        assert_eq!(outcome.code, Some(2), "{words}: {}", outcome.stderr);
        assert!(!outcome.stderr.is_empty(), "{words}");
    }
}

#[test]
fn completions_are_for_this_command() {
    let folder = folder();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        assert!(run(folder.path(), ["completions", shell]).ok().stdout.contains("reconstruct"), "{shell}");
    }
}

#[test]
fn manual_pages_tell_every_option() {
    use clap::CommandFactory;
    let folder = folder();
    clap_mangen::generate_to(zeroset_cli::args::Args::command(), folder.path()).unwrap();
    let commands =
        ["reconstruct", "features", "fit2d", "sample", "simplify", "compare", "render", "view", "info", "completions"];
    for command in commands {
        let page = std::fs::read_to_string(folder.path().join(format!("zeroset-{command}.1"))).unwrap();
        assert!(page.contains(".SH SYNOPSIS"), "{page}");
        let own = zeroset_cli::args::Args::command();
        let own = own.find_subcommand(command).unwrap();
        for option in own.get_arguments().filter_map(|argument| argument.get_long()) {
            assert!(page.contains(&option.replace('-', "\\-")), "{command} --{option}");
        }
    }
    let main = std::fs::read_to_string(folder.path().join("zeroset.1")).unwrap();
    assert!(commands.iter().all(|command| main.contains(command)), "{main}");
}

#[test]
fn a_reader_that_goes_is_no_error() {
    let folder = folder();
    let mut command = zeroset(folder.path());
    command.args(["sample", "torus", "-o", "-", "--points", "200000"]);
    let mut child = command.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    let mut first = [0; 100];
    child.stdout.take().unwrap().read_exact(&mut first).unwrap();
    let output = child.wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(0));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}
