//! Planes, edges and corners of whole scenes, held against their truth.

use std::path::{Path, PathBuf};

use zeroset::cloud::Cloud;
use zeroset::feature::{
    CompareFeaturesParams, CompareFeaturesReport, FeatureError, FeatureParams, FeatureReport, Features, Plane,
    compare_features, detect,
};
use zeroset::fit::cascade::Scene as FitScene;
use zeroset::mesh::Mesh;
use zeroset::sample::{Scene, SceneKind, sample_surface};

fn found(cloud: &Cloud, params: &FeatureParams) -> (Features, FeatureReport) {
    let (features, report) = detect(cloud, params, &()).expect("the points bear a surface");
    assert_sound(&features, &report);
    (features, report)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// What must hold of any features.
fn assert_sound(features: &Features, report: &FeatureReport) {
    let (planes, edges) = (features.planes.len(), features.edges.len());
    for plane in &features.planes {
        assert!((dot(plane.normal, plane.normal) - 1.0).abs() < 1e-9);
        assert!(plane.area > 0.0 && !plane.rings.is_empty(), "{plane:?}");
        for p in plane.rings.iter().flatten() {
            assert!((dot(plane.normal, *p) - plane.offset).abs() < 1e-6 * report.spacing, "{p:?} is off its plane");
        }
        assert_rings_do_not_cross(plane, 1e-6 * report.spacing);
    }
    assert!(features.planes.is_sorted_by(|a, b| a.area >= b.area));
    let labelled = features.points.iter().filter_map(|p| p.plane).max();
    assert!(labelled.is_none_or(|plane| (plane as usize) < planes));
    for edge in &features.edges {
        assert!(edge.length() > 0.0 && edge.planes.iter().all(|&plane| plane < planes), "{edge:?}");
        assert!(edge.planes.is_sorted_by(|a, b| a < b), "{edge:?}");
    }
    for corner in &features.corners {
        assert!(corner.edges.len() >= 2 && corner.edges.iter().all(|&edge| edge < edges), "{corner:?}");
        assert!(corner.edges.is_sorted_by(|a, b| a < b), "{corner:?}");
        for &plane in &corner.planes {
            let off = dot(features.planes[plane].normal, corner.position) - features.planes[plane].offset;
            assert!(off.abs() <= 2.0 * report.max_distance, "{corner:?} is {off} off plane {plane}");
        }
    }
}

/// Sides that touch, to the tolerance, do not cross.
fn assert_rings_do_not_cross(plane: &Plane, tolerance: f64) {
    // On which side of the line through p and q a position lies: -1, 0 or 1.
    let side = |p: [f64; 3], q: [f64; 3], r: [f64; 3]| {
        let [u, v]: [[f64; 3]; 2] = [q, r].map(|s| std::array::from_fn(|a| s[a] - p[a]));
        let cross = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
        let distance = dot(cross, plane.normal) / dot(u, u).sqrt();
        if distance.abs() <= tolerance { 0.0 } else { distance.signum() }
    };
    let sides = |ring: &Vec<[f64; 3]>| -> Vec<[[f64; 3]; 2]> {
        (0..ring.len()).map(|i| [ring[i], ring[(i + 1) % ring.len()]]).collect()
    };
    let all: Vec<[[f64; 3]; 2]> = plane.rings.iter().flat_map(sides).collect();
    for (i, &[a, b]) in all.iter().enumerate() {
        for &[c, d] in &all[i + 1..] {
            let crosses = side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            assert!(!crosses, "sides cross at {a:?} {b:?} and {c:?} {d:?}");
        }
    }
}

fn compared(features: &Features, truth: &Mesh, cloud: &Cloud, params: &CompareFeaturesParams) -> CompareFeaturesReport {
    compare_features(features, truth, Some(cloud), params, &()).expect("the truth is sound")
}

/// Tolerances in multiples of the noise: twice for edges, three times for corners.
fn by_noise(noise: f64) -> CompareFeaturesParams {
    CompareFeaturesParams {
        edge_tolerance: Some(2.0 * noise),
        corner_tolerance: Some(3.0 * noise),
        ..CompareFeaturesParams::default()
    }
}

#[test]
fn a_scanned_city_is_found_face_by_face() {
    let noise = 0.001;
    // The second city was not looked at while the constants were chosen.
    for (seed, angle, precision) in [(0, 0.4, 0.98), (11, 0.45, 0.97)] {
        let scene = Scene::new(SceneKind::City, seed);
        let cloud = scene.points(100_000, noise, seed);
        let (features, _) = found(&cloud, &FeatureParams::default());
        let report = compared(&features, &scene.truth, &cloud, &by_noise(noise));
        let planes = &report.planes;
        assert!(planes.all.by_area >= Some(0.995) && planes.all.by_count >= Some(0.97), "{planes:?}");
        assert!(planes.precision >= Some(precision), "{planes:?}");
        assert_eq!(planes.orientation, Some(1.0));
        let errors = [planes.angle_error_deg, planes.offset_error].map(|e| e.expect("planes match").mean);
        assert!(errors[0] <= angle && errors[1] <= 0.0001, "{errors:?}");
        assert!(report.edges.recall >= Some(0.95) && report.edges.precision >= Some(0.95), "{:?}", report.edges);
        assert!(report.edges.kind >= Some(0.99), "{:?}", report.edges);
        assert!(report.corners.recall >= Some(0.9) && report.corners.precision >= Some(0.95), "{:?}", report.corners);
    }
}

#[test]
fn walls_of_an_airborne_city_are_found_from_roofs_and_few_points() {
    let scene = Scene::new(SceneKind::AirborneCity, 0);
    let cloud = scene.points(100_000, 0.001, 0);
    let (features, report) = found(&cloud, &FeatureParams::default());
    assert_eq!(report.scene, FitScene::Airborne);
    // Every wall counts, with points or without.
    let params = CompareFeaturesParams { min_points: 0, ..by_noise(0.001) };
    let planes = compared(&features, &scene.truth, &cloud, &params).planes;
    assert!(planes.walls.by_area >= Some(0.95) && planes.walls.by_count >= Some(0.93), "{planes:?}");
    assert!(planes.roofs_and_ground.by_area >= Some(0.99), "{planes:?}");
    assert!(planes.precision >= Some(0.9), "{planes:?}");
    // Walls of too few points for a region of their own can only have been inferred.
    let bare = features.planes.iter().filter(|plane| plane.points < 15 && plane.normal[2] == 0.0).count();
    assert!(bare > 50, "only {bare} walls were inferred");
}

#[test]
fn round_bodies_have_no_planes() {
    for kind in [SceneKind::Sphere, SceneKind::Torus] {
        for (points, noise) in [(60_000, 0.001), (30_000, 0.002)] {
            let cloud = Scene::new(kind, 0).points(points, noise, 1);
            let (features, _) = found(&cloud, &FeatureParams::default());
            let on_planes = features.points.iter().filter(|p| p.plane.is_some()).count();
            assert_eq!((features.planes.len(), on_planes), (0, 0), "{kind}");
            assert_eq!(features.edges.len(), 0, "{kind}");
        }
    }
}

#[test]
fn solids_are_found_whole_where_the_noise_is_half_the_spacing() {
    for (kind, planes, edges, corners) in [(SceneKind::Box, 6, 12, 8), (SceneKind::LBlock, 8, 18, 12)] {
        let scene = Scene::new(kind, 0);
        let quiet = found(&scene.points(40_000, 0.0, 3), &FeatureParams::default()).1;
        let noise = 0.5 * quiet.spacing;
        let cloud = scene.points(40_000, noise, 3);
        let (features, _) = found(&cloud, &FeatureParams::default());
        assert_eq!((features.planes.len(), features.edges.len(), features.corners.len()), (planes, edges, corners));
        let report = compared(&features, &scene.truth, &cloud, &by_noise(noise));
        assert_eq!((report.edges.precision, report.corners.recall), (Some(1.0), Some(1.0)), "{kind}");
        // Faces have 900 points and more: their planes of least squares are wrong by 0.1 degrees and a thirtieth of the noise at most, or half
        // of that; what is mixed up near edges may double it.
        let planes = report.planes;
        let errors = [&planes.angle_error_deg, &planes.offset_error].map(|e| e.as_ref().expect("matches").max);
        assert!(errors[0] < 0.25 && errors[1] < noise / 8.0, "{kind}: {errors:?}");
    }
}

#[test]
fn solids_are_found_whole() {
    for (kind, planes, edges, corners) in [(SceneKind::Box, 6, 12, 8), (SceneKind::LBlock, 8, 18, 12)] {
        let scene = Scene::new(kind, 0);
        let cloud = scene.points(40_000, 0.001, 2);
        let (features, _) = found(&cloud, &FeatureParams::default());
        assert_eq!((features.planes.len(), features.edges.len(), features.corners.len()), (planes, edges, corners));
        let report = compared(&features, &scene.truth, &cloud, &by_noise(0.001));
        // A sample beside a corner can be nearer to an edge of another kind.
        assert!(report.edges.kind >= Some(0.999), "{kind}: {:?}", report.edges);
        assert_eq!(report.corners.kind, Some(1.0), "{kind}");
        assert_eq!((report.edges.precision, report.corners.recall), (Some(1.0), Some(1.0)), "{kind}");
        assert!(report.edges.recall >= Some(0.99), "{kind}");
        let area: f64 = features.planes.iter().map(|p| p.area).sum();
        let truth: f64 = report.planes.all.area;
        assert!((area / truth - 1.0).abs() < 0.005, "{kind}: {area} for {truth}");
    }
}

struct Hip {
    middle: [f64; 3],
    /// Outward.
    normal: [f64; 3],
}

/// The ground with houses on it that have hipped roofs, each turned by another angle, and their hips.
fn hipped_houses() -> (Mesh, Vec<Hip>) {
    // Half the length and width of a house, the height of its eaves and its ridge; at 45 degrees the ridge is shorter by one width.
    let (long, wide, eaves, ridge) = (0.05, 0.02, 0.03, 0.05);
    let ground = vec![[0.0, 0.0, 0.0], [0.6, 0.0, 0.0], [0.6, 0.4, 0.0], [0.0, 0.4, 0.0]];
    let mut mesh = Mesh { vertices: ground, triangles: vec![[0, 1, 2], [0, 2, 3]], ..Mesh::default() };
    let mut hips = Vec::new();
    for house in 0..6 {
        let (s, c) = (0.4 * f64::from(house)).sin_cos();
        let centre = [0.1 + 0.2 * f64::from(house % 3), 0.1 + 0.2 * f64::from(house / 3)];
        let turn = |[x, y, z]: [f64; 3]| [c * x - s * y, s * x + c * y, z];
        let place = |p: [f64; 3]| {
            let [x, y, z] = turn(p);
            [centre[0] + x, centre[1] + y, z]
        };
        let first = mesh.vertices.len() as u32;
        let corners = [[-long, -wide], [long, -wide], [long, wide], [-long, wide]];
        mesh.vertices.extend([0.0, eaves].iter().flat_map(|&z| corners.map(|[x, y]| place([x, y, z]))));
        mesh.vertices.extend([wide - long, long - wide].map(|x| place([x, 0.0, ridge])));
        let walls = (0..4).flat_map(|i| {
            let j = (i + 1) % 4;
            [[i, j, 4 + j], [i, 4 + j, 4 + i]]
        });
        let roof = [[4, 5, 9], [4, 9, 8], [5, 6, 9], [6, 7, 8], [6, 8, 9], [7, 4, 8]];
        mesh.triangles.extend(walls.chain(roof).map(|t| t.map(|v| first + v)));
        for side in [-1.0, 1.0] {
            let middle = place([side * (long - wide / 3.0), 0.0, eaves + (ridge - eaves) / 3.0]);
            let normal = turn([side * 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()]);
            hips.push(Hip { middle, normal });
        }
    }
    (mesh, hips)
}

#[test]
fn hips_of_thirty_points_are_found() {
    let (mesh, hips) = hipped_houses();
    let area = 0.02 * 0.02 * 2.0_f64.sqrt();
    let count = 17_000;
    let sampled = sample_surface(&mesh, count, 1).expect("a surface").points;
    let total: f64 = mesh.triangles.iter().map(|t| triangle_area(t.map(|v| mesh.vertices[v as usize]))).sum();
    let points_on_hip = count as f64 * area / total;
    assert!((28.0..33.0).contains(&points_on_hip), "{points_on_hip}");
    let moved = |(p, n): (&[f64; 3], [f64; 3])| std::array::from_fn(|a| p[a] + n[a]);
    let points = sampled.iter().zip(noise(sampled.len(), 0.001)).map(moved).collect();
    let (features, _) = found(&Cloud { points, ..Cloud::default() }, &FeatureParams::default());
    let is_found = |Hip { middle, normal }: &Hip| {
        features.planes.iter().any(|plane| {
            let near = |p: &[f64; 3]| (0..3).map(|a| (p[a] - middle[a]).powi(2)).sum::<f64>() < 0.03 * 0.03;
            // Least squares through 30 points tell the direction to 2.5 degrees.
            dot(plane.normal, *normal) > 10.0_f64.to_radians().cos()
                && (dot(plane.normal, *middle) - plane.offset).abs() < 0.001
                && plane.rings[0].iter().all(near)
        })
    };
    let found = hips.iter().filter(|hip| is_found(hip)).count();
    assert!(found >= 11, "{found} of {}", hips.len());
    // Ground, and for each house four walls and four roofs; one face may come in two.
    assert!(features.planes.len() <= 1 + 6 * 8 + 1, "{} planes", features.planes.len());
}

fn triangle_area([a, b, c]: [[f64; 3]; 3]) -> f64 {
    let [u, v]: [[f64; 3]; 2] = [b, c].map(|p| std::array::from_fn(|k| p[k] - a[k]));
    0.5 * (dot(u, u) * dot(v, v) - dot(u, v).powi(2)).sqrt()
}

/// Where a truth of the shared data lies, scaled to a diagonal of 1; `None` where the data are absent.
fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data").join(name);
    if path.exists() {
        return Some(path);
    }
    eprintln!("skipped: {} is absent", path.display());
    None
}

