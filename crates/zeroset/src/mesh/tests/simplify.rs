use super::{mapped, mesh, sheet, together};
use crate::cloud::Attributes;
use crate::mesh::{
    CompareParams, Mesh, SHARP_ANGLE, SimplifyError, SimplifyParams, SimplifyReport, compare, creases,
    self_intersections, simplify, simplify_held, topology,
};
use crate::sample::{Chance, Scene, SceneKind};
use crate::vec3::{self, Vec3};

fn to_triangles(n: usize) -> SimplifyParams {
    SimplifyParams { triangles: Some(n), ..SimplifyParams::default() }
}

fn within(length: f64) -> SimplifyParams {
    SimplifyParams { max_error: Some(length), ..SimplifyParams::default() }
}

/// Simplifies, and holds the result to what every simplification must keep.
fn simplified(mesh: &Mesh, params: &SimplifyParams) -> (Mesh, SimplifyReport) {
    assert_eq!(self_intersections(mesh, 3, &()).unwrap().pairs, 0);
    let (light, report) = simplify(mesh, params, &()).expect("a sound mesh");
    let shape = |mesh: &Mesh| {
        let found = topology(mesh).unwrap();
        let defects = found.nonmanifold_edges + found.nonmanifold_vertices + found.inconsistent_edges;
        (defects, found.components.len(), found.genus, found.boundary_loops)
    };
    assert_eq!(shape(&light), shape(mesh));
    assert_eq!(self_intersections(&light, 3, &()).unwrap().pairs, 0);
    assert!(params.max_error.is_none_or(|max| report.deviation.max() <= max), "{report:?}");
    assert_eq!((report.triangles_before, report.triangles_after), (mesh.triangles.len(), light.triangles.len()));
    (light, report)
}

/// Each triangle cut into four at the middles of its edges, so many times.
fn cut(mesh: &Mesh, times: usize) -> Mesh {
    (0..times).fold(mesh.clone(), |mesh, _| {
        let mut cut = Mesh { vertices: mesh.vertices.clone(), ..Mesh::default() };
        let mut middles = rustc_hash::FxHashMap::default();
        for &[a, b, c] in &mesh.triangles {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(p, q)| {
                *middles.entry((p.min(q), p.max(q))).or_insert_with(|| {
                    cut.vertices.push(vec3::lerp(mesh.vertices[p as usize], mesh.vertices[q as usize], 0.5));
                    cut.vertices.len() as u32 - 1
                })
            });
            cut.triangles.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        cut
    })
}

/// The vertices moved at random by up to a length in each direction.
fn shaken(mesh: &Mesh, by: f64) -> Mesh {
    let mut chance = Chance::new(2, 0, 0);
    let vertices = mesh.vertices.iter().map(|&v| v.map(|c| c + chance.between(-by, by))).collect();
    Mesh { vertices, ..mesh.clone() }
}

#[test]
fn exact_solids_come_down_to_their_faces_and_stay_exact() {
    for (kind, faces) in [(SceneKind::Box, 12), (SceneKind::LBlock, 20), (SceneKind::Stairs, 44)] {
        let truth = Scene::new(kind, 0).truth;
        let (light, _) = simplified(&cut(&truth, 4), &within(1e-3));
        assert_eq!(light.triangles.len(), faces, "{kind}");
        let params = CompareParams { samples: 20_000, ..CompareParams::default() };
        let report = compare(&light, &truth, &params, &()).unwrap();
        // The scenes are about one across, so this is a matter of rounding.
        assert!(report.overall.distances.combined.max < 1e-12 && report.crease_distance.unwrap().max < 1e-12, "{kind}");
    }
}

#[test]
fn a_turned_box_far_from_the_origin_keeps_its_planes_to_rounding() {
    let (sin, cos) = 0.3_f64.sin_cos();
    let turn =
        |[x, y, z]: Vec3| [cos * x - sin * y + 1000.0, sin * x + cos * z * 0.6 + cos * y * 0.8, 0.8 * z - 0.6 * y];
    let truth = mapped(&Scene::new(SceneKind::Box, 0).truth, turn);
    let (light, _) = simplified(&cut(&truth, 4), &within(1e-3));
    assert_eq!(light.triangles.len(), 12);
    let gap = |v: &Vec3| truth.vertices.iter().map(|t| vec3::distance(*v, *t)).fold(f64::INFINITY, f64::min);
    // 1e-12 of the coordinates.
    assert!(light.vertices.iter().map(gap).fold(0.0, f64::max) < 1e-9);
}

