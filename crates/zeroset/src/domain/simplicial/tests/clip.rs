//! Pieces sum to the whole.

use super::super::SimplicialMesh;
use super::super::clip::polygon_area as area;
use super::{filled_box, grid, random, turned};

fn assert_near<const D: usize>(mesh: &SimplicialMesh<D>, simplex: usize, position: [f64; D]) {
    let lowest = mesh.barycentric(simplex, position).into_iter().take(D + 1).fold(1.0, f64::min);
    assert!(lowest > -1e-9, "{position:?} lies in simplex {simplex}: {lowest}");
}

/// The sum of the pieces of a segment, as share of the whole; the pieces are checked.
fn share_of_segment<const D: usize>(mesh: &SimplicialMesh<D>, ends: [[f64; D]; 2]) -> f64 {
    let pieces = mesh.clip_segment(ends);
    let at = |t: f64| std::array::from_fn(|a| (1.0 - t) * ends[0][a] + t * ends[1][a]);
    for piece in &pieces {
        assert!(piece.range[0] < piece.range[1]);
        piece.range.iter().for_each(|&t| assert_near(mesh, piece.simplex, at(t)));
        let middle = mesh.locate(at(0.5 * (piece.range[0] + piece.range[1]))).unwrap();
        assert_eq!(middle.simplex, piece.simplex);
    }
    assert!(pieces.windows(2).all(|p| p[0].range[1] <= p[1].range[0]));
    pieces.iter().map(|piece| piece.range[1] - piece.range[0]).sum()
}

/// The sum of the pieces of a triangle, as share of the whole; the pieces are checked.
fn share_of_triangle<const D: usize>(mesh: &SimplicialMesh<D>, corners: [[f64; D]; 3]) -> f64 {
    let pieces = mesh.clip_triangle(corners);
    for piece in &pieces {
        piece.corners.iter().for_each(|&c| assert_near(mesh, piece.simplex, c));
    }
    pieces.iter().map(|piece| area(&piece.corners)).sum::<f64>() / area(&corners)
}

fn assert_sums<const D: usize>(mesh: &SimplicialMesh<D>, seed: u64, size: f64) {
    let points = random::<D>(seed, 600);
    for [a, b, c] in points.as_chunks().0 {
        let near = |p: &[f64; D]| std::array::from_fn(|k| a[k] + size * (p[k] - a[k]));
        assert!((share_of_segment(mesh, [*a, near(b)]) - 1.0).abs() < 1e-12);
        let share = share_of_triangle(mesh, [*a, near(b), near(c)]);
        assert!((share - 1.0).abs() < 1e-12, "{share}");
    }
}

/// Segments and triangles between vertices: along edges and faces, and through vertices.
fn assert_sums_between_vertices<const D: usize>(mesh: &SimplicialMesh<D>, step: usize) {
    for s in (0..mesh.len()).step_by(step) {
        let corners = mesh.corner_positions(s);
        for i in 0..=D {
            for j in (0..=D).filter(|&j| j != i) {
                assert!((share_of_segment(mesh, [corners[i], corners[j]]) - 1.0).abs() < 1e-12);
            }
            let [a, b, c] = [1, 2, 3].map(|k| corners[(i + k) % (D + 1)]);
            if D == 3 {
                let share = share_of_triangle(mesh, [a, b, c]);
                assert!((share - 1.0).abs() < 1e-12, "{share}");
            }
        }
    }
    let vertices = mesh.vertices();
    for k in (0..vertices.len() - 2).step_by(step) {
        let corners = [vertices[k], vertices[(7 * k + 5) % vertices.len()], vertices[(11 * k + 3) % vertices.len()]];
        if corners[0] != corners[1] {
            assert!((share_of_segment(mesh, [corners[0], corners[1]]) - 1.0).abs() < 1e-12);
        }
        if area(&corners) > 1e-9 {
            let share = share_of_triangle(mesh, corners);
            assert!((share - 1.0).abs() < 1e-12, "{share}");
        }
    }
}

#[test]
fn pieces_sum_to_the_whole_in_the_plane() {
    let lattice = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [7, 9]).unwrap();
    let delaunay = SimplicialMesh::<2>::delaunay(&filled_box(1, 80)).unwrap();
    let four = SimplicialMesh::four_triangles([0.0; 2], [1.0; 2]).unwrap();
    for mesh in [&lattice, &delaunay, &four] {
        assert_sums(mesh, 2, 1.0);
        assert_sums(mesh, 3, 0.05);
        assert_sums_between_vertices(mesh, 1);
    }
}

#[test]
fn pieces_sum_to_the_whole_in_space() {
    let lattice = SimplicialMesh::<3>::lattice([0.0; 3], [1.0; 3], [3, 4, 5]).unwrap();
    let delaunay = SimplicialMesh::<3>::delaunay(&filled_box(4, 60)).unwrap();
    for mesh in [&lattice, &delaunay] {
        assert_sums(mesh, 5, 1.0);
        assert_sums(mesh, 6, 0.05);
        assert_sums_between_vertices(mesh, 3);
    }
}

#[test]
fn pieces_sum_to_the_whole_far_from_the_origin() {
    let far = 1e6;
    let mesh = SimplicialMesh::<3>::lattice([far; 3], [far + 1.0; 3], [10; 3]).unwrap();
    for [a, b, c] in random::<3>(8, 300).as_chunks().0 {
        let [a, b, c] = [a, b, c].map(|p| p.map(|u| far + u));
        assert!((share_of_segment_sum(&mesh, [a, b]) - 1.0).abs() < 1e-12);
        let sum: f64 = mesh.clip_triangle([a, b, c]).iter().map(|piece| area(&piece.corners)).sum();
        // Cuts are rounded to 1e-10, which can turn them a little out of the plane.
        assert!((sum / area(&[a, b, c]) - 1.0).abs() < 1e-7);
    }
}

