//! Names of files that can be told to be wrong before anything is read.

use std::path::{Path, PathBuf};

use zeroset_io::{CloudFormat, IoError, MeshFormat, check_writable, shown};

use crate::error::CliError;

/// Looks at the inputs: known suffixes, files that are there. Returns their formats.
pub(crate) fn check_inputs(inputs: &[PathBuf]) -> Result<Vec<CloudFormat>, CliError> {
    let formats = inputs.iter().map(|path| CloudFormat::from_path(path)).collect::<Result<_, _>>()?;
    let standard_input = inputs.iter().filter(|path| is_stream(path)).count();
    if standard_input > 1 {
        return Err(same(Path::new("-"), "an input", "another input"));
    }
    for input in inputs.iter().filter(|path| !is_stream(path)) {
        check_is_file(input)?;
    }
    Ok(formats)
}

/// Refuses what is not there, and folders.
pub(crate) fn check_is_file(path: &Path) -> Result<(), IoError> {
    let facts = std::fs::metadata(path).map_err(|source| IoError::from_system(path, source))?;
    if facts.is_dir() { Err(IoError::IsDirectory { path: path.to_path_buf() }) } else { Ok(()) }
}

/// Looks at the files that will be written: they can be, are no inputs, and are all different. Standard output takes
/// only one of them.
pub(crate) fn check_outputs(inputs: &[PathBuf], outputs: &[(&Path, &'static str)]) -> Result<(), CliError> {
    for (i, &(path, role)) in outputs.iter().enumerate() {
        if !is_stream(path) {
            if inputs.iter().any(|input| is_same(input, path)) {
                return Err(same(path, "an input", role));
            }
            check_writable(path)?;
        }
        for &before in &outputs[..i] {
            if is_stream(path) && is_stream(before.0) {
                return Err(CliError::BothToStream { first: before.1, second: role });
            }
            if !is_stream(path) && !is_stream(before.0) {
                refuse_same(before, (path, role))?;
            }
        }
    }
    Ok(())
}

/// The same for one output and a report, as far as they are asked for.
pub(crate) fn check_output_and_report(
    inputs: &[PathBuf],
    output: Option<&Path>,
    report: Option<&Path>,
) -> Result<(), CliError> {
    let outputs = [(output, "the output"), (report, "the report")];
    let outputs: Vec<_> = outputs.into_iter().filter_map(|(path, role)| Some((path?, role))).collect();
    check_outputs(inputs, &outputs)
}

/// Refuses two outputs of one name.
pub(crate) fn refuse_same(first: (&Path, &'static str), second: (&Path, &'static str)) -> Result<(), CliError> {
    if is_same(first.0, second.0) { Err(same(second.0, first.1, second.1)) } else { Ok(()) }
}

fn same(path: &Path, first: &'static str, second: &'static str) -> CliError {
    CliError::SameFile { path: path.to_path_buf(), first, second }
}

/// Refuses standard output for a mesh.
pub(crate) fn refuse_mesh_stream(output: &Path) -> Result<(), CliError> {
    if !is_stream(output) {
        return Ok(());
    }
    let known: Vec<&str> = MeshFormat::KNOWN.iter().map(|(suffix, _)| *suffix).collect();
    Err(CliError::MeshToStream { known: known.join(", ") })
}

pub(crate) fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
}

/// The name of an output in messages.
pub(crate) fn shown_output(path: &Path) -> String {
    if is_stream(path) { "standard output".to_owned() } else { shown(path) }
}

/// Whether two names stand for one file, there or not.
fn is_same(a: &Path, b: &Path) -> bool {
    let (a, b) = (resolved(a), resolved(b));
    a.is_some() && a == b
}

/// The path without links; of a file that is not there yet, at least its folder's.
fn resolved(path: &Path) -> Option<PathBuf> {
    if let Ok(resolved) = path.canonicalize() {
        return Some(resolved);
    }
    let folder = path.parent().filter(|folder| *folder != Path::new("")).unwrap_or(Path::new("."));
    Some(folder.canonicalize().ok()?.join(path.file_name()?))
}