/// Vertices and triangles of an OBJ file of triangles.
fn obj(path: &Path) -> Mesh {
    let text = std::fs::read_to_string(path).expect("a readable file");
    let mut mesh = Mesh::default();
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let values: Vec<f64> = words.map(|w| w.parse().expect("a number")).collect();
                mesh.vertices.push([values[0], values[1], values[2]]);
            }
            Some("f") => {
                let index = |w: &str| w.split('/').next().and_then(|n| n.parse::<u32>().ok()).expect("an index") - 1;
                let corners: Vec<u32> = words.map(index).collect();
                mesh.triangles.push([corners[0], corners[1], corners[2]]);
            }
            _ => {}
        }
    }
    mesh
}

#[test]
fn creases_of_a_machined_part_follow_its_curves() {
    let Some(path) = shared("fandisk.obj") else { return };
    let mut truth = obj(&path);
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for v in &truth.vertices {
        for a in 0..3 {
            (low[a], high[a]) = (low[a].min(v[a]), high[a].max(v[a]));
        }
    }
    let diagonal = (0..3).map(|a| (high[a] - low[a]).powi(2)).sum::<f64>().sqrt();
    truth.vertices.iter_mut().flatten().for_each(|c| *c /= diagonal);
    let sampled = sample_surface(&truth, 60_000, 0).expect("a surface").points;
    // A quarter and half of the spacing.
    for deviation in [0.001, 0.002] {
        let noise = noise(sampled.len(), deviation);
        let moved = |(p, n): (&[f64; 3], [f64; 3])| std::array::from_fn(|a| p[a] + n[a]);
        let cloud = Cloud { points: sampled.iter().zip(noise).map(moved).collect(), ..Cloud::default() };
        let params = FeatureParams { scene: Some(FitScene::Object), ..FeatureParams::default() };
        let (features, _) = found(&cloud, &params);
        let params = CompareFeaturesParams { edge_tolerance: Some(0.01), ..CompareFeaturesParams::default() };
        let edges = compared(&features, &truth, &cloud, &params).edges;
        assert!(edges.recall >= Some(0.9) && edges.precision >= Some(0.9), "{deviation}: {edges:?}");
        assert!(edges.kind >= Some(0.95), "{deviation}: {edges:?}");
        let curved = features.edges.iter().filter(|edge| edge.polyline.len() > 4).count();
        assert!(curved >= 5, "{deviation}: {curved} curved edges");
    }
}

