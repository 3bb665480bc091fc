//! Lines and facets weigh as their integrals, and data that serve no fit are refused by name.

use std::collections::BTreeMap;

use super::{bases, difference, gram, interpolated, meshes_2d, meshes_3d, quadratic_form, random, sites};
use crate::basis::{Basis, Derivatives, P1, Terms};
use crate::domain::{Place, SimplicialMesh};
use crate::fit::normalized::{Data, DataError, NormalizedFit, PolygonError};

fn distance<const D: usize>(p: [f64; D], q: [f64; D]) -> f64 {
    (0..D).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>().sqrt()
}

/// Half the root of the Gram determinant of two sides.
fn area<const D: usize>([p, q, r]: [[f64; D]; 3]) -> f64 {
    let product = |x: [f64; D], y: [f64; D]| (0..D).map(|a| (x[a] - p[a]) * (y[a] - p[a])).sum::<f64>();
    0.5 * (product(q, q) * product(r, r) - product(q, r).powi(2)).sqrt()
}

fn middle<const D: usize>(p: [f64; D], q: [f64; D]) -> [f64; D] {
    std::array::from_fn(|a| 0.5 * (p[a] + q[a]))
}

/// The Gram matrix of weighted points.
fn sampled<const D: usize>(basis: &dyn Basis<D>, points: &[[f64; D]], weight: f64) -> BTreeMap<(usize, usize), f64> {
    let mut matrix = BTreeMap::new();
    let mut terms = Terms::new();
    for &p in points {
        let place = basis.domain().locate(p).expect("the point lies in the domain");
        basis.evaluate(&place, Derivatives::None, &mut terms);
        for (&i, &u) in terms.indices.iter().zip(&terms.values) {
            for (&j, &v) in terms.indices.iter().zip(&terms.values).filter(|(j, _)| **j <= i) {
                *matrix.entry((i as usize, j as usize)).or_insert(0.0) += weight * u * v;
            }
        }
    }
    matrix
}

#[test]
fn a_segment_is_the_limit_of_dense_points() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        const COUNT: usize = 100_000;
        let mut ends = [[0.03; D], [0.96; D]];
        (ends[0][1], ends[1][0]) = (0.41, 0.87);
        let weight = 2.5;
        let points: Vec<[f64; D]> = (0..COUNT)
            .map(|i| (i as f64 + 0.5) / COUNT as f64)
            .map(|t| std::array::from_fn(|a| ends[0][a] + t * (ends[1][a] - ends[0][a])))
            .collect();
        for (degree, basis) in bases(mesh) {
            let mut data = Data::new();
            data.segment(ends, weight).unwrap();
            let dense = sampled(&*basis, &points, weight * distance(ends[0], ends[1]) / COUNT as f64);
            // At each face the products have a kink of the slope of some 10 per length; the midpoint rule is off by an eighth of it
            // times the square of the step, 1e-10, and entries are some 0.1.
            let off = difference(&gram(&*basis, &data), &dense);
            assert!(off < 1e-6, "D {D}, degree {degree}: {off}");
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

/// The Gram matrix of the centres of the parts of a triangle's pieces between parallels to their sides. The triangle weighs 3 by area.
fn dense_facet<const D: usize>(
    basis: &dyn Basis<D>,
    corners: [[f64; D]; 3],
    parts: usize,
) -> BTreeMap<(usize, usize), f64> {
    let mut sums = BTreeMap::new();
    let mut terms = Terms::new();
    for piece in basis.domain().clip_triangle(corners) {
        let weight = 3.0 * area(piece.corners) / (parts * parts) as f64;
        let lower = (0..parts).flat_map(|i| (0..parts - i).map(move |j| (i, j, 1.0 / 3.0)));
        let upper = (0..parts).flat_map(|i| (0..parts - i - 1).map(move |j| (i, j, 2.0 / 3.0)));
        for (i, j, third) in lower.chain(upper) {
            let (u, v) = ((i as f64 + third) / parts as f64, (j as f64 + third) / parts as f64);
            let [p, q, r] = piece.corners;
            let position = std::array::from_fn(|a| p[a] + u * (q[a] - p[a]) + v * (r[a] - p[a]));
            let barycentric = basis.domain().barycentric(piece.simplex, position);
            basis.evaluate(&Place { simplex: piece.simplex, barycentric, position }, Derivatives::None, &mut terms);
            for (&i, a) in terms.indices.iter().zip(&terms.values) {
                for (&j, b) in terms.indices.iter().zip(&terms.values).filter(|(j, _)| **j <= i) {
                    *sums.entry((i as usize, j as usize)).or_insert(0.0) += weight * a * b;
                }
            }
        }
    }
    sums
}

#[test]
fn a_facet_is_the_limit_of_dense_points() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>, corners: [[f64; D]; 3]) {
        // Pieces are sampled apart, so that no sample stands for parts on both sides of a face.
        const PARTS: usize = 48;
        for (degree, basis) in bases(mesh) {
            let mut data = Data::new();
            data.triangle(corners, 3.0).unwrap();
            // The sum at the centres errs by the square of the side of a part; so does one of half as many parts, by four times as much.
            let [coarse, fine] = [PARTS, 2 * PARTS].map(|parts| dense_facet(&*basis, corners, parts));
            let limit = fine.iter().map(|(k, f)| (*k, (4.0 * f - coarse[k]) / 3.0)).collect();
            let off = difference(&gram(&*basis, &data), &limit);
            assert!(off < 1e-6, "D {D}, degree {degree}: {off}");
        }
    }
    meshes_2d().iter().for_each(|m| check(m, [[0.1, 0.07], [0.93, 0.2], [0.35, 0.9]]));
    meshes_3d().iter().for_each(|m| check(m, [[0.1, 0.07, 0.2], [0.93, 0.2, 0.7], [0.35, 0.9, 0.45]]));
}

