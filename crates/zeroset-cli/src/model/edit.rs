//! `zeroset edit`.

use zeroset::model::{Model, Solid};
use zeroset_io::{is_model, shown, write_model};

use super::mesh::{check as check_mesh, make};
use super::open::{Opener, files, provenance};
use super::{console, start};
use crate::args::EditArgs;
use crate::error::CliError;
use crate::input::check_output_and_report;
use crate::report::write_report;
use crate::table::bytes;

/// What is done with an operand.
#[derive(Debug, Clone, Copy)]
enum Operation {
    Union,
    Subtract,
    Intersect,
}

pub(crate) fn run(args: &EditArgs) -> Result<(), CliError> {
    let steps = steps(&args.operations)?;
    let named = || std::iter::once(args.base.as_str()).chain(steps.iter().map(|(_, operand)| *operand));
    if is_model(&args.output) {
        check_output_and_report(&files(named()), Some(&args.output), args.run.report.as_deref())?;
    } else {
        check_mesh(&args.output, &args.run, named())?;
    }
    start(&args.run)?;
    let mut opener = Opener::new();
    let mut solid = opener.read(&args.base)?;
    for &(operation, operand) in &steps {
        let operand = opener.read(operand)?;
        solid = apply(operation, solid, operand);
    }
    let opened = opener.finish(solid);
    if !is_model(&args.output) {
        return make(opened, &args.base, &args.surface, &args.output, &args.run);
    }
    let parameters = vec![("edit".to_owned(), args.operations.join(" "))];
    let provenance = provenance(opened.inputs, parameters);
    let model = Model { solid: opened.solid, crs: opened.crs, provenance };
    let written = write_model(&args.output, &model)?;
    console(&args.run).say(&format!("{}: {}", shown(&args.output), bytes(written)));
    let report = serde_json::json!({
        "inputs": model.provenance.inputs,
        "output": { "path": shown(&args.output), "bytes": written },
    });
    write_report(args.run.report.as_deref(), report)
}

/// The operations, each with its operand.
fn steps(words: &[String]) -> Result<Vec<(Operation, &str)>, CliError> {
    let pair = |pair: &'_ [String]| -> Result<Operation, CliError> {
        match pair[0].as_str() {
            "union" => Ok(Operation::Union),
            "subtract" => Ok(Operation::Subtract),
            "intersect" => Ok(Operation::Intersect),
            other => Err(CliError::Usage(format!(
                "`{other}` is no operation; give union, subtract or intersect, and then an operand"
            ))),
        }
    };
    words
        .chunks(2)
        .map(|words| {
            let operation = pair(words)?;
            let operand = words.get(1).ok_or_else(|| CliError::Usage(format!("`{}` has no operand", words[0])))?;
            Ok((operation, operand.as_str()))
        })
        .collect()
}

/// Adds an operand; equal operations one after the other become one.
fn apply(operation: Operation, base: Solid, operand: Solid) -> Solid {
    match (operation, base) {
        (Operation::Union, Solid::Union(mut all)) => {
            all.push(operand);
            Solid::Union(all)
        }
        (Operation::Union, base) => Solid::Union(vec![base, operand]),
        (Operation::Intersect, Solid::Intersection(mut all)) => {
            all.push(operand);
            Solid::Intersection(all)
        }
        (Operation::Intersect, base) => Solid::Intersection(vec![base, operand]),
        (Operation::Subtract, base) => Solid::Difference(Box::new([base, operand])),
    }
}
