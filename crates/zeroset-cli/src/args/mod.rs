//! What can be typed.

mod fit2d;
mod values;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, ValueEnum};
use zeroset::sample::SceneKind;

pub use fit2d::{BasisChoice, BranchesChoice, DomainChoice, Fit2dArgs, NormalizationChoice, SolverChoice};
pub use values::{Bounds, Classes, OrOff, Rectangle};

const EXAMPLES: &str = "\
Examples:
  zeroset reconstruct tile.laz -o tile.ply
  zeroset sample torus -o - | zeroset reconstruct - -o torus.ply
  zeroset info tile.laz tile.ply";

const RECONSTRUCT_EXAMPLES: &str = "\
Examples:
  zeroset reconstruct tile.laz -o tile.ply
  zeroset reconstruct west.laz east.laz -o town.glb --resolution 0.5
  zeroset reconstruct tile.laz -o houses.obj --classes 2,6 --bounds 84800,447400,84900,447500
  zeroset reconstruct statue.ply -o statue.stl --scene object --up y
  zeroset reconstruct tile.laz --dry-run

Lengths are in the unit of the input, mostly metres.
Where only some inputs have classes, points of the others count as class 0, never classified: --exclude keeps them and
--classes drops them unless the list names 0. Where only some have colours or intensities, the others count as white or 0.
Read are las, laz (COPC too), ply, xyz, txt, csv, asc, pts, pcd and e57; written are ply, obj, stl, off and glb.
Coordinates stay in the input's reference system; stl and glb hold them less an offset, which is printed.";

const SAMPLE_EXAMPLES: &str = "\
Examples:
  zeroset sample torus -o torus.xyz
  zeroset sample airborne-city -o city.laz --points 1000000 --truth city.ply
  zeroset sample box -o - --noise 0 | zeroset reconstruct - -o box.ply";

const COMPARE_EXAMPLES: &str = "\
Examples:
  zeroset compare mesh.ply truth.ply
  zeroset compare mesh.ply truth.obj --tau 0.01 --json";

const INFO_EXAMPLES: &str = "\
Examples:
  zeroset info tile.laz
  zeroset info mesh.ply --json";

/// Raw point clouds in, implicit models and meshes out. No normals needed.
#[derive(Debug, Clone, Parser)]
#[command(name = "zeroset", version, after_help = EXAMPLES, arg_required_else_help = true)]
pub struct Args {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// What to do.
#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Turn raw points into a mesh.
    Reconstruct(Box<ReconstructArgs>),
    /// Fit a curve to points, segments and polygons in the plane, and draw it.
    Fit2d(Box<Fit2dArgs>),
    /// Make a test scene: a cloud, and the exact mesh behind it.
    Sample(SampleArgs),
    /// Measure how well a mesh agrees with the truth.
    Compare(CompareArgs),
    /// Show what a cloud or a mesh holds.
    Info(InfoArgs),
    /// Print completions for a shell.
    Completions(CompletionsArgs),
}

/// The kind of scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum SceneChoice {
    /// Airborne if all inputs are las or laz, else decided from the shape of the cloud.
    Auto,
    /// A body seen from all sides: closed.
    Object,
    /// Ground and what stands on it.
    Terrain,
    /// Terrain scanned from above, with hardly a point on walls.
    Airborne,
    /// Nothing is known about inside and outside.
    Free,
}

/// The axis that points to the sky.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum UpChoice {
    X,
    Y,
    Z,
    #[value(name = "-x")]
    MinusX,
    #[value(name = "-y")]
    MinusY,
    #[value(name = "-z")]
    MinusZ,
}

/// Which values of the points the vertices get.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum AttributesChoice {
    Off,
    Rgb,
    Intensity,
    Class,
}

/// Arguments of `zeroset reconstruct`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = RECONSTRUCT_EXAMPLES)]
pub struct ReconstructArgs {
    /// Point clouds, taken together as one; `-` reads lines of x y z from standard input.
    #[arg(value_name = "INPUT", required = true)]
    pub inputs: Vec<PathBuf>,
    /// Mesh to write; the suffix tells the format.
    #[arg(short, long, value_name = "FILE", required_unless_present = "dry_run")]
    pub output: Option<PathBuf>,

