//! What F is to vanish on: points, lines and facets, each with a weight.
//!
//! A point weighs as much as its weight says; a line weighs its weight for each unit of length, a facet for each unit of area. Lines and
//! facets are cut at the faces of the domain, and in each piece F^2 is integrated by a rule that is exact for it. So every datum becomes
//! a list of weighted samples, and the problem keeps its form.

mod polygon;

pub use polygon::PolygonError;
pub(crate) use polygon::{Triangulated, triangulate_polygon};

use crate::basis::Basis;
use crate::basis::quadrature::rule;
use crate::domain::{Place, SimplicialMesh, polygon_area};

/// What kind of thing a datum is.
#[derive(Debug, Clone, PartialEq)]
enum Shape<const D: usize> {
    Point([f64; D]),
    /// Segments one after the other, through these positions.
    Line(Vec<[f64; D]>),
    /// Triangles.
    Facet(Vec<[[f64; D]; 3]>),
}

/// One datum.
#[derive(Debug, Clone, PartialEq)]
struct Datum<const D: usize> {
    shape: Shape<D>,
    weight: f64,
}

/// Data that serve no fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum DataError {
    /// There are none.
    #[error("there are no data; give points, segments, polygons or triangles")]
    Empty,
    /// A weight is not a positive number.
    #[error("datum {datum} has the weight {weight}; weights must be positive, and finite times the length or area")]
    Weight {
        /// Which datum, counted from 0 in the order in which they were added.
        datum: usize,
        /// Its weight.
        weight: f64,
    },
    /// A coordinate is infinite or not a number.
    #[error("datum {datum} has a coordinate that is not finite; correct or leave it out")]
    NotFinite {
        /// Which datum.
        datum: usize,
    },
    /// A line without length or a facet without area.
    #[error(
        "datum {datum} has no extent: its positions coincide or lie in one line; leave it out, or give a point instead"
    )]
    NoExtent {
        /// Which datum.
        datum: usize,
    },
    /// A part of a datum lies outside the domain.
    #[error(
        "datum {datum} leaves the domain: {inside} of {whole} lies inside; enlarge the domain or leave the datum out"
    )]
    Outside {
        /// Which datum.
        datum: usize,
        /// Its number, length or area inside.
        inside: f64,
        /// Its number, length or area.
        whole: f64,
    },
    /// A polygon that bounds no area.
    #[error("datum {datum}, a polygon, {why}")]
    Polygon {
        /// Which datum.
        datum: usize,
        /// What is wrong, and what to do.
        why: PolygonError,
    },
}

/// Points, lines and facets for one fit.
///
/// ```
/// use zeroset::fit::normalized::Data;
/// let mut data = Data::<2>::new();
/// data.points(&[[0.2, 0.3], [0.5, 0.4]], 1.0)?;
/// data.corner([[0.1, 0.9], [0.5, 0.8], [0.6, 0.1]], 4.0)?;
/// assert_eq!(data.len(), 3);
/// # Ok::<(), zeroset::fit::normalized::DataError>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Data<const D: usize> {
    data: Vec<Datum<D>>,
}

impl<const D: usize> Data<D> {
    /// No data yet.
    #[must_use]
    pub fn new() -> Self {
        Self { data: Vec::new() }
    }

    /// Number of data.
    #[must_use]
    pub fn len(&self) -> usize {
        self.data.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.data.is_empty()
    }

    fn push(&mut self, shape: Shape<D>, weight: f64) -> Result<(), DataError> {
        let datum = self.data.len();
        if !(weight.is_finite() && weight > 0.0) {
            return Err(DataError::Weight { datum, weight });
        }
        let finite = |positions: &[[f64; D]]| positions.as_flattened().iter().all(|c| c.is_finite());
        let (all_finite, extent) = match &shape {
            Shape::Point(p) => (finite(&[*p]), 1.0),
            Shape::Line(line) => (finite(line), line.windows(2).map(|w| length([w[0], w[1]])).sum()),
            Shape::Facet(triangles) => {
                (triangles.iter().all(|t| finite(t)), triangles.iter().map(|t| polygon_area(t)).sum())
            }
        };
        if !all_finite {
            return Err(DataError::NotFinite { datum });
        }
        if !(extent * weight).is_finite() {
            return Err(DataError::Weight { datum, weight });
        }
        if extent <= 0.0 {
            return Err(DataError::NoExtent { datum });
        }
        self.data.push(Datum { shape, weight });
        Ok(())
    }

