//! Arguments of `zeroset simplify`.

use std::path::PathBuf;

use clap::ArgGroup;

use super::values;
use super::{BriefRunArgs, SimplifyTarget};

const EXAMPLES: &str = "\
Examples:
  zeroset simplify tile.ply -o light.ply --max-error 0.05
  zeroset simplify statue.stl -o statue.glb --triangles 20000
  zeroset simplify part.obj -o part.off --triangles 5000 --max-error 0.1

At least one of --triangles and --max-error is needed; of both, the first to be reached counts.
The error is measured both ways, between the mesh before and after. Creases and borders are kept within it.
Read and written are ply, obj, stl, off and glb.";

/// Arguments of `zeroset simplify`.
#[derive(Debug, Clone, clap::Args)]
#[command(
    after_help = EXAMPLES,
    group = ArgGroup::new("how_far").args(["triangles", "max_error"]).required(true).multiple(true)
)]
pub struct SimplifyArgs {
    /// Mesh to simplify.
    #[arg(value_name = "MESH")]
    pub input: PathBuf,
    /// Mesh to write; the suffix tells the format.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How far.
    #[command(flatten)]
    pub target: SimplifyTarget,
    /// Angle from which an edge is a crease, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = values::sharp_angle, default_value = "30", help_heading = "Simplification")]
    pub sharp_angle: f64,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}
