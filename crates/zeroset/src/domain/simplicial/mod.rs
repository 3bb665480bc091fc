//! Conforming meshes of triangles in the plane and of tetrahedra in space, for the small exact fit.
//!
//! # What
//! A [`SimplicialMesh`] covers a region by simplices that meet in whole faces only. It is given, or made: a regular lattice, the
//! Delaunay mesh of sites, or a square cut into four triangles.
//!
//! ```
//! use zeroset::domain::SimplicialMesh;
//! let mesh = SimplicialMesh::<2>::lattice([0.0, 0.0], [2.0, 1.0], [4, 2])?;
//! let place = mesh.locate([0.7, 0.2]).expect("the point lies in the mesh");
//! assert!((mesh.position(place.simplex, &place.barycentric)[0] - 0.7).abs() < 1e-15);
//! # Ok::<(), zeroset::domain::DomainError>(())
//! ```
//!
//! # Guaranteed
//! A mesh that is given was examined with exact predicates: no simplex is degenerate, no two overlap, faces are shared whole, and
//! every vertex is used. What is made is so by construction. Simplices are positively oriented (two corners of a simplex given
//! otherwise are swapped). A point in the mesh is never lost between two simplices; one on a shared face, up to rounding, belongs
//! to the simplex of lowest index. The pieces of a segment or triangle sum to what of it lies in the mesh.
//!
//! # Not guaranteed
//! Delaunay meshes in space can have very flat tetrahedra, most of all where sites lie on one plane or sphere but for rounding.
//! Their gradients are huge, and so flat a tetrahedron has barycentric coordinates with few digits.
//!
//! # Cost
//! n log n in the number of simplices in practice. Where very many simplices share a vertex, finding a point near it and examining
//! them is slower: linear and quadratic in their number. A segment costs as many steps as it crosses simplices, and a triangle at
//! worst the square of that.
//!
//! # Source
//! Shewchuk 1997 (predicates); Bowyer 1981, Watson 1981 (Delaunay meshes in space); Freudenthal 1942 (lattices).

mod adjacency;
mod bowyer_watson;
mod buckets;
mod check;
mod clip;
mod delaunay;
mod locate;
mod made;
mod predicates;

#[cfg(test)]
mod tests;

pub(crate) use clip::polygon_area;
pub use clip::{FacetPiece, SegmentPiece};

use adjacency::Adjacency;
use buckets::Locator;

/// Barycentric coordinates in a triangle (the first three) or a tetrahedron (all four). Unused entries are zero.
pub type Barycentric = [f64; 4];

/// A position, and the simplex that holds it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place<const D: usize> {
    /// Index of the simplex.
    pub simplex: usize,
    /// Weights of its corners. They sum to 1; on the rim of the mesh one can be negative by rounding.
    pub barycentric: Barycentric,
    /// The position.
    pub position: [f64; D],
}

/// A mesh that cannot serve as a domain.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DomainError {
    /// There are no simplices.
    #[error("the domain has no cells; give at least one triangle or tetrahedron")]
    Empty,
    /// A coordinate is infinite or not a number.
    #[error("vertex {vertex} of the domain is not finite; correct its coordinates")]
    NotFinite {
        /// The vertex.
        vertex: usize,
    },
    /// A coordinate is too large or too small for exact predicates.
    #[error(
        "coordinate {coordinate:e} of vertex {vertex} of the domain is neither 0 nor between {least:e} and {most:e} in magnitude; scale the mesh and the data, or round the coordinate to 0"
    )]
    OutOfRange {
        /// The vertex.
        vertex: usize,
        /// Its coordinate.
        coordinate: f64,
        /// Least magnitude that is not zero.
        least: f64,
        /// Most magnitude.
        most: f64,
    },
    /// A vertex belongs to no simplex.
    #[error("vertex {vertex} of the domain belongs to no cell; remove it")]
    VertexUnused {
        /// The vertex.
        vertex: usize,
    },
    /// A simplex names a vertex that is not there.
    #[error("cell {simplex} of the domain names vertex {vertex}, but there are only {count} vertices")]
    VertexMissing {
        /// The simplex.
        simplex: usize,
        /// The vertex that it names.
        vertex: u32,
        /// Number of vertices.
        count: usize,
    },
    /// The corners of a simplex lie in one line or plane.
    #[error("cell {simplex} of the domain is degenerate: its corners {corners:?} do not span it; remove the cell")]
    Degenerate {
        /// The simplex.
        simplex: usize,
        /// Its corners.
        corners: Vec<u32>,
    },
    /// Two simplices overlap.
    #[error("cells {simplices:?} of the domain overlap; remove one of them")]
    Overlap {
        /// The two simplices.
        simplices: [usize; 2],
    },
    /// A face of one simplex meets another simplex, but is no face of it.
    #[error(
        "cells {simplices:?} of the domain meet in part of a face; split the larger one so that faces are shared whole"
    )]
    HangingFace {
        /// The two simplices.
        simplices: [usize; 2],
    },
    /// Sites that no simplex can be made of.
    #[error("{count} sites span no cells; give at least {least} that do not lie in one line or plane")]
    TooFewSites {
        /// Number of different sites.
        count: usize,
        /// Least number needed.
        least: usize,
    },
    /// A box without extent, or without cells.
    #[error(
        "a lattice of {cells:?} cells from {low:?} to {high:?} is not possible: high must exceed low, with at least one cell along each axis and at most {most} cells in all"
    )]
    Lattice {
        /// Lower corner.
        low: Vec<f64>,
        /// Upper corner.
        high: Vec<f64>,
        /// Cells along each axis.
        cells: Vec<u32>,
        /// Most cells.
        most: usize,
    },
}

