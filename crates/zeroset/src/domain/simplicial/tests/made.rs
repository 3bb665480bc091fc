//! Lattices and the four triangles.

use super::super::{DomainError, SimplicialMesh};
use super::{assert_valid, volume};

fn assert_neighbors_are_mutual<const D: usize>(mesh: &SimplicialMesh<D>, on_rim: impl Fn([f64; D]) -> bool) {
    for s in 0..mesh.len() {
        for corner in 0..=D {
            let face = |s: usize, c: usize| {
                let mut face: Vec<u32> = mesh.simplex(s).to_vec();
                face.remove(c);
                face.sort_unstable();
                face
            };
            let Some(n) = mesh.neighbor(s, corner) else {
                let mut middle = [0.0; D];
                for v in face(s, corner) {
                    for (m, x) in middle.iter_mut().zip(mesh.vertices()[v as usize]) {
                        *m += x / D as f64;
                    }
                }
                assert!(on_rim(middle), "only faces on the rim have one neighbour");
                continue;
            };
            assert!((0..=D).any(|c| mesh.neighbor(n, c) == Some(s) && face(n, c) == face(s, corner)));
        }
    }
}

#[test]
fn lattices_conform_and_fill_their_boxes() {
    for cells in [[1, 1], [2, 1], [5, 7], [16, 3]] {
        let (low, high) = ([-1.0, 0.3], [2.0, 1.1]);
        let mesh = SimplicialMesh::<2>::lattice(low, high, cells).unwrap();
        assert_valid(&mesh);
        assert!((volume(&mesh) - 2.4).abs() < 1e-13);
        let rim = |p: [f64; 2]| (0..2).any(|a| (p[a] - low[a]).abs() < 1e-12 || (p[a] - high[a]).abs() < 1e-12);
        assert_neighbors_are_mutual(&mesh, rim);
        assert_eq!(mesh.rim().len(), 2 * (cells[0] + cells[1]) as usize);
    }
    for cells in [[1, 1, 1], [3, 1, 2], [4, 5, 6]] {
        let (low, high) = ([0.1, 0.2, 0.3], [0.8, 1.2, 2.3]);
        let mesh = SimplicialMesh::<3>::lattice(low, high, cells).unwrap();
        assert_valid(&mesh);
        assert!((volume(&mesh) - 1.4).abs() < 1e-13);
        let rim = |p: [f64; 3]| (0..3).any(|a| (p[a] - low[a]).abs() < 1e-12 || (p[a] - high[a]).abs() < 1e-12);
        assert_neighbors_are_mutual(&mesh, rim);
    }
}

#[test]
fn lattices_that_are_not_possible_are_refused() {
    let tiny = f64::EPSILON;
    for (low, high, cells) in [
        ([0.0, 0.0], [1.0, 0.0], [1, 1]),
        ([0.0, 0.0], [-1.0, 1.0], [1, 1]),
        ([0.0, 0.0], [1.0, 1.0], [0, 1]),
        ([0.0, f64::NAN], [1.0, 1.0], [1, 1]),
        ([0.0, 0.0], [f64::INFINITY, 1.0], [1, 1]),
        ([0.0, 0.0], [1e300, 1.0], [1, 1]),
        ([1.0, 0.0], [1.0 + 4.0 * tiny, 1.0], [3, 1]),
        ([0.0, 0.0], [1.0, 1.0], [1 << 16, 1 << 16]),
    ] {
        let refused = SimplicialMesh::<2>::lattice(low, high, cells);
        assert!(matches!(refused, Err(DomainError::Lattice { .. })), "{low:?} {high:?} {cells:?}");
    }
}

#[test]
fn a_square_is_cut_into_four_triangles() {
    let mesh = SimplicialMesh::four_triangles([-1.0, -1.0], [1.0, 1.0]).unwrap();
    assert_valid(&mesh);
    assert_eq!((mesh.len(), mesh.edges().len(), mesh.rim().len()), (4, 8, 4));
    assert!((0..4).all(|s| mesh.volume(s) == 1.0));
    assert_eq!(mesh.vertices()[4], [0.0, 0.0]);
}
