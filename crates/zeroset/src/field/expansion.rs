//! A small fit, as a field.

use std::sync::Arc;

use rayon::prelude::*;

use super::{Field, FieldError, Interval, Metric};
use crate::basis::{Basis, Expansion, Span};
use crate::domain::Place;
use crate::vec3::{self, Vec3};

/// Halvings of the box of the domain at most, for which ranges are kept.
const MOST_LEVELS: u32 = 6;
/// Values may be this far off, as a share of the coefficients: barycentric coordinates of flat simplices have few digits.
const ROUNDING: f64 = 1e-10;
/// The volume of a domain that fills its box may differ by this share.
const FILLED: f64 = 1e-6;

/// F = sum_j F_j B_j as a field: what [`NormalizedFit`](crate::fit::normalized::NormalizedFit) gives, with functions linear or quadratic on tetrahedra, or radial.
///
/// Beyond its domain, which must fill a box, F is as on the nearest place of it: the surface goes straight on there. Only the sign of F and the direction of
/// its gradient count.
///
/// # Cost
/// A value costs as many functions as do not vanish at a place: all of them for radial ones that are not compact. Bounds take a value and at most 64 ranges, which
/// are made once, at the cost of all functions on all simplices for radial ones.
///
/// ```
/// use std::sync::Arc;
/// use zeroset::basis::{Kernel, Radial, Tail};
/// use zeroset::contour::{FieldContourParams, contour_field};
/// use zeroset::domain::SimplicialMesh;
/// use zeroset::field::ExpansionField;
///
/// // One Gaussian less a half: a ball of radius sqrt(ln 2).
/// let domain = SimplicialMesh::<3>::lattice([-1.5; 3], [1.5; 3], [6; 3])?;
/// let basis = Radial::new(domain, Kernel::Gaussian { width: 1.0 }, vec![[0.0; 3]], Tail::Constant)?;
/// let field = ExpansionField::new(Arc::new(basis), vec![-1.0, 0.5])?;
/// let (mesh, _) = contour_field(&field, &FieldContourParams { cell: 0.05, bounds: None }, &())?;
/// let volume = zeroset::mesh::topology(&mesh)?.volume.expect("it is closed");
/// let exact = 4.0 / 3.0 * std::f64::consts::PI * 2.0_f64.ln().powf(1.5);
/// assert!((volume - exact).abs() < 0.002 * exact);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct ExpansionField {
    basis: Arc<dyn Basis<3> + Send>,
    coefficients: Vec<f64>,
    low: Vec3,
    high: Vec3,
    /// Ranges of F on the cells of grids over the box, from one cell up to the finest, which halve from one to the next.
    levels: Vec<Vec<Span>>,
    rounding: f64,
}

impl std::fmt::Debug for ExpansionField {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let functions = self.coefficients.len();
        write!(f, "ExpansionField {{ functions: {functions}, low: {:?}, high: {:?} }}", self.low, self.high)
    }
}

impl ExpansionField {
    /// F of given coefficients, one for each function of a basis.
    ///
    /// # Errors
    /// If their number is wrong, one is not finite, or the domain does not fill a box.
    pub fn new(basis: Arc<dyn Basis<3> + Send>, coefficients: Vec<f64>) -> Result<Self, FieldError> {
        super::finite("a coefficient", &coefficients)?;
        if coefficients.len() != basis.len() {
            return Err(FieldError::Empty("a number of coefficients that differs from that of the functions"));
        }
        let domain = basis.domain();
        let (low, high) = crate::domain::bounds(domain.vertices().iter().copied());
        let volume: f64 = (0..domain.len()).map(|simplex| domain.volume(simplex)).sum();
        let whole: f64 = (0..3).map(|a| high[a] - low[a]).product();
        if (volume - whole).abs() > FILLED * whole {
            return Err(FieldError::Empty(
                "the domain of a fit does not fill a box, so that F is not known everywhere: take a lattice, or sites at the corners",
            ));
        }
        let rounding = ROUNDING * coefficients.iter().map(|c| c.abs()).sum::<f64>();
        let spans: Vec<Span> =
            (0..domain.len()).into_par_iter().map(|simplex| basis.span(simplex, &coefficients)).collect();
        let finest = (domain.len().ilog2() / 3).min(MOST_LEVELS);
        let mut field = Self { levels: Vec::new(), basis, coefficients, low, high, rounding };
        let mut finer = field.splat(&spans, finest);
        for level in (0..finest).rev() {
            let coarser = halved(&finer, level);
            field.levels.push(std::mem::replace(&mut finer, coarser));
        }
        field.levels.push(finer);
        field.levels.reverse();
        Ok(field)
    }

