//! A surface in small tiles: its levels of detail, as others read them.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use serde_json::Value;
use zeroset::cloud::Cloud;
use zeroset::fit::cascade::Scene;
use zeroset::mesh::{CompareParams, Mesh, compare};
use zeroset::reconstruct::{Quality, ReconstructParams, Resolution};
use zeroset::tile::{Measurement, TileId, TileMesh, TilePlan};

use crate::folder::{create, write_json};
use crate::mesh::write_tile_mesh;
use crate::pieces::pieces;
use crate::{Crew, Folder, Sorted, TileFormat, TileSeconds, Values, Written, write_tiles};

/// Cells along a tile, each one wide.
const CELLS: i64 = 32;
/// Five tiles by three, but for the last.
const COLUMNS: std::ops::Range<i32> = -2..3;
const ROWS: std::ops::Range<i32> = -1..2;
const GONE: TileId = TileId { x: 2, y: 1 };

/// Hills and flat roofs; level at the border.
fn height(i: i64, j: i64) -> f64 {
    let (x, y) = (i as f64, j as f64);
    let roof = if (i.div_euclid(9) + j.div_euclid(7)) % 3 == 0 { 6.0 } else { 0.0 };
    // Whole thousandths of two: single precision holds them.
    ((3.0 * (x / 7.0).sin() * (y / 5.0).cos() + roof) * 1024.0).round() / 1024.0
}

fn tiles() -> Vec<TileId> {
    ROWS.flat_map(|y| COLUMNS.map(move |x| TileId { x, y })).filter(|tile| *tile != GONE).collect()
}