/// Noise with the given deviation: sums of twelve uniform numbers are nearly normal.
fn noise(n: usize, deviation: f64) -> Vec<[f64; 3]> {
    let mut state = 1_u64;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut normal = move || deviation * ((0..12).map(|_| uniform()).sum::<f64>() - 6.0);
    (0..n).map(|_| [normal(), normal(), normal()]).collect()
}

#[test]
fn the_result_depends_neither_on_the_order_of_the_points_nor_on_threads() {
    for kind in [SceneKind::AirborneCity, SceneKind::Stairs] {
        let cloud = Scene::new(kind, 3).points(20_000, 0.001, 3);
        let (features, _) = found(&cloud, &FeatureParams::default());
        assert!(features.planes.len() > 10 && features.edges.len() > 10);
        // A stride without a common divisor visits every point once.
        let order: Vec<usize> = (0..cloud.len()).map(|i| i * 7919 % cloud.len()).collect();
        let shuffled = Cloud { points: order.iter().map(|&i| cloud.points[i]).collect(), ..Cloud::default() };
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a pool");
        let (mut again, _) = pool.install(|| found(&shuffled, &FeatureParams::default()));
        let mut points = again.points.clone();
        for (place, &i) in order.iter().enumerate() {
            points[i] = again.points[place];
        }
        again.points = points;
        assert!(features == again, "{kind}");
    }
}

