//! Grids of values over the plane, such as surface models (DSM): written as GeoTIFF.

mod keys;

use std::path::Path;

use tiff::encoder::colortype::Gray32Float;
use tiff::encoder::{Compression, DeflateLevel, TiffEncoder, TiffKind};
use tiff::tags::Tag;
use tiff::{TiffError, TiffResult};

use crate::mesh::WriteReport;
use crate::output::{Sink, write_file};
use crate::{IoError, MAX_COORDINATE, format};
use keys::GeoKeys;

/// A grid of values with a place in the world.
#[derive(Debug, Clone, PartialEq)]
pub struct Raster {
    /// West edge and north edge of the grid, in world coordinates: the corner of the first cell, not its middle.
    pub origin: [f64; 2],
    /// The side of a cell, in the unit of the coordinates.
    pub cell: f64,
    /// Cells from west to east, and from north to south.
    pub size: [usize; 2],
    /// The values, row by row from the north and each row from the west; NaN where there is none.
    pub values: Vec<f32>,
    /// The reference system, as the input stated it.
    pub crs: Option<String>,
}

/// A format of rasters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum RasterFormat {
    /// TIFF with its place in the world.
    GeoTiff,
}

impl RasterFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] = &[("tif", Self::GeoTiff), ("tiff", Self::GeoTiff)];

    /// The format that the suffix of `path` stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        format::by_suffix(path, "raster", Self::KNOWN)
    }

    /// The name that messages use.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::GeoTiff => "GeoTIFF",
        }
    }
}

/// Values beyond this are more than the 32 bit offsets of plain TIFF can point behind.
const MOST_IN_PLAIN: usize = 1_000_000_000;

/// Writes a raster; the suffix tells the format. See [`crate::write_atomically`] for what happens to an old file.
///
/// **GeoTIFF** 1.1: one band in single precision, compressed by deflate; BigTIFF beyond 10^9 cells. Cells without a value
/// are NaN, and the tag `GDAL_NODATA` says so. A reference system with an EPSG code is written as that code, with the code
/// of the vertical system if there is one; WKT without a code is written whole, in a way that GDAL reads; any other text
/// is a citation.
///
/// # Errors
/// The number of values is not that of the cells, a value is infinite, the origin or the cell is of no use, or the file
/// cannot be written.
///
/// ```
/// use zeroset_io::{Raster, write_raster};
/// let values = vec![1.0, 2.0, f32::NAN, 4.0, 5.0, 6.0];
/// let crs = Some("EPSG:28992+5709".to_owned());
/// let raster = Raster { origin: [84_800.0, 447_500.0], cell: 0.5, size: [3, 2], values, crs };
/// let path = std::env::temp_dir().join("zeroset-doc-raster.tif");
/// write_raster(&path, &raster)?;
/// # std::fs::remove_file(&path).ok();
/// # Ok::<(), zeroset_io::IoError>(())
/// ```
pub fn write_raster(path: &Path, raster: &Raster) -> Result<WriteReport, IoError> {
    let RasterFormat::GeoTiff = RasterFormat::from_path(path)?;
    let size = check(path, raster)?;
    let bytes = write_file(path, |sink| {
        let written = if raster.values.len() > MOST_IN_PLAIN {
            TiffEncoder::new_big(sink).and_then(|file| encode(file, raster, size))
        } else {
            TiffEncoder::new(sink).and_then(|file| encode(file, raster, size))
        };
        written.map_err(|error| match error {
            TiffError::IoError(error) => error,
            other => std::io::Error::other(other),
        })
    })?;
    Ok(WriteReport { bytes, ..WriteReport::default() })
}

/// Looks at every number. Returns width and height.
fn check(path: &Path, raster: &Raster) -> Result<[u32; 2], IoError> {
    let wrong = |what: String| IoError::malformed(path, what, "correct the raster first");
    let [width, height] = raster.size;
    let sides = [width, height].map(|side| u32::try_from(side).unwrap_or(0));
    if sides.contains(&0) {
        return Err(wrong(format!("a raster of {width} x {height} cells cannot be written")));
    }
    if Some(raster.values.len()) != width.checked_mul(height) {
        return Err(wrong(format!("the raster has {} values for {width} x {height} cells", raster.values.len())));
    }
    if !(raster.cell.is_finite() && raster.cell > 0.0) {
        return Err(wrong(format!("the raster has cells of the side {}", raster.cell)));
    }
    let [west, north] = raster.origin;
    if !raster.origin.iter().all(|c| c.abs() <= MAX_COORDINATE) {
        return Err(wrong(format!("the corner of the raster is at {west}, {north}")));
    }
    match raster.values.iter().position(|value| value.is_infinite()) {
        Some(at) => Err(wrong(format!("the value in row {}, column {} is infinite", at / width, at % width))),
        None => Ok(sides),
    }
}

fn encode<K: TiffKind>(
    file: TiffEncoder<&mut dyn Sink, K>,
    raster: &Raster,
    [width, height]: [u32; 2],
) -> TiffResult<()> {
    let mut file = file.with_compression(Compression::Deflate(DeflateLevel::Balanced));
    let mut image = file.new_image::<Gray32Float>(width, height)?;
    let tags = image.encoder();
    let ([west, north], cell) = (raster.origin, raster.cell);
    tags.write_tag(Tag::Software, concat!("zeroset ", env!("CARGO_PKG_VERSION")))?;
    tags.write_tag(Tag::ModelPixelScaleTag, &[cell, cell, 0.0][..])?;
    // The corner of the image at column and row 0 is at the origin of the raster.
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, west, north, 0.0][..])?;
    tags.write_tag(Tag::GdalNodata, "nan")?;
    if let Some(crs) = &raster.crs {
        let keys = GeoKeys::of(crs);
        tags.write_tag(Tag::GeoKeyDirectoryTag, &keys.directory()[..])?;
        if !keys.texts.is_empty() {
            tags.write_tag(Tag::GeoAsciiParamsTag, keys.texts.as_str())?;
        }
    }
    image.write_data(&raster.values)
}
