//! How well a mesh agrees with the truth.
//!
//! # What
//! Both surfaces are sampled by area. For each sample the exact closest point of the other surface is found; distances
//! and normals of these pairs, both ways, make the figures.
//!
//! # Definitions
//! - *Distances*: mean, root of the mean square, 95th percentile and maximum of the samples' distances, from the mesh
//!   to the truth, from the truth to the mesh, and combined: mean and RMS average the two ways with equal weight, the
//!   percentile is that of all samples together, the maximum the larger one.
//! - *Precision*: share of the mesh's samples within tau of the truth. *Recall*: share of the truth's within tau of the
//!   mesh. *F-score*: their harmonic mean.
//! - *Normal consistency*: mean |m . n| over the pairs of one way, averaged over the two ways; m and n are the unit
//!   normals of the two triangles.
//! - *Orientation*: share of the mesh's samples with m . n > 0.
//! - *Near edges*: the same figures over the samples within `edge_band` of the truth's creases.
//! - *Crease distance*: distances to the mesh of points spread evenly by length over the truth's creases.
//! - *Occupancy*: share of uniform random points of the truth's box, its sides made a tenth longer around its middle,
//!   at which mesh and truth agree whether the winding number is over 1/2.
//!
//! # Cost
//! Two searches a sample at a microsecond or two, and building both trees: about a second for 300,000 samples a side.
//!
//! # Guaranteed
//! The same seed gives the same report, bit for bit, on any number of threads. Mesh and truth may carry different world
//! offsets: both are compared in the truth's local frame.
//!
//! # Not guaranteed
//! Figures vary with the seed as an average of so many samples does; maxima vary most, and a feature smaller than the
//! spacing of the samples can be missed by them. On a sheet thinner than the error, the closest point may lie on the
//! other side, which shows as wrong orientation.
//!
//! # Source
//! Two-way sampled distances: Cignoni, Rocchini and Scopigno, "Metro", 1998. F-score of surfaces: Knapitsch, Park, Zhou
//! and Koltun, "Tanks and Temples", 2017.
//!
//! ```
//! use zeroset::mesh::{CompareParams, compare};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let truth = Scene::new(SceneKind::Box, 0).truth;
//! let mut lifted = truth.clone();
//! lifted.world_from_local[2] = 0.001;
//! let params = CompareParams { samples: 10_000, ..CompareParams::default() };
//! let report = compare(&lifted, &truth, &params, &()).unwrap();
//! assert!((report.overall.distances.combined.max - 0.001).abs() < 1e-12);
//! assert_eq!(report.overall.f_score, 1.0);
//! ```

use super::{Mesh, MeshError, SHARP_ANGLE, SelfIntersections, Topology, creases, intersections, topology};
use crate::monitor::{Cancelled, Monitor, Part, check};
use crate::sample::{Chance, SurfaceSamples, sample_surface};
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Samples that are searched between two looks at the monitor.
const CHUNK: usize = 1 << 12;
/// Points at which occupancy is tested.
const OCCUPANCY_POINTS: usize = 20_000;
/// Share of [`CompareParams::samples`] that are spread over the creases.
const CREASE_SHARE: f64 = 1.0 / 6.0;
/// Pairs of triangles that cut through each other that are listed, for each mesh.
const LISTED_PAIRS: usize = 20;
/// A winding number this close to 1/2 is computed again without expansions, whose error is at most 0.02 as a rule.
const DOUBTFUL: f64 = 0.2;

/// How to compare.
#[derive(Debug, Clone, PartialEq)]
pub struct CompareParams {
    /// Number of samples on each surface.
    pub samples: usize,
    /// The distance within which a sample counts as right, in the meshes' unit. `None`: 0.002 of the diagonal of the
    /// truth's box.
    pub tau: Option<f64>,
    /// The distance from a crease within which a sample counts as near it. `None`: 0.01 of the diagonal of the truth's
    /// box.
    pub edge_band: Option<f64>,
    /// The angle, in radians, from which an edge of the truth is a crease.
    pub sharp_angle: f64,
    /// Chooses the samples.
    pub seed: u64,
}

impl Default for CompareParams {
    fn default() -> Self {
        Self { samples: 300_000, tau: None, edge_band: None, sharp_angle: SHARP_ANGLE, seed: 0 }
    }
}

/// One of the two meshes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// The mesh that is examined.
    Mesh,
    /// What it should be.
    Truth,
}

impl std::fmt::Display for Role {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Mesh => "mesh",
            Self::Truth => "truth",
        })
    }
}

