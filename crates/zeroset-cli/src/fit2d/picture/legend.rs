//! What explains the picture: axes, the colour bar, the legend and the caption.

use svg::node::element::{Group, Line, Rectangle, Text};
use zeroset_io::PlanarData;

use super::bands::Bands;
use super::canvas::{Canvas, LETTER, TICK};
use super::{CONTOUR, DARK, DATA, LINES, RIM};

fn text(content: impl Into<String>, x: f64, y: f64, anchor: &str) -> Text {
    let number = |v: f64| format!("{v:.1}");
    Text::new(content.into()).set("x", number(x)).set("y", number(y)).set("text-anchor", anchor)
}

fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> Line {
    let number = |v: f64| format!("{v:.2}");
    Line::new().set("x1", number(x1)).set("y1", number(y1)).set("x2", number(x2)).set("y2", number(y2))
}

/// A frame around the domain with marks at round coordinates.
pub(super) fn axes(canvas: &Canvas) -> Group {
    let [[left, bottom], [right, top]] = canvas.corners();
    let frame = Rectangle::new().set("x", left).set("y", top).set("width", right - left).set("height", bottom - top);
    let mut lines = Group::new().set("fill", "none").set("stroke", DARK).set("stroke-width", "0.8").add(frame);
    let mut texts = Group::new().set("fill", DARK);
    for (mark, label) in &canvas.ticks[0] {
        let x = canvas.place([*mark, 0.0])[0];
        lines = lines.add(line([x, bottom], [x, bottom + TICK]));
        texts = texts.add(text(label, x, bottom + TICK + 13.0, "middle"));
    }
    for (mark, label) in &canvas.ticks[1] {
        let y = canvas.place([0.0, *mark])[1];
        lines = lines.add(line([left, y], [left - TICK, y]));
        texts = texts.add(text(label, left - TICK - 4.0, y + 4.0, "end"));
    }
    Group::new().set("id", "axes").add(lines).add(texts)
}

/// The colours of F beside the domain.
pub(super) fn bar(bands: &Bands, canvas: &Canvas) -> Group {
    /// Width of the bar, and its distance from the domain.
    const WIDTH: f64 = 16.0;
    const GAP: f64 = 20.0;
    /// Labels are no nearer to one another.
    const LABEL: f64 = 24.0;
    let [[_, bottom], [right, top]] = canvas.corners();
    let count = f64::from(bands.end() - bands.first);
    let height = (bottom - top).min(320.0);
    let foot = 0.5 * (bottom + top + height);
    let (x, each) = (right + GAP, height / count);
    let every = ((LABEL / each).ceil() as i32).max(1);
    let mut group = Group::new().set("id", "bar").set("fill", DARK);
    for index in bands.first..bands.end() {
        let y = foot - each * f64::from(index + 1 - bands.first);
        // A little taller than the band, so that no seam shows.
        let overlap = if index == bands.first { 0.0 } else { 0.5 };
        let rectangle = Rectangle::new().set("x", format!("{x:.2}")).set("y", format!("{y:.2}")).set("width", WIDTH);
        group = group.add(rectangle.set("height", format!("{:.2}", each + overlap)).set("fill", bands.color(index)));
    }
    let frame = Rectangle::new().set("x", format!("{x:.2}")).set("y", format!("{:.2}", foot - height));
    let frame = frame.set("width", WIDTH).set("height", format!("{height:.2}"));
    group = group.add(frame.set("fill", "none").set("stroke", DARK).set("stroke-width", "0.6"));
    for index in (bands.first..=bands.end()).filter(|index| index % every == 0) {
        let y = foot - each * f64::from(index - bands.first);
        let value = f64::from(index) * bands.step;
        let decimals = bands.decimals;
        // Exponents where plain figures would be long.
        let small = bands.step < 1e-6 || bands.step >= 1e6;
        let label = if small { format!("{value:.1e}") } else { format!("{value:.decimals$}") };
        group = group.add(line([x + WIDTH, y], [x + WIDTH + 4.0, y]).set("stroke", DARK).set("stroke-width", "0.8"));
        group = group.add(text(label, x + WIDTH + 8.0, y + 4.0, "start"));
    }
    group.add(text("F", x + 0.5 * WIDTH, foot + 16.0, "middle").set("font-style", "italic"))
}

/// The legend below the domain, and the caption below that.
pub(super) fn captions(input: &PlanarData, canvas: &Canvas, captions: [String; 2], has_unknown: bool) -> Group {
    let [[left, bottom], _] = canvas.corners();
    let [figures, method] = captions;
    let y = bottom + 46.0;
    let mut group = Group::new().set("id", "caption").set("fill", DARK);
    let mut x = left;
    let mut entry = |group: Group, label: &str, swatch: &dyn Fn(f64) -> Group| {
        let added = group.add(swatch(x)).add(text(label, x + 28.0, y, "start"));
        x += 28.0 + LETTER * label.len() as f64 + 18.0;
        added
    };
    let stroke = |x: f64, color: &str, width: f64| {
        line([x + 2.0, y - 4.0], [x + 20.0, y - 4.0]).set("stroke", color).set("stroke-width", width)
    };
    group = entry(group, "F = 0", &|x| Group::new().add(stroke(x, DARK, CONTOUR)));
    if !input.points.is_empty() {
        let dot = |x: f64, width: f64, color: &str| {
            line([x + 11.0, y - 4.0], [x + 11.0, y - 4.0])
                .set("stroke", color)
                .set("stroke-width", width)
                .set("stroke-linecap", "round")
        };
        group = entry(group, "points", &|x| Group::new().add(dot(x, 8.0, DARK)).add(dot(x, 5.6, DATA)));
    }
    if input.points.len() < input.len() {
        group = entry(group, "lines", &|x| {
            Group::new().add(stroke(x, DARK, LINES + 2.0 * RIM)).add(stroke(x, DATA, LINES))
        });
    }
    if has_unknown {
        group = entry(group, "F not known", &|x| {
            let swatch = Rectangle::new().set("x", format!("{:.1}", x + 2.0)).set("y", format!("{:.1}", y - 10.0));
            let swatch = swatch.set("width", "18").set("height", "12").set("fill", "url(#hatch)");
            Group::new().add(swatch.set("stroke", DARK).set("stroke-width", "0.6"))
        });
    }
    group
        .add(text(figures, left, y + 22.0, "start").set("id", "figures"))
        .add(text(method, left, y + 40.0, "start").set("fill", "#555555"))
}
