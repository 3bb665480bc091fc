//! The names under which reports are written to files: other programs read them, so they do not change unnoticed.

use serde_json::Value;
use zeroset::cloud::Spacing;
use zeroset::mesh::{CompareParams, CompareReport, compare};
use zeroset::sample::{Scene, SceneKind};

fn names(value: &Value) -> Vec<&str> {
    let mut names: Vec<&str> = value.as_object().expect("an object").keys().map(String::as_str).collect();
    names.sort_unstable();
    names
}

#[test]
fn a_comparison_keeps_its_names_and_comes_back_equal() {
    let truth = Scene::new(SceneKind::Box, 0).truth;
    let params = CompareParams { samples: 1000, ..CompareParams::default() };
    let report = compare(&truth, &truth, &params, &()).expect("a box agrees with itself");
    let json = serde_json::to_value(&report).expect("plain numbers");
    assert_eq!(
        names(&json),
        [
            "crease_distance",
            "edge_band",
            "mesh",
            "mesh_self_intersections",
            "near_edges",
            "occupancy",
            "overall",
            "tau",
            "truth",
            "truth_diagonal",
            "truth_self_intersections"
        ]
    );
    assert_eq!(names(&json["mesh_self_intersections"]), ["listed", "pairs", "triangles"]);
    let figures = [
        "distances",
        "f_score",
        "mesh_samples",
        "normal_consistency",
        "orientation",
        "precision",
        "recall",
        "truth_samples",
    ];
    assert_eq!(names(&json["overall"]), figures);
    assert_eq!(names(&json["near_edges"]), figures);
    assert_eq!(names(&json["overall"]["distances"]), ["combined", "mesh_to_truth", "truth_to_mesh"]);
    assert_eq!(names(&json["crease_distance"]), ["max", "mean", "p95", "rms"]);
    assert_eq!(
        names(&json["mesh"]),
        [
            "area",
            "boundary_edges",
            "boundary_loops",
            "bounds",
            "closed",
            "components",
            "degenerate_triangles",
            "duplicate_triangles",
            "edges",
            "euler_characteristic",
            "faces",
            "genus",
            "inconsistent_edges",
            "large_components",
            "nonmanifold_edges",
            "nonmanifold_vertices",
            "unused_vertices",
            "vertices",
            "volume"
        ]
    );
    assert_eq!(
        names(&json["mesh"]["components"][0]),
        ["area", "boundary_edges", "euler_characteristic", "faces", "first_triangle", "genus"]
    );
    let back: CompareReport = serde_json::from_value(json).expect("what was written");
    assert_eq!(back, report);
}

#[test]
fn spacing_keeps_its_names() {
    let cloud = Scene::new(SceneKind::Box, 0).points(1000, 0.0, 0);
    let spacing = Spacing::of(&cloud).expect("many places");
    let json = serde_json::to_value(spacing).expect("plain numbers");
    assert_eq!(names(&json), ["examined", "mean", "median", "p10", "p90"]);
}
