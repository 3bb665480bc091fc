//! Solids as users write them: expressions, and trees in TOML.
//!
//! ```
//! let cup = "subtract(cylinder(0,0,0; 0,0,10; 4); cylinder(0,0,1; 0,0,11; 3)) rotate(x, 90deg)";
//! let cup = zeroset_io::SolidFiles::default().expression(cup)?;
//! let field = cup.field([0.0; 3])?;
//! assert!(field.value([0.0, -0.5, 0.0]) < 0.0 && field.value([0.0, -5.0, 0.0]) > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Expressions
//!
//! ```text
//! operand    = ( shape | operation | file ) { transform }
//! shape      = "box(" corner ";" opposite corner ")"
//!            | "sphere(" centre ";" radius ")"
//!            | "cylinder(" end ";" end ";" radius ")"
//!            | "cone(" end ";" end ";" radius ";" radius ")"
//!            | "halfspace(" point ";" outward normal ")"
//!            | "extrude(" file of polygons ";" height ";" height ")"
//!            | "mesh(" file ")"
//! operation  = ( "union" | "intersect" | "subtract" ) "(" operand ";" operand { ";" operand } ")"
//!            | "smooth_union(" operand ";" operand ";" radius ")"
//! transform  = "at(" shift ")"
//!            | "rotate(" ( "x," | "y," | "z," | direction ";" ) angle [ ";" centre ] ")"
//!            | "scale(" factor [ ";" centre ] ")"
//!            | "offset(" distance ")" | "shell(" thickness ")" | "complement()"
//! ```
//!
//! - Positions, directions and normals are three numbers with commas between them. Spaces do not matter.
//! - Transforms work from left to right, in world coordinates. A centre that is not given is the origin.
//! - `subtract` takes all others from the first.
//! - Angles have a unit: `30deg` or `0.5rad`. They turn counter-clockwise for one who looks against the axis.
//! - A file that stands for itself is a mesh (`.ply`, `.obj`, `.stl`, `.off`, `.glb`), a model (`.zset`) or a tree (`.toml`). Its name ends at a
//!   space, `;` or a parenthesis; within quotation marks it may hold them.
//! - Polygons come from GeoJSON, DXF, OBJ or features as JSON: see [`read_footprints`](crate::read_footprints). Polygons that overlap are one solid.
//!
//! # Trees
//!
//! The same in TOML, one operand a table:
//!
//! ```toml
//! [solid]
//! op = "subtract"
//! of = [
//!     { file = "tile.ply" },
//!     { expr = "box(0,0,0; 10,5,3)", rotate = { axis = "z", degrees = 30 }, at = [84810, 447412, 2] },
//! ]
//! ```
//!
//! | key | value |
//! |---|---|
//! | `op` | `union`, `intersect`, `subtract`: two operands or more; `smooth_union`: two; `complement`, `offset`, `shell`: one |
//! | `of` | the list of operands |
//! | `radius`, `distance`, `thickness` | of `smooth_union`, `offset`, `shell` |
//! | `expr` | an expression, in place of `op` |
//! | `file` | a mesh, model or tree, in place of `op` |
//! | `scale` | a factor, about the origin |
//! | `rotate` | `axis`: `"x"`, `"y"`, `"z"` or three numbers; `degrees`; `about`: a position, the origin if left out |
//! | `at` | a shift |
//!
//! A table is scaled, then turned, then moved. Names of files are relative to the folder of the tree.
//!
//! # Guaranteed
//! - No text makes a reader panic or run out of stack: solids lie within at most 100 others.
//! - Shapes without volume, lengths that are not positive, and open meshes are refused where they are named.
//!
//! # Not guaranteed
//! - That something is left of an intersection or a difference.

mod cursor;
mod error;
mod expression;
mod files;
mod make;
mod tree;

use std::path::Path;

use zeroset::model::Solid;

pub use error::{Fault, SolidError};
pub use files::SolidFiles;

use crate::MeshFormat;
use crate::constraints::Footprint;

/// The suffix of models.
pub const MODEL_SUFFIX: &str = "zset";
/// The suffix of trees.
pub const TREE_SUFFIX: &str = "toml";

/// How many levels a solid can have. Work on one goes from level to level, so the stack limits them.
const DEEPEST: usize = 100;

/// What reads the files that expressions and trees name. [`SolidFiles`] is the usual one.
pub trait Operands {
    /// The solid that a file holds. It has `depth` levels around it; whoever reads a tree passes them on.
    ///
    /// # Errors
    /// If it cannot be read.
    fn file(&mut self, path: &Path, depth: usize) -> Result<Solid, SolidError>;

    /// The polygons that a file holds, in plan.
    ///
    /// # Errors
    /// If it cannot be read.
    fn footprints(&mut self, path: &Path) -> Result<Vec<Footprint>, SolidError>;
}

/// Reads an expression with `depth` levels around it, 0 for one on its own.
///
/// # Errors
/// If it cannot be understood, a shape in it has no volume, or a file that it names cannot be read.
pub fn parse_solid(text: &str, operands: &mut dyn Operands, depth: usize) -> Result<Solid, SolidError> {
    expression::parse(text, operands, depth)
}

/// Reads a TOML tree with `depth` levels around it, 0 for one on its own; `path` is for messages only.
///
/// # Errors
/// As [`parse_solid`].
pub fn parse_solid_tree(
    path: &Path,
    text: &str,
    operands: &mut dyn Operands,
    depth: usize,
) -> Result<Solid, SolidError> {
    tree::parse(path, text, operands, depth)
}

/// The suffixes of files that can be operands.
fn suffixes() -> String {
    let meshes = MeshFormat::KNOWN.iter().map(|(suffix, _)| *suffix);
    meshes.chain([MODEL_SUFFIX, TREE_SUFFIX]).collect::<Vec<_>>().join(", ")
}
