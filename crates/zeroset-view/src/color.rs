//! Which colour stands for what.

use colorous::Gradient;

/// Red, green, blue.
pub type Rgb = [u8; 3];

/// A surface of which nothing is told.
pub const PLAIN_SURFACE: Rgb = [214, 208, 198];
/// Points of which nothing is told.
pub const PLAIN_POINTS: Rgb = [92, 110, 132];
/// Sharp edges.
pub const PLAIN_EDGE: Rgb = [24, 34, 52];
/// Corners.
pub const PLAIN_CORNER: Rgb = [206, 40, 40];
/// What has no value.
pub const NO_VALUE: Rgb = [150, 150, 150];

/// A scale of colours.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ColorMap {
    /// Dark blue to yellow, alike to all eyes.
    #[default]
    Viridis,
    /// Dark violet to white.
    Magma,
    /// Dark blue to yellow through grey, for all kinds of colour blindness.
    Cividis,
    /// Blue through green to red: many steps, not alike to all eyes.
    Turbo,
    /// Grey.
    Gray,
    /// Blue below, white at the middle, red above: for values with a sign.
    BlueRed,
}

impl ColorMap {
    fn gradient(self) -> Gradient {
        match self {
            Self::Viridis => colorous::VIRIDIS,
            Self::Magma => colorous::MAGMA,
            Self::Cividis => colorous::CIVIDIS,
            Self::Turbo => colorous::TURBO,
            Self::Gray => colorous::GREYS,
            Self::BlueRed => colorous::RED_BLUE,
        }
    }

    /// The colour at a share of the way from the low to the high end.
    #[must_use]
    pub fn at(self, share: f64) -> Rgb {
        let share = share.clamp(0.0, 1.0);
        // These run from light to dark, and from red to blue.
        let share = if matches!(self, Self::Gray | Self::BlueRed) { 1.0 - share } else { share };
        let color = self.gradient().eval_continuous(share);
        [color.r, color.g, color.b]
    }
}

/// From values to colours: the colour map from one value to another. What lies beyond gets the colour of the end.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// The colours.
    pub map: ColorMap,
    /// The value of the low end.
    pub low: f64,
    /// The value of the high end.
    pub high: f64,
}

/// How the ends of a scale are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Ends {
    /// All but one in a hundred at either end lie within.
    Both,
    /// From 0; all but one in a hundred lie within.
    FromZero,
    /// As far below 0 as above; all but one in fifty lie within.
    Symmetric,
}

impl Scale {
    /// The scale that values ask for; from 0 to 1 if there are none.
    #[must_use]
    pub fn of(values: &[Option<f64>], map: ColorMap, ends: Ends) -> Self {
        let measured = values.iter().flatten().copied().filter(|v| v.is_finite());
        let mut sorted: Vec<f64> = match ends {
            Ends::Symmetric => measured.map(f64::abs).collect(),
            Ends::Both | Ends::FromZero => measured.collect(),
        };
        if sorted.is_empty() {
            return Self { map, low: 0.0, high: 1.0 };
        }
        let mut at = |share: f64| {
            let place = (share * (sorted.len() - 1) as f64).round() as usize;
            *sorted.select_nth_unstable_by(place, f64::total_cmp).1
        };
        let [low, high] = match ends {
            Ends::Both => [at(0.01), at(0.99)],
            Ends::FromZero => [0.0, at(0.99)],
            Ends::Symmetric => {
                let most = at(0.98);
                [-most, most]
            }
        };
        // A scale needs some width.
        let high = if high > low { high } else { low + if low == 0.0 { 1.0 } else { low.abs() * 1e-6 } };
        Self { map, low, high }
    }

    /// The colour of a value.
    #[must_use]
    pub fn color(&self, value: Option<f64>) -> Rgb {
        value.map_or(NO_VALUE, |v| self.map.at((v - self.low) / (self.high - self.low)))
    }
}

/// What the colours of a picture stand for.
#[derive(Debug, Clone, PartialEq)]
pub enum Legend {
    /// Values.
    Bar {
        /// What they are, with their unit.
        title: String,
        /// Their colours.
        scale: Scale,
    },
    /// Names.
    Names {
        /// What they are.
        title: String,
        /// Each with its colour.
        entries: Vec<(Rgb, String)>,
    },
}

/// The colour of an ASPRS class, near to what surveyors use: brown ground, green vegetation, red buildings, blue water.
#[must_use]
pub fn class_color(class: u8) -> Rgb {
    match class {
        0 | 1 => [170, 170, 170],
        2 => [166, 118, 68],
        3 => [178, 214, 110],
        4 => [110, 180, 70],
        5 => [40, 130, 50],
        6 => [216, 78, 58],
        7 | 18 => [255, 0, 200],
        9 => [60, 120, 216],
        10 => [110, 90, 130],
        11 => [120, 124, 130],
        17 => [236, 176, 60],
        other => plane_color(usize::from(other)),
    }
}

/// A colour for each plane. Neighbours in number are far apart in hue.
#[must_use]
pub fn plane_color(plane: usize) -> Rgb {
    // Steps by the golden ratio never come near to one another; three shades tell those apart that do.
    let hue = (plane as f64 * 0.618_033_988_749_895 + 0.58).fract();
    let (saturation, value) = [(0.52, 0.92), (0.7, 0.78), (0.36, 0.98)][plane % 3];
    let channel = |shift: f64| {
        let k = (shift + 6.0 * hue) % 6.0;
        let share = k.min(4.0 - k).clamp(0.0, 1.0);
        (255.0 * value * (1.0 - saturation * share)).round() as u8
    };
    [channel(5.0), channel(3.0), channel(1.0)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_scale_leaves_strays_out_and_marks_what_has_no_value() {
        let mut values: Vec<Option<f64>> = (0..=1000).map(|i| Some(f64::from(i))).collect();
        values.extend([Some(1e9), None]);
        let scale = Scale::of(&values, ColorMap::Viridis, Ends::Both);
        assert!((scale.low - 10.0).abs() <= 1.0 && (scale.high - 991.0).abs() <= 1.0, "{scale:?}");
        assert_eq!(scale.color(None), NO_VALUE);
        assert_eq!(scale.color(Some(1e9)), ColorMap::Viridis.at(1.0));
    }

    #[test]
    fn a_scale_with_a_sign_is_white_at_zero_blue_below_and_red_above() {
        let values: Vec<Option<f64>> = (-50..=20).map(|i| Some(f64::from(i))).collect();
        let scale = Scale::of(&values, ColorMap::BlueRed, Ends::Symmetric);
        assert_eq!(scale.low, -scale.high);
        let [low, middle, high] = [-50.0, 0.0, 50.0].map(|v| scale.color(Some(v)));
        assert!(low[2] > low[0] && high[0] > high[2] && middle.iter().all(|c| *c > 230), "{low:?} {middle:?} {high:?}");
    }

    #[test]
    fn one_value_alone_has_a_scale() {
        for value in [0.0, -3.0, 1e7] {
            let scale = Scale::of(&[Some(value)], ColorMap::Gray, Ends::Both);
            assert!(scale.high > scale.low, "{scale:?}");
        }
    }

    #[test]
    fn the_first_planes_can_be_told_apart() {
        for i in 0..12 {
            for j in 0..i {
                let difference: i32 =
                    (0..3).map(|c| (i32::from(plane_color(i)[c]) - i32::from(plane_color(j)[c])).abs()).sum();
                assert!(difference > 30, "{i} {:?} and {j} {:?}", plane_color(i), plane_color(j));
            }
        }
    }
}
