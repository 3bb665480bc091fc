//! The plot of the convergence: logarithmic axes, measurements, guides of slope 2 and 3, and a legend with the orders.

use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Circle, Group, Line, Path, Rectangle, Text, Title};

use crate::convergence::{Degree, Series, Shape};

const WIDTH: f64 = 620.0;
const HEIGHT: f64 = 500.0;
/// The frame: left, top, right and bottom.
const FRAME: [f64; 4] = [78.0, 18.0, 600.0, 440.0];
const DARK: &str = "#1a1a1a";
const GRID: &str = "#e2e2e2";
const GUIDE: &str = "#8a8a8a";

/// From h and errors to pixels.
struct Axes {
    /// Least and greatest exponents of ten.
    h: [f64; 2],
    error: [f64; 2],
}

impl Axes {
    fn around(series: &[Series]) -> Self {
        let range = |values: &dyn Fn(&crate::convergence::Measurement) -> f64| {
            let logs = series.iter().flat_map(|s| &s.measurements).map(|m| values(m).log10());
            logs.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)])
        };
        let ([h, error], margin) = ([range(&|m| m.h), range(&|m| m.error)], 0.12);
        Self { h: [h[0] - margin, h[1] + margin], error: [error[0].floor(), error[1].ceil()] }
    }

    fn x(&self, h: f64) -> f64 {
        FRAME[0] + (FRAME[2] - FRAME[0]) * (h.log10() - self.h[0]) / (self.h[1] - self.h[0])
    }

    fn y(&self, error: f64) -> f64 {
        FRAME[3] - (FRAME[3] - FRAME[1]) * (error.log10() - self.error[0]) / (self.error[1] - self.error[0])
    }

    fn path(&self, places: impl IntoIterator<Item = [f64; 2]>) -> Path {
        let mut data = Data::new();
        for (i, [h, error]) in places.into_iter().enumerate() {
            let at = (hundredths(self.x(h)), hundredths(self.y(error)));
            data = if i == 0 { data.move_to(at) } else { data.line_to(at) };
        }
        Path::new().set("d", data).set("fill", "none")
    }
}

fn hundredths(v: f64) -> f64 {
    (100.0 * v).round() / 100.0
}

pub(crate) fn draw(series: &[Series]) -> String {
    let axes = Axes::around(series);
    let mut document = Document::new()
        .set("viewBox", format!("0 0 {WIDTH} {HEIGHT}"))
        .set("width", WIDTH)
        .set("height", HEIGHT)
        .set("font-family", "Helvetica, Arial, sans-serif")
        .set("font-size", "13")
        .add(Title::new(Series::TITLE))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(grid(&axes));
    let guides = Guide::both(series);
    document = guides.iter().fold(document, |document, guide| document.add(guide.draw(&axes)));
    for one in series {
        document = document.add(curve(&axes, one));
    }
    format!("{}\n", document.add(legend(series)))
}

fn text(content: impl Into<String>, [x, y]: [f64; 2], anchor: &str) -> Text {
    Text::new(content.into()).set("x", hundredths(x)).set("y", hundredths(y)).set("text-anchor", anchor)
}

fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2], color: &str) -> Line {
    let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(hundredths);
    Line::new().set("x1", x1).set("y1", y1).set("x2", x2).set("y2", y2).set("stroke", color)
}

/// Lines at round values, the frame and what the axes show.
fn grid(axes: &Axes) -> Group {
    let [left, top, right, bottom] = FRAME;
    let mut group = Group::new().set("id", "axes").set("fill", DARK);
    for h in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0] {
        let x = axes.x(h);
        if (left..=right).contains(&x) {
            group = group.add(line([x, top], [x, bottom], GRID)).add(text(h.to_string(), [x, bottom + 18.0], "middle"));
        }
    }
    for exponent in axes.error[0] as i32..=axes.error[1] as i32 {
        let y = axes.y(10_f64.powi(exponent));
        // A superscript that every program draws.
        let power = text(exponent.to_string().replace('-', "\u{2212}"), [left - 26.0, y - 2.0], "start");
        group = group
            .add(line([left, y], [right, y], GRID))
            .add(text("10", [left - 27.0, y + 4.5], "end"))
            .add(power.set("font-size", "10"));
    }
    let frame = Rectangle::new().set("x", left).set("y", top).set("width", right - left).set("height", bottom - top);
    let side = text("largest distance from the truth", [20.0, 0.5 * (top + bottom)], "middle");
    let turn = format!("rotate(-90 20 {})", hundredths(0.5 * (top + bottom)));
    group
        .add(frame.set("fill", "none").set("stroke", DARK))
        .add(text("h, the side of a cell", [0.5 * (left + right), bottom + 42.0], "middle"))
        .add(side.set("transform", turn))
}

