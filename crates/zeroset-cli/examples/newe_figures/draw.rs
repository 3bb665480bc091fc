//! Panels side by side: points, flats and the corner, in the plane or in parallel projection.

use svg::Document;
use svg::node::element::path::Data;
use svg::node::element::{Circle, Group, Path, Rectangle, Text, Title};
use zeroset::feature::newe::{Flat, corner};

use crate::clip::Bounds;

/// Side of a panel, the space between two, and that above and below for words.
const SIDE: f64 = 300.0;
const GAP: f64 = 16.0;
const HEAD: f64 = 30.0;
const FOOT: f64 = 28.0;
const DARK: &str = "#1a1a1a";
const PALE: &str = "#b8b8b8";
const OUTLIER: &str = "#9a9a9a";
/// Colours of the flats, told apart by the colour-blind too.
const COLORS: [&str; 4] = ["#c0392b", "#2166ac", "#d08a00", "#1b7f5c"];
/// From where one looks at points in space.
const TOWARDS_VIEWER: [f64; 3] = [0.52, -0.68, 0.52];

/// One set of flats.
pub(crate) struct Panel<const D: usize> {
    pub(crate) title: String,
    pub(crate) note: String,
    pub(crate) flats: Vec<Flat<D>>,
    /// The flat of each point; `None` for an outlier.
    pub(crate) assignment: Vec<Option<usize>>,
}

/// From points to pixels of a panel.
struct View<const D: usize> {
    right: [f64; D],
    down: [f64; D],
    scale: f64,
    shift: [f64; 2],
}

impl<const D: usize> View<D> {
    /// Shows all of the box.
    fn of(bounds: &Bounds<D>) -> Self {
        let (mut right, mut down) = ([0.0; D], [0.0; D]);
        if D == 2 {
            (right[0], down[1]) = (1.0, -1.0);
        } else {
            let [x, y, z] = TOWARDS_VIEWER;
            let (flat, all) = (x.hypot(y), (x * x + y * y + z * z).sqrt());
            (right[0], right[1]) = (-y / flat, x / flat);
            (down[0], down[1], down[2]) = (z * x / (flat * all), z * y / (flat * all), -flat / all);
        }
        let mut view = Self { right, down, scale: 1.0, shift: [0.0; 2] };
        let corners: Vec<[f64; 2]> = (0..1 << D).map(|i| view.at(&bounds.corner(i))).collect();
        let ends =
            |a: usize| corners.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], c| [l.min(c[a]), h.max(c[a])]);
        let ends = [ends(0), ends(1)];
        view.scale = (SIDE - 12.0) / ends.iter().map(|[low, high]| high - low).fold(0.0, f64::max);
        view.shift = ends.map(|[low, high]| 0.5 * (SIDE - view.scale * (low + high)));
        view
    }

    fn at(&self, point: &[f64; D]) -> [f64; 2] {
        let along = |axis: &[f64; D]| (0..D).map(|a| axis[a] * point[a]).sum::<f64>();
        [self.scale * along(&self.right) + self.shift[0], self.scale * along(&self.down) + self.shift[1]]
    }
}

fn tenths(v: f64) -> f64 {
    (10.0 * v).round() / 10.0
}

fn text(content: &str, y: f64, size: f64, color: &str) -> Text {
    let text = Text::new(content).set("x", tenths(0.5 * SIDE)).set("y", y).set("text-anchor", "middle");
    text.set("font-size", size).set("fill", color)
}

pub(crate) fn picture<const D: usize>(title: &str, points: &[[f64; D]], panels: &[Panel<D>]) -> String {
    let bounds = Bounds::around(points, if D == 2 { 0.08 } else { 0.04 });
    let width = panels.len() as f64 * (SIDE + GAP) + GAP;
    let height = HEAD + SIDE + FOOT;
    let document = Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("width", width)
        .set("height", height)
        .set("font-family", "Helvetica, Arial, sans-serif")
        .add(Title::new(title))
        .add(Rectangle::new().set("width", "100%").set("height", "100%").set("fill", "white"));
    let document = panels.iter().enumerate().fold(document, |document, (i, one)| {
        let left = GAP + i as f64 * (SIDE + GAP);
        document.add(panel(points, one, &bounds).set("transform", format!("translate({left} {HEAD})")))
    });
    format!("{document}\n")
}

