use super::{mesh, sheet};
use crate::mesh::{SHARP_ANGLE, creases};
use crate::sample::{Scene, SceneKind};
use crate::vec3;

fn length(segments: &[[[f64; 3]; 2]]) -> f64 {
    segments.iter().map(|[a, b]| vec3::distance(*a, *b)).sum()
}

#[test]
fn a_box_has_twelve_creases_and_smooth_shapes_none() {
    let of = |kind| creases(&Scene::new(kind, 0).truth, SHARP_ANGLE).expect("a sound mesh");
    let edges = of(SceneKind::Box);
    assert_eq!(edges.len(), 12);
    assert!((length(&edges) - 4.0 * (1.0 + 0.8 + 0.6)).abs() < 1e-14);
    assert!(of(SceneKind::Sphere).is_empty() && of(SceneKind::Torus).is_empty());
    // Twice the outline of the L, and its six upright edges.
    assert!((length(&of(SceneKind::LBlock)) - (2.0 * 3.6 + 6.0 * 0.5)).abs() < 1e-14);
    assert_eq!(creases(&sheet(3), SHARP_ANGLE), Ok(vec![]));
}

#[test]
fn the_angle_is_that_between_the_normals_however_they_are_turned() {
    let fold = |degrees: f64, turned: bool| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let second = if turned { [0, 1, 3] } else { [1, 0, 3] };
        mesh(&[[0.0; 3], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [cos, 0.0, sin]], &[[0, 1, 2], second])
    };
    for turned in [false, true] {
        for degrees in [-170.0, -40.0, 40.0, 90.0, 170.0] {
            assert_eq!(creases(&fold(degrees, turned), SHARP_ANGLE).map(|c| c.len()), Ok(1), "{degrees} {turned}");
        }
        for degrees in [-20.0_f64, 0.0, 20.0, 29.9] {
            assert_eq!(creases(&fold(degrees, turned), SHARP_ANGLE).map(|c| c.len()), Ok(0), "{degrees} {turned}");
        }
    }
}

#[test]
fn edges_of_three_sheets_are_sharp_and_needles_are_passed_over() {
    let vertices = [[0.0; 3], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.5, 0.0]];
    let three = mesh(&vertices, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
    assert_eq!(creases(&three, SHARP_ANGLE), Ok(vec![[vertices[0], vertices[1]]]));
    let needle = mesh(&vertices, &[[0, 1, 2], [1, 0, 4]]);
    assert_eq!(creases(&needle, SHARP_ANGLE), Ok(vec![]));
}
