//! Which points are used.

use zeroset::cloud::{Cloud, Filter, NOISE_CLASSES, isolated_points, retain};
use zeroset_io::ReadReport;

use crate::args::{Outliers, ReconstructArgs};
use crate::error::{CliError, in_words};
use crate::report::{Dropped, Filters, Input};
use crate::table::count;

/// Leaves out what the options leave out.
pub(super) fn select(mut cloud: Cloud, read: ReadReport, args: &ReconstructArgs) -> Result<Input, CliError> {
    let filters = filters(args);
    if filters.classes.is_some() && cloud.attributes.classes.is_none() {
        let some = read.attributes_left_out.contains(&"classes");
        return Err(CliError::NoClasses { inputs: in_words(&args.inputs), some });
    }
    let mut warnings = Vec::new();
    if !filters.exclude.is_empty() && read.attributes_left_out.contains(&"classes") {
        warnings.push("some of the inputs have no classes, so no class is left out; use inputs of one kind".to_owned());
    }
    let filter = Filter {
        only_classes: filters.classes.clone(),
        exclude_classes: filters.exclude.clone(),
        bounds: args.bounds.map(|b| b.0),
    };
    let before = cloud.len();
    let by = filter.apply(&mut cloud);
    let mut dropped = Dropped {
        non_finite: read.non_finite,
        withheld: read.withheld,
        by_class: by.by_class as u64,
        by_bounds: by.by_bounds as u64,
        isolated: 0,
    };
    if let Some(k) = filters.outliers {
        let keep: Vec<bool> = isolated_points(&cloud, k).into_iter().map(|isolated| !isolated).collect();
        dropped.isolated = retain(&mut cloud, &keep) as u64;
    }
    if cloud.is_empty() {
        let filters = left_out(&dropped, before, &filters);
        return Err(CliError::NothingLeft { inputs: in_words(&args.inputs), filters });
    }
    Ok(Input { cloud, read, filters, dropped, warnings })
}

fn filters(args: &ReconstructArgs) -> Filters {
    let classes = args.classes.as_ref().map(|c| c.0.clone());
    let exclude = args.exclude.as_ref().map_or_else(
        || {
            let asked_for = |class: &u8| classes.as_ref().is_some_and(|only| only.contains(class));
            NOISE_CLASSES.into_iter().filter(|class| !asked_for(class)).collect()
        },
        |c| c.0.clone(),
    );
    let open = |v: f64| v.is_finite().then_some(v);
    Filters {
        bounds: args.bounds.map(|b| b.0.map(|side| side.map(open))),
        outliers: match args.outliers {
            Outliers::Off => None,
            Outliers::Groups(k) => Some(k.get()),
        },
        classes,
        exclude,
    }
}

/// What each option left out, in words.
fn left_out(dropped: &Dropped, before: usize, filters: &Filters) -> String {
    let by_class = if filters.classes.is_some() { "--classes and --exclude" } else { "--exclude" };
    let parts = [(by_class, dropped.by_class), ("--bounds", dropped.by_bounds), ("--outliers", dropped.isolated)];
    let said: Vec<String> = parts
        .iter()
        .filter(|(_, points)| *points > 0)
        .map(|(option, points)| format!("{option} left out {}", count(*points)))
        .collect();
    format!("{} of {}", said.join(", "), count(before))
}
