//! What a reconstruction says to people.

use zeroset::constraint::ConstraintPlan;
use zeroset::fit::cascade::PolishParams;
use zeroset::mesh::{Mesh, SimplifyParams, Topology, topology};
use zeroset::reconstruct::{PlanReport, ReconstructReport};
use zeroset_io::LinearUnit;

use crate::input::Input;
use crate::report::{ComponentsReport, OutputReport, Seconds};
use crate::simplify::outcome;
use crate::table::{
    bytes, clock, columns, count, decimals_for, length, name, pairs, position, significant, stages, words,
};

/// That memory made the result coarser than the points are.
pub(super) fn capped(plan: &PlanReport, wanted: f64) -> String {
    format!(
        "warning: memory allows for a resolution of {} only, the points bear {}; give more --memory, or --bounds",
        significant(plan.resolution, 4),
        significant(wanted, 4)
    )
}

/// The plan, as `--dry-run` prints it.
pub(super) fn plan(plan: &PlanReport, input: &Input, memory: u64) -> String {
    let unit = input.read.unit;
    let decimals = decimals_for(plan.resolution);
    let [low, high] = plan.bounds;
    let sides: [f64; 3] = std::array::from_fn(|a| high[a] - low[a]);
    let cap = plan
        .wanted_resolution
        .map_or_else(String::new, |wanted| format!(", for memory; the points bear {}", length(wanted, unit)));
    pairs(&[
        ("points", input.points_in_words()),
        ("box from", position(low, decimals)),
        ("box to", position(high, decimals)),
        ("box sides", position(sides, decimals)),
        ("spacing", length(plan.spacing, unit)),
        ("noise", length(plan.noise, unit)),
        ("scene", format!("{} ({})", name(plan.scene), plan.scene_reason)),
        ("up", name(plan.up)),
        ("resolution", format!("{}{cap}", length(plan.resolution, unit))),
        ("levels", plan.levels.to_string()),
        ("occupied cells", count(plan.occupied_cells)),
        ("nodes", format!("about {}", count(plan.expected_nodes))),
        ("memory", format!("about {}, of {} allowed", bytes(plan.expected_bytes), bytes(memory))),
        ("trim", plan.trim.map_or_else(|| "off".to_owned(), |trim| length(trim, unit))),
        ("screening", significant(plan.screening, 4)),
        ("quality", name(plan.quality)),
        ("polish", polish(plan.polish.as_ref())),
        ("simplify", simplification(plan.simplify.as_ref())),
        ("attributes", name(plan.attributes)),
        ("constraints", constraints(plan.constraints.as_ref(), unit)),
    ])
}

/// How much the user knows of the surface.
fn constraints(plan: Option<&ConstraintPlan>, unit: Option<LinearUnit>) -> String {
    plan.map_or_else(
        || "none".to_owned(),
        |plan| {
            let lines = format!("{} lines, {} in all", count(plan.lines_used), length(plan.length, unit));
            format!("{lines}; {} polygons, {} square units", count(plan.polygons_used), significant(plan.area, 4))
        },
    )
}

/// How F is polished.
fn polish(params: Option<&PolishParams>) -> String {
    params.map_or_else(
        || "off".to_owned(),
        |p| format!("{} rounds, smoothness {}", p.rounds, significant(p.smoothness, 4)),
    )
}

/// How far the mesh is simplified.
fn simplification(params: Option<&SimplifyParams>) -> String {
    let triangles = params.and_then(|p| p.triangles).map(|n| format!("to {} triangles", count(n)));
    let error = params.and_then(|p| p.max_error).map(|error| format!("within {}", significant(error, 4)));
    let said: Vec<String> = triangles.into_iter().chain(error).collect();
    if said.is_empty() { "off".to_owned() } else { said.join(", ") }
}