/// A tile as it comes out of the extraction.
fn extracted(tile: TileId) -> TileMesh {
    let corner = [tile.x, tile.y].map(|c| i64::from(c) * CELLS);
    let (mut mesh, mut shared) = (Mesh::default(), Vec::new());
    let all = tiles();
    let number = |i: i64, j: i64| (j * (CELLS + 1) + i) as u32;
    for j in 0..=CELLS {
        for i in 0..=CELLS {
            let (x, y) = (corner[0] + i, corner[1] + j);
            let others = all.iter().filter(|other| **other != tile).filter(|other| {
                let low = [other.x, other.y].map(|c| i64::from(c) * CELLS);
                (low[0]..=low[0] + CELLS).contains(&x) && (low[1]..=low[1] + CELLS).contains(&y)
            });
            if others.count() > 0 {
                shared.push((number(i, j), [x as u64, y as u64, u64::MAX]));
            }
            mesh.vertices.push([x as f64, y as f64, height(x, y)]);
            if i < CELLS && j < CELLS {
                let [a, b, c, d] = [number(i, j), number(i + 1, j), number(i + 1, j + 1), number(i, j + 1)];
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    TileMesh { mesh, shared }
}

fn plan() -> TilePlan {
    let points: Vec<[f64; 3]> =
        (0..4000).map(|k| [k % 80, k / 80].map(|c| c as f64 * 0.5)).map(|[x, y]| [x, y, 0.0]).collect();
    let sample = Cloud { points, ..Cloud::default() };
    let bounds = [[-64.0, -32.0, -4.0], [96.0, 64.0, 10.0]];
    let measured = Measurement { points: sample.points.len(), bounds, sample: &sample, tiles: tiles() };
    let params = ReconstructParams {
        scene: Some(Scene::Terrain),
        resolution: Resolution::Length(1.0),
        quality: Quality::Draft,
        ..ReconstructParams::default()
    };
    let mut plan = TilePlan::new(measured, 128.0, &params).unwrap();
    // Narrower than what can be fitted.
    plan.side = CELLS as f64;
    plan.report.min_component = None;
    plan
}

/// Does what follows the extraction.
fn made(path: &Path, jobs: usize) -> (TilePlan, Written) {
    let plan = plan();
    let folder = Folder::at(path);
    create(&folder.work().join("mesh")).unwrap();
    for tile in tiles() {
        let mesh = extracted(tile);
        write_tile_mesh(&folder.mesh(tile), &mesh).unwrap();
        write_json(&folder.pieces(tile), &pieces(&mesh)).unwrap();
    }
    let sorted = Sorted {
        tiles: Vec::new(),
        points: 0,
        bounds: plan.bounds,
        values: Values::default(),
        side: plan.side,
        crs: None,
    };
    let crew = Crew { jobs, threads: jobs, monitor: &() };
    let written = write_tiles(&folder, &sorted, &plan, TileFormat::Glb, &crew, &mut TileSeconds::default()).unwrap();
    (plan, written)
}

/// The mesh of a GLB in world coordinates, without the turn that puts y up. Sums of single precision and a middle are exact.
fn read(path: &Path) -> Mesh {
    let glb = std::fs::read(path).unwrap();
    let word = |at: usize| u32::from_le_bytes(glb[at..at + 4].try_into().unwrap());
    let length = word(12) as usize;
    let json: Value = serde_json::from_slice(&glb[20..20 + length]).unwrap();
    let view = |accessor: &Value| -> &[u8] {
        let number = json["accessors"][accessor.as_u64().unwrap() as usize]["bufferView"].as_u64().unwrap();
        let view = &json["bufferViews"][number as usize];
        let at = 28 + length + view["byteOffset"].as_u64().unwrap() as usize;
        &glb[at..at + view["byteLength"].as_u64().unwrap() as usize]
    };
    let middle: [f64; 3] = std::array::from_fn(|a| json["nodes"][1]["translation"][a].as_f64().unwrap());
    let position = |c: &[u8]| -> [f64; 3] {
        std::array::from_fn(|a| f64::from(f32::from_le_bytes(c[4 * a..4 * a + 4].try_into().unwrap())) + middle[a])
    };
    let corners =
        |c: &[u8]| -> [u32; 3] { std::array::from_fn(|a| u32::from_le_bytes(c[4 * a..4 * a + 4].try_into().unwrap())) };
    let primitive = &json["meshes"][0]["primitives"][0];
    Mesh {
        vertices: view(&primitive["attributes"]["POSITION"]).chunks_exact(12).map(position).collect(),
        triangles: view(&primitive["indices"]).chunks_exact(12).map(corners).collect(),
        ..Mesh::default()
    }
}

/// A place in the tree of a tileset.
struct Branch {
    mesh: Mesh,
    error: f64,
    volume: [f64; 12],
    children: Vec<Branch>,
}

fn branch(folder: &Path, value: &Value) -> Branch {
    let children = value["children"].as_array().map(Vec::as_slice).unwrap_or_default();
    Branch {
        mesh: read(&folder.join(value["content"]["uri"].as_str().unwrap())),
        error: value["geometricError"].as_f64().unwrap(),
        volume: std::array::from_fn(|i| value["boundingVolume"]["box"][i].as_f64().unwrap()),
        children: children.iter().map(|child| branch(folder, child)).collect(),
    }
}

impl Branch {
    fn leaves(&self) -> Vec<&Self> {
        if self.children.is_empty() { vec![self] } else { self.children.iter().flat_map(Self::leaves).collect() }
    }

    /// What is seen if some are replaced by their children, and those in turn.
    fn cut<'a>(&'a self, depth: u32, refined: &dyn Fn(u32, &Branch) -> bool, shown: &mut Vec<&'a Mesh>) {
        if !self.children.is_empty() && refined(depth, self) {
            self.children.iter().for_each(|child| child.cut(depth + 1, refined, shown));
        } else {
            shown.push(&self.mesh);
        }
    }

    fn contains(&self, p: &[f64; 3]) -> bool {
        (0..3).all(|a| (p[a] - self.volume[a]).abs() <= self.volume[3 + 4 * a])
    }

    fn check(&self) {
        for child in &self.children {
            assert!(child.error < self.error);
            assert!(child.leaves().iter().flat_map(|leaf| &leaf.mesh.vertices).all(|p| self.contains(p)));
            child.check();
        }
        assert!(self.mesh.vertices.iter().all(|p| self.contains(p)));
        if !self.children.is_empty() {
            let finest = joined(&self.leaves().iter().map(|leaf| &leaf.mesh).collect::<Vec<_>>());
            let params = CompareParams { samples: 20_000, ..CompareParams::default() };
            let found = compare(&self.mesh, &finest, &params, &()).unwrap().overall.distances;
            assert!(found.combined.max <= self.error, "{found:?}, {}", self.error);
            assert!(found.combined.max > 0.1 * self.error, "{found:?}, {}", self.error);
            assert!(self.mesh.triangles.len() < finest.triangles.len() / 2);
        }
    }
}

/// Meshes as one, joined where vertices are equal bit for bit.
fn joined(parts: &[&Mesh]) -> Mesh {
    let mut numbers: BTreeMap<[u64; 3], u32> = BTreeMap::new();
    let mut all = Mesh::default();
    for part in parts {
        let number: Vec<u32> = part
            .vertices
            .iter()
            .map(|p| {
                *numbers.entry(p.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
                    all.vertices.push(*p);
                    all.vertices.len() as u32 - 1
                })
            })
            .collect();
        all.triangles.extend(part.triangles.iter().map(|t| t.map(|v| number[v as usize])));
    }
    all
}

/// Middles of edges with one triangle that do not lie at the border of all.
fn cracks(mesh: &Mesh) -> Vec<[f64; 3]> {
    let mut sides: BTreeMap<[u32; 2], usize> = BTreeMap::new();
    for t in &mesh.triangles {
        for i in 0..3 {
            let (a, b) = (t[i], t[(i + 1) % 3]);
            *sides.entry([a.min(b), a.max(b)]).or_default() += 1;
        }
    }
    let middle = |ends: [u32; 2]| -> [f64; 3] {
        let [p, q] = ends.map(|v| mesh.vertices[v as usize]);
        std::array::from_fn(|a| 0.5 * (p[a] + q[a]))
    };
    let near = |c: f64, face: f64| (c - face).abs() < 4.0;
    let is_border = |p: &[f64; 3]| {
        let outside = near(p[0], -64.0) || near(p[0], 96.0) || near(p[1], -32.0) || near(p[1], 64.0);
        outside || (near(p[0], 64.0) && p[1] > 28.0) || (near(p[1], 32.0) && p[0] > 60.0)
    };
    let open = sides.into_iter().filter(|(_, count)| *count == 1).map(|(ends, _)| middle(ends));
    open.filter(|p| !is_border(p)).collect()
}

#[test]
fn levels_replace_one_another_without_a_crack_and_keep_their_error() {
    let place = tempfile::tempdir().unwrap();
    let (plan, written) = made(place.path(), 2);
    assert_eq!(plan.levels().iter().map(Vec::len).collect::<Vec<_>>(), [6, 4, 1]);
    assert_eq!((written.tiles.len(), written.levels.len()), (14, 11));
    let tileset: Value = serde_json::from_slice(&std::fs::read(place.path().join("tileset.json")).unwrap()).unwrap();
    assert_eq!(tileset["root"]["refine"], "REPLACE");
    let root = branch(place.path(), &tileset["root"]);
    assert_eq!(root.leaves().len(), 14);
    assert!(root.leaves().iter().all(|leaf| leaf.error == 0.0));
    assert!(tileset["geometricError"].as_f64().unwrap() >= 160.0);
    root.check();

    // All of one level, some refined beside some that are not, and every second all the way down.
    let west = |b: &Branch| b.volume[0] < 0.0;
    type Rule<'a> = &'a dyn Fn(u32, &Branch) -> bool;
    let rules: [Rule<'_>; 6] = [
        &|depth, _| depth < 1,
        &|depth, _| depth < 2,
        &|_, _| true,
        &|depth, b| depth < 1 || west(b),
        &|depth, b| depth < 1 || b.volume[0] + b.volume[1] > 20.0,
        &|depth, b| depth < 2 && (depth < 1 || !west(b)),
    ];
    let mut seen = BTreeSet::new();
    for (i, rule) in rules.into_iter().enumerate() {
        let mut shown = Vec::new();
        root.cut(0, rule, &mut shown);
        assert!(seen.insert(shown.iter().map(|mesh| mesh.triangles.len()).sum::<usize>()), "{i}");
        let cracks = cracks(&joined(&shown));
        assert!(cracks.is_empty(), "{i}: {} at {:?}", cracks.len(), cracks[0]);
    }
}

#[test]
fn squares_are_made_again_only_where_they_are_missing_and_with_the_same_bits() {
    let [one, other] = [tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap()];
    let (_, first) = made(one.path(), 1);
    let (_, second) = made(other.path(), 2);
    assert_eq!(first.levels, second.levels);
    let bytes = |entry: &crate::LevelEntry, place: &Path| std::fs::read(place.join(&entry.file)).unwrap();
    assert!(first.levels.iter().all(|entry| bytes(entry, one.path()) == bytes(entry, other.path())));
    // Killed before the last two were done.
    let folder = Folder::at(one.path());
    let before: Vec<Vec<u8>> = first.levels.iter().map(|entry| bytes(entry, one.path())).collect();
    for entry in &first.levels[9..] {
        std::fs::remove_file(folder.level_entry(entry.id)).unwrap();
        std::fs::write(one.path().join(&entry.file), b"begun").unwrap();
    }
    // What is there is taken as it is.
    std::fs::write(one.path().join(&first.levels[0].file), b"there").unwrap();
    assert_eq!(made(one.path(), 2).1.levels, first.levels);
    for (i, entry) in first.levels.iter().enumerate() {
        assert!(bytes(entry, one.path()) == if i == 0 { b"there".to_vec() } else { before[i].clone() }, "{i}");
    }
}
