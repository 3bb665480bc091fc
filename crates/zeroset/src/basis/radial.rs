//! Functions of the distance to centres.
//!
//! With r the distance to a centre and s = r / width:
//!
//! | kernel | value | decays |
//! |---|---|---|
//! | Gaussian | exp(-s^2) | yes |
//! | multiquadric (Hardy 1971) | sqrt(1 + s^2) | no, grows |
//! | inverse multiquadric | 1 / sqrt(1 + s^2) | slowly |
//! | thin plate (Duchon 1977) | s^2 ln s | no, grows |
//! | Wendland C2 (1995) | (1 - s)^4 (4 s + 1) for s < 1, else 0 | compact |
//! | Wendland C4 (1995) | (1 - s)^6 (35 s^2 + 18 s + 3) / 3 for s < 1, else 0 | compact |
//!
//! Kernels alone neither sum to 1 nor reproduce polynomials; a [`Tail`] of polynomials beside them does.

use super::{Basis, Derivatives, Span, Terms, length};
use crate::domain::{Place, SimplicialMesh, bounds};

/// A function of the distance to a centre. Widths are lengths.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Kernel {
    /// exp(-s^2).
    Gaussian {
        /// Where it has fallen to 1/e.
        width: f64,
    },
    /// sqrt(1 + s^2).
    Multiquadric {
        /// Where it begins to grow like the distance.
        width: f64,
    },
    /// 1 / sqrt(1 + s^2).
    InverseMultiquadric {
        /// Where it begins to decay like the inverse distance.
        width: f64,
    },
    /// s^2 ln s. Its second derivatives are infinite at the centre itself; there 0 is taken for them.
    ThinPlate {
        /// The unit of length. It matters, as no side condition is put on the coefficients.
        width: f64,
    },
    /// (1 - s)^4 (4 s + 1), twice differentiable.
    WendlandC2 {
        /// Beyond it the function is 0.
        width: f64,
    },
    /// (1 - s)^6 (35 s^2 + 18 s + 3) / 3, four times differentiable.
    WendlandC4 {
        /// Beyond it the function is 0.
        width: f64,
    },
}

impl Kernel {
    /// Its width.
    #[must_use]
    pub fn width(self) -> f64 {
        match self {
            Self::Gaussian { width }
            | Self::Multiquadric { width }
            | Self::InverseMultiquadric { width }
            | Self::ThinPlate { width }
            | Self::WendlandC2 { width }
            | Self::WendlandC4 { width } => width,
        }
    }

    /// Whether it vanishes beyond its width.
    #[must_use]
    pub fn is_compact(self) -> bool {
        matches!(self, Self::WendlandC2 { .. } | Self::WendlandC4 { .. })
    }

    /// The value f, and the two factors that give derivatives at offset d from the centre: the gradient is f1 d, the matrix
    /// of second derivatives f1 I + f2 d d'. Here f1 = f'(r) / r and f2 = f1'(r) / r.
    fn jet(self, squared_distance: f64) -> [f64; 3] {
        let per_length = 1.0 / self.width();
        let u = squared_distance * per_length * per_length;
        let [value, first, second] = match self {
            Self::Gaussian { .. } => {
                let e = (-u).exp();
                [e, -2.0 * e, 4.0 * e]
            }
            Self::Multiquadric { .. } => {
                let q = (1.0 + u).sqrt();
                [q, 1.0 / q, -1.0 / (q * q * q)]
            }
            Self::InverseMultiquadric { .. } => {
                let q = 1.0 / (1.0 + u).sqrt();
                [q, -q.powi(3), 3.0 * q.powi(5)]
            }
            Self::ThinPlate { .. } if u == 0.0 => [0.0; 3],
            Self::ThinPlate { .. } => [0.5 * u * u.ln(), u.ln() + 1.0, 2.0 / u],
            Self::WendlandC2 { .. } | Self::WendlandC4 { .. } if u >= 1.0 => [0.0; 3],
            Self::WendlandC2 { .. } => {
                let s = u.sqrt();
                let t = 1.0 - s;
                let second = if s > 0.0 { 60.0 * t * t / s } else { 0.0 };
                [t.powi(4) * (4.0 * s + 1.0), -20.0 * t.powi(3), second]
            }
            Self::WendlandC4 { .. } => {
                let s = u.sqrt();
                let t = 1.0 - s;
                let value = t.powi(6) * (35.0 * u + 18.0 * s + 3.0) / 3.0;
                [value, -56.0 / 3.0 * t.powi(5) * (5.0 * s + 1.0), 560.0 * t.powi(4)]
            }
        };
        [value, first * per_length.powi(2), second * per_length.powi(4)]
    }
}