/// A conforming mesh of triangles (D = 2) or tetrahedra (D = 3).
#[derive(Debug, Clone)]
pub struct SimplicialMesh<const D: usize> {
    vertices: Vec<[f64; D]>,
    /// D + 1 vertices a simplex.
    corners: Vec<u32>,
    adjacency: Adjacency,
    locator: Locator<D>,
    /// For each simplex the gradients of its barycentric coordinates.
    gradients: Vec<[[f64; D]; 4]>,
    volumes: Vec<f64>,
}

impl SimplicialMesh<2> {
    /// A mesh of triangles.
    ///
    /// # Errors
    /// If a triangle is degenerate, two overlap, or an edge is not shared whole; the error names the offender.
    pub fn from_triangles(vertices: Vec<[f64; 2]>, triangles: &[[u32; 3]]) -> Result<Self, DomainError> {
        Self::examined(vertices, triangles.as_flattened().to_vec())
    }
}

impl SimplicialMesh<3> {
    /// A mesh of tetrahedra.
    ///
    /// # Errors
    /// If a tetrahedron is degenerate, two overlap, or a face is not shared whole; the error names the offender.
    pub fn from_tetrahedra(vertices: Vec<[f64; 3]>, tetrahedra: &[[u32; 4]]) -> Result<Self, DomainError> {
        Self::examined(vertices, tetrahedra.as_flattened().to_vec())
    }
}

impl<const D: usize> SimplicialMesh<D> {
    /// Corners of a simplex.
    pub const CORNERS: usize = D + 1;
    /// Edges of a simplex.
    pub const EDGES: usize = D * (D + 1) / 2;

    /// Orients and examines simplices, then builds the mesh.
    fn examined(vertices: Vec<[f64; D]>, mut corners: Vec<u32>) -> Result<Self, DomainError> {
        check::orient(&vertices, &mut corners)?;
        let mesh = Self::trusted(vertices, corners);
        check::conforming(&mesh)?;
        Ok(mesh)
    }

    /// Builds the mesh of simplices that are known to conform and to be positively oriented.
    fn trusted(vertices: Vec<[f64; D]>, corners: Vec<u32>) -> Self {
        const { assert!(D == 2 || D == 3, "meshes are of triangles or of tetrahedra") };
        let adjacency = Adjacency::new(&corners, Self::CORNERS);
        let (gradients, volumes): (Vec<_>, _) =
            corners.chunks_exact(Self::CORNERS).map(|simplex| barycentric_gradients(&vertices, simplex)).unzip();
        let locator = Locator::new(&vertices, &corners, &gradients);
        Self { vertices, corners, adjacency, locator, gradients, volumes }
    }

    /// Positions of the vertices.
    #[must_use]
    pub fn vertices(&self) -> &[[f64; D]] {
        &self.vertices
    }

    /// Number of simplices.
    #[must_use]
    #[allow(clippy::len_without_is_empty, reason = "a mesh without simplices cannot be made")]
    pub fn len(&self) -> usize {
        self.volumes.len()
    }

    /// The D + 1 vertices of a simplex, positively oriented.
    #[must_use]
    pub fn simplex(&self, simplex: usize) -> &[u32] {
        &self.corners[simplex * Self::CORNERS..][..Self::CORNERS]
    }

