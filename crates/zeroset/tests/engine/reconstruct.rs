//! From points to mesh, against scenes whose truth is known.

use zeroset::cloud::Cloud;
use zeroset::fit::cascade::Scene;
use zeroset::mesh::{CompareParams, CompareReport, Mesh, Topology, compare, topology};
use zeroset::reconstruct::{
    AttributeChoice, Quality, ReconstructParams, ReconstructReport, Resolution, Trim, Up, plan,
};
use zeroset::sample::{Scene as Sample, SceneKind};

fn run(
    cloud: &Cloud,
    scene: Scene,
    resolution: f64,
    change: impl FnOnce(&mut ReconstructParams),
) -> (Mesh, ReconstructReport) {
    let mut params = ReconstructParams {
        scene: Some(scene),
        resolution: Resolution::Length(resolution),
        ..ReconstructParams::default()
    };
    change(&mut params);
    plan(cloud, &params, &()).expect("a plan").run(&()).expect("a surface")
}

fn measure(mesh: &Mesh, truth: &Mesh) -> CompareReport {
    // 40,000 samples: the mean distance is known to a per cent.
    compare(mesh, truth, &CompareParams { samples: 40_000, ..CompareParams::default() }, &()).expect("two surfaces")
}

fn sound(mesh: &Mesh, what: &str) -> Topology {
    let t = topology(mesh).expect("a mesh");
    assert_eq!(
        (
            t.nonmanifold_edges,
            t.nonmanifold_vertices,
            t.inconsistent_edges,
            t.duplicate_triangles,
            t.degenerate_triangles
        ),
        (0, 0, 0, 0, 0),
        "{what}"
    );
    t
}

fn rotated(points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    // A rotation by 0.7 about (1, 2, 3), and a shift.
    let (axis, angle) = ([1.0, 2.0, 3.0].map(|c: f64| c / 14.0_f64.sqrt()), 0.7_f64);
    let (s, c) = angle.sin_cos();
    points
        .iter()
        .map(|p| {
            let along: f64 = (0..3).map(|a| axis[a] * p[a]).sum();
            let cross = |a: usize| axis[(a + 1) % 3] * p[(a + 2) % 3] - axis[(a + 2) % 3] * p[(a + 1) % 3];
            std::array::from_fn(|a| p[a] * c + cross(a) * s + axis[a] * along * (1.0 - c) + [0.31, -0.17, 0.23][a])
        })
        .collect()
}

#[test]
fn bodies_are_closed_whole_and_filled() {
    // Points misplaced between inside and outside are those within a fraction of a cell of the surface: with 0.014 a cell the
    // bounds allow a layer of about a tenth of a cell, and more where edges are rounded.
    let bodies = [
        (SceneKind::Sphere, Some(0), 0.998),
        (SceneKind::Torus, Some(1), 0.996),
        (SceneKind::Box, Some(0), 0.994),
        (SceneKind::LBlock, Some(0), 0.995),
        (SceneKind::Stairs, Some(0), 0.994),
        // Floor and walls are thinner than a cell here: nothing is asked but a sound mesh.
        (SceneKind::PocketPlate, None, 0.0),
    ];
    for (kind, genus, occupancy) in bodies {
        let scene = Sample::new(kind, 1);
        let (mesh, report) = run(&scene.points(20_000, 0.001, 1), Scene::Object, 0.014, |_| ());
        let thin = report.fit.levels.iter().any(|l| l.thin_walled);
        assert_eq!(thin, kind == SceneKind::PocketPlate, "{kind}: taken for thin-walled or not");
        let t = sound(&mesh, kind.name());
        assert!(t.closed, "{kind}");
        if let Some(genus) = genus {
            assert_eq!(t.large_components, 1, "{kind}");
            let main = t.components.iter().max_by_key(|c| c.faces).expect("one");
            assert_eq!(main.genus, Some(genus), "{kind}");
            let report = measure(&mesh, &scene.truth);
            let found = report.occupancy.expect("both are closed");
            println!("{kind}: occupancy {found:.4}, mean {:.5}", report.overall.distances.combined.mean);
            assert!(found > occupancy, "{kind}: {found}");
            assert!(report.overall.orientation > 0.995, "{kind}: {}", report.overall.orientation);
        }
    }
}

#[test]
fn a_city_is_right_side_up_and_near() {
    let scene = Sample::new(SceneKind::City, 1);
    let (mesh, _) = run(&scene.points(100_000, 0.001, 1), Scene::Terrain, 0.0047, |_| ());
    let t = sound(&mesh, "city");
    assert_eq!(t.large_components, 1);
    let found = measure(&mesh, &scene.truth).overall;
    println!("city: mean {:.6}, orientation {:.5}", found.distances.combined.mean, found.orientation);
    // Noise is 0.001: the surface is nearer to the truth than the points are, and a tenth of a cell.
    assert!(found.distances.combined.mean < 0.0005, "{}", found.distances.combined.mean);
    assert!(found.orientation > 0.999, "{}", found.orientation);
}