#[test]
fn motion_and_scale_change_the_result_within_tolerance_only() {
    let scene = Scene::new(SceneKind::LBlock, 0);
    let cloud = scene.points(30_000, 0.001, 4);
    let params = FeatureParams { scene: Some(FitScene::Object), ..FeatureParams::default() };
    let (features, _) = found(&cloud, &params);
    // Turned about an axis that is none of the body's, a thousand times larger, and moved.
    let (s, c) = 0.7_f64.sin_cos();
    let turn = |[x, y, z]: [f64; 3]| {
        let [x, y] = [c * x - s * y, s * x + c * y];
        [x, c * y - s * z, s * y + c * z]
    };
    let moved = |p: [f64; 3]| {
        let q = turn(p);
        [1000.0 * q[0] + 5e4, 1000.0 * q[1] - 2e5, 1000.0 * q[2] + 300.0]
    };
    let other = Cloud { points: cloud.points.iter().map(|&p| moved(p)).collect(), ..Cloud::default() };
    let (others, _) = found(&other, &params);
    assert_eq!(features.planes.len(), others.planes.len());
    assert_eq!((features.edges.len(), features.corners.len()), (others.edges.len(), others.corners.len()));
    for plane in &features.planes {
        let normal = turn(plane.normal);
        let cos = |q: &[f64; 3]| q.iter().zip(normal).map(|(a, b)| a * b).sum::<f64>();
        let on = moved(plane.rings[0][0]);
        let twin = others.planes.iter().find(|q| {
            let off = q.normal.iter().zip(on).map(|(a, b)| a * b).sum::<f64>() - q.offset;
            cos(&q.normal) > 0.9999 && off.abs() < 0.3
        });
        let twin = twin.unwrap_or_else(|| panic!("no twin of {:?}", plane.normal));
        assert!((twin.area / plane.area / 1e6 - 1.0).abs() < 0.01);
    }
}

