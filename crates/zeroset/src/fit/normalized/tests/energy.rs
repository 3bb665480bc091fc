//! Energies of smoothness are the integrals that they stand for.

use nalgebra::DMatrix;

use super::{bases, interpolated, meshes_2d, meshes_3d};
use crate::basis::{Basis, Kernel, P1, P2, Radial, Tail};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Order1, Order2, Smoothness};

const ORDER1: Order1 = Order1 { weight: 1.0 };
const ORDER2: Order2 = Order2 { weight: 1.0 };

/// The matrix of an energy.
fn matrix<const D: usize>(energy: &dyn Smoothness<D>, basis: &dyn Basis<D>) -> DMatrix<f64> {
    let mut matrix = DMatrix::zeros(basis.len(), basis.len());
    energy.squares(basis, &mut |weight, indices, values| {
        for (&i, &u) in indices.iter().zip(values) {
            for (&j, &v) in indices.iter().zip(values) {
                matrix[(i as usize, j as usize)] += weight * u * v;
            }
        }
    });
    matrix
}

/// The energy of F.
fn of<const D: usize>(energy: &dyn Smoothness<D>, basis: &dyn Basis<D>, f: &[f64]) -> f64 {
    let mut sum = 0.0;
    energy.squares(basis, &mut |weight, indices, values| {
        let value: f64 = indices.iter().zip(values).map(|(&j, v)| f[j as usize] * v).sum();
        sum += weight * value * value;
    });
    sum
}

#[test]
fn order_1_on_a_lattice_is_the_stencil_of_the_laplacian() {
    fn check<const D: usize>() {
        const CELLS: u32 = 4;
        const SIDE: f64 = 0.3;
        let side = SIDE * f64::from(CELLS);
        let basis = P1::new(SimplicialMesh::lattice([0.0; D], [side; D], [CELLS; D]).unwrap());
        let matrix = matrix(&Order1 { weight: 2.0 }, &basis);
        let nodes = basis.domain().vertices();
        let is_inner = |v: &[f64; D]| v.iter().all(|&c| c > 0.5 * SIDE && c < side - 0.5 * SIDE);
        let mut compared = 0;
        for i in (0..nodes.len()).filter(|&i| is_inner(&nodes[i])) {
            for j in 0..nodes.len() {
                // By how many sides of cells they are apart, along the axes.
                let apart: f64 = (0..D).map(|a| ((nodes[i][a] - nodes[j][a]) / SIDE).abs().round()).sum();
                let stencil = match apart as usize {
                    0 => 2.0 * D as f64,
                    1 => -1.0,
                    _ => 0.0,
                };
                let expected = 2.0 * SIDE.powi(D as i32 - 2) * stencil;
                assert!((matrix[(i, j)] - expected).abs() < 1e-13, "D {D}: {} {expected}", matrix[(i, j)]);
                compared += usize::from(expected != 0.0);
            }
        }
        assert_eq!(compared, 3_usize.pow(D as u32) * (2 * D + 1));
    }
    check::<2>();
    check::<3>();
}

/// How many dimensions an energy leaves free: its eigenvalues that are zero, with functions scaled to equal energy.
fn kernel<const D: usize>(energy: &dyn Smoothness<D>, basis: &dyn Basis<D>) -> usize {
    let mut matrix = matrix(energy, basis);
    let scale: Vec<f64> = matrix.diagonal().iter().map(|d| 1.0 / d.sqrt()).collect();
    for ((i, j), scaled) in (0..matrix.len()).map(|k| (k % scale.len(), k / scale.len())).zip(matrix.iter_mut()) {
        *scaled *= scale[i] * scale[j];
    }
    let mut values: Vec<f64> = matrix.symmetric_eigenvalues().iter().copied().collect();
    values.sort_unstable_by(f64::total_cmp);
    let zero = values.iter().filter(|v| v.abs() < 1e-13 * basis.len() as f64).count();
    // What is not zero is so by far: the meshes are coarse, and no simplex is very flat.
    assert!(values[zero] > 1e-6, "D {D}: {:?}", &values[..zero + 2]);
    zero
}

