//! What a model holds.

use std::path::Path;

use serde::Serialize;
use zeroset::field::Placement;
use zeroset::model::{Fitted, Model, Solid};
use zeroset_io::{IoError, read_model, shown};

use super::box_rows;
use crate::table::{count, decimals_for, name, pairs, position, significant};

/// What `zeroset info` tells of a model.
#[derive(Debug, Serialize)]
pub(super) struct ModelInfo {
    file: String,
    bytes: u64,
    crs: Option<String>,
    zeroset_version: String,
    inputs: Vec<String>,
    parameters: Vec<(String, String)>,
    /// The tree of operands: a line each, the deeper the farther in.
    solid: Vec<String>,
    fitted: Vec<FittedInfo>,
}

/// A fit in a model.
#[derive(Debug, Serialize)]
struct FittedInfo {
    scene: String,
    cell: f64,
    nodes: usize,
    points: usize,
    /// `None` in a draft.
    planes: Option<usize>,
    noise: f64,
    /// Lowest and highest corner of the points in world coordinates.
    bounds: [[f64; 3]; 2],
}

impl ModelInfo {
    pub(super) fn read(path: &Path) -> Result<Self, IoError> {
        let bytes = std::fs::metadata(path).map_err(|source| IoError::from_system(path, source))?.len();
        let Model { solid, crs, provenance } = read_model(path)?;
        let mut info = Self {
            file: shown(path),
            bytes,
            crs,
            zeroset_version: provenance.version,
            inputs: provenance.inputs,
            parameters: provenance.parameters,
            solid: Vec::new(),
            fitted: Vec::new(),
        };
        info.add(&solid, 0);
        Ok(info)
    }

    fn add(&mut self, solid: &Solid, depth: usize) {
        let at = |p: &[f64; 3]| p.map(|c| significant(c, 12)).join(",");
        let own = |value: &f64| significant(*value, 12);
        let (text, below): (String, Vec<&Solid>) = match solid {
            Solid::HalfSpace { point, normal } => (format!("halfspace({}; {})", at(point), at(normal)), vec![]),
            Solid::Cuboid { corners: [a, b] } => (format!("box({}; {})", at(a), at(b)), vec![]),
            Solid::Ball { center, radius } => (format!("sphere({}; {})", at(center), own(radius)), vec![]),
            Solid::Frustum { ends: [a, b], radii: [r, s] } if r == s => {
                (format!("cylinder({}; {}; {})", at(a), at(b), own(r)), vec![])
            }
            Solid::Frustum { ends: [a, b], radii: [r, s] } => {
                (format!("cone({}; {}; {}; {})", at(a), at(b), own(r), own(s)), vec![])
            }
            Solid::Prism { rings, heights: [low, high] } => {
                (format!("extrude({} rings; {}; {})", count(rings.len()), own(low), own(high)), vec![])
            }
            Solid::HeightField { count: [x, y], .. } => (format!("heights({x} by {y})"), vec![]),
            Solid::Mesh(mesh) => (format!("mesh({} triangles)", count(mesh.triangles.len())), vec![]),
            Solid::Fitted(fitted) => {
                self.fitted.push(FittedInfo::new(fitted));
                (format!("fit {}", self.fitted.len()), vec![])
            }
            Solid::Union(of) => ("union".to_owned(), of.iter().collect()),
            Solid::Intersection(of) => ("intersect".to_owned(), of.iter().collect()),
            Solid::Difference(of) => ("subtract".to_owned(), of.iter().collect()),
            Solid::Complement(of) => ("complement".to_owned(), vec![of]),
            Solid::SmoothUnion { of, radius } => (format!("smooth_union {}", own(radius)), of.iter().collect()),
            Solid::Offset { of, distance } => (format!("offset {}", own(distance)), vec![of]),
            Solid::Shell { of, thickness } => (format!("shell {}", own(thickness)), vec![of]),
            Solid::Placed { of, placement } => (placed(placement), vec![of]),
        };
        self.solid.push(format!("{}{text}", "  ".repeat(depth)));
        below.into_iter().for_each(|solid| self.add(solid, depth + 1));
    }

    pub(super) fn text(&self) -> String {
        let mut rows = vec![
            ("file", self.file.clone()),
            ("format", format!("ZSET, a model of {}", crate::table::bytes(self.bytes))),
            ("made by", format!("zeroset {}", self.zeroset_version)),
            ("inputs", self.inputs.join(", ")),
            ("crs", self.crs.clone().unwrap_or_else(|| "not stated".to_owned())),
        ];
        rows.extend(self.parameters.iter().map(|(name, value)| (name.as_str(), value.clone())));
        let mut text = pairs(&rows);
        text += &format!("\n{}\n", self.solid.join("\n"));
        for (i, fit) in self.fitted.iter().enumerate() {
            let mut rows = vec![
                ("fit", (i + 1).to_string()),
                ("scene", fit.scene.clone()),
                ("cell", significant(fit.cell, 4)),
                ("nodes", count(fit.nodes)),
                ("points", count(fit.points)),
                ("planes", fit.planes.map_or_else(|| "not looked for".to_owned(), count)),
                ("noise", significant(fit.noise, 4)),
            ];
            rows.extend(box_rows(Some(fit.bounds), decimals_for(fit.cell)));
            text += &format!("\n{}", pairs(&rows));
        }
        text
    }
}

fn placed(placement: &Placement) -> String {
    let shift = position(placement.shift(), 3);
    let scale = significant(placement.scale(), 6);
    if placement.rotation() == Placement::default().rotation() {
        return format!("placed: scale {scale}, at {shift}");
    }
    format!("placed: turned, scale {scale}, at {shift}")
}

impl FittedInfo {
    fn new(fitted: &Fitted) -> Self {
        let parts = fitted.parts();
        let nodes = fitted.lattice().known_nodes();
        Self {
            scene: name(parts.scene),
            cell: fitted.cell(),
            nodes,
            points: parts.points.len(),
            planes: parts.structure.as_ref().map(|structure| structure.planes.len()),
            noise: parts.noise,
            bounds: parts.bounds.map(|corner| std::array::from_fn(|a| corner[a] + parts.world_from_local[a])),
        }
    }
}