    /// All edges, each with its lower vertex first, in ascending order.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.adjacency.edges
    }

    /// The edges of a simplex, as indices into [`Self::edges`]. Local order: corners 01, 02, 12 in a triangle; 01, 02, 03, 12, 13, 23
    /// in a tetrahedron.
    #[must_use]
    pub fn edges_of(&self, simplex: usize) -> &[u32] {
        &self.adjacency.edges_of[simplex * Self::EDGES..][..Self::EDGES]
    }

    /// The simplex across the face opposite to a corner; `None` on the rim.
    #[must_use]
    pub fn neighbor(&self, simplex: usize, corner: usize) -> Option<usize> {
        self.adjacency.neighbors[simplex * Self::CORNERS + corner].map(|n| n as usize)
    }

    /// Area of a triangle, volume of a tetrahedron.
    #[must_use]
    pub fn volume(&self, simplex: usize) -> f64 {
        self.volumes[simplex]
    }

    /// The gradients of the barycentric coordinates, one for each corner. Unused entries are zero.
    #[must_use]
    pub fn barycentric_gradients(&self, simplex: usize) -> &[[f64; D]; 4] {
        &self.gradients[simplex]
    }

    /// The barycentric coordinates of a position in a simplex, which need not hold it.
    #[must_use]
    pub fn barycentric(&self, simplex: usize, position: [f64; D]) -> Barycentric {
        // The corner nearest to the position is the origin: its own weight is what the others leave.
        let corners = self.simplex(simplex);
        let from = |c: usize| -> [f64; D] {
            let v = self.vertices[corners[c] as usize];
            std::array::from_fn(|a| position[a] - v[a])
        };
        let squared = |c: usize| from(c).iter().map(|d| d * d).sum::<f64>();
        let nearest = (1..Self::CORNERS).fold(0, |best, c| if squared(c) < squared(best) { c } else { best });
        let offset = from(nearest);
        let mut weights = [0.0; 4];
        let mut rest = 1.0;
        for c in (0..Self::CORNERS).filter(|&c| c != nearest) {
            weights[c] = (0..D).map(|a| self.gradients[simplex][c][a] * offset[a]).sum();
            rest -= weights[c];
        }
        weights[nearest] = rest;
        weights
    }

    /// The position of barycentric coordinates.
    #[must_use]
    pub fn position(&self, simplex: usize, barycentric: &Barycentric) -> [f64; D] {
        let corners = self.simplex(simplex);
        let origin = self.vertices[corners[0] as usize];
        let mut position = origin;
        for (c, &corner) in corners.iter().enumerate().skip(1) {
            for a in 0..D {
                position[a] += barycentric[c] * (self.vertices[corner as usize][a] - origin[a]);
            }
        }
        position
    }

    /// The vertices on the rim of the mesh, in ascending order.
    #[must_use]
    pub fn rim(&self) -> Vec<u32> {
        let mut on_rim = vec![false; self.vertices.len()];
        for simplex in 0..self.len() {
            for corner in (0..Self::CORNERS).filter(|&c| self.neighbor(simplex, c).is_none()) {
                for (c, &v) in self.simplex(simplex).iter().enumerate() {
                    on_rim[v as usize] |= c != corner;
                }
            }
        }
        (0..self.vertices.len() as u32).filter(|&v| on_rim[v as usize]).collect()
    }
}

/// The positions of the corners of a simplex; the last is unused in the plane.
fn positions<const D: usize>(vertices: &[[f64; D]], corners: &[u32]) -> [[f64; D]; 4] {
    std::array::from_fn(|c| corners.get(c).map_or([0.0; D], |&v| vertices[v as usize]))
}

/// The gradients of the barycentric coordinates of a simplex, and its volume.
fn barycentric_gradients<const D: usize>(vertices: &[[f64; D]], corners: &[u32]) -> ([[f64; D]; 4], f64) {
    let origin = vertices[corners[0] as usize];
    let side = |c: usize| -> [f64; D] {
        let v = vertices[corners[c] as usize];
        std::array::from_fn(|a| v[a] - origin[a])
    };
    let mut positions = [[0.0; D]; 4];
    for (position, &corner) in positions.iter_mut().zip(corners) {
        *position = vertices[corner as usize];
    }
    // Positive however flat the simplex is, which a plain sum of products would not be.
    let determinant = predicates::orientation(&positions[..=D]);
    let mut gradients = [[0.0; D]; 4];
    let mut set = |c: usize, values: &[f64]| {
        for (a, value) in values.iter().enumerate() {
            gradients[c][a] = *value;
            gradients[0][a] -= value;
        }
    };
    let volume = if D == 2 {
        let (u, v) = (side(1), side(2));
        set(1, &[v[1] / determinant, -v[0] / determinant]);
        set(2, &[-u[1] / determinant, u[0] / determinant]);
        determinant / 2.0
    } else {
        let sides = [side(1), side(2), side(3)].map(|s| [s[0], s[1], s[2]]);
        let normals: [_; 3] = std::array::from_fn(|k| crate::vec3::cross(sides[(k + 1) % 3], sides[(k + 2) % 3]));
        for (k, normal) in normals.into_iter().enumerate() {
            set(k + 1, &normal.map(|n| n / determinant));
        }
        determinant / 6.0
    };
    (gradients, volume)
}
