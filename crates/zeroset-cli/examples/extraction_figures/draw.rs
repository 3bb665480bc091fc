//! Meshes side by side, shaded, in parallel projection.

use svg::Document;
use svg::node::element::{Group, Path, Rectangle, Text, Title};
use zeroset::mesh::Mesh;

use crate::shapes::{Place, cross, dot, minus, norm};

/// Width of a panel, its height over that, the space between two, and that below for words.
const SIDE: f64 = 320.0;
const HIGH: f64 = 0.8;
const GAP: f64 = 12.0;
const FOOT: f64 = 30.0;
/// From where one looks, and from where light falls.
const VIEWER: Place = [0.48, -0.68, 0.5546];
const LIGHT: Place = [0.75, -0.35, 0.56];
/// The colour of a triangle that faces the light.
const BRIGHT: [f64; 3] = [226.0, 232.0, 240.0];

/// A picture of meshes in the cube -1..1, each with a caption.
pub(crate) fn picture(title: &str, panels: &[(&str, &Mesh)]) -> String {
    let (width, height) = (panels.len() as f64 * (SIDE + GAP) + GAP, SIDE * HIGH + FOOT + GAP);
    let mut document = Document::new()
        .set("viewBox", format!("0 0 {width} {height}"))
        .set("width", width)
        .set("height", height)
        .set("font-family", "sans-serif")
        .add(Title::new(title))
        .add(Rectangle::new().set("width", width).set("height", height).set("fill", "#ffffff"));
    for (i, (caption, mesh)) in panels.iter().enumerate() {
        let shift = format!("translate({} {GAP})", GAP + i as f64 * (SIDE + GAP));
        let words = Text::new(*caption).set("x", 0.5 * SIDE).set("y", SIDE * HIGH + 20.0).set("text-anchor", "middle");
        let words = words.set("font-size", 15).set("fill", "#1a1a1a").set("stroke", "none");
        document = document.add(shaded(mesh).add(words).set("transform", shift));
    }
    format!("{document}\n")
}

/// The triangles that face the viewer, the farthest first.
fn shaded(mesh: &Mesh) -> Group {
    let flat = VIEWER[0].hypot(VIEWER[1]);
    let right = [-VIEWER[1] / flat, VIEWER[0] / flat, 0.0];
    let up = cross(VIEWER, right);
    let mut drawn: Vec<(f64, String, String)> = Vec::new();
    for triangle in &mesh.triangles {
        let corners = triangle.map(|v| mesh.vertices[v as usize]);
        let normal = cross(minus(corners[1], corners[0]), minus(corners[2], corners[0]));
        if dot(normal, VIEWER) <= 0.0 {
            continue;
        }
        let light = 0.3 + 0.7 * (dot(normal, LIGHT) / (norm(normal) * norm(LIGHT))).max(0.0);
        let [r, g, b] = BRIGHT.map(|c| (c * light).round() as u8);
        let pixel = |axis: Place, p: Place| 0.5 * SIDE + 0.56 * SIDE * dot(axis, p);
        let place = corners.map(|p| format!("{:.1} {:.1}", pixel(right, p), 0.5 * (1.0 + HIGH) * SIDE - pixel(up, p)));
        let depth = corners.iter().map(|&p| dot(VIEWER, p)).sum::<f64>();
        drawn.push((depth, format!("M{}z", place.join(" ")), format!("#{r:02x}{g:02x}{b:02x}")));
    }
    drawn.sort_by(|a, b| a.0.total_cmp(&b.0));
    // A stroke of the same colour covers the seams.
    let mut group = Group::new().set("stroke-width", 0.4).set("fill", "currentColor").set("stroke", "currentColor");
    for (_, path, color) in drawn {
        group = group.add(Path::new().set("d", path).set("color", color));
    }
    group
}