impl Kernel {
    /// What its second derivatives, along any direction, do not exceed between two distances; infinite if there is no such bound.
    ///
    /// They are f1 across and f1 + f2 r^2 along the direction to the centre: see [`Self::jet`].
    fn bend(self, [low, high]: [f64; 2]) -> f64 {
        let s = low / self.width();
        let u = s * s;
        let bend = match self {
            // The second derivative along is greatest again at u = 3/2.
            Self::Gaussian { .. } if u < 1.5 => (2.0 * (-u).exp()).max(4.0 * (-1.5_f64).exp()),
            Self::Gaussian { .. } => (4.0 * u - 2.0) * (-u).exp(),
            Self::Multiquadric { .. } => 1.0 / (1.0 + u).sqrt(),
            Self::InverseMultiquadric { .. } => 2.0 / (1.0 + u).powf(1.5),
            Self::ThinPlate { width } => {
                let of = |u: f64| (u.ln() + 1.0).abs().max((u.ln() + 3.0).abs());
                of(u).max(of((high / width).powi(2)))
            }
            Self::WendlandC2 { .. } | Self::WendlandC4 { .. } if s >= 1.0 => 0.0,
            // And here at s = 1/2 and 3/7.
            Self::WendlandC2 { .. } if s < 0.5 => (20.0 * (1.0 - s).powi(3)).max(5.0),
            Self::WendlandC2 { .. } => 20.0 * (1.0 - s).powi(2) * (4.0 * s - 1.0),
            Self::WendlandC4 { .. } => {
                let along = |s: f64| 56.0 / 3.0 * (1.0 - s).powi(4) * (35.0 * s * s - 4.0 * s - 1.0);
                let across = 56.0 / 3.0 * (1.0 - s).powi(5) * (5.0 * s + 1.0);
                across.max(along(s.max(3.0 / 7.0)))
            }
        };
        bend / self.width().powi(2)
    }

    /// What the length of its gradient does not exceed between two distances, where it has no bound on second derivatives.
    fn steepest(self, [low, high]: [f64; 2]) -> f64 {
        let at = |s: f64| if s > 0.0 { (s * (2.0 * s.ln() + 1.0)).abs() } else { 0.0 };
        let [low, high] = [low / self.width(), high / self.width()];
        // Near the centre it is steepest at exp(-3/2).
        let inner = (-1.5_f64).exp().clamp(low, high);
        at(low).max(at(high)).max(at(inner)) / self.width()
    }
}

/// Polynomials beside the kernels, in coordinates that run from -1 to 1 over the longest side of the domain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Tail {
    /// None.
    None,
    /// The constant 1.
    Constant,
    /// 1 and the coordinates.
    Linear,
}

/// Radial functions that are not possible.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum RadialError {
    /// The width is not a positive number.
    #[error("a kernel of width {0} is not possible: give a positive length")]
    Width(f64),
    /// There are no functions at all.
    #[error("there are no centres for radial functions; give at least one")]
    NoCentres,
    /// A centre is infinite or not a number.
    #[error("centre {centre} of the radial functions is not finite; correct its coordinates")]
    NotFinite {
        /// The centre.
        centre: usize,
    },
    /// Two centres are equal, so that their functions are, too.
    #[error("centres {centres:?} of the radial functions are equal; give each only once")]
    Equal {
        /// The two.
        centres: [usize; 2],
    },
}