#[test]
fn a_sheet_comes_down_to_two_triangles_and_keeps_its_corners() {
    let (light, report) = simplified(&sheet(40), &within(1e-3));
    assert_eq!(light.triangles.len(), 2);
    assert!(report.deviation.max() < 1e-12);
}

#[test]
fn noise_is_flattened_and_creases_stay() {
    let fine = cut(&Scene::new(SceneKind::LBlock, 0).truth, 5);
    let (light, _) = simplified(&shaken(&fine, 2e-4), &within(1e-3));
    // Twenty would do without noise.
    assert!(light.triangles.len() < 40, "{}", light.triangles.len());
    let found = creases(&light, SHARP_ANGLE).unwrap();
    let length: f64 = found.iter().map(|[a, b]| vec3::distance(*a, *b)).sum();
    // Twice the outline of the L, and its six upright edges; corners move by no more than the error, and there are twelve.
    assert!((length - (2.0 * 3.6 + 6.0 * 0.5)).abs() < 0.03, "{length}");
}

#[test]
fn a_sphere_keeps_the_error_and_uses_it() {
    let sphere = Scene::new(SceneKind::Sphere, 0).truth;
    let (light, report) = simplified(&sphere, &within(2e-3));
    // A triangle of side s on radius R misses by about s^2 / 6 R inside. Errors both ways let s^2 / 6 R be twice the bound, and the
    // area 4 pi R^2 over 0.43 s^2 asks for 1200 triangles at least.
    assert!((800..2400).contains(&light.triangles.len()), "{}", light.triangles.len());
    assert!(report.deviation.max() > 1e-3);
    let (exactly, _) = simplified(&sphere, &to_triangles(500));
    assert_eq!(exactly.triangles.len(), 500);
    let both = SimplifyParams { triangles: Some(10_000), ..within(2e-3) };
    assert_eq!(simplified(&sphere, &both).0.triangles.len(), 10_000);
}

#[test]
fn thin_plates_do_not_cut_through_themselves() {
    // Floor and walls are 0.01 thick, and the error is allowed to be more than that.
    let plate = cut(&Scene::new(SceneKind::PocketPlate, 0).truth, 3);
    simplified(&shaken(&plate, 2e-5), &within(0.012));
    simplified(&shaken(&plate, 2e-5), &to_triangles(200));
}

#[test]
fn borders_and_closeness_to_others_are_kept() {
    let wave = mapped(&sheet(60), |[x, y, _]| [x, y, 0.05 * (20.0 * x).sin() * (17.0 * y).cos()]);
    // A second sheet follows the first at a hundredth.
    let both = together(&[wave.clone(), mapped(&wave, |p| vec3::add(p, [0.0, 0.0, 0.01]))]);
    simplified(&both, &within(0.02));
    simplified(&both, &to_triangles(100));
}

#[test]
fn what_is_no_manifold_stays_and_a_tetrahedron_is_the_least() {
    let vertices = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let tetrahedron = mesh(&vertices, &[[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]]);
    assert_eq!(simplified(&tetrahedron, &to_triangles(1)).0, tetrahedron);
    // Three sheets at one edge.
    let fins = mesh(
        &[[0.0; 3], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [-1.0, 1.0, 0.0], [-1.0, -1.0, 0.0]],
        &[[0, 1, 2], [0, 1, 3], [0, 1, 4]],
    );
    assert_eq!(simplify(&fins, &to_triangles(1), &()).unwrap().0, fins);
    // Twice the same triangle, and one without area.
    let odd = mesh(&vertices, &[[0, 1, 2], [0, 2, 1], [0, 1, 1], [0, 1, 3]]);
    assert!(simplify(&odd, &within(10.0), &()).is_ok());
}

