use super::{mesh, moved, sheet, together, turned_over};
use crate::mesh::{Mesh, MeshError, Topology, topology};
use crate::sample::{Scene, SceneKind};

fn of(mesh: &Mesh) -> Topology {
    topology(mesh).expect("a sound mesh")
}

fn scene(kind: SceneKind) -> Mesh {
    Scene::new(kind, 0).truth
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} to {tolerance}");
}

/// No defect of any kind.
fn assert_manifold(t: &Topology) {
    assert_eq!((t.nonmanifold_edges, t.nonmanifold_vertices, t.inconsistent_edges), (0, 0, 0));
    assert_eq!((t.duplicate_triangles, t.degenerate_triangles, t.unused_vertices), (0, 0, 0));
}

#[test]
fn closed_scenes_are_manifold_with_their_volume_and_genus() {
    use std::f64::consts::PI;
    // The tolerance of the curved ones is their tessellation, under 1e-4 of their size.
    let cases = [
        (SceneKind::Box, 0.48, 1e-14, 0),
        (SceneKind::LBlock, 0.25, 1e-14, 0),
        (SceneKind::Stairs, 0.18, 1e-14, 0),
        (SceneKind::Sphere, PI / 6.0, 1e-4, 0),
        (SceneKind::Torus, 2.0 * PI * PI * 0.35 * 0.15 * 0.15, 1e-4, 1),
        (SceneKind::PocketPlate, pocket_plate_volume(), 1e-14, 0),
    ];
    for (kind, volume, tolerance, genus) in cases {
        let t = of(&scene(kind));
        assert_manifold(&t);
        assert!(t.closed, "{kind}");
        assert_eq!((t.components.len(), t.boundary_edges, t.boundary_loops), (1, 0, 0), "{kind}");
        assert_eq!(t.genus, Some(genus), "{kind}");
        assert_eq!(t.euler_characteristic, 2 - 2 * genus as i64, "{kind}");
        assert_near(t.volume.expect("closed"), volume, tolerance);
    }
}

/// The floor, and walls as strips of the plan: the frame, one strip across the length, two along the width less the
/// pieces left out.
fn pocket_plate_volume() -> f64 {
    let frame = 0.7 - 0.98 * 0.68;
    let along = 0.01 * (0.98 - 0.28);
    let across = 2.0 * 0.01 * 0.68 - 2.0 * 0.01 * 0.01 - 0.01 * 0.30;
    0.7 * 0.01 + 0.14 * (frame + along + across)
}

#[test]
fn the_city_is_one_sheet_open_at_its_border_only() {
    for seed in 0..20 {
        let t = of(&Scene::new(SceneKind::City, seed).truth);
        assert_manifold(&t);
        assert_eq!((t.components.len(), t.boundary_edges, t.boundary_loops), (1, 4, 1), "seed {seed}");
        // A disc.
        assert_eq!((t.euler_characteristic, t.closed, t.genus, t.volume), (1, false, None, None), "seed {seed}");
        // 14 flat roofs, and 26 with two ends of a ridge.
        assert_eq!(t.vertices, 4 + 40 * 8 + 26 * 2, "seed {seed}");
    }
}

#[test]
fn a_sheet_has_one_border_and_a_sheet_with_a_hole_two() {
    let t = of(&sheet(5));
    assert_manifold(&t);
    assert_eq!((t.boundary_edges, t.boundary_loops, t.euler_characteristic), (20, 1, 1));
    assert_eq!((t.edges, t.closed), (85, false));
    assert_near(t.area, 1.0, 1e-14);
    assert_eq!(t.bounds, Some([[0.0; 3], [1.0, 1.0, 0.0]]));

    let mut holed = sheet(5);
    // The two triangles of the middle cell.
    holed.triangles.drain(24..26);
    let t = of(&holed);
    assert_eq!((t.boundary_edges, t.boundary_loops, t.euler_characteristic), (24, 2, 0));
    assert_eq!(t.components[0].boundary_edges, 24);
    assert_near(t.components[0].area, 0.96, 1e-14);
}

#[test]
fn components_are_counted_and_sorted_by_size() {
    let parts = [sheet(2), scene(SceneKind::Box), moved(&scene(SceneKind::Torus), [3.0, 0.0, 0.0])];
    let t = of(&together(&parts));
    let faces: Vec<_> = t.components.iter().map(|c| (c.faces, c.genus)).collect();
    assert_eq!(faces, [(262_144, Some(1)), (12, Some(0)), (8, None)]);
    assert_eq!((t.large_components, t.closed, t.genus), (1, false, None));
    assert_eq!(t.components[2].first_triangle, 0);
    assert_near(t.components.iter().map(|c| c.area).sum(), t.area, 1e-12);

    let closed = of(&together(&parts[1..]));
    assert_eq!((closed.genus, closed.closed), (Some(1), true));
}