/// Some polynomials, by their degree.
fn polynomials<const D: usize>(degree: usize) -> Vec<Box<dyn Fn([f64; D]) -> f64>> {
    let mut all: Vec<Box<dyn Fn([f64; D]) -> f64>> =
        vec![Box::new(|_| 1.0), Box::new(|p| p[0] - 2.0 * p[D - 1] + 0.3), Box::new(|p| 3.0 * p[1] - 1.0)];
    if degree == 2 {
        all.push(Box::new(|p| p[0] * p[D - 1] - 0.2));
        all.push(Box::new(|p| (p[0] - 0.4).powi(2) + p[1] * (p[D - 1] - 0.7) - 0.1));
    }
    all
}

/// The integral of the square of a quadratic over a segment, by its values: Simpson's matrix of the quadratic element.
fn over_segment<const D: usize>(f: impl Fn([f64; D]) -> f64, [p, q]: [[f64; D]; 2]) -> f64 {
    let [a, b, m] = [f(p), f(q), f(middle(p, q))];
    distance(p, q) / 30.0 * (4.0 * (a * a + b * b) + 16.0 * m * m - 2.0 * a * b + 4.0 * m * (a + b))
}

/// The same over a triangle, by the mass matrix of the quadratic element.
fn over_triangle<const D: usize>(f: impl Fn([f64; D]) -> f64, corners: [[f64; D]; 3]) -> f64 {
    let [p, q, r] = corners;
    let v = corners.map(&f);
    // Each middle lies opposite to the corner of its place.
    let m = [middle(q, r), middle(r, p), middle(p, q)].map(&f);
    let (sum, cross) = (v.iter().sum::<f64>(), m.iter().sum::<f64>());
    let squares = |x: [f64; 3]| x.iter().map(|x| x * x).sum::<f64>();
    let opposite: f64 = (0..3).map(|k| v[k] * m[k]).sum();
    area(corners) / 180.0 * (7.0 * squares(v) - sum * sum + 16.0 * (squares(m) + cross * cross) - 8.0 * opposite)
}

#[test]
fn integrals_of_squared_polynomials_are_exact() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        let corners = random::<D>(3, 30, 0.02, 0.98);
        for (degree, basis) in bases(mesh) {
            for corners in corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]) {
                let (mut segment, mut triangle) = (Data::new(), Data::new());
                segment.segment([corners[0], corners[1]], 1.5).unwrap();
                triangle.triangle(corners, 0.7).unwrap();
                let (segment, triangle) = (gram(&*basis, &segment), gram(&*basis, &triangle));
                for (k, f) in polynomials::<D>(degree).iter().enumerate() {
                    let coefficients = interpolated(&*basis, f);
                    // The polynomials are some 1 in size: rounding, times the number of samples.
                    let found = quadratic_form(&segment, &coefficients);
                    let expected = 1.5 * over_segment(f, [corners[0], corners[1]]);
                    assert!((found - expected).abs() < 1e-12, "segment, D {D}, polynomial {k}: {found} {expected}");
                    let found = quadratic_form(&triangle, &coefficients);
                    let expected = 0.7 * over_triangle(f, corners);
                    assert!((found - expected).abs() < 1e-12, "triangle, D {D}, polynomial {k}: {found} {expected}");
                }
            }
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

