//! A small city in tiles, against the same without.

use super::*;
use crate::mesh::{Mesh, topology};
use crate::reconstruct::{ReconstructParams, Resolution, plan};
use crate::sample::{Scene, SceneKind};

/// The middles of boundary edges that are not beside the outline of a unit square.
fn holes(mesh: &Mesh, margin: f64) -> Vec<[f64; 3]> {
    let mut sides: std::collections::BTreeMap<[u32; 2], i32> = Default::default();
    for t in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let middle = |e: &[u32; 2]| crate::vec3::lerp(mesh.vertices[e[0] as usize], mesh.vertices[e[1] as usize], 0.5);
    let open = sides.iter().filter(|(_, n)| **n == 1).map(|(e, _)| middle(e));
    open.filter(|p| (0..2).all(|a| p[a] > margin && p[a] < 1.0 - margin)).collect()
}

#[test]
fn a_city_in_tiles() {
    let cloud = Scene::new(SceneKind::AirborneCity, 1).points(60_000, 0.001, 1);
    let params = ReconstructParams { resolution: Resolution::Length(0.004), ..ReconstructParams::default() };
    let (whole, _) = plan(&cloud, &params, &()).unwrap().run(&()).unwrap();
    let (tiled, plan) = reconstruct(&cloud, 0.55, &params, &()).unwrap();
    println!("tiles {:?}", plan.tiles);
    for mesh in [&whole, &tiled] {
        let t = topology(mesh).unwrap();
        println!("{} {} {} {} {:?}", t.faces, t.components.len(), t.boundary_edges, t.boundary_loops, t.bounds);
        println!("{:?}", holes(mesh, 0.01).iter().take(40).collect::<Vec<_>>());
    }
}