#[test]
fn whatever_the_noise_what_is_found_is_sound() {
    for kind in [SceneKind::AirborneCity, SceneKind::City, SceneKind::LBlock, SceneKind::PocketPlate] {
        for noise in [0.0, 0.005, 0.01] {
            let cloud = Scene::new(kind, 1).points(15_000, noise, 1);
            let (features, _) = found(&cloud, &FeatureParams::default());
            assert!(noise > 0.0 || kind == SceneKind::PocketPlate || features.planes.len() > 5, "{kind}");
        }
    }
}

#[test]
fn points_that_bear_no_surface_are_refused_with_a_remedy() {
    let refused = |points: Vec<[f64; 3]>| {
        let cloud = Cloud { points, ..Cloud::default() };
        detect(&cloud, &FeatureParams::default(), &()).expect_err("no surface").to_string()
    };
    assert!(refused(vec![]).contains("give at least"));
    assert!(refused(vec![[1.0, 2.0, 3.0]]).contains("give at least"));
    assert!(refused(vec![[1.0, 2.0, 3.0]; 500]).contains("give at least"));
    assert!(refused(vec![[f64::NAN; 3]; 500]).contains("give at least"));
    assert!(refused((0..500).map(|i| [f64::from(i), 0.0, 0.0]).collect()).contains("on one line"));
    let cloud = Scene::new(SceneKind::Box, 0).points(1000, 0.001, 0);
    let params = FeatureParams { min_area: Some(-1.0), ..FeatureParams::default() };
    assert!(matches!(detect(&cloud, &params, &()), Err(FeatureError::Parameter { name: "minimum area", .. })));
}

#[test]
fn stray_points_that_are_not_finite_and_repeated_points_change_nothing() {
    let cloud = Scene::new(SceneKind::Box, 0).points(20_000, 0.001, 5);
    let (features, _) = found(&cloud, &FeatureParams::default());
    let mut points: Vec<[f64; 3]> = cloud.points.iter().flat_map(|&p| [p, p]).collect();
    points.insert(7, [f64::NAN, 0.0, 1.0]);
    let (others, _) = found(&Cloud { points, ..Cloud::default() }, &FeatureParams::default());
    assert_eq!((features.planes, features.edges, features.corners), (others.planes, others.edges, others.corners));
    assert_eq!(others.points[7].plane, None);
    assert_eq!(others.points[5], others.points[4]);
}