/// The sum of the weights of a datum's samples.
fn total<const D: usize>(basis: &dyn Basis<D>, data: &Data<D>) -> f64 {
    data.samples(basis).unwrap().iter().map(|s| s.weight).sum()
}

#[test]
fn weights_of_samples_sum_to_weight_times_measure() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        let corners = random::<D>(4, 150, 0.0, 1.0);
        for (degree, basis) in bases(mesh) {
            for corners in corners.chunks_exact(3).map(|c| [c[0], c[1], c[2]]) {
                let (mut segment, mut triangle) = (Data::new(), Data::new());
                segment.segment([corners[0], corners[1]], 4.0).unwrap();
                triangle.triangle(corners, 0.25).unwrap();
                let length = total(&*basis, &segment) / (4.0 * distance(corners[0], corners[1]));
                let area = total(&*basis, &triangle) / (0.25 * area(corners));
                assert!((length - 1.0).abs() < 1e-12, "D {D}, degree {degree}: {length}");
                assert!((area - 1.0).abs() < 1e-12, "D {D}, degree {degree}: {area} {corners:?}");
            }
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

#[test]
fn segments_and_facets_along_faces_count_once() {
    let mesh = SimplicialMesh::<3>::lattice([0.0; 3], [1.0; 3], [4; 3]).unwrap();
    for (degree, basis) in bases(&mesh) {
        let mut data = Data::<3>::new();
        // Along an edge, a cell's main diagonal, the rim, and in a plane of faces.
        data.segment([[0.25, 0.25, 0.0], [0.25, 0.25, 1.0]], 1.0).unwrap();
        data.segment([[0.0; 3], [1.0; 3]], 1.0).unwrap();
        data.segment([[0.0, 0.0, 0.1], [0.0, 1.0, 0.1]], 1.0).unwrap();
        data.triangle([[0.5, 0.0, 0.0], [0.5, 1.0, 0.0], [0.5, 0.0, 1.0]], 1.0).unwrap();
        data.triangle([[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 1.0, 1.0]], 1.0).unwrap();
        let mut sums = [0.0; 5];
        data.samples(&*basis).unwrap().iter().for_each(|s| sums[s.datum as usize] += s.weight);
        let expected = [1.0, 3.0_f64.sqrt(), 1.0, 0.5, 0.5_f64.sqrt()];
        for (found, expected) in sums.iter().zip(expected) {
            assert!((found - expected).abs() < 1e-12, "degree {degree}: {sums:?}");
        }
    }
}

/// A square with a hole.
fn holed() -> [Vec<[f64; 2]>; 2] {
    let outer = vec![[-0.35, -0.35], [0.35, -0.35], [0.35, 0.35], [-0.35, 0.35]];
    let hole = vec![[-0.1, -0.2], [0.15, -0.2], [0.15, 0.1], [-0.1, 0.1]];
    [outer, hole]
}

/// From the coordinates of a plane across all axes to space.
fn place([u, v]: [f64; 2]) -> [f64; 3] {
    let (sin, cos) = 0.6_f64.sin_cos();
    [0.5 + cos * u - sin * sin * v, 0.5 + sin * u + sin * cos * v, 0.5 + cos * v]
}

#[test]
fn a_polygon_with_a_hole_is_integrated_without_it() {
    let rings = holed();
    let in_space = |rings: &[Vec<[f64; 2]>]| -> Vec<Vec<[f64; 3]>> {
        rings.iter().map(|ring| ring.iter().map(|&p| place(p)).collect()).collect()
    };
    let outer = [[rings[0][0], rings[0][1], rings[0][2]], [rings[0][0], rings[0][2], rings[0][3]]];
    let hole = [[rings[1][0], rings[1][1], rings[1][2]], [rings[1][0], rings[1][2], rings[1][3]]];
    let polygon = |rings: &[Vec<[f64; 3]>]| {
        let mut data = Data::<3>::new();
        data.polygon(rings, 2.0).unwrap();
        data
    };
    // Rings turned round, begun elsewhere, closed, and with a position repeated.
    let mut others = vec![rings.clone(); 4];
    others[0][0].reverse();
    others[1][1].reverse();
    others[2].iter_mut().for_each(|ring| ring.push(ring[0]));
    others[3].iter_mut().for_each(|ring| {
        ring.rotate_left(1);
        ring.insert(2, ring[2]);
    });
    for mesh in meshes_3d() {
        for (degree, basis) in bases(&mesh) {
            let data = polygon(&in_space(&rings));
            let matrix = gram(&*basis, &data);
            let area = total(&*basis, &data);
            assert!((area - 2.0 * (0.7 * 0.7 - 0.25 * 0.3)).abs() < 1e-12, "{area}");
            for f in polynomials::<3>(degree) {
                let over = |t: [[f64; 2]; 3]| over_triangle(&f, t.map(place));
                let expected = 2.0 * (outer.map(over).iter().sum::<f64>() - hole.map(over).iter().sum::<f64>());
                let found = quadratic_form(&matrix, &interpolated(&*basis, &f));
                assert!((found - expected).abs() < 1e-12, "degree {degree}: {found} {expected}");
            }
            for other in &others {
                // Other triangles, the same integrals.
                let off = difference(&matrix, &gram(&*basis, &polygon(&in_space(other))));
                assert!(off < 1e-12, "degree {degree}: {off}");
            }
        }
    }
}

#[test]
fn a_polygon_in_the_plane_is_its_boundary() {
    let basis = P1::new(SimplicialMesh::<2>::delaunay(&sites(5, 20)).unwrap());
    let ring = [[0.1, 0.2], [0.8, 0.15], [0.9, 0.7], [0.3, 0.85]];
    let polygon = |ring: &[[f64; 2]]| {
        let mut data = Data::<2>::new();
        data.polygon(ring, 1.0).unwrap();
        gram(&basis, &data)
    };
    let mut sides = Data::new();
    (0..4).for_each(|i| sides.segment([ring[i], ring[(i + 1) % 4]], 1.0).unwrap());
    let expected = gram(&basis, &sides);
    let (mut closed, mut reversed) = (ring.to_vec(), ring);
    closed.push(ring[0]);
    reversed.reverse();
    for found in [polygon(&ring), polygon(&closed), polygon(&reversed)] {
        // Rounding of the cuts, seen from either end.
        assert!(difference(&expected, &found) < 1e-12);
    }
}

#[test]
fn a_corner_is_a_polyline_is_two_segments() {
    fn check<const D: usize>(mesh: &SimplicialMesh<D>) {
        let positions: [[f64; D]; 3] = random(6, 3, 0.0, 1.0).try_into().unwrap();
        for (_, basis) in bases(mesh) {
            let [mut corner, mut polyline, mut segments] = [Data::new(), Data::new(), Data::new()];
            corner.corner(positions, 3.0).unwrap();
            polyline.polyline(&positions, 3.0).unwrap();
            segments.segment([positions[0], positions[1]], 3.0).unwrap();
            segments.segment([positions[1], positions[2]], 3.0).unwrap();
            assert_eq!(corner, polyline);
            assert_eq!((corner.len(), segments.len()), (1, 2));
            assert_eq!(gram(&*basis, &corner), gram(&*basis, &segments));
        }
    }
    meshes_2d().iter().for_each(check);
    meshes_3d().iter().for_each(check);
}

#[test]
fn data_that_serve_no_fit_are_refused_by_number() {
    let mut data = Data::<3>::new();
    data.point([0.5; 3], 1.0).unwrap();
    for weight in [0.0, -1.0, f64::INFINITY] {
        assert_eq!(data.point([0.1; 3], weight), Err(DataError::Weight { datum: 1, weight }));
    }
    assert!(matches!(data.point([0.1; 3], f64::NAN), Err(DataError::Weight { datum: 1, .. })));
    let bad = [0.1, f64::NAN, 0.2];
    let not_finite = Err(DataError::NotFinite { datum: 1 });
    assert_eq!(data.point(bad, 1.0), not_finite);
    assert_eq!(data.point([f64::INFINITY; 3], 1.0), not_finite);
    assert_eq!(data.segment([bad, [0.0; 3]], 1.0), not_finite);
    assert_eq!(data.corner([[0.0; 3], [1.0; 3], bad], 1.0), not_finite);
    assert_eq!(data.triangle([[0.0; 3], [1.0; 3], bad], 1.0), not_finite);
    assert_eq!(data.polygon(&[vec![[0.0; 3], [1.0; 3], bad]], 1.0), not_finite);
    let no_extent = Err(DataError::NoExtent { datum: 1 });
    assert_eq!(data.segment([[0.25; 3]; 2], 1.0), no_extent);
    assert_eq!(data.polyline(&[], 1.0), no_extent);
    assert_eq!(data.polyline(&[[0.25; 3]], 1.0), no_extent);
    assert_eq!(data.triangle([[0.0; 3], [0.5; 3], [1.0; 3]], 1.0), no_extent);
    // What was refused left nothing behind.
    assert_eq!(data.len(), 1);
    let mut plane = Data::<2>::new();
    assert_eq!(plane.polygon(&[[0.0; 2], [1.0, f64::NAN], [1.0; 2]], 1.0), Err(DataError::NotFinite { datum: 0 }));
    assert_eq!(
        plane.polygon(&[[0.0; 2], [1.0; 2], [0.0; 2]], 1.0),
        Err(DataError::Polygon { datum: 0, why: PolygonError::TooFewPositions(2) })
    );
    let basis = P1::new(SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [2; 2]).unwrap());
    let error = NormalizedFit::new(&basis, &plane).run().unwrap_err();
    assert_eq!(error, DataError::Empty.into());
}

