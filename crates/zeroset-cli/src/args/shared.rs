//! What several commands have in common: which points, what they show, how to run.

use std::num::NonZeroUsize;
use std::path::PathBuf;

use clap::ValueEnum;
use zeroset::mesh::SimplifyParams;

use super::values::{self, Bounds, Classes, OrOff};

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

/// Clouds, and which of their points are used.
#[derive(Debug, Clone, clap::Args)]
pub struct InputArgs {
    /// Point clouds, taken together as one; `-` reads lines of x y z from standard input.
    #[arg(value_name = "INPUT", required = true)]
    pub inputs: Vec<PathBuf>,
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
}

/// What the points show.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct SceneArgs {
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
}

/// How far a mesh is simplified: until the number or the error is reached, whichever comes first.
#[derive(Debug, Clone, Copy, clap::Args)]
pub struct SimplifyTarget {
    /// Simplify the mesh to N triangles.
    #[arg(long, value_name = "N", help_heading = "Simplification")]
    pub triangles: Option<NonZeroUsize>,
    /// Simplify the mesh as far as it moves by no more than this, in the unit of the input.
    #[arg(long, value_name = "LENGTH", value_parser = values::positive, help_heading = "Simplification")]
    pub max_error: Option<f64>,
}

impl SimplifyTarget {
    /// The same as the core understands it; `None` if nothing is asked for.
    pub(crate) fn params(&self) -> Option<SimplifyParams> {
        let triangles = self.triangles.map(NonZeroUsize::get);
        let params = SimplifyParams { triangles, max_error: self.max_error, ..SimplifyParams::default() };
        (triangles.is_some() || params.max_error.is_some()).then_some(params)
    }
}

/// How to run.
#[derive(Debug, Clone, clap::Args)]
pub struct RunArgs {
    /// Threads to use [default: all]; the result does not depend on it.
    #[arg(long, value_name = "N", value_parser = values::threads, help_heading = "Running")]
    pub threads: Option<NonZeroUsize>,
    /// Memory to use at most, such as 4GB [default: 70 % of what is free].
    #[arg(long, value_name = "SIZE", value_parser = values::size, help_heading = "Running")]
    pub memory: Option<u64>,
    /// Write a report of all figures as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE", help_heading = "Running")]
    pub report: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long, conflicts_with = "verbose", help_heading = "Running")]
    pub quiet: bool,
    /// Print a table of stages and levels.
    #[arg(short, long, help_heading = "Running")]
    pub verbose: bool,
}

/// How to run where there is nothing to limit.
#[derive(Debug, Clone, clap::Args)]
pub struct BriefRunArgs {
    /// Threads to use [default: all]; the result does not depend on it.
    #[arg(long, value_name = "N", value_parser = values::threads, help_heading = "Running")]
    pub threads: Option<NonZeroUsize>,
    /// Write a report of all figures as JSON; `-` is standard output.
    #[arg(long, value_name = "FILE", help_heading = "Running")]
    pub report: Option<PathBuf>,
    /// Print nothing but errors.
    #[arg(short, long, help_heading = "Running")]
    pub quiet: bool,
}
