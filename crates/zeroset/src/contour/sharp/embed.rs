//! Takes vertices back towards F where triangles cut through each other.
//!
//! The surface of F does not meet itself, and each vertex has its place there. So going back far enough helps; the surface is a little
//! rounder there, but stays embedded.

use rayon::prelude::*;

use crate::mesh::{Mesh, Projection, overlapping_pairs, projections};
use crate::spatial::TriangleTree;
use crate::vec3::{self, Vec3};

/// Vertices that moved farther than this, in cells, may have brought triangles together; by experience the others hardly do.
pub(super) const MOVED: f64 = 0.2;
/// Rings of triangles around these that they are held against.
const RINGS: usize = 2;
/// The most rounds of taking back.
const ROUNDS: usize = 20;
/// The first time a vertex goes half the way, the next time the whole.
const SHARES: [f64; 2] = [0.5, 1.0];
/// Where all vertices of a pair are on F already, neighbours up to so many rings away are in the way.
const MOST_RINGS: usize = 4;

/// Places whose coordinates single precision holds: what is true of a mesh on them is true of it in every file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Raster {
    step: f64,
}

impl Raster {
    /// The finest that holds a mesh.
    pub(super) fn new(mesh: &Mesh) -> Self {
        Self::up_to(
            mesh.vertices.par_iter().map(|v| v.iter().fold(0.0, |m, c| c.abs().max(m))).reduce(|| 0.0, f64::max),
        )
    }

    /// The finest for coordinates up to the largest: its steps are a power of two, the largest is about 2^23 of them.
    pub(crate) fn up_to(largest: f64) -> Self {
        Self { step: if largest > 0.0 { 2.0_f64.powi(largest.log2().floor() as i32 - 22) } else { 1.0 } }
    }

    /// How far apart its places are along each axis.
    pub(crate) fn step(self) -> f64 {
        self.step
    }

    /// The place nearest to a position.
    pub(crate) fn nearest(self, v: Vec3) -> Vec3 {
        v.map(|c| (c / self.step).round_ties_even() * self.step)
    }
}

/// Puts the vertices on a raster, and takes them back until no triangles that moved cut through each other or have no area; the
/// number of vertices taken back, and of pairs that are left.
///
/// The vertices from `inserted` on were put in; `origins` are the places on F, on the raster. Looked at are triangles with vertices that were put in,
/// or moved farther than `moved`.
pub(super) fn embed(mesh: &mut Mesh, inserted: usize, origins: &[Vec3], raster: Raster, moved: f64) -> (usize, u64) {
    mesh.vertices.par_iter_mut().for_each(|v| *v = raster.nearest(*v));
    let mut part = Part::new(mesh, inserted, origins, moved);
    let mut times = vec![0_u8; mesh.vertices.len()];
    let is_done = |times: &[u8], v: u32| usize::from(times[v as usize]) == SHARES.len();
    let mut rings = 1;
    for _ in 0..ROUNDS {
        let bad = part.bad();
        let (stuck, mut going): (Vec<u32>, Vec<u32>) = {
            let (stuck, going): (Vec<_>, Vec<_>) = bad.chunks(2).partition(|pair| {
                pair.iter().flat_map(|&t| part.mesh.triangles[t as usize]).all(|v| is_done(&times, v))
            });
            (part.corners(&stuck.concat()), part.corners(&going.concat()))
        };
        if !stuck.is_empty() {
            going.extend(part.around(&stuck, rings));
        }
        going.sort_unstable();
        going.dedup();
        going.retain(|&v| !is_done(&times, v));
        if going.is_empty() {
            rings += 1;
            if stuck.is_empty() || rings > MOST_RINGS {
                break;
            }
            continue;
        }
        for &v in &going {
            let v = v as usize;
            let share = SHARES[usize::from(times[v])];
            mesh.vertices[v] = raster.nearest(vec3::lerp(mesh.vertices[v], origins[v], share));
            times[v] += 1;
        }
        part.follow(mesh, &going);
    }
    (times.iter().filter(|&&times| times > 0).count(), part.pairs.len() as u64)
}

