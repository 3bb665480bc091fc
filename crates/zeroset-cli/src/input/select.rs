//! Which points are used.

use std::num::NonZeroUsize;

use zeroset::cloud::{Cloud, Filter, isolated_points, retain};
use zeroset::monitor::Monitor;
use zeroset_io::{NO_CLASS, ReadReport, Source, shown};

use super::{Dropped, Filters, Input};
use crate::args::InputArgs;
use crate::error::{CliError, in_words};
use crate::interrupt;
use crate::table::{count, position};

/// Leaves out what the options leave out.
pub(super) fn select(
    mut cloud: Cloud,
    read: ReadReport,
    args: &InputArgs,
    monitor: &dyn Monitor,
) -> Result<Input, CliError> {
    let filters = filters(args);
    if filters.classes.is_some() && cloud.attributes.classes.is_none() {
        return Err(CliError::NoClasses { inputs: in_words(&args.inputs) });
    }
    let warnings = left_out_whole(&filters, &cloud, &read);
    let filter = Filter {
        only_classes: filters.classes.clone(),
        exclude_classes: filters.exclude.clone(),
        bounds: args.bounds.map(|b| b.0),
    };
    let (before, extent) = (cloud.len(), cloud.bounds());
    let by = filter.apply(&mut cloud);
    let mut dropped = Dropped {
        non_finite: read.non_finite,
        withheld: read.withheld,
        by_class: by.by_class as u64,
        by_bounds: by.by_bounds as u64,
        isolated: 0,
    };
    if let Some(k) = filters.outliers {
        monitor.stage("looking for isolated points");
        let isolated =
            interrupt::watched(|| isolated_points(&cloud, k, monitor))?.map_err(|_| CliError::Interrupted)?;
        let keep: Vec<bool> = isolated.into_iter().map(|isolated| !isolated).collect();
        dropped.isolated = retain(&mut cloud, &keep) as u64;
    }
    if cloud.is_empty() {
        return Err(nothing_left(&dropped, before, extent, &filters, args));
    }
    Ok(Input { cloud, read, filters, dropped, warnings })
}

/// What of an input is used, but for what is isolated.
pub(crate) fn filter(args: &InputArgs) -> Filter {
    let filters = filters(args);
    Filter { only_classes: filters.classes, exclude_classes: filters.exclude, bounds: args.bounds.map(|b| b.0) }
}

fn filters(args: &InputArgs) -> Filters {
    let classes = args.classes.as_ref().map(|c| c.0.clone());
    let exclude =
        args.exclude.as_ref().map_or_else(|| Filter::excluded_by_default(classes.as_deref()), |c| c.0.clone());
    let open = |v: f64| v.is_finite().then_some(v);
    Filters {
        bounds: args.bounds.map(|b| b.0.map(|side| side.map(open))),
        outliers: args.outliers.value().map(NonZeroUsize::get),
        classes,
        exclude,
    }
}

/// A warning for each input without classes that `--classes` or `--exclude` leaves out as a whole.
fn left_out_whole(filters: &Filters, cloud: &Cloud, read: &ReadReport) -> Vec<String> {
    if cloud.attributes.classes.is_none() {
        return Vec::new();
    }
    let option = if filters.exclude.contains(&NO_CLASS) {
        "--exclude"
    } else if filters.classes.as_ref().is_some_and(|only| !only.contains(&NO_CLASS)) {
        "--classes"
    } else {
        return Vec::new();
    };
    let bare = read.sources.iter().filter(|source| !source.has("classes"));
    let warning = |source: &Source| {
        format!(
            "{} has no classes, so {option} leaves out all its {} points",
            shown(&source.path),
            count(source.points)
        )
    };
    bare.map(warning).collect()
}

/// The error that names what left out how many points.
fn nothing_left(
    dropped: &Dropped,
    before: usize,
    extent: Option<[[f64; 3]; 2]>,
    filters: &Filters,
    args: &InputArgs,
) -> CliError {
    let by_class = match (&filters.classes, filters.exclude.is_empty()) {
        (Some(_), true) => "--classes",
        (Some(_), false) => "--classes and --exclude",
        (None, _) => "--exclude",
    };
    let parts = [(by_class, dropped.by_class), ("--bounds", dropped.by_bounds), ("--outliers", dropped.isolated)];
    let said: Vec<String> = parts
        .iter()
        .filter(|(_, points)| *points > 0)
        .map(|(option, points)| format!("{option} left out {}", count(*points)))
        .collect();
    let mut words = format!("{} of {}", said.join(", "), count(before));
    if let Some([low, high]) = extent.filter(|_| dropped.by_bounds > 0) {
        words += &format!(", which lie from {} to {}", position(low, 1), position(high, 1));
    }
    CliError::NothingLeft { inputs: in_words(&args.inputs), filters: words, several: said.len() > 1 }
}
