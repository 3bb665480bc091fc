//! Pictures: written as PNG.

use std::path::Path;

use crate::mesh::WriteReport;
use crate::output::write_file;
use crate::{IoError, format};

/// A format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum PictureFormat {
    /// Portable network graphics.
    Png,
}

impl PictureFormat {
    /// Every suffix that is known, with its format.
    pub const KNOWN: &'static [(&'static str, Self)] = &[("png", Self::Png)];

    /// The format that the suffix of `path` stands for, in upper or lower case.
    ///
    /// # Errors
    /// [`IoError::UnknownSuffix`], which lists the known ones.
    pub fn from_path(path: &Path) -> Result<Self, IoError> {
        format::by_suffix(path, "picture", Self::KNOWN)
    }
}

/// Writes a picture; the suffix tells the format. See [`crate::write_atomically`] for what happens to an old file.
///
/// `pixels` are red, green, blue and opacity, row by row from the top, `size` of them across and down. A picture without a transparent pixel is written without opacity. Equal
/// pictures give equal bytes.
///
/// # Errors
/// The number of pixels is not that of the size, or the file cannot be written.
///
/// ```
/// use zeroset_io::write_picture;
/// let path = std::env::temp_dir().join("zeroset-doc-picture.png");
/// write_picture(&path, [2, 1], &[[255, 0, 0, 255], [0, 0, 255, 128]])?;
/// # std::fs::remove_file(&path).unwrap();
/// # Ok::<(), zeroset_io::IoError>(())
/// ```
pub fn write_picture(path: &Path, size: [u32; 2], pixels: &[[u8; 4]]) -> Result<WriteReport, IoError> {
    PictureFormat::from_path(path)?;
    let [width, height] = size;
    if size.contains(&0) || pixels.len() as u64 != u64::from(width) * u64::from(height) {
        let what = format!("a picture of {width} by {height} has {} pixels", pixels.len());
        return Err(IoError::malformed(path, what, "this is a fault of the program that made it"));
    }
    let is_opaque = pixels.iter().all(|pixel| pixel[3] == u8::MAX);
    let bytes = write_file(path, |sink| {
        let mut encoder = png::Encoder::new(sink, width, height);
        encoder.set_color(if is_opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        encoder.set_depth(png::BitDepth::Eight);
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        let kept = if is_opaque { 3 } else { 4 };
        let data: Vec<u8> = pixels.iter().flat_map(|pixel| pixel[..kept].iter().copied()).collect();
        let mut writer = encoder.write_header().map_err(to_io)?;
        writer.write_image_data(&data).map_err(to_io)?;
        writer.finish().map_err(to_io)
    })?;
    Ok(WriteReport { bytes, ..WriteReport::default() })
}

fn to_io(error: png::EncodingError) -> std::io::Error {
    match error {
        png::EncodingError::IoError(error) => error,
        other => std::io::Error::other(other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(path: &Path) -> (png::ColorType, Vec<u8>) {
        let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
        let mut reader = png::Decoder::new(file).read_info().unwrap();
        let mut data = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut data).unwrap();
        data.truncate(info.buffer_size());
        (info.color_type, data)
    }

    #[test]
    fn pixels_come_back_with_opacity_where_there_is_any() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.PNG");
        let pixels = [[1, 2, 3, 255], [4, 5, 6, 255], [7, 8, 9, 255], [10, 11, 12, 0]];
        write_picture(&path, [2, 2], &pixels).unwrap();
        assert_eq!(read(&path), (png::ColorType::Rgba, pixels.concat()));
        write_picture(&path, [1, 3], &pixels[..3]).unwrap();
        assert_eq!(read(&path), (png::ColorType::Rgb, vec![1, 2, 3, 4, 5, 6, 7, 8, 9]));
    }

    #[test]
    fn a_picture_that_is_none_is_refused_and_leaves_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        std::fs::write(&path, "old").unwrap();
        for (size, pixels) in [([2, 2], 3), ([0, 0], 0), ([u32::MAX, u32::MAX], 1)] {
            assert!(write_picture(&path, size, &vec![[0; 4]; pixels]).is_err());
        }
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        assert!(matches!(write_picture(Path::new("a.jpg"), [1, 1], &[[0; 4]]), Err(IoError::UnknownSuffix { .. })));
    }
}
