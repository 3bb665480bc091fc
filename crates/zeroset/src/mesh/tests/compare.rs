use super::{mapped, mesh, moved, sheet, together, turned_over};
use crate::mesh::{CompareError, CompareParams, CompareReport, Mesh, MeshError, Role, compare};
use crate::monitor::{Cancelled, Monitor};
use crate::sample::{Scene, SceneKind};
use crate::vec3;

fn params() -> CompareParams {
    CompareParams { samples: 40_000, ..CompareParams::default() }
}

fn run(mesh: &Mesh, truth: &Mesh) -> CompareReport {
    compare(mesh, truth, &params(), &()).expect("two sound meshes")
}

fn scene(kind: SceneKind) -> Mesh {
    Scene::new(kind, 0).truth
}

fn assert_near(value: f64, expected: f64, tolerance: f64) {
    assert!((value - expected).abs() <= tolerance, "{value} is not {expected} to {tolerance}");
}

#[test]
fn a_mesh_agrees_with_itself() {
    for kind in SceneKind::ALL {
        let truth = scene(kind);
        let report = run(&truth, &truth);
        assert!(report.overall.distances.combined.max < 1e-15, "{kind}");
        assert_eq!((report.overall.f_score, report.overall.orientation), (1.0, 1.0), "{kind}");
        assert_near(report.overall.normal_consistency, 1.0, 1e-12);
        assert_eq!(report.occupancy, report.truth.closed.then_some(1.0), "{kind}");
        assert_eq!(report.near_edges.is_some(), !matches!(kind, SceneKind::Sphere | SceneKind::Torus), "{kind}");
        assert!(report.crease_distance.is_none_or(|d| d.max < 1e-15), "{kind}");
    }
}

#[test]
fn offset_spheres_are_their_offset_apart() {
    let truth = scene(SceneKind::Sphere);
    let grown = mapped(&truth, |v| vec3::scale(v, 1.02));
    let report = run(&grown, &truth);
    // Radii 0.51 and 0.5; the faces of the two are parallel and 1.5e-5 under their spheres.
    let d = report.overall.distances;
    for way in [d.mesh_to_truth, d.truth_to_mesh, d.combined] {
        for value in [way.mean, way.rms, way.p95, way.max] {
            assert_near(value, 0.01, 2e-5);
        }
    }
    assert_near(report.overall.normal_consistency, 1.0, 1e-4);
    assert_eq!((report.overall.orientation, report.overall.f_score), (1.0, 0.0));
    // The shell between them: 4 pi r^2 dr of the box with sides 1.1.
    let shell = 4.0 / 3.0 * std::f64::consts::PI * (0.51_f64.powi(3) - 0.125) / 1.1_f64.powi(3);
    assert_near(report.occupancy.expect("both closed"), 1.0 - shell, 0.005);
    assert_near(report.mesh.volume.expect("closed"), 1.02_f64.powi(3) * report.truth.volume.expect("closed"), 1e-12);
}

#[test]
fn tau_and_band_default_to_shares_of_the_diagonal_and_decide_the_score() {
    let truth = scene(SceneKind::Sphere);
    let grown = mapped(&truth, |v| vec3::scale(v, 1.02));
    let report = run(&grown, &truth);
    assert_near(report.truth_diagonal, 3.0_f64.sqrt(), 1e-3);
    assert_eq!((report.tau, report.edge_band), (0.002 * report.truth_diagonal, 0.01 * report.truth_diagonal));
    let wide = compare(&grown, &truth, &CompareParams { tau: Some(0.0101), ..params() }, &()).expect("sound");
    assert_eq!((wide.tau, wide.overall.f_score), (0.0101, 1.0));
}

#[test]
fn parallel_sheets_are_one_distance_apart() {
    let truth = sheet(10);
    let report = run(&moved(&truth, [0.0, 0.0, 0.25]), &truth);
    let d = report.overall.distances.combined;
    for value in [d.mean, d.rms, d.p95, d.max] {
        assert_near(value, 0.25, 1e-12);
    }
    assert_eq!((report.occupancy, report.near_edges, report.crease_distance), (None, None, None));
    assert_near(report.overall.normal_consistency, 1.0, 1e-12);
}

#[test]
fn half_a_sheet_has_full_precision_and_half_the_recall() {
    let truth = sheet(10);
    let half = mapped(&truth, |[x, y, z]| [0.5 * x, y, z]);
    let report = run(&half, &truth);
    assert_eq!(report.overall.precision, 1.0);
    // Half, and what lies within tau of the cut.
    assert_near(report.overall.recall, 0.5 + report.tau, 0.01);
    assert_near(report.overall.f_score, 2.0 * report.overall.recall / (1.0 + report.overall.recall), 1e-12);
    // From the missing half the distance is uniform in 0 to 1/2: mean 1/8 over all, RMS sqrt(1/24), 95 % at 0.45.
    let back = report.overall.distances.truth_to_mesh;
    assert_near(back.mean, 0.125, 0.002);
    assert_near(back.rms, (1.0_f64 / 24.0).sqrt(), 0.002);
    assert_near(back.p95, 0.45, 0.005);
    assert_near(back.max, 0.5, 0.005);
    assert_near(report.overall.distances.combined.mean, 0.0625, 0.001);
    // Of all samples together 5 % lie beyond 0.4.
    assert_near(report.overall.distances.combined.p95, 0.4, 0.005);
}

