//! Features as DXF.

use zeroset::feature::FeatureKind;

use super::FeatureOutput;
use crate::drawing::{Closing, Drawing};
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
    let rings = || features.planes.iter().flat_map(|plane| &plane.rings);
    let all = rings().flatten().chain(features.edges.iter().flat_map(|edge| &edge.polyline));
    let all = all.chain(features.corners.iter().map(|corner| &corner.position)).map(at);
    let mut file = Drawing::new(&output.options.comment_lines(features.crs.as_deref()), all, &LAYERS);
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
                file.line(layer, [at(from), at(to)]);
            }
            [first, between @ .., last] if first == last => {
                file.polyline(layer, Closing::Closed, std::iter::once(first).chain(between).map(at));
            }
            line => file.polyline(layer, Closing::Open, line.iter().map(at)),
        }
    }
    for corner in &features.corners {
        file.point("CORNERS", at(&corner.position));
    }
    file.finish()
}
