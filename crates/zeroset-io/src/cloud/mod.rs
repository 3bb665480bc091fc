//! Reading and writing point clouds.

mod columns;
mod e57;
pub(crate) mod las;
mod parts;
mod pcd;
pub(crate) mod ply;
mod report;
pub(crate) mod text;
mod write;

use std::path::{Path, PathBuf};

pub use parts::{CloudPart, CloudSize, cloud_size, read_cloud_parts};
pub use report::{CloudFile, LinearUnit, NO_CLASS, NO_COLOR, NO_INTENSITY, ReadReport, Source};
pub use write::write_cloud;

use crate::input::read_file;
use crate::{CloudFormat, IoError};
pub(crate) use columns::{Columns, check_size, class_from_value, colors_from_values};

/// Reads a cloud; the suffix tells the format, `-` is text on standard input.
///
/// Points whose coordinates are NaN or infinite are left out and counted, and so are points that a LAS file marks as
/// withheld. Coordinates are f64 from the file to the [`Cloud`](zeroset::cloud::Cloud); its offset follows
/// [`choose_offset`](zeroset::cloud::choose_offset).
///
/// # Errors
/// Whatever keeps the points from being read in full: see [`IoError`].
///
/// ```
/// let path = std::env::temp_dir().join("zeroset-doc-three-points.xyz");
/// std::fs::write(&path, "84810.3 447412.8 1\n84811.3 447412.8 1\n84810.3 447413.8 nan\n")?;
/// let file = zeroset_io::read_cloud(&path)?;
/// assert_eq!((file.cloud.len(), file.report.non_finite), (2, 1));
/// assert_eq!(file.cloud.world(0), [84810.3, 447412.8, 1.0]);
/// # std::fs::remove_file(&path)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_cloud(path: &Path) -> Result<CloudFile, IoError> {
    let format = CloudFormat::from_path(path)?;
    let bytes = read_file(path)?;
    read_cloud_bytes(path, format, bytes)
}

/// Reads a cloud from the content of a file. `path` only names it in messages.
///
/// # Errors
/// As [`read_cloud`].
pub fn read_cloud_bytes(path: &Path, format: CloudFormat, bytes: Vec<u8>) -> Result<CloudFile, IoError> {
    Ok(world(path, format, bytes)?.into_file())
}

/// Reads several files as one cloud, in the order given, with one common offset.
///
/// Where only some inputs have an attribute, the points of the others get [`NO_COLOR`], [`NO_INTENSITY`] or [`NO_CLASS`],
/// and the report's notes say so. If the inputs state different reference systems the first one is kept and the notes
/// say so, too: coordinates are not transformed.
///
/// # Errors
/// As [`read_cloud`], for the first input that fails; and [`IoError::NoInput`] for an empty list.
pub fn read_clouds(paths: &[PathBuf]) -> Result<CloudFile, IoError> {
    // Names are looked at first: a mistyped last name should not cost the reading of all others.
    let formats = paths.iter().map(|path| CloudFormat::from_path(path)).collect::<Result<Vec<_>, _>>()?;
    let mut joined: Option<report::WorldCloud> = None;
    for (path, format) in paths.iter().zip(formats) {
        let next = world(path, format, read_file(path)?)?;
        match &mut joined {
            Some(joined) => joined.append(path, next),
            None => joined = Some(next),
        }
    }
    Ok(joined.ok_or(IoError::NoInput)?.into_file())
}

/// The points before the offset is taken off.
pub(crate) fn world(path: &Path, format: CloudFormat, bytes: Vec<u8>) -> Result<report::WorldCloud, IoError> {
    if bytes.is_empty() {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    let columns = match format {
        CloudFormat::Las | CloudFormat::Laz => las::read(path, format, &bytes)?,
        CloudFormat::Ply => ply::read(path, &bytes)?,
        CloudFormat::Xyz | CloudFormat::Csv => text::read(path, &bytes, text::Convention::Plain)?,
        CloudFormat::Pts => text::read(path, &bytes, text::Convention::Pts)?,
        CloudFormat::Pcd => pcd::read(path, &bytes)?,
        CloudFormat::E57 => e57::read(path, &bytes)?,
    };
    // The points are decoded: the file's bytes need not be there while they are sifted.
    drop(bytes);
    columns.finish(path, format)
}