#[test]
fn polygons_that_bound_no_area_are_refused_with_the_reason() {
    fn why(rings: &[Vec<[f64; 3]>]) -> PolygonError {
        let mut data = Data::<3>::new();
        data.point([0.5; 3], 1.0).unwrap();
        match data.polygon(rings, 1.0) {
            Err(DataError::Polygon { datum: 1, why }) => why,
            other => panic!("{other:?}"),
        }
    }
    let at = |x: f64, y: f64| [x, y, 0.3 + 0.2 * x - 0.1 * y];
    let square = vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)];
    assert_eq!(why(&[]), PolygonError::TooFewPositions(0));
    assert_eq!(why(&[vec![]]), PolygonError::TooFewPositions(0));
    assert_eq!(why(&[vec![square[0], square[1], square[1], square[0]]]), PolygonError::TooFewPositions(2));
    assert_eq!(why(&[square.clone(), vec![square[0]]]), PolygonError::TooFewPositions(1));
    assert_eq!(why(&[vec![at(0.0, 0.0), at(0.5, 0.5), at(1.0, 1.0)]]), PolygonError::NoArea);
    // Bows, one with parts of equal area, which cancel.
    assert_eq!(why(&[vec![at(0.0, 0.0), at(1.0, 1.0), at(1.0, 0.0), at(0.0, 0.5)]]), PolygonError::Crossing);
    assert_eq!(why(&[vec![at(0.0, 0.0), at(1.0, 1.0), at(1.0, 0.0), at(0.0, 1.0)]]), PolygonError::Crossing);
    // A hole that leaves its polygon.
    let hole = vec![at(0.5, 0.5), at(1.5, 0.5), at(0.5, 0.7)];
    assert_eq!(why(&[square.clone(), hole]), PolygonError::Crossing);
    let mut bent = square;
    bent[2][2] += 0.1;
    match why(&[bent]) {
        // The middle of a raised corner and three others lies a quarter of the way, and the plane tilts with it.
        PolygonError::NotPlane { distance, size } => assert!(distance > 0.01 && distance < 0.05 && size > 0.5),
        other => panic!("{other:?}"),
    }
}

