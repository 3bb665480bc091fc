//! Meshes with sharp edges stay sound and come out sharp, whatever the scene.

use zeroset::mesh::{CompareParams, Mesh, compare, self_intersections, topology};
use zeroset::reconstruct::{Quality, ReconstructParams, Resolution, plan};
use zeroset::sample::{Scene, SceneKind};

const POINTS: usize = 20_000;
const NOISE: f64 = 0.002;
const CELL: f64 = 0.011;

fn made(scene: &Scene, quality: Quality, seed: u64) -> Mesh {
    let cloud = scene.points(POINTS, NOISE, seed);
    let params = ReconstructParams { resolution: Resolution::Length(CELL), quality, ..ReconstructParams::default() };
    plan(&cloud, &params, &()).expect("a plan").run(&()).expect("a surface").0
}

#[test]
fn sharp_meshes_of_random_cities_are_manifolds_that_do_not_meet_themselves() {
    for (kind, seed) in [
        (SceneKind::City, 0),
        (SceneKind::City, 1),
        (SceneKind::City, 2),
        (SceneKind::AirborneCity, 3),
        (SceneKind::AirborneCity, 4),
    ] {
        let mut mesh = made(&Scene::new(kind, seed), Quality::Normal, seed);
        let t = topology(&mesh).unwrap();
        assert_eq!((t.nonmanifold_edges, t.nonmanifold_vertices, t.inconsistent_edges), (0, 0, 0), "{kind:?} {seed}");
        assert_eq!((t.duplicate_triangles, t.degenerate_triangles), (0, 0), "{kind:?} {seed}");
        // As files hold them: with more digits, corners of triangles that share a line lie beside it by the last of these.
        mesh.vertices.iter_mut().for_each(|v| *v = v.map(|c| f64::from(c as f32)));
        assert_eq!(self_intersections(&mesh, 1, &()).unwrap().pairs, 0, "{kind:?} {seed}");
    }
}

#[test]
fn normal_quality_halves_the_error_of_a_draft_and_finds_its_creases() {
    let scene = Scene::new(SceneKind::City, 5);
    let [draft, normal] = [Quality::Draft, Quality::Normal].map(|quality| {
        let params = CompareParams { samples: 40_000, ..CompareParams::default() };
        compare(&made(&scene, quality, 5), &scene.truth, &params, &()).expect("two surfaces")
    });
    let mean = |report: &zeroset::mesh::CompareReport| report.overall.distances.combined.mean;
    let crease = |report: &zeroset::mesh::CompareReport| report.crease_distance.as_ref().expect("creases").mean;
    assert!(mean(&normal) < 0.5 * mean(&draft), "{} {}", mean(&normal), mean(&draft));
    assert!(crease(&normal) < 0.4 * crease(&draft), "{} {}", crease(&normal), crease(&draft));
}