/// Why two meshes were not compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// A mesh without triangles, or whose triangles have no area.
    #[error("the {role} has no surface ({faces} triangles, no area): nothing to compare")]
    NoSurface {
        /// Which one.
        role: Role,
        /// Number of its triangles.
        faces: usize,
    },
    /// A mesh that can't be examined.
    #[error("the {role} is broken: {source}")]
    Broken {
        /// Which one.
        role: Role,
        /// What is wrong with it.
        source: MeshError,
    },
    /// A parameter that is zero, negative or not finite.
    #[error("{name} is {value}; it must be positive")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The monitor asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

/// Distances of many samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct OneWay {
    /// The mean.
    pub mean: f64,
    /// The root of the mean square.
    pub rms: f64,
    /// 95 % of the samples are no farther.
    pub p95: f64,
    /// The largest.
    pub max: f64,
}

/// Distances both ways, in the meshes' unit.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Distances {
    /// From samples of the mesh to the truth: large where the mesh has something that should not be.
    pub mesh_to_truth: OneWay,
    /// From samples of the truth to the mesh: large where something is missing.
    pub truth_to_mesh: OneWay,
    /// Both ways.
    pub combined: OneWay,
}

/// The figures of a set of samples.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Agreement {
    /// Number of samples on the mesh.
    pub mesh_samples: usize,
    /// Number of samples on the truth.
    pub truth_samples: usize,
    /// Distances both ways.
    pub distances: Distances,
    /// Share of the mesh's samples within tau.
    pub precision: f64,
    /// Share of the truth's samples within tau.
    pub recall: f64,
    /// Harmonic mean of precision and recall; 0 if both are.
    pub f_score: f64,
    /// Mean |m . n|.
    pub normal_consistency: f64,
    /// Share of the mesh's samples with m . n > 0.
    pub orientation: f64,
}

/// What [`compare`] finds. Lengths are in the meshes' unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CompareReport {
    /// The tau used.
    pub tau: f64,
    /// The edge band used.
    pub edge_band: f64,
    /// The diagonal of the truth's box.
    pub truth_diagonal: f64,
    /// Over all samples.
    pub overall: Agreement,
    /// Over the samples near the truth's creases; `None` if the truth has none, or either surface has no sample near
    /// them.
    pub near_edges: Option<Agreement>,
    /// From the truth's creases to the mesh; `None` if the truth has none.
    pub crease_distance: Option<OneWay>,
    /// Share of points whose inside or outside agrees; `None` unless both meshes are closed.
    pub occupancy: Option<f64>,
    /// How the mesh hangs together.
    pub mesh: Topology,
    /// How the truth hangs together.
    pub truth: Topology,
    /// Where the mesh cuts through itself; the first 20 pairs are listed.
    pub mesh_self_intersections: SelfIntersections,
    /// Where the truth cuts through itself; the first 20 pairs are listed.
    pub truth_self_intersections: SelfIntersections,
}

/// One of the meshes, made ready.
struct Side<'a> {
    mesh: Cow<'a, Mesh>,
    topology: Topology,
    tree: TriangleTree,
    samples: SurfaceSamples,
}

/// What was found for one sample.
#[derive(Clone, Copy)]
struct Pair {
    distance: f64,
    /// m . n; `None` if the closest triangle has no area.
    cosine: Option<f64>,
}

