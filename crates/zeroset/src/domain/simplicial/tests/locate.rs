//! Which simplex holds a point.

use super::super::SimplicialMesh;
use super::{filled_box, grid, random, turned};
use crate::sample::Chance;

/// The lowest simplex all of whose coordinates are at least zero, up to rounding.
fn by_brute_force<const D: usize>(mesh: &SimplicialMesh<D>, position: [f64; D]) -> Option<usize> {
    (0..mesh.len()).find(|&s| mesh.barycentric(s, position).iter().all(|&b| b >= -mesh.tolerance(s)))
}

fn assert_faces_are_held<const D: usize>(mesh: &SimplicialMesh<D>, seed: u64) {
    let mut chance = Chance::new(seed, 92, 0);
    for s in 0..mesh.len() {
        // All subsets of the corners: vertices, edges, faces and the inside.
        for subset in 1..1_usize << (D + 1) {
            let mut weights = [0.0; 4];
            for (c, weight) in weights.iter_mut().enumerate().take(D + 1) {
                *weight = if subset >> c & 1 == 1 { chance.between(0.05, 1.0) } else { 0.0 };
            }
            let sum: f64 = weights.iter().sum();
            let position = mesh.position(s, &weights.map(|w| w / sum));
            let place = mesh.locate(position).expect("the point lies in the mesh");
            assert!(place.simplex <= s, "of those that hold it, the lowest is taken");
            assert_eq!(Some(place.simplex), by_brute_force(mesh, position));
        }
    }
}

#[test]
fn points_on_vertices_edges_and_faces_belong_to_the_lowest_simplex() {
    assert_faces_are_held(&SimplicialMesh::<2>::lattice([0.0; 2], [1.3, 0.7], [9, 6]).unwrap(), 1);
    assert_faces_are_held(&SimplicialMesh::<3>::lattice([0.0; 3], [1.3, 0.7, 0.9], [4, 3, 5]).unwrap(), 2);
    assert_faces_are_held(&SimplicialMesh::<2>::delaunay(&filled_box(3, 100)).unwrap(), 3);
    assert_faces_are_held(&SimplicialMesh::<3>::delaunay(&filled_box(4, 100)).unwrap(), 4);
    assert_faces_are_held(&SimplicialMesh::four_triangles([0.0; 2], [1.0; 2]).unwrap(), 5);
}

#[test]
fn the_middle_of_four_triangles_belongs_to_the_first() {
    let mesh = SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2]).unwrap();
    assert_eq!(mesh.locate([0.0, 0.0]).map(|p| p.simplex), Some(0));
    assert_eq!(mesh.locate([0.5, 0.5]).map(|p| p.simplex), Some(1));
    assert_eq!(mesh.locate([-0.5, -0.5]).map(|p| p.simplex), Some(0));
}

#[test]
fn meshes_far_from_the_origin_lose_no_point() {
    let origin = 1e6;
    let small = SimplicialMesh::<3>::lattice([origin; 3], [origin + 0.3; 3], [3; 3]).unwrap();
    assert_faces_are_held(&small, 6);
    let mesh = SimplicialMesh::<3>::lattice([origin; 3], [origin + 1.0; 3], [10; 3]).unwrap();
    for unit in random::<3>(7, 5000) {
        assert!(mesh.locate(unit.map(|u| origin + u)).is_some());
    }
    // On the rim, where a coordinate can be rounded outwards.
    for unit in random::<3>(8, 1000) {
        assert!(mesh.locate([origin + 1.0 + 1e-10, origin + unit[1], origin + unit[2]]).is_some());
    }
}

#[test]
fn points_outside_belong_to_none() {
    let mesh = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [3, 3]).unwrap();
    for outside in [[-1e-9, 0.5], [0.5, 1.0 + 1e-9], [7.0, 7.0], [-1e300, 0.0], [f64::NAN, 0.5], [0.5, f64::INFINITY]] {
        assert_eq!(mesh.locate(outside), None);
    }
    assert!(mesh.locate([1.0, 1.0]).is_some() && mesh.locate([0.0, 1.0]).is_some());
}

#[test]
fn flat_cells_neither_lose_points_nor_claim_those_of_others() {
    // A turned grid: rounding puts four corners of a square slightly off one plane, and cells without thickness between them.
    let sites: Vec<_> = grid::<3>(5, 0.25).into_iter().map(turned).collect();
    let mesh = SimplicialMesh::<3>::delaunay(&sites).unwrap();
    assert!((super::volume(&mesh) - 1.0).abs() < 1e-12);
    for position in random::<3>(9, 3000).into_iter().map(turned) {
        let place = mesh.locate(position).expect("the point lies in the mesh");
        let corners = mesh.corner_positions(place.simplex);
        let (low, high) = crate::domain::bounds(corners.into_iter());
        assert!((0..3).all(|a| low[a] - 1e-12 <= position[a] && position[a] <= high[a] + 1e-12));
    }
}

#[test]
fn coordinates_and_positions_are_inverse() {
    let mesh = SimplicialMesh::<3>::lattice([-0.5; 3], [0.5; 3], [3, 4, 5]).unwrap();
    for unit in random::<3>(10, 2000) {
        let position = unit.map(|u| u - 0.5);
        let place = mesh.locate(position).unwrap();
        assert!((place.barycentric.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        let back = mesh.position(place.simplex, &place.barycentric);
        assert!((0..3).all(|a| (back[a] - position[a]).abs() < 1e-14));
    }
}

#[test]
fn meshes_with_cells_of_many_sizes_are_searched_as_others() {
    // Most sites lie in a thousandth of the box, so most cells lie in one bucket of the grid.
    let mut sites = filled_box::<3>(11, 20);
    sites.extend(random::<3>(12, 300).into_iter().map(|p| p.map(|c| 0.3 + 1e-3 * c)));
    let mesh = SimplicialMesh::<3>::delaunay(&sites).unwrap();
    assert!((0..mesh.len()).any(|s| mesh.locator.near(mesh.corner_positions(s)[0]).len() < mesh.len() / 4));
    super::assert_valid(&mesh);
    for (wide, narrow) in random::<3>(13, 500).into_iter().zip(random::<3>(14, 500)) {
        for position in [wide, narrow.map(|c| 0.3 + 1e-3 * c)] {
            let place = mesh.locate(position).expect("the point lies in the mesh");
            assert_eq!(Some(place.simplex), by_brute_force(&mesh, position));
        }
    }
}
