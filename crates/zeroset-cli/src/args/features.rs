//! Arguments of `zeroset features`.

use std::path::PathBuf;

use clap::ValueEnum;

use super::shared::{InputArgs, RunArgs, SceneArgs};
use super::values;

const EXAMPLES: &str = "\
Examples:
  zeroset features tile.laz -o tile.json
  zeroset features tile.laz -o roofs.geojson -o roofs.dxf --classes 6 --min-area 4
  zeroset features part.ply -o part.obj -o points.ply --scene object
  zeroset sample stairs -o - | zeroset features - -o - --scene object

Lengths are in the unit of the input, mostly metres. Coordinates stay in the input's reference system.
Read are las, laz (COPC too), ply, xyz, txt, csv, asc, pts, pcd and e57. Written are:
  json     planes, edges and corners with all figures; `-` writes it to standard output
  geojson  planes as polygons, upright ones as lines in plan; edges as lines, corners as points
  obj      planes as faces, edges as lines, corners as points
  ply      the points, each with the number of its plane (-1: none) and its class
           (0 unstructured, 1 flat, 2 edge, 3 corner); a colour for each plane if the points have none
  dxf      closed polylines, lines and points on layers, for CAD";

/// What is made of planes that nearly stand or lie.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum PostureChoice {
    /// Walls stand and flats lie, unless their points contradict.
    Upright,
    /// Each plane is that of least squares.
    Free,
}

/// Arguments of `zeroset features`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct FeaturesArgs {
    /// The points.
    #[command(flatten)]
    pub input: InputArgs,
    /// File to write, several if repeated; the suffix tells the format; `-` writes json to standard output.
    #[arg(short, long = "output", value_name = "FILE", required = true)]
    pub outputs: Vec<PathBuf>,

    /// What the points show.
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Smallest area of a plane, in square units of the input [default: 16 points' worth, or more under much noise].
    #[arg(long, value_name = "AREA", value_parser = values::positive)]
    pub min_area: Option<f64>,
    /// Farthest that a point lies from its plane [default: 3 times the measured noise].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive)]
    pub max_distance: Option<f64>,
    /// Largest angle between a plane and the surface around its points, in degrees [default: 40; near an edge that surface turns].
    #[arg(long, value_name = "DEGREES", value_parser = values::plane_angle)]
    pub max_angle: Option<f64>,
    /// Angle by which the surface turns at an edge, at least, in degrees.
    #[arg(long, value_name = "DEGREES", value_parser = values::plane_angle, default_value = "30")]
    pub sharp_angle: f64,

    /// Planes that nearly stand or lie: upright takes walls of terrain for upright and flats for level unless their points contradict; free
    /// fits each as it is.
    #[arg(
        long,
        value_name = "HOW",
        default_value = "upright",
        hide_possible_values = true,
        help = "Nearly upright walls and nearly level flats of terrain: upright (so unless their points contradict) or free"
    )]
    pub posture: PostureChoice,

    /// How to run.
    #[command(flatten)]
    pub run: RunArgs,
}