/// A dashed line: error = factor * h^slope.
struct Guide {
    slope: i32,
    factor: f64,
    /// The least and the greatest h.
    span: [f64; 2],
    /// Where on its way its name stands, so that it touches no curve.
    name: f64,
}

impl Guide {
    /// One below the linear functions, and one between the two shapes of the quadratic ones, which are far apart.
    fn both(series: &[Series]) -> [Self; 2] {
        /// The share of the errors at which the first one runs.
        const BELOW: f64 = 0.45;
        [(Degree::Linear, 2, 0.4), (Degree::Quadratic, 3, 0.8)].map(|(degree, slope, name)| {
            let all = || series.iter().filter(|s| s.degree == degree).flat_map(|s| &s.measurements);
            let factors = || all().map(|m| m.error / m.h.powi(slope));
            let (least, most) = factors().fold((f64::INFINITY, 0.0_f64), |(low, high), f| (low.min(f), high.max(f)));
            let factor = if degree == Degree::Linear { BELOW * least } else { (least * most).sqrt() };
            let span = all().fold([f64::INFINITY, 0.0_f64], |[low, high], m| [low.min(m.h), high.max(m.h)]);
            Self { slope, factor, span, name }
        })
    }

    fn draw(&self, axes: &Axes) -> Group {
        let Self { slope, factor, span, name } = *self;
        let at = |h: f64| [h, factor * h.powi(slope)];
        let dashes = axes.path(span.map(at)).set("stroke", GUIDE).set("stroke-width", "1.2");
        let [h, error] = at(span[0].powf(1.0 - name) * span[1].powf(name));
        let name = text(format!("slope {slope}"), [axes.x(h) + 8.0, axes.y(error) + 14.0], "start");
        Group::new().add(dashes.set("stroke-dasharray", "6 4")).add(name.set("fill", "#6a6a6a"))
    }
}

/// Colour by the degree, and whether marks are full by the shape.
fn style(one: &Series) -> (&'static str, bool) {
    (if one.degree == Degree::Linear { "#c0392b" } else { "#2166ac" }, one.shape == Shape::Circle)
}

fn mark([x, y]: [f64; 2], (color, full): (&str, bool)) -> Circle {
    let mark = Circle::new().set("cx", hundredths(x)).set("cy", hundredths(y)).set("r", "4");
    mark.set("fill", if full { color } else { "white" }).set("stroke", color).set("stroke-width", "1.6")
}

fn curve(axes: &Axes, one: &Series) -> Group {
    let style = style(one);
    let places = || one.measurements.iter().map(|m| [m.h, m.error]);
    let group = Group::new().add(axes.path(places()).set("stroke", style.0).set("stroke-width", "1.6"));
    places().fold(group, |group, [h, error]| group.add(mark([axes.x(h), axes.y(error)], style)))
}

/// Names and orders, in the lower right, where no measurement is.
fn legend(series: &[Series]) -> Group {
    const ROW: f64 = 21.0;
    const WIDTH: f64 = 212.0;
    let height = ROW * (series.len() + 1) as f64 + 10.0;
    let [left, top] = [FRAME[2] - WIDTH - 12.0, FRAME[3] - height - 12.0];
    let ground = Rectangle::new().set("x", left).set("y", top).set("width", WIDTH).set("height", height);
    let ground = ground.set("fill", "white").set("stroke", "#b0b0b0").set("stroke-width", "0.8");
    let head = text("measured order", [left + 200.0, top + ROW - 3.0], "end").set("fill", "#6a6a6a");
    let mut group = Group::new().set("id", "legend").set("fill", DARK).add(ground).add(head);
    for (i, one) in series.iter().enumerate() {
        let (y, style) = (top + ROW * (i + 2) as f64 - 3.0, style(one));
        group = group
            .add(line([left + 10.0, y - 4.5], [left + 40.0, y - 4.5], style.0).set("stroke-width", "1.6"))
            .add(mark([left + 25.0, y - 4.5], style))
            .add(text(one.name(), [left + 50.0, y], "start"))
            .add(text(format!("{:.2}", one.order()), [left + 200.0, y], "end"));
    }
    group
}
