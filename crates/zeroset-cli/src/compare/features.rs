//! `zeroset compare --features`.

use zeroset::feature::{
    CompareFeaturesError, CompareFeaturesParams, CompareFeaturesReport, ErrorSummary, FaceRecall, compare_features,
};
use zeroset_io::{read_cloud, read_features, read_mesh};

use super::{figure, row, share};
use crate::args::CompareArgs;
use crate::console::Console;
use crate::error::CliError;
use crate::progress::{Progress, with_progress};
use crate::report::to_json;
use crate::table::{columns, count};

/// The first of the two names is that of the truth; the features have an option of their own.
pub(super) fn run(args: &CompareArgs) -> Result<(), CliError> {
    let Some(features) = &args.features else {
        return Err(CliError::Usage("error: name a mesh and the truth, or --features and the truth".to_owned()));
    };
    let found = read_features(features)?.features;
    let truth = read_mesh(&args.first)?;
    let cloud = args.cloud.as_ref().map(|path| read_cloud(path)).transpose()?.map(|file| file.cloud);
    let params = CompareFeaturesParams {
        max_angle: args.max_angle.to_radians(),
        offset_tolerance: args.tau,
        edge_tolerance: args.edge_tolerance,
        corner_tolerance: args.corner_tolerance,
        min_points: args.min_points,
        min_face_area: args.min_area.unwrap_or(0.0),
        sharp_angle: args.sharp_angle.to_radians(),
        ..CompareFeaturesParams::default()
    };
    let compare = |progress: &Progress| compare_features(&found, &truth, cloud.as_ref(), &params, progress);
    let report = with_progress(Console::Normal, compare)?;
    let report = report.map_err(|error| named(error, args))?;
    Console::print(&if args.json { to_json(&report) } else { table(&report) })
}

/// The error with the name of the file that it is about.
fn named(error: CompareFeaturesError, args: &CompareArgs) -> CliError {
    let truth = || args.first.clone();
    match error {
        CompareFeaturesError::NoSurface { faces } => CliError::NoSurface { path: truth(), faces },
        CompareFeaturesError::Broken(source) => CliError::Mesh { path: truth(), source },
        CompareFeaturesError::Cancelled(_) => CliError::Interrupted,
        source @ CompareFeaturesError::NoPoints { .. } => {
            CliError::CompareFeatures { path: args.cloud.clone().unwrap_or_default(), source }
        }
        source @ CompareFeaturesError::Parameter { .. } => CliError::CompareFeatures { path: truth(), source },
    }
}

fn or_dash(value: Option<f64>, shown: fn(f64) -> String) -> String {
    value.map_or_else(|| "-".to_owned(), shown)
}

fn table(report: &CompareFeaturesReport) -> String {
    let planes = &report.planes;
    let mut faces = vec![row("true faces", ["all", "walls", "roofs and ground"].map(String::from))];
    let mut face = |name: &str, of: fn(&FaceRecall) -> String| {
        faces.push(row(name, [&planes.all, &planes.walls, &planes.roofs_and_ground].map(of)));
    };
    face("number", |f| count(f.faces));
    face("found", |f| count(f.found));
    face("recall by number", |f| or_dash(f.by_count, share));
    face("recall by area", |f| or_dash(f.by_area, share));

    let mut errors = vec![row("planes", ["mean", "median", "95 %", "max"].map(String::from))];
    let mut error = |name: &str, e: Option<ErrorSummary>| {
        errors.push(row(
            name,
            [e.map(|e| e.mean), e.map(|e| e.median), e.map(|e| e.p95), e.map(|e| e.max)].map(|v| or_dash(v, figure)),
        ));
    };
    error("angle, degrees", planes.angle_error_deg);
    error("distance of the middle", planes.offset_error);

    let (edges, corners) = (&report.edges, &report.corners);
    let all = [
        row("agreement", ["planes", "edges", "corners"].map(String::from)),
        row("found", [planes.found, edges.found, corners.found].map(count)),
        row("recall", [planes.all.by_count, edges.recall, corners.recall].map(|v| or_dash(v, share))),
        row("precision", [planes.precision, edges.precision, corners.precision].map(|v| or_dash(v, share))),
        row("right orientation or kind", [planes.orientation, edges.kind, corners.kind].map(|v| or_dash(v, share))),
        row("found, length", ["-".to_owned(), figure(edges.found_length), "-".to_owned()]),
        row("true, length or number", [count(planes.all.faces), figure(edges.true_length), count(corners.truth)]),
        row("with points on both sides", ["-".to_owned(), figure(edges.counted_length), count(corners.counted)]),
        row("mean distance", ["-".to_owned(), "-".to_owned(), or_dash(corners.mean_distance, figure)]),
    ];
    let lengths = format!(
        "within {} and {} degrees for planes, {} for edges, {} for corners; diagonal of the truth {}\n",
        figure(report.offset_tolerance),
        figure(report.max_angle_deg),
        figure(report.edge_tolerance),
        figure(report.corner_tolerance),
        figure(report.truth_diagonal)
    );
    [columns(&all), columns(&faces), columns(&errors), lengths].join("\n")
}