    /// Adds a point.
    ///
    /// # Errors
    /// If it is not finite, or the weight not positive.
    pub fn point(&mut self, point: [f64; D], weight: f64) -> Result<(), DataError> {
        self.push(Shape::Point(point), weight)
    }

    /// Adds points of equal weight.
    ///
    /// # Errors
    /// If one is not finite, or the weight not positive.
    pub fn points(&mut self, points: &[[f64; D]], weight: f64) -> Result<(), DataError> {
        points.iter().try_for_each(|&p| self.point(p, weight))
    }

    /// Adds a segment. The weight counts for each unit of length.
    ///
    /// # Errors
    /// If it is not finite or has no length, or the weight is not positive.
    pub fn segment(&mut self, ends: [[f64; D]; 2], weight: f64) -> Result<(), DataError> {
        self.push(Shape::Line(ends.to_vec()), weight)
    }

    /// Adds a corner: two segments that meet at the middle one of three positions. The weight counts for each unit of length.
    ///
    /// # Errors
    /// If it is not finite or has no length, or the weight is not positive.
    pub fn corner(&mut self, positions: [[f64; D]; 3], weight: f64) -> Result<(), DataError> {
        self.push(Shape::Line(positions.to_vec()), weight)
    }

    /// Adds a line through positions. The weight counts for each unit of length.
    ///
    /// # Errors
    /// If it is not finite or has no length, or the weight is not positive.
    pub fn polyline(&mut self, positions: &[[f64; D]], weight: f64) -> Result<(), DataError> {
        self.push(Shape::Line(positions.to_vec()), weight)
    }

    /// Adds a triangle, of which all of the area counts. The weight is for each unit of area.
    ///
    /// # Errors
    /// If it is not finite or has no area, or the weight is not positive.
    pub fn triangle(&mut self, corners: [[f64; D]; 3], weight: f64) -> Result<(), DataError> {
        self.push(Shape::Facet(vec![corners]), weight)
    }
}

impl Data<2> {
    /// Adds the boundary of a polygon, closed from the last position to the first. The weight counts for each unit of length.
    ///
    /// # Errors
    /// If it has fewer than three positions, is not finite or has no length, or the weight is not positive.
    pub fn polygon(&mut self, ring: &[[f64; 2]], weight: f64) -> Result<(), DataError> {
        let datum = self.data.len();
        let ring = polygon::open_ring(ring).map_err(|why| DataError::Polygon { datum, why })?;
        let closed = ring.iter().chain(ring.first()).copied().collect();
        self.push(Shape::Line(closed), weight)
    }
}

impl Data<3> {
    /// Adds a plane polygon in space: its outer ring, then its holes. The weight counts for each unit of area.
    ///
    /// Rings close from the last position to the first. Which way round they run does not matter: what lies within an odd number of
    /// rings belongs to the polygon.
    ///
    /// # Errors
    /// If the positions do not lie in a plane, rings cross, a ring has fewer than three positions, a position is not finite, there is no
    /// area, or the weight is not positive.
    pub fn polygon(&mut self, rings: &[Vec<[f64; 3]>], weight: f64) -> Result<(), DataError> {
        let datum = self.data.len();
        if !rings.iter().flatten().flatten().all(|c| c.is_finite()) {
            return Err(DataError::NotFinite { datum });
        }
        let triangles = polygon::triangulate(rings).map_err(|why| DataError::Polygon { datum, why })?;
        self.push(Shape::Facet(triangles), weight)
    }
}

