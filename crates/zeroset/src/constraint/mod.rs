//! What the user knows of the surface: lines and polygons that it is to pass through.
//!
//! # What
//! Kerbs, ridges, break lines and outlines from CAD or GIS are lines; walls and roofs are polygons. They enter the fit beside the points: as
//! evenly spaced samples in the cascade, and as exact pieces in the polish, where the integral of F^2 over each is part of what is
//! minimised. Polygons are also planes for the sharpening, so that edges run where they meet other planes, and the mesh gets edges along
//! lines.
//!
//! A polygon is a part of the surface: the ground floor of a house, which is none, is to be given by its outline
//! ([`Constraints::into_outlines`]).
//!
//! # Not changed by constraints
//! Spacing, noise, scene and box are those of the points, and so are resolution, trim in plan, and the values at vertices. What of a constraint
//! lies outside of the box of the points, grown by a twentieth of its longest side, takes no part.
//!
//! ```
//! use zeroset::constraint::Constraints;
//! let mut known = Constraints::default();
//! known.line(&[[0.0, 0.0, 5.0], [10.0, 0.0, 5.0]])?;
//! known.polygon(&[vec![[0.0, 0.0, 0.0], [10.0, 0.0, 0.0], [10.0, 0.0, 5.0], [0.0, 0.0, 5.0]]])?;
//! assert_eq!((known.lines(), known.polygons()), (1, 1));
//! # Ok::<(), zeroset::constraint::ConstraintError>(())
//! ```

mod imprint;
mod local;

#[cfg(test)]
mod tests;

pub(crate) use imprint::imprint;
pub(crate) use local::{Local, LocalPolygon};

use serde::{Deserialize, Serialize};

use crate::fit::normalized::{PolygonError, Triangulated, triangulate_polygon};
use crate::vec3::{self, Vec3};

/// Lines and polygons in world coordinates.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Constraints {
    lines: Vec<Vec<Vec3>>,
    polygons: Vec<Polygon>,
}

/// A plane polygon.
#[derive(Debug, Clone, PartialEq)]
struct Polygon {
    rings: Vec<Vec<Vec3>>,
    /// The same as triangles.
    triangles: Vec<[Vec3; 3]>,
    /// Of unit length; which side is outside is not known.
    normal: Vec3,
}

/// A line or polygon that constrains nothing, or cannot be understood. Each message names the remedy.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ConstraintError {
    /// A coordinate is infinite or not a number.
    #[error("has a coordinate that is not finite; correct it or leave it out")]
    NotFinite,
    /// A line without length, or a polygon without area.
    #[error("has no extent: its positions coincide or lie in one line; leave it out")]
    NoExtent,
    /// A polygon that is not plane, or whose sides cross.
    #[error(transparent)]
    Polygon(PolygonError),
}

/// A polygon's position may lie off its plane by this share of its size: centimetres in a roof, as files round coordinates.
const PLANE_REL: f64 = 5e-3;

impl Constraints {
    /// Adds a line through positions in world coordinates.
    ///
    /// # Errors
    /// If a coordinate is not finite, or the line has no length.
    pub fn line(&mut self, positions: &[[f64; 3]]) -> Result<(), ConstraintError> {
        if !positions.iter().all(|p| vec3::is_finite(*p)) {
            return Err(ConstraintError::NotFinite);
        }
        let mut line = positions.to_vec();
        line.dedup();
        if line.len() < 2 {
            return Err(ConstraintError::NoExtent);
        }
        self.lines.push(line);
        Ok(())
    }

    /// Adds a plane polygon in world coordinates: its outer ring, then its holes. Whether first positions are repeated at the end does not
    /// matter, nor which way round rings run.
    ///
    /// # Errors
    /// If a coordinate is not finite, the positions do not lie in a plane to 0.5 % of the polygon's size, sides cross, or there is no area.
    pub fn polygon(&mut self, rings: &[Vec<[f64; 3]>]) -> Result<(), ConstraintError> {
        if !rings.iter().flatten().all(|p| vec3::is_finite(*p)) {
            return Err(ConstraintError::NotFinite);
        }
        let Triangulated { triangles, normal } = triangulate_polygon(rings, PLANE_REL).map_err(|why| match why {
            PolygonError::TooFewPositions(_) | PolygonError::NoArea => ConstraintError::NoExtent,
            other => ConstraintError::Polygon(other),
        })?;
        self.polygons.push(Polygon { rings: rings.to_vec(), triangles, normal });
        Ok(())
    }

    /// Adds those of another.
    pub fn append(&mut self, mut other: Self) {
        self.lines.append(&mut other.lines);
        self.polygons.append(&mut other.polygons);
    }

    /// The same with the rings of polygons as lines, and nothing said about what they enclose.
    #[must_use]
    pub fn into_outlines(self) -> Self {
        let Self { mut lines, polygons } = self;
        for mut ring in polygons.into_iter().flat_map(|polygon| polygon.rings) {
            ring.extend(ring.first().copied());
            ring.dedup();
            lines.push(ring);
        }
        Self { lines, polygons: Vec::new() }
    }

    /// Number of lines.
    #[must_use]
    pub fn lines(&self) -> usize {
        self.lines.len()
    }

    /// Number of polygons.
    #[must_use]
    pub fn polygons(&self) -> usize {
        self.polygons.len()
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.lines.is_empty() && self.polygons.is_empty()
    }

    /// Lowest and highest corner of the box around all; `None` if there are none.
    #[must_use]
    pub fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let corners = self.polygons.iter().flat_map(|polygon| polygon.rings.iter().flatten());
        let (low, high) = crate::domain::bounds(self.lines.iter().flatten().chain(corners).copied());
        (!self.is_empty()).then_some([low, high])
    }

    /// How much of it takes part in a reconstruction of points in a box, which is given by its lowest and highest corner in world
    /// coordinates.
    #[must_use]
    pub fn within(&self, bounds: [[f64; 3]; 2]) -> ConstraintPlan {
        Local::new(self, [0.0; 3], |p| p, (bounds[0], bounds[1])).plan
    }
}

/// How much of the user's lines and polygons takes part.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct ConstraintPlan {
    /// Lines given.
    pub lines: usize,
    /// Polygons given.
    pub polygons: usize,
    /// Lines of which a part lies in the box of the points.
    pub lines_used: usize,
    /// Polygons of which a part does.
    pub polygons_used: usize,
    /// Length of these parts.
    pub length: f64,
    /// Area of these parts.
    pub area: f64,
}

impl ConstraintPlan {
    /// Whether nothing takes part.
    #[must_use]
    pub fn is_idle(&self) -> bool {
        self.lines_used + self.polygons_used == 0
    }
}

/// How well a mesh passes through the user's lines and polygons.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ConstraintReport {
    /// Mean distance of the mesh from them, over evenly spaced positions on them.
    pub mean_distance: f64,
    /// The distance that 95 % of the positions keep within.
    pub p95_distance: f64,
    /// The largest distance.
    pub max_distance: f64,
    /// Vertices put in along lines; 0 in a draft.
    pub on_lines: usize,
}
