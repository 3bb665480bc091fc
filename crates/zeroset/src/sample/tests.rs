//! Scenes: what they promise about their truths and their points.

use super::*;
use crate::spatial::TriangleTree;

fn corners(mesh: &Mesh, t: usize) -> [Vec3; 3] {
    mesh.triangles[t].map(|v| mesh.vertices[v as usize])
}

fn area_vector([a, b, c]: [Vec3; 3]) -> Vec3 {
    vec3::scale(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)), 0.5)
}

#[test]
fn names_are_read_as_they_are_written() {
    for kind in SceneKind::ALL {
        assert_eq!(kind.to_string().parse(), Ok(kind));
    }
    let error = "village".parse::<SceneKind>().unwrap_err().to_string();
    assert!(error.contains("'village'") && error.contains("pocket-plate"), "{error}");
}

#[test]
fn exactly_the_wanted_number_of_points_comes_back() {
    for kind in SceneKind::ALL {
        let scene = Scene::new(kind, 3);
        for n in [0, 1, 7, 1000, CHUNK + 1] {
            assert_eq!(scene.points(n, 0.001, 5).len(), n, "{kind}");
        }
    }
}

#[test]
fn points_lie_on_the_truth_but_for_the_noise() {
    for kind in SceneKind::ALL {
        let scene = Scene::new(kind, 1);
        let tree = TriangleTree::new(&scene.truth);
        let off = |noise: f64| {
            let cloud = scene.points(5000, noise, 2);
            let sum: f64 = cloud.points.iter().map(|p| tree.closest(*p).expect("a truth").distance_squared).sum();
            (sum / 5000.0).sqrt()
        };
        // Tessellation of the curved shapes: 2e-5.
        assert!(off(0.0) < 3e-5, "{kind}: {}", off(0.0));
        // The deviation across the surface is the noise, but for edges and for rays that come in at an angle.
        let across = off(0.002) / 0.002;
        assert!((0.9..1.1).contains(&across), "{kind}: {across}");
    }
}

#[test]
fn points_do_not_depend_on_threads_but_on_the_seed() {
    for kind in [SceneKind::City, SceneKind::AirborneCity, SceneKind::Torus] {
        let scene = Scene::new(kind, 1);
        let draw = |threads, seed| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            pool.install(|| scene.points(100_000, 0.001, seed))
        };
        assert_eq!(draw(1, 4), draw(3, 4), "{kind}");
        assert_ne!(draw(2, 4), draw(2, 5), "{kind}");
    }
    assert_eq!(Scene::new(SceneKind::City, 9).truth, Scene::new(SceneKind::AirborneCity, 9).truth);
    assert_ne!(Scene::new(SceneKind::City, 9).truth, Scene::new(SceneKind::City, 10).truth);
}

#[test]
fn the_ground_is_the_square_without_the_footprints() {
    for seed in 0..20 {
        let truth = Scene::new(SceneKind::City, seed).truth;
        // What faces up adds up to the square: every roof covers exactly its footprint's hole in the ground.
        let up: f64 = (0..truth.triangles.len()).map(|t| area_vector(corners(&truth, t))[2]).sum();
        assert!((up - 1.0).abs() < 1e-12, "seed {seed}: {up}");
        let highest = truth.vertices.iter().map(|v| v[2]).fold(0.0, f64::max);
        assert!((0.1..0.21).contains(&highest), "seed {seed}: {highest}");
        for t in 0..truth.triangles.len() {
            let normal = vec3::normalized(area_vector(corners(&truth, t))).expect("no triangle without area");
            assert!(normal[2] > -1e-12, "seed {seed}: a triangle faces down");
        }
    }
}

#[test]
fn airborne_walls_are_nearly_bare() {
    let scene = Scene::new(SceneKind::AirborneCity, 0);
    let cloud = scene.points(200_000, 0.0, 1);
    let tree = TriangleTree::new(&scene.truth);
    let (mut area, mut count) = ([0.0; 3], [0.0; 3]);
    // 0 wall, 1 roof, 2 ground.
    let kinds: Vec<usize> = (0..scene.truth.triangles.len())
        .map(|t| {
            let triangle = corners(&scene.truth, t);
            let normal = area_vector(triangle);
            let wall = normal[2].abs() < 1e-9 * vec3::norm(normal);
            let kind = if wall { 0 } else { 1 + usize::from(triangle.iter().all(|c| c[2] == 0.0)) };
            area[kind] += vec3::norm(normal);
            kind
        })
        .collect();
    for point in &cloud.points {
        count[kinds[tree.closest(*point).expect("a truth").triangle]] += 1.0;
    }
    let [walls, roofs, ground] = [0, 1, 2].map(|k| count[k] / area[k]);
    println!("points an area, over that of roofs: walls {:.4}, ground {:.3}", walls / roofs, ground / roofs);
    assert!((0.02..0.04).contains(&(walls / roofs)), "{}", walls / roofs);
    // The ground is shadowed a little but has no slopes.
    assert!((0.8..1.3).contains(&(ground / roofs)), "{}", ground / roofs);
}

#[test]
fn samples_are_spread_by_area() {
    let truth = Scene::new(SceneKind::Stairs, 0).truth;
    let n = 10_000;
    let samples = sample_surface(&truth, n, 8).expect("stairs have area");
    let total: f64 = (0..truth.triangles.len()).map(|t| vec3::norm(area_vector(corners(&truth, t)))).sum();
    let mut counts = vec![0.0; truth.triangles.len()];
    for &t in &samples.triangles {
        counts[t as usize] += 1.0;
    }
    for (t, count) in counts.iter().enumerate() {
        let expected = n as f64 * vec3::norm(area_vector(corners(&truth, t))) / total;
        assert!((count - expected).abs() <= 2.0, "triangle {t}: {count} for {expected}");
    }
    assert!(samples.triangles.is_sorted());
}

#[test]
fn a_mesh_without_area_gives_no_samples() {
    assert_eq!(sample_surface(&Mesh::default(), 10, 0), None);
    let vertices = vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [f64::NAN; 3]];
    for triangle in [[0, 1, 2], [0, 0, 1], [0, 1, 3], [0, 1, 4]] {
        let mesh = Mesh { vertices: vertices.clone(), triangles: vec![triangle], ..Mesh::default() };
        assert_eq!(sample_surface(&mesh, 10, 0), None, "{triangle:?}");
    }
    // Triangles without area at either end are never chosen.
    let mesh = Mesh {
        vertices: vec![[0.0; 3], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
        triangles: vec![[0, 1, 2], [0, 1, 3], [0, 1, 2]],
        ..Mesh::default()
    };
    let samples = sample_surface(&mesh, 1000, 0).expect("one triangle has area");
    assert!(samples.triangles.iter().all(|&t| t == 1));
}
