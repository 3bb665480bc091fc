//! The cascade's operator and fixed point against the general fit, on a lattice small enough for both.

use std::collections::BTreeMap;

use super::*;
use crate::basis::P1;
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{
    Data, MeanGradient, Normalization, NormalizedFit, Order0, Order1, Smoothness, SquaredGradient,
};

/// Nodes along an axis.
const NODES: u32 = 16;

/// One point in each cell that a sphere cuts. Coordinates are multiples of 1/16 of a cell, so that the cascade's f32 moments are exact.
struct Ball {
    placed: Placed,
    points: Vec<[f64; 3]>,
    basis: P1<3>,
}

impl Ball {
    fn new() -> Self {
        let lattice = Lattice::around([0.0; 3], [12.0; 3], 1.0, 0.1).unwrap();
        assert_eq!((lattice.finest, lattice.nodes_at(0)), (0, [NODES; 3]));
        let distance = |p: [f64; 3]| p.iter().map(|c| (c - 7.4) * (c - 7.4)).sum::<f64>().sqrt() - 4.3;
        let mut chance = Chance::new(5, 304, 0);
        let mut points = Vec::new();
        for cell in 0..15_usize.pow(3) {
            let corner = [cell % 15, cell / 15 % 15, cell / 225].map(|c| c as f64);
            let at = |bits: usize| distance(std::array::from_fn(|a| corner[a] + (bits >> a & 1) as f64));
            if (0..8).all(|bits| at(bits) > 0.0) || (0..8).all(|bits| at(bits) < 0.0) {
                continue;
            }
            // The best of some points whose fractions are all different, so that each lies inside a tetrahedron.
            let mut best = (f64::INFINITY, [0.0; 3]);
            for _ in 0..60 {
                let sixteenths = [(); 3].map(|()| 1.0 + (chance.uniform() * 15.0).floor());
                let p: [f64; 3] = std::array::from_fn(|a| corner[a] + sixteenths[a] / 16.0);
                let [x, y, z] = sixteenths;
                if x != y && y != z && x != z && distance(p).abs() < best.0 {
                    best = (distance(p).abs(), p);
                }
            }
            points.push(std::array::from_fn(|a| lattice.origin[a] + best.1[a]));
        }
        let last = lattice.origin.map(|c| c + f64::from(NODES - 1));
        let domain = SimplicialMesh::lattice(lattice.origin, last, [NODES - 1; 3]).unwrap();
        let placed = Placed { points: LatticePoints::new(&lattice, &points), lattice };
        Self { placed, points, basis: P1::new(domain) }
    }

    /// The points, each with the cascade's weight in E.
    fn data(&self) -> Data<3> {
        let mut data = Data::new();
        data.points(&self.points, f64::from(ALPHA)).unwrap();
        data
    }
}

/// A node's number in the mesh.
fn number(node: [i64; 3]) -> usize {
    let n = i64::from(NODES);
    (node[0] + n * (node[1] + n * node[2])) as usize
}

/// Where each node of the mesh is stored on the level.
fn stored(level: &Level) -> Vec<usize> {
    let mut at = vec![0; (NODES * NODES * NODES) as usize];
    for (b, local, node) in nodes(&level.blocks) {
        at[number(node)] = b * 512 + local;
    }
    at
}

fn is_interior(number: usize) -> bool {
    let n = NODES as usize;
    [number % n, number / n % n, number / (n * n)].iter().all(|&c| c > 0 && c < n - 1)
}