#[test]
fn pieces_sum_to_the_whole_among_flat_cells() {
    let sites: Vec<_> = grid::<3>(5, 0.25).into_iter().map(turned).collect();
    let mesh = SimplicialMesh::<3>::delaunay(&sites).unwrap();
    let (mut worst_segment, mut worst_triangle) = (0.0_f64, 0.0_f64);
    for (k, points) in random::<3>(9, 300).as_chunks::<3>().0.iter().enumerate() {
        // Every other triangle lies along a layer of the grid, where the flat cells are.
        let [a, b, c] = points.map(|p| turned([p[0], p[1], if k % 2 == 0 { 0.5 } else { p[2] }]));
        worst_segment = worst_segment.max((share_of_segment_sum(&mesh, [a, b]) - 1.0).abs());
        let sum: f64 = mesh.clip_triangle([a, b, c]).iter().map(|piece| area(&piece.corners)).sum();
        worst_triangle = worst_triangle.max((sum / area(&[a, b, c]) - 1.0).abs());
    }
    assert!(worst_segment < 1e-12 && worst_triangle < 1e-12, "{worst_segment:e} {worst_triangle:e}");
}

fn share_of_segment_sum<const D: usize>(mesh: &SimplicialMesh<D>, ends: [[f64; D]; 2]) -> f64 {
    mesh.clip_segment(ends).iter().map(|piece| piece.range[1] - piece.range[0]).sum()
}

#[test]
fn parts_on_shared_faces_belong_to_the_lowest_simplex() {
    let mesh = SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2]).unwrap();
    let pieces = mesh.clip_segment([[-1.0, -1.0], [1.0, 1.0]]);
    let found: Vec<_> = pieces.iter().map(|p| (p.simplex, p.range)).collect();
    assert_eq!(found, [(0, [0.0, 0.5]), (1, [0.5, 1.0])]);
    // The rim, with points that stick out of it by rounding.
    let pieces = mesh.clip_segment([[-1.0, -1.0 - 1e-16], [1.0, -1.0]]);
    assert_eq!(pieces.iter().map(|p| (p.simplex, p.range)).collect::<Vec<_>>(), [(0, [0.0, 1.0])]);
    // The floor between two cells of a lattice.
    let mesh = SimplicialMesh::<3>::lattice([0.0; 3], [1.0, 1.0, 2.0], [1, 1, 2]).unwrap();
    let floor = [[0.1, 0.2, 1.0], [0.9, 0.3, 1.0], [0.4, 0.8, 1.0]];
    let pieces = mesh.clip_triangle(floor);
    assert!(!pieces.is_empty() && pieces.iter().all(|p| p.simplex < 6));
    assert!((share_of_triangle(&mesh, floor) - 1.0).abs() < 1e-12);
}

#[test]
fn parts_outside_are_left_out() {
    let mesh = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [4, 4]).unwrap();
    assert!((share_of_segment(&mesh, [[-1.0, 0.25], [2.0, 0.25]]) - 1.0 / 3.0).abs() < 1e-12);
    assert!((share_of_segment(&mesh, [[-0.5, 0.3], [0.5, 0.6]]) - 0.5).abs() < 1e-12);
    assert_eq!(share_of_segment(&mesh, [[-0.5, 1.3], [1.5, 1.3]]), 0.0);
    assert!((share_of_triangle(&mesh, [[-1.0, -1.0], [3.0, -1.0], [-1.0, 3.0]]) - 1.0 / 8.0).abs() < 1e-12);
    let mesh = SimplicialMesh::<3>::lattice([0.0; 3], [1.0; 3], [3, 2, 4]).unwrap();
    let across = [[-1.0, -1.0, 0.37], [3.0, -1.0, 0.37], [-1.0, 3.0, 0.37]];
    assert!((share_of_triangle(&mesh, across) - 1.0 / 8.0).abs() < 1e-12);
    // A region with a hole in it.
    let ring: Vec<_> = {
        let full = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [3, 3]).unwrap();
        full.corners
            .as_chunks::<3>()
            .0
            .iter()
            .copied()
            .enumerate()
            .filter(|(s, _)| s / 2 != 4)
            .map(|(_, t)| t)
            .collect()
    };
    let nodes = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [3, 3]).unwrap().vertices;
    let mesh = SimplicialMesh::from_triangles(nodes, &ring).unwrap();
    let pieces = mesh.clip_segment([[0.0, 0.4], [1.0, 0.6]]);
    let sum: f64 = pieces.iter().map(|p| p.range[1] - p.range[0]).sum();
    assert!((sum - 2.0 / 3.0).abs() < 1e-12);
}

#[test]
fn what_has_no_extent_has_no_pieces() {
    let mesh = SimplicialMesh::<3>::lattice([0.0; 3], [1.0; 3], [2; 3]).unwrap();
    assert!(mesh.clip_segment([[0.3; 3]; 2]).is_empty());
    assert!(mesh.clip_segment([[0.3; 3], [0.3, f64::NAN, 0.3]]).is_empty());
    assert!(mesh.clip_triangle([[0.3; 3], [0.5; 3], [0.7; 3]]).is_empty());
    assert!(mesh.clip_triangle([[0.3; 3], [0.5; 3], [f64::INFINITY, 0.0, 0.0]]).is_empty());
}
