use super::*;
use crate::feature::FeatureKind;

#[test]
fn a_missing_edge_takes_its_length_from_the_recall() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    let long = found.edges.iter().position(|edge| (edge.length() - 1.0).abs() < 1e-9).expect("an edge of length 1");
    found.edges.remove(long);
    let edges = run(&found, &truth).edges;
    assert_eq!((edges.found, edges.precision), (11, Some(1.0)));
    // The neighbours reach around the two ends by the tolerance, 0.005 of the root of 2.
    let reach = 2.0 * 0.005 * 2_f64.sqrt();
    assert_near(edges.recall, (8.6 + reach) / 9.6, 1e-3);
}

#[test]
fn an_edge_through_the_middle_is_false_by_its_length() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    let polyline = vec![[0.5, 0.0, 0.3], [0.5, 0.4, 0.3], [0.5, 0.8, 0.3]];
    found.edges.push(Edge { polyline, ..found.edges[0].clone() });
    let edges = run(&found, &truth).edges;
    assert_eq!((edges.found, edges.recall, edges.kind), (13, Some(1.0), Some(1.0)));
    assert_near(edges.precision, 9.6 / 10.4, 1e-3);
}

#[test]
fn the_tolerances_decide() {
    let truth = truth_of(SceneKind::Box);
    // Away from the box: no other edge comes closer.
    let lifted = |by: f64| {
        let mut found = exact(&truth);
        found.edges.iter_mut().flat_map(|edge| &mut edge.polyline).for_each(|p| {
            *p = std::array::from_fn(|a| if p[a] > 0.0 { p[a] + by } else { p[a] - by });
        });
        found.corners.iter_mut().for_each(|corner| corner.position[2] += by);
        let params =
            CompareFeaturesParams { edge_tolerance: Some(0.02), corner_tolerance: Some(0.03), ..Default::default() };
        let report = compare_features(&found, &truth, None, &params, &()).expect("a sound truth");
        (report.edges, report.corners)
    };
    let (edges, corners) = lifted(0.0141);
    assert_eq!((edges.recall, corners.recall), (Some(1.0), Some(1.0)));
    // The ends stick out beyond the box.
    assert!(edges.precision.expect("a share") > 0.95);
    assert_near(corners.mean_distance, 0.0141, 1e-12);
    let (edges, _) = lifted(0.0143);
    assert!(edges.recall.expect("a share") < 0.01 && edges.precision.expect("a share") < 0.01);
    assert_near(lifted(0.029).1.recall, 1.0, 0.0);
    let (_, corners) = lifted(0.031);
    assert_eq!((corners.recall, corners.precision, corners.mean_distance), (Some(0.0), Some(0.0), None));
}

#[test]
fn kinds_are_compared_where_they_are_known() {
    let truth = truth_of(SceneKind::LBlock);
    let mut found = exact(&truth);
    let concave = found.edges.iter().filter(|edge| edge.kind == FeatureKind::Concave).collect::<Vec<_>>();
    assert_eq!(concave.len(), 1);
    assert_near(Some(concave[0].length()), 0.5, 1e-12);
    found.edges.iter_mut().for_each(|edge| edge.kind = FeatureKind::Convex);
    found.corners.iter_mut().for_each(|corner| corner.kind = FeatureKind::Convex);
    found.corners[0].kind = FeatureKind::Unknown;
    let report = run(&found, &truth);
    assert_near(report.edges.kind, 1.0 - 0.5 / report.edges.true_length, 2e-3);
    assert_near(report.corners.kind, 9.0 / 11.0, 1e-12);
    found.edges.iter_mut().for_each(|edge| edge.kind = FeatureKind::Unknown);
    assert_eq!(run(&found, &truth).edges.kind, None);
}

#[test]
fn missing_and_made_up_corners_show() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    found.corners.pop();
    found.corners.push(Corner { position: [0.5, 0.4, 0.6], ..found.corners[0].clone() });
    found.corners.push(Corner { position: [0.0, 0.4, 0.6], ..found.corners[0].clone() });
    let corners = run(&found, &truth).corners;
    assert_eq!((corners.found, corners.truth, corners.counted), (9, 8, 8));
    assert_near(corners.recall, 7.0 / 8.0, 1e-12);
    assert_near(corners.precision, 7.0 / 9.0, 1e-12);
}

#[test]
fn an_edge_just_under_the_sharp_angle_is_neither_missed_nor_false() {
    // A tent that turns by 27 degrees at its ridge.
    let rise = 13.5_f64.to_radians().tan();
    let truth = Mesh {
        vertices: vec![
            [-1.0, 0.0, 0.0],
            [0.0, 0.0, rise],
            [1.0, 0.0, 0.0],
            [-1.0, 2.0, 0.0],
            [0.0, 2.0, rise],
            [1.0, 2.0, 0.0],
        ],
        triangles: vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]],
        ..Mesh::default()
    };
    let ridge = Edge {
        kind: FeatureKind::Convex,
        planes: vec![],
        polyline: vec![[0.0, 0.0, rise], [0.0, 2.0, rise]],
        angle: 0.47,
    };
    let found = Features { edges: vec![ridge], ..Features::default() };
    let edges = run(&found, &truth).edges;
    assert_eq!((edges.true_length, edges.recall, edges.precision), (0.0, None, Some(1.0)));
    assert_eq!(edges.kind, Some(1.0));
}
