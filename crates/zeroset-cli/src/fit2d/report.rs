//! What came of the fit, in figures and in words.

use clap::ValueEnum;
use zeroset_io::PlanarResult;
use zeroset_io::planar::MethodReport;

use super::Done;
use crate::args::Fit2dArgs;
use crate::table::{count, significant};

/// The figures.
pub(super) fn result(args: &Fit2dArgs, done: &Done<'_>) -> PlanarResult {
    let (fitted, plan) = (&done.fitted, done.plan);
    let polyline = |line: &zeroset::contour::Polyline| {
        let first = line.points.first().filter(|_| line.closed);
        line.points.iter().chain(first).copied().collect()
    };
    PlanarResult {
        eigenvalue: fitted.spectrum.first().copied(),
        gap: fitted.gap(),
        spectrum: fitted.spectrum.clone(),
        rayleigh_quotient: fitted.rayleigh_quotient,
        nodes: (0..plan.basis.len()).map(|j| plan.basis.node(j)).collect(),
        coefficients: fitted.coefficients.clone(),
        unconstrained: fitted.diagnosis.unconstrained.clone(),
        residual_rms: fitted.residual_rms,
        distance_rms: fitted.distance_rms,
        residuals: fitted.residuals.clone(),
        contour: done.contour.iter().map(polyline).collect(),
        closed: done.contour.iter().map(|line| line.closed).collect(),
        warnings: fitted.diagnosis.warnings.iter().map(ToString::to_string).collect(),
        method: MethodReport {
            domain: plan.domain_name.to_owned(),
            triangles: plan.basis.domain().len(),
            bounds: [plan.extent.low, plan.extent.high],
            basis: name(args.basis),
            width: plan.width,
            normalization: name(args.normalization),
            order: args.order,
            smoothness: plan.smoothness,
            line_weight: args.line_weight,
            tolerance: plan.tolerance,
        },
    }
}

/// The word that is typed for a choice.
fn name(choice: impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// One line for a user who waits.
pub(super) fn summary(done: &Done<'_>, output: &str) -> String {
    format!(
        "{output}: {} data, {} functions on {}; {}; {}",
        count(done.input.len()),
        count(done.plan.basis.len()),
        done.plan.domain_text,
        figures(done),
        curves(done)
    )
}

/// The figures that tell whether a fit is good.
pub(super) fn figures(done: &Done<'_>) -> String {
    let fitted = &done.fitted;
    let mut text = match fitted.spectrum.first() {
        Some(&eigenvalue) => format!("eigenvalue {}", significant(eigenvalue, 6)),
        None => format!("quotient {}", significant(fitted.rayleigh_quotient, 6)),
    };
    if let Some(gap) = fitted.gap() {
        text += &format!(", gap {}", significant(gap, 3));
    }
    text + &format!(", distance of the data {} rms", significant(fitted.distance_rms, 3))
}

fn curves(done: &Done<'_>) -> String {
    let closed = done.contour.iter().filter(|line| line.closed).count();
    match (done.contour.len(), closed) {
        (0, _) => "no curve".to_owned(),
        (1, 1) => "1 closed curve".to_owned(),
        (1, _) => "1 open curve".to_owned(),
        (all, closed) => format!("{all} curves, {closed} of them closed"),
    }
}

/// How the fit was made.
pub(super) fn method(args: &Fit2dArgs, done: &Done<'_>) -> String {
    let plan = done.plan;
    let mut text = format!("{}, {} functions on {}", name(args.basis), count(plan.basis.len()), plan.domain_text);
    if let Some(width) = plan.width {
        text += &format!(", width {}", significant(width, 3));
    }
    text + &match args.order {
        0 => format!("; {}, order 0", name(args.normalization)),
        order => {
            format!("; {}, order {order}, smoothness {}", name(args.normalization), significant(plan.smoothness, 3))
        }
    }
}
