//! Each way in which a mesh can be wrong, and what the error names.

use super::super::predicates::{holds, orientation, side};
use super::super::{DomainError, SimplicialMesh};
use super::{assert_valid, filled_box, random};

fn triangles(vertices: &[[f64; 2]], triangles: &[[u32; 3]]) -> Result<SimplicialMesh<2>, DomainError> {
    SimplicialMesh::from_triangles(vertices.to_vec(), triangles)
}

fn tetrahedra(vertices: &[[f64; 3]], tetrahedra: &[[u32; 4]]) -> Result<SimplicialMesh<3>, DomainError> {
    SimplicialMesh::from_tetrahedra(vertices.to_vec(), tetrahedra)
}

const SQUARE: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
const UNIT: [[f64; 3]; 4] = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

#[test]
fn what_is_no_mesh_is_refused() {
    assert_eq!(triangles(&SQUARE, &[]).err(), Some(DomainError::Empty));
    let missing = DomainError::VertexMissing { simplex: 1, vertex: 4, count: 4 };
    assert_eq!(triangles(&SQUARE, &[[0, 1, 2], [0, 2, 4]]).err(), Some(missing));
    assert_eq!(triangles(&SQUARE, &[[0, 1, 2]]).err(), Some(DomainError::VertexUnused { vertex: 3 }));
    let not_finite = [[0.0, 0.0], [1.0, 0.0], [1.0, f64::NAN]];
    assert_eq!(triangles(&not_finite, &[[0, 1, 2]]).err(), Some(DomainError::NotFinite { vertex: 2 }));
    for coordinate in [1e61, -1e300, 1e-43, -5e-324] {
        let far = triangles(&[[0.0, 0.0], [1.0, coordinate], [1.0, 1.0]], &[[0, 1, 2]]).unwrap_err();
        assert!(matches!(far, DomainError::OutOfRange { vertex: 1, coordinate: c, .. } if c == coordinate));
    }
}

#[test]
fn degenerate_simplices_are_named() {
    let degenerate = |simplex, corners: &[u32]| Some(DomainError::Degenerate { simplex, corners: corners.to_vec() });
    let line = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.5, 0.5]];
    assert_eq!(triangles(&line, &[[0, 1, 2], [1, 2, 3]]).err(), degenerate(1, &[1, 2, 3]));
    assert_eq!(triangles(&line, &[[0, 1, 1]]).err(), degenerate(0, &[0, 1, 1]));
    // The third is off the line by less than a plain determinant can tell.
    let nearly = [[0.5, 0.5], [12.0, 12.0], [24.0, f64::from_bits(24.0_f64.to_bits() + 1)]];
    assert!(triangles(&nearly, &[[0, 1, 2]]).is_ok());
    let flat = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0]];
    assert_eq!(tetrahedra(&flat, &[[0, 1, 2, 3]]).err(), degenerate(0, &[0, 1, 2, 3]));
}

#[test]
fn simplices_are_turned_to_positive() {
    let mesh = triangles(&SQUARE, &[[0, 2, 1], [0, 2, 3]]).unwrap();
    assert_eq!((mesh.simplex(0), mesh.simplex(1)), (&[0, 1, 2][..], &[0, 2, 3][..]));
    let mesh = tetrahedra(&UNIT, &[[0, 1, 3, 2]]).unwrap();
    assert_eq!(mesh.simplex(0), [0, 1, 2, 3]);
    assert!((mesh.volume(0) - 1.0 / 6.0).abs() < 1e-16);
}

#[test]
fn overlapping_triangles_are_named() {
    let overlap = |a, b| Some(DomainError::Overlap { simplices: [a, b] });
    assert_eq!(triangles(&SQUARE[..3], &[[0, 1, 2], [1, 2, 0]]).err(), overlap(0, 1));
    assert_eq!(triangles(&SQUARE, &[[0, 1, 2], [0, 1, 3]]).err(), overlap(0, 1));
    // One inside the other, and two whose edges cross with no vertex inside.
    let nested = [[0.0, 0.0], [9.0, 0.0], [0.0, 9.0], [1.0, 1.0], [2.0, 1.0], [1.0, 2.0]];
    assert_eq!(triangles(&nested, &[[0, 1, 2], [3, 4, 5]]).err(), overlap(0, 1));
    let star = [[0.0, 0.0], [6.0, 0.0], [3.0, 6.0], [0.0, 4.0], [6.0, 4.0], [3.0, -2.0]];
    assert_eq!(triangles(&star, &[[0, 1, 2], [3, 4, 5]]).err(), overlap(0, 1));
    // The same place twice under different numbers.
    let twice: Vec<_> = SQUARE[..3].iter().chain(&SQUARE[..3]).copied().collect();
    assert_eq!(triangles(&twice, &[[0, 1, 2], [3, 4, 5]]).err(), overlap(0, 1));
    // The lowest pair is named.
    let mesh = SimplicialMesh::<2>::lattice([0.0; 2], [1.0; 2], [8, 8]).unwrap();
    let mut all: Vec<[u32; 3]> = mesh.corners.as_chunks().0.to_vec();
    all.push(all[100]);
    all.push(all[7]);
    assert_eq!(SimplicialMesh::from_triangles(mesh.vertices, &all).err(), overlap(7, 129));
}

