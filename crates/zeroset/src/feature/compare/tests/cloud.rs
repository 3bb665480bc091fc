use super::*;
use crate::monitor::{Cancelled, Monitor};

/// Points of the box without those of the side at x = 1.
fn without_a_side() -> Cloud {
    let mut cloud = Scene::new(SceneKind::Box, 0).points(40_000, 0.0, 3);
    cloud.points.retain(|p| p[0] < 1.0);
    cloud
}

fn with(cloud: &Cloud, found: &Features, truth: &Mesh) -> CompareFeaturesReport {
    let params = CompareFeaturesParams::default();
    compare_features(found, truth, Some(cloud), &params, &()).expect("a sound truth")
}

#[test]
fn only_what_has_points_counts() {
    let truth = truth_of(SceneKind::Box);
    let full = Scene::new(SceneKind::Box, 0).points(40_000, 0.001, 3);
    let report = with(&full, &exact(&truth), &truth);
    assert_all_right(&report);
    assert_eq!((report.planes.all.faces, report.corners.counted), (6, 8));
    assert_near(Some(report.edges.counted_length), 9.6, 1e-9);
    assert_near(report.spacing, (3.76_f64 / 40_000.0).sqrt(), 1e-3);

    let cloud = without_a_side();
    let mut found = exact(&truth);
    // Right all the same, though nothing was to be found there.
    let report = with(&cloud, &found, &truth);
    assert_all_right(&report);
    assert_eq!((report.planes.all.faces, report.planes.matched, report.corners.counted), (5, 6, 4));
    assert_near(Some(report.edges.counted_length), 6.8, 0.01);
    // Not found, it is not missed.
    found.planes.remove(facing(&found, [1.0, 0.0, 0.0]));
    found.edges.retain(|edge| edge.polyline.iter().any(|p| p[0] < 1.0));
    found.corners.retain(|corner| corner.position[0] < 1.0);
    let report = with(&cloud, &found, &truth);
    assert_eq!((report.planes.all.by_count, report.corners.recall), (Some(1.0), Some(1.0)));
    assert_near(report.edges.recall, 1.0, 0.002);
}

#[test]
fn a_face_counts_from_its_fewest_points_on() {
    let truth = truth_of(SceneKind::Box);
    let mut cloud = without_a_side();
    for i in 0..50 {
        cloud.points.push([1.0, 0.2 + 0.01 * f64::from(i), 0.3]);
    }
    assert_eq!(with(&cloud, &exact(&truth), &truth).planes.all.faces, 6);
    cloud.points.pop();
    assert_eq!(with(&cloud, &exact(&truth), &truth).planes.all.faces, 5);
}

#[test]
fn the_cloud_may_have_an_offset_of_its_own() {
    let truth = truth_of(SceneKind::Box);
    let cloud = without_a_side();
    let mut far = cloud.clone();
    far.world_from_local = [1024.0, -2048.0, 512.0];
    far.points.iter_mut().for_each(|p| *p = vec3::sub(*p, far.world_from_local));
    let (near, far) = (with(&cloud, &exact(&truth), &truth), with(&far, &exact(&truth), &truth));
    assert_eq!(near.planes.all, far.planes.all);
    assert_near(Some(far.edges.counted_length), near.edges.counted_length, 0.01);
}

#[test]
fn the_report_does_not_depend_on_threads() {
    let scene = Scene::new(SceneKind::AirborneCity, 0);
    let cloud = scene.points(30_000, 0.001, 1);
    let found = exact(&scene.truth);
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
        pool.install(|| with(&cloud, &found, &scene.truth))
    };
    let report = on(1);
    assert_eq!(report, on(3));
    // Nearly bare walls count for little, and exact features are right everywhere.
    assert!(report.planes.walls.faces < 100 && report.planes.precision == Some(1.0));
    assert!(report.edges.counted_length < 0.8 * report.edges.true_length);
}

#[test]
fn the_monitor_can_stop_it() {
    struct Stop;
    impl Monitor for Stop {
        fn cancelled(&self) -> bool {
            true
        }
    }
    let truth = truth_of(SceneKind::Box);
    let params = CompareFeaturesParams::default();
    let stopped = compare_features(&exact(&truth), &truth, Some(&without_a_side()), &params, &Stop);
    assert_eq!(stopped, Err(CompareFeaturesError::Cancelled(Cancelled)));
}
