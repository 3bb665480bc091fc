//! Formats of point clouds, meshes, features and constraints for `zeroset`.
//!
//! | | read | written |
//! |---|---|---|
//! | clouds | LAS, LAZ (COPC too), PLY, XYZ / TXT / CSV / ASC, PTS, PCD, E57 | LAS, LAZ, PLY, XYZ / TXT / CSV / ASC, PTS |
//! | meshes | PLY, OBJ, STL, OFF, GLB | PLY, OBJ, STL, OFF, GLB |
//! | models | ZSET | ZSET |
//! | features | JSON | JSON, GeoJSON, OBJ, PLY, DXF |
//! | sections | | SVG, DXF, GeoJSON |
//! | points with values of F | any format of clouds, NPY | PLY, CSV, NPY |
//! | rasters | | GeoTIFF |
//! | pictures | | PNG |
//! | constraints | OBJ, GeoJSON, DXF, and features as JSON | |
//! | data in the plane | JSON, CSV | JSON |
//! | solids | expressions, TOML | |
//!
//! ```no_run
//! use std::path::Path;
//! let file = zeroset_io::read_cloud(Path::new("tile.laz"))?;
//! println!("{} points in {:?}", file.cloud.len(), file.report.unit);
//! # Ok::<(), zeroset_io::IoError>(())
//! ```
//!
//! # Guaranteed
//! - Coordinates pass from a file to the cloud as f64, and the offset is taken off before anything is rounded: the
//!   millimetres of national grids survive.
//! - Equal files give equal clouds, bit for bit, on any number of threads.
//! - Memory is bounded by a small multiple of a file's true size, whatever counts it states, and no content makes a
//!   reader panic.
//! - Every error is one line that names the file and the remedy.
//! - A file is written completely or not at all: see [`write_atomically`].
//!
//! # Not guaranteed
//! - Coordinates are not transformed between reference systems, nor between units: readers give what files hold.
//!   [`globe`] tells where on the globe it lies.
//! - GPS time, return numbers, normals and extra columns are not kept.

pub mod cloud;
mod collection;
pub mod constraints;
mod drawing;
mod epsg;
mod error;
pub mod features;
mod format;
pub mod globe;
mod guard;
mod input;
pub mod mesh;
pub mod model;
mod number;
mod output;
pub mod picture;
pub mod planar;
mod ply;
pub mod raster;
pub mod section;
pub mod solid;
pub mod table;

pub use cloud::{
    CloudFile, CloudPart, CloudSize, LinearUnit, NO_CLASS, NO_COLOR, NO_INTENSITY, ReadReport, Source, cloud_size,
    read_cloud, read_cloud_bytes, read_cloud_parts, read_clouds, write_cloud,
};
pub use constraints::{
    ConstraintFile, ConstraintFormat, Footprint, read_constraints, read_constraints_bytes, read_footprints,
    read_footprints_bytes,
};
pub use error::{IoError, shown};
pub use features::{FeatureFile, FeatureFormat, FeatureOutput, read_features, read_features_bytes, write_features};
pub use format::{CloudFormat, MeshFormat, by_suffix};
pub use globe::{Frame, Globe, GlobeError};
pub use mesh::{WriteOptions, WriteReport, read_mesh, read_mesh_bytes, write_mesh};
pub use model::{check_model_suffix, is_model, read_model, read_model_bytes, write_model};
pub use output::{abandon_writes, check_writable, write_atomically};
pub use picture::{PictureFormat, write_picture};
pub use planar::{PlanarData, PlanarFormat, PlanarResult, planar_json, read_planar, read_planar_bytes};
pub use raster::{Raster, RasterFormat, write_raster};
pub use section::{Section, SectionFormat, SectionLevel, SectionLine, SectionPlane, plane_frame, write_section};
pub use solid::{Operands, SolidError, SolidFiles, parse_solid, parse_solid_tree};
pub use table::{
    EvaluatedPoints, PositionFile, PositionFormat, TableFormat, read_positions, read_positions_bytes, write_evaluated,
};

/// The largest coordinate that is read or written, in the unit of the file.
///
/// National grids reach 10^7 m, which is 10^10 mm. Beyond 10^11 a coordinate is a mistake or a mark for "no data", and
/// f64 would resolve it to no more than 0.015 mm even if it were metres.
pub const MAX_COORDINATE: f64 = 1e11;