#[test]
fn values_come_from_the_nearest_place() {
    let mut ramp = sheet(20);
    let x = |v: &Vec3| v[0];
    ramp.attributes = Attributes {
        colors: Some(ramp.vertices.iter().map(|v| [(200.0 * x(v)).round() as u8, 7, 0]).collect()),
        intensities: Some(ramp.vertices.iter().map(|v| 4.0 * x(v) as f32).collect()),
        classes: Some(ramp.vertices.iter().map(|v| if x(v) < 0.5 { 2 } else { 6 }).collect()),
    };
    ramp.world_from_local = [1e5, 2e5, 0.0];
    ramp.crs = Some("EPSG:28992".into());
    let (light, _) = simplified(&ramp, &to_triangles(60));
    assert_eq!((light.world_from_local, &light.crs), (ramp.world_from_local, &ramp.crs));
    let Attributes { colors: Some(colors), intensities: Some(intensities), classes: Some(classes) } = light.attributes
    else {
        panic!("values are lost")
    };
    for (i, v) in light.vertices.iter().enumerate() {
        assert!((f64::from(colors[i][0]) - 200.0 * x(v)).abs() <= 1.0 && colors[i][1] == 7);
        assert!((f64::from(intensities[i]) - 4.0 * x(v)).abs() < 1e-5);
        // Between the last vertex of one class and the first of the other either may be the weightier.
        let expected: &[u8] = if x(v) < 0.45 {
            &[2]
        } else if x(v) < 0.5 {
            &[2, 6]
        } else {
            &[6]
        };
        assert!(expected.contains(&classes[i]), "{v:?}");
    }
}

#[test]
fn held_vertices_stay_with_their_values_and_the_edges_between_them() {
    let mut plane = shaken(&sheet(24), 2e-3);
    plane.attributes.intensities = Some((0..25 * 25).map(|i| 0.1 * i as f32).collect());
    // One side, and one in the midst.
    let held: Vec<u32> = (0..25).chain([313]).collect();
    let params = within(0.05);
    let free = simplified(&plane, &params).0;
    let (light, numbers, report) = simplify_held(&plane, &held, &params, &()).unwrap();
    assert!(report.deviation.max() <= 0.05);
    assert!(light.triangles.len() > free.triangles.len() && light.triangles.len() < plane.triangles.len() / 4);
    let numbers: Vec<usize> = numbers.into_iter().map(|number| number.unwrap() as usize).collect();
    for (&old, &new) in held.iter().zip(&numbers) {
        assert_eq!(light.vertices[new].map(f64::to_bits), plane.vertices[old as usize].map(f64::to_bits));
        let value = |mesh: &Mesh, v: usize| mesh.attributes.intensities.as_ref().unwrap()[v].to_bits();
        assert_eq!(value(&light, new), value(&plane, old as usize));
    }
    for pair in numbers[..25].windows(2) {
        assert!(light.triangles.iter().any(|t| pair.iter().all(|&v| t.contains(&(v as u32)))), "{pair:?}");
    }
    // Without any, nothing else is done.
    assert!(simplify_held(&plane, &[], &params, &()).unwrap().0 == free);
}

#[test]
fn equal_on_any_number_of_threads_and_wherever_it_lies() {
    let torus = shaken(&cut(&Scene::new(SceneKind::LBlock, 0).truth, 5), 1e-3);
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| simplify(&torus, &within(2e-3), &()).unwrap())
    };
    let ((one, first), (four, second)) = (run(1), run(4));
    assert_eq!(one, four);
    assert_eq!(first.deviation, second.deviation);
}

#[test]
fn nonsense_is_refused_and_the_monitor_stops() {
    let sheet = sheet(50);
    let refused = |params: SimplifyParams| simplify(&sheet, &params, &()).unwrap_err();
    assert_eq!(refused(SimplifyParams::default()), SimplifyError::NoTarget);
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(refused(within(value)), SimplifyError::Parameter { name: "the largest error", .. }));
    }
    assert!(matches!(refused(to_triangles(0)), SimplifyError::Parameter { .. }));
    assert_eq!(simplify(&Mesh::default(), &within(1.0), &()).unwrap_err(), SimplifyError::NoSurface { faces: 0 });
    let broken = mesh(&[[0.0; 3]], &[[0, 1, 2]]);
    assert!(matches!(simplify(&broken, &within(1.0), &()), Err(SimplifyError::Broken(_))));
    let log = crate::monitor::tests::Log(std::sync::Mutex::default(), 1);
    assert!(matches!(simplify(&sheet, &within(1.0), &log), Err(SimplifyError::Cancelled(_))));
    let log = crate::monitor::tests::Log(std::sync::Mutex::default(), usize::MAX);
    simplify(&sheet, &within(0.1), &log).unwrap();
    assert!(log.0.into_inner().unwrap().is_sorted());
}