#[test]
fn a_shifted_box_is_found_at_its_creases_and_in_its_space() {
    let truth = scene(SceneKind::Box);
    let dx = 0.01;
    let report = run(&moved(&truth, [dx, 0.0, 0.0]), &truth);
    // The faces across x, 0.48 each, are off by dx; what a long face overhangs is off by its distance from the edge.
    let (across, total) = (2.0 * 0.48, 2.0 * (0.48 + 0.6 + 0.8));
    let overhang = 2.0 * (0.6 + 0.8) * dx * dx / 2.0;
    assert_near(report.overall.distances.combined.mean, (across * dx + overhang) / total, 5e-5);
    assert_near(report.overall.distances.combined.max, dx, 1e-12);
    // Edges along y and z at x = 0 and 1 are off by dx or lie in the shifted face at distance 0; those along x run into
    // it. At x = 0: 2 (0.8 + 0.6) of length at distance dx from the shifted box; at x = 1 its long faces cover them.
    let total_length = 4.0 * 2.4;
    let expected = (2.8 * dx + 4.0 * dx * dx / 2.0) / total_length;
    assert_near(report.crease_distance.expect("a box has creases").mean, expected, 1e-6);
    // Two slabs of dx of the box with sides a tenth longer are taken differently.
    let expected = 1.0 - 2.0 * dx / 1.1_f64.powi(3);
    assert_near(report.occupancy.expect("both closed"), expected, 0.003);
    let near = report.near_edges.expect("a box has creases");
    assert!(near.mesh_samples > 1000 && near.truth_samples > 1000 && near.mesh_samples < report.overall.mesh_samples);
    assert!(near.normal_consistency < report.overall.normal_consistency);
}

#[test]
fn what_is_turned_over_has_no_right_orientation_but_is_consistent() {
    let truth = scene(SceneKind::LBlock);
    let report = run(&turned_over(&truth), &truth);
    assert_eq!((report.overall.orientation, report.overall.f_score), (0.0, 1.0));
    assert_near(report.overall.normal_consistency, 1.0, 1e-12);
    assert_eq!(report.mesh.volume, report.truth.volume.map(|v| -v));
}

#[test]
fn a_tilted_sheet_shows_the_cosine() {
    let truth = sheet(10);
    let tilted = mapped(&truth, |[x, y, _]| {
        let (sin, cos) = 0.3_f64.sin_cos();
        [0.5 + (x - 0.5) * cos, y, (x - 0.5) * sin]
    });
    assert_near(run(&tilted, &truth).overall.normal_consistency, 0.3_f64.cos(), 1e-12);
}

#[test]
fn world_offsets_may_differ() {
    let truth = Mesh { world_from_local: [84_900.0, 447_500.0, 0.0], ..scene(SceneKind::Box) };
    let shift = [-100.0, 400.0, 7.0];
    let mut mesh = moved(&scene(SceneKind::Box), vec3::scale(shift, -1.0));
    mesh.world_from_local = vec3::add(truth.world_from_local, shift);
    let report = run(&mesh, &truth);
    assert!(report.overall.distances.combined.max < 1e-12);
    assert_eq!(report.occupancy, Some(1.0));
}

#[test]
fn an_extra_piece_costs_precision_only() {
    let truth = scene(SceneKind::Box);
    let report = run(&together(&[truth.clone(), moved(&truth, [5.0, 0.0, 0.0])]), &truth);
    assert_near(report.overall.precision, 0.5, 0.01);
    assert_eq!(report.overall.recall, 1.0);
    assert_eq!(report.mesh.components.len(), 2);
    assert!(report.overall.distances.truth_to_mesh.max < 1e-15);
}

#[test]
fn nothing_to_compare_is_an_error() {
    let truth = scene(SceneKind::Box);
    let flat = mesh(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]], &[[0, 1, 2]]);
    let error = |m: &Mesh, t: &Mesh, p: &CompareParams| compare(m, t, p, &()).expect_err("not comparable");
    assert_eq!(error(&Mesh::default(), &truth, &params()), CompareError::NoSurface { role: Role::Mesh, faces: 0 });
    assert_eq!(error(&truth, &flat, &params()), CompareError::NoSurface { role: Role::Truth, faces: 1 });
    let broken = mesh(&[[0.0; 3]], &[[0, 1, 2]]);
    let source = MeshError::VertexMissing { triangle: 0, vertex: 1, count: 1 };
    assert_eq!(error(&truth, &broken, &params()), CompareError::Broken { role: Role::Truth, source });
    for bad in [
        CompareParams { tau: Some(0.0), ..params() },
        CompareParams { edge_band: Some(f64::NAN), ..params() },
        CompareParams { samples: 0, ..params() },
    ] {
        assert!(matches!(error(&truth, &truth, &bad), CompareError::Parameter { .. }));
    }
}

#[test]
fn the_monitor_can_stop_it() {
    struct Impatient;
    impl Monitor for Impatient {
        fn cancelled(&self) -> bool {
            true
        }
    }
    let truth = scene(SceneKind::Box);
    let result = compare(&truth, &truth, &params(), &Impatient);
    assert_eq!(result, Err(CompareError::Cancelled(Cancelled)));
}

#[test]
fn reports_do_not_depend_on_threads_but_on_the_seed() {
    let truth = scene(SceneKind::Stairs);
    let mesh = mapped(&truth, |[x, y, z]| [x + 0.01 * y, y, z]);
    let on = |threads, seed| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| compare(&mesh, &truth, &CompareParams { seed, ..params() }, &()).expect("two sound meshes"))
    };
    assert_eq!(on(1, 3), on(3, 3));
    assert_ne!(on(2, 3), on(2, 4));
}
