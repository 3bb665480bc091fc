//! Arguments of `zeroset fit2d`.

use std::path::PathBuf;

use clap::ValueEnum;

use super::values::{self, Rectangle};

const EXAMPLES: &str = "\
Examples:
  zeroset fit2d bowl.csv -o bowl.svg
  zeroset fit2d bowl.csv -o bowl.json --domain four --bounds 0,0,1,1
  zeroset fit2d plan.json -o plan.svg --basis p2 --cells 12 --normalization mean-gradient --order 2
  zeroset fit2d bowl.csv -o bowl.svg --basis gaussian --centres 20 --width 0.3

JSON in, every key optional:
  {\"points\": [[x, y], [x, y, weight]], \"segments\": [[[x, y], [x, y]]], \"polygons\": [[[x, y], [x, y], [x, y]]],
   \"domain\": {\"vertices\": [[x, y], ...], \"triangles\": [[0, 1, 2], ...]}}
CSV in: x, y and perhaps a weight on each line, a line of names on top if you like.
JSON out: eigenvalue, gap, spectrum, rayleigh_quotient, nodes, coefficients, unconstrained, residual_rms, distance_rms, residuals,
contour (polylines, closed ones with their first position repeated), closed, warnings and method.
Lengths are in the unit of the input.";

/// Where F is known.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum DomainChoice {
    /// A regular lattice, each cell cut into two triangles.
    Lattice,
    /// The box cut into four triangles by its diagonals.
    Four,
    /// The Delaunay triangles of the box's corners and of data that cover the others evenly.
    Delaunay,
}

/// What F is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum BasisChoice {
    P1,
    P2,
    Gaussian,
    Multiquadric,
    InverseMultiquadric,
    ThinPlate,
    #[value(name = "wendland-c2")]
    WendlandC2,
    #[value(name = "wendland-c4")]
    WendlandC4,
}

/// What keeps F from being zero.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum NormalizationChoice {
    /// The sum of the squared coefficients.
    Coefficients,
    /// The sum of the squared gradients at the data.
    SquaredGradient,
    /// The squared sum of the gradients' lengths at the data.
    MeanGradient,
}

/// How the smallest eigenvalues are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs, reason = "the names say it")]
pub enum SolverChoice {
    Auto,
    Dense,
    ShiftInvert,
    Lobpcg,
}

/// Which parts of the zero set are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum BranchesChoice {
    /// All of them.
    All,
    /// Those that hold data, and what continues them.
    Data,
}

/// Arguments of `zeroset fit2d`.
#[derive(Debug, Clone, clap::Args)]
#[command(after_help = EXAMPLES)]
pub struct Fit2dArgs {
    /// Points, segments and polygons: json, or points alone: csv, txt; `-` reads either from standard input.
    #[arg(value_name = "INPUT")]
    pub input: PathBuf,
    /// Picture (svg) or figures (json) to write; `-` is standard output, as json.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,

    /// Where F is known: lattice, four (triangles) or delaunay [default: the file's domain, else lattice].
    #[arg(long, value_name = "KIND", hide_possible_values = true, help_heading = "Domain")]
    pub domain: Option<DomainChoice>,
    /// Cells of a lattice along its longer side.
    #[arg(help = "Cells of a lattice along its longer side [default: as many as all have data enough; with order 1 or 2 twice the root of the number of data; radial: half a width each]",
        long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=1000), help_heading = "Domain")]
    pub cells: Option<u32>,
    /// Data that become vertices of a Delaunay mesh, spread evenly [default: a quarter of the points, 4 to 60].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=100_000), help_heading = "Domain")]
    pub sites: Option<u32>,
    /// Box of the domain [default: that of the data, grown by 10 % of its longer side].
    #[arg(help = "Box of the domain: xmin,ymin,xmax,ymax [default: that of the data, grown by 10 % of its longer side]",
        long, value_name = "BOX", value_parser = values::rectangle, allow_hyphen_values = true, help_heading = "Domain")]
    pub bounds: Option<Rectangle>,

    /// What F is made of.
    #[arg(
        help = "What F is made of: p1, p2, gaussian, multiquadric, inverse-multiquadric, thin-plate, wendland-c2 or wendland-c4",
        long,
        value_name = "KIND",
        default_value = "p1",
        hide_possible_values = true,
        help_heading = "Basis"
    )]
    pub basis: BasisChoice,
    /// Radial functions: their number, at data spread evenly [default: 60, or all data if fewer].
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=2000), help_heading = "Basis")]
    pub centres: Option<u32>,
    /// Radial functions: their width [default: 5 times the mean distance of a centre to its nearest].
    #[arg(help = "Radial functions: their width [default: 5 times the mean distance of a centre to its nearest, 2 times with order 0 or thin plates; Wendland's functions, which end there: three times that]",
        long, value_name = "LENGTH", value_parser = values::positive, help_heading = "Basis")]
    pub width: Option<f64>,

    /// What keeps F from zero: coefficients, squared-gradient or mean-gradient.
    #[arg(
        long,
        value_name = "KIND",
        default_value = "coefficients",
        hide_possible_values = true,
        help_heading = "Fit"
    )]
    pub normalization: NormalizationChoice,
    /// Derivatives that are kept small: 0 for none, 1 or 2.
    #[arg(long, value_name = "ORDER", default_value = "0", value_parser = clap::value_parser!(u8).range(0..=2), help_heading = "Fit")]
    pub order: u8,
    /// Weight of the smoothness, with order 1 or 2.
    #[arg(help = "Weight of the smoothness, with order 1 or 2 [default: by the data's weight; order 1: a twelfth of it over the cells along the longer side of the domain; order 2: 1e-6 of it, times the square of that side]",
        long, value_name = "WEIGHT", value_parser = values::not_negative, help_heading = "Fit")]
    pub smoothness: Option<f64>,
    /// Weight of segments and polygons for each unit of length; a point weighs 1.
    #[arg(long, value_name = "WEIGHT", default_value = "1", value_parser = values::positive, help_heading = "Fit")]
    pub line_weight: f64,
    /// How eigenvalues are found: auto, dense, shift-invert or lobpcg.
    #[arg(long, value_name = "KIND", default_value = "auto", hide_possible_values = true, help_heading = "Fit")]
    pub solver: SolverChoice,

    /// How near the contour is to the zero set [default: 1/1000 of the domain's longer side].
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, help_heading = "Contour and picture")]
    pub tolerance: Option<f64>,
    /// Parts of the zero set to keep: all, or data for those that hold data and what continues them.
    #[arg(
        long,
        value_name = "WHICH",
        default_value = "data",
        hide_possible_values = true,
        help_heading = "Contour and picture"
    )]
    pub branches: BranchesChoice,
    /// Longer side of the domain in the picture, in pixels.
    #[arg(long, value_name = "PIXELS", default_value = "560", value_parser = clap::value_parser!(u32).range(100..=10_000), help_heading = "Contour and picture")]
    pub size: u32,
    /// Leave the edges of the cells out of the picture.
    #[arg(long, help_heading = "Contour and picture")]
    pub no_cells: bool,
    /// Leave the shades of F out of the picture.
    #[arg(long, help_heading = "Contour and picture")]
    pub no_shading: bool,

    /// Print nothing but errors.
    #[arg(short, long)]
    pub quiet: bool,
}