#[test]
fn the_operator_is_the_gram_matrix_and_the_stiffness_matrix() {
    let ball = Ball::new();
    let data = ball.data();
    let mut gram = BTreeMap::new();
    let fit = NormalizedFit::new(&ball.basis, &data);
    for (i, j, value) in fit.smoothness(&Order0).energy_matrix().unwrap() {
        gram.insert((i, j), value);
    }
    let mut stiffness = BTreeMap::new();
    let order = Order1 { weight: 1.0 };
    Smoothness::<3>::squares(&order, &ball.basis, &mut |weight, indices, values| {
        for (&i, &u) in indices.iter().zip(values) {
            for (&j, &v) in indices.iter().zip(values).filter(|(j, _)| **j <= i) {
                *stiffness.entry((i as usize, j as usize)).or_insert(0.0) += weight * u * v;
            }
        }
    });
    let bare = ball.placed.dense(0, FixedFaces::None, 0.0, false);
    let full = ball.placed.dense(0, FixedFaces::None, ALPHA, false);
    let at = stored(&full);
    let (mut x, mut l, mut a) = (vec![0.0_f64; full.len()], vec![0.0; full.len()], vec![0.0; full.len()]);
    let mut compared = 0;
    for column in (0..at.len()).filter(|&c| is_interior(c)) {
        x[at[column]] = 1.0;
        apply(&bare, &x, &mut l);
        apply(&full, &x, &mut a);
        x[at[column]] = 0.0;
        for row in (0..at.len()).filter(|&r| r >= column) {
            let expected = stiffness.get(&(row, column)).copied().unwrap_or(0.0);
            assert!((l[at[row]] - expected).abs() < 1e-12, "stiffness {row} {column}: {} {expected}", l[at[row]]);
            let expected = gram.get(&(row, column)).copied().unwrap_or(0.0);
            let found = a[at[row]] - l[at[row]];
            assert!((found - expected).abs() < 1e-12, "Gram {row} {column}: {found} {expected}");
            compared += usize::from(expected != 0.0);
        }
    }
    assert!(compared > 2000, "{compared}");
}

#[test]
fn the_fixed_point_with_the_mean_gradient_is_the_same() {
    let ball = Ball::new();
    let data = ball.data();
    let order = Order1 { weight: 1.0 };
    // Both hold F at zero on the faces of the box.
    let mut problem = NormalizedFit::new(&ball.basis, &data).smoothness(&order).problem().unwrap();
    let kept: Vec<usize> = (0..problem.unknown.len()).filter(|&j| is_interior(j)).collect();
    problem.energy = problem.energy.restricted(&kept);
    problem.unknown.fill(None);
    for (place, &j) in kept.iter().enumerate() {
        problem.unknown[j] = Some(place as u32);
    }
    for gradient in [Gradient::Recovered, Gradient::Element] {
        let start = SquaredGradient { gradient }.minimise(&problem).unwrap().coefficients;
        let mut all = vec![0.0; problem.unknown.len()];
        kept.iter().zip(&start).for_each(|(&j, &f)| all[j] = f);
        let mean = MeanGradient { gradient, start: Some(all.clone()), tolerance: 1e-13, ..MeanGradient::default() };
        let expected = mean.minimise(&problem).unwrap().coefficients;

        let mut level = ball.placed.dense(0, FixedFaces::All, ALPHA, false);
        level.gradient = gradient;
        let at = stored(&level);
        let mut f = vec![0.0_f64; level.len()];
        all.iter().zip(&at).for_each(|(&v, &i)| f[i] = v);
        let found = at_rest(&level, f);
        let found: Vec<f64> = kept.iter().map(|&j| found[at[j]]).collect();
        // The same up to a factor: the general fit has N = 1.
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let factor = product(&found, &expected) / product(&expected, &expected);
        let largest = found.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        for (f, e) in found.iter().zip(&expected) {
            assert!((f - factor * e).abs() < 1e-8 * largest, "{gradient:?}: {f} {}", factor * e);
        }
    }
}

/// The cascade's steps on a level, in f64 and with every system solved to rounding, until F moves no more.
fn at_rest(level: &Level, mut f: Vec<f64>) -> Vec<f64> {
    let n = level.len();
    for _ in 0..2000 {
        let [mut x, mut y, mut z, mut rhs] = std::array::from_fn(|_| vec![0.0; n]);
        linearise(level, &f, [&mut x, &mut y, &mut z], &mut rhs);
        let mut next = f.clone();
        let mut residual = vec![0.0; n];
        apply(level, &next, &mut residual);
        residual.iter_mut().zip(&rhs).for_each(|(r, b)| *r = b - *r);
        let scale = rhs.iter().map(|r| r * r).sum::<f64>().sqrt();
        let params = SolveParams { tolerance: 1e-14, max_steps: 2000 };
        conjugate_gradients(level, &mut next, &mut residual, [&mut x, &mut y, &mut z], scale, params);
        let largest = next.iter().fold(0.0_f64, |m, f| m.max(f.abs()));
        let moved = next.iter().zip(&f).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
        f = next;
        if moved <= 1e-12 * largest {
            return f;
        }
    }
    panic!("the steps did not come to rest");
}
