//! Clouds that need not fit into memory.

use std::path::Path;

use zeroset::cloud::Cloud;

use super::columns::{Columns, Sifted};
use super::las::{self, Table, Values};
use super::read_cloud;
use super::report::{LinearUnit, ReadReport};
use crate::input::{OpenFile, Source};
use crate::{CloudFormat, IoError};

/// Points that follow one another in a file.
#[derive(Debug, Clone)]
pub struct CloudPart {
    /// The place of the first of them in the file. At 0 a reading begins, perhaps anew: what came before is void then.
    pub first: u64,
    /// The points, with an offset of their own. There may be none, if all are left out.
    pub cloud: Cloud,
}

/// Reads a cloud in parts of about so many points, and hands over one after the other.
///
/// LAS and LAZ are read so; of other formats all points are one part. Parts follow from the file and their size alone. What they
/// hold is what [`read_cloud`] gives, but for the rounding that their own offsets bring, which is less than a millionth of a
/// millimetre.
///
/// Whether colours are 8 or 16 bits, and whether there are any values but zeros, is only known at the end of a LAS file. Parts are
/// read as those before them tell. If one tells otherwise, reading begins anew with what is known by then, and its first part says
/// so. That is rare, and comes at most three times.
///
/// # Errors
/// As [`read_cloud`], and whatever `take` returns. An error may come after parts were taken.
///
/// ```
/// # let path = std::env::temp_dir().join("zeroset-doc-parts.las");
/// # let points = (0..5000).map(|i| [f64::from(i), 0.0, 1.0]).collect();
/// # zeroset_io::write_cloud(&path, &zeroset::cloud::Cloud::from_world(points), &zeroset_io::WriteOptions::default())?;
/// use zeroset_io::{CloudPart, IoError, read_cloud_parts};
///
/// let mut highest = f64::NEG_INFINITY;
/// let report = read_cloud_parts(&path, 1000, |CloudPart { first, cloud }| {
///     if first == 0 {
///         highest = f64::NEG_INFINITY;
///     }
///     highest = (0..cloud.len()).map(|i| cloud.world(i)[2]).fold(highest, f64::max);
///     Ok::<(), IoError>(())
/// })?;
/// assert_eq!((report.points_read, highest), (5000, 1.0));
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), IoError>(())
/// ```
pub fn read_cloud_parts<E: From<IoError>>(
    path: &Path,
    points: usize,
    mut take: impl FnMut(CloudPart) -> Result<(), E>,
) -> Result<ReadReport, E> {
    let format = CloudFormat::from_path(path)?;
    let Some(mut parts) = open(path, format)? else {
        let file = read_cloud(path)?;
        take(CloudPart { first: 0, cloud: file.cloud })?;
        return Ok(file.report);
    };
    let mut known: Option<Values> = None;
    let (mut sifted, mut last) = (Sifted::default(), Columns::default());
    loop {
        let first = parts.done();
        let mut table = Table::default();
        parts.next(points.max(1), &mut table)?;
        if table.len() == 0 {
            return Ok(last.report(path, format, sifted)?);
        }
        let values = known.unwrap_or_default().or(table.values());
        if first > 0 && known != Some(values) {
            known = Some(values);
            sifted = Sifted::default();
            parts.rewind();
            continue;
        }
        known = Some(values);
        last = parts.columns(table, values);
        sifted = sifted.and(last.sift(path, first)?);
        let world = std::mem::take(&mut last.points);
        let attributes = last.attributes.clone();
        let cloud = Cloud { attributes, crs: last.crs.clone(), ..Cloud::from_world(world) };
        take(CloudPart { first, cloud })?;
    }
}

/// How large a cloud is.
#[derive(Debug, Clone, PartialEq)]
pub struct CloudSize {
    /// Number of points.
    pub points: u64,
    /// Lowest and highest coordinates.
    pub bounds: [[f64; 3]; 2],
    /// The unit of the coordinates, where the file tells.
    pub unit: Option<LinearUnit>,
}

/// How large a cloud is, without reading its points where the file tells. The header of LAS and LAZ does, and is believed.
///
/// # Errors
/// As [`read_cloud`].
pub fn cloud_size(path: &Path) -> Result<CloudSize, IoError> {
    let format = CloudFormat::from_path(path)?;
    if let Some(parts) = open(path, format)? {
        return Ok(parts.size());
    }
    let file = read_cloud(path)?;
    let bounds = file.cloud.bounds().ok_or_else(|| IoError::NoPoints { path: path.to_path_buf() })?;
    Ok(CloudSize { points: file.report.points_read, bounds, unit: file.report.unit })
}

/// Opens a file that can be read in parts; `None` if it is read as a whole.
fn open(path: &Path, format: CloudFormat) -> Result<Option<las::Parts<'_, OpenFile>>, IoError> {
    if !matches!(format, CloudFormat::Las | CloudFormat::Laz) {
        return Ok(None);
    }
    let Some(file) = OpenFile::open(path)? else { return Ok(None) };
    if file.length() == 0 {
        return Err(IoError::Empty { path: path.to_path_buf() });
    }
    las::Parts::open(path, format, file).map(Some)
}
