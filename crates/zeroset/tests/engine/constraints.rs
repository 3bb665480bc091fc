//! Lines and polygons of the user: they hold the surface where points are missing, and nothing else changes.

use zeroset::cloud::Cloud;
use zeroset::constraint::{ConstraintReport, Constraints};
use zeroset::fit::cascade::Scene;
use zeroset::mesh::{Mesh, topology};
use zeroset::reconstruct::{Quality, ReconstructError, ReconstructParams, ReconstructReport, Resolution, Trim, plan};
use zeroset::sample::{Scene as Sample, SceneKind};
use zeroset::spatial::TriangleTree;

const CELL: f64 = 0.02;
/// The box's edge that lost its points.
const EDGE: [[f64; 3]; 2] = [[0.0, 0.8, 0.6], [1.0, 0.8, 0.6]];

/// A box of 1 x 0.8 x 0.6 whose points beside one edge are missing.
fn chipped() -> Cloud {
    let mut cloud = Sample::new(SceneKind::Box, 0).points(20_000, 0.001, 1);
    cloud.points.retain(|p| (p[1] - EDGE[0][1]).hypot(p[2] - EDGE[0][2]) > 0.12);
    cloud
}

fn known(line: bool, polygons: bool) -> Constraints {
    let mut known = Constraints::default();
    let inward = |by: [f64; 2]| EDGE.map(|p| [p[0], p[1] - by[0], p[2] - by[1]]);
    if line {
        known.line(&EDGE).unwrap();
    }
    for by in [[0.13, 0.0], [0.0, 0.13]].into_iter().filter(|_| polygons) {
        let [a, b] = inward(by);
        known.polygon(&[vec![EDGE[0], EDGE[1], b, a]]).unwrap();
    }
    known
}

fn run(cloud: &Cloud, quality: Quality, constraints: Constraints) -> (Mesh, ReconstructReport) {
    let params = ReconstructParams {
        scene: Some(Scene::Object),
        resolution: Resolution::Length(CELL),
        quality,
        constraints,
        ..ReconstructParams::default()
    };
    plan(cloud, &params, &()).expect("a plan").run(&()).expect("a surface")
}

/// Mean and largest distance of the middle of the edge from a mesh, in cells.
fn off_edge(mesh: &Mesh) -> [f64; 2] {
    let tree = TriangleTree::new(mesh);
    let distance = |i: i32| {
        let p = [0.03 + 0.94 * f64::from(i) / 200.0, EDGE[0][1], EDGE[0][2]];
        tree.closest(p).expect("triangles").distance_squared.sqrt() / CELL
    };
    let all: Vec<f64> = (0..=200).map(distance).collect();
    [all.iter().sum::<f64>() / all.len() as f64, all.into_iter().fold(0.0, f64::max)]
}

#[test]
fn an_edge_without_points_comes_back() {
    let cloud = chipped();
    // Bounds on the mean and the largest distance, in cells.
    let cases = [
        (Quality::Draft, true, false, [0.15, 0.5]),
        (Quality::Draft, true, true, [0.35, 0.6]),
        // Where the step that puts mesh edges on lines would fold a triangle, it leaves it: at one or two of the 200 places.
        (Quality::Normal, true, false, [0.03, 0.5]),
        (Quality::Normal, false, true, [0.01, 0.1]),
        (Quality::Normal, true, true, [0.01, 0.1]),
    ];
    for quality in [Quality::Draft, Quality::Normal] {
        let (mesh, report) = run(&cloud, quality, Constraints::default());
        let [mean, _] = off_edge(&mesh);
        assert!(mean > 2.0, "{quality:?} without: {mean} cells");
        assert_eq!((report.constraints, report.plan.constraints), (None, None));
    }
    for (quality, line, polygons, most) in cases {
        let (mesh, report) = run(&cloud, quality, known(line, polygons));
        let what = format!("{quality:?}, line {line}, polygons {polygons}");
        let off = off_edge(&mesh);
        println!("{what}: {off:?} cells");
        assert!(off[0] < most[0] && off[1] < most[1], "{what}: {off:?} cells");
        let ConstraintReport { mean_distance, max_distance, .. } = report.constraints.expect("figures");
        assert!(mean_distance < CELL && max_distance < 2.0 * CELL, "{what}: {mean_distance} {max_distance}");
        let t = topology(&mesh).expect("a mesh");
        assert!(t.closed, "{what}");
        assert_eq!((t.nonmanifold_edges, t.inconsistent_edges, t.large_components), (0, 0, 1), "{what}");
        assert_eq!(report.plan.points, cloud.len());
    }
}

