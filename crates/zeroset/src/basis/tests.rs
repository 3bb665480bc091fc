//! Bases keep what their pages promise.

use super::*;
use crate::sample::Chance;

/// A lattice over a box that is not the unit cube.
fn domain<const D: usize>(cells: u32) -> SimplicialMesh<D> {
    SimplicialMesh::lattice([-1.0; D], [1.5; D], [cells; D]).unwrap()
}

fn places<const D: usize>(domain: &SimplicialMesh<D>, count: usize) -> Vec<Place<D>> {
    let mut chance = Chance::new(11, 305, D);
    (0..count)
        .map(|_| domain.locate(std::array::from_fn(|_| chance.between(-0.99, 1.49))).expect("the place is inside"))
        .collect()
}

/// All monomials of up to a degree, as functions of position.
fn monomials<const D: usize>(degree: usize) -> Vec<impl Fn([f64; D]) -> f64> {
    (0..(degree + 1).pow(D as u32))
        .map(move |index| std::array::from_fn::<usize, D, _>(|a| index / (degree + 1).pow(a as u32) % (degree + 1)))
        .filter(move |powers| powers.iter().sum::<usize>() <= degree)
        .map(|powers| move |p: [f64; D]| (0..D).map(|a| p[a].powi(powers[a] as i32)).product())
        .collect()
}

