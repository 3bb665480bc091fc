//! Arguments of the commands about models.

use std::path::PathBuf;

use super::values::{self, Bounds, Plane};
use super::{AttributesChoice, BriefRunArgs, FitOptions, InputArgs, RunArgs, SimplifyTarget};

const SOLID: &str = "\
A model is a .zset file, a tree of operands in a .toml file, a closed mesh, or an expression such as
  box(0,0,0; 10,5,3) rotate(z, 30deg) at(84810,447412,2)
  subtract(tile.zset; extrude(houses.geojson; -5; 50))
docs/solids-expressions.md lists the shapes and operations.";

const FIT_EXAMPLES: &str = "\
Examples:
  zeroset fit tile.laz -o tile.zset
  zeroset fit tile.laz -o ground.zset --classes 2
  zeroset fit part.ply -o part.zset --scene object --quality fine";

const MESH_EXAMPLES: &str = "\
Examples:
  zeroset mesh tile.zset -o tile.ply
  zeroset mesh planned.toml -o planned.glb --max-error 0.05
  zeroset mesh 'subtract(box(0,0,0; 4,2,1); cylinder(2,1,-1; 2,1,2; 0.5))' -o part.stl --cell 0.02";

const EDIT_EXAMPLES: &str = "\
Examples:
  zeroset edit tile.zset union 'box(84810,447412,0; 84820,447420,12)' -o planned.zset
  zeroset edit tile.zset subtract 'subtract(extrude(house.geojson; -5; 50); ground.zset)' -o healed.ply
  zeroset edit 'box(-1,-1,-1; 1,1,1)' subtract part.zset intersect 'halfspace(0,0,0; 0,0,1)' -o mould.stl

Operations work from left to right.";

const EVAL_EXAMPLES: &str = "\
Examples:
  zeroset eval tile.zset --points tile.laz -o distances.ply
  echo 84810 447412 2 | zeroset eval tile.zset --points - -o -

Columns: x, y, z; value, which is negative inside and near the surface about the distance; gx, gy, gz, the gradient, which points out; inside, 0 or 1.";

const VOLUME_EXAMPLES: &str = "\
Examples:
  zeroset volume part.zset
  zeroset volume heap.zset --above 2.5 --bounds 84800,447400,84850,447450
  zeroset volume before.zset after.zset";

const SLICE_EXAMPLES: &str = "\
Examples:
  zeroset slice tile.zset --plane 12.5 -o plan.svg
  zeroset slice tile.zset --plane '84850,447450,0; 1,0,0' -o profile.dxf
  zeroset slice ground.zset --every 0.5 -o contours.geojson";

const RASTER_EXAMPLES: &str = "\
Examples:
  zeroset raster tile.zset -o dsm.tif
  zeroset raster ground.zset -o dtm.tif --cell 1";

/// How meshes are made of models.
#[derive(Debug, Clone, clap::Args)]
pub struct SurfaceArgs {
    /// Side of the cells in which the surface is looked for [default: those of the first fitted model; without any a 128th of the box].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub cell: Option<f64>,
    /// Only the surface in this box of world coordinates, which cuts it open.
    #[arg(help = "Only the surface in this box of world coordinates, which cuts it open: xmin,ymin,xmax,ymax[,zmin,zmax]",
        long, value_name = "BOX", value_parser = values::bounds, allow_hyphen_values = true)]
    pub bounds: Option<Bounds>,
    /// Values of the nearest point that each vertex gets: off, rgb, intensity or class [default: rgb].
    #[arg(long, value_name = "WHICH", hide_possible_values = true)]
    pub attributes: Option<AttributesChoice>,
    /// How far the mesh is simplified.
    #[command(flatten)]
    pub simplify: SimplifyTarget,
}

/// Arguments of `zeroset fit`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = FIT_EXAMPLES)]
pub struct FitArgs {
    /// The points.
    #[command(flatten)]
    pub input: InputArgs,
    /// Model to write: a .zset file.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How the points are fitted.
    #[command(flatten)]
    pub fit: FitOptions,
    /// How to run.
    #[command(flatten)]
    pub run: RunArgs,
}