#[test]
fn what_is_measured_in_the_points_stays() {
    let cloud = chipped();
    let params = |constraints| ReconstructParams { constraints, ..ReconstructParams::default() };
    let [without, with] =
        [Constraints::default(), known(true, true)].map(|c| plan(&cloud, &params(c), &()).expect("a plan").report);
    assert_eq!(
        (with.points, with.bounds, with.spacing, with.noise, with.scene, with.resolution),
        (without.points, without.bounds, without.spacing, without.noise, without.scene, without.resolution)
    );
    let used = with.constraints.expect("what takes part");
    assert_eq!((used.lines, used.lines_used, used.polygons, used.polygons_used), (1, 1, 2, 2));
    assert!((used.length - 1.0).abs() < 1e-9 && (used.area - 0.26).abs() < 1e-9, "{used:?}");
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_at_any_offset() {
    let cloud = chipped();
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        pool.install(|| run(&cloud, Quality::Normal, known(true, true)).0)
    };
    let one = on(1);
    assert!(one == on(3), "threads change the mesh");
    // A power of two, so that nothing is rounded.
    let mut far = cloud.clone();
    far.world_from_local = [524_288.0, 4_194_304.0, 64.0];
    let at = |p: [f64; 3]| std::array::from_fn(|a| p[a] + far.world_from_local[a]);
    let mut shifted = Constraints::default();
    shifted.line(&EDGE.map(at)).unwrap();
    let ([there, _], [here, _]) = (
        off_edge(&run(&far, Quality::Normal, shifted).0),
        off_edge(&run(&cloud, Quality::Normal, known(true, false)).0),
    );
    assert!((there - here).abs() < 0.01, "{there} {here}");
}

#[test]
fn ground_keeps_its_box_and_gets_its_kerb() {
    // A terrace 0.05 high whose step holds no points within 0.06.
    let mut points = Vec::new();
    for i in 0..150 {
        for k in 0..150 {
            let x = (f64::from(i) + 0.5 * f64::from(k % 2)) / 150.0;
            if (x - 0.5).abs() > 0.06 {
                points.push([x, f64::from(k) / 150.0, if x < 0.5 { 0.05 } else { 0.0 }]);
            }
        }
    }
    let cloud = Cloud { points, ..Cloud::default() };
    let kerb = [[0.5, -3.0, 0.05], [0.5, 4.0, 0.05]];
    let foot = [[0.51, -3.0, 0.0], [0.51, 4.0, 0.0]];
    let mut known = Constraints::default();
    known.line(&kerb).unwrap();
    known.line(&foot).unwrap();
    let measure = |constraints| {
        let params = ReconstructParams {
            scene: Some(Scene::Terrain),
            resolution: Resolution::Length(0.01),
            quality: Quality::Normal,
            trim: Trim::Auto,
            constraints,
            ..ReconstructParams::default()
        };
        let (mesh, _) = plan(&cloud, &params, &()).expect("a plan").run(&()).expect("a surface");
        let tree = TriangleTree::new(&mesh);
        let off = |i: i32, x: f64, z: f64| {
            tree.closest([x, 0.05 + 0.009 * f64::from(i), z]).expect("triangles").distance_squared.sqrt() / 0.01
        };
        let [top, bottom] =
            [(0.5, 0.05), (0.51, 0.0)].map(|(x, z)| (0..100).map(|i| off(i, x, z)).sum::<f64>() / 100.0);
        let beyond = mesh.vertices.iter().map(|v| v[1].max(-v[1])).fold(0.0, f64::max);
        (top, bottom, beyond)
    };
    let (bare, held) = (measure(Constraints::default()), measure(known));
    println!("{bare:?} {held:?}");
    assert!(bare.0 > 0.5 && held.0 < 0.1 && held.1 < 0.1, "{bare:?} {held:?}");
    assert!(held.2 < 1.0, "the mesh leaves the box of the points: {}", held.2);
}

#[test]
fn constraints_far_away_are_refused() {
    let mut far = Constraints::default();
    far.line(&[[100.0, 0.0, 0.0], [101.0, 0.0, 0.0]]).unwrap();
    let params = ReconstructParams { constraints: far, ..ReconstructParams::default() };
    let refused = plan(&chipped(), &params, &()).expect_err("they are far away");
    assert!(matches!(refused, ReconstructError::ConstraintsAstray), "{refused}");
}