/// Compares a mesh with the truth.
///
/// # Errors
/// [`CompareError`] if a mesh has no surface or is broken, a parameter makes no sense, or the monitor asks to stop.
pub fn compare(
    mesh: &Mesh,
    truth: &Mesh,
    params: &CompareParams,
    monitor: &dyn Monitor,
) -> Result<CompareReport, CompareError> {
    let lengths = [("tau", params.tau), ("edge_band", params.edge_band)];
    let given = lengths.into_iter().filter_map(|(name, value)| Some((name, value?)));
    for (name, value) in given.chain([("samples", params.samples as f64), ("sharp_angle", params.sharp_angle)]) {
        if !(value > 0.0 && value.is_finite()) {
            return Err(CompareError::Parameter { name, value });
        }
    }
    monitor.stage("sampling both surfaces");
    let shift = vec3::sub(mesh.world_from_local, truth.world_from_local);
    let mesh = Side::new(moved(mesh, shift), Role::Mesh, params)?;
    check(monitor)?;
    let truth = Side::new(Cow::Borrowed(truth), Role::Truth, params)?;
    let diagonal = truth.topology.bounds.map_or(0.0, |[low, high]| vec3::distance(low, high));
    let tau = params.tau.unwrap_or(0.002 * diagonal);
    let edge_band = params.edge_band.unwrap_or(0.01 * diagonal);

    monitor.share(0.2);
    monitor.stage("measuring distances");
    let forth = mesh.pairs_with(&truth, monitor)?;
    monitor.share(0.4);
    let back = truth.pairs_with(&mesh, monitor)?;
    monitor.share(0.6);
    // A surface has samples, so there is always something to summarise.
    let no_surface = || CompareError::NoSurface { role: Role::Mesh, faces: mesh.mesh.triangles.len() };
    let overall = Agreement::of(&forth, &back, tau).ok_or_else(no_surface)?;

    monitor.stage("measuring at the creases");
    let segments = creases(&truth.mesh, params.sharp_angle)
        .map_err(|source| CompareError::Broken { role: Role::Truth, source })?;
    let crease_tree = TriangleTree::from_segments(&segments);
    let near = |side: &Side, pairs: &[Pair]| -> Vec<Pair> {
        let points = side.samples.points.par_iter().zip(pairs);
        points.filter(|(p, _)| crease_tree.closest_within(**p, edge_band).is_some()).map(|(_, pair)| *pair).collect()
    };
    let near_edges = Agreement::of(&near(&mesh, &forth), &near(&truth, &back), tau);
    let on_creases = spread(&segments, (params.samples as f64 * CREASE_SHARE).ceil() as usize);
    let crease_pairs = mesh.search(&on_creases, &|_, _| None, monitor)?;
    let crease_distance = OneWay::of(crease_pairs.iter().map(|p| p.distance).collect());
    monitor.share(0.8);

    monitor.stage("testing inside and outside");
    let occupancy = occupancy(&mesh, &truth, params.seed, monitor)?;
    monitor.share(0.9);

    monitor.stage("looking for self-intersections");
    let mesh_self_intersections = mesh.self_intersections(&Part::new(monitor, 0.9..0.95))?;
    let truth_self_intersections = truth.self_intersections(&Part::new(monitor, 0.95..1.0))?;
    monitor.share(1.0);
    Ok(CompareReport {
        tau,
        edge_band,
        truth_diagonal: diagonal,
        overall,
        near_edges,
        crease_distance,
        occupancy,
        mesh: mesh.topology,
        truth: truth.topology,
        mesh_self_intersections,
        truth_self_intersections,
    })
}

/// The mesh with its vertices moved.
fn moved(mesh: &Mesh, shift: Vec3) -> Cow<'_, Mesh> {
    if shift == [0.0; 3] {
        return Cow::Borrowed(mesh);
    }
    let vertices = mesh.vertices.iter().map(|&v| vec3::add(v, shift)).collect();
    Cow::Owned(Mesh { vertices, triangles: mesh.triangles.clone(), ..Mesh::default() })
}

impl<'a> Side<'a> {
    fn new(mesh: Cow<'a, Mesh>, role: Role, params: &CompareParams) -> Result<Self, CompareError> {
        let topology = topology(&mesh).map_err(|source| CompareError::Broken { role, source })?;
        // One seed would put the same random numbers on both surfaces.
        let seed = params.seed.wrapping_mul(2).wrapping_add(u64::from(role == Role::Truth));
        let Some(samples) = sample_surface(&mesh, params.samples, seed) else {
            return Err(CompareError::NoSurface { role, faces: mesh.triangles.len() });
        };
        let tree = TriangleTree::new(&mesh);
        Ok(Self { mesh, topology, tree, samples })
    }

    fn normal(&self, triangle: usize) -> Option<Vec3> {
        let [a, b, c] = self.mesh.triangles[triangle].map(|v| self.mesh.vertices[v as usize]);
        vec3::normalized(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))
    }

    fn self_intersections(&self, monitor: &dyn Monitor) -> Result<SelfIntersections, Cancelled> {
        intersections::with_tree(&self.mesh, &self.tree, LISTED_PAIRS, monitor)
    }

    /// Pairs this surface's samples with the closest points of another.
    fn pairs_with(&self, other: &Side, monitor: &dyn Monitor) -> Result<Vec<Pair>, Cancelled> {
        let cosine = |sample: usize, triangle: usize| {
            let own = self.normal(self.samples.triangles[sample] as usize)?;
            Some(vec3::dot(own, other.normal(triangle)?))
        };
        other.search(&self.samples.points, &cosine, monitor)
    }

    /// Closest points of this surface; `cosine` is told the numbers of point and triangle.
    fn search(
        &self,
        points: &[Vec3],
        cosine: &(dyn Fn(usize, usize) -> Option<f64> + Sync),
        monitor: &dyn Monitor,
    ) -> Result<Vec<Pair>, Cancelled> {
        let chunks = points.par_chunks(CHUNK).enumerate().map(|(chunk, points)| {
            check(monitor)?;
            let pairs = points.iter().enumerate().filter_map(|(i, &point)| {
                let closest = self.tree.closest(point)?;
                let cosine = cosine(chunk * CHUNK + i, closest.triangle);
                Some(Pair { distance: closest.distance_squared.sqrt(), cosine })
            });
            Ok(pairs.collect::<Vec<_>>())
        });
        Ok(chunks.collect::<Result<Vec<_>, Cancelled>>()?.concat())
    }
}

