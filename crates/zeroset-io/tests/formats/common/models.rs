//! Small models, and files of models with sound checksums around any content.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

use serde_json::{Value, json};
use zeroset::cloud::Attributes;
use zeroset::domain::{Lattice, Mask, mask_set};
use zeroset::field::{LatticeField, Metric, Placement};
use zeroset::fit::cascade::Scene;
use zeroset::mesh::Mesh;
use zeroset::model::{Fitted, FittedParts, Model, Provenance, Solid, Structure};
use zeroset_io::write_model;

use super::{GEOREFERENCED, attributes, folder, mesh};

/// Bytes before the header.
pub const PREFIX: usize = 24;

/// Some blocks around a ball of five cells, with every optional array.
pub fn small_fitted() -> Fitted {
    let lattice = Lattice::new([-0.5, 1.0, 2.0], 0.25, 1, [1; 3]).unwrap();
    let (keys, mut known, mut inside, mut values) = (vec![0, 1, 3, 7], Vec::new(), Vec::new(), Vec::new());
    for block in [[0, 0, 0], [1, 0, 0], [1, 1, 0], [1, 1, 1_usize]] {
        let masks: &mut [Mask; 2] = &mut [[0; 8]; 2];
        for local in 0..512 {
            let node = [local & 7, local >> 3 & 7, local >> 6];
            let place: [f64; 3] = std::array::from_fn(|a| (8 * block[a] + node[a]) as f64 - 7.3);
            let distance = place.iter().map(|c| c * c).sum::<f64>().sqrt() - 5.0;
            if distance.abs() < 0.7 {
                mask_set(&mut masks[0], local);
                values.push(0.25 * distance as f32);
            } else if distance < 0.0 {
                mask_set(&mut masks[1], local);
            }
        }
        known.push(masks[0]);
        inside.push(masks[1]);
    }
    let field = LatticeField::from_packed(lattice, keys, known, &inside, &values).unwrap();
    let parts = FittedParts {
        world_from_local: [84_810.0, 447_412.0, 0.0],
        scene: Scene::Object,
        frame: [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]],
        metric: Metric::Near,
        bounds: [[2.5, 0.1, 1.5], [5.0, 2.5, 4.0]],
        noise: 0.01,
        trim: Some(0.75),
        min_component: Some(12),
        points: vec![[2.6, 0.5, 2.0], [3.0, 0.5, 2.0], [2.5, 1.5, 3.0], [5.0, 2.0, 4.0]],
        attributes: attributes(),
        structure: Some(Structure {
            planes: vec![([0.0, 0.0, 1.0], 4.0), ([0.6, 0.8, 0.0], -1.5)],
            triangles: vec![[[2.0, 1.0, 4.0], [3.0, 1.0, 4.0], [3.0, 2.0, 4.0]]],
            plane_of_triangle: vec![0],
            plane_of_point: vec![None, Some(1), Some(0), None],
            curved_creases: true,
        }),
        lines: vec![vec![[[2.6, 0.5, 2.0], [3.0, 0.5, 2.0]], [[3.0, 0.5, 2.0], [3.0, 1.5, 2.0]]], vec![]],
        polygons: vec![[[2.0, 1.0, 4.0], [3.0, 1.0, 4.0], [3.0, 2.0, 4.0]]],
    };
    Fitted::kept(field, parts).unwrap()
}

/// A solid of every kind, in one tree.
pub fn every_solid() -> Solid {
    let [low, high] = [[84_810.0, 447_410.0, 0.0], [84_812.0, 447_414.0, 3.5]];
    let body = Arc::new(Mesh { crs: None, attributes: Attributes::default(), ..mesh(GEOREFERENCED) });
    let fitted = Arc::new(small_fitted());
    let heights = Arc::new(vec![1.0, 2.0, 1.5, 0.5, 0.25, 0.125]);
    let ground = || Solid::HeightField {
        origin: [84_800.0, 447_400.0],
        step: [5.0, 10.0],
        count: [3, 2],
        heights: Arc::clone(&heights),
    };
    let placement = Placement::default().turned([1.0, 2.0, 3.0], 0.4, low).unwrap().scaled(1.25, high).unwrap();
    let of = Solid::Fitted(Arc::clone(&fitted));
    Solid::Union(vec![
        Solid::Cuboid { corners: [low, high] },
        Solid::Intersection(vec![ground(), Solid::HalfSpace { point: high, normal: [0.0, 0.1, 3.0] }, ground()]),
        Solid::Difference(Box::new([
            Solid::Frustum { ends: [low, high], radii: [1.0, 0.1 + 0.2] },
            Solid::Complement(Box::new(Solid::Mesh(Arc::clone(&body)))),
        ])),
        Solid::SmoothUnion { of: Box::new([Solid::Fitted(fitted), Solid::Mesh(body)]), radius: 0.5 },
        Solid::Shell {
            of: Box::new(Solid::Offset { of: Box::new(Solid::Ball { center: low, radius: 2.0 }), distance: -0.5 }),
            thickness: 1e-3,
        },
        Solid::Prism {
            rings: vec![
                vec![[84_810.0, 447_410.0], [84_814.0, 447_410.0], [84_812.0, 447_414.0]],
                vec![[84_811.5, 447_411.0], [84_812.5, 447_411.0], [84_812.0, 447_412.0]],
            ],
            heights: [0.0, 2.0],
        },
        Solid::Placed { of: Box::new(of), placement },
    ])
}

