//! Delaunay meshes: empty spheres, and hulls that are filled.

use super::super::predicates::{in_sphere, orientation};
use super::super::{DomainError, SimplicialMesh};
use super::{assert_valid, filled_box, grid, random, volume};
use crate::sample::Chance;

/// Asserts that a mesh in space is valid, holds all sites, and has no site in a sphere.
fn assert_delaunay(mesh: &SimplicialMesh<3>) {
    assert_valid(mesh);
    for s in 0..mesh.len() {
        let corners = mesh.corner_positions(s);
        assert!(mesh.vertices().iter().all(|&v| in_sphere(&corners, v) <= 0.0), "sphere {s} is empty");
    }
    assert_convex(mesh);
}

/// Asserts that no vertex lies beyond a face of the rim.
fn assert_convex<const D: usize>(mesh: &SimplicialMesh<D>) {
    for s in 0..mesh.len() {
        for corner in (0..=D).filter(|&c| mesh.neighbor(s, c).is_none()) {
            let mut moved = mesh.corner_positions(s);
            for &v in mesh.vertices() {
                moved[corner] = v;
                assert!(orientation(&moved[..=D]) >= 0.0, "the rim is convex");
            }
        }
    }
}

#[test]
fn random_sites_in_the_plane() {
    for (seed, count) in [(1, 0), (2, 1), (3, 30), (4, 400)] {
        let sites = filled_box::<2>(seed, count);
        let mesh = SimplicialMesh::<2>::delaunay(&sites).unwrap();
        assert_valid(&mesh);
        assert_convex(&mesh);
        assert_eq!(mesh.vertices(), sites);
        assert!((volume(&mesh) - 1.0).abs() < 1e-13);
        for s in 0..mesh.len() {
            let [a, b, c, _] = mesh.corner_positions(s).map(|[x, y]| robust::Coord { x, y });
            let inside = |v: &[f64; 2]| robust::incircle(a, b, c, robust::Coord { x: v[0], y: v[1] }) > 0.0;
            assert!(!sites.iter().any(inside), "circle {s} is empty");
        }
    }
}

#[test]
fn sites_on_grids_circles_and_curves_in_the_plane() {
    let mesh = SimplicialMesh::<2>::delaunay(&grid(12, 0.1)).unwrap();
    assert_valid(&mesh);
    assert_eq!(mesh.len(), 2 * 11 * 11);
    let circle: Vec<_> = (0..64).map(|k| (f64::from(k) * 0.1).sin_cos().into()).collect();
    let mesh = SimplicialMesh::<2>::delaunay(&circle).unwrap();
    assert_valid(&mesh);
    assert_eq!(mesh.len(), 62);
    // All on one line but one.
    let mut comb: Vec<_> = (0..50).map(|k| [f64::from(k) * 0.1, 0.0]).collect();
    comb.push([2.0, 1e-9]);
    let mesh = SimplicialMesh::<2>::delaunay(&comb).unwrap();
    assert_valid(&mesh);
    assert_eq!(mesh.len(), 49);
}

#[test]
fn random_sites_in_space() {
    for (seed, count) in [(1, 0), (2, 1), (3, 2), (4, 20), (5, 150)] {
        let sites = filled_box::<3>(seed, count);
        let mesh = SimplicialMesh::<3>::delaunay(&sites).unwrap();
        assert_eq!(mesh.vertices(), sites);
        assert!((volume(&mesh) - 1.0).abs() < 1e-13);
        assert_delaunay(&mesh);
    }
    for seed in 10..40 {
        assert_delaunay(&SimplicialMesh::<3>::delaunay(&random::<3>(seed, 12)).unwrap());
    }
    // Few different coordinates: many sites on each sphere, line and plane.
    for seed in 40..80 {
        let coarse: Vec<_> = random::<3>(seed, 40).into_iter().map(|p| p.map(|c| (c * 4.0).floor() * 0.1)).collect();
        assert_delaunay(&SimplicialMesh::<3>::delaunay(&coarse).unwrap());
    }
}

#[test]
fn grids_in_space() {
    for (points, side) in [(2, 1.0), (3, 0.1), (5, 0.1), (6, 1.0)] {
        let mesh = SimplicialMesh::<3>::delaunay(&grid(points, side)).unwrap();
        assert_delaunay(&mesh);
        let long = (points - 1) as f64 * side;
        assert!((volume(&mesh) / long.powi(3) - 1.0).abs() < 1e-12);
    }
    let mut offset = grid::<3>(4, 0.1);
    offset.iter_mut().flatten().for_each(|c| *c += 1e6);
    assert_delaunay(&SimplicialMesh::<3>::delaunay(&offset).unwrap());
}

