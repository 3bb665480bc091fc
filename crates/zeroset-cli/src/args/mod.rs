//! What can be typed.

mod compare;
mod features;
mod fit2d;
mod model;
mod render;
mod shared;
mod simplify;
mod tiles;
mod values;
mod view;

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Parser, Subcommand, ValueEnum};
use zeroset::sample::SceneKind;

pub use compare::CompareArgs;
pub use features::{FeaturesArgs, PostureChoice};
pub use fit2d::{BasisChoice, BranchesChoice, DomainChoice, Fit2dArgs, NormalizationChoice, SolverChoice};
pub use model::{EditArgs, EvalArgs, FitArgs, MeshArgs, RasterArgs, SliceArgs, SurfaceArgs, VolumeArgs};
pub use render::{ColorChoice, ColorMapChoice, RenderArgs};
pub use shared::{BriefRunArgs, InputArgs, RunArgs, SceneArgs, SceneChoice, SimplifyTarget, UpChoice};
pub use simplify::SimplifyArgs;
pub use tiles::{TileArgs, TileFormatChoice};
pub use values::{Backdrop, Bounds, Classes, Length, OrAuto, OrOff, Plane, Rectangle, Viewpoint};
pub use view::ViewArgs;

const EXAMPLES: &str = "\
Examples:
  zeroset reconstruct tile.laz -o tile.ply
  zeroset sample torus -o - | zeroset reconstruct - -o torus.ply
  zeroset fit tile.laz -o tile.zset
  zeroset edit tile.zset union 'box(84810,447412,0; 84820,447420,12)' -o planned.ply
  zeroset info tile.laz tile.ply";

const RECONSTRUCT_EXAMPLES: &str = "\
Examples:
  zeroset reconstruct tile.laz -o tile.ply
  zeroset reconstruct west.laz east.laz -o town.glb --resolution 0.5
  zeroset reconstruct tile.laz -o houses.obj --classes 2,6 --bounds 84800,447400,84900,447500
  zeroset reconstruct statue.ply -o statue.stl --scene object --up y
  zeroset reconstruct tile.laz -o light.ply --max-error 0.05
  zeroset reconstruct city/*.laz -o city/tiles/ --tile 250m --memory 4GB --jobs 2
  zeroset reconstruct tile.laz -o streets.ply --quality normal --constraints kerbs.dxf --constraints roofs.geojson
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

const INFO_EXAMPLES: &str = "\
Examples:
  zeroset info tile.laz
  zeroset info tile.zset
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
    /// Turn raw points into a model that can be kept, asked, edited and made into meshes.
    Fit(Box<FitArgs>),
    /// Make a mesh of a model.
    Mesh(MeshArgs),
    /// Join, cut and subtract models, meshes and shapes.
    Edit(EditArgs),
    /// Tell for points how far they are from the surface of a model, on which side, and which way is out.
    Eval(EvalArgs),
    /// Measure the volume of a model, or what was cut and filled between two.
    Volume(VolumeArgs),
    /// Cut a model along planes: cross-sections, profiles, contour lines.
    Slice(SliceArgs),
    /// Make a raster of the heights of a model, a digital surface model.
    Raster(RasterArgs),
    /// Find planes, edges and corners in raw points.
    Features(Box<FeaturesArgs>),
    /// Fit a curve to points, segments and polygons in the plane, and draw it.
    Fit2d(Box<Fit2dArgs>),
    /// Make a test scene: a cloud, and the exact mesh behind it.
    Sample(SampleArgs),
    /// Make a mesh of fewer triangles.
    Simplify(SimplifyArgs),
    /// Measure how well a mesh, or features, agree with the truth.
    Compare(CompareArgs),
    /// Draw clouds, meshes, models and features as a picture.
    Render(Box<RenderArgs>),
    /// Show clouds, meshes, models and features in the browser.
    View(ViewArgs),
    /// Show what a cloud, a mesh or a model holds.
    Info(InfoArgs),
    /// Print completions for a shell.
    Completions(CompletionsArgs),
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

/// How much is done for the surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum QualityChoice {
    Draft,
    Normal,
    Fine,
}

/// What polygons among the constraints are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PolygonsChoice {
    /// Parts of the surface.
    Faces,
    /// Only their rings are on the surface.
    Outlines,
}

/// How points are fitted.
#[derive(Debug, Clone, clap::Args)]
pub struct FitOptions {
    /// What the points show.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// How much is done for the surface: draft (the zero set as fitted), normal (planes are found, F is polished, edges made
    /// sharp) or fine (the same on finer cells) [default: normal].
    #[arg(long, value_name = "WHICH", hide_possible_values = true)]
    pub quality: Option<QualityChoice>,
    /// Weight of smoothness in the polish, without unit, or `auto` [default: auto].
    #[arg(long, value_name = "W|auto", value_parser = values::smooth)]
    pub smooth: Option<OrAuto<f64>>,
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
    /// Lines and polygons that the surface passes through: obj, geojson, dxf, or json of `zeroset features`, in the coordinates of the input;
    /// may be repeated.
    #[arg(long, value_name = "FILE")]
    pub constraints: Vec<PathBuf>,
    /// What polygons among the constraints are: faces, parts of the surface such as walls and roofs, or outlines, such as footprints, of which
    /// only the rings are on it [default: faces].
    #[arg(long, value_name = "WHAT", hide_possible_values = true, requires = "constraints")]
    pub constraint_polygons: Option<PolygonsChoice>,
}

/// Arguments of `zeroset reconstruct`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = RECONSTRUCT_EXAMPLES)]
pub struct ReconstructArgs {
    /// The points.
    #[command(flatten)]
    pub input: InputArgs,
    /// Mesh to write; the suffix tells the format. A folder gets a file for each tile.
    #[arg(short, long, value_name = "FILE|FOLDER/", required_unless_present = "dry_run")]
    pub output: Option<PathBuf>,

    /// How the points are fitted.
    #[command(flatten)]
    pub fit: FitOptions,
    /// Values of the nearest point that each vertex gets: off, rgb, intensity or class [default: rgb].
    #[arg(long, value_name = "WHICH", hide_possible_values = true)]
    pub attributes: Option<AttributesChoice>,
    /// How far the mesh is simplified.
    #[command(flatten)]
    pub simplify: SimplifyTarget,
    /// How ground that is larger than memory is cut up.
    #[command(flatten)]
    pub tiles: TileArgs,

    /// Print what would be done, and the memory that it takes, and write no mesh.
    #[arg(long, help_heading = "Running")]
    pub dry_run: bool,
    /// How to run.
    #[command(flatten)]
    pub run: RunArgs,
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

/// Arguments of `zeroset info`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = INFO_EXAMPLES)]
pub struct InfoArgs {
    /// Clouds, meshes and models; `-` reads lines of x y z from standard input.
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
