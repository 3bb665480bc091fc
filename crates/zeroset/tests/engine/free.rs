//! Scenes of which nothing is known.

use zeroset::cloud::Cloud;
use zeroset::fit::cascade::Scene;
use zeroset::mesh::{CompareParams, compare};
use zeroset::reconstruct::{ReconstructParams, Resolution, plan};
use zeroset::sample::{Scene as Sample, SceneKind};

fn free(resolution: f64) -> ReconstructParams {
    ReconstructParams {
        scene: Some(Scene::Free),
        resolution: Resolution::Length(resolution),
        ..ReconstructParams::default()
    }
}

#[test]
fn bodies_come_out_closed_and_right_side_out() {
    // Bounds as for objects: see `bodies_are_closed_whole_and_filled`.
    for (kind, occupancy) in [(SceneKind::Sphere, 0.997), (SceneKind::Torus, 0.996), (SceneKind::Box, 0.99)] {
        let scene = Sample::new(kind, 1);
        let cloud = scene.points(20_000, 0.001, 1);
        let (mesh, report) = plan(&cloud, &free(0.014), &()).expect("a plan").run(&()).expect("a surface");
        let params = CompareParams { samples: 40_000, ..CompareParams::default() };
        let found = compare(&mesh, &scene.truth, &params, &()).expect("two surfaces");
        assert!(found.mesh.closed, "{kind}");
        assert!(found.overall.orientation > 0.999, "{kind}: {}", found.overall.orientation);
        assert!(found.occupancy.expect("both are closed") > occupancy, "{kind}: {:?}", found.occupancy);
        assert_eq!(report.fit.levels[0].outside_share, Some(1.0), "{kind}");
    }
}

/// Rolling ground, one height over each place of the unit square.
fn ground(n: u32) -> (Vec<[f64; 3]>, impl Fn(f64, f64) -> f64) {
    let height = |x: f64, y: f64| 0.08 * (5.0 * x).sin() * (4.0 * y).cos() + 0.05 * x;
    let at = |i: u32| (f64::from(i) + 0.5) / f64::from(n);
    let points = (0..n).flat_map(|i| (0..n).map(move |j| [at(i), at(j), height(at(i), at(j))])).collect();
    (points, height)
}

#[test]
fn an_open_sheet_has_one_sign_on_each_side_and_the_upper_one_is_outside() {
    let (points, height) = ground(120);
    let cloud = Cloud { points, ..Cloud::default() };
    let cell = 0.014;
    let (mesh, report) = plan(&cloud, &free(cell), &()).expect("a plan").run(&()).expect("a surface");
    let share = report.fit.levels[0].outside_share.expect("of a free scene");
    assert!((0.1..0.9).contains(&share), "the sheet cuts the box: {share}");
    let mut area = 0.0;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
        let over = |v: &[f64; 3]| (0.05..0.95).contains(&v[0]) && (0.05..0.95).contains(&v[1]);
        if [a, b, c].iter().all(over) {
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            assert!(twice > 0.0, "faces down at {a:?}");
            assert!((a[2] - height(a[0], a[1])).abs() < cell, "off the ground at {a:?}");
            area += 0.5 * twice;
        }
    }
    // One sheet over the square but for its rim of cut triangles.
    assert!((0.74..=0.81).contains(&area), "{area}");
}

#[test]
fn the_mesh_is_equal_on_one_and_on_three_threads() {
    let cloud = Sample::new(SceneKind::LBlock, 1).points(10_000, 0.001, 1);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| plan(&cloud, &free(0.02), &()).expect("a plan").run(&()).expect("a surface").0)
    };
    assert!(run(1) == run(3));
}
