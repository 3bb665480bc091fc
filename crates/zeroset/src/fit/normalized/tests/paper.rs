//! The paper's 13-point example.

use crate::basis::P1;
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Data, NormalizedFit, Solver};

/// The points as printed.
pub(super) const THIRTEEN: [[f64; 2]; 13] = [
    [0.44, 0.13],
    [0.24, 0.15],
    [0.22, 0.35],
    [0.31, 0.49],
    [0.35, 0.60],
    [0.43, 0.70],
    [0.51, 0.77],
    [0.57, 0.70],
    [0.70, 0.55],
    [0.85, 0.30],
    [0.88, 0.23],
    [0.80, 0.10],
    [0.60, 0.10],
];

#[test]
fn the_thirteen_points_have_the_known_eigenvector() {
    let basis = P1::new(SimplicialMesh::four_triangles([0.0, 0.0], [1.0, 1.0]).unwrap());
    let mut data = Data::new();
    data.points(&THIRTEEN, 1.0).unwrap();
    for solver in [Solver::Auto, Solver::Dense, Solver::ShiftInvert, Solver::Lobpcg] {
        let fitted = NormalizedFit::new(&basis, &data).solver(solver).run().unwrap();
        assert!((fitted.rayleigh_quotient - 0.043_397_2).abs() < 1e-7, "{solver:?}: {fitted:?}");
        let expected = [0.165_637, 0.092_039, 0.352_474, 0.840_197, -0.365_958];
        for (found, expected) in fitted.coefficients.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-6, "{solver:?}: {:?}", fitted.coefficients);
        }
        assert!(fitted.diagnosis.warnings.is_empty(), "{:?}", fitted.diagnosis);
        let gap = fitted.gap().unwrap();
        assert!((gap - 0.054_732_8).abs() < 1e-7, "{gap}");
        assert!((fitted.residual_rms.powi(2) * 13.0 - fitted.rayleigh_quotient).abs() < 1e-12);
    }
}