#[test]
fn edges_that_are_not_shared_whole_are_named() {
    let hanging = |a, b| Some(DomainError::HangingFace { simplices: [a, b] });
    let tee = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [0.0, -1.0], [1.0, 0.0], [2.0, -1.0]];
    assert_eq!(triangles(&tee, &[[0, 1, 2], [0, 3, 4], [4, 5, 1]]).err(), hanging(0, 1));
    // A corner in the middle of an edge, without a shared vertex.
    let touch = [[0.0, 0.0], [2.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, -1.0], [2.0, -1.0]];
    assert_eq!(triangles(&touch, &[[0, 1, 2], [3, 4, 5]]).err(), hanging(0, 1));
    // Two vertices at one place.
    let double = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [0.0, 0.0], [-1.0, 0.0], [0.0, -1.0]];
    assert_eq!(triangles(&double, &[[0, 1, 2], [3, 4, 5]]).err(), hanging(0, 1));
    // Shared by its number, the same vertex is in order.
    assert!(triangles(&double[..5], &[[0, 1, 2], [0, 4, 3]]).is_err());
    let bow = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [-1.0, 0.0], [0.0, -1.0]];
    assert_valid(&triangles(&bow, &[[0, 1, 2], [0, 3, 4]]).unwrap());
}

#[test]
fn overlapping_tetrahedra_are_named() {
    let overlap = Some(DomainError::Overlap { simplices: [0, 1] });
    let with = |more: &[[f64; 3]]| UNIT.iter().chain(more).copied().collect::<Vec<_>>();
    assert_eq!(tetrahedra(&UNIT, &[[0, 1, 2, 3], [3, 2, 1, 0]]).err(), overlap);
    // Beyond the same face.
    assert_eq!(tetrahedra(&with(&[[0.2, 0.2, 2.0]]), &[[0, 1, 2, 3], [0, 1, 2, 4]]).err(), overlap);
    // An edge through two faces, and no vertex of one in the other.
    let through = with(&[[0.2, 0.2, -1.0], [0.2, 0.3, 3.0], [5.0, 5.0, 1.0], [5.0, 6.0, 1.0]]);
    assert_eq!(tetrahedra(&through, &[[0, 1, 2, 3], [4, 5, 6, 7]]).err(), overlap);
    // Two edges that cross where both tetrahedra go on to both sides.
    let cross = [
        [-1.0, 0.0, 0.0],
        [1.0, 0.0, 0.0],
        [0.0, 3.0, 1.0],
        [0.0, 3.0, -1.0],
        [0.0, 0.0, -1.0],
        [0.0, 0.0, 1.0],
        [-0.5, 1.0, 0.0],
        [0.5, 1.0, 0.0],
    ];
    assert_eq!(tetrahedra(&cross, &[[0, 1, 2, 3], [4, 5, 6, 7]]).err(), overlap);
    // A shared vertex, and a common inside.
    let apex = with(&[[2.0, 0.1, 0.1], [0.1, 2.0, 0.1], [0.1, 0.1, 2.0]]);
    assert_eq!(tetrahedra(&apex, &[[0, 1, 2, 3], [0, 4, 5, 6]]).err(), overlap);
}

#[test]
fn faces_that_are_not_shared_whole_are_named() {
    let hanging = Some(DomainError::HangingFace { simplices: [0, 1] });
    let with = |more: &[[f64; 3]]| UNIT.iter().chain(more).copied().collect::<Vec<_>>();
    let pair = &[[0, 1, 2, 3], [4, 5, 6, 7]];
    // A vertex in a face, in an edge, and on a vertex of another number.
    let tips = [[0.2, 0.2, 0.0], [0.5, 0.0, 0.0], [0.0, 0.0, 0.0]];
    for tip in tips {
        let below = with(&[tip, [0.0, -1.0, -1.0], [1.0, -1.0, -1.0], [0.0, -0.5, -2.0]]);
        assert_eq!(tetrahedra(&below, pair).err(), hanging, "{tip:?}");
    }
    // Faces of one plane that overlap in a star, with no vertex in the other: only edges cross.
    let star = with(&[[0.6, 0.6, 0.0], [-0.3, 0.6, 0.0], [0.6, -0.3, 0.0], [0.0, 0.0, -1.0]]);
    assert_eq!(tetrahedra(&star, pair).err(), hanging);
    // Edges that cross, with the insides on either side.
    let cross = with(&[[0.5, -1.0, 0.0], [0.5, 1.0, 0.0], [0.5, -1.0, -1.0], [0.6, 0.5, -1.0]]);
    assert_eq!(tetrahedra(&cross, pair).err(), hanging);
    // A shared edge, and half of a face.
    let half = with(&[[0.0, 2.0, 0.0], [0.0, 0.0, -1.0]]);
    assert_eq!(tetrahedra(&half, &[[0, 1, 2, 3], [0, 1, 4, 5]]).err(), hanging);
}