fn panel<const D: usize>(points: &[[f64; D]], panel: &Panel<D>, bounds: &Bounds<D>) -> Group {
    let view = View::of(bounds);
    let mut group = Group::new()
        .add(text(&panel.title, -10.0, 14.0, DARK))
        .add(text(&panel.note, SIDE + 18.0, 12.0, "#5a5a5a"))
        .add(frame(&view, bounds));
    for (flat, color) in panel.flats.iter().zip(COLORS.iter().cycle()) {
        group = group.add(trace(&view, bounds, flat).set("stroke", *color).set("fill", *color));
    }
    for (label, color) in (0..panel.flats.len()).map(Some).chain([None]).zip(COLORS.iter().cycle()) {
        let color = if label.is_some() { color } else { OUTLIER };
        let own = points.iter().zip(&panel.assignment).filter(|(_, a)| **a == label).map(|(p, _)| p);
        group = group.add(dots(&view, own).set("stroke", color));
    }
    let meeting = corner(&panel.flats, points[0]);
    if meeting.rank == D && bounds.holds(&meeting.position) {
        let [x, y] = view.at(&meeting.position).map(tenths);
        let ring = Circle::new().set("cx", x).set("cy", y).set("r", 6).set("fill", "none");
        group = group.add(ring.set("stroke", DARK).set("stroke-width", 1.6));
    }
    group
}

/// The flat nearest to each point.
pub(crate) fn nearest<const D: usize>(points: &[[f64; D]], flats: &[Flat<D>]) -> Vec<Option<usize>> {
    let one = |point: &[f64; D]| {
        let distance = |j: &usize| flats[*j].signed_distance(point).abs();
        (0..flats.len()).min_by(|i, j| distance(i).total_cmp(&distance(j)))
    };
    points.iter().map(one).collect()
}

/// The edges of the box.
fn frame<const D: usize>(view: &View<D>, bounds: &Bounds<D>) -> Path {
    let data = bounds.edges().iter().fold(Data::new(), |data, [p, q]| {
        let ([x1, y1], [x2, y2]) = (view.at(p).map(tenths), view.at(q).map(tenths));
        data.move_to((x1, y1)).line_to((x2, y2))
    });
    Path::new().set("d", data).set("stroke", PALE).set("stroke-width", 0.8).set("fill", "none")
}

/// A line across the box, or the polygon in which a plane cuts it.
fn trace<const D: usize>(view: &View<D>, bounds: &Bounds<D>, flat: &Flat<D>) -> Path {
    let mut outline: Vec<[f64; 2]> = bounds.crossings(flat).iter().map(|p| view.at(p)).collect();
    let count = outline.len().max(1) as f64;
    let [x, y] = [0, 1].map(|a| outline.iter().map(|p| p[a]).sum::<f64>() / count);
    // The polygon is convex, and so is its picture.
    outline.sort_by(|p, q| (p[1] - y).atan2(p[0] - x).total_cmp(&(q[1] - y).atan2(q[0] - x)));
    let data = outline.iter().enumerate().fold(Data::new(), |data, (i, p)| {
        let [x, y] = p.map(tenths);
        if i == 0 { data.move_to((x, y)) } else { data.line_to((x, y)) }
    });
    let path = Path::new().set("d", data.close()).set("stroke-linejoin", "round");
    if D == 2 { path.set("stroke-width", 1.8) } else { path.set("stroke-width", 1.2).set("fill-opacity", 0.13) }
}

/// Points as strokes of no length with round ends: a fraction of the text that circles take.
fn dots<'a, const D: usize>(view: &View<D>, points: impl Iterator<Item = &'a [f64; D]>) -> Path {
    let data = points.fold(Data::new(), |data, point| {
        let [x, y] = view.at(point).map(tenths);
        data.move_to((x, y)).horizontal_line_by(0)
    });
    let width = if D == 2 { 4.5 } else { 3.2 };
    Path::new().set("d", data).set("stroke-linecap", "round").set("stroke-width", width).set("fill", "none")
}