/// One kernel at each centre, and a tail of polynomials.
#[derive(Debug, Clone)]
pub struct Radial<const D: usize> {
    domain: SimplicialMesh<D>,
    kernel: Kernel,
    centres: Vec<[f64; D]>,
    tail: Tail,
    middle: [f64; D],
    half_side: f64,
}

impl<const D: usize> Radial<D> {
    /// Kernels at `centres`. The domain tells where F is known; its cells serve integrals and the zero set, so they should be no
    /// longer than about half the kernel's width.
    ///
    /// # Errors
    /// If the width is not positive, there are no centres, or one is not finite or there twice.
    pub fn new(
        domain: SimplicialMesh<D>,
        kernel: Kernel,
        centres: Vec<[f64; D]>,
        tail: Tail,
    ) -> Result<Self, RadialError> {
        let width = kernel.width();
        if !(width.is_finite() && width > 0.0) {
            return Err(RadialError::Width(width));
        }
        if centres.is_empty() {
            return Err(RadialError::NoCentres);
        }
        if let Some(centre) = centres.iter().position(|c| !c.iter().all(|x| x.is_finite())) {
            return Err(RadialError::NotFinite { centre });
        }
        let mut order: Vec<usize> = (0..centres.len()).collect();
        let compare = |&i: &usize, &j: &usize| centres[i].partial_cmp(&centres[j]).expect("finite centres compare");
        order.sort_by(compare);
        if let Some(pair) = order.windows(2).find(|p| centres[p[0]] == centres[p[1]]) {
            return Err(RadialError::Equal { centres: [pair[0], pair[1]] });
        }
        let (low, high) = bounds(domain.vertices().iter().copied());
        let middle = std::array::from_fn(|a| 0.5 * (low[a] + high[a]));
        let half_side = (0..D).map(|a| 0.5 * (high[a] - low[a])).fold(0.0, f64::max);
        Ok(Self { domain, kernel, centres, tail, middle, half_side })
    }

    /// The centres.
    #[must_use]
    pub fn centres(&self) -> &[[f64; D]] {
        &self.centres
    }
}

impl<const D: usize> Basis<D> for Radial<D> {
    fn domain(&self) -> &SimplicialMesh<D> {
        &self.domain
    }

    fn len(&self) -> usize {
        self.centres.len()
            + match self.tail {
                Tail::None => 0,
                Tail::Constant => 1,
                Tail::Linear => 1 + D,
            }
    }

    fn node(&self, j: usize) -> Option<[f64; D]> {
        self.centres.get(j).copied()
    }

    fn degree(&self) -> Option<usize> {
        None
    }

    fn is_local(&self) -> bool {
        self.kernel.is_compact() && self.tail == Tail::None
    }

    fn evaluate(&self, place: &Place<D>, derivatives: Derivatives, terms: &mut Terms<D>) {
        terms.clear();
        let mut push = |j: usize, value: f64, gradient: [f64; D], hessian: [[f64; D]; D]| {
            terms.indices.push(j as u32);
            terms.values.push(value);
            if derivatives >= Derivatives::First {
                terms.gradients.push(gradient);
            }
            if derivatives >= Derivatives::Second {
                terms.hessians.push(hessian);
            }
        };
        for (j, centre) in self.centres.iter().enumerate() {
            let d: [f64; D] = std::array::from_fn(|a| place.position[a] - centre[a]);
            let squared = d.iter().map(|c| c * c).sum::<f64>();
            if self.kernel.is_compact() && squared >= self.kernel.width() * self.kernel.width() {
                continue;
            }
            let [value, first, second] = self.kernel.jet(squared);
            let hessian = std::array::from_fn(|a| {
                std::array::from_fn(|b| second * d[a] * d[b] + if a == b { first } else { 0.0 })
            });
            push(j, value, d.map(|c| first * c), hessian);
        }
        let flat = [[0.0; D]; D];
        let first = self.centres.len();
        if self.tail != Tail::None {
            push(first, 1.0, [0.0; D], flat);
        }
        if self.tail == Tail::Linear {
            for a in 0..D {
                let mut gradient = [0.0; D];
                gradient[a] = 1.0 / self.half_side;
                push(first + 1 + a, (place.position[a] - self.middle[a]) / self.half_side, gradient, flat);
            }
        }
    }