/// A model of a solid.
pub fn model(solid: Solid) -> Model {
    let provenance = Provenance {
        version: "0.1.0".into(),
        inputs: vec!["a \"b\".laz".into()],
        parameters: vec![("noise".into(), "0.01".into()), ("scene".into(), "object".into())],
    };
    Model { solid, crs: Some("EPSG:28992".into()), provenance }
}

/// The file of a model.
pub fn model_bytes(model: &Model) -> Vec<u8> {
    let folder = folder();
    let path = folder.path().join("a.zset");
    let size = write_model(&path, model).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(bytes.len() as u64, size);
    bytes
}

/// A file of the small fitted model alone.
pub fn sound_model() -> Vec<u8> {
    model_bytes(&model(Solid::Fitted(Arc::new(small_fitted()))))
}

/// The parts of a file of a model, to be changed and put together again.
#[derive(Debug, Clone)]
pub struct Parts {
    /// The header. Offsets and checksums of arrays are made anew, unless `is_kept`.
    pub header: Value,
    /// The content of each array.
    pub arrays: BTreeMap<String, Vec<u8>>,
    /// Whether the list of arrays stays as it is.
    pub is_kept: bool,
}

impl Parts {
    pub fn of(bytes: &[u8]) -> Self {
        let length = u64::from_le_bytes(bytes[16..PREFIX].try_into().unwrap()) as usize;
        let header: Value = serde_json::from_slice(&bytes[PREFIX..PREFIX + length]).unwrap();
        let content = |entry: &Value| {
            let shape = entry["shape"].as_array().unwrap().iter().map(|n| n.as_u64().unwrap() as usize);
            let item = entry["dtype"].as_str().unwrap()[2..].parse::<usize>().unwrap();
            let first = PREFIX + length + entry["offset"].as_u64().unwrap() as usize;
            bytes[first..first + item * shape.product::<usize>()].to_vec()
        };
        let arrays = header["arrays"].as_object().unwrap();
        let arrays = arrays.iter().map(|(name, entry)| (name.clone(), content(entry))).collect();
        Self { header, arrays, is_kept: false }
    }

    /// The file, with sound checksums.
    pub fn bytes(&self) -> Vec<u8> {
        let (mut header, mut data) = (self.header.clone(), Vec::new());
        for (name, content) in &self.arrays {
            if !self.is_kept {
                header["arrays"][name]["offset"] = json!(data.len());
                header["arrays"][name]["crc32"] = json!(crc32fast::hash(content));
            }
            data.extend(content);
            data.resize(data.len().next_multiple_of(64), 0);
        }
        wrapped(&serde_json::to_vec(&header).unwrap(), &data)
    }

    /// Puts numbers in place of some in an array.
    pub fn patch(&mut self, array: &str, at: usize, bytes: &[u8]) {
        self.arrays.get_mut(array).unwrap()[at..at + bytes.len()].copy_from_slice(bytes);
    }
}

/// A prefix, a header and data.
pub fn wrapped(header: &[u8], data: &[u8]) -> Vec<u8> {
    let mut text = header.to_vec();
    text.resize((PREFIX + text.len()).next_multiple_of(64) - PREFIX, b' ');
    let sum = crc32fast::hash(&text).to_le_bytes();
    let length = (text.len() as u64).to_le_bytes();
    [b"\x89ZSET\r\n\x1a", &1_u32.to_le_bytes()[..], &sum, &length, &text, data].concat()
}

/// Reads a model from bytes under the name that messages must have.
pub fn read_bad(bytes: &[u8]) -> Result<Model, zeroset_io::IoError> {
    zeroset_io::read_model_bytes(Path::new("bad.zset"), bytes)
}
