//! What came of a fit in the plane, as JSON.

use serde::Serialize;

/// What came of a fit in the plane: the fields are the keys of the JSON.
///
/// Lengths are in the unit of the input. Lists that go together have equal lengths: `nodes` and `coefficients`, `contour` and `closed`.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct PlanarResult {
    /// The smallest eigenvalue; null where the normalisation has no spectrum.
    pub eigenvalue: Option<f64>,
    /// From the smallest eigenvalue to the next; null where there is none.
    pub gap: Option<f64>,
    /// The smallest eigenvalues, ascending.
    pub spectrum: Vec<f64>,
    /// Energy over normalisation.
    pub rayleigh_quotient: f64,
    /// Where the functions sit; null for those that sit nowhere, such as constants.
    pub nodes: Vec<Option<[f64; 2]>>,
    /// The coefficients of the functions; 0 for those that nothing constrains.
    pub coefficients: Vec<f64>,
    /// Indices of the functions that nothing constrains, ascending.
    pub unconstrained: Vec<usize>,
    /// The root of the weighted mean of F^2 over the data.
    pub residual_rms: f64,
    /// The same over the gradient of F: to first order, the distance of the data from the zero set.
    pub distance_rms: f64,
    /// The root of the mean F^2 of each datum: points, then segments, then polygons.
    pub residuals: Vec<f64>,
    /// The zero set. A closed polyline repeats its first position at the end. F < 0 lies on its left.
    pub contour: Vec<Vec<[f64; 2]>>,
    /// Whether each polyline is closed.
    pub closed: Vec<bool>,
    /// What may be wrong, with the remedy.
    pub warnings: Vec<String>,
    /// How the fit was made.
    pub method: MethodReport,
}

/// How a fit was made, with every default resolved, in the words of the command's options.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct MethodReport {
    /// `file`, `lattice`, `four` or `delaunay`.
    pub domain: String,
    /// Number of triangles.
    pub triangles: usize,
    /// Lower and upper corner of the box around the domain.
    pub bounds: [[f64; 2]; 2],
    /// The basis.
    pub basis: String,
    /// The width of radial functions.
    pub width: Option<f64>,
    /// The normalisation.
    pub normalization: String,
    /// The order of the smoothness.
    pub order: u8,
    /// Its weight.
    pub smoothness: f64,
    /// The weight of segments and polygons, for each unit of length.
    pub line_weight: f64,
    /// How near the contour is to the zero set.
    pub tolerance: f64,
}

/// A result as JSON, with a line end.
#[must_use]
pub fn planar_json(result: &PlanarResult) -> String {
    // Plain structures with names for keys always serialise.
    let mut text = serde_json::to_string(result).unwrap_or_default();
    text.push('\n');
    text
}