#[test]
fn volume_does_not_suffer_far_from_the_origin() {
    let far = moved(&scene(SceneKind::Box), [2_600_000.0, 1_200_000.0, 400.0]);
    assert_near(of(&far).volume.expect("closed"), 0.48, 1e-8);
    assert_near(of(&turned_over(&far)).volume.expect("closed"), -0.48, 1e-8);
}

#[test]
fn two_boxes_that_share_a_vertex_are_a_bow_tie() {
    let one = scene(SceneKind::Box);
    let corner = one.vertices.iter().position(|v| *v == [1.0, 0.8, 0.6]).expect("a corner") as u32;
    let mut both = together(&[one.clone(), moved(&one, [1.0, 0.8, 0.6])]);
    let twin = both.vertices[8..].iter().position(|v| *v == [1.0, 0.8, 0.6]).expect("its twin") as u32 + 8;
    for t in &mut both.triangles {
        *t = t.map(|v| if v == twin { corner } else { v });
    }
    let t = of(&both);
    assert_eq!((t.nonmanifold_vertices, t.nonmanifold_edges, t.unused_vertices), (1, 0, 1));
    // Seen by its fans each side is still a sphere, though V - E + F of the whole is 3, not 4.
    assert_eq!(t.components.iter().map(|c| c.genus).collect::<Vec<_>>(), [Some(0), Some(0)]);
    assert_eq!((t.euler_characteristic, t.genus), (3, Some(0)));
}

#[test]
fn three_sheets_at_one_edge_are_non_manifold() {
    let fin = mesh(
        &[[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        &[[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    );
    let t = of(&fin);
    assert_eq!((t.nonmanifold_edges, t.boundary_edges, t.components.len()), (1, 6, 1));
    assert_eq!((t.closed, t.components[0].genus), (false, None));
}

#[test]
fn one_triangle_turned_over_is_inconsistent_at_its_three_edges() {
    let mut one = scene(SceneKind::Box);
    one.triangles[4].swap(0, 1);
    let t = of(&one);
    assert_eq!((t.inconsistent_edges, t.nonmanifold_edges, t.boundary_edges), (3, 0, 0));
    assert_eq!((t.closed, t.genus, t.volume), (false, None, None));
}

#[test]
fn a_moebius_strip_has_no_genus_and_one_border() {
    // Five triangles round five vertices, each sharing two vertices with the next.
    let around = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / 5.0;
        [angle.cos(), angle.sin(), if i.is_multiple_of(2) { 0.3 } else { -0.3 }]
    };
    let vertices: Vec<_> = (0..5).map(around).collect();
    let triangles: Vec<_> = (0..5).map(|i| [i, (i + 1) % 5, (i + 2) % 5]).collect();
    let t = of(&mesh(&vertices, &triangles));
    assert_eq!((t.euler_characteristic, t.boundary_loops, t.boundary_edges), (0, 1, 5));
    assert_eq!(t.components[0].genus, None);
    assert!(t.inconsistent_edges > 0);
}

#[test]
fn duplicate_and_degenerate_triangles_are_counted() {
    let mut one = scene(SceneKind::Box);
    let [a, b, c] = one.triangles[3];
    one.triangles.extend([[b, c, a], [c, b, a], [a, a, b]]);
    let t = of(&one);
    assert_eq!((t.duplicate_triangles, t.degenerate_triangles), (2, 1));
    assert_eq!((t.nonmanifold_edges, t.faces), (3, 15));

    let flat = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]);
    assert_eq!((of(&flat).degenerate_triangles, of(&flat).boundary_edges), (1, 3));
}

#[test]
fn nothing_is_legal_and_broken_meshes_are_named() {
    let t = of(&Mesh::default());
    assert_eq!((t.faces, t.closed, t.bounds, t.components.len()), (0, false, None, 0));
    let missing = mesh(&[[0.0; 3]; 3], &[[0, 1, 2], [0, 7, 1]]);
    assert_eq!(topology(&missing), Err(MeshError::VertexMissing { triangle: 1, vertex: 7, count: 3 }));
    let infinite = mesh(&[[0.0; 3], [0.0, f64::INFINITY, 0.0]], &[]);
    assert!(matches!(topology(&infinite), Err(MeshError::NotFinite { vertex: 1, .. })));
}

#[test]
fn results_do_not_depend_on_threads() {
    let mesh = together(&[scene(SceneKind::Sphere), scene(SceneKind::Torus), sheet(40)]);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| of(&mesh))
    };
    assert_eq!(run(1), run(3));
}
