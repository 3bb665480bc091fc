//! Sharp and flat features straight from points: planes, edges, corners.
//!
//! # What
//! [`detect`] finds the planes of a cloud with their points and polygons, the edges in which they meet, the creases of curved surfaces, and
//! the corners, each with its kind: convex, concave or mixed. It takes positions only: no normals. [`newe`] is the small exact tool
//! of the same task: several flats at once through a handful of points, in any dimension. [`compare_features`] holds what was found
//! against a truth.
//!
//! # How
//! 1. *F* is fitted as for a mesh, with cells of 1.5 spacings. It tells inside from outside, and no more.
//! 2. *Around each point* the plane of least squares through 16 neighbours, more where the noise is over a quarter of the spacing, gives
//!    a direction and how flat it is there (`surroundings`).
//! 3. *Regions* grow from the flattest seeds over neighbours within three deviations of the noise of a running plane (`planes::regions`). What is
//!    left over in small groups bears faces of a few points; NEWE finds their one to four flats (`planes::leftovers`).
//! 4. *Settling*: points are given to regions, and planes fitted to points by their probabilities near edges, in turn (`planes::settle`). Walls
//!    of terrain stand and flats lie unless their points contradict ([`Posture`]).
//! 5. *Flat or not*: a region that a quadric explains as well, together with the surface around it, is a part of something round; one whose
//!    neighbours belong to nothing is clutter; beside what is round, less evidence suffices (`planes::flatness`).
//! 6. *Walls that were hardly scanned* stand under the straight rims of roofs beyond which the surface drops (`planes::walls`).
//! 7. *Edges* are the parts of the lines of two planes beside which both have points (`sharp::straight`); *creases* with a curved side are found point
//!    by point and joined (`sharp::creases`); *corners* are where three planes or more meet at the ends of edges (`sharp::corners`), and where
//!    other ends come together (`sharp::joints`).
//! 8. *Polygons* are the outlines of the regions, drawn out to edges and corners (`planes::polygons`, `planes::outline`).
//!
//! # Cost
//! O(n log n). A city of 100,000 points takes 1.3 CPU seconds, half of it the fit; 849 thousand airborne points of a real town 11, in 0.4 GB.
//!
//! # Guaranteed
//! - The same result on any number of threads, from run to run, and in whatever order the points come.
//! - Indices name what is there; a plane's rings lie in it, up to rounding, and do not cross.
//!
//! # Not guaranteed
//! - Motion and scale change the result within the noise: a decision that hangs on a hair may fall the other way.
//! - A face of fewer than 15 points, or narrower than about three spacings, is mostly missed. Sheets nearer to each other than two and a
//!   half spacings mix: their planes come in pieces.
//! - With noise of half the spacing, faces of fewer than some 60 points and rims of holes that are a few noises wide are missed in part, and
//!   strips of narrow cylinders are taken for planes. Noise over half of the spacing is not made up for.
//! - Limits of area are held against the points of a region, each worth the square of the spacing; its polygon may have a little less.
//! - Coplanar faces that come nearer than two spacings to each other are one plane, with several rings.
//! - Walls that were inferred stand under the rim of the roof: eaves that overhang shift them.
//!
//! # Source
//! G. M. Nielson, "Techniques for extracting and modeling geometric features from point cloud data sets with application to urban terrain
//! modeling", 3AI 2013, for NEWE and for the aim. Region growing: Vosselman et al. 2004. The sources of single steps are on their pages.
//! Measured figures are in `docs/methods/features.md`.
//!
//! ```
//! use zeroset::feature::{FeatureKind, FeatureParams, detect};
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let cloud = Scene::new(SceneKind::Box, 0).points(20_000, 0.001, 0);
//! let (features, report) = detect(&cloud, &FeatureParams::default(), &())?;
//! assert_eq!((features.planes.len(), features.edges.len(), features.corners.len()), (6, 12, 8));
//! assert!(features.edges.iter().all(|edge| edge.kind == FeatureKind::Convex));
//! assert!(report.plane_rms < Some(0.0011));
//! # Ok::<(), zeroset::feature::FeatureError>(())
//! ```

mod assemble;
mod compare;
mod detect;
mod facets;
mod model;
mod moments;
pub mod newe;
mod params;
mod planes;
mod prepare;
mod sharp;
mod surroundings;
mod triangulate;

pub use compare::{
    CompareFeaturesError, CompareFeaturesParams, CompareFeaturesReport, CornerAgreement, EdgeAgreement, ErrorSummary,
    FaceRecall, PlaneAgreement, compare_features,
};
pub use detect::detect;
pub(crate) use detect::detect_with;
pub(crate) use facets::{Facets, Flat, NearFacet, Patch};
pub use model::{Corner, Edge, FeatureClass, FeatureKind, Features, Plane, PointFeature};
pub use params::{FeatureError, FeatureParams, FeatureReport, FeatureSeconds, Posture};
pub(crate) use prepare::farthest_from_planes;
pub use triangulate::triangulate;