/// The part of a mesh that moved.
struct Part {
    mesh: Mesh,
    tree: TriangleTree,
    projections: Vec<Option<Projection>>,
    /// Triangles that cut through each other.
    pairs: Vec<[u32; 2]>,
}

impl Part {
    fn new(mesh: &Mesh, inserted: usize, origins: &[Vec3], moved: f64) -> Self {
        let has_moved =
            |v: usize| v >= inserted || vec3::distance_squared(mesh.vertices[v], origins[v]) > moved * moved;
        let mut is_near: Vec<bool> = (0..mesh.vertices.len()).into_par_iter().map(has_moved).collect();
        let touches = |is_near: &[bool], corners: &[u32; 3]| corners.iter().any(|&v| is_near[v as usize]);
        let asked = is_near.clone();
        add_rings(&mut is_near, &mesh.triangles, RINGS);
        let triangles: Vec<[u32; 3]> =
            mesh.triangles.par_iter().copied().filter(|corners| touches(&is_near, corners)).collect();
        drop(is_near);
        let asked: Vec<bool> = triangles.par_iter().map(|corners| touches(&asked, corners)).collect();
        let vertices = mesh.vertices.clone();
        let mesh = Mesh { vertices, triangles, ..Mesh::default() };
        let tree = TriangleTree::new(&mesh);
        let projections = projections(&mesh);
        let pairs = overlapping_pairs(&mesh, &tree, &projections, &asked);
        Self { mesh, tree, projections, pairs }
    }

    /// The triangles of pairs, two and two, and those without area, each twice.
    fn bad(&self) -> Vec<u32> {
        let flat =
            (0..self.projections.len() as u32).into_par_iter().filter(|&t| self.projections[t as usize].is_none());
        let mut bad: Vec<u32> = flat.flat_map_iter(|t| [t, t]).collect();
        bad.extend(self.pairs.iter().flatten());
        bad
    }

    fn corners(&self, triangles: &[u32]) -> Vec<u32> {
        triangles.iter().flat_map(|&t| self.mesh.triangles[t as usize]).collect()
    }

    /// The vertices up to so many rings around some.
    fn around(&self, vertices: &[u32], rings: usize) -> Vec<u32> {
        let mut is_near = vec![false; self.mesh.vertices.len()];
        vertices.iter().for_each(|&v| is_near[v as usize] = true);
        add_rings(&mut is_near, &self.mesh.triangles, rings);
        (0..is_near.len() as u32).filter(|&v| is_near[v as usize]).collect()
    }

    /// Takes over some vertices of the whole mesh, and looks at their triangles again.
    fn follow(&mut self, whole: &Mesh, vertices: &[u32]) {
        let mut has_moved = vec![false; self.mesh.vertices.len()];
        for &v in vertices {
            has_moved[v as usize] = true;
            self.mesh.vertices[v as usize] = whole.vertices[v as usize];
        }
        let touches = |corners: &[u32; 3]| corners.iter().any(|&v| has_moved[v as usize]);
        let asked: Vec<bool> = self.mesh.triangles.par_iter().map(touches).collect();
        self.tree.follow(&self.mesh);
        for (t, corners) in self.mesh.triangles.iter().enumerate().filter(|(t, _)| asked[*t]) {
            self.projections[t] = Projection::new(corners.map(|v| self.mesh.vertices[v as usize]));
        }
        self.pairs.retain(|pair| !pair.iter().any(|&t| asked[t as usize]));
        self.pairs.extend(overlapping_pairs(&self.mesh, &self.tree, &self.projections, &asked));
    }
}

/// Adds the vertices of all triangles that have one, so many times.
fn add_rings(has: &mut [bool], triangles: &[[u32; 3]], rings: usize) {
    for _ in 0..rings {
        let touches = |corners: &&[u32; 3]| corners.iter().any(|&v| has[v as usize]);
        let beside: Vec<u32> = triangles.par_iter().filter(touches).flatten().copied().collect();
        beside.into_iter().for_each(|v| has[v as usize] = true);
    }
}
