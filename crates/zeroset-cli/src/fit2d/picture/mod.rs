//! The picture: shades of F and cells, the data over them, the zero set on top, axes, a colour bar and a caption.
//!
//! Positions are taken to pixels at once and kept as whole hundredths of them. So any scale and offset of the input draws equally well,
//! outlines of shades close exactly, and equal input gives equal text.

mod bands;
mod canvas;
mod cells;
mod color;
mod legend;
mod outline;

use svg::Document;
use svg::node::element::{ClipPath, Definitions, Group, Path, Pattern, Rectangle, Title};
use zeroset::basis::Expansion;
use zeroset::domain::SimplicialMesh;

use super::{Done, measure, report};
use crate::args::Fit2dArgs;
use bands::Bands;
use canvas::{Canvas, Pixel, place};
use outline::Outline;

/// Colour of the zero set and of the rims of data.
const DARK: &str = "#1a1a1a";
/// Colour of data.
const DATA: &str = "#ffc20e";
/// Width of segments and sides, without their rims: on both sides of the zero set, which lies on them, they can be seen.
const LINES: f64 = 5.4;
/// Width of the rims of segments and sides.
const RIM: f64 = 0.6;
/// Width of the zero set.
const CONTOUR: f64 = 2.2;
/// Colour of the edges of cells.
const EDGES: &str = "#555555";
/// Colour of strokes over parts where F is not known.
const HATCH: &str = "#9a9a9a";

/// The picture as text.
pub(super) fn draw(args: &Fit2dArgs, done: &Done<'_>) -> String {
    let captions = [report::figures(done), report::method(args, done)];
    let longest = captions.iter().map(|text| text.chars().count()).max().unwrap_or(0);
    let canvas = Canvas::new(done.plan.extent, args.size, longest);
    let f = done.fitted.function(done.plan.basis.as_ref());
    let bands = (!args.no_shading).then(|| Bands::new(&f, &canvas)).flatten();
    let unknown = unknown(&f, &canvas);
    let clipped = || Group::new().set("clip-path", "url(#domain)").set("stroke-linejoin", "round");
    let mut inside = clipped();
    if let Some(bands) = &bands {
        inside = inside.add(bands.draw());
    }
    if !unknown.is_empty() {
        inside = inside.add(path(&unknown).set("id", "unknown").set("fill", "url(#hatch)"));
    }
    if !args.no_cells {
        inside = inside.add(cells::draw(f.domain(), &canvas));
    }
    let contour = path(&contour(done, &canvas)).set("id", "contour").set("fill", "none");
    let contour = contour.set("stroke", DARK).set("stroke-width", CONTOUR);
    let (width, height) = canvas.size();
    let [low, high] = canvas.corners();
    let [x, y, right, bottom] = [low[0], high[1], high[0], low[1]];
    let clip = Rectangle::new().set("x", x).set("y", y).set("width", right - x).set("height", bottom - y);
    let definitions = Definitions::new().add(ClipPath::new().set("id", "domain").add(clip)).add(hatch());
    let document = Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("width", width)
        .set("height", height)
        .set("font-family", "Helvetica, Arial, sans-serif")
        .set("font-size", "12")
        .add(Title::new("The zero set of a normalised implicit fit"))
        .add(definitions)
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"))
        .add(inside)
        .add(legend::axes(&canvas))
        .add(data(done, &canvas))
        // Many data would hide it.
        .add(clipped().add(contour))
        .add(legend::captions(done.input, &canvas, captions, !unknown.is_empty()));
    let document = match &bands {
        Some(bands) => document.add(legend::bar(bands, &canvas)),
        None => document,
    };
    format!("{document}\n")
}

fn path(commands: &str) -> Path {
    Path::new().set("d", commands)
}

/// Strokes over parts where F is not known.
fn hatch() -> Pattern {
    let stroke = path("M0 6L6 0").set("stroke", HATCH).set("stroke-width", "0.8");
    let ground = Rectangle::new().set("width", "6").set("height", "6").set("fill", "white");
    let pattern = Pattern::new().set("id", "hatch").set("width", "6").set("height", "6");
    pattern.set("patternUnits", "userSpaceOnUse").add(ground).add(stroke)
}

/// The outline of the triangles on which F is not known.
fn unknown(f: &Expansion<'_, 2>, canvas: &Canvas) -> String {
    let mut outline = Outline::default();
    let domain = f.domain();
    for simplex in (0..domain.len()).filter(|&s| !f.is_defined(s)) {
        outline.add(&corners(domain, simplex).map(|p| canvas.pixel(p)));
    }
    outline.commands()
}

fn corners(domain: &SimplicialMesh<2>, simplex: usize) -> [[f64; 2]; 3] {
    std::array::from_fn(|c| domain.vertices()[domain.simplex(simplex)[c] as usize])
}

fn contour(done: &Done<'_>, canvas: &Canvas) -> String {
    let line = |line: &zeroset::contour::Polyline| {
        let mut pixels: Vec<Pixel> = line.points.iter().map(|&p| canvas.pixel(p)).collect();
        pixels.dedup();
        polyline(&pixels, line.closed)
    };
    done.contour.iter().map(line).collect()
}

/// The commands of a line through pixels.
fn polyline(pixels: &[Pixel], closed: bool) -> String {
    let mut commands = String::new();
    for (i, &pixel) in pixels.iter().enumerate() {
        commands += if i == 0 { "M" } else { "L" };
        commands += &place(pixel);
    }
    commands + if closed { "Z" } else { "" }
}

/// Points, segments and polygons, each with a dark rim.
fn data(done: &Done<'_>, canvas: &Canvas) -> Group {
    let input = done.input;
    let lines: String = measure::lines(input).map(|ends| polyline(&ends.map(|p| canvas.pixel(p)), false)).collect();
    let mut pixels: Vec<Pixel> = input.points.iter().map(|p| canvas.pixel(p.position)).collect();
    pixels.sort_unstable();
    pixels.dedup();
    // A line without length and with round ends is a dot, in a fraction of a circle's text.
    let dots: String = pixels.iter().map(|&p| format!("M{}h0", place(p))).collect();
    let dot = dot_width(pixels.len());
    let mut group = Group::new().set("id", "data").set("fill", "none").set("stroke-linecap", "round");
    for (id, commands, width, rim) in
        [("lines", &lines, LINES, RIM), ("points", &dots, dot, (0.2 * dot).clamp(0.4, 1.2))]
    {
        if commands.is_empty() {
            continue;
        }
        let dark = path(commands).set("stroke", DARK).set("stroke-width", format!("{:.2}", width + 2.0 * rim));
        let light = path(commands).set("stroke", DATA).set("stroke-width", format!("{width:.2}")).set("id", id);
        group = group.add(dark).add(light);
    }
    group
}

/// The more dots, the smaller.
fn dot_width(count: usize) -> f64 {
    (6.0 * (100.0 / count.max(1) as f64).powf(0.3)).clamp(1.0, 6.0)
}
