//! A small city in tiles, against the same without.

use std::collections::BTreeMap;

use super::*;
use crate::cloud::Cloud;
use crate::mesh::{Mesh, topology};
use crate::reconstruct::{Quality, ReconstructError, ReconstructParams, Resolution, plan};
use crate::sample::{Scene, SceneKind};
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

const CELL: f64 = 0.008;

fn city() -> Cloud {
    Scene::new(SceneKind::AirborneCity, 1).points(30_000, 0.001, 1)
}

fn params() -> ReconstructParams {
    ReconstructParams { resolution: Resolution::Length(CELL), ..ReconstructParams::default() }
}

/// The mean distance, in cells, of the vertices of one mesh from another.
fn mean_distance(from: &Mesh, to: &Mesh) -> f64 {
    let tree = TriangleTree::new(to);
    let distances = from.vertices.iter().filter_map(|&v| Some(tree.closest_within(v, 1.0)?.distance_squared.sqrt()));
    distances.sum::<f64>() / from.vertices.len() as f64 / CELL
}

/// The middles of edges with one triangle.
fn rim(mesh: &Mesh) -> Vec<Vec3> {
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for t in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let middle = |[a, b]: [u32; 2]| vec3::lerp(mesh.vertices[a as usize], mesh.vertices[b as usize], 0.5);
    sides.into_iter().filter(|(_, count)| *count == 1).map(|(ends, _)| middle(ends)).collect()
}

#[test]
fn four_tiles_are_one_manifold_without_a_seam() {
    // Not along the sides of the city: tiles meet in its midst.
    let mut cloud = city();
    cloud.points.iter_mut().for_each(|p| (0..2).for_each(|a| p[a] -= 0.45));
    let params = params();
    let (whole, _) = plan(&cloud, &params, &()).unwrap().run(&()).unwrap();
    let (tiled, plan) = reconstruct(&cloud, 1.1, &params, &()).unwrap();
    assert_eq!(plan.tiles.len(), 4);
    let found = topology(&tiled).unwrap();
    assert_eq!((found.nonmanifold_edges, found.duplicate_triangles, found.inconsistent_edges), (0, 0, 0));
    assert_eq!(found.components.len(), topology(&whole).unwrap().components.len());
    // Open edges are where the whole has them, too: none along the faces.
    let open = rim(&whole);
    let astray: Vec<Vec3> = rim(&tiled)
        .into_iter()
        .filter(|p| (0..2).any(|a| p[a].abs() < 2.0 * CELL))
        .filter(|p| !open.iter().any(|q| vec3::distance(*p, *q) < 4.0 * CELL))
        .collect();
    assert!(astray.is_empty(), "{astray:?}");
    let apart = [mean_distance(&tiled, &whole), mean_distance(&whole, &tiled)];
    assert!(apart.iter().all(|d| *d < 0.05), "{apart:?}");
}

#[test]
fn what_cannot_be_cut_into_tiles_is_refused() {
    let cloud = city();
    let refused = |side: f64, params: &ReconstructParams| reconstruct(&cloud, side, params, &()).err().unwrap();
    let draft = ReconstructParams { quality: Quality::Draft, ..params() };
    assert!(matches!(refused(f64::NAN, &draft), ReconstructError::Length { name: "tile", .. }));
    assert!(matches!(refused(0.1, &draft), ReconstructError::NarrowTiles { .. }));
    let object = ReconstructParams { scene: Some(crate::fit::cascade::Scene::Object), ..draft.clone() };
    assert!(matches!(refused(1.1, &object), ReconstructError::TilesOfBody));
    let endless = ReconstructParams { trim: crate::reconstruct::Trim::Off, ..draft };
    assert!(matches!(refused(1.1, &endless), ReconstructError::TilesWithoutTrim));
}

#[test]
fn tiles_lie_on_whole_multiples_of_their_side() {
    let sorted = |p: [f64; 3]| TileId::of(p, [100.0, 200.0, 0.0], 50.0);
    assert_eq!(sorted([0.0, 0.0, 0.0]), TileId { x: 2, y: 4 });
    assert_eq!(sorted([-0.1, 49.9, 7.0]), TileId { x: 1, y: 4 });
    assert_eq!(sorted([-101.0, -201.0, 7.0]), TileId { x: -1, y: -1 });
    assert_eq!(TileId { x: 3, y: -1 }.to_string(), "3_-1");
    let mut tiles = [TileId { x: 0, y: 1 }, TileId { x: 5, y: 0 }];
    tiles.sort();
    assert_eq!(tiles[0].y, 0);
}

#[test]
fn levels_end_with_one_square_that_has_all() {
    let draft = ReconstructParams { quality: Quality::Draft, ..params() };
    let (cloud, tiles) = (city(), vec![TileId { x: 0, y: 0 }]);
    let bounds = crate::domain::bounds(cloud.points.iter().copied()).into();
    let measured = Measurement { points: cloud.len(), bounds, sample: &cloud, tiles };
    let mut plan = TilePlan::new(measured, 1.1, &draft).unwrap();
    assert!(plan.levels().is_empty());
    let mut named = |tiles: &[(i32, i32)]| -> Vec<Vec<String>> {
        plan.tiles = tiles.iter().map(|&(x, y)| TileId { x, y }).collect();
        let name = |node: Node| {
            let children: Vec<String> = node.children.iter().map(NodeId::to_string).collect();
            format!("{} of {}", node.id, children.join(" "))
        };
        plan.levels().into_iter().map(|nodes| nodes.into_iter().map(name).collect()).collect()
    };
    // Around the origin, where halves never meet.
    assert_eq!(named(&[(-1, -1), (0, -1), (-1, 0), (0, 0)]), [["1/-1_-1 of 0/-1_-1 0/0_-1 0/-1_0 0/0_0"]]);
    // A row, in which a square has a single part.
    let row = named(&[(3, 5), (4, 5), (5, 5), (6, 5), (7, 5)]);
    assert_eq!(row[0], ["1/1_2 of 0/3_5", "1/2_2 of 0/4_5 0/5_5", "1/3_2 of 0/6_5 0/7_5"]);
    assert_eq!(row[1], ["2/0_1 of 1/1_2", "2/1_1 of 1/2_2 1/3_2"]);
    assert_eq!(row[2..], [["3/0_0 of 2/0_1 2/1_1"]]);
    // Middles lie in the middle of the square, whatever it is made of.
    let root = plan.levels().remove(2).remove(0);
    let middle = plan.middle(&root, [[0.0; 3]; 2]);
    let offset = plan.world_from_local;
    assert!((middle[0] + offset[0] - 4.0 * 1.1).abs() < 1e-5, "{middle:?}");
}
