//! Letters on a picture.

use noto_sans_mono_bitmap::{FontWeight, RasterHeight, get_raster, get_raster_width};

use super::Picture;
use crate::color::Rgb;

/// A size of letters.
#[derive(Debug, Clone, Copy)]
pub(super) struct Font {
    height: RasterHeight,
}

impl Font {
    /// The size for a picture so high.
    pub(super) fn for_height(pixels: u32) -> Self {
        let height = match pixels {
            0..=700 => RasterHeight::Size16,
            701..=1000 => RasterHeight::Size20,
            1001..=1500 => RasterHeight::Size24,
            _ => RasterHeight::Size32,
        };
        Self { height }
    }

    /// Pixels from line to line.
    pub(super) fn line(self) -> u32 {
        self.height.val() as u32
    }

    /// Pixels across a text.
    pub(super) fn width(self, text: &str) -> u32 {
        (text.chars().count() * get_raster_width(FontWeight::Regular, self.height)) as u32
    }

    /// Writes a text whose left upper corner is at a pixel. Letters that are not there become question marks; what lies beyond the picture is left out.
    pub(super) fn write(self, picture: &mut Picture, text: &str, [left, top]: [u32; 2], color: Rgb) {
        let mut x = left;
        for letter in text.chars() {
            let raster = |c| get_raster(c, FontWeight::Regular, self.height);
            let Some(raster) = raster(letter).or_else(|| raster('?')) else { continue };
            for (dy, row) in raster.rows().enumerate() {
                for (dx, &strength) in row.iter().enumerate() {
                    picture.blend([x + dx as u32, top + dy as u32], color, strength);
                }
            }
            x += raster.width() as u32;
        }
    }
}

impl Picture {
    /// Lays a colour over a pixel, more or less strongly.
    pub(super) fn blend(&mut self, [x, y]: [u32; 2], color: Rgb, strength: u8) {
        if x >= self.size[0] || y >= self.size[1] || strength == 0 {
            return;
        }
        let pixel = &mut self.pixels[(y * self.size[0] + x) as usize];
        let over = f32::from(strength) / 255.0;
        let below = (1.0 - over) * f32::from(pixel[3]) / 255.0;
        let opacity = over + below;
        for c in 0..3 {
            pixel[c] = ((over * f32::from(color[c]) + below * f32::from(pixel[c])) / opacity).round() as u8;
        }
        pixel[3] = (255.0 * opacity).round() as u8;
    }

    /// Fills a rectangle, from one pixel up to but without another.
    pub(super) fn fill(&mut self, from: [u32; 2], to: [u32; 2], color: Rgb) {
        for y in from[1]..to[1] {
            for x in from[0]..to[0] {
                self.blend([x, y], color, 255);
            }
        }
    }
}