    /// From the value and the gradient in the middle of the simplex, and bounds on second derivatives over the ball around it.
    fn span(&self, simplex: usize, coefficients: &[f64]) -> Span {
        let corners = self.domain.simplex(simplex).iter().map(|&v| self.domain.vertices()[v as usize]);
        let weight = 1.0 / (D + 1) as f64;
        let barycentric = std::array::from_fn(|c| if c <= D { weight } else { 0.0 });
        let middle = self.domain.position(simplex, &barycentric);
        let distance = |p: [f64; D]| length::<D>(std::array::from_fn(|a| p[a] - middle[a]));
        let radius = corners.map(distance).fold(0.0, f64::max);
        let mut terms = Terms::new();
        self.evaluate(&Place { simplex, barycentric, position: middle }, Derivatives::First, &mut terms);
        let (mut value, mut gradient, mut slope) = (0.0, [0.0; D], 0.0);
        let reach = |j: usize| {
            let away = distance(self.centres[j]);
            [(away - radius).max(0.0), away + radius]
        };
        for (k, &j) in terms.indices.iter().enumerate() {
            let (j, c) = (j as usize, coefficients[j as usize]);
            value += c * terms.values[k];
            if j < self.centres.len() && self.kernel.bend(reach(j)).is_infinite() {
                slope += c.abs() * self.kernel.steepest(reach(j));
            } else {
                (0..D).for_each(|a| gradient[a] += c * terms.gradients[k][a]);
            }
        }
        // Compact functions that vanish in the middle may not elsewhere.
        let bends = (0..self.centres.len()).map(|j| (coefficients[j].abs(), self.kernel.bend(reach(j))));
        let bends = bends.filter(|(_, bend)| bend.is_finite()).map(|(c, bend)| c * bend);
        slope += length(gradient) + radius * bends.sum::<f64>();
        Span { low: value - radius * slope, high: value + radius * slope, slope }
    }
}

/// Indices of `count` points that cover a set evenly: each next one is the farthest from those before it (Gonzalez 1985). The first is
/// the farthest from the mean; among equals the lowest index wins. Equal points are taken once, so fewer can come.
///
/// Cost: `count` times the number of points.
#[must_use]
pub fn farthest_points<const D: usize>(points: &[[f64; D]], count: usize) -> Vec<usize> {
    let squared = |p: &[f64; D], q: &[f64; D]| (0..D).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>();
    let mut mean = [0.0; D];
    for p in points {
        for a in 0..D {
            mean[a] += p[a] / points.len() as f64;
        }
    }
    let farthest = |distances: &[f64]| {
        let mut best = 0;
        for (i, &d) in distances.iter().enumerate() {
            if d > distances[best] {
                best = i;
            }
        }
        best
    };
    let mut chosen = Vec::new();
    let mut distances: Vec<f64> = points.iter().map(|p| squared(p, &mean)).collect();
    while chosen.len() < count.min(points.len()) {
        let next = farthest(&distances);
        if chosen.is_empty() {
            distances.fill(f64::INFINITY);
        } else if distances[next] == 0.0 {
            break;
        }
        chosen.push(next);
        for (d, p) in distances.iter_mut().zip(points) {
            *d = d.min(squared(p, &points[next]));
        }
    }
    chosen
}
