//! What a closed mesh surrounds.

use rustc_hash::FxHashMap;

use crate::field::{Field, FieldError, Metric, direction};
use crate::mesh::{Mesh, topology};
use crate::spatial::{ClosestPoint, TriangleTree};
use crate::vec3::{self, Vec3};

/// Triangles that turn by less than this belong to one smooth sheet; its cosine: 20 degrees.
const SMOOTH: f64 = 0.94;
/// A sheet whose triangles turn by less than this is flat; the sine.
const FLAT: f64 = 1e-6;

/// What a closed mesh surrounds, whichever way its triangles face. The distance is that to the triangles, the sign that of the winding number.
#[derive(Debug)]
pub struct MeshSolid {
    normals: Vec<Vec3>,
    corners: Vec<Vec3>,
    extent: [Vec3; 2],
    tree: TriangleTree,
    /// The sheet of each triangle.
    sheet_of: Vec<u32>,
    sheets: Vec<Sheet>,
    /// -1 if triangles face inward.
    facing: f64,
}

/// A smooth part of the surface.
#[derive(Debug)]
struct Sheet {
    triangles: Vec<u32>,
    tree: TriangleTree,
    is_flat: bool,
}

impl MeshSolid {
    /// The solid of a mesh, in its local coordinates. Sheets end where it turns by more than 20 degrees.
    ///
    /// # Errors
    /// If the mesh is broken or not closed.
    pub fn new(mesh: &Mesh) -> Result<Self, FieldError> {
        let topology = topology(mesh)?;
        if !topology.closed {
            return Err(FieldError::Open { boundary_edges: topology.boundary_edges });
        }
        let place = |v: u32| mesh.vertices[v as usize];
        let normal = |&[a, b, c]: &[u32; 3]| vec3::cross(vec3::sub(place(b), place(a)), vec3::sub(place(c), place(a)));
        let areas: Vec<Vec3> = mesh.triangles.iter().map(normal).collect();
        let facing = if topology.volume.is_some_and(|v| v < 0.0) { -1.0 } else { 1.0 };
        let normals: Vec<Vec3> = areas.iter().map(|&n| vec3::scale(direction(n), facing)).collect();
        let sheet_of = smooth_parts(mesh, &normals);
        let mut parts: Vec<Vec<u32>> = Vec::new();
        for (t, &sheet) in sheet_of.iter().enumerate() {
            parts.resize_with(parts.len().max(sheet as usize + 1), Vec::new);
            parts[sheet as usize].push(t as u32);
        }
        let sheet = |triangles: Vec<u32>| {
            let vertices = triangles.iter().flat_map(|&t| mesh.triangles[t as usize]).map(place).collect();
            let own = (0..triangles.len() as u32).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
            let part = Mesh { vertices, triangles: own, ..Mesh::default() };
            let first = normals[triangles[0] as usize];
            let is_flat = triangles.iter().all(|&t| vec3::norm(vec3::cross(first, normals[t as usize])) < FLAT);
            Sheet { tree: TriangleTree::new(&part), triangles, is_flat }
        };
        let used = || mesh.triangles.iter().flatten().map(|&v| place(v));
        let extent = [used().fold([f64::INFINITY; 3], vec3::min), used().fold([f64::NEG_INFINITY; 3], vec3::max)];
        Ok(Self {
            corners: mesh.triangles.iter().map(|t| place(t[0])).collect(),
            extent,
            tree: TriangleTree::new(mesh),
            sheets: parts.into_iter().map(sheet).collect(),
            normals,
            sheet_of,
            facing,
        })
    }

    fn closest(&self, p: Vec3) -> Option<ClosestPoint> {
        self.tree.closest(p)
    }

    fn is_inside(&self, p: Vec3) -> bool {
        self.facing * self.tree.winding_number(p).value > 0.5
    }
}

/// The smooth part that each triangle belongs to, numbered in the order of their first triangles.
fn smooth_parts(mesh: &Mesh, normals: &[Vec3]) -> Vec<u32> {
    let mut at_edge: FxHashMap<[u32; 2], u32> = FxHashMap::default();
    let mut roots: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    fn root(roots: &mut [u32], mut t: u32) -> u32 {
        while roots[t as usize] != t {
            roots[t as usize] = roots[roots[t as usize] as usize];
            t = roots[t as usize];
        }
        t
    }
    for (t, corners) in mesh.triangles.iter().enumerate() {
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            let Some(other) = at_edge.insert([a.min(b), a.max(b)], t as u32) else { continue };
            if vec3::dot(normals[t], normals[other as usize]) > SMOOTH {
                let (s, t) = (root(&mut roots, t as u32), root(&mut roots, other));
                roots[s.max(t) as usize] = s.min(t);
            }
        }
    }
    let mut number: FxHashMap<u32, u32> = FxHashMap::default();
    (0..roots.len() as u32)
        .map(|t| {
            let (root, next) = (root(&mut roots, t), number.len() as u32);
            *number.entry(root).or_insert(next)
        })
        .collect()
}

impl Field for MeshSolid {
    fn value(&self, p: [f64; 3]) -> f64 {
        let distance = self.closest(p).map_or(f64::INFINITY, |c| c.distance_squared.sqrt());
        if self.is_inside(p) { -distance } else { distance }
    }

    fn gradient(&self, p: [f64; 3]) -> [f64; 3] {
        let Some(closest) = self.closest(p) else { return [0.0, 0.0, 1.0] };
        let away = vec3::sub(p, closest.position);
        match vec3::normalized(away) {
            Some(away) if self.is_inside(p) => vec3::scale(away, -1.0),
            Some(away) => away,
            None => self.normals[closest.triangle],
        }
    }

    fn metric(&self) -> Metric {
        Metric::Distance
    }

    fn extent(&self) -> Option<[[f64; 3]; 2]> {
        Some(self.extent)
    }

    fn sheets(&self) -> u32 {
        self.sheets.len() as u32
    }

    fn sheet(&self, p: [f64; 3]) -> u32 {
        self.closest(p).map_or(0, |closest| self.sheet_of[closest.triangle])
    }

    fn on_sheet(&self, sheet: u32, p: [f64; 3]) -> (f64, [f64; 3]) {
        let sheet = &self.sheets[sheet as usize];
        let Some(closest) = sheet.tree.closest(p) else { return (f64::INFINITY, [0.0, 0.0, 1.0]) };
        let t = sheet.triangles[closest.triangle] as usize;
        (vec3::dot(self.normals[t], vec3::sub(p, self.corners[t])), self.normals[t])
    }

    fn is_flat(&self, sheet: u32) -> bool {
        self.sheets[sheet as usize].is_flat
    }
}