#[test]
fn sites_on_spheres_and_curves() {
    // Exactly on one sphere: all points with whole coordinates and squares that sum to 101.
    let whole = |r: i32| (-r..=r).map(f64::from);
    let exact: Vec<[f64; 3]> = whole(10)
        .flat_map(|x| whole(10).flat_map(move |y| whole(10).map(move |z| [x, y, z])))
        .filter(|p| p.iter().map(|c| c * c).sum::<f64>() == 101.0)
        .collect();
    assert!(exact.len() > 100);
    assert_delaunay(&SimplicialMesh::<3>::delaunay(&exact).unwrap());
    let mut chance = Chance::new(5, 93, 0);
    let rounded: Vec<_> = (0..150).map(|_| chance.direction()).collect();
    assert_delaunay(&SimplicialMesh::<3>::delaunay(&rounded).unwrap());
    // The curve whose sites are all joined to each other.
    let moment: Vec<_> = (0..40).map(f64::from).map(|t| [t, t * t, t * t * t]).collect();
    let mesh = SimplicialMesh::<3>::delaunay(&moment).unwrap();
    assert_delaunay(&mesh);
    // A plane with one site above it.
    let mut tent: Vec<_> = grid::<2>(6, 0.1).into_iter().map(|[x, y]| [x, y, 0.3]).collect();
    tent.push([0.2, 0.2, 0.4]);
    assert_delaunay(&SimplicialMesh::<3>::delaunay(&tent).unwrap());
}

#[test]
fn sites_that_repeat_are_left_out() {
    let sites = [[1.0, 0.0, 0.0], [0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [-0.0, 0.0, -0.0], [0.0, 0.0, 1.0]];
    let mesh = SimplicialMesh::<3>::delaunay(&sites).unwrap();
    assert_eq!(mesh.vertices(), [sites[0], sites[1], sites[3], sites[5]]);
    let sites = [[1.0, 0.0], [0.0; 2], [1.0, 0.0], [0.0, 1.0], [-0.0, 0.0]];
    let mesh = SimplicialMesh::<2>::delaunay(&sites).unwrap();
    assert_eq!(mesh.vertices(), [sites[0], sites[1], sites[3]]);
}

#[test]
fn sites_that_span_nothing_are_refused() {
    let too_few = |count, least| Some(DomainError::TooFewSites { count, least });
    assert_eq!(SimplicialMesh::<2>::delaunay(&[]).err(), too_few(0, 3));
    assert_eq!(SimplicialMesh::<2>::delaunay(&[[0.0, 0.1]; 5]).err(), too_few(1, 3));
    let line: Vec<_> = (0..20).map(|k| [f64::from(k), f64::from(3 * k)]).collect();
    assert_eq!(SimplicialMesh::<2>::delaunay(&line).err(), too_few(20, 3));
    assert_eq!(SimplicialMesh::<3>::delaunay(&[]).err(), too_few(0, 4));
    assert_eq!(SimplicialMesh::<3>::delaunay(&[[0.0; 3], [1.0; 3], [2.0; 3]]).err(), too_few(3, 4));
    let line: Vec<_> = (0..20).map(|k| [f64::from(k), f64::from(3 * k), 1.0]).collect();
    assert_eq!(SimplicialMesh::<3>::delaunay(&line).err(), too_few(20, 4));
    let plane: Vec<_> = grid::<2>(5, 0.1).into_iter().map(|[x, y]| [x, y, x]).collect();
    assert_eq!(SimplicialMesh::<3>::delaunay(&plane).err(), too_few(25, 4));
    let mut broken = filled_box::<3>(1, 5);
    broken[6][1] = f64::INFINITY;
    assert_eq!(SimplicialMesh::<3>::delaunay(&broken).err(), Some(DomainError::NotFinite { vertex: 6 }));
    broken[6][1] = 1e80;
    assert!(matches!(SimplicialMesh::<3>::delaunay(&broken), Err(DomainError::OutOfRange { vertex: 6, .. })));
}

#[test]
fn extreme_coordinates_are_borne() {
    let stretched = |seed, factors: [f64; 3]| -> Vec<[f64; 3]> {
        random::<3>(seed, 40).into_iter().map(|p| std::array::from_fn(|a| p[a] * factors[a])).collect()
    };
    for factors in [[1e60; 3], [1e-40; 3], [1e60, 1.0, 1e-40], [1.0, 1e-30, 1.0]] {
        assert_delaunay(&SimplicialMesh::<3>::delaunay(&stretched(7, factors)).unwrap());
    }
}
