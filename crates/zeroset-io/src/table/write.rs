//! Tables as bytes: rows in parallel, then out in their order.

use std::io::{Result, Write};
use std::ops::Range;

use rayon::prelude::*;

use super::{EvaluatedPoints, npy};
use crate::mesh::one_line;

/// The names of the columns.
const NAMES: [&str; 8] = ["x", "y", "z", "value", "gx", "gy", "gz", "inside"];
/// Rows that one thread encodes at a time, and rows that are in memory at a time.
const RUN: usize = 1 << 13;
const GROUP: usize = RUN << 5;

/// All numbers of a row but the last.
fn row(points: &EvaluatedPoints, i: usize) -> [f64; 7] {
    let ([x, y, z], [gx, gy, gz]) = (points.positions[i], points.gradients[i]);
    [x, y, z, points.values[i], gx, gy, gz]
}

/// Writes all rows; `encode` appends a run of them.
fn rows(out: &mut dyn Write, count: usize, encode: impl Fn(&mut Vec<u8>, Range<usize>) + Sync) -> Result<()> {
    for start in (0..count).step_by(GROUP) {
        let runs = (start..count.min(start + GROUP)).into_par_iter().step_by(RUN);
        let encoded: Vec<Vec<u8>> = runs
            .map(|first| {
                let mut run = Vec::with_capacity(64 * RUN);
                encode(&mut run, first..count.min(first + RUN));
                run
            })
            .collect();
        for run in encoded {
            out.write_all(&run)?;
        }
    }
    Ok(())
}

pub(super) fn csv(out: &mut dyn Write, points: &EvaluatedPoints) -> Result<()> {
    writeln!(out, "{}", NAMES.join(","))?;
    rows(out, points.positions.len(), |run, range| {
        let mut digits = zmij::Buffer::new();
        for i in range {
            for number in row(points, i) {
                run.extend_from_slice(digits.format(number).as_bytes());
                run.push(b',');
            }
            run.extend_from_slice(if points.inside[i] { b"1\n" } else { b"0\n" });
        }
    })
}

pub(super) fn ply(out: &mut dyn Write, points: &EvaluatedPoints) -> Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0\ncomment generator zeroset {}", env!("CARGO_PKG_VERSION"))?;
    if let Some(crs) = &points.crs {
        writeln!(out, "comment crs {}", one_line(crs))?;
    }
    writeln!(out, "element vertex {}", points.positions.len())?;
    for name in &NAMES[..7] {
        writeln!(out, "property double {name}")?;
    }
    writeln!(out, "property uchar {}\nend_header", NAMES[7])?;
    rows(out, points.positions.len(), |run, range| {
        for i in range {
            run.extend(row(points, i).iter().flat_map(|number| number.to_le_bytes()));
            run.push(u8::from(points.inside[i]));
        }
    })
}

pub(super) fn npy(out: &mut dyn Write, points: &EvaluatedPoints) -> Result<()> {
    out.write_all(&npy::header(points.positions.len(), NAMES.len()))?;
    rows(out, points.positions.len(), |run, range| {
        for i in range {
            run.extend(row(points, i).iter().flat_map(|number| number.to_le_bytes()));
            run.extend_from_slice(&f64::from(u8::from(points.inside[i])).to_le_bytes());
        }
    })
}
