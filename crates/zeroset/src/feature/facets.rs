//! The polygons of planes as triangles that can be asked what is near.

use rayon::prelude::*;

use super::{Features, Plane, triangulate};
use crate::mesh::Mesh;
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// A plane: the positions x with `normal . x = offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Flat {
    /// Unit normal, which points outward.
    pub(crate) normal: Vec3,
    pub(crate) offset: f64,
}

impl Flat {
    /// The plane with a normal through a position.
    pub(crate) fn through(normal: Vec3, position: Vec3) -> Self {
        Self { normal, offset: vec3::dot(normal, position) }
    }

    /// Distance of a position, positive on the side of the normal.
    pub(crate) fn distance(&self, p: Vec3) -> f64 {
        vec3::dot(self.normal, p) - self.offset
    }

    /// The position of the plane that is nearest to another.
    pub(crate) fn foot(&self, p: Vec3) -> Vec3 {
        vec3::add_scaled(p, self.normal, -self.distance(p))
    }
}

/// The planes of some features, with the polygons of those that know their outer side.
#[derive(Debug)]
pub(crate) struct Facets {
    /// In the order of the features.
    pub(crate) flats: Vec<Flat>,
    /// Corners of the polygons' triangles.
    triangles: Vec<[Vec3; 3]>,
    /// The plane of each triangle.
    plane_of: Vec<u32>,
    /// How many of the triangles are those of features.
    of_features: usize,
    tree: TriangleTree,
}

fn of_feature(plane: &Plane) -> Flat {
    Flat { normal: plane.normal, offset: plane.offset }
}

/// A polygon near a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct NearFacet {
    /// Index of its plane among [`Facets::flats`].
    pub(crate) plane: u32,
    /// Squared distance to the polygon.
    pub(crate) distance_squared: f64,
}

/// Triangles of a plane that is no feature, or of one that the caller knows better.
#[derive(Debug, Clone)]
pub(crate) struct Patch {
    /// Its plane; the normal points outward.
    pub(crate) flat: Flat,
    pub(crate) triangles: Vec<[Vec3; 3]>,
    /// The feature that lies in the same plane, if there is one.
    pub(crate) feature: Option<u32>,
}

impl Facets {
    /// The facets of some features.
    pub(crate) fn new(features: &Features) -> Self {
        Self::with_patches(features, &[])
    }

    /// The same with patches, whose planes come after those of the features; a feature moves to the plane of its patch.
    pub(crate) fn with_patches(features: &Features, patches: &[Patch]) -> Self {
        let mut flats: Vec<Flat> = features.planes.iter().map(of_feature).collect();
        let parts: Vec<Vec<[Vec3; 3]>> = features
            .planes
            .par_iter()
            .map(|plane| {
                if !plane.oriented {
                    return Vec::new();
                }
                let corners: Vec<Vec3> = plane.rings.concat();
                triangulate(plane).into_iter().map(|t| t.map(|corner| corners[corner])).collect()
            })
            .collect();
        let mut plane_of: Vec<u32> =
            parts.iter().enumerate().flat_map(|(p, part)| part.iter().map(move |_| p as u32)).collect();
        let mut triangles: Vec<[Vec3; 3]> = parts.concat();
        for patch in patches {
            let plane = patch.feature.unwrap_or(flats.len() as u32);
            match flats.get_mut(plane as usize) {
                Some(flat) => *flat = patch.flat,
                None => flats.push(patch.flat),
            }
            plane_of.extend(patch.triangles.iter().map(|_| plane));
            triangles.extend(&patch.triangles);
        }
        let of_features = parts.iter().map(Vec::len).sum();
        for (corners, &plane) in triangles.iter_mut().zip(&plane_of).take(of_features) {
            let flat: &Flat = &flats[plane as usize];
            if *flat != of_feature(&features.planes[plane as usize]) {
                *corners = corners.map(|corner| flat.foot(corner));
            }
        }
        Self { of_features, ..Self::of(flats, triangles, plane_of) }
    }

    /// Facets from planes, triangles, and the plane of each triangle.
    pub(crate) fn of(flats: Vec<Flat>, triangles: Vec<[Vec3; 3]>, plane_of: Vec<u32>) -> Self {
        let mesh = Mesh {
            vertices: triangles.as_flattened().to_vec(),
            triangles: (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect(),
            ..Mesh::default()
        };
        Self { flats, of_features: triangles.len(), triangles, plane_of, tree: TriangleTree::new(&mesh) }
    }

    /// The triangles, with the plane of each.
    pub(crate) fn triangles(&self) -> (&[[Vec3; 3]], &[u32]) {
        (&self.triangles, &self.plane_of)
    }

    /// The triangles of the features' polygons with their outward normals; those of patches are left out.
    pub(crate) fn oriented_triangles(&self) -> impl Iterator<Item = ([Vec3; 3], Vec3)> + '_ {
        let own = self.triangles.iter().zip(&self.plane_of).take(self.of_features);
        own.map(|(corners, &plane)| (*corners, self.flats[plane as usize].normal))
    }

    /// Fills `found` with the polygons within a distance, each plane once, by plane.
    pub(crate) fn near(&self, p: Vec3, radius: f64, found: &mut Vec<NearFacet>) {
        found.clear();
        self.tree.visit_within(p, radius, |triangle, distance_squared| {
            let plane = self.plane_of[triangle];
            match found.iter_mut().find(|facet| facet.plane == plane) {
                Some(facet) => facet.distance_squared = facet.distance_squared.min(distance_squared),
                None => found.push(NearFacet { plane, distance_squared }),
            }
        });
        found.sort_unstable_by_key(|facet| facet.plane);
    }
}
