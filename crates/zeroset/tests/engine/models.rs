//! Models: a fit that is kept gives the mesh that a reconstruction gives, and takes part in other solids.

use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use zeroset::cloud::Cloud;
use zeroset::field::Placement;
use zeroset::mesh::{Mesh, creases, self_intersections, topology};
use zeroset::model::{Fitted, MeshParams, MeshReport, Solid, mesh};
use zeroset::reconstruct::{Quality, ReconstructParams, Resolution, plan};
use zeroset::sample::{Scene, SceneKind};
use zeroset::spatial::TriangleTree;

fn fitted(cloud: &Cloud, params: &ReconstructParams) -> Arc<Fitted> {
    Arc::new(plan(cloud, params, &()).unwrap().fit(&()).unwrap().0)
}

fn params(quality: Quality, cell: f64) -> ReconstructParams {
    ReconstructParams { quality, resolution: Resolution::Length(cell), ..ReconstructParams::default() }
}

/// A mesh that must be closed and embedded.
fn closed(solid: &Solid) -> (Mesh, MeshReport) {
    let (mesh, report) = mesh(solid, &MeshParams::default(), &()).unwrap();
    let t = topology(&mesh).unwrap();
    assert!(t.closed && t.nonmanifold_edges + t.nonmanifold_vertices == 0, "{t:?}");
    let cuts = self_intersections(&mesh, 3, &()).unwrap();
    assert_eq!(cuts.pairs, 0, "{:?}", cuts.listed);
    (mesh, report)
}

fn volume(mesh: &Mesh) -> f64 {
    topology(mesh).unwrap().volume.unwrap()
}

/// The mean and the largest distance from creases of a mesh to those of another; the share of their length, too.
fn crease_distances(mesh: &Mesh, truth: &Mesh) -> (f64, f64) {
    let angle = 30.0_f64.to_radians();
    let tree = TriangleTree::from_segments(&creases(mesh, angle).unwrap());
    let mut distances: Vec<f64> = Vec::new();
    for [a, b] in creases(truth, angle).unwrap() {
        for k in 0..20 {
            let t = (f64::from(k) + 0.5) / 20.0;
            let p = std::array::from_fn(|i| a[i] + t * (b[i] - a[i]));
            distances.push(tree.closest(p).unwrap().distance_squared.sqrt());
        }
    }
    (distances.iter().sum::<f64>() / distances.len() as f64, distances.iter().fold(0.0, |m: f64, d| m.max(*d)))
}

#[test]
fn a_fit_and_a_mesh_are_a_reconstruction() {
    for (kind, quality) in [
        (SceneKind::Torus, Quality::Draft),
        (SceneKind::Box, Quality::Normal),
        (SceneKind::City, Quality::Normal),
        (SceneKind::AirborneCity, Quality::Draft),
    ] {
        let cloud = Scene::new(kind, 2).points(20_000, 0.001, 2);
        let params = params(quality, 0.02);
        let (whole, done) = plan(&cloud, &params, &()).unwrap().run(&()).unwrap();
        let solid = Solid::Fitted(fitted(&cloud, &params));
        let (parts, report) = mesh(&solid, &MeshParams::default(), &()).unwrap();
        assert_eq!(whole, parts, "{kind:?}");
        assert_eq!((done.vertices, done.sharp), (report.vertices, report.sharp));
    }
}

#[test]
fn values_of_a_polished_fit_are_distances() {
    let scene = Scene::new(SceneKind::Sphere, 1);
    let cloud = scene.points(20_000, 0.001, 1);
    let model = Solid::Fitted(fitted(&cloud, &params(Quality::Normal, 0.02)));
    let field = model.field([0.0; 3]).unwrap();
    let tree = TriangleTree::new(&scene.truth);
    let (mut sum, mut count) = (0.0, 0);
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    for _ in 0..20_000 {
        let p: [f64; 3] = std::array::from_fn(|_| 1.2 * rng.random::<f64>() - 0.1);
        let distance = tree.closest(p).unwrap().distance_squared.sqrt();
        let is_inside = tree.winding_number(p).value > 0.5;
        if distance > 0.004 {
            assert_eq!(field.value(p) < 0.0, is_inside, "{p:?}");
        }
        if (0.004..0.04).contains(&distance) {
            sum += (field.value(p).abs() / distance - 1.0).abs();
            count += 1;
        }
    }
    assert!(count > 100 && sum / f64::from(count) < 0.1, "{} of {count}", sum / f64::from(count));
}

#[test]
fn a_cut_body_keeps_its_own_edges_and_gets_new_ones() {
    let scene = Scene::new(SceneKind::Box, 3);
    let cloud = scene.points(60_000, 0.0005, 3);
    let cell = 0.015;
    let base = Solid::Fitted(fitted(&cloud, &params(Quality::Normal, cell)));
    let (whole, _) = closed(&base);
    let (low, high) = bounds(&scene.truth);
    // The upper corner is taken off by a box that stands clear of the rest.
    let middle: [f64; 3] = std::array::from_fn(|a| 0.45 * low[a] + 0.55 * high[a]);
    let cut = Solid::Cuboid { corners: [middle, high.map(|c| c + 0.2)] };
    let (part, report) = closed(&Solid::Difference(Box::new([base.clone(), cut.clone()])));
    let taken: f64 = (0..3).map(|a| high[a] - middle[a]).product();
    assert!(
        (volume(&whole) - volume(&part) - taken).abs() < 0.005 * taken,
        "{} {taken}",
        volume(&whole) - volume(&part)
    );
    assert!(report.sharp.unwrap().at_corners >= 14, "{report:?}");
    // The truth by the same operation on exact solids.
    let exact = Solid::Difference(Box::new([Solid::Cuboid { corners: [low, high] }, cut]));
    let (exact, _) = mesh(&exact, &MeshParams { cell: Some(cell), ..MeshParams::default() }, &()).unwrap();
    for (a, b) in [(&part, &exact), (&exact, &part)] {
        let (mean, worst) = crease_distances(a, b);
        assert!(mean < 0.05 * cell && worst < cell, "{mean} {worst}");
    }
}