    /// The function itself.
    #[must_use]
    pub fn expansion(&self) -> Expansion<'_, 3> {
        Expansion::new(&*self.basis, &self.coefficients)
    }

    /// Ranges on the cells of a grid, from those on simplices.
    fn splat(&self, spans: &[Span], level: u32) -> Vec<Span> {
        let domain = self.basis.domain();
        let mut cells = vec![Span::EMPTY; 1 << (3 * level)];
        for (simplex, span) in spans.iter().enumerate() {
            let corners = domain.simplex(simplex).iter().map(|&v| domain.vertices()[v as usize]);
            let (low, high) = crate::domain::bounds(corners);
            self.for_cells(level, low, high, |cell| cells[cell] = cells[cell].hull(*span));
        }
        cells
    }

    /// Goes through the cells of a grid that touch a box.
    fn for_cells(&self, level: u32, low: Vec3, high: Vec3, mut visit: impl FnMut(usize)) {
        let last = (1_u32 << level) - 1;
        let place = |p: Vec3, slack: f64| -> [usize; 3] {
            std::array::from_fn(|a| {
                let t = (p[a] - self.low[a]) / (self.high[a] - self.low[a]) * f64::from(last + 1);
                // As integers saturate, what lies beyond goes to the cells at the rim.
                ((t + slack).floor() as u32).min(last) as usize
            })
        };
        // Touching is enough.
        let (first, end) = (place(low, -1e-9), place(high, 1e-9));
        for k in first[2]..=end[2] {
            for j in first[1]..=end[1] {
                for i in first[0]..=end[0] {
                    visit(i | j << level | k << (2 * level));
                }
            }
        }
    }

    /// The nearest position of the domain.
    fn clamped(&self, p: Vec3) -> Vec3 {
        std::array::from_fn(|a| p[a].clamp(self.low[a], self.high[a]))
    }

    /// The place of a position of the domain.
    fn place(&self, p: Vec3) -> Place<3> {
        let domain = self.basis.domain();
        let middle = vec3::lerp(self.low, self.high, 0.5);
        // On the rim a position may be outside by rounding.
        let found = domain.locate(p).or_else(|| domain.locate(vec3::lerp(p, middle, 1e-12)));
        found.unwrap_or_else(|| Place { simplex: 0, barycentric: domain.barycentric(0, p), position: p })
    }

    /// Whether F has a sign on a whole box, as far as bounds tell after some halvings.
    fn has_sign(&self, low: Vec3, high: Vec3, negative: bool, halvings: u32) -> bool {
        let bounds = self.bounds(low, high);
        if bounds.high < 0.0 || bounds.low > 0.0 {
            return (bounds.high < 0.0) == negative;
        }
        if halvings == 0 || (self.value(vec3::lerp(low, high, 0.5)) < 0.0) != negative {
            return false;
        }
        let middle = vec3::lerp(low, high, 0.5);
        let part = |k: usize, a: usize| if k >> a & 1 == 0 { [low[a], middle[a]] } else { [middle[a], high[a]] };
        let is_whole = |k: usize| (0..3).all(|a| low[a] < high[a] || k >> a & 1 == 0);
        (0..8).filter(|&k| is_whole(k)).all(|k| {
            let [from, to] = [0, 1].map(|end| std::array::from_fn(|a| part(k, a)[end]));
            self.has_sign(from, to, negative, halvings - 1)
        })
    }
}

/// A grid with half the cells along each axis.
fn halved(finer: &[Span], level: u32) -> Vec<Span> {
    let side = 1_usize << level;
    let cell = |i: usize| {
        let place = [i & (side - 1), i >> level & (side - 1), i >> (2 * level)];
        let child = |k: usize| {
            let [x, y, z]: [usize; 3] = std::array::from_fn(|a| 2 * place[a] + (k >> a & 1));
            finer[x | y << (level + 1) | z << (2 * (level + 1))]
        };
        (0..8).map(child).fold(Span::EMPTY, Span::hull)
    };
    (0..1 << (3 * level)).map(cell).collect()
}

impl Field for ExpansionField {
    fn value(&self, p: [f64; 3]) -> f64 {
        self.expansion().value_at(&self.place(self.clamped(p)))
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let gradient = self.expansion().gradient_at(&self.place(self.clamped(p)));
        let is_within = |a: usize| self.low[a] <= p[a] && p[a] <= self.high[a];
        std::array::from_fn(|a| if is_within(a) { gradient[a] } else { 0.0 })
    }

    fn metric(&self) -> Metric {
        Metric::Sign
    }

    fn lipschitz(&self) -> f64 {
        self.levels[0][0].slope
    }

    fn bounds(&self, low: [f64; 3], high: [f64; 3]) -> Interval {
        let (low, high) = (self.clamped(low), self.clamped(high));
        // The finest grid of which the box touches few cells.
        let share = (0..3).map(|a| (high[a] - low[a]) / (self.high[a] - self.low[a])).fold(0.0, f64::max);
        let finest = self.levels.len() - 1;
        let level = (0..finest).take_while(|&level| share * f64::from(1_u32 << level) <= 1.0).count();
        let mut span = Span::EMPTY;
        self.for_cells(level as u32, low, high, |cell| span = span.hull(self.levels[level][cell]));
        let middle = vec3::lerp(low, high, 0.5);
        let near = Interval::around(
            self.value(middle),
            span.slope * (0.5 * vec3::distance(low, high)) * (1.0 + 1e-9) + self.rounding,
        );
        let wide = Interval { low: span.low - self.rounding, high: span.high + self.rounding };
        let both = Interval { low: near.low.max(wide.low), high: near.high.min(wide.high) };
        if both.low <= both.high { both } else { Interval::ALL }
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        let sign = self.value(self.low) < 0.0;
        // The surface must not go through the rim of the domain.
        let is_clear = |a: usize, at: f64| {
            let (mut low, mut high) = (self.low, self.high);
            (low[a], high[a]) = (at, at);
            self.has_sign(low, high, sign, MOST_LEVELS)
        };
        (0..3).all(|a| is_clear(a, self.low[a]) && is_clear(a, self.high[a])).then_some([self.low, self.high])
    }
}
