//! Drawings as DXF, release 12, in text.
//!
//! A drawing is a list of pairs, a code on one line and its value on the next. The few kinds of entity that are needed are
//! written here rather than by a library: those stamp the time and a random mark into each file, and equal data are to
//! give equal bytes.

use std::fmt::{Display, Write};

/// Whether the last position is joined to the first.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Closing {
    Open,
    Closed,
}

/// A drawing while it is written. The name of a layer has at most 31 capitals, digits, `$`, `-` and `_`: release 12 knows
/// no others.
pub(crate) struct Drawing(String);

impl Drawing {
    /// Starts with comments, the box around all positions, and the layers with their colours: numbers of the palette
    /// that all programs share.
    pub(crate) fn new<N: AsRef<str>>(
        comments: &[String],
        positions: impl Iterator<Item = [f64; 3]>,
        layers: &[(N, u8)],
    ) -> Self {
        let mut drawing = Self(String::new());
        for comment in comments {
            drawing.add(999, ascii(comment));
        }
        drawing.header(positions);
        drawing.layers(layers);
        drawing.section("ENTITIES");
        drawing
    }

    pub(crate) fn point(&mut self, layer: &str, position: [f64; 3]) {
        self.entity("POINT", layer);
        self.position(0, position);
    }

    pub(crate) fn line(&mut self, layer: &str, [from, to]: [[f64; 3]; 2]) {
        self.entity("LINE", layer);
        self.position(0, from);
        self.position(1, to);
    }

    pub(crate) fn polyline(&mut self, layer: &str, closing: Closing, positions: impl Iterator<Item = [f64; 3]>) {
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

    /// The content of the file.
    pub(crate) fn finish(mut self) -> String {
        self.add(0, "ENDSEC");
        self.add(0, "EOF");
        self.0
    }

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

    fn header(&mut self, positions: impl Iterator<Item = [f64; 3]>) {
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
    }

    fn layers<N: AsRef<str>>(&mut self, layers: &[(N, u8)]) {
        self.section("TABLES");
        self.add(0, "TABLE");
        self.add(2, "LAYER");
        self.add(70, layers.len());
        for (name, color) in layers {
            self.add(0, "LAYER");
            self.add(2, name.as_ref());
            self.add(70, 0);
            self.add(62, color);
            self.add(6, "CONTINUOUS");
        }
        self.add(0, "ENDTAB");
        self.add(0, "ENDSEC");
    }
}

/// Release 12 knows no other letters for sure.
fn ascii(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_graphic() || c == ' ' { c } else { '?' }).take(250).collect()
}