/// Arguments of `zeroset mesh`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{MESH_EXAMPLES}\n\n{SOLID}"))]
pub struct MeshArgs {
    /// Model, tree or expression.
    #[arg(value_name = "MODEL", allow_hyphen_values = true)]
    pub model: String,
    /// Mesh to write; the suffix tells the format.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How the mesh is made.
    #[command(flatten)]
    pub surface: SurfaceArgs,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}

/// Arguments of `zeroset edit`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{EDIT_EXAMPLES}\n\n{SOLID}"))]
pub struct EditArgs {
    /// What is edited: a model, tree, mesh or expression.
    #[arg(value_name = "BASE")]
    pub base: String,
    /// Operations, each with its operand: union, subtract or intersect, and a model, tree, mesh or expression.
    #[arg(value_names = ["OPERATION", "OPERAND"], num_args = 2.., required = true, help = "union, subtract or intersect, with a model, tree, mesh or expression; may be repeated")]
    pub operations: Vec<String>,
    /// Model (.zset) or mesh to write; the suffix tells.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How a mesh is made.
    #[command(flatten)]
    pub surface: SurfaceArgs,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}

/// Arguments of `zeroset eval`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{EVAL_EXAMPLES}\n\n{SOLID}"))]
pub struct EvalArgs {
    /// Model, tree or expression.
    #[arg(value_name = "MODEL")]
    pub model: String,
    /// Points in world coordinates: a cloud, or an npy of n x 3 numbers; `-` reads lines of x y z from standard input.
    #[arg(long, value_name = "FILE")]
    pub points: PathBuf,
    /// Table to write: ply, csv or npy; `-` is standard output, as csv.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}

/// Arguments of `zeroset volume`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{VOLUME_EXAMPLES}\n\n{SOLID}"))]
pub struct VolumeArgs {
    /// Model, tree or expression.
    #[arg(value_name = "MODEL")]
    pub model: String,
    /// A later state of it: what was cut and filled is measured.
    #[arg(value_name = "AFTER")]
    pub after: Option<String>,
    /// Only what lies in this box of world coordinates.
    #[arg(help = "Only what lies in this box of world coordinates: xmin,ymin,xmax,ymax[,zmin,zmax]",
        long, value_name = "BOX", value_parser = values::bounds, allow_hyphen_values = true)]
    pub bounds: Option<Bounds>,
    /// Only what lies above this height, or beyond a plane: x,y,z; nx,ny,nz.
    #[arg(long, value_name = "PLANE", value_parser = values::plane, allow_hyphen_values = true)]
    pub above: Option<Plane>,
    /// Distance between the upright lines that are measured [default: half a cell].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub step: Option<f64>,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}

/// Arguments of `zeroset slice`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{SLICE_EXAMPLES}\n\n{SOLID}"))]
pub struct SliceArgs {
    /// Model, tree or expression.
    #[arg(value_name = "MODEL")]
    pub model: String,
    /// Plane: a height, or a position and a normal, x,y,z; nx,ny,nz. May be repeated.
    #[arg(long, value_name = "PLANE", value_parser = values::plane, allow_hyphen_values = true, required_unless_present = "every")]
    pub plane: Vec<Plane>,
    /// Contour lines at all multiples of a height.
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, conflicts_with = "plane")]
    pub every: Option<f64>,
    /// Curves to write: svg, dxf or geojson.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Side of the cells in which the surface is looked for [default: those of the first fitted model; without any a 128th of the box].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub cell: Option<f64>,
    /// Only the surface in this box of world coordinates.
    #[arg(help = "Only the surface in this box of world coordinates: xmin,ymin,xmax,ymax[,zmin,zmax]",
        long, value_name = "BOX", value_parser = values::bounds, allow_hyphen_values = true)]
    pub bounds: Option<Bounds>,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}

/// Arguments of `zeroset raster`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = format!("{RASTER_EXAMPLES}\n\n{SOLID}"))]
pub struct RasterArgs {
    /// Model, tree or expression.
    #[arg(value_name = "MODEL")]
    pub model: String,
    /// GeoTIFF to write.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Side of a pixel [default: a cell of the first fitted model; without any a 128th of the box].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub cell: Option<f64>,
    /// Only this box of world coordinates.
    #[arg(help = "Only this box of world coordinates: xmin,ymin,xmax,ymax[,zmin,zmax]",
        long, value_name = "BOX", value_parser = values::bounds, allow_hyphen_values = true)]
    pub bounds: Option<Bounds>,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}
