//! `zeroset sample`.

use zeroset::sample::Scene;
use zeroset_io::{CloudFormat, MeshFormat, WriteOptions, check_writable, write_cloud, write_mesh};

use crate::args::SampleArgs;
use crate::error::CliError;
use crate::input::{is_stream, refuse_same};

pub(crate) fn run(args: &SampleArgs) -> Result<(), CliError> {
    check(args)?;
    let scene = Scene::new(args.kind, args.seed);
    let noise = args.noise.unwrap_or_else(|| args.kind.default_noise());
    let cloud = scene.points(args.points.get(), noise, args.seed);
    let comments =
        vec![format!("zeroset sample {} points {} noise {noise} seed {}", args.kind, args.points, args.seed)];
    let options = WriteOptions { comments, ..WriteOptions::default() };
    if let Some(path) = &args.truth {
        write_mesh(path, &scene.truth, &options)?;
    }
    write_cloud(&args.output, &cloud, &options)?;
    Ok(())
}

/// What can be told to be wrong before any work.
fn check(args: &SampleArgs) -> Result<(), CliError> {
    CloudFormat::from_path(&args.output)?;
    if let Some(truth) = &args.truth {
        MeshFormat::from_path(truth)?;
        refuse_same((&args.output, "the cloud"), (truth, "the truth"))?;
        check_writable(truth)?;
    }
    if !is_stream(&args.output) {
        check_writable(&args.output)?;
    }
    Ok(())
}
