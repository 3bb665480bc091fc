//! What explains the picture: axes, a scale bar, and the heights of contour lines.

use svg::node::element::{Group, Line, Rectangle, Text};

use super::super::Section;
use super::DARK;
use super::axis::round_down;
use super::canvas::Canvas;
use crate::LinearUnit;
use crate::number::trimmed;

/// Length of the marks on the axes.
const TICK: f64 = 5.0;
/// About how many heights are labelled.
const LABELS: f64 = 8.0;
/// The scale bar is at most this long, relative to the width of the frame.
const BAR_REL: f64 = 0.25;

fn text(content: impl Into<String>, [x, y]: [f64; 2], anchor: &str) -> Text {
    let number = |v: f64| format!("{v:.1}");
    Text::new(content.into()).set("x", number(x)).set("y", number(y)).set("text-anchor", anchor)
}

fn line([x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) -> Line {
    let number = |v: f64| format!("{v:.2}");
    Line::new().set("x1", number(x1)).set("y1", number(y1)).set("x2", number(x2)).set("y2", number(y2))
}

fn symbol(unit: LinearUnit) -> &'static str {
    match unit {
        LinearUnit::Metre => "m",
        LinearUnit::Foot => "ft",
        LinearUnit::UsSurveyFoot => "US survey ft",
    }
}

/// A frame with marks at round figures.
pub(super) fn axes(canvas: &Canvas) -> Group {
    let [[left, top], [right, bottom]] = canvas.frame();
    let number = |v: f64| format!("{v:.2}");
    let frame = Rectangle::new().set("x", number(left)).set("y", number(top));
    let frame = frame.set("width", number(right - left)).set("height", number(bottom - top));
    let mut lines = Group::new().set("fill", "none").set("stroke", DARK).set("stroke-width", "0.8").add(frame);
    let mut texts = Group::new().set("fill", DARK);
    for (place, label) in &canvas.axes[0].marks {
        let x = canvas.pixel([*place, 0.0])[0];
        lines = lines.add(line([x, bottom], [x, bottom + TICK]));
        texts = texts.add(text(label, [x, bottom + TICK + 13.0], "middle"));
    }
    for (place, label) in &canvas.axes[1].marks {
        let y = canvas.pixel([0.0, *place])[1];
        lines = lines.add(line([left, y], [left - TICK, y]));
        texts = texts.add(text(label, [left - TICK - 4.0, y + 4.0], "end"));
    }
    let unit = canvas.unit.map_or_else(String::new, |unit| format!(" ({})", symbol(unit)));
    let [across, upward] = [0, 1].map(|i: usize| format!("{}{unit}", canvas.axes[i].name));
    let middle = 0.5 * (top + bottom);
    let upward = text(upward, [14.0, middle], "middle").set("transform", format!("rotate(-90 14 {middle:.1})"));
    texts = texts.add(text(across, [0.5 * (left + right), bottom + TICK + 32.0], "middle")).add(upward);
    Group::new().set("id", "axes").add(lines).add(texts)
}

/// A bar of a round length.
pub(super) fn scale_bar(canvas: &Canvas) -> Group {
    let [[left, _], [right, bottom]] = canvas.frame();
    let (length, decimals) = round_down(BAR_REL * (right - left) / canvas.pixels(1.0));
    let (y, end) = (bottom + 70.0, left + canvas.pixels(length));
    let unit = canvas.unit.map_or_else(String::new, |unit| format!(" {}", symbol(unit)));
    let mut bar = Group::new().set("id", "scale").set("stroke", DARK).set("stroke-width", "1.6");
    bar = bar.add(line([left, y], [end, y]));
    for x in [left, end] {
        bar = bar.add(line([x, y - 4.0], [x, y + 4.0]));
    }
    let label = text(format!("{length:.decimals$}{unit}"), [end + 8.0, y + 4.0], "start");
    bar.add(label.set("fill", DARK).set("stroke", "none"))
}

/// The heights of contour lines that are labelled: all if they are few, else the round ones.
pub(super) fn round_heights(section: &Section) -> Vec<f64> {
    let mut heights: Vec<f64> = section.levels.iter().filter_map(|level| level.height).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup();
    let (Some(low), Some(high)) = (heights.first(), heights.last()) else { return heights };
    if heights.len() as f64 > LABELS {
        // Twice the least step, so that there are no more than wanted.
        let step = round_down(2.0 * (high - low) / LABELS).0;
        heights.retain(|height| (height / step - (height / step).round()).abs() < 1e-6);
    }
    heights
}

/// The labels of contour lines, each at the middle of the longest line of its height.
pub(super) fn heights(section: &Section, canvas: &Canvas, marked: &[f64]) -> Group {
    let mut group = Group::new().set("id", "heights").set("fill", DARK).set("font-size", "10");
    group = group.set("stroke", "white").set("stroke-width", "3").set("paint-order", "stroke");
    for level in &section.levels {
        let Some(height) = level.height.filter(|height| marked.contains(height)) else { continue };
        let Some(line) = level.lines.iter().max_by_key(|line| line.positions.len()) else { continue };
        let middle = line.positions.len() / 2;
        let [[x0, y0], [x, y], [x1, y1]] =
            [middle.saturating_sub(1), middle, (middle + 1).min(line.positions.len() - 1)]
                .map(|i| canvas.pixel(canvas.place(line.positions[i])));
        // Along the line, and never upside down.
        let angle = ((y1 - y0) / (x1 - x0)).atan().to_degrees();
        let angle = if angle.is_finite() { angle } else { 0.0 };
        let label = text(trimmed(height, 6), [x, y + 3.5], "middle");
        group = group.add(label.set("transform", format!("rotate({angle:.1} {x:.1} {y:.1})")));
    }
    group
}
