//! What a search for features says to people.

use zeroset::feature::{FeatureReport, Features};

use super::report::{Kinds, OutputReport, Seconds};
use crate::input::Input;
use crate::table::{bytes, columns, count, length, name, pairs, significant, stages, words};

/// That nothing is flat, and what may help.
pub(super) fn no_planes(done: &FeatureReport) -> String {
    format!(
        "note: no planes: nothing of {} or more is flat to {}; rougher planes take a larger --max-distance, smaller ones a smaller \
         --min-area, and where the noise comes near the spacing of the points none can be told",
        significant(done.min_area, 3),
        significant(done.max_distance, 3)
    )
}

/// Planes that are listed.
const LISTED: usize = 20;

/// What was found, in a line.
pub(super) fn summary(
    features: &Features,
    done: &FeatureReport,
    outputs: &[OutputReport],
    seconds: f64,
    input: &Input,
) -> String {
    let unit = input.read.unit;
    format!(
        "{}: {}, {}, {} from {}{} points ({}, within {} of planes) in {} s",
        outputs.iter().map(|output| output.path.as_str()).collect::<Vec<_>>().join(", "),
        counted(features.planes.len(), "plane"),
        counted(features.edges.len(), "edge"),
        counted(features.corners.len(), "corner"),
        count(done.points),
        input.of_all(done.points),
        name(done.scene),
        length(done.max_distance, unit),
        significant(seconds, 3),
    )
}

fn counted(n: usize, what: &str) -> String {
    format!("{} {what}{}", count(n), if n == 1 { "" } else { "s" })
}

/// Stages, parameters and what was found, for `--verbose`.
pub(super) fn tables(features: &Features, done: &FeatureReport, seconds: &Seconds, input: &Input) -> String {
    let unit = input.read.unit;
    let stages = stages(&[
        ("read", seconds.read),
        ("select", seconds.select),
        ("detect", seconds.detect),
        ("write", seconds.write),
        ("total", seconds.total),
    ]);
    let figures = pairs(&[
        ("spacing", length(done.spacing, unit)),
        ("noise", length(done.noise, unit)),
        ("smallest plane", significant(done.min_area, 4)),
        ("distance from planes", length(done.max_distance, unit)),
        ("angle from planes", format!("{} degrees", significant(done.max_angle_deg, 4))),
        ("sharp from", format!("{} degrees", significant(done.sharp_angle_deg, 4))),
        ("points on planes", format!("{} of {}", count(done.points_on_planes), count(done.points))),
        ("area of planes", significant(done.plane_area, 5)),
        ("their distance, rms", done.plane_rms.map_or_else(|| "-".to_owned(), |rms| length(rms, unit))),
        ("length of edges", length(done.edge_length, unit)),
    ]);
    let edges = Kinds::of(features.edges.iter().map(|edge| edge.kind));
    let corners = Kinds::of(features.corners.iter().map(|corner| corner.kind));
    let kinds = |name: &str, k: Kinds| {
        let numbers = [k.convex, k.concave, k.mixed, k.unknown, k.all].map(count);
        std::iter::once(name.to_owned()).chain(numbers).collect::<Vec<_>>()
    };
    let kinds = vec![
        words(&["kind", "convex", "concave", "mixed", "unknown", "all"]),
        kinds("edges", edges),
        kinds("corners", corners),
    ];
    let mut planes = vec![words(&["plane", "area", "points", "rms", "slope", "faces"])];
    for (id, plane) in features.planes.iter().take(LISTED).enumerate() {
        planes.push(vec![
            id.to_string(),
            significant(plane.area, 4),
            count(plane.points),
            plane.rms.map_or_else(|| "-".to_owned(), |rms| significant(rms, 3)),
            format!("{:.1}", plane.normal[2].abs().min(1.0).acos().to_degrees()),
            if plane.oriented { "outward" } else { "unknown" }.to_owned(),
        ]);
    }
    let mut text = [stages, figures, columns(&kinds), columns(&planes)].join("\n");
    if features.planes.len() > LISTED {
        text += &format!("and {} smaller ones\n", count(features.planes.len() - LISTED));
    }
    if let Some(peak) = crate::memory::peak() {
        text += &format!("{} of memory at most\n", bytes(peak));
    }
    text
}