#[test]
fn data_that_leave_the_domain_are_named_with_what_is_inside() {
    fn outside<const D: usize>(add: impl Fn(&mut Data<D>)) -> (f64, f64) {
        let basis = P1::new(SimplicialMesh::lattice([0.0; D], [1.0; D], [3; D]).unwrap());
        let mut data = Data::new();
        data.point([0.5; D], 7.0).unwrap();
        add(&mut data);
        match data.samples(&basis) {
            Err(DataError::Outside { datum: 1, inside, whole }) => (inside, whole),
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(outside::<2>(|d| d.point([1.5, 0.5], 9.0).unwrap()), (0.0, 1.0));
    let near = |(a, b): (f64, f64), (c, d): (f64, f64)| (a - c).abs() < 1e-12 && (b - d).abs() < 1e-12;
    assert!(near(outside::<2>(|d| d.segment([[0.5, 0.5], [2.5, 0.5]], 9.0).unwrap()), (0.5, 2.0)));
    assert!(near(outside::<3>(|d| d.segment([[0.5, 0.5, 0.5], [2.5, 0.5, 0.5]], 9.0).unwrap()), (0.5, 2.0)));
    assert!(near(outside::<2>(|d| d.triangle([[0.0; 2], [2.0, 0.0], [0.0, 2.0]], 9.0).unwrap()), (1.0, 2.0)));
    let square = [[0.5, 0.5, 0.3], [1.5, 0.5, 0.3], [1.5, 1.5, 0.3], [0.5, 1.5, 0.3]].to_vec();
    assert!(near(outside::<3>(|d| d.polygon(std::slice::from_ref(&square), 9.0).unwrap()), (0.25, 1.0)));
    assert_eq!(outside::<3>(|d| d.triangle([[2.0; 3], [3.0, 2.0, 2.0], [2.0, 3.0, 2.0]], 9.0).unwrap()).0, 0.0);
}
