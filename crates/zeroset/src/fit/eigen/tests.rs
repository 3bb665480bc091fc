//! The three ways agree.

use super::*;
use crate::sample::Chance;

/// Second differences on an n x n grid, a little scrambled, and M of a given rank (all of the diagonal if none is given).
fn pencil(n: usize, rank: Option<usize>) -> (Matrix, Option<Matrix>) {
    let mut chance = Chance::new(3, 303, 0);
    let mut energy = MatrixBuilder::new(n * n, false);
    for y in 0..n {
        for x in 0..n {
            let i = x + n * y;
            energy.add(i, i, 1e-3 * (1.0 + chance.uniform()));
            for j in [(x + 1 < n).then_some(i + 1), (y + 1 < n).then_some(i + n)].into_iter().flatten() {
                energy.add_outer(1.0 + chance.uniform(), &[i as u32, j as u32], &[1.0, -1.0]);
            }
        }
    }
    let mass = rank.map(|rank| {
        let mut mass = MatrixBuilder::new(n * n, false);
        for _ in 0..rank {
            let at = (chance.uniform() * (n * (n - 2)) as f64) as u32;
            mass.add_outer(1.0, &[at, at + 1, at + n as u32], &[chance.normal(), chance.normal(), chance.normal()]);
        }
        mass.finish()
    });
    (energy.finish(), mass)
}

#[test]
fn dense_shift_invert_and_lobpcg_agree() {
    for rank in [None, Some(40), Some(400)] {
        let (energy, mass) = pencil(20, rank);
        let pencil = Pencil { energy: &energy, mass: mass.as_ref(), dimension: 2 };
        let exact = pencil.smallest(4, Solver::Dense, &()).unwrap();
        for solver in [Solver::ShiftInvert, Solver::Lobpcg] {
            let found = pencil.smallest(4, solver, &()).unwrap();
            for k in 0..4 {
                let (a, b) = (found.values[k], exact.values[k]);
                assert!((a / b - 1.0).abs() < 1e-8, "{rank:?} {solver:?} {k}: {a} {b}");
                let mut image = vec![0.0; 400];
                pencil.mass_times(&exact.vectors[k], &mut image);
                let along = dot(&found.vectors[k], &image).abs();
                assert!((along - 1.0).abs() < 1e-8, "{rank:?} {solver:?} {k}: {along}");
            }
        }
    }
}

#[test]
fn a_singular_energy_has_the_value_zero_in_every_way() {
    // No diagonal: constants have no energy.
    let n = 12;
    let mut energy = MatrixBuilder::new(n, false);
    for i in 1..n {
        energy.add_outer(1.0, &[i as u32 - 1, i as u32], &[1.0, -1.0]);
    }
    let energy = energy.finish();
    let pencil = Pencil { energy: &energy, mass: None, dimension: 2 };
    for solver in [Solver::Dense, Solver::ShiftInvert, Solver::Lobpcg] {
        let found = pencil.smallest(2, solver, &()).unwrap();
        let second = 2.0 - 2.0 * (std::f64::consts::PI / n as f64).cos();
        assert!(found.values[0] < 1e-14 && (found.values[1] - second).abs() < 1e-10, "{solver:?} {:?}", found.values);
    }
}

#[test]
fn matrices_agree_with_their_dense_form() {
    let (energy, mass) = pencil(6, Some(9));
    let mass = mass.unwrap();
    let sum = energy.plus(0.5, &mass).plus_diagonal(2.0);
    let dense = sum.to_dense();
    let x: Vec<f64> = (0..36).map(|i| (i as f64).sin()).collect();
    let mut y = vec![0.0; 36];
    sum.multiply(&x, &mut y);
    for i in 0..36 {
        let expected: f64 = (0..36).map(|j| dense[(i, j)] * x[j]).sum();
        assert!((y[i] - expected).abs() < 1e-12);
    }
    sum.factor().expect("the sum is positive definite").solve(&mut y);
    assert!(x.iter().zip(&y).all(|(a, b)| (a - b).abs() < 1e-10));
    assert!(energy.plus_diagonal(-1.0).factor().is_none());
    let kept = [1, 4, 30];
    let part = sum.restricted(&kept).to_dense();
    assert!((0..9).all(|k| part[(k / 3, k % 3)] == dense[(kept[k / 3], kept[k % 3])]));
}