#[test]
fn a_hanging_node_in_a_refined_mesh_is_found() {
    let mesh = SimplicialMesh::<3>::delaunay(&filled_box(3, 60)).unwrap();
    let mut all: Vec<[u32; 4]> = mesh.corners.as_chunks().0.to_vec();
    // One edge is halved in one of its tetrahedra only.
    let [a, b, c, d] = all[40];
    let (p, q) = (mesh.vertices[a as usize], mesh.vertices[b as usize]);
    let mut vertices = mesh.vertices.clone();
    // Doubling and halving are exact, so the middle is where it should be up to one rounding; it need not be on the edge.
    vertices.push(std::array::from_fn(|k| 0.5 * (p[k] + q[k])));
    let middle = vertices.len() as u32 - 1;
    all[40] = [a, middle, c, d];
    all.push([middle, b, c, d]);
    let refused = SimplicialMesh::from_tetrahedra(vertices, &all).unwrap_err();
    assert!(matches!(refused, DomainError::HangingFace { .. } | DomainError::Overlap { .. }), "{refused}");
}

/// How two tetrahedra meet.
#[derive(Debug, PartialEq)]
enum Meeting {
    Not,
    Outside,
    Inside,
}

/// How two tetrahedra meet, by their differences: they meet if zero lies in the hull of the differences of their corners, and their
/// insides meet if it lies inside the hull.
fn by_differences(a: &[[f64; 3]], b: &[[f64; 3]]) -> Meeting {
    let differences: Vec<[f64; 3]> =
        a.iter().flat_map(|p| b.iter().map(move |q| std::array::from_fn(|k| p[k] - q[k]))).collect();
    let (mut meets, mut inside, count) = (false, true, differences.len());
    for i in 0..count {
        for j in i + 1..count {
            for k in j + 1..count {
                let mut points = [differences[i], differences[j], differences[k], [0.0; 3]];
                let zero = orientation(&points);
                let signs = differences.iter().map(|&d| side(&points, 3, d));
                let (least, most) = signs.fold((0.0_f64, 0.0_f64), |(l, m), s| (l.min(s), m.max(s)));
                inside &= least * most < 0.0 || least == most || zero * (least + most) > 0.0;
                for &last in &differences[k + 1..] {
                    points[3] = last;
                    let volume = orientation(&points);
                    if !meets && volume != 0.0 {
                        let [p, q, r, s] = points;
                        meets = holds(&if volume > 0.0 { [p, q, r, s] } else { [p, q, s, r] }, [0.0; 3]);
                    }
                }
            }
        }
    }
    match (meets, inside) {
        (false, _) => Meeting::Not,
        (true, false) => Meeting::Outside,
        (true, true) => Meeting::Inside,
    }
}

#[test]
fn small_tetrahedra_meet_as_their_differences_say() {
    let mut counts = [0; 3];
    for seed in 0..1500 {
        // Few different coordinates, so that vertices, edges and faces touch often.
        let points: Vec<_> = random::<3>(seed, 8).into_iter().map(|p| p.map(|c| (5.0 * c).floor())).collect();
        let (a, b) = points.split_at(4);
        if orientation(a) == 0.0 || orientation(b) == 0.0 {
            continue;
        }
        let meeting = by_differences(a, b);
        let found = match tetrahedra(&points, &[[0, 1, 2, 3], [4, 5, 6, 7]]) {
            Ok(_) => Meeting::Not,
            Err(DomainError::HangingFace { simplices: [0, 1] }) => Meeting::Outside,
            Err(DomainError::Overlap { simplices: [0, 1] }) => Meeting::Inside,
            Err(other) => panic!("{other}"),
        };
        assert_eq!(found, meeting, "{points:?}");
        counts[meeting as usize] += 1;
        // With vertices of one place made one, contact in them alone is in order, and insides that meet are not.
        let shared = [4, 5, 6, 7].map(|k: u32| (0..4).find(|&l| points[l as usize] == points[k as usize]).unwrap_or(k));
        let mut used: Vec<u32> = [0, 1, 2, 3].into_iter().chain(shared).collect();
        used.sort_unstable();
        used.dedup();
        let number = |v: u32| used.binary_search(&v).unwrap() as u32;
        let kept: Vec<_> = used.iter().map(|&v| points[v as usize]).collect();
        let welded = tetrahedra(&kept, &[[0, 1, 2, 3], shared.map(number)]);
        let overlaps = matches!(welded, Err(DomainError::Overlap { .. }));
        assert_eq!(overlaps, found == Meeting::Inside, "{points:?}");
    }
    assert!(counts.iter().all(|&count| count > 50), "{counts:?}");
}