impl OneWay {
    /// `None` without distances.
    pub(super) fn of(mut distances: Vec<f64>) -> Option<Self> {
        let n = distances.len() as f64;
        let mean = distances.iter().sum::<f64>() / n;
        let rms = (distances.iter().map(|d| d * d).sum::<f64>() / n).sqrt();
        distances.sort_unstable_by(f64::total_cmp);
        let p95 = *distances.get((0.95 * n).ceil() as usize - usize::from(n > 0.0))?;
        Some(Self { mean, rms, p95, max: *distances.last()? })
    }
}

impl Agreement {
    /// `None` if either way has no pairs.
    fn of(forth: &[Pair], back: &[Pair], tau: f64) -> Option<Self> {
        let distances = |pairs: &[Pair]| pairs.iter().map(|p| p.distance).collect::<Vec<_>>();
        let mesh_to_truth = OneWay::of(distances(forth))?;
        let truth_to_mesh = OneWay::of(distances(back))?;
        let all = OneWay::of([distances(forth), distances(back)].concat())?;
        let combined = OneWay {
            mean: 0.5 * (mesh_to_truth.mean + truth_to_mesh.mean),
            rms: (0.5 * (mesh_to_truth.rms.powi(2) + truth_to_mesh.rms.powi(2))).sqrt(),
            ..all
        };
        let within = |pairs: &[Pair]| share(pairs.iter().map(|p| f64::from(p.distance <= tau)));
        let (precision, recall) = (within(forth), within(back));
        let consistency = |pairs: &[Pair]| share(pairs.iter().filter_map(|p| Some(p.cosine?.abs())));
        Some(Self {
            mesh_samples: forth.len(),
            truth_samples: back.len(),
            distances: Distances { mesh_to_truth, truth_to_mesh, combined },
            precision,
            recall,
            f_score: if precision + recall > 0.0 { 2.0 * precision * recall / (precision + recall) } else { 0.0 },
            normal_consistency: 0.5 * (consistency(forth) + consistency(back)),
            orientation: share(forth.iter().filter_map(|p| Some(f64::from(p.cosine? > 0.0)))),
        })
    }
}

/// The mean; 0 of nothing.
fn share(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// `n` points at equal steps along the segments laid end to end.
fn spread(segments: &[[Vec3; 2]], n: usize) -> Vec<Vec3> {
    let lengths: Vec<f64> = segments.iter().map(|[a, b]| vec3::distance(*a, *b)).collect();
    let step = lengths.iter().sum::<f64>() / n as f64;
    let (mut points, mut before) = (Vec::new(), 0.0);
    for ([a, b], length) in segments.iter().zip(lengths) {
        while length > 0.0 && points.len() < n && (points.len() as f64 + 0.5) * step <= before + length {
            let along = (points.len() as f64 + 0.5) * step - before;
            points.push(vec3::lerp(*a, *b, (along / length).clamp(0.0, 1.0)));
        }
        before += length;
    }
    points
}

/// The share of points at which both agree about inside; `None` unless both are closed.
fn occupancy(mesh: &Side, truth: &Side, seed: u64, monitor: &dyn Monitor) -> Result<Option<f64>, Cancelled> {
    let Some([low, high]) = truth.topology.bounds.filter(|_| mesh.topology.closed && truth.topology.closed) else {
        return Ok(None);
    };
    let mut chance = Chance::new(seed, 7, 0);
    let mut points = vec![[0.0; 3]; OCCUPANCY_POINTS];
    for point in &mut points {
        *point = std::array::from_fn(|a| low[a] + (chance.between(-0.05, 1.05)) * (high[a] - low[a]));
    }
    let inside = |side: &Side, q: Vec3| {
        let winding = side.tree.winding_number(q).value;
        let doubtful = (winding - 0.5).abs() < DOUBTFUL;
        (if doubtful { side.tree.winding_number_exact(q) } else { winding }) > 0.5
    };
    let agreeing = points.par_chunks(256).map(|chunk| {
        check(monitor)?;
        Ok(chunk.iter().filter(|q| inside(mesh, **q) == inside(truth, **q)).count())
    });
    let agreeing: usize = agreeing.collect::<Result<Vec<_>, Cancelled>>()?.into_iter().sum();
    Ok(Some(agreeing as f64 / OCCUPANCY_POINTS as f64))
}