fn reproduces<const D: usize>(basis: &dyn Basis<D>, degree: usize) {
    for place in places(basis.domain(), 200) {
        for (m, monomial) in monomials::<D>(degree).iter().enumerate() {
            let coefficients: Vec<f64> = (0..basis.len()).map(|j| monomial(basis.node(j).unwrap())).collect();
            let found = Expansion::new(basis, &coefficients).value_at(&place);
            assert!((found - monomial(place.position)).abs() < 1e-12, "D {D}, degree {degree}, monomial {m}: {found}");
        }
        // A partition of unity.
        let mut terms = Terms::new();
        basis.evaluate(&place, Derivatives::None, &mut terms);
        assert!((terms.values.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn polynomials_of_the_degree_are_reproduced() {
    reproduces(&P1::new(domain::<2>(5)), 1);
    reproduces(&P1::new(domain::<3>(3)), 1);
    reproduces(&P2::new(domain::<2>(5)), 2);
    reproduces(&P2::new(domain::<3>(3)), 2);
}

#[test]
fn functions_are_one_at_their_own_node_and_zero_at_the_others() {
    fn check<const D: usize>(basis: &dyn Basis<D>) {
        let mut terms = Terms::new();
        for j in 0..basis.len() {
            let place = basis.domain().locate(basis.node(j).unwrap()).unwrap();
            basis.evaluate(&place, Derivatives::None, &mut terms);
            for (&i, &value) in terms.indices.iter().zip(&terms.values) {
                let expected = if i as usize == j { 1.0 } else { 0.0 };
                assert!((value - expected).abs() < 1e-12);
            }
        }
    }
    check(&P1::new(domain::<2>(3)));
    check(&P1::new(domain::<3>(2)));
    check(&P2::new(domain::<2>(3)));
    check(&P2::new(domain::<3>(2)));
}

#[test]
fn functions_are_continuous_across_faces() {
    fn check<const D: usize>(basis: &dyn Basis<D>) {
        let domain = basis.domain();
        let mut chance = Chance::new(12, 305, D);
        let coefficients: Vec<f64> = (0..basis.len()).map(|_| chance.normal()).collect();
        let f = Expansion::new(basis, &coefficients);
        for simplex in 0..domain.len() {
            for opposite in 0..=D {
                let Some(neighbor) = domain.neighbor(simplex, opposite) else { continue };
                let mut barycentric = [0.0; 4];
                (0..=D).filter(|&c| c != opposite).for_each(|c| barycentric[c] = chance.uniform());
                let sum: f64 = barycentric.iter().sum();
                let barycentric = barycentric.map(|b| b / sum);
                let position = domain.position(simplex, &barycentric);
                let own = f.value_at(&Place { simplex, barycentric, position });
                let barycentric = domain.barycentric(neighbor, position);
                let other = f.value_at(&Place { simplex: neighbor, barycentric, position });
                assert!((own - other).abs() < 1e-12, "{own} {other}");
            }
        }
    }
    check(&P1::new(domain::<2>(3)));
    check(&P2::new(domain::<2>(3)));
    check(&P2::new(domain::<3>(2)));
}

/// Every kernel, on a few centres.
fn radial<const D: usize>(tail: Tail) -> Vec<Radial<D>> {
    let mut chance = Chance::new(13, 305, D);
    let centres: Vec<[f64; D]> = (0..6).map(|_| std::array::from_fn(|_| chance.between(-1.0, 1.5))).collect();
    let width = 1.3;
    [
        Kernel::Gaussian { width },
        Kernel::Multiquadric { width },
        Kernel::InverseMultiquadric { width },
        Kernel::ThinPlate { width },
        Kernel::WendlandC2 { width },
        Kernel::WendlandC4 { width },
    ]
    .map(|kernel| Radial::new(domain(4), kernel, centres.clone(), tail).unwrap())
    .into()
}

#[test]
fn derivatives_are_those_of_the_values() {
    fn check<const D: usize>(basis: &dyn Basis<D>) {
        const STEP: f64 = 1e-5;
        let mut chance = Chance::new(14, 305, D);
        let coefficients: Vec<f64> = (0..basis.len()).map(|_| chance.normal()).collect();
        let f = Expansion::new(basis, &coefficients);
        let mut terms = Terms::new();
        for place in places(basis.domain(), 60) {
            if place.barycentric[..=D].iter().any(|&b| b < 1e-3) {
                continue; // Too near to a face for differences.
            }
            let moved = |axis: usize, step: f64| {
                let mut position = place.position;
                position[axis] += step;
                let barycentric = basis.domain().barycentric(place.simplex, position);
                Place { position, barycentric, ..place }
            };
            basis.evaluate(&place, Derivatives::Second, &mut terms);
            let gradient = f.gradient_at(&place);
            for a in 0..D {
                let slope = (f.value_at(&moved(a, STEP)) - f.value_at(&moved(a, -STEP))) / (2.0 * STEP);
                assert!((slope - gradient[a]).abs() < 1e-6 * (1.0 + slope.abs()), "{slope} {}", gradient[a]);
                let (after, before) = (f.gradient_at(&moved(a, STEP)), f.gradient_at(&moved(a, -STEP)));
                for b in 0..D {
                    let bend = (after[b] - before[b]) / (2.0 * STEP);
                    let hessian: f64 = terms
                        .indices
                        .iter()
                        .zip(&terms.hessians)
                        .map(|(&j, h)| coefficients[j as usize] * h[a][b])
                        .sum();
                    assert!((bend - hessian).abs() < 1e-4 * (1.0 + bend.abs()), "{bend} {hessian}");
                }
            }
        }
    }
    check(&P1::new(domain::<2>(3)));
    check(&P2::new(domain::<2>(3)));
    check(&P2::new(domain::<3>(2)));
    radial::<2>(Tail::Linear).iter().for_each(|basis| check(basis));
    radial::<3>(Tail::Linear).iter().for_each(|basis| check(basis));
}

#[test]
fn the_tail_of_radial_functions_sums_to_one_and_reproduces_linear_functions() {
    for basis in radial::<2>(Tail::Linear) {
        for place in places(basis.domain(), 50) {
            // 1 and the scaled coordinates are the last functions.
            let mut coefficients = vec![0.0; basis.len()];
            coefficients[6] = 1.0;
            assert!((Expansion::new(&basis, &coefficients).value_at(&place) - 1.0).abs() < 1e-12);
            coefficients[6] = 0.25;
            coefficients[7] = 1.25;
            let x = Expansion::new(&basis, &coefficients).value_at(&place);
            assert!((x - place.position[0]).abs() < 1e-12, "{x}");
        }
    }
}

#[test]
fn impossible_radial_functions_are_refused() {
    let make = |width, centres| Radial::<2>::new(domain(2), Kernel::Gaussian { width }, centres, Tail::None).err();
    assert_eq!(make(0.0, vec![[0.0; 2]]), Some(RadialError::Width(0.0)));
    assert!(matches!(make(f64::NAN, vec![[0.0; 2]]), Some(RadialError::Width(_))));
    assert_eq!(make(1.0, vec![]), Some(RadialError::NoCentres));
    assert_eq!(make(1.0, vec![[0.0; 2], [f64::NAN, 0.0]]), Some(RadialError::NotFinite { centre: 1 }));
    assert_eq!(make(1.0, vec![[1.0; 2], [0.0; 2], [1.0; 2]]), Some(RadialError::Equal { centres: [0, 2] }));
}

#[test]
fn farthest_points_spread() {
    let mut chance = Chance::new(15, 305, 0);
    let mut points: Vec<[f64; 2]> = (0..500).map(|_| [chance.uniform(), chance.uniform()]).collect();
    points.extend_from_within(0..500);
    let chosen = farthest_points(&points, 40);
    let distance =
        |i: usize, j: usize| ((points[i][0] - points[j][0]).powi(2) + (points[i][1] - points[j][1]).powi(2)).sqrt();
    let apart = (0..40).flat_map(|i| (0..i).map(move |j| (i, j))).map(|(i, j)| distance(chosen[i], chosen[j]));
    let cover = (0..1000).map(|p| chosen.iter().map(|&c| distance(p, c)).fold(f64::INFINITY, f64::min));
    // No two chosen points are nearer to each other than some point is to all of them.
    assert!(apart.fold(f64::INFINITY, f64::min) >= cover.fold(0.0, f64::max));
    assert_eq!(farthest_points(&points, 2000).len(), 500);
    assert!(farthest_points::<2>(&[], 3).is_empty());
}
