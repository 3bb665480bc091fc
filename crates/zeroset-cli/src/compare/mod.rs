//! `zeroset compare`.

mod features;

use std::path::Path;

use zeroset::mesh::{Agreement, CompareError, CompareParams, CompareReport, OneWay, Role, Topology, compare};
use zeroset_io::read_mesh;

use crate::args::CompareArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::progress::with_progress;
use crate::report::to_json;
use crate::table::{columns, count, significant};

pub(crate) fn run(args: &CompareArgs) -> Result<(), CliError> {
    // Without --features there is always a second file.
    let (Some(second), None) = (&args.second, &args.features) else {
        return features::run(args);
    };
    let (mesh, truth) = (read_mesh(&args.first)?, read_mesh(second)?);
    let params = CompareParams {
        samples: args.samples.get(),
        tau: args.tau,
        edge_band: args.edge_band,
        sharp_angle: args.sharp_angle.to_radians(),
        seed: args.seed,
    };
    let report = with_progress(Console::Normal, |progress| compare(&mesh, &truth, &params, progress))?;
    let report = report.map_err(|error| named(error, &args.first, second))?;
    Console::print(&if args.json { to_json(&report) } else { table(&report) })
}

/// The error with the name of the file that it is about.
fn named(error: CompareError, mesh: &Path, truth: &Path) -> CliError {
    let path = |role| match role {
        Role::Mesh => mesh.to_path_buf(),
        Role::Truth => truth.to_path_buf(),
    };
    match error {
        CompareError::NoSurface { role, faces } => CliError::NoSurface { path: path(role), faces },
        CompareError::Broken { role, source } => CliError::Mesh { path: path(role), source },
        CompareError::Cancelled(_) => CliError::Interrupted,
        other @ CompareError::Parameter { .. } => CliError::Compare(other),
    }
}

fn figure(value: f64) -> String {
    significant(value, 4)
}

fn share(value: f64) -> String {
    format!("{value:.5}")
}

fn row(name: &str, values: impl IntoIterator<Item = String>) -> Vec<String> {
    std::iter::once(name.to_owned()).chain(values).collect()
}

fn table(report: &CompareReport) -> String {
    let mut distances = vec![row("distance", ["mean", "rms", "95 %", "max"].map(String::from))];
    let mut one_way = |name: &str, d: &OneWay| distances.push(row(name, [d.mean, d.rms, d.p95, d.max].map(figure)));
    one_way("mesh to truth", &report.overall.distances.mesh_to_truth);
    one_way("truth to mesh", &report.overall.distances.truth_to_mesh);
    one_way("both ways", &report.overall.distances.combined);
    if let Some(near) = &report.near_edges {
        one_way("near edges, mesh to truth", &near.distances.mesh_to_truth);
        one_way("near edges, truth to mesh", &near.distances.truth_to_mesh);
        one_way("near edges, both ways", &near.distances.combined);
    }
    if let Some(creases) = &report.crease_distance {
        one_way("truth's creases to mesh", creases);
    }

    let near = report.near_edges.as_ref();
    let mut agreement = vec![row("agreement", ["all", "near edges"].map(String::from))];
    let mut agree = |name: &str, of: fn(&Agreement) -> String| {
        agreement.push(row(name, [of(&report.overall), near.map_or_else(|| "-".to_owned(), of)]));
    };
    agree("F-score", |a| share(a.f_score));
    agree("precision", |a| share(a.precision));
    agree("recall", |a| share(a.recall));
    agree("normal consistency", |a| share(a.normal_consistency));
    agree("right orientation", |a| share(a.orientation));
    agree("samples on mesh", |a| count(a.mesh_samples));
    agree("samples on truth", |a| count(a.truth_samples));
    if let Some(occupancy) = report.occupancy {
        agreement.push(row("inside or outside right", [share(occupancy), "-".to_owned()]));
    }

    let lengths = format!(
        "tau {}, edge band {}, diagonal of the truth {}\n",
        figure(report.tau),
        figure(report.edge_band),
        figure(report.truth_diagonal)
    );
    let cutting = [&report.mesh_self_intersections, &report.truth_self_intersections];
    let cutting = [
        row("self-intersections", ["mesh", "truth"].map(String::from)),
        row("pairs of triangles", cutting.map(|found| count(found.pairs))),
        row("triangles", cutting.map(|found| count(found.triangles))),
    ];
    let topology = topologies(&["mesh", "truth"], &[&report.mesh, &report.truth]);
    [columns(&distances), columns(&agreement), topology, columns(&cutting), lengths].join("\n")
}

/// How meshes hang together, side by side.
pub(crate) fn topologies(names: &[&str], all: &[&Topology]) -> String {
    let mut rows = vec![row("topology", names.iter().map(|name| (*name).to_owned()))];
    let mut add = |name: &str, of: fn(&Topology) -> String| rows.push(row(name, all.iter().map(|t| of(t))));
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    add("vertices", |t| count(t.vertices));
    add("triangles", |t| count(t.faces));
    add("components", |t| count(t.components.len()));
    add("components over 1 %", |t| count(t.large_components));
    add("largest, share of area", |t| share(t.components.iter().map(|c| c.area).fold(0.0, f64::max) / t.area));
    add("closed", |t| if t.closed { "yes" } else { "no" }.to_owned());
    add("boundary edges", |t| count(t.boundary_edges));
    add("boundary loops", |t| count(t.boundary_loops));
    add("non-manifold edges", |t| count(t.nonmanifold_edges));
    add("non-manifold vertices", |t| count(t.nonmanifold_vertices));
    add("inconsistent edges", |t| count(t.inconsistent_edges));
    add("duplicate triangles", |t| count(t.duplicate_triangles));
    add("degenerate triangles", |t| count(t.degenerate_triangles));
    add("unused vertices", |t| count(t.unused_vertices));
    add("Euler characteristic", |t| t.euler_characteristic.to_string());
    rows.push(row("genus", all.iter().map(|t| or_dash(t.genus.map(|g| g.to_string())))));
    rows.push(row("area", all.iter().map(|t| figure(t.area))));
    rows.push(row("volume", all.iter().map(|t| or_dash(t.volume.map(figure)))));
    columns(&rows)
}
