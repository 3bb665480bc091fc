//! Round figures along an axis of the picture.

/// A direction of the world is along an axis if the cosine between them is this near to 1.
const ALONG: f64 = 1e-12;

/// An axis of the picture. Places on it are distances from the plane's point; its figures are what the reader sees.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Axis {
    /// What the figures are.
    pub(super) name: &'static str,
    /// The figure at the plane's point.
    base: f64,
    /// 1, or -1 if figures fall along the axis.
    sign: f64,
    /// Both ends of what is shown.
    pub(super) range: [f64; 2],
    /// Round figures: their places, and their texts.
    pub(super) marks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis along a direction; `point` is the plane's point in the world.
    pub(super) fn new(direction: [f64; 3], point: [f64; 3], range: [f64; 2]) -> Self {
        let along = (0..3).find(|a| direction[*a].abs() >= 1.0 - ALONG);
        let (name, base, sign) = match along {
            Some(a) => (["x", "y", "height"][a], point[a], direction[a].signum()),
            None => (if direction[2] == 0.0 { "distance" } else { "distance up the plane" }, 0.0, 1.0),
        };
        Self { name, base, sign, range, marks: Vec::new() }
    }

    /// Sets about so many marks.
    pub(super) fn with_marks(mut self, about: f64) -> Self {
        let [a, b] = self.range.map(|place| self.figure(place));
        let place = |figure: f64| self.sign * (figure - self.base);
        self.marks = marks(a.min(b), a.max(b), about).into_iter().map(|(figure, text)| (place(figure), text)).collect();
        self
    }

    /// The figure at a place.
    pub(super) fn figure(&self, place: f64) -> f64 {
        self.base + self.sign * place
    }

    pub(super) fn length(&self) -> f64 {
        self.range[1] - self.range[0]
    }
}

/// The number of 1, 2 or 5 times a power of ten that is no more than a value, and its decimals.
pub(super) fn round_down(most: f64) -> (f64, usize) {
    let mut power = most.log10().floor();
    // The logarithm may be off by one unit in its last place at a power of ten.
    if 10_f64.powf(power + 1.0) <= most {
        power += 1.0;
    }
    let unit = 10_f64.powf(power);
    let factor = [5.0, 2.0].into_iter().find(|factor| factor * unit <= most * (1.0 + 1e-9)).unwrap_or(1.0);
    (factor * unit, (-power).clamp(0.0, 12.0) as usize)
}

/// About so many round figures in a range, with their texts.
fn marks(low: f64, high: f64, about: f64) -> Vec<(f64, String)> {
    // Among round steps the next is at most 2.5 times as long, so there are between one and 2.5 times as many.
    let (step, decimals) = round_down((high - low) / about);
    let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
    let count = if last >= first { (last - first).min(60.0) as usize + 1 } else { 0 };
    let figures = (0..count).map(|i| (first + i as f64) * step);
    // Adding zero makes a plain zero of a negative one.
    figures.map(|figure| (figure, format!("{:.decimals$}", figure + 0.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(axis: Axis) -> Vec<String> {
        axis.marks.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn figures_are_round() {
        for (most, step, decimals) in [(1.0, 1.0, 0), (0.99, 0.5, 1), (4.9, 2.0, 0), (25.0, 20.0, 0), (0.1, 0.1, 1)] {
            assert_eq!(round_down(most), (step, decimals), "{most}");
        }
        let texts = |low, high| marks(low, high, 4.0).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(84_810.0, 84_850.0), ["84810", "84820", "84830", "84840", "84850"]);
        assert_eq!(texts(-0.3, 0.3), ["-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"]);
    }

    #[test]
    fn an_axis_of_the_world_has_its_coordinates() {
        let axis = |direction| Axis::new(direction, [100.0, 200.0, 3.0], [0.0, 4.0]).with_marks(2.0);
        assert_eq!(texts(axis([1.0, 0.0, 0.0])), ["100", "102", "104"]);
        let west = axis([-1.0, 0.0, 0.0]);
        assert_eq!((west.name, &west.marks[0]), ("x", &(4.0, "96".to_string())));
        assert_eq!(texts(axis([0.0, 0.0, 1.0])), ["4", "6"]);
        let aslant = axis([0.6, 0.8, 0.0]);
        assert_eq!((aslant.name, texts(aslant.clone())), ("distance", vec!["0".into(), "2".into(), "4".into()]));
        assert_eq!(axis([0.0, 0.6, 0.8]).name, "distance up the plane");
    }
}
