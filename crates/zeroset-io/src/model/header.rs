//! What the header of a model says.
//!
//! Nothing in it is of a kind that has to be held as a whole before it is understood, which would take some 50 times the memory of its text.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};
use zeroset::field::Metric;
use zeroset::fit::cascade::Scene;

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct Header {
    #[serde(default)]
    pub(super) crs: Option<String>,
    #[serde(default)]
    pub(super) provenance: Provenance,
    /// The operands, each after those that it is made of; the last is the whole.
    pub(super) solid: Vec<Node>,
    #[serde(default)]
    pub(super) models: Vec<ModelHeader>,
    #[serde(default)]
    pub(super) meshes: Vec<MeshHeader>,
    #[serde(default)]
    pub(super) arrays: BTreeMap<String, Entry>,
}

/// An array.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Entry {
    pub(super) dtype: String,
    pub(super) shape: Vec<usize>,
    /// From the end of the header.
    pub(super) offset: usize,
    pub(super) crc32: u32,
}

#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Provenance {
    pub(super) zeroset: String,
    #[serde(default)]
    pub(super) inputs: Vec<String>,
    #[serde(default)]
    pub(super) parameters: BTreeMap<String, String>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct ModelHeader {
    pub(super) world_from_local: [f64; 3],
    pub(super) frame: [[f64; 3]; 3],
    pub(super) lattice: LatticeHeader,
    pub(super) metric: Metric,
    pub(super) scene: Scene,
    pub(super) bounds: [[f64; 3]; 2],
    pub(super) noise: f64,
    #[serde(default)]
    pub(super) trim: Option<f64>,
    #[serde(default)]
    pub(super) min_component: Option<usize>,
    /// Whether curved parts may have creases; absent without planes.
    #[serde(default)]
    pub(super) curved_creases: Option<bool>,
}

#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct LatticeHeader {
    pub(super) origin: [f64; 3],
    pub(super) spacing: f64,
    pub(super) finest: u32,
    pub(super) blocks: [u32; 3],
}

#[derive(Debug, Serialize, Deserialize)]
pub(super) struct MeshHeader {
    pub(super) world_from_local: [f64; 3],
}

/// An operand. Operands of operands are named by their places in the list.
#[derive(Debug, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Node {
    HalfSpace { point: [f64; 3], normal: [f64; 3] },
    Box { corners: [[f64; 3]; 2] },
    Ball { center: [f64; 3], radius: f64 },
    Frustum { ends: [[f64; 3]; 2], radii: [f64; 2] },
    Prism { rings: Vec<Vec<[f64; 2]>>, heights: [f64; 2] },
    HeightField { origin: [f64; 2], step: [f64; 2], count: [usize; 2], heights: usize },
    Mesh { mesh: usize },
    Fitted { model: usize },
    Union { of: Vec<usize> },
    Intersection { of: Vec<usize> },
    Difference { of: [usize; 2] },
    Complement { of: usize },
    SmoothUnion { of: [usize; 2], radius: f64 },
    Offset { of: usize, distance: f64 },
    Shell { of: usize, thickness: f64 },
    Placed { of: usize, rotation: [[f64; 3]; 3], scale: f64, shift: [f64; 3] },
}

impl Node {
    /// The operands of an operand.
    pub(super) fn operands(&self) -> Vec<usize> {
        match self {
            Self::Union { of } | Self::Intersection { of } => of.clone(),
            Self::Difference { of } | Self::SmoothUnion { of, .. } => of.to_vec(),
            Self::Complement { of } | Self::Offset { of, .. } | Self::Shell { of, .. } | Self::Placed { of, .. } => {
                vec![*of]
            }
            _ => Vec::new(),
        }
    }
}
