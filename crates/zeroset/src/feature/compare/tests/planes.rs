use super::*;

/// A plane turned around the area centre of its face.
fn tilted(plane: &Plane, centre: Vec3, degrees: f64) -> Plane {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let turned = |v: Vec3| [v[0], cos * v[1] - sin * v[2], sin * v[1] + cos * v[2]];
    let place = |p: Vec3| vec3::add(centre, turned(vec3::sub(p, centre)));
    let normal = turned(plane.normal);
    let rings = plane.rings.iter().map(|ring| ring.iter().map(|p| place(*p)).collect()).collect();
    Plane { normal, offset: vec3::dot(normal, centre), rings, ..plane.clone() }
}

#[test]
fn a_doubled_plane_is_false() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    found.planes.push(found.planes[2].clone());
    let planes = run(&found, &truth).planes;
    assert_eq!((planes.found, planes.matched, planes.all.by_count), (7, 6, Some(1.0)));
    assert_near(planes.precision, 6.0 / 7.0, 1e-12);
}

#[test]
fn a_missing_wall_is_missed_among_the_walls() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    found.planes.remove(facing(&found, [1.0, 0.0, 0.0]));
    let planes = run(&found, &truth).planes;
    assert_eq!((planes.precision, planes.walls.faces, planes.roofs_and_ground.faces), (Some(1.0), 4, 2));
    assert_near(planes.all.by_count, 5.0 / 6.0, 1e-12);
    // The box is 1 x 0.8 x 0.6.
    assert_near(planes.all.by_area, 1.0 - 0.48 / 3.76, 1e-12);
    assert_near(planes.walls.by_count, 0.75, 1e-12);
    assert_near(planes.walls.by_area, 1.0 - 0.48 / 2.16, 1e-12);
    assert_eq!(planes.roofs_and_ground.by_area, Some(1.0));
}

#[test]
fn of_a_face_in_two_halves_one_is_found_and_one_is_false() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    let top = facing(&found, [0.0, 0.0, 1.0]);
    for (from, to) in [(0.0, 0.45), (0.45, 1.0)] {
        let ring = vec![[from, 0.0, 0.6], [to, 0.0, 0.6], [to, 0.8, 0.6], [from, 0.8, 0.6]];
        found.planes.push(Plane { rings: vec![ring], ..found.planes[top].clone() });
    }
    found.planes.remove(top);
    let planes = run(&found, &truth).planes;
    assert_eq!((planes.found, planes.matched, planes.all.by_count), (7, 6, Some(1.0)));
}

#[test]
fn a_tilt_is_measured_up_to_the_largest_angle() {
    let truth = truth_of(SceneKind::Box);
    let top_of = |degrees| {
        let found = exact(&truth);
        let top = &found.planes[facing(&found, [0.0, 0.0, 1.0])];
        let planes = vec![tilted(top, [0.5, 0.4, 0.6], degrees)];
        run(&Features { planes, ..Features::default() }, &truth).planes
    };
    for degrees in [-4.9, 0.5, 4.9] {
        let planes = top_of(degrees);
        assert_eq!(planes.matched, 1, "{degrees}");
        let errors = planes.angle_error_deg.expect("a match");
        assert_near(Some(errors.median), degrees.abs(), 1e-9);
        assert_eq!((errors.mean, errors.p95, errors.max), (errors.median, errors.median, errors.median));
    }
    let planes = top_of(5.1);
    assert_eq!((planes.matched, planes.precision, planes.angle_error_deg), (0, Some(0.0), None));
}

#[test]
fn an_offset_is_measured_up_to_the_tolerance() {
    let truth = truth_of(SceneKind::Box);
    // 0.002 of the diagonal, the root of 2.
    let tolerance = 0.002 * 2_f64.sqrt();
    let lifted = |by: f64| {
        let mut found = exact(&truth);
        let top = facing(&found, [0.0, 0.0, 1.0]);
        found.planes[top].offset += by;
        found.planes[top].rings.iter_mut().flatten().for_each(|p| p[2] += by);
        run(&found, &truth).planes
    };
    for by in [0.9 * tolerance, -0.9 * tolerance] {
        let planes = lifted(by);
        assert_eq!(planes.matched, 6);
        let errors = planes.offset_error.expect("matches");
        assert_near(Some(errors.max), 0.9 * tolerance, 1e-12);
        assert_near(Some(errors.mean), 0.15 * tolerance, 1e-12);
        assert_near(Some(errors.median), 0.0, 1e-12);
    }
    assert_eq!(lifted(1.1 * tolerance).matched, 5);
}

#[test]
fn a_normal_to_the_wrong_side_shows_only_where_it_is_claimed() {
    let truth = truth_of(SceneKind::Box);
    let mut found = exact(&truth);
    for plane in &mut found.planes[..2] {
        plane.normal = vec3::scale(plane.normal, -1.0);
        plane.offset = -plane.offset;
    }
    found.planes[0].oriented = false;
    let planes = run(&found, &truth).planes;
    assert_eq!(planes.matched, 6);
    assert_near(planes.orientation, 0.8, 1e-12);
    found.planes.iter_mut().for_each(|plane| plane.oriented = false);
    assert_eq!(run(&found, &truth).planes.orientation, None);
}

#[test]
fn half_of_either_must_be_common() {
    let truth = truth_of(SceneKind::Box);
    let top_over = |[x0, x1, y0, y1]: [f64; 4]| {
        let found = exact(&truth);
        let top = &found.planes[facing(&found, [0.0, 0.0, 1.0])];
        let ring = vec![[x0, y0, 0.6], [x1, y0, 0.6], [x1, y1, 0.6], [x0, y1, 0.6]];
        let planes = vec![Plane { rings: vec![ring], ..top.clone() }];
        run(&Features { planes, ..Features::default() }, &truth).planes.matched
    };
    assert_eq!(top_over([0.4, 1.4, 0.0, 0.8]), 1, "slid by 0.4: six tenths are common");
    assert_eq!(top_over([0.6, 1.6, 0.0, 0.8]), 0, "slid by 0.6: four tenths are common");
    assert_eq!(top_over([0.1, 0.2, 0.1, 0.2]), 1, "a small piece lies in the face as a whole");
    assert_eq!(top_over([-5.0, 5.0, -5.0, 5.0]), 1, "the face lies in a large plane as a whole");
    assert_eq!(top_over([3.0, 4.0, 3.0, 4.0]), 0, "beside the face");
}

#[test]
fn a_hole_where_the_face_is_leaves_nothing_in_common() {
    let truth = truth_of(SceneKind::Box);
    let found = exact(&truth);
    let top = &found.planes[facing(&found, [0.0, 0.0, 1.0])];
    let square = |low: f64, high: f64| vec![[low, low, 0.6], [high, low, 0.6], [high, high, 0.6], [low, high, 0.6]];
    let mut hole = square(-0.5, 1.5);
    hole.reverse();
    let planes = vec![Plane { rings: vec![square(-2.0, 3.0), hole], ..top.clone() }];
    assert_eq!(run(&Features { planes, ..Features::default() }, &truth).planes.matched, 0);
}

#[test]
fn small_faces_need_not_count_and_are_not_false() {
    let truth = truth_of(SceneKind::Box);
    let params = CompareFeaturesParams { min_face_area: 0.5, ..CompareFeaturesParams::default() };
    let planes = compare_features(&exact(&truth), &truth, None, &params, &()).expect("a sound truth").planes;
    // Of 0.8, 0.6 and 0.48 square units, two each.
    assert_eq!((planes.all.faces, planes.matched, planes.precision), (4, 6, Some(1.0)));
}
