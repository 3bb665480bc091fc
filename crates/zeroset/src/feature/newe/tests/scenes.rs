//! Corners with a known truth.

use crate::feature::newe::Flat;
use crate::sample::Chance;
use crate::vec3::{Vec3, add, add_scaled, cross, dot, norm, normalized, scale};

/// Points and the flats they were drawn from, which meet in `corner`.
pub(super) struct Truth<const D: usize> {
    pub(super) points: Vec<[f64; D]>,
    pub(super) flats: Vec<Flat<D>>,
    pub(super) corner: [f64; D],
}

impl<const D: usize> Truth<D> {
    /// Largest angle between flats that belong together, in degrees, for the best way to pair them. Infinite if there are not as many.
    pub(super) fn angle_deg(&self, found: &[Flat<D>]) -> f64 {
        if found.len() != self.flats.len() {
            return f64::INFINITY;
        }
        let mut order: Vec<usize> = (0..found.len()).collect();
        let mut best = f64::INFINITY;
        permute(&mut order, 0, &mut |order| {
            let worst = order.iter().zip(&self.flats).map(|(&j, flat)| found[j].angle(flat)).fold(0.0, f64::max);
            best = best.min(worst.to_degrees());
        });
        best
    }

    /// Adds outliers, uniform in the box around the points, until they are this share of all.
    pub(super) fn with_outliers(mut self, share: f64, chance: &mut Chance) -> Self {
        let mut ends = [[f64::INFINITY, f64::NEG_INFINITY]; D];
        for point in &self.points {
            for a in 0..D {
                ends[a] = [ends[a][0].min(point[a]), ends[a][1].max(point[a])];
            }
        }
        let added = (self.points.len() as f64 * share / (1.0 - share)).round() as usize;
        self.points.extend((0..added).map(|_| ends.map(|[low, high]| chance.between(low, high))));
        self
    }
}

fn permute(order: &mut [usize], from: usize, each: &mut impl FnMut(&[usize])) {
    if from == order.len() {
        return each(order);
    }
    for i in from..order.len() {
        order.swap(from, i);
        permute(order, from + 1, each);
        order.swap(from, i);
    }
}

/// Two arms of length 1: an angle of 0.5 to 2.6, shares of 30:70 to 70:30, anywhere.
pub(super) fn planar_corner(chance: &mut Chance, points: usize, noise: f64) -> Truth<2> {
    let angle = chance.between(0.5, 2.6);
    let first = (chance.between(0.3, 0.7) * points as f64) as usize;
    let turn = chance.between(0.0, std::f64::consts::TAU);
    let corner = [chance.between(-2.0, 2.0), chance.between(-2.0, 2.0)];
    let arms = [turn, turn + angle].map(|a| [a.cos(), a.sin()]);
    let points = (0..points)
        .map(|i| {
            let (arm, t) = (arms[usize::from(i >= first)], chance.uniform());
            std::array::from_fn(|a| corner[a] + t * arm[a] + noise * chance.normal())
        })
        .collect();
    let flats = arms.iter().filter_map(|arm| Flat::through(corner, [-arm[1], arm[0]])).collect();
    Truth { points, flats, corner }
}

/// How three planes meet.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Corner {
    /// Three faces of one quadrant each, as at the outside of a box.
    Outside,
    /// One face of three quadrants and two of one: a saddle, as where a notch meets a face.
    Notch,
}

