//! From positions to pixels.

use crate::fit2d::measure::Extent;

/// A place in the picture, in hundredths of a pixel, y down.
pub(super) type Pixel = [i32; 2];

/// Hundredths.
const PER_PIXEL: f64 = 100.0;
/// About the width of a letter.
pub(super) const LETTER: f64 = 6.7;
/// Room above the domain, and to its right for the colour bar.
const TOP: f64 = 16.0;
const RIGHT: f64 = 110.0;
/// Room below the domain for the axis, the legend and the caption.
const BOTTOM: f64 = 104.0;
/// Length of the marks on the axes.
pub(super) const TICK: f64 = 5.0;
/// Room to the right of a caption.
const AFTER_CAPTION: f64 = 16.0;

/// The frame of the picture.
#[derive(Debug, Clone)]
pub(super) struct Canvas {
    extent: Extent,
    /// Pixels for each unit of length.
    scale: f64,
    left: f64,
    /// Letters of the longest caption.
    caption: usize,
    /// Marks on the axes: coordinates, and their texts.
    pub(super) ticks: [Vec<(f64, String)>; 2],
}

impl Canvas {
    /// The longer side of the box gets `size` pixels; `caption` is the number of letters of the longest caption.
    pub(super) fn new(extent: Extent, size: u32, caption: usize) -> Self {
        let scale = f64::from(size) / extent.longer_side();
        let ticks = [0, 1].map(|a| {
            let pixels = scale * extent.sides()[a];
            marks(extent.low[a], extent.high[a], (pixels / [70.0, 60.0][a]).clamp(1.0, 12.0))
        });
        let longest = ticks[1].iter().map(|(_, text)| text.len()).max().unwrap_or(0);
        Self { extent, scale, left: 24.0 + LETTER * longest as f64, caption, ticks }
    }

    /// Where a position is drawn.
    pub(super) fn pixel(&self, position: [f64; 2]) -> Pixel {
        let [x, y] = self.place(position);
        // Positions far outside the box are held at a distance that the numbers bear.
        [x, y].map(|c| (PER_PIXEL * c).round().clamp(-1e8, 1e8) as i32)
    }

    /// The same in pixels.
    pub(super) fn place(&self, position: [f64; 2]) -> [f64; 2] {
        let offset: [f64; 2] = std::array::from_fn(|a| self.scale * (position[a] - self.extent.low[a]));
        [self.left + offset[0], TOP + self.scale * self.extent.sides()[1] - offset[1]]
    }

    /// Lower left and upper right corner of the domain's box, in pixels.
    pub(super) fn corners(&self) -> [[f64; 2]; 2] {
        [self.extent.low, self.extent.high].map(|p| self.place(p).map(|c| (PER_PIXEL * c).round() / PER_PIXEL))
    }

    /// Width and height of the picture.
    pub(super) fn size(&self) -> (f64, f64) {
        let [width, height] = self.extent.sides().map(|side| self.scale * side);
        let caption = LETTER * self.caption as f64 + AFTER_CAPTION;
        ((self.left + caption.max(width + RIGHT)).ceil(), (TOP + height + BOTTOM).ceil())
    }
}

/// A pixel as text.
pub(super) fn place([x, y]: Pixel) -> String {
    format!("{} {}", hundredths(x), hundredths(y))
}

fn hundredths(value: i32) -> String {
    let (sign, size) = (if value < 0 { "-" } else { "" }, value.unsigned_abs());
    match (size / 100, size % 100) {
        (whole, 0) => format!("{sign}{whole}"),
        (whole, part) if part % 10 == 0 => format!("{sign}{whole}.{}", part / 10),
        (whole, part) => format!("{sign}{whole}.{part:02}"),
    }
}

/// The step of 1, 2 or 5 times a power of ten that is no less than a value, and its decimals.
pub(super) fn round_step(least: f64) -> (f64, usize) {
    let power = least.log10().floor();
    let unit = 10_f64.powf(power);
    let factor = [1.0, 2.0, 5.0].into_iter().find(|f| f * unit >= least * (1.0 - 1e-9));
    let (factor, power) = factor.map_or((1.0, power + 1.0), |factor| (factor, power));
    (factor * 10_f64.powf(power), (-power).clamp(0.0, 12.0) as usize)
}

/// About so many round coordinates in a range, with their texts.
fn marks(low: f64, high: f64, about: f64) -> Vec<(f64, String)> {
    let (step, decimals) = round_step((high - low) / about);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let count = (last - first).clamp(0.0, 30.0) as usize + 1;
    let large = low.abs().max(high.abs()) >= 1e8 || (step < 1e-4 && high.abs() < 1e-2);
    (0..count)
        .map(|i| (first + i as f64) * step)
        .filter(|mark| *mark <= high + 1e-9 * step)
        .map(|mark| (mark, if large { format!("{mark:.4e}") } else { format!("{:.decimals$}", mark + 0.0) }))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_round() {
        let texts = |low, high, about| marks(low, high, about).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(0.0, 1.0, 5.0), ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        assert_eq!(texts(84_810.0, 84_850.0, 4.0), ["84810", "84820", "84830", "84840", "84850"]);
        assert_eq!(texts(-0.3, 0.3, 3.0), ["-0.2", "0.0", "0.2"]);
        assert_eq!(texts(2e9, 3e9, 2.0), ["2.0000e9", "2.5000e9", "3.0000e9"]);
    }

    #[test]
    fn pixels_are_hundredths() {
        let canvas = Canvas::new(Extent { low: [1e6, 0.0], high: [1e6 + 2.0, 1.0] }, 200, 10);
        let [low, high] = canvas.corners();
        assert!((high[0] - low[0] - 200.0).abs() < 1e-9 && (low[1] - high[1] - 100.0).abs() < 1e-9);
        assert_eq!(hundredths(-5), "-0.05");
        assert_eq!(hundredths(1230), "12.3");
        assert_eq!(hundredths(-700), "-7");
    }
}
