//! Sections as pictures.
//!
//! Curves are in the unit of the data, from a round place near the corner of the picture, and a transform takes them to
//! pixels. So their figures have few digits, and a program that opens the picture can take lengths from it.

mod axis;
mod canvas;
mod legend;

use svg::Document;
use svg::node::element::{Description, Group, Path, Rectangle, Title};

use self::canvas::Canvas;
use super::{Section, SectionLevel, SectionLine};
use crate::WriteOptions;
use crate::number::{push_trimmed, trimmed};

/// Colour of curves and texts.
const DARK: &str = "#1a1a1a";
/// Colour of solid.
const SOLID: &str = "#e3d5ba";
/// Width of the curves of cross-sections, of contour lines of round heights, and of other contour lines, in pixels.
const CUT: f64 = 1.4;
const ROUND: f64 = 1.3;
const OTHER: f64 = 0.6;

/// The content of a file, with a line end.
pub(super) fn text(section: &Section, options: &WriteOptions) -> String {
    let canvas = Canvas::new(section, options.unit);
    let marked = legend::round_heights(section);
    let contours = section.levels.iter().any(|level| level.height.is_some());
    let mut curves = Group::new().set("id", "curves").set("transform", canvas.transform());
    curves = curves.set("fill", "none").set("stroke", DARK).set("stroke-linejoin", "round");
    curves = curves.add(Description::new().add(svg::node::Text::new(canvas.zero())));
    for (number, level) in (1..).zip(&section.levels) {
        curves = curves.add(draw(number, level, &canvas, &marked));
    }
    let (width, height) = canvas.size();
    let notes = options.comment_lines(section.crs.as_deref()).join("\n");
    let document = Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("width", width)
        .set("height", height)
        .set("font-family", "Helvetica, Arial, sans-serif")
        .set("font-size", "12")
        .add(Title::new(if contours { "Contour lines" } else { "Cross-section" }))
        .add(Description::new().add(svg::node::Text::new(notes)))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(curves)
        .add(legend::heights(section, &canvas, &marked))
        .add(legend::axes(&canvas))
        .add(legend::scale_bar(&canvas));
    format!("{document}\n")
}

/// The curves of a level: the closed ones as one path, so that holes stay open, then the others.
fn draw(number: usize, level: &SectionLevel, canvas: &Canvas, marked: &[f64]) -> Group {
    let (closed, open): (Vec<&SectionLine>, Vec<&SectionLine>) = level.lines.iter().partition(|line| line.closed);
    let width = match level.height {
        None => CUT,
        Some(height) if marked.contains(&height) => ROUND,
        Some(_) => OTHER,
    };
    let name = level.height.map_or_else(|| format!("section {number}"), |height| trimmed(height, 6));
    let mut group = Group::new().set("stroke-width", canvas.length(width)).add(Title::new(name));
    for (lines, solid) in [(closed, level.height.is_none()), (open, false)] {
        if lines.is_empty() {
            continue;
        }
        let mut path = Path::new().set("d", commands(&lines, canvas));
        if solid {
            path = path.set("fill", SOLID).set("fill-rule", "evenodd");
        }
        group = group.add(path);
    }
    group
}

/// The commands of lines through positions in the plane.
fn commands(lines: &[&SectionLine], canvas: &Canvas) -> String {
    let mut out = Vec::new();
    for line in lines {
        for (i, position) in line.positions.iter().enumerate() {
            out.push(if i == 0 { b'M' } else { b'L' });
            let [right, up] = canvas.beyond_zero(*position);
            push_trimmed(&mut out, right, canvas.decimals);
            out.push(b' ');
            push_trimmed(&mut out, up, canvas.decimals);
        }
        if line.closed {
            out.push(b'Z');
        }
    }
    String::from_utf8_lossy(&out).into_owned()
}