    /// Kind of scene.
    #[arg(
        long,
        value_name = "KIND",
        default_value = "auto",
        hide_possible_values = true,
        help = "Kind of scene: auto, object, terrain, airborne or free"
    )]
    pub scene: SceneChoice,
    /// Axis that points to the sky: x, y, z, -x, -y or -z.
    #[arg(long, value_name = "AXIS", default_value = "z", allow_hyphen_values = true, hide_possible_values = true)]
    pub up: UpChoice,
    /// Finest cell, in the unit of the input [default: 1.5 times the spacing of the points].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, conflicts_with = "depth")]
    pub resolution: Option<f64>,
    /// Finest cell as a share of the box instead: its longest side over 2^N.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=20))]
    pub depth: Option<u32>,
    /// Drop surface farther than this from the points, or `off` [default: 60 times the spacing; off for objects].
    #[arg(long, value_name = "LENGTH|off", value_parser = values::trim)]
    pub trim: Option<OrOff<f64>>,
    /// Drop pieces of fewer than N triangles, but never the largest [default: 100; off for objects].
    #[arg(long, value_name = "N|off", value_parser = values::min_component)]
    pub min_component: Option<OrOff<NonZeroUsize>>,
    /// Weight of the points against smoothness, without unit [default: 1 to 16, by the noise of the points over the cell].
    #[arg(long, value_name = "ALPHA", value_parser = values::positive)]
    pub screening: Option<f64>,
    /// Values of the nearest point that each vertex gets: off, rgb, intensity or class [default: rgb].
    #[arg(long, value_name = "WHICH", hide_possible_values = true)]
    pub attributes: Option<AttributesChoice>,

    /// Use only these classes, such as 2,6,9 [default: all].
    #[arg(long, value_name = "LIST", value_parser = values::classes, help_heading = "Points")]
    pub classes: Option<Classes>,
    /// Leave these classes out, or `none` [default: 7,18, noise, unless --classes names them].
    #[arg(long, value_name = "LIST|none", value_parser = values::excluded, help_heading = "Points")]
    pub exclude: Option<Classes>,
    /// Use only points in this box of world coordinates.
    #[arg(help = "Use only points in this box of world coordinates: xmin,ymin,xmax,ymax[,zmin,zmax]",
        long, value_name = "BOX", value_parser = values::bounds, allow_hyphen_values = true, help_heading = "Points")]
    pub bounds: Option<Bounds>,
    /// Drop groups of up to K points that lie far from all others; 8 is usual.
    #[arg(long, value_name = "off|K", value_parser = values::outliers, default_value = "off", help_heading = "Points")]
    pub outliers: OrOff<NonZeroUsize>,

    /// Threads to use [default: all]; the mesh does not depend on it.
    #[arg(long, value_name = "N", value_parser = values::threads, help_heading = "Running")]
    pub threads: Option<NonZeroUsize>,
    /// Memory to use at most, such as 4GB [default: 70 % of what is free].
    #[arg(long, value_name = "SIZE", value_parser = values::size, help_heading = "Running")]
    pub memory: Option<u64>,
    /// Write a report of all figures as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE", help_heading = "Running")]
    pub report: Option<PathBuf>,
    /// Print what would be done, and the memory that it takes, and write no mesh.
    #[arg(long, help_heading = "Running")]
    pub dry_run: bool,
    /// Print nothing but errors.
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Running")]
    pub quiet: bool,
    /// Print a table of stages and levels.
    #[arg(short, long, help_heading = "Running")]
    pub verbose: bool,
}

/// Arguments of `zeroset sample`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = SAMPLE_EXAMPLES)]
pub struct SampleArgs {
    /// Scene, about one unit across.
    #[arg(value_parser = PossibleValuesParser::new(SceneKind::ALL.map(SceneKind::name)).try_map(|name| name.parse::<SceneKind>()))]
    pub kind: SceneKind,
    /// Cloud to write; `-` is standard output, as lines of x y z.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Number of points.
    #[arg(long, value_name = "N", default_value = "100000")]
    pub points: NonZeroUsize,
    /// Standard deviation of the noise, in units of the scene [default: 0.001].
    #[arg(long, value_name = "LENGTH", value_parser = values::not_negative)]
    pub noise: Option<f64>,
    /// Chooses the points, and the houses of a city.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Write the exact mesh, too.
    #[arg(long, value_name = "FILE")]
    pub truth: Option<PathBuf>,
}

/// Arguments of `zeroset compare`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = COMPARE_EXAMPLES)]
pub struct CompareArgs {
    /// Mesh to examine.
    pub mesh: PathBuf,
    /// What it should be.
    pub truth: PathBuf,
    /// Distance within which a sample counts as right [default: 0.002 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub tau: Option<f64>,
    /// Distance from sharp edges within which samples are counted apart [default: 0.01 of the truth's diagonal].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub edge_band: Option<f64>,
    /// Samples on each surface.
    #[arg(long, value_name = "N", default_value = "300000")]
    pub samples: NonZeroUsize,
    /// Chooses the samples.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Angle from which an edge is sharp, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = values::sharp_angle, default_value = "30")]
    pub sharp_angle: f64,
    /// Print JSON instead of a table.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `zeroset info`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = INFO_EXAMPLES)]
pub struct InfoArgs {
    /// Clouds and meshes; `-` reads lines of x y z from standard input.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Print JSON, a line for each file.
    #[arg(long)]
    pub json: bool,
}

/// Arguments of `zeroset completions`.
#[derive(Debug, Clone, clap::Args)]
pub struct CompletionsArgs {
    /// The shell.
    pub shell: clap_complete::Shell,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_sound() {
        Args::command().debug_assert();
    }
}
