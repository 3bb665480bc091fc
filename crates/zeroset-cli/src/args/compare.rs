//! Arguments of `zeroset compare`.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use super::values;

const EXAMPLES: &str = "\
Examples:
  zeroset compare mesh.ply truth.ply
  zeroset compare mesh.ply truth.obj --tau 0.01 --json
  zeroset compare --features found.json truth.ply --cloud points.laz

With --features, a plane is right if it lies on a flat part of the truth, within --tau and
--max-angle, and shares half of its area with it; an edge or a corner is right within its tolerance
of a sharp edge or a corner of the truth. With --cloud, only what has points is looked for.";

const USAGE: &str = "zeroset compare [OPTIONS] <MESH> <TRUTH>
       zeroset compare [OPTIONS] --features <FILE> <TRUTH>";

/// Arguments of `zeroset compare`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXAMPLES, override_usage = USAGE)]
pub struct CompareArgs {
    /// Mesh to examine; with --features, the truth.
    #[arg(value_name = "MESH")]
    pub first: PathBuf,
    /// What it should be.
    #[arg(value_name = "TRUTH", required_unless_present = "features", conflicts_with = "features")]
    pub second: Option<PathBuf>,
    /// Distance within which a sample, or the middle of a plane, is right [default: 0.002 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub tau: Option<f64>,
    /// Angle from which an edge is sharp, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = values::sharp_angle, default_value = "30")]
    pub sharp_angle: f64,
    /// Print JSON instead of a table.
    #[arg(long)]
    pub json: bool,

    /// Distance from sharp edges within which samples are counted apart [default: 0.01 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, conflicts_with = "features", help_heading = "Meshes")]
    pub edge_band: Option<f64>,
    /// Samples on each surface.
    #[arg(long, value_name = "N", default_value = "300000", conflicts_with = "features", help_heading = "Meshes")]
    pub samples: NonZeroUsize,
    /// Chooses the samples.
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "features", help_heading = "Meshes")]
    pub seed: u64,

    /// Planes, edges and corners to examine instead of a mesh: json of `zeroset features`.
    #[arg(long, value_name = "FILE", help_heading = "Features")]
    pub features: Option<PathBuf>,
    /// Cloud that they were found in: only what it has points of is looked for.
    #[arg(long, value_name = "FILE", requires = "features", conflicts_with = "second", help_heading = "Features")]
    pub cloud: Option<PathBuf>,
    /// Fewest points of the cloud with which a flat part of the truth counts.
    #[arg(
        long,
        value_name = "N",
        default_value_t = 50,
        requires = "cloud",
        conflicts_with = "second",
        help_heading = "Features"
    )]
    pub min_points: usize,
    /// Smallest area with which a flat part of the truth counts [default: any].
    #[arg(long, value_name = "AREA", value_parser = values::positive, requires = "features", conflicts_with = "second", help_heading = "Features")]
    pub min_area: Option<f64>,
    /// Angle within which a plane is right, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = values::plane_angle, default_value = "5", requires = "features", conflicts_with = "second", help_heading = "Features")]
    pub max_angle: f64,
    /// Distance within which an edge is right [default: 0.005 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "features", conflicts_with = "second", help_heading = "Features")]
    pub edge_tolerance: Option<f64>,
    /// Distance within which a corner is right [default: 0.01 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, requires = "features", conflicts_with = "second", help_heading = "Features")]
    pub corner_tolerance: Option<f64>,
}