fn normal(mesh: &Mesh, triangle: [u32; 3]) -> ([f64; 3], [f64; 3], f64) {
    let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
    let (u, v): ([f64; 3], [f64; 3]) = (std::array::from_fn(|i| b[i] - a[i]), std::array::from_fn(|i| c[i] - a[i]));
    let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
    let twice = n.iter().map(|c| c * c).sum::<f64>().sqrt();
    (n.map(|c| c / twice), std::array::from_fn(|i| (a[i] + b[i] + c[i]) / 3.0), 0.5 * twice)
}

/// The signed angle in degrees of the mesh's walls to the vertical: the median by area over the triangles that are steep (|n_z| <
/// 0.5) and whose centroid lies within two cells of a vertical face of the truth and three cells away from its upper
/// and lower edges, where the surface is round. The second figure is the median of the absolute angle.
fn wall_lean(mesh: &Mesh, truth: &Mesh, cell: f64) -> (f64, f64) {
    let walls: Vec<[[f64; 3]; 3]> = truth
        .triangles
        .iter()
        .filter(|&&t| normal(truth, t).0[2].abs() < 1e-9)
        .map(|t| t.map(|v| truth.vertices[v as usize]))
        .collect();
    // In the plan a wall is a segment, and its triangles span its heights.
    let near = |p: [f64; 3]| {
        walls.iter().any(|w| {
            let (low, high) =
                (w.iter().map(|v| v[2]).fold(f64::MAX, f64::min), w.iter().map(|v| v[2]).fold(f64::MIN, f64::max));
            if p[2] < low + 3.0 * cell || p[2] > high - 3.0 * cell {
                return false;
            }
            (0..3).any(|i| {
                let (a, b) = (w[i], w[(i + 1) % 3]);
                let (d, e) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
                let square = d[0] * d[0] + d[1] * d[1];
                if square == 0.0 {
                    return false;
                }
                let s = ((d[0] * e[0] + d[1] * e[1]) / square).clamp(0.0, 1.0);
                (e[0] - s * d[0]).hypot(e[1] - s * d[1]) < 2.0 * cell
            })
        })
    };
    let mut leans: Vec<(f64, f64)> = mesh
        .triangles
        .iter()
        .map(|&t| normal(mesh, t))
        .filter(|(n, centre, _)| n[2].abs() < 0.5 && near(*centre))
        .map(|(n, _, area)| (n[2].asin().to_degrees(), area))
        .collect();
    let median = |leans: &mut Vec<(f64, f64)>| {
        leans.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half = 0.5 * leans.iter().map(|l| l.1).sum::<f64>();
        let mut sum = 0.0;
        leans
            .iter()
            .find(|l| {
                sum += l.1;
                sum >= half
            })
            .expect("there are walls")
            .0
    };
    let signed = median(&mut leans);
    leans.iter_mut().for_each(|l| l.0 = l.0.abs());
    (signed, median(&mut leans))
}

#[test]
fn walls_that_were_hardly_scanned_are_upright() {
    for (seed, points, cell) in [(1, 100_000, 0.0047), (3, 50_000, 0.0066)] {
        let scene = Sample::new(SceneKind::AirborneCity, seed);
        let (mesh, report) = run(&scene.points(points, 0.001, seed), Scene::Airborne, cell, |_| ());
        let topology = sound(&mesh, "airborne city");
        let (signed, absolute) = wall_lean(&mesh, &scene.truth, cell);
        println!(
            "airborne city {seed} at {cell}: walls lean by {signed:.2} degrees, {absolute:.2} without sign; screening {}",
            report.plan.screening
        );
        assert_eq!(topology.large_components, 1, "no roof floats, seed {seed}");
        assert!(signed.abs() < 1.0, "walls as a whole: {signed} degrees");
        assert!(absolute < 3.0, "wall by wall, with their ripples: {absolute} degrees");
    }
}

#[test]
fn trims_axes_and_attributes_are_obeyed() {
    let mut cloud = Sample::new(SceneKind::City, 1).points(10_000, 0.001, 1);
    cloud.crs = Some("EPSG:28992".to_owned());
    cloud.attributes.intensities = Some(cloud.points.iter().map(|p| p[0] as f32).collect());
    cloud.attributes.classes = Some(cloud.points.iter().map(|p| if p[2] > 0.02 { 6 } else { 2 }).collect());
    let cell = 0.015;
    let (upright, report) = run(&cloud, Scene::Terrain, cell, |p| p.attributes = AttributeChoice::Intensity);
    assert!(report.plan.trim.is_some());
    assert_eq!(upright.crs, cloud.crs);
    let values = upright.attributes.intensities.as_ref().expect("asked for");
    assert!(upright.attributes.classes.is_none(), "not asked for");
    let within = |mesh: &Mesh, margin: f64| {
        mesh.vertices.iter().flat_map(|v| [v[0], v[1]]).all(|c| (-margin..=1.0 + margin).contains(&c))
    };
    for (v, x) in upright.vertices.iter().zip(values) {
        // The nearest point is within some spacings (0.01), or a little more at the outline.
        assert!((v[0] - f64::from(*x)).abs() < 0.06, "{v:?} {x}");
    }
    assert!(within(&upright, 2.0 * cell), "nothing beyond the outline");
    let (open, report) = run(&cloud, Scene::Terrain, cell, |p| p.trim = Trim::Off);
    assert!(report.plan.trim.is_none() && report.contour.trimmed_polygons == 0);
    assert!(!within(&open, 4.0 * cell), "the ground goes on to the faces of the box");
    let near = 0.05;
    let (_, report) = run(&cloud, Scene::Terrain, cell, |p| p.trim = Trim::Length(near));
    assert_eq!(report.plan.trim, Some(near));

    let (upright, _) = run(&cloud, Scene::Terrain, cell, |p| p.quality = Quality::Draft);
    for up in [Up::Y, Up::MinusX] {
        let mut turned = cloud.clone();
        turned.points.iter_mut().for_each(|p| *p = up.restore(*p));
        let (mesh, _) = run(&turned, Scene::Terrain, cell, |p| {
            p.up = up;
            p.quality = Quality::Draft;
            p.attributes = AttributeChoice::Class;
        });
        // The upright frame of the fit sees the same points: not a bit may differ in a draft. Planes are found in the frame of the cloud.
        let back: Vec<[f64; 3]> = mesh.vertices.iter().map(|v| up.upright(*v)).collect();
        assert!(back == upright.vertices && mesh.triangles == upright.triangles, "{up:?}");
        assert!(mesh.attributes.classes.expect("asked for").iter().all(|c| [2, 6].contains(c)));
    }
}

