//! What can be told to be wrong before anything is read.

use std::path::{Path, PathBuf};

use zeroset_io::{CloudFormat, IoError, MeshFormat, check_writable};

use crate::args::ReconstructArgs;
use crate::error::CliError;

/// Looks at all names: known suffixes, inputs that are there, outputs that can be written and are no inputs. Returns
/// the formats of the inputs.
pub(super) fn check(args: &ReconstructArgs) -> Result<Vec<CloudFormat>, CliError> {
    if let Some(output) = &args.output {
        if is_stream(output) {
            let known: Vec<&str> = MeshFormat::KNOWN.iter().map(|(suffix, _)| *suffix).collect();
            return Err(CliError::MeshToStream { known: known.join(", ") });
        }
        MeshFormat::from_path(output)?;
    }
    let formats = args.inputs.iter().map(|path| CloudFormat::from_path(path)).collect::<Result<_, _>>()?;
    let standard_input = args.inputs.iter().filter(|path| is_stream(path)).count();
    if standard_input > 1 {
        return Err(same(Path::new("-"), "an input", "another input"));
    }
    for input in args.inputs.iter().filter(|path| !is_stream(path)) {
        let facts = std::fs::metadata(input).map_err(|source| IoError::from_system(input, source))?;
        if facts.is_dir() {
            return Err(IoError::IsDirectory { path: input.clone() }.into());
        }
    }
    let report = args.report.as_ref().filter(|path| !is_stream(path));
    for (path, role) in [(args.output.as_ref(), "the output"), (report, "the report")] {
        let Some(path) = path else { continue };
        if args.inputs.iter().any(|input| is_same(input, path)) {
            return Err(same(path, "an input", role));
        }
        check_writable(path)?;
    }
    if let (Some(output), Some(report)) = (&args.output, report) {
        refuse_same((output, "the output"), (report, "the report"))?;
    }
    Ok(formats)
}

/// Refuses two outputs of one name.
pub(crate) fn refuse_same(first: (&Path, &'static str), second: (&Path, &'static str)) -> Result<(), CliError> {
    if is_same(first.0, second.0) { Err(same(second.0, first.1, second.1)) } else { Ok(()) }
}

fn same(path: &Path, first: &'static str, second: &'static str) -> CliError {
    CliError::SameFile { path: path.to_path_buf(), first, second }
}

fn is_stream(path: &Path) -> bool {
    path == Path::new("-")
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
