//! Features as DXF, release 12, in text.
//!
//! A drawing is a list of pairs, a code on one line and its value on the next. The few kinds of entity that features need
//! are written here rather than by a library: those stamp the time and a random mark into each file, and equal features
//! are to give equal bytes.

use std::fmt::{Display, Write};

use zeroset::feature::FeatureKind;

use super::FeatureOutput;
use crate::mesh::world;

/// Layers with their colours: numbers of the palette that all programs share.
const LAYERS: [(&str, u8); 6] = [
    ("PLANES", 8),
    ("EDGES_CONVEX", 1),
    ("EDGES_CONCAVE", 5),
    ("EDGES_MIXED", 6),
    ("EDGES_UNKNOWN", 3),
    ("CORNERS", 2),
];

/// The content of a file.
pub(super) fn text(output: FeatureOutput<'_>) -> String {
    let features = output.features;
    let at = |p: &[f64; 3]| world(*p, features.world_from_local);
    let mut file = Pairs(String::new());
    for comment in output.options.comment_lines(features.crs.as_deref()) {
        file.add(999, ascii(&comment));
    }
    let rings = || features.planes.iter().flat_map(|plane| &plane.rings);
    let all = rings().flatten().chain(features.edges.iter().flat_map(|edge| &edge.polyline));
    let all = all.chain(features.corners.iter().map(|corner| &corner.position)).map(at);
    file.head(all);
    file.section("ENTITIES");
    for ring in rings() {
        file.polyline("PLANES", Closing::Closed, ring.iter().map(at));
    }
    for edge in &features.edges {
        let layer = match edge.kind {
            FeatureKind::Convex => "EDGES_CONVEX",
            FeatureKind::Concave => "EDGES_CONCAVE",
            FeatureKind::Mixed => "EDGES_MIXED",
            FeatureKind::Unknown => "EDGES_UNKNOWN",
        };
        match &edge.polyline[..] {
            [from, to] => {
                file.entity("LINE", layer);
                file.position(0, at(from));
                file.position(1, at(to));
            }
            [first, between @ .., last] if first == last => {
                file.polyline(layer, Closing::Closed, std::iter::once(first).chain(between).map(at));
            }
            line => file.polyline(layer, Closing::Open, line.iter().map(at)),
        }
    }
    for corner in &features.corners {
        file.entity("POINT", "CORNERS");
        file.position(0, at(&corner.position));
    }
    file.add(0, "ENDSEC");
    file.add(0, "EOF");
    file.0
}

/// Release 12 knows no other letters for sure.
fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).take(250).collect()
}

/// Whether the last position is joined to the first.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Closing {
    Open,
    Closed,
}

/// Codes and their values.
struct Pairs(String);

impl Pairs {
    fn add(&mut self, code: u16, value: impl Display) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.0, "{code:>3}\n{value}");
    }

    /// A coordinate in the fewest digits that give back the same number, with a point, by which readers tell it from a
    /// whole number.
    fn number(&mut self, code: u16, value: f64) {
        self.add(code, format_args!("{value:?}"));
    }

    /// The `i`-th position of an entity.
    fn position(&mut self, i: u16, position: [f64; 3]) {
        for (axis, coordinate) in (1..).zip(position) {
            self.number(10 * axis + i, coordinate);
        }
    }

    fn section(&mut self, name: &str) {
        self.add(0, "SECTION");
        self.add(2, name);
    }

    fn entity(&mut self, kind: &str, layer: &str) {
        self.add(0, kind);
        self.add(8, layer);
    }

    /// The release, the box around all positions, and the layers.
    fn head(&mut self, positions: impl Iterator<Item = [f64; 3]>) {
        let empty = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        let [low, high] = positions.fold(empty, |[low, high], p| {
            [std::array::from_fn(|a| low[a].min(p[a])), std::array::from_fn(|a| high[a].max(p[a]))]
        });
        self.section("HEADER");
        self.add(9, "$ACADVER");
        self.add(1, "AC1009");
        if low[0] <= high[0] {
            for (name, corner) in [("$EXTMIN", low), ("$EXTMAX", high)] {
                self.add(9, name);
                self.position(0, corner);
            }
        }
        self.add(0, "ENDSEC");
        self.section("TABLES");
        self.add(0, "TABLE");
        self.add(2, "LAYER");
        self.add(70, LAYERS.len());
        for (name, color) in LAYERS {
            self.add(0, "LAYER");
            self.add(2, name);
            self.add(70, 0);
            self.add(62, color);
            self.add(6, "CONTINUOUS");
        }
        self.add(0, "ENDTAB");
        self.add(0, "ENDSEC");
    }

    fn polyline(&mut self, layer: &str, closing: Closing, positions: impl Iterator<Item = [f64; 3]>) {
        // 8 marks a polyline in space, 32 its vertices.
        self.entity("POLYLINE", layer);
        self.add(66, 1);
        self.position(0, [0.0; 3]);
        self.add(70, if closing == Closing::Closed { 9 } else { 8 });
        for position in positions {
            self.entity("VERTEX", layer);
            self.position(0, position);
            self.add(70, 32);
        }
        self.entity("SEQEND", layer);
    }
}