#[test]
fn motion_scale_and_order_change_little() {
    for (kind, motion) in [(SceneKind::Torus, 0.05), (SceneKind::LBlock, 0.05)] {
        moved_scaled_and_shuffled(kind, motion);
    }
}

/// Tolerances are mean distances in cells.
fn moved_scaled_and_shuffled(kind: SceneKind, motion: f64) {
    let cell = 0.02;
    let cloud = Sample::new(kind, 1).points(10_000, 0.001, 1);
    let (mesh, _) = run(&cloud, Scene::Object, cell, |_| ());
    let apart = |other: &Mesh| measure(other, &mesh).overall.distances.combined.mean / cell;

    // The lattice falls elsewhere: the surface moves by the error of the interpolation and what noise each cell averages.
    let mut moved = mesh.clone();
    moved.vertices = rotated(&mesh.vertices);
    let turned = Cloud { points: rotated(&cloud.points), ..Cloud::default() };
    let (other, _) = run(&turned, Scene::Object, cell, |_| ());
    let d = measure(&other, &moved).overall.distances.combined.mean / cell;
    println!("{kind}, rigid motion: {d:.5} cells");
    assert!(d < motion, "{kind}, rigid motion: {d} cells");

    // By 1000 and its resolution with it: the same lattice but for the rounding of fixed-point coordinates.
    let large = Cloud { points: cloud.points.iter().map(|p| p.map(|c| 1000.0 * c)).collect(), ..Cloud::default() };
    let (mut other, _) = run(&large, Scene::Object, 1000.0 * cell, |_| ());
    other.vertices.iter_mut().for_each(|v| *v = v.map(|c| c / 1000.0));
    let d = apart(&other);
    println!("{kind}, scale: {d:.6} cells");
    assert!(d < 0.001, "{kind}, scale: {d} cells");

    // Sums over the points of a cell change in their last bits, and with them where iterations end.
    let mut backwards = cloud.clone();
    backwards.points.reverse();
    let (other, _) = run(&backwards, Scene::Object, cell, |_| ());
    let d = apart(&other);
    println!("{kind}, order: {d:.6} cells");
    assert!(d < 0.001, "{kind}, order: {d} cells");

    // World coordinates of a national grid resolve 2^-31: five-millionths of a cell here.
    let far = [2_600_000.123, 1_200_000.456, 0.0];
    let world = cloud.points.iter().map(|p| std::array::from_fn(|a| p[a] + far[a])).collect();
    let (mut other, _) = run(&Cloud::from_world(world), Scene::Object, cell, |_| ());
    let offset = other.world_from_local;
    assert!(offset != [0.0; 3]);
    other.vertices.iter_mut().for_each(|v| *v = std::array::from_fn(|a| v[a] + (offset[a] - far[a])));
    other.world_from_local = [0.0; 3];
    let d = apart(&other);
    println!("{kind}, georeference: {d:.6} cells");
    assert!(d < 0.01, "{kind}, georeference: {d} cells");
}

#[test]
fn the_mesh_is_equal_bit_for_bit_on_any_number_of_threads() {
    for (kind, scene, cell) in
        [(SceneKind::LBlock, Scene::Object, 0.011), (SceneKind::AirborneCity, Scene::Airborne, 0.011)]
    {
        let cloud = Sample::new(kind, 1).points(10_000, 0.001, 1);
        let mut first: Option<Mesh> = None;
        for threads in [1, 2, 2, 3] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let (mesh, report) = pool.install(|| run(&cloud, scene, cell, |_| ()));
            assert!(report.fit.levels.len() >= 3, "levels are refined");
            let first = first.get_or_insert_with(|| mesh.clone());
            assert!(*first == mesh, "{kind} on {threads} threads, or in another run");
        }
    }
}
