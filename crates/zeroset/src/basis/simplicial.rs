//! Polynomials on simplices, in barycentric form.
//!
//! With barycentric coordinates l_i, the linear functions are B_i = l_i at the corners; the quadratic ones are l_i (2 l_i - 1) at the
//! corners and 4 l_i l_j in the middle of the edges. Both are continuous across faces, sum to 1, and reproduce polynomials of
//! their degree.

use super::{Basis, Derivatives, Expansion, Span, Terms, length};
use crate::domain::{Place, SimplicialMesh};

/// Linear on each simplex (Lagrange, degree 1): one function for each vertex.
#[derive(Debug, Clone)]
pub struct P1<const D: usize> {
    domain: SimplicialMesh<D>,
}

impl<const D: usize> P1<D> {
    /// The functions of a mesh.
    #[must_use]
    pub fn new(domain: SimplicialMesh<D>) -> Self {
        Self { domain }
    }
}

impl<const D: usize> Basis<D> for P1<D> {
    fn domain(&self) -> &SimplicialMesh<D> {
        &self.domain
    }

    fn len(&self) -> usize {
        self.domain.vertices().len()
    }

    fn node(&self, j: usize) -> Option<[f64; D]> {
        Some(self.domain.vertices()[j])
    }

    fn degree(&self) -> Option<usize> {
        Some(1)
    }

    fn is_local(&self) -> bool {
        true
    }

    fn evaluate(&self, place: &Place<D>, derivatives: Derivatives, terms: &mut Terms<D>) {
        terms.clear();
        terms.indices.extend_from_slice(self.domain.simplex(place.simplex));
        terms.values.extend_from_slice(&place.barycentric[..=D]);
        if derivatives >= Derivatives::First {
            terms.gradients.extend_from_slice(&self.domain.barycentric_gradients(place.simplex)[..=D]);
        }
        if derivatives >= Derivatives::Second {
            terms.hessians.resize(D + 1, [[0.0; D]; D]);
        }
    }

    /// The values at the corners, between which F lies.
    fn span(&self, simplex: usize, coefficients: &[f64]) -> Span {
        let values = self.domain.simplex(simplex).iter().map(|&v| coefficients[v as usize]);
        let span = values.fold(Span::EMPTY, Span::with_value);
        Span { slope: slope_at_corners(self, simplex, coefficients), ..span }
    }
}

/// Quadratic on each simplex (Lagrange, degree 2): one function for each vertex, then one for each edge.
#[derive(Debug, Clone)]
pub struct P2<const D: usize> {
    domain: SimplicialMesh<D>,
}

impl<const D: usize> P2<D> {
    /// The functions of a mesh.
    #[must_use]
    pub fn new(domain: SimplicialMesh<D>) -> Self {
        Self { domain }
    }
}

impl<const D: usize> Basis<D> for P2<D> {
    fn domain(&self) -> &SimplicialMesh<D> {
        &self.domain
    }

    fn len(&self) -> usize {
        self.domain.vertices().len() + self.domain.edges().len()
    }

    fn node(&self, j: usize) -> Option<[f64; D]> {
        let vertices = self.domain.vertices();
        Some(match j.checked_sub(vertices.len()) {
            None => vertices[j],
            Some(edge) => {
                let [p, q] = self.domain.edges()[edge].map(|v| vertices[v as usize]);
                std::array::from_fn(|a| p[a] + 0.5 * (q[a] - p[a]))
            }
        })
    }

    fn degree(&self) -> Option<usize> {
        Some(2)
    }

    fn is_local(&self) -> bool {
        true
    }

    fn evaluate(&self, place: &Place<D>, derivatives: Derivatives, terms: &mut Terms<D>) {
        terms.clear();
        let simplex = place.simplex;
        let l = &place.barycentric;
        let g = self.domain.barycentric_gradients(simplex);
        let outer = |u: &[f64; D], v: &[f64; D], factor: f64| -> [[f64; D]; D] {
            std::array::from_fn(|a| std::array::from_fn(|b| factor * u[a] * v[b]))
        };
        terms.indices.extend_from_slice(self.domain.simplex(simplex));
        let first_edge = self.domain.vertices().len() as u32;
        terms.indices.extend(self.domain.edges_of(simplex).iter().map(|e| first_edge + e));
        for i in 0..=D {
            terms.values.push(l[i] * (2.0 * l[i] - 1.0));
            if derivatives >= Derivatives::First {
                terms.gradients.push(g[i].map(|c| (4.0 * l[i] - 1.0) * c));
            }
            if derivatives >= Derivatives::Second {
                terms.hessians.push(outer(&g[i], &g[i], 4.0));
            }
        }
        for i in 0..=D {
            for j in i + 1..=D {
                terms.values.push(4.0 * l[i] * l[j]);
                if derivatives >= Derivatives::First {
                    terms.gradients.push(std::array::from_fn(|a| 4.0 * (l[i] * g[j][a] + l[j] * g[i][a])));
                }
                if derivatives >= Derivatives::Second {
                    let (there, back) = (outer(&g[i], &g[j], 4.0), outer(&g[j], &g[i], 4.0));
                    terms.hessians.push(std::array::from_fn(|a| std::array::from_fn(|b| there[a][b] + back[a][b])));
                }
            }
        }
    }

    /// The coefficients in Bernstein's form, between which F lies: the values at the corners, and for each edge twice the value in its middle less the mean of
    /// its ends. The gradient is linear, and so longest at a corner.
    fn span(&self, simplex: usize, coefficients: &[f64]) -> Span {
        let corner = |i: usize| coefficients[self.domain.simplex(simplex)[i] as usize];
        let first_edge = self.domain.vertices().len();
        let pairs = (0..=D).flat_map(|i| (i + 1..=D).map(move |j| (i, j)));
        let edges = pairs
            .zip(self.domain.edges_of(simplex))
            .map(|((i, j), &edge)| 2.0 * coefficients[first_edge + edge as usize] - 0.5 * (corner(i) + corner(j)));
        let span = (0..=D).map(corner).chain(edges).fold(Span::EMPTY, Span::with_value);
        Span { slope: slope_at_corners(self, simplex, coefficients), ..span }
    }
}

/// The length of the longest of the gradients at the corners of a simplex.
fn slope_at_corners<const D: usize>(basis: &dyn Basis<D>, simplex: usize, coefficients: &[f64]) -> f64 {
    let f = Expansion::new(basis, coefficients);
    let at = |corner: usize| {
        let barycentric = std::array::from_fn(|c| if c == corner { 1.0 } else { 0.0 });
        let position = basis.domain().vertices()[basis.domain().simplex(simplex)[corner] as usize];
        length(f.gradient_at(&Place { simplex, barycentric, position }))
    };
    (0..=D).map(at).fold(0.0, f64::max)
}
