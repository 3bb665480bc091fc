//! Every tree against the plain loop over all items.

use super::*;
use crate::mesh::Mesh;
use crate::vec3;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

fn random_points(n: usize, seed: u64) -> Vec<[f64; 3]> {
    let mut rng = Pcg64Mcg::seed_from_u64(seed);
    (0..n).map(|_| std::array::from_fn(|_| rng.random::<f64>())).collect()
}

fn all_by_distance(points: &[[f64; 3]], q: [f64; 3]) -> Vec<Neighbour> {
    let mut all: Vec<_> = points
        .iter()
        .enumerate()
        .filter(|(_, p)| vec3::is_finite(**p))
        .map(|(index, p)| Neighbour { index, distance_squared: vec3::distance_squared(*p, q) })
        .collect();
    all.sort_by(|a, b| a.distance_squared.total_cmp(&b.distance_squared).then(a.index.cmp(&b.index)));
    all
}

fn assert_same_as_loop(points: &[[f64; 3]], queries: &[[f64; 3]]) {
    let tree = PointTree::new(points);
    let mut found = Vec::new();
    for &q in queries {
        let all = all_by_distance(points, q);
        assert_eq!(tree.nearest(q), all.first().copied());
        for k in [1, 2, 7, 40] {
            tree.k_nearest(q, k, &mut found);
            assert_eq!(found, all[..k.min(all.len())]);
        }
        for radius in [0.0, 0.05, 0.3, 10.0] {
            let inside = all.iter().filter(|n| n.distance_squared <= radius * radius).count();
            assert_eq!(tree.count_within(q, radius), inside);
            let mut visited = Vec::new();
            tree.visit_within(q, radius, |index| visited.push(index));
            visited.sort_unstable();
            let mut expected: Vec<_> = all[..inside].iter().map(|n| n.index).collect();
            expected.sort_unstable();
            assert_eq!(visited, expected);
            assert_eq!(tree.nearest_within(q, radius), all.first().copied().filter(|_| inside > 0));
        }
    }
}

#[test]
fn random_points_are_found_as_by_a_loop() {
    let points = random_points(3000, 1);
    let mut queries = random_points(40, 2);
    queries.extend_from_slice(&points[..20]);
    queries.push([-5.0, 0.5, 9.0]);
    assert_same_as_loop(&points, &queries);
}

#[test]
fn ties_on_a_lattice_go_to_the_lowest_index() {
    let mut points: Vec<_> =
        (0..1000).map(|i| [f64::from(i % 10), f64::from(i / 10 % 10), f64::from(i / 100)]).collect();
    points.reverse();
    assert_same_as_loop(&points, &[[4.5, 4.5, 4.5], [0.0, 0.5, 0.5], [3.0, 3.0, 3.5], [9.0, 9.0, 9.0]]);
}

#[test]
fn few_equal_and_collinear_points_are_legal() {
    let q = [0.1, 0.2, 0.3];
    assert_same_as_loop(&[], &[q]);
    assert_same_as_loop(&[[1.0; 3]], &[q, [1.0; 3]]);
    assert_same_as_loop(&vec![[0.1, 0.2, 0.3]; 500], &[q, [1.0; 3]]);
    let line: Vec<_> = (0..700).map(|i| [0.1 * f64::from(i % 90), 0.0, 0.0]).collect();
    assert_same_as_loop(&line, &[q, [4.5, 0.0, 0.0], [4.55, 3.0, 0.0]]);
}

#[test]
fn non_finite_points_are_never_found() {
    let mut points = random_points(50, 3);
    points[7] = [f64::NAN, 0.5, 0.5];
    points[8] = [0.5, f64::INFINITY, 0.5];
    points[9] = [0.5, 0.5, f64::NEG_INFINITY];
    assert_same_as_loop(&points, &[[0.5; 3]]);
    let tree = PointTree::new(&points);
    assert_eq!(tree.len(), 47);
    assert_eq!(tree.nearest([f64::NAN, 0.0, 0.0]), None);
    assert_eq!(tree.nearest_within([0.0; 3], f64::NAN), None);
    assert_eq!(tree.count_within([0.0; 3], -1.0), 0);
    assert!(PointTree::new(&[[f64::NAN; 3]]).is_empty());
}

