//! Arguments of `zeroset render`.

use std::path::PathBuf;

use clap::ValueEnum;

use super::shared::{BriefRunArgs, UpChoice};
use super::values::{self, Backdrop, Viewpoint};

const EXAMPLES: &str = "\
Examples:
  zeroset render tile.ply -o tile.png
  zeroset render tile.laz -o heights.png --color height --camera top
  zeroset render tile.ply tile.json -o roofs.png --camera 200,30 --zoom 1.5
  zeroset render part.stl -o error.png --distance-to scan.ply --range 0,0.1
  zeroset render scan.laz model.zset -o residuals.png --color residual

Drawn together: las, laz, xyz, csv and other clouds; ply, obj, stl, off and glb; models as zset or toml, of which the
surface is made; and json of `zeroset features`, as edges and corners over what they lie on, or as planes if alone.
The same files give the same picture, bit for bit. No display is needed.";

/// What colours tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorChoice {
    /// What there is: colours, classes, heights of clouds alone.
    Auto,
    /// Nothing.
    Plain,
    /// Height above zero.
    Height,
    /// ASPRS class.
    Class,
    /// Colours of the files.
    Rgb,
    /// The plane that each place lies on.
    Plane,
    /// Distance of points from a model, with its sign: above zero outside.
    Residual,
    /// Mean curvature of surfaces, surface variation of clouds.
    Curvature,
    /// Distance to another file.
    Distance,
}

/// Scales of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum ColorMapChoice {
    Viridis,
    Magma,
    Cividis,
    Turbo,
    Gray,
    BlueRed,
}

/// Arguments of `zeroset render`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct RenderArgs {
    /// Clouds, meshes, models and features.
    #[arg(value_name = "FILE", required = true)]
    pub files: Vec<PathBuf>,
    /// Picture to write: png.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Where it is seen from: iso, top, bottom, front, back, left, right; or azimuth,elevation of the camera in degrees, from north to east; or x,y,z,x,y,z of the
    /// camera and of what it looks at.
    #[arg(long, value_name = "VIEW", default_value = "iso", value_parser = values::viewpoint, allow_hyphen_values = true, help_heading = "Camera")]
    pub camera: Viewpoint,
    /// How many times larger than what fits.
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = values::positive, help_heading = "Camera")]
    pub zoom: f64,
    /// Angle between the lower and the upper side of the picture, in degrees.
    #[arg(long, value_name = "DEGREES", default_value = "30", value_parser = values::angle_of_view, conflicts_with = "parallel", help_heading = "Camera")]
    pub field_of_view: f64,
    /// All in one scale, as on a map or a plan.
    #[arg(long, help_heading = "Camera")]
    pub parallel: bool,
    /// Axis that points to the sky: x, y, z, -x, -y or -z.
    #[arg(
        long,
        value_name = "AXIS",
        default_value = "z",
        allow_hyphen_values = true,
        hide_possible_values = true,
        help_heading = "Camera"
    )]
    pub up: UpChoice,

    /// What colours tell: auto, plain, height, class, rgb, plane (with json of `zeroset features`), residual (of points from a model), curvature or
    /// distance [default: auto, or distance with --distance-to].
    #[arg(long, value_name = "WHAT", hide_possible_values = true, help_heading = "Colours")]
    pub color: Option<ColorChoice>,
    /// File to which distances are measured: a cloud, a mesh or a model.
    #[arg(long, value_name = "FILE", help_heading = "Colours")]
    pub distance_to: Option<PathBuf>,
    /// Values at the ends of the scale [default: what nearly all values lie within].
    #[arg(long, value_name = "LOW,HIGH", value_parser = values::range, allow_hyphen_values = true, help_heading = "Colours")]
    pub range: Option<[f64; 2]>,
    /// Colours of the scale: viridis, magma, cividis, turbo, gray or blue-red [default: viridis, or blue-red for values with a sign].
    #[arg(long, value_name = "MAP", hide_possible_values = true, help_heading = "Colours")]
    pub color_map: Option<ColorMapChoice>,
    /// Leave out what the colours stand for.
    #[arg(long, help_heading = "Colours")]
    pub no_legend: bool,
    /// Pixels across a point [default: by the number of points].
    #[arg(long, value_name = "PIXELS", value_parser = values::positive, help_heading = "Colours")]
    pub point_size: Option<f64>,
    /// What is behind everything: white, black, transparent or #rrggbb.
    #[arg(long, value_name = "COLOR", default_value = "white", value_parser = values::backdrop, help_heading = "Colours")]
    pub background: Backdrop,

    /// Pixels across and down.
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = values::pixels, help_heading = "Picture")]
    pub size: [u32; 2],
    /// Samples along either side of a pixel, 1 to 4: 1 is fast, more is smoother.
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..=4), help_heading = "Picture")]
    pub antialias: u32,
    /// How to run.
    #[command(flatten)]
    pub run: BriefRunArgs,
}