/// Three planes with dihedral angles of 60 to 120 degrees, anywhere; points even over the area.
pub(super) fn spatial_corner(chance: &mut Chance, kind: Corner, points: usize, noise: f64) -> Truth<3> {
    let normals = loop {
        let normals: [Vec3; 3] = std::array::from_fn(|_| chance.direction());
        let far = |a: usize, b: usize| dot(normals[a], normals[b]).abs() <= 0.5;
        // Three normals near one plane have no corner to speak of.
        let volume = dot(cross(normals[0], normals[1]), normals[2]).abs();
        if far(0, 1) && far(1, 2) && far(2, 0) && volume > 0.4 {
            break normals;
        }
    };
    let edge = |a: usize, b: usize| normalized(cross(normals[a], normals[b])).expect("normals differ");
    let edges = [edge(1, 2), edge(2, 0), edge(0, 1)];
    let corner = std::array::from_fn(|_| chance.between(-2.0, 2.0));
    // A patch is spanned by two edges, each with a sign.
    let patches: Vec<[Vec3; 2]> = match kind {
        Corner::Outside => vec![[edges[1], edges[2]], [edges[2], edges[0]], [edges[0], edges[1]]],
        Corner::Notch => {
            let [p, q] = [edges[1], edges[2]];
            let [back_p, back_q] = [scale(p, -1.0), scale(q, -1.0)];
            vec![[p, q], [back_p, q], [p, back_q], [edges[0], back_p], [edges[0], back_q]]
        }
    };
    let points = scatter(chance, &patches, corner, points, noise);
    let flats = normals.iter().filter_map(|n| Flat::through(corner, *n)).collect();
    Truth { points, flats, corner }
}

/// Points on parallelograms at a corner, even over their areas.
fn scatter(chance: &mut Chance, patches: &[[Vec3; 2]], corner: Vec3, points: usize, noise: f64) -> Vec<Vec3> {
    let areas: Vec<f64> = patches.iter().map(|[a, b]| norm(cross(*a, *b))).collect();
    let total: f64 = areas.iter().sum();
    (0..points)
        .map(|_| {
            let mut left = chance.uniform() * total;
            let at = areas.iter().position(|area| {
                left -= area;
                left < 0.0
            });
            let [a, b] = patches[at.unwrap_or(0)];
            let on = add_scaled(add_scaled(corner, a, chance.uniform()), b, chance.uniform());
            add(on, chance.normal3(noise))
        })
        .collect()
}

/// A part of a roof with one to four planes: a flat one, a ridge, a corner of three, and the tip of a hipped roof.
pub(super) fn roof(chance: &mut Chance, planes: usize, points: usize, noise: f64) -> Truth<3> {
    if planes == 3 {
        let kind = if chance.uniform() < 0.5 { Corner::Outside } else { Corner::Notch };
        return spatial_corner(chance, kind, points, noise);
    }
    let slope = chance.between(20_f64.to_radians(), 50_f64.to_radians());
    let (sin, cos) = slope.sin_cos();
    let corner: Vec3 = std::array::from_fn(|_| chance.between(-2.0, 2.0));
    // Downhill directions.
    let sides: Vec<Vec3> = match planes {
        1 => vec![[cos, 0.0, -sin]],
        2 => vec![[cos, 0.0, -sin], [-cos, 0.0, -sin]],
        _ => vec![[cos, 0.0, -sin], [-cos, 0.0, -sin], [0.0, cos, -sin], [0.0, -cos, -sin]],
    };
    let axes: [Vec3; 3] = {
        let z = chance.direction();
        let x = normalized(cross(z, chance.direction())).expect("directions differ");
        [x, cross(z, x), z]
    };
    let turned = |v: Vec3| add_scaled(add_scaled(scale(axes[0], v[0]), axes[1], v[1]), axes[2], v[2]);
    let level = |side: Vec3| if side[0] == 0.0 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let points = (0..points)
        .map(|i| {
            let side = sides[i % sides.len()];
            // A triangle below the tip, or a rectangle below the ridge.
            let down = if planes == 4 { chance.uniform().sqrt() } else { chance.uniform() };
            let width = if planes == 4 { down * cos } else { 1.0 };
            let on = add_scaled(scale(side, down), level(side), width * chance.between(-1.0, 1.0));
            add(add(corner, turned(on)), chance.normal3(noise))
        })
        .collect();
    let normal = |side: Vec3| turned(cross(side, level(side)));
    let flats = sides.iter().filter_map(|side| Flat::through(corner, normal(*side))).collect();
    Truth { points, flats, corner }
}