fn bounds(mesh: &Mesh) -> ([f64; 3], [f64; 3]) {
    mesh.vertices.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), v| {
        (std::array::from_fn(|a| low[a].min(v[a])), std::array::from_fn(|a| high[a].max(v[a])))
    })
}

/// Points of an upright cylinder with its two ends.
fn cylinder_points(radius: f64, height: f64, noise: f64) -> Cloud {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let mut normal = || noise * (0..12).map(|_| rng.random::<f64>()).sum::<f64>() - 6.0 * noise;
    let golden = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (ends, side) = (8_000, 24_000);
    let at_end = (0..ends).map(|i| {
        let (share, angle) = ((f64::from(i) + 0.5) / f64::from(ends), std::f64::consts::TAU * golden * f64::from(i));
        let (r, z) = (radius * share.sqrt(), if i % 2 == 0 { 0.0 } else { height });
        [r * angle.cos(), r * angle.sin(), z + normal()]
    });
    let mut positions: Vec<[f64; 3]> = at_end.collect();
    positions.extend((0..side).map(|i| {
        let (share, angle) = ((f64::from(i) + 0.5) / f64::from(side), std::f64::consts::TAU * golden * f64::from(i));
        let r = radius + normal();
        [r * angle.cos(), r * angle.sin(), height * share]
    }));
    Cloud::from_world(positions)
}

#[test]
fn a_curved_surface_keeps_its_shape_beside_a_cut() {
    let (radius, cell) = (0.3, 0.025);
    let cloud = cylinder_points(radius, 0.75, 0.0015);
    let base = Solid::Fitted(fitted(&cloud, &params(Quality::Normal, cell)));
    // The box stands out by two cells at the least.
    let top = Solid::Cuboid { corners: [[-0.345, -0.345, 0.6], [0.345, 0.345, 1.2]] };
    let (whole, _) = closed(&base);
    let (joined, _) = closed(&Solid::Union(vec![base, top]));
    let off = |mesh: &Mesh| {
        let beside = mesh.vertices.iter().filter(|v| (0.4..0.5999).contains(&v[2]));
        let off: Vec<f64> = beside.map(|v| (v[0].hypot(v[1]) - radius).abs()).filter(|off| *off < cell).collect();
        ((off.iter().map(|off| off * off).sum::<f64>() / off.len() as f64).sqrt(), off.into_iter().fold(0.0, f64::max))
    };
    let (before, after) = (off(&whole), off(&joined));
    assert!(after.0 < 1.5 * before.0 && after.1 < 0.06 * cell, "{before:?} {after:?}");
}

#[test]
fn a_fitted_body_can_be_taken_out_of_a_block_and_put_elsewhere() {
    let cloud = Scene::new(SceneKind::Torus, 4).points(30_000, 0.0005, 4);
    let base = Solid::Fitted(fitted(&cloud, &params(Quality::Normal, 0.015)));
    let (body, _) = closed(&base);
    let (low, high) = bounds(&body);
    let block = [low.map(|c| c - 0.1), high.map(|c| c + 0.1)];
    let mould = Solid::Difference(Box::new([Solid::Cuboid { corners: block }, base.clone()]));
    let (mould, _) = closed(&mould);
    let whole: f64 = (0..3).map(|a| block[1][a] - block[0][a]).product();
    assert!((whole - volume(&body) - volume(&mould)).abs() < 1e-4 * whole);

    let placement = Placement::default().turned([1.0, 1.0, 0.0], 0.7, [0.5; 3]).unwrap();
    let placement = placement.scaled(1.5, [0.0; 3]).unwrap().moved([100.0, 0.0, 3.0]).unwrap();
    let placed = Solid::Placed { of: Box::new(base), placement };
    let params = MeshParams { cell: Some(0.0225), ..MeshParams::default() };
    let (elsewhere, _) = mesh(&placed, &params, &()).unwrap();
    assert!((volume(&elsewhere) / volume(&body) - 1.5_f64.powi(3)).abs() < 0.01 * 3.375);
}

#[test]
fn ground_is_cut_filled_and_built_on() {
    let scene = Scene::new(SceneKind::City, 5);
    let cloud = scene.points(60_000, 0.0005, 5);
    let base = Solid::Fitted(fitted(&cloud, &params(Quality::Normal, 0.008)));
    let (before, _) = mesh(&base, &MeshParams::default(), &()).unwrap();
    let (low, high) = bounds(&before);
    let tower = Solid::Cuboid { corners: [[0.4, 0.4, low[2]], [0.6, 0.6, high[2] + 0.5]] };
    let (after, report) = mesh(&Solid::Union(vec![base, tower]), &MeshParams::default(), &()).unwrap();
    let t = topology(&after).unwrap();
    assert_eq!(t.nonmanifold_edges + t.nonmanifold_vertices, 0);
    let top = bounds(&after).1[2];
    assert!((top - high[2] - 0.5).abs() < 1e-6, "{top} {}", high[2]);
    assert!(report.sharp.unwrap().at_corners >= 4);
    // Far from the tower nothing has changed.
    let tree = TriangleTree::new(&before);
    let far = after.vertices.iter().filter(|v| (0..2).any(|a| !(0.37..0.63).contains(&v[a])));
    let worst = far.map(|&v| tree.closest(v).unwrap().distance_squared.sqrt()).fold(0.0, f64::max);
    assert!(worst < 0.008, "{worst}");
}
