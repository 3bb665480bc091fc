//! Delaunay meshes of given sites.

use super::predicates::in_range;
use super::{DomainError, SimplicialMesh, bowyer_watson};
use rustc_hash::FxHashSet;
use spade::{DelaunayTriangulation, Point2, Triangulation};

impl SimplicialMesh<2> {
    /// The Delaunay mesh of sites in the plane. Its vertices are the different sites in order of first appearance: a site that
    /// repeats another, bit for bit, is left out.
    ///
    /// # Errors
    /// If fewer than three sites differ, or all lie in one line; if a coordinate is not finite, or too large or small for exact
    /// predicates.
    pub fn delaunay(sites: &[[f64; 2]]) -> Result<Self, DomainError> {
        let vertices = distinct(sites)?;
        let too_few = DomainError::TooFewSites { count: vertices.len(), least: 3 };
        if vertices.len() < 3 {
            return Err(too_few);
        }
        let points = vertices.iter().map(|&[x, y]| Point2::new(x, y)).collect();
        let Ok(triangulation) = DelaunayTriangulation::<Point2<f64>>::bulk_load_stable(points) else {
            unreachable!("coordinates are in the range that is allowed");
        };
        let corners: Vec<u32> =
            triangulation.inner_faces().flat_map(|face| face.vertices().map(|v| v.fix().index() as u32)).collect();
        if corners.is_empty() { Err(too_few) } else { Ok(Self::trusted(vertices, corners)) }
    }
}

impl SimplicialMesh<3> {
    /// The Delaunay mesh of sites in space. Its vertices are the different sites in order of first appearance: a site that
    /// repeats another, bit for bit, is left out. No site lies inside the sphere around a tetrahedron; where more than four lie on
    /// one, as in a lattice, any of their meshes can come out, but always the same one.
    ///
    /// # Errors
    /// If fewer than four sites differ, or all lie in one plane; if a coordinate is not finite, or too large or small for exact
    /// predicates.
    pub fn delaunay(sites: &[[f64; 3]]) -> Result<Self, DomainError> {
        let vertices = distinct(sites)?;
        match bowyer_watson::tetrahedra(&vertices) {
            Some(corners) => Ok(Self::trusted(vertices, corners)),
            None => Err(DomainError::TooFewSites { count: vertices.len(), least: 4 }),
        }
    }
}

/// The different sites in order of first appearance.
fn distinct<const D: usize>(sites: &[[f64; D]]) -> Result<Vec<[f64; D]>, DomainError> {
    in_range(sites)?;
    let mut seen = FxHashSet::default();
    // The sum turns -0 to 0.
    Ok(sites.iter().filter(|site| seen.insert(site.map(|c| (c + 0.0).to_bits()))).copied().collect())
}