#[test]
fn a_million_equal_points_cost_no_more_than_one_path() {
    // Without the index in the search order, each of these queries would visit every leaf and the test take hours.
    let points = vec![[0.5; 3]; 1_000_000];
    let tree = PointTree::new(&points);
    let mut found = Vec::new();
    for _ in 0..100_000 {
        tree.k_nearest([0.5; 3], 8, &mut found);
    }
    assert_eq!(found.iter().map(|n| n.index).collect::<Vec<_>>(), [0, 1, 2, 3, 4, 5, 6, 7]);
    assert_eq!(tree.count_within([0.5; 3], 0.0), 1_000_000);
}

#[test]
fn the_tree_is_the_same_on_any_number_of_threads() {
    let points = random_points(100_000, 4);
    let order = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| PointTree::new(&points).spatial_order().collect::<Vec<_>>())
    };
    assert_eq!(order(1), order(5));
}

/// A sphere of triangles by latitude and longitude; `flatten` < 1 makes it an ellipsoid.
fn ellipsoid(rings: u32, flatten: f64) -> Mesh {
    let sectors = 2 * rings;
    let mut vertices = vec![[0.0, 0.0, flatten], [0.0, 0.0, -flatten]];
    for ring in 1..rings {
        let polar = std::f64::consts::PI * f64::from(ring) / f64::from(rings);
        for sector in 0..sectors {
            let turn = std::f64::consts::TAU * f64::from(sector) / f64::from(sectors);
            vertices.push([polar.sin() * turn.cos(), polar.sin() * turn.sin(), flatten * polar.cos()]);
        }
    }
    let at = |ring: u32, sector: u32| 2 + (ring - 1) * sectors + sector % sectors;
    let mut triangles = Vec::new();
    for sector in 0..sectors {
        triangles.push([0, at(1, sector), at(1, sector + 1)]);
        triangles.push([1, at(rings - 1, sector + 1), at(rings - 1, sector)]);
        for ring in 1..rings - 1 {
            let [a, b] = [at(ring, sector), at(ring, sector + 1)];
            let [c, d] = [at(ring + 1, sector), at(ring + 1, sector + 1)];
            triangles.extend([[a, c, d], [a, d, b]]);
        }
    }
    Mesh { vertices, triangles, ..Mesh::default() }
}

#[test]
fn closest_points_are_those_of_the_loop_over_triangles() {
    let mesh = ellipsoid(12, 0.3);
    let tree = TriangleTree::new(&mesh);
    for q in random_points(300, 5).iter().map(|p| p.map(|c| 3.0 * c - 1.5)) {
        let distances = mesh.triangles.iter().map(|t| {
            let point = triangles::closest_on_triangle(t.map(|v| mesh.vertices[v as usize]), q);
            vec3::distance_squared(point, q)
        });
        let best = distances.fold(f64::INFINITY, f64::min);
        let found = tree.closest(q).expect("the mesh has triangles");
        assert!((found.distance_squared.sqrt() - best.sqrt()).abs() < 1e-14);
        assert_eq!(vec3::distance_squared(found.position, q), found.distance_squared);
        assert_eq!(tree.closest_within(q, 0.2), Some(found).filter(|f| f.distance_squared <= 0.2 * 0.2));
    }
}

#[test]
fn the_closest_point_of_one_triangle_covers_face_edges_and_corners() {
    let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
    let cases = [
        ([0.5, 0.5, 3.0], [0.5, 0.5, 0.0]),
        ([1.0, -1.0, 1.0], [1.0, 0.0, 0.0]),
        ([2.0, 2.0, 0.0], [1.0, 1.0, 0.0]),
        ([-1.0, 1.0, -1.0], [0.0, 1.0, 0.0]),
        ([-1.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
        ([5.0, -1.0, 0.0], [2.0, 0.0, 0.0]),
        ([-1.0, 5.0, 0.0], [0.0, 2.0, 0.0]),
    ];
    for (q, expected) in cases {
        let found = triangles::closest_on_triangle(triangle, q);
        assert!(vec3::distance(found, expected) < 1e-15, "{q:?} gave {found:?}");
    }
}

#[test]
fn degenerate_triangles_act_as_segments_and_points() {
    let point = [1.0, 2.0, 3.0];
    assert_eq!(triangles::closest_on_triangle([point; 3], [0.0; 3]), point);
    let segment = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 0.0, 0.0]];
    assert_eq!(triangles::closest_on_triangle(segment, [3.0, 1.0, 0.0]), [3.0, 0.0, 0.0]);
    // A needle a thousand million times longer than wide.
    let needle = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.5, 1e-9, 0.0]];
    assert!(vec3::distance(triangles::closest_on_triangle(needle, [0.3, -1.0, 1.0]), [0.3, 0.0, 0.0]) < 1e-9);
}

