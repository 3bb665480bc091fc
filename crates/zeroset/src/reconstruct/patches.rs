//! The user's polygons among the planes that were found.

use rayon::prelude::*;

use crate::constraint::{Local, LocalPolygon};
use crate::feature::{Facets, Features, Flat, Patch};
use crate::vec3::{self, Vec3};

/// Polygons smaller than this, in square cells, act on F only: facets of a curved surface are no planes of their own.
const LEAST_AREA: f64 = 4.0;
/// A plane that was found is the user's if the normals agree within this cosine, 10 degrees,
const ALIKE: f64 = 0.985;
/// and if the corners of both lie within so many cells of the user's plane.
const APART: f64 = 0.5;
/// A plane within so many cells of the user's polygon, along it, can be the same one.
const REACH: f64 = 1.7;

/// The polygons that count as planes, each with the plane that was found in its place. `gradient` is that of F, in the coordinates of the cloud, and
/// tells the outer side; a polygon where F has none is no plane of the surface.
pub(super) fn patches(
    features: &Features,
    known: &Local,
    cell: f64,
    gradient: impl Fn(Vec3) -> Option<Vec3> + Sync,
) -> Vec<Patch> {
    if known.polygons.is_empty() {
        return Vec::new();
    }
    let found = Facets::new(features);
    let mut patches: Vec<Patch> = known
        .polygons
        .par_iter()
        .filter(|polygon| polygon.area >= LEAST_AREA * cell * cell)
        .filter_map(|polygon| {
            let (flat, samples) = oriented(polygon, cell, &gradient)?;
            let feature = same_plane(features, &found, &flat, &samples, cell);
            Some(Patch { flat, triangles: polygon.triangles.clone(), feature })
        })
        .collect();
    // One patch for each plane that was found; further ones are planes of their own, nearly the same.
    let mut taken = vec![false; features.planes.len()];
    for patch in &mut patches {
        patch.feature = patch.feature.filter(|&plane| !std::mem::replace(&mut taken[plane as usize], true));
    }
    patches
}

/// The plane of a polygon with its normal turned outward, and positions on it.
fn oriented(polygon: &LocalPolygon, cell: f64, gradient: impl Fn(Vec3) -> Option<Vec3>) -> Option<(Flat, Vec<Vec3>)> {
    let one = Local { polygons: vec![polygon.clone()], ..Local::default() };
    let samples = one.samples(cell);
    let side: f64 = samples.iter().filter_map(|&p| Some(vec3::dot(gradient(p)?, polygon.normal).signum())).sum();
    let normal = vec3::scale(polygon.normal, 1.0_f64.copysign(side));
    let corners = polygon.triangles.as_flattened();
    let middle = vec3::scale(corners.iter().fold([0.0; 3], |sum, &p| vec3::add(sum, p)), 1.0 / corners.len() as f64);
    (side != 0.0).then(|| (Flat::through(normal, middle), samples))
}

/// The plane that was found where most of a polygon lies, if both are one plane.
fn same_plane(features: &Features, found: &Facets, flat: &Flat, samples: &[Vec3], cell: f64) -> Option<u32> {
    let mut hits = vec![0_usize; found.flats.len()];
    let mut near = Vec::new();
    for &p in samples {
        found.near(p, REACH * cell, &mut near);
        near.iter().for_each(|facet| hits[facet.plane as usize] += 1);
    }
    let is_same = |plane: &usize| {
        let other = &found.flats[*plane];
        let corners = features.planes[*plane].rings.iter().flatten();
        vec3::dot(other.normal, flat.normal) > ALIKE
            && samples.iter().all(|&p| other.distance(p).abs() < APART * cell)
            && corners.into_iter().all(|&p| flat.distance(p).abs() < APART * cell)
    };
    let most = (0..hits.len())
        .filter(|&plane| hits[plane] > 0 && is_same(&plane))
        .max_by_key(|&plane| (hits[plane], usize::MAX - plane));
    most.map(|plane| plane as u32)
}

/// Gives points of no plane that lie beside a patch to its plane. Patches begin at plane `first`.
pub(super) fn join(plane_of: &mut [Option<u32>], facets: &Facets, first: u32, points: &[Vec3], reach: f64) {
    plane_of.par_iter_mut().zip(points).filter(|(plane, _)| plane.is_none()).for_each_init(
        Vec::new,
        |near, (plane, &p)| {
            facets.near(p, reach, near);
            let own = near.iter().filter(|facet| facet.plane >= first);
            *plane = own.min_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared)).map(|facet| facet.plane);
        },
    );
}
