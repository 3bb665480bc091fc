//! What can be told to be wrong before anything is read.

use std::path::Path;

use zeroset_io::{IoError, PlanarFormat, by_suffix, check_writable};

use crate::args::{BasisChoice, DomainChoice, Fit2dArgs};
use crate::error::CliError;
use crate::input::{is_stream, refuse_same};

/// What is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Output {
    /// JSON to standard output.
    Stream,
    /// A file of JSON.
    Json,
    /// A picture.
    Svg,
}

/// Suffixes of outputs.
const KNOWN: [(&str, Output); 2] = [("svg", Output::Svg), ("json", Output::Json)];

pub(super) fn check(args: &Fit2dArgs) -> Result<Output, CliError> {
    usage(args).map_err(CliError::Usage)?;
    let output = output(&args.output)?;
    PlanarFormat::from_path(&args.input)?;
    if !is_stream(&args.input) {
        std::fs::metadata(&args.input).map_err(|source| IoError::from_system(&args.input, source))?;
    }
    if output != Output::Stream {
        refuse_same((&args.input, "the input"), (&args.output, "the output"))?;
        check_writable(&args.output)?;
    }
    Ok(output)
}

/// Options that have no meaning together.
fn usage(args: &Fit2dArgs) -> Result<(), String> {
    let is_radial = !matches!(args.basis, BasisChoice::P1 | BasisChoice::P2);
    if args.smoothness.is_some() && args.order == 0 {
        return Err("--smoothness has no meaning with --order 0; give --order 1 or 2".into());
    }
    for (given, option) in [(args.centres.is_some(), "--centres"), (args.width.is_some(), "--width")] {
        if given && !is_radial {
            return Err(format!("{option} is for radial functions only; give --basis gaussian or the like"));
        }
    }
    if args.sites.is_some() && args.domain != Some(DomainChoice::Delaunay) {
        return Err("--sites is for Delaunay meshes only; give --domain delaunay".into());
    }
    if args.cells.is_some() && matches!(args.domain, Some(DomainChoice::Four | DomainChoice::Delaunay)) {
        return Err("--cells is for lattices only; leave it out, or give --domain lattice".into());
    }
    Ok(())
}

fn output(path: &Path) -> Result<Output, CliError> {
    if is_stream(path) {
        return Ok(Output::Stream);
    }
    Ok(by_suffix(path, "picture or figures", &KNOWN)?)
}