/// What was made, in a line, and what a user must know about the file.
pub(super) fn summary(done: &ReconstructReport, output: &OutputReport, seconds: f64, input: &Input) -> String {
    let mut text = format!(
        "{}: {} vertices, {} triangles from {}{} points ({}, resolution {}) in {} s",
        output.path,
        count(done.vertices),
        count(done.triangles),
        count(done.plan.points),
        input.of_all(done.plan.points),
        name(done.plan.scene),
        length(done.plan.resolution, input.read.unit),
        significant(seconds, 3),
    );
    text += &output.offset_line();
    if let Some(report) = &done.simplify {
        text += &format!("\nsimplified: {}", outcome(report));
    }
    if let Some(report) = &done.constraints {
        let unit = input.read.unit;
        text += &format!(
            "\nconstraints: the mesh lies {} from them in the mean, 95 % within {}",
            length(report.mean_distance, unit),
            length(report.p95_distance, unit)
        );
    }
    if done.fit.outside_is_clear() == Some(false) {
        text += "\nthe surface runs out of the box of the points, so neither side is clearly outside: the upper one was taken; \
                 --scene terrain or airborne knows";
    }
    text + &output.left_out_line()
}

/// What became of the smallest pieces.
fn pieces(components: &ComponentsReport) -> String {
    let Some(least) = components.least_triangles else { return "every piece is kept".to_owned() };
    format!(
        "{} pieces of fewer than {} triangles were left out, {} triangles in all",
        count(components.dropped.components),
        count(least),
        count(components.dropped.triangles)
    )
}

/// Stages, levels and the mesh, for `--verbose`.
pub(super) fn tables(done: &ReconstructReport, seconds: &Seconds, mesh: &Mesh) -> String {
    let stages = stages(&[
        ("read", seconds.read),
        ("select", seconds.select),
        ("plan", done.seconds.plan),
        ("fit", done.seconds.fit),
        ("structure", done.seconds.structure),
        ("polish", done.seconds.polish),
        ("contour", done.seconds.contour),
        ("sharpen", done.seconds.sharpen),
        ("simplify", done.seconds.simplify),
        ("attributes", done.seconds.attributes),
        ("write", seconds.write),
        ("total", seconds.total),
    ]);
    let mut text = format!("{stages}\n{}", levels(done));
    if let Ok(topology) = topology(mesh) {
        text += &format!("\n{}\n", components(&topology));
    }
    text += &format!("{}\n", pieces(&ComponentsReport::new(done)));
    if let Some(peak) = crate::memory::peak() {
        text += &format!("{} of memory at most, {} expected\n", bytes(peak), bytes(done.plan.expected_bytes));
    }
    text
}

/// The levels of the fit, a row each.
fn levels(done: &ReconstructReport) -> String {
    let mut levels =
        vec![words(&["level", "cell", "occupied", "nodes", "start", "steps", "R before", "R after", "seconds"])];
    for level in &done.fit.levels {
        let first = level.iterations.first().map_or(level.rayleigh_quotient, |i| i.rayleigh_quotient);
        levels.push(vec![
            (level.level + 1).to_string(),
            significant(level.spacing, 4),
            count(level.occupied_cells),
            count(level.free_nodes),
            if level.seeded { "seed" } else { "coarser" }.to_owned(),
            level.iterations.len().to_string(),
            significant(first, 5),
            significant(level.rayleigh_quotient, 5),
            clock(level.seconds),
        ]);
    }
    columns(&levels)
}

/// How many components there are, and whether they are closed.
fn components(topology: &Topology) -> String {
    let largest = topology.components.iter().map(|c| c.area).fold(0.0, f64::max);
    let large = match topology.large_components {
        1 => "1 component".to_owned(),
        n => format!("{n} components"),
    };
    let closed = if topology.closed {
        "closed".to_owned()
    } else {
        format!("{} boundary edges", count(topology.boundary_edges))
    };
    format!(
        "{large} with over 1 % of the triangles, {} in all; the largest holds {:.1} % of the area; {closed}",
        count(topology.components.len()),
        100.0 * largest / topology.area,
    )
}