/// A weighted point that stands for a part of a datum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample<const D: usize> {
    /// Where it is.
    pub place: Place<D>,
    /// The datum's weight times the part's share of its number, length or area.
    pub weight: f64,
    /// Which datum.
    pub datum: u32,
}

/// The pieces of a whole may miss this share of it by rounding.
const MISSING: f64 = 1e-9;
/// The degree of the rules for functions that are no polynomials; their cells are shorter than half a width.
const DATA_DEGREE: usize = 6;

impl<const D: usize> Data<D> {
    /// The samples of all data: exact for the integral of F^2 where F is a polynomial on each simplex.
    ///
    /// # Errors
    /// If there are no data, or one lies outside the domain, in part or whole.
    pub fn samples(&self, basis: &dyn Basis<D>) -> Result<Vec<Sample<D>>, DataError> {
        if self.data.is_empty() {
            return Err(DataError::Empty);
        }
        let degree = basis.degree().map_or(DATA_DEGREE, |d| 2 * d);
        let mut sampler = Sampler { domain: basis.domain(), degree, samples: Vec::new() };
        for (i, datum) in self.data.iter().enumerate() {
            let (inside, whole) = sampler.add(i as u32, datum);
            if inside < (1.0 - MISSING) * whole {
                return Err(DataError::Outside { datum: i, inside, whole });
            }
        }
        Ok(sampler.samples)
    }
}

struct Sampler<'a, const D: usize> {
    domain: &'a SimplicialMesh<D>,
    degree: usize,
    samples: Vec<Sample<D>>,
}

impl<const D: usize> Sampler<'_, D> {
    /// Adds the samples of a datum. Returns its measure in the domain, and in all.
    fn add(&mut self, number: u32, datum: &Datum<D>) -> (f64, f64) {
        let before = self.samples.len();
        let whole = match &datum.shape {
            Shape::Point(point) => {
                if let Some(place) = self.domain.locate(*point) {
                    self.samples.push(Sample { place, weight: 1.0, datum: number });
                }
                1.0
            }
            Shape::Line(line) => line.windows(2).map(|w| self.segment([w[0], w[1]], number)).sum(),
            Shape::Facet(triangles) => triangles.iter().map(|t| self.triangle(t, number)).sum(),
        };
        let added = &mut self.samples[before..];
        let inside = added.iter().map(|s| s.weight).sum();
        added.iter_mut().for_each(|s| s.weight *= datum.weight);
        (inside, whole)
    }

    fn sample(&mut self, simplex: usize, position: [f64; D], weight: f64, datum: u32) {
        let barycentric = self.domain.barycentric(simplex, position);
        self.samples.push(Sample { place: Place { simplex, barycentric, position }, weight, datum });
    }

    fn segment(&mut self, ends: [[f64; D]; 2], datum: u32) -> f64 {
        let whole = length(ends);
        let rule = rule::<1>(self.degree);
        for piece in self.domain.clip_segment(ends) {
            let [from, to] = piece.range;
            for node in &rule {
                let t = from + node.coordinates[0] * (to - from);
                let position = std::array::from_fn(|a| ends[0][a] + t * (ends[1][a] - ends[0][a]));
                self.sample(piece.simplex, position, node.weight * (to - from) * whole, datum);
            }
        }
        whole
    }

    fn triangle(&mut self, corners: &[[f64; D]; 3], datum: u32) -> f64 {
        let rule = rule::<2>(self.degree);
        for piece in self.domain.clip_triangle(*corners) {
            let part = polygon_area(&piece.corners);
            for node in &rule {
                self.sample(piece.simplex, node.position(&piece.corners), node.weight * part, datum);
            }
        }
        polygon_area(corners)
    }
}

/// The length of a segment.
fn length<const D: usize>([p, q]: [[f64; D]; 2]) -> f64 {
    (0..D).map(|a| (q[a] - p[a]).powi(2)).sum::<f64>().sqrt()
}
