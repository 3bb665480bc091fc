//! The JSON report of a search for features.
//!
//! Its names do not change within a `schema_version`; new ones may come. Lengths are in the unit of the input.

use serde::Serialize;
use zeroset::feature::{FeatureKind, FeatureParams, FeatureReport, Features};

use crate::args::FeaturesArgs;
use crate::input::{Input, Origin, up};
use crate::memory;
use crate::table::name;

/// Wall seconds of each stage.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Seconds {
    /// Reading and decoding.
    pub(super) read: f64,
    /// Leaving out points.
    pub(super) select: f64,
    /// Finding features.
    pub(super) detect: f64,
    /// Writing all outputs.
    pub(super) write: f64,
    /// From the start to the end of writing.
    pub(super) total: f64,
}

/// A file that was written.
#[derive(Debug, Clone, Serialize)]
pub(super) struct OutputReport {
    pub(super) path: String,
    pub(super) format: &'static str,
    pub(super) bytes: u64,
}

/// How many of each kind.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
pub(super) struct Kinds {
    pub(super) all: usize,
    pub(super) convex: usize,
    pub(super) concave: usize,
    pub(super) mixed: usize,
    pub(super) unknown: usize,
}

impl Kinds {
    pub(super) fn of(kinds: impl Iterator<Item = FeatureKind> + Clone) -> Self {
        let count = |wanted| kinds.clone().filter(|kind| *kind == wanted).count();
        Self {
            all: kinds.clone().count(),
            convex: count(FeatureKind::Convex),
            concave: count(FeatureKind::Concave),
            mixed: count(FeatureKind::Mixed),
            unknown: count(FeatureKind::Unknown),
        }
    }
}

#[derive(Debug, Serialize)]
struct Counts {
    planes: usize,
    oriented_planes: usize,
    edges: Kinds,
    corners: Kinds,
}

/// The whole report.
#[derive(Debug, Serialize)]
pub(super) struct Report<'a> {
    #[serde(flatten)]
    origin: Origin<'a>,
    up: String,
    counts: Counts,
    detection: &'a FeatureReport,
    outputs: Vec<OutputReport>,
    seconds: Seconds,
    threads: usize,
    memory_limit_bytes: u64,
    memory_peak_bytes: Option<u64>,
}

impl<'a> Report<'a> {
    pub(super) fn new(
        input: &'a Input,
        features: &Features,
        detection: &'a FeatureReport,
        args: &FeaturesArgs,
        params: &FeatureParams,
        outputs: Vec<OutputReport>,
        seconds: Seconds,
    ) -> Self {
        Self {
            origin: Origin::of(input),
            up: name(up(&args.scene)),
            counts: Counts {
                planes: features.planes.len(),
                oriented_planes: features.planes.iter().filter(|plane| plane.oriented).count(),
                edges: Kinds::of(features.edges.iter().map(|edge| edge.kind)),
                corners: Kinds::of(features.corners.iter().map(|corner| corner.kind)),
            },
            detection,
            outputs,
            seconds,
            threads: rayon::current_num_threads(),
            memory_limit_bytes: params.memory,
            memory_peak_bytes: memory::peak(),
        }
    }
}