#[test]
fn order_1_leaves_constants_free_and_order_2_linear_functions() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        for (degree, basis) in bases(mesh) {
            let linear = interpolated(&*basis, |p| 2.0 * p[0] - p[D - 1] + 0.5);
            let ones = vec![1.0; basis.len()];
            let size = |energy: &dyn Smoothness<D>| matrix(energy, &*basis).trace();
            // Rounding: the sum of squares of sums that cancel.
            assert!(of(&ORDER1, &*basis, &ones) < 1e-28 * size(&ORDER1));
            assert!(of(&ORDER2, &*basis, &linear) < 1e-28 * size(&ORDER2));
            // |grad F|^2 = 5 over a volume of 1.
            assert!((of(&ORDER1, &*basis, &linear) - 5.0).abs() < 1e-12);
            assert_eq!(kernel(&ORDER1, &*basis), 1, "order 1, D {D}, degree {degree}");
            assert_eq!(kernel(&ORDER2, &*basis), D + 1, "order 2, D {D}, degree {degree}");
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

#[test]
fn order_2_of_a_quadratic_is_its_integral_on_p2() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        let basis = P2::new(mesh.clone());
        // Second derivatives: 6 along x, -1 in the mixed one, 2 along the last axis.
        let f = interpolated(&basis, |p| 3.0 * p[0] * p[0] - p[0] * p[D - 1] + p[D - 1] * p[D - 1] + p[1] - 4.0);
        let found = of(&ORDER2, &basis, &f);
        assert!((found - 42.0).abs() < 1e-9, "D {D}: {found}");
        assert!((of(&Order2 { weight: 0.5 }, &basis, &f) - 21.0).abs() < 1e-9);
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

#[test]
fn order_2_of_a_square_is_its_integral_but_for_the_rim_on_p1() {
    fn check<const D: usize>() {
        const CELLS: u32 = 6;
        let basis = P1::new(SimplicialMesh::lattice([0.0; D], [1.5; D], [CELLS; D]).unwrap());
        for axis in 0..D {
            let f = interpolated(&basis, |p| p[axis] * p[axis]);
            // The second derivative is 2; of the planes of faces across the axis all but one of the two on the rim are there.
            let expected = 4.0 * 1.5_f64.powi(D as i32) * (1.0 - 1.0 / f64::from(CELLS));
            let found = of(&ORDER2, &basis, &f);
            assert!((found / expected - 1.0).abs() < 1e-12, "D {D}, axis {axis}: {found} {expected}");
        }
    }
    check::<2>();
    check::<3>();
}

#[test]
fn order_1_of_a_smooth_function_converges_to_its_integral() {
    fn check<const D: usize>(cells: u32) {
        let exact = {
            // F = sin(2 x) cos(y), constant along z: 4 cos^2(2x) cos^2(y) + sin^2(2x) sin^2(y) over the unit square.
            let (c, s) = (0.5 + 4.0_f64.sin() / 8.0, 0.5 - 4.0_f64.sin() / 8.0);
            let (cy, sy) = (0.5 + 2.0_f64.sin() / 4.0, 0.5 - 2.0_f64.sin() / 4.0);
            4.0 * c * cy + s * sy
        };
        let errors = [cells, 2 * cells].map(|cells| {
            let mesh = SimplicialMesh::<D>::lattice([0.0; D], [1.0; D], [cells; D]).unwrap();
            bases(&mesh).map(|(_, basis)| {
                let f = interpolated(&*basis, |p| (2.0 * p[0]).sin() * p[1].cos());
                (of(&ORDER1, &*basis, &f) / exact - 1.0).abs()
            })
        });
        let [[coarse1, coarse2], [fine1, fine2]] = errors;
        // The energy of an interpolant is off by the square of the cell, on P2 by its third power at least.
        assert!(coarse1 / fine1 > 3.5 && coarse2 / fine2 > 7.0, "D {D}: {errors:?}");
        assert!(fine1 < 0.01 && fine2 < 1e-4, "D {D}: {errors:?}");
    }
    check::<2>(6);
    check::<3>(4);
}

#[test]
fn energies_of_a_gaussian_are_its_integrals() {
    fn check<const D: usize>(cells: u32) {
        let width = 0.5_f64;
        // So wide that what lies outside is 1e-6 of the whole, with cells of half the width.
        let half = 0.25 * width * f64::from(cells);
        let mesh = SimplicialMesh::lattice([-half; D], [half; D], [cells; D]).unwrap();
        let centre = std::array::from_fn(|a| 0.07 * (a as f64 - 0.8));
        let basis = Radial::new(mesh, Kernel::Gaussian { width }, vec![centre], Tail::None).unwrap();
        let d = D as f64;
        let volume = (std::f64::consts::FRAC_PI_2 * width * width).powf(0.5 * d);
        let first = of(&ORDER1, &basis, &[1.0]) / (d / width.powi(2) * volume);
        let second = of(&ORDER2, &basis, &[1.0]) / (d * (d + 2.0) / width.powi(4) * volume);
        // On a lattice any rule errs only by the spectrum of the integrand at the frequency of the cells, exp(-2 pi^2) = 3e-9 of it, times
        // the square of the frequency for each derivative; and by what lies outside.
        assert!((first - 1.0).abs() < 1e-6, "D {D}: {first}");
        assert!((second - 1.0).abs() < 1e-6, "D {D}: {second}");
    }
    check::<2>(14);
    check::<3>(14);
}

#[test]
fn a_tail_has_the_energy_of_its_linear_function() {
    let mesh = SimplicialMesh::lattice([0.0; 2], [2.0, 1.0], [8, 4]).unwrap();
    let basis = Radial::new(mesh, Kernel::Gaussian { width: 0.5 }, vec![[0.5; 2]], Tail::Linear).unwrap();
    // 1, then coordinates from -1 to 1 over the longest side: gradients of length 1 over an area of 2.
    assert_eq!(of(&ORDER1, &basis, &[0.0, 1.0, 0.0, 0.0]), 0.0);
    assert!((of(&ORDER1, &basis, &[0.0, 9.0, 1.0, 0.0]) - 2.0).abs() < 1e-12);
    assert_eq!(of(&ORDER2, &basis, &[0.0, 1.0, 2.0, 3.0]), 0.0);
}
