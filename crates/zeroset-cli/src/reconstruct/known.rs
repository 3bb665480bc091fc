//! The user's lines and polygons.

use std::path::{Path, PathBuf};

use zeroset::cloud::Cloud;
use zeroset::constraint::Constraints;
use zeroset_io::{ConstraintFile, ConstraintFormat, read_constraints, shown};

use crate::args::{FitOptions, PolygonsChoice};
use crate::console::Lines;
use crate::error::CliError;
use crate::input::check_is_file;
use crate::table::{count, position};

/// Looks at the names before anything is read.
pub(crate) fn check(paths: &[PathBuf]) -> Result<(), CliError> {
    for path in paths {
        ConstraintFormat::from_path(path)?;
        check_is_file(path)?;
    }
    Ok(())
}

/// Reads all files.
pub(crate) fn read(args: &FitOptions) -> Result<Vec<ConstraintFile>, CliError> {
    let outlines = args.constraint_polygons == Some(PolygonsChoice::Outlines);
    let one = |path: &PathBuf| {
        let mut file = read_constraints(path)?;
        if outlines {
            file.constraints = file.constraints.into_outlines();
        }
        Ok(file)
    };
    args.constraints.iter().map(one).collect()
}

/// Holds each file against the points, says what is left out, and takes all together.
pub(crate) fn place(
    files: Vec<ConstraintFile>,
    paths: &[PathBuf],
    cloud: &Cloud,
    lines: &mut Lines,
) -> Result<Constraints, CliError> {
    let mut all = Constraints::default();
    let Some(around) = cloud.bounds() else { return Ok(all) };
    for (file, path) in files.into_iter().zip(paths) {
        let used = file.constraints.within(around);
        if used.is_idle() {
            return Err(astray(path, &file, around));
        }
        let of = |used: usize, given: usize, what: &str| {
            (used < given).then(|| format!("{} of {} {what}", count(given - used), count(given)))
        };
        let outside = [of(used.lines_used, used.lines, "lines"), of(used.polygons_used, used.polygons, "polygons")];
        let outside: Vec<String> = outside.into_iter().flatten().collect();
        if !outside.is_empty() {
            lines.say(format!("note: {}: {} lie outside of the box of the points", shown(path), outside.join(" and ")));
        }
        if file.passed_over > 0 {
            let what = "passed over, as neither line nor polygon with an extent";
            lines.say(format!("note: {}: {what}: {}", shown(path), count(file.passed_over)));
        }
        let theirs = cloud.crs.as_deref().and_then(zeroset_io::constraints::epsg);
        if let (Some(own), Some(theirs)) = (file.epsg(), theirs)
            && own != theirs
        {
            lines.say(format!(
                "warning: {} is in EPSG:{own}, the points are in EPSG:{theirs}; coordinates are not transformed",
                shown(path)
            ));
        }
        all.append(file.constraints);
    }
    Ok(all)
}

fn astray(path: &Path, file: &ConstraintFile, around: [[f64; 3]; 2]) -> CliError {
    let span = |[low, high]: [[f64; 3]; 2]| format!("from {} to {}", position(low, 1), position(high, 1));
    let system = file.epsg().map_or_else(String::new, |code| format!(" in EPSG:{code}"));
    CliError::ConstraintsAstray {
        path: path.to_path_buf(),
        own: file.constraints.bounds().map_or_else(String::new, span) + &system,
        points: span(around),
    }
}
