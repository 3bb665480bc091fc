//! Arguments of `zeroset view`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::shared::UpChoice;
use super::values;

const EXAMPLES: &str = "\
Examples:
  zeroset view tile.laz tile.ply
  zeroset view tile.laz tile.json --no-open
  zeroset view scan.ply model.zset --distance-to part.stl

The page is served to this machine alone, at an address that nobody else can guess. Ctrl-C ends it.
Shown are las, laz, xyz, csv and other clouds; ply, obj, stl, off and glb; models as zset or toml; and json of
`zeroset features`. With features, clouds can be coloured by plane; with a model, by their distance from it.";

/// Arguments of `zeroset view`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct ViewArgs {
    /// Clouds, meshes, models and features.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Port to listen on; 0 is any that is free.
    #[arg(long, value_name = "PORT", default_value_t = 0)]
    pub port: u16,
    /// Do not open the browser, only print the address.
    #[arg(long)]
    pub no_open: bool,
    /// Axis that points to the sky: x, y, z, -x, -y or -z.
    #[arg(long, value_name = "AXIS", default_value = "z", allow_hyphen_values = true, hide_possible_values = true)]
    pub up: UpChoice,
    /// File to which distances can be shown: a cloud, a mesh or a model.
    #[arg(long, value_name = "FILE")]
    pub distance_to: Option<PathBuf>,
    /// Threads to use [default: all].
    #[arg(long, value_name = "N", value_parser = values::threads)]
    pub threads: Option<NonZeroUsize>,
    /// Print nothing but the address and errors.
    #[arg(short, long)]
    pub quiet: bool,
}
