//! Shades of F: the parts of the domain where F lies between round values.

use svg::node::element::Group;
use zeroset::basis::Expansion;
use zeroset::domain::Place;

use super::Pixel;
use super::canvas::{Canvas, round_step};
use super::color::shade;
use super::outline::Outline;

/// About how many bands the side of F with the larger values gets.
const BANDS: f64 = 10.0;
/// Triangles that all shades are made of, about.
const MOST_PARTS: usize = 60_000;
/// A triangle in which F is not linear is cut along each side into this many parts at most.
const MOST_CUTS: usize = 64;
/// Parts need be no smaller than this, in pixels.
const LEAST_PART: f64 = 6.0;

/// The shades, from the lowest values of F to the highest.
pub(super) struct Bands {
    /// The height of a band.
    pub(super) step: f64,
    /// Decimals that tell steps apart.
    pub(super) decimals: usize,
    /// Index of the lowest band; band i holds values from i to i + 1 steps.
    pub(super) first: i32,
    outlines: Vec<Outline>,
}

/// A corner of a part, with F.
#[derive(Clone, Copy)]
struct Corner {
    place: [f64; 2],
    value: f64,
}

impl Bands {
    /// `None` if F is known nowhere, or zero.
    pub(super) fn new(f: &Expansion<'_, 2>, canvas: &Canvas) -> Option<Self> {
        let parts = parts(f, canvas);
        let values = || parts.iter().flatten().map(|corner| corner.value).filter(|v| v.is_finite());
        let (low, high) = values().fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let most = high.max(-low);
        if most <= 0.0 {
            return None;
        }
        let (step, decimals) = round_step(most / BANDS);
        let first = (low / step).floor() as i32;
        let last = ((high / step).ceil() as i32).max(first + 1);
        let mut outlines: Vec<Outline> = (first..last).map(|_| Outline::default()).collect();
        for part in parts.iter().filter(|part| part.iter().all(|corner| corner.value.is_finite())) {
            let values = part.map(|corner| corner.value);
            let lowest = (values.iter().copied().fold(f64::INFINITY, f64::min) / step).floor() as i32;
            let highest = (values.iter().copied().fold(f64::NEG_INFINITY, f64::max) / step).ceil() as i32;
            for index in lowest.max(first)..highest.min(last) {
                let [low, high] = [index, index + 1].map(|i| f64::from(i) * step);
                let above = clipped(part, |value| value - low);
                let between = clipped(&above, |value| high - value);
                if between.len() > 2 {
                    let pixels: Vec<Pixel> = between.iter().map(|corner| to_pixel(corner.place)).collect();
                    outlines[(index - first) as usize].add(&pixels);
                }
            }
        }
        Some(Self { step, decimals, first, outlines })
    }

    /// The index of the band above the highest.
    pub(super) fn end(&self) -> i32 {
        self.first + self.outlines.len() as i32
    }

    /// The colour of a band.
    pub(super) fn color(&self, index: i32) -> String {
        let reach = self.end().max(-self.first);
        shade((f64::from(index) + 0.5) / f64::from(reach))
    }

    pub(super) fn draw(&self) -> Group {
        let mut group = Group::new().set("id", "shading").set("stroke-width", "0.6");
        for (index, outline) in (self.first..).zip(&self.outlines) {
            let commands = outline.commands();
            if !commands.is_empty() {
                let color = self.color(index);
                // The stroke covers the seam between bands.
                group = group.add(super::path(&commands).set("fill", color.clone()).set("stroke", color));
            }
        }
        group
    }
}

/// The part of a polygon on which a linear function of F is not negative.
fn clipped(polygon: &[Corner], height: impl Fn(f64) -> f64) -> Vec<Corner> {
    let mut kept = Vec::with_capacity(polygon.len() + 2);
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (a, b) = (height(p.value), height(q.value));
        if a >= 0.0 {
            kept.push(p);
        }
        if (a < 0.0) != (b < 0.0) {
            // Always from the lower end, so that both neighbours of an edge find the same place.
            let (low, high, t) = if a < b { (p, q, a / (a - b)) } else { (q, p, b / (b - a)) };
            let between = |x: f64, y: f64| x + t * (y - x);
            let place = [0, 1].map(|axis| between(low.place[axis], high.place[axis]));
            kept.push(Corner { place, value: between(low.value, high.value) });
        }
    }
    kept
}

/// The triangles on which F is known, cut into parts on which it is nearly linear.
fn parts(f: &Expansion<'_, 2>, canvas: &Canvas) -> Vec<[Corner; 3]> {
    let domain = f.domain();
    let cuts = if f.basis().degree() == Some(1) {
        1
    } else {
        let most = ((MOST_PARTS / domain.len()) as f64).sqrt() as usize;
        most.clamp(1, MOST_CUTS)
    };
    let mut parts = Vec::new();
    for simplex in (0..domain.len()).filter(|&s| f.is_defined(s)) {
        let corners = super::corners(domain, simplex).map(|p| canvas.place(p));
        let side = |a: usize, b: usize| (corners[a][0] - corners[b][0]).hypot(corners[a][1] - corners[b][1]);
        let longest = side(0, 1).max(side(1, 2)).max(side(2, 0));
        // All triangles of a lattice are cut alike; elsewhere a few places on an edge may not be shared, which no eye sees.
        let cuts = cuts.min((longest / LEAST_PART).ceil() as usize).max(1);
        let corner = |i: usize, j: usize| {
            let (u, v) = (i as f64 / cuts as f64, j as f64 / cuts as f64);
            let barycentric = [1.0 - u - v, u, v, 0.0];
            let position = domain.position(simplex, &barycentric);
            Corner { place: canvas.place(position), value: f.value_at(&Place { simplex, barycentric, position }) }
        };
        let rows: Vec<Vec<Corner>> = (0..=cuts).map(|j| (0..=cuts - j).map(|i| corner(i, j)).collect()).collect();
        for j in 0..cuts {
            for i in 0..cuts - j {
                parts.push([rows[j][i], rows[j][i + 1], rows[j + 1][i]]);
                if i + j + 1 < cuts {
                    parts.push([rows[j][i + 1], rows[j + 1][i + 1], rows[j + 1][i]]);
                }
            }
        }
    }
    parts
}

fn to_pixel(place: [f64; 2]) -> Pixel {
    place.map(|c| (100.0 * c).round() as i32)
}