#[test]
fn broken_triangles_are_passed_over() {
    let mesh = Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [f64::NAN, 0.0, 0.0]],
        triangles: vec![[0, 1, 3], [0, 1, 9], [0, 1, 2]],
        ..Mesh::default()
    };
    let tree = TriangleTree::new(&mesh);
    assert_eq!(tree.len(), 1);
    assert_eq!(tree.closest([0.2, 0.2, 1.0]).map(|c| c.triangle), Some(2));
    let empty = TriangleTree::new(&Mesh::default());
    assert_eq!(empty.closest([0.0; 3]), None);
    assert_eq!(empty.ray([0.0; 3], [0.0, 0.0, 1.0]), None);
    assert_eq!(empty.winding_number([0.0; 3]).value, 0.0);
}

#[test]
fn segments_are_searched_as_exactly_as_triangles() {
    let segments = [[[0.0; 3], [1.0, 0.0, 0.0]], [[0.0, 1.0, 0.0], [0.0, 1.0, 5.0]]];
    let tree = TriangleTree::from_segments(&segments);
    let found = tree.closest([0.1, 1.0, 2.0]).expect("two segments");
    assert_eq!((found.triangle, found.position), (1, [0.0, 1.0, 2.0]));
}

#[test]
fn rays_hit_the_first_triangle_and_slip_through_no_edge() {
    let mesh = ellipsoid(16, 1.0);
    let tree = TriangleTree::new(&mesh);
    // From the centre every ray leaves; aimed at vertices and at the middle of edges it meets several triangles at
    // once.
    let mut targets = mesh.vertices.clone();
    for t in &mesh.triangles {
        let [a, b, _] = t.map(|v| mesh.vertices[v as usize]);
        targets.push(vec3::lerp(a, b, 0.5));
    }
    for target in targets {
        let hit = tree.ray([0.0; 3], target).expect("no ray leaves a closed mesh unseen");
        assert!((hit.parameter - 1.0).abs() < 1e-12, "{}", hit.parameter);
        // From far outside the near side is hit, not the far one.
        let outside = vec3::scale(target, 10.0);
        let hit = tree.ray(outside, vec3::scale(target, -1.0)).expect("aimed at the centre");
        assert!((hit.parameter - 9.0).abs() < 1e-11);
        assert!(vec3::distance(hit.position, target) < 1e-11);
        assert_eq!(tree.ray(outside, target), None);
    }
    assert_eq!(tree.ray([0.0; 3], [0.0; 3]), None);
    assert_eq!(tree.ray([0.0; 3], [f64::NAN, 0.0, 1.0]), None);
}

#[test]
fn winding_numbers_stay_within_their_bound() {
    for flatten in [1.0, 0.02] {
        let mesh = ellipsoid(64, flatten);
        let tree = TriangleTree::new(&mesh);
        let mut worst = 0.0_f64;
        for q in random_points(400, 6).iter().map(|p| p.map(|c| 3.0 * c - 1.5)) {
            let fast = tree.winding_number(q);
            let exact = tree.winding_number_exact(q);
            let error = (fast.value - exact).abs();
            assert!(error <= fast.error_bound + 1e-12, "{q:?}: {error} over {}", fast.error_bound);
            worst = worst.max(error);
        }
        assert!(worst < 0.02, "flattened to {flatten}: {worst}");
        assert!((tree.winding_number_exact([0.0; 3]) - 1.0).abs() < 1e-12);
        assert!(tree.winding_number_exact([1.1, 0.0, 0.0]).abs() < 1e-12);
    }
}

#[test]
fn an_open_mesh_has_fractions_and_a_turned_one_negative_numbers() {
    let mut mesh = ellipsoid(32, 1.0);
    for t in &mut mesh.triangles {
        t.swap(1, 2);
    }
    let turned = TriangleTree::new(&mesh);
    assert!((turned.winding_number([0.1, 0.2, 0.3]).value + 1.0).abs() < 0.02);
    mesh.triangles.retain(|t| t.iter().all(|&v| mesh.vertices[v as usize][2] >= -1e-9));
    let half = TriangleTree::new(&mesh);
    assert!((half.winding_number([0.0; 3]).value + 0.5).abs() < 0.02);
}
