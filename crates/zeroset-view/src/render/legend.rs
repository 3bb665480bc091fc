//! What the colours stand for, at the right side of a picture.

use super::text::Font;
use super::{Background, Picture};
use crate::color::{Legend, Rgb, Scale};

/// Marks along a bar, at most.
const MARKS: f64 = 6.0;
/// The bar takes so much of the height.
const BAR: f64 = 0.62;
/// Letters of the longest name that is written in full.
const LONGEST: usize = 30;
/// The legend takes no more than this share of the width.
const WIDEST: u32 = 3;

/// A legend, laid out.
pub(super) struct Panel<'a> {
    legend: &'a Legend,
    size: [u32; 2],
    font: Font,
    /// The texts from above: values, or names.
    rows: Vec<Row>,
}

struct Row {
    text: String,
    mark: Mark,
}

#[derive(Clone, Copy)]
enum Mark {
    /// At a share of the bar, from below.
    At(f64),
    /// A box of a colour.
    Box(Rgb),
}

impl<'a> Panel<'a> {
    pub(super) fn new(legend: &'a Legend, size: [u32; 2]) -> Self {
        let font = Font::for_height(size[1]);
        let rows = match legend {
            Legend::Bar { scale, .. } => marks(scale),
            Legend::Names { entries, .. } => {
                let fit = (size[1] / (font.line() * 3 / 2)).saturating_sub(3).max(1) as usize;
                let row = |(color, name): &(Rgb, String)| Row { text: short(name), mark: Mark::Box(*color) };
                let mut rows: Vec<Row> = entries.iter().take(fit).map(row).collect();
                if entries.len() > fit {
                    rows.push(Row { text: format!("and {} more", entries.len() - fit), mark: Mark::Box([255; 3]) });
                }
                rows
            }
        };
        Self { legend, size, font, rows }
    }

    fn title(&self) -> String {
        match self.legend {
            Legend::Bar { title, .. } | Legend::Names { title, .. } => short(title),
        }
    }

    /// Pixels that it takes of the width.
    pub(super) fn width(&self) -> u32 {
        let line = self.font.line();
        let rows = self.rows.iter().map(|row| self.font.width(&row.text) + 2 * line).max().unwrap_or(0);
        (rows.max(self.font.width(&self.title())) + 2 * line).min(self.size[0] / WIDEST)
    }

    /// Writes it onto a picture.
    pub(super) fn draw(&self, picture: &mut Picture, background: Background) {
        let is_dark = matches!(background, Background::Plain(color) if luminance(color) < 110.0);
        let ink: Rgb = if is_dark { [235, 235, 235] } else { [30, 34, 40] };
        let line = self.font.line();
        let left = self.size[0] - self.width() + line / 2;
        let bar = (BAR * f64::from(self.size[1])) as u32;
        let step = line * 3 / 2;
        let height = if matches!(self.legend, Legend::Bar { .. }) { bar } else { step * self.rows.len() as u32 };
        let top = (self.size[1].saturating_sub(height + 2 * line)) / 2;
        self.font.write(picture, &self.title(), [left, top], ink);
        let top = top + 2 * line;
        if let Legend::Bar { scale, .. } = self.legend {
            for y in 0..bar {
                let share = 1.0 - (f64::from(y) + 0.5) / f64::from(bar);
                picture.fill([left, top + y], [left + line, top + y + 1], scale.map.at(share));
            }
        }
        for (i, row) in self.rows.iter().enumerate() {
            let middle = match row.mark {
                Mark::At(share) => {
                    let y = top + ((1.0 - share) * f64::from(bar)).round() as u32;
                    picture.fill(
                        [left + line, y.min(top + bar - 1)],
                        [left + line + line / 3, y.min(top + bar - 1) + 1],
                        ink,
                    );
                    y
                }
                Mark::Box(color) => {
                    let y = top + step * i as u32;
                    picture.fill([left, y], [left + line, y + line], color);
                    y + line / 2
                }
            };
            self.font.write(picture, &row.text, [left + line + line / 2, middle.saturating_sub(line / 2)], ink);
        }
    }
}

fn luminance(color: Rgb) -> f64 {
    0.2126 * f64::from(color[0]) + 0.7152 * f64::from(color[1]) + 0.0722 * f64::from(color[2])
}

fn short(name: &str) -> String {
    if name.chars().count() <= LONGEST {
        return name.to_owned();
    }
    name.chars().take(LONGEST - 3).chain("...".chars()).collect()
}

/// Round values along a scale, with as few digits as tell them apart.
fn marks(scale: &Scale) -> Vec<Row> {
    let width = scale.high - scale.low;
    let rough = width / MARKS;
    let power = 10_f64.powf(rough.log10().floor());
    let step =
        [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough * 0.999).unwrap_or(10.0 * power);
    let decimals = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let is_wide = scale.low.abs().max(scale.high.abs()) >= 1e7 || step < 1e-6;
    let first = (scale.low / step - 1e-9).ceil();
    let count = ((scale.high / step + 1e-9).floor() - first).clamp(0.0, 4.0 * MARKS) as usize;
    let row = |k: usize| {
        // Zero has no sign.
        let value = (first + k as f64) * step + 0.0;
        let text = if is_wide { format!("{value:.2e}") } else { format!("{value:.decimals$}") };
        Row { text, mark: Mark::At((value - scale.low) / width) }
    };
    (0..=count).map(row).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::color::ColorMap;

    fn texts(low: f64, high: f64) -> Vec<String> {
        marks(&Scale { map: ColorMap::Viridis, low, high }).into_iter().map(|row| row.text).collect()
    }

    #[test]
    fn marks_are_round_and_within() {
        assert_eq!(texts(0.0, 10.0), ["0", "2", "4", "6", "8", "10"]);
        assert_eq!(texts(-0.031, 0.031), ["-0.02", "0.00", "0.02"]);
        assert_eq!(texts(1.03, 1.17), ["1.05", "1.10", "1.15"]);
        assert_eq!(texts(0.0, 3e-9).first().map(String::as_str), Some("0.00e0"));
    }

    #[test]
    fn marks_of_a_scale_of_one_value_are_few() {
        let scale = Scale::of(&[Some(84_810.0)], ColorMap::Viridis, crate::color::Ends::Both);
        assert!(marks(&scale).len() < 12);
    }
}
