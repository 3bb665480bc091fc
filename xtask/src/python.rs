//! The Python package: built beside everything else, its types compared, its tests run.
//!
//! The library is the one that `cargo build --workspace` makes. A build by maturin selects one package, so that dependencies get other
//! features, and the whole engine would be compiled a second time.

use std::env::consts::{DLL_PREFIX, DLL_SUFFIX};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use crate::{Step, root, run, target};

/// What the tests need, by the names of the package index.
const PACKAGES: [&str; 6] = ["numpy", "distributed", "fsspec", "pytest", "mypy", "numpydoc"];

/// Whether the file of types is compared or written.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Types {
    Compare,
    Write,
}

/// Builds the package in place and tests it.
pub(crate) fn test() -> Result<(), String> {
    types(Types::Compare)?;
    let python = environment()?;
    let python = python.to_str().ok_or("the name of the folder is not UTF-8")?;
    call(python, &["-m", "mypy"])?;
    call(python, &["-m", "pytest"])
}

/// Builds the package in place, and compares or writes the types of its module.
pub(crate) fn types(what: Types) -> Result<(), String> {
    run(&Step { arguments: &["build", "--locked", "--workspace", "--all-targets"], environment: &[] })?;
    let package = root().join("python/zeroset");
    let built = target()?;
    let library = built.join(format!("{DLL_PREFIX}_core{DLL_SUFFIX}"));
    let suffix = if cfg!(windows) { "pyd" } else { "abi3.so" };
    // Not over the old one: a process may have it open.
    let own = package.join(format!("_core.{suffix}"));
    let _ = fs::remove_file(&own);
    fs::copy(&library, &own).map_err(|why| format!("`{}` cannot be copied: {why}", library.display()))?;

    let made = Command::new(built.join("examples/stubs")).arg(&library).output();
    let made = made.map_err(|why| format!("the types cannot be read: {why}"))?;
    if !made.status.success() {
        return Err(format!("the types cannot be read: {}", String::from_utf8_lossy(&made.stderr)));
    }
    let stub = package.join("_core.pyi");
    if what == Types::Write {
        return fs::write(&stub, made.stdout).map_err(|why| format!("`{}` cannot be written: {why}", stub.display()));
    }
    let kept = fs::read(&stub).unwrap_or_default();
    let same = kept == made.stdout;
    if same { Ok(()) } else { Err("python/zeroset/_core.pyi is out of date; run `cargo xtask stubs`".to_owned()) }
}

/// Makes a virtual environment that sees the package in place; returns its interpreter.
fn environment() -> Result<PathBuf, String> {
    let folder = target()?.join("python");
    let python = folder.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    if !python.exists() {
        let name = folder.to_str().ok_or("the name of the folder is not UTF-8")?;
        let made = call("python3", &["-m", "venv", "--clear", name]);
        made.map_err(|why| format!("{why}; install Python 3.10 or later with venv (Debian: python3-venv)"))?;
    }
    let interpreter = python.to_str().ok_or("the name of the folder is not UTF-8")?;
    let install = ["-m", "pip", "install", "--quiet", "--disable-pip-version-check"];
    call(interpreter, &[&install[..], &PACKAGES].concat())?;
    let site = Command::new(&python).args(["-c", "import sysconfig; print(sysconfig.get_path('purelib'))"]).output();
    let site = site.map_err(|why| format!("`{interpreter}` cannot be started: {why}"))?;
    let link = Path::new(String::from_utf8_lossy(&site.stdout).trim()).join("zeroset.pth");
    let sources = fs::canonicalize(root().join("python")).map_err(|why| format!("there is no folder python: {why}"))?;
    fs::write(&link, format!("{}\n", sources.display())).map_err(|why| format!("`{}`: {why}", link.display()))?;
    Ok(python)
}

/// Runs a program in the root of the repository; the error says which one failed.
fn call(program: &str, arguments: &[&str]) -> Result<(), String> {
    let line = format!("{program} {}", arguments.join(" "));
    eprintln!("> {line}");
    let status = Command::new(program).args(arguments).current_dir(root()).status();
    let status = status.map_err(|why| format!("`{program}` cannot be started: {why}"))?;
    if status.success() { Ok(()) } else { Err(format!("`{line}` failed: {status}")) }
}
