//! Features as Wavefront OBJ: faces, lines and points in named groups.

use std::io::Write;

use zeroset::feature::{FeatureKind, Features, Plane, triangulate};

use super::FeatureOutput;
use crate::mesh::{tolerance, world};
use crate::number::{decimals_for, push_fixed};

/// The content of a file.
pub(super) fn text(output: FeatureOutput<'_>) -> Vec<u8> {
    let features = output.features;
    let mut file = File { features, decimals: decimals(output), text: Vec::new(), vertices: 0 };
    for comment in output.options.comment_lines(features.crs.as_deref()) {
        file.line(&format!("# {comment}"));
    }
    for (id, plane) in features.planes.iter().enumerate() {
        file.line(&format!("g plane_{id}"));
        let first = file.positions(plane.rings.iter().flatten());
        if is_convex(plane) {
            file.element('f', first, 0..plane.rings[0].len());
        } else {
            for triangle in triangulate(plane) {
                file.element('f', first, triangle);
            }
        }
    }
    for (kind, name) in [
        (FeatureKind::Convex, "convex"),
        (FeatureKind::Concave, "concave"),
        (FeatureKind::Mixed, "mixed"),
        (FeatureKind::Unknown, "unknown"),
    ] {
        let mut edges = features.edges.iter().filter(|edge| edge.kind == kind).peekable();
        if edges.peek().is_some() {
            file.line(&format!("g edges_{name}"));
        }
        for edge in edges {
            let first = file.positions(&edge.polyline);
            file.element('l', first, 0..edge.polyline.len());
        }
    }
    if !features.corners.is_empty() {
        file.line("g corners");
    }
    for corner in &features.corners {
        let first = file.positions([&corner.position]);
        file.element('p', first, [0]);
    }
    file.text
}

/// How many digits coordinates get.
fn decimals(output: FeatureOutput<'_>) -> u32 {
    let features = output.features;
    let rings = features.planes.iter().flat_map(|plane| plane.rings.iter().flatten());
    let polylines = features.edges.iter().flat_map(|edge| &edge.polyline);
    decimals_for(tolerance(output.options, &rings.chain(polylines).copied().collect::<Vec<_>>()))
}

struct File<'a> {
    features: &'a Features,
    decimals: u32,
    text: Vec<u8>,
    vertices: usize,
}

impl File<'_> {
    fn line(&mut self, line: &str) {
        self.text.extend_from_slice(line.as_bytes());
        self.text.push(b'\n');
    }

    /// Writes vertices; returns the number of the first, which counts from 1.
    fn positions<'b>(&mut self, positions: impl IntoIterator<Item = &'b [f64; 3]>) -> usize {
        let first = self.vertices + 1;
        for position in positions {
            self.text.push(b'v');
            for coordinate in world(*position, self.features.world_from_local) {
                self.text.push(b' ');
                push_fixed(&mut self.text, coordinate, self.decimals);
            }
            self.text.push(b'\n');
            self.vertices += 1;
        }
        first
    }

    /// Writes a face, line or point over vertices that count from `first`.
    fn element(&mut self, word: char, first: usize, vertices: impl IntoIterator<Item = usize>) {
        self.text.push(word as u8);
        for vertex in vertices {
            // Writing to a Vec cannot fail.
            let _ = write!(self.text, " {}", first + vertex);
        }
        self.text.push(b'\n');
    }
}

/// Whether a plane is one ring that turns only to the left, and whose fan of triangles around the first position never
/// folds back: so a program that cuts faces into fans gets it right.
fn is_convex(plane: &Plane) -> bool {
    let [ring] = &plane.rings[..] else { return false };
    let n = ring.len();
    let left = |from: usize, corner: usize, to: usize| {
        let side = |a: usize, b: usize| -> [f64; 3] { std::array::from_fn(|i| ring[b % n][i] - ring[a % n][i]) };
        let ([ax, ay, az], [bx, by, bz]) = (side(from, corner), side(from, to));
        let [nx, ny, nz] = plane.normal;
        nx * (ay * bz - az * by) + ny * (az * bx - ax * bz) + nz * (ax * by - ay * bx) >= 0.0
    };
    (0..n).all(|i| left(i, i + 1, i + 2)) && (1..n - 1).all(|i| left(0, i, i + 1))
}
