//! Far fewer triangles, fast: all vertices of a cell become one.
//!
//! # What
//! Space is cut into cubic cells, aligned to whole multiples of their side in local coordinates. The vertices of each connected part of the surface
//! within a cell become one. Triangles whose corners fall together go, the others keep their corners. [`simplify`](super::simplify())
//! makes better meshes, a hundred times slower: this is for levels of detail.
//!
//! *Held* vertices stay where they are, bit for bit, and join no other: meshes that share them go on sharing them. Their triangles with one
//! another stay, too.
//!
//! # Where the vertex goes
//! Where the sum of squared distances from the planes of the triangles around is least, each plane weighted by area, so that edges and corners stay
//! sharp; borders count as planes upright on their triangles. What planes leave open is decided by the mean of the vertices: from there the vertex moves towards the least,
//! no farther than to the faces of the cell.
//!
//! # Two sheets in a cell
//! Vertices join along edges that lie within a cell. So the ground under a bridge, and the two sides of a wall, stay apart although they are
//! closer together than a cell, except where they meet within it. Where a wall has collapsed to a sheet, both of its sides stay, back to back:
//! the surface stays closed, and is seen from both sides. Of triangles that come twice the same way round one stays.
//!
//! A small part that is surrounded by two others leaves a *flap*: both sides of one triangle, hanging from an edge. It is folded onto that edge, if no
//! vertex moves farther than a diagonal for it. Of noisy cities about one triangle in twenty is of a flap.
//!
//! # Cost
//! O(V + F), and sorting the triangles that are left. Quadrics are solved in parallel, all else is done on one thread.
//!
//! # Guaranteed
//! - The same mesh, bit for bit, on any number of threads.
//! - No vertex moves farther than [`Clustered::moved`], which is at most the diagonal of a cell. So no place of the result is farther than that from the original,
//!   nor is any place of the original on a triangle that does not collapse from the result.
//!
//! # Not guaranteed
//! - That what is narrower than a cell stays: pieces and strands may vanish.
//! - A manifold: parts that meet in a cell grow together.
//! - That triangles do not cut through each other.
//!
//! # Attributes
//! Colours and intensities are means, a class is the most frequent one, of equals the lowest. Those of held vertices stay.
//!
//! # Source
//! Rossignac and Borrel, Multi-resolution 3D approximations for rendering complex scenes, 1993, for the cells. Lindstrom, Out-of-core simplification of
//! large polygonal models, 2000, for the vertex of a cell, with the quadrics of Garland and Heckbert, 1997. Ours: parts of a cell apart, held vertices,
//! and the way from the mean that ends at the cell.
//!
//! ```
//! use zeroset::mesh::cluster;
//! use zeroset::sample::{Scene, SceneKind};
//!
//! let sphere = Scene::new(SceneKind::Sphere, 0).truth;
//! let coarse = cluster(&sphere, &[], 0.1)?;
//! assert!(coarse.mesh.triangles.len() < sphere.triangles.len() / 4 && coarse.moved < 0.18);
//! # Ok::<(), zeroset::mesh::SimplifyError>(())
//! ```

use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

use super::edges::Edges;
use super::quadric::Quadric;
use super::topology::Groups;
use super::{Mesh, SimplifyError};
use crate::cloud::Attributes;
use crate::vec3::{self, Vec3};

/// Weight of the planes that stand on borders, over the squared length of the edge. A triangle of equal sides has 0.43 in the same measure.
const BORDER_WEIGHT: f64 = 1.0;

/// What [`cluster`] made.
#[derive(Debug, Clone, PartialEq)]
pub struct Clustered {
    /// The mesh that is left, without unused vertices. What is left of vertices keeps its order, by the first of each cluster.
    pub mesh: Mesh,
    /// The numbers of the held vertices in it, in the order in which they were given; `None` for those without a triangle.
    pub held: Vec<Option<u32>>,
    /// The farthest that a vertex moved, in the unit of the mesh.
    pub moved: f64,
}

/// Joins the vertices of each cell of a side, in the unit of the mesh, but for those that are held.
///
/// # Errors
/// [`SimplifyError`] if the side is not positive or the mesh is broken.
pub fn cluster(mesh: &Mesh, held: &[u32], side: f64) -> Result<Clustered, SimplifyError> {
    if !(side > 0.0 && side.is_finite()) {
        return Err(SimplifyError::Parameter { name: "the side of cells", value: side });
    }
    let edges = Edges::new(mesh)?;
    let clusters = Clusters::new(mesh, held, side);
    let mut places = clusters.places(mesh, &edges, side);
    drop(edges);
    let mut triangles = clusters.triangles(mesh);
    while clusters.fold(mesh, 3.0_f64.sqrt() * side, &mut triangles, &mut places) {}

    // What no triangle is left at goes.
    let mut is_used = vec![false; clusters.len()];
    triangles.iter().flatten().for_each(|&c| is_used[c as usize] = true);
    let used: Vec<u32> = (0..clusters.len() as u32).filter(|&c| is_used[c as usize]).collect();
    let mut number = vec![None; clusters.len()];
    used.iter().enumerate().for_each(|(new, &c)| number[c as usize] = Some(new as u32));
    let renumbered = |t: &[u32; 3]| t.map(|c| number[c as usize].unwrap_or_default());
    Ok(Clustered {
        moved: clusters.moved(mesh, &places),
        held: held.iter().map(|&v| number[*clusters.of.get(v as usize)? as usize]).collect(),
        mesh: Mesh {
            vertices: used.iter().map(|&c| places[c as usize]).collect(),
            triangles: triangles.iter().map(renumbered).collect(),
            attributes: clusters.attributes(&mesh.attributes, &used),
            world_from_local: mesh.world_from_local,
            crs: mesh.crs.clone(),
        },
    })
}

/// Which vertices become one. Clusters are numbered by their first vertex.
struct Clusters {
    /// The cluster of each vertex.
    of: Vec<u32>,
    /// Where the members of each cluster begin, and their number.
    starts: Vec<u32>,
    /// The vertices, cluster after cluster, in order.
    members: Vec<u32>,
    /// Whether each vertex is held; these are alone in their clusters.
    is_held: Vec<bool>,
}

/// Both sides of a triangle that hang from an edge.
struct Flap {
    /// As the triangle that is first of the two has it.
    triangle: [u32; 3],
    /// The corner that has no other triangles, and the edge across.
    tip: u32,
    edge: [u32; 2],
}

impl Clusters {
    fn new(mesh: &Mesh, held: &[u32], side: f64) -> Self {
        let count = mesh.vertices.len();
        let mut is_held = vec![false; count];
        held.iter().for_each(|&v| {
            if let Some(is_held) = is_held.get_mut(v as usize) {
                *is_held = true;
            }
        });
        let cells: Vec<Vec3> = mesh.vertices.iter().map(|&v| cell(v, side)).collect();
        let mut groups = Groups::new(count);
        for &[a, b, c] in &mesh.triangles {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                if cells[a as usize] == cells[b as usize] && !is_held[a as usize] && !is_held[b as usize] {
                    groups.merge(a, b);
                }
            }
        }
        drop(cells);
        // A root is the lowest of its group, so it comes first.
        let mut of = vec![0; count];
        let mut starts: Vec<u32> = Vec::new();
        for v in 0..count as u32 {
            let root = groups.root(v);
            if root == v {
                of[v as usize] = starts.len() as u32;
                starts.push(0);
            } else {
                of[v as usize] = of[root as usize];
            }
            starts[of[v as usize] as usize] += 1;
        }
        let mut total = 0;
        starts.iter_mut().for_each(|start| total += std::mem::replace(start, total));
        starts.push(total);
        let mut next = starts.clone();
        let mut members = vec![0; count];
        for (v, &c) in of.iter().enumerate() {
            let place = &mut next[c as usize];
            members[*place as usize] = v as u32;
            *place += 1;
        }
        Self { of, starts, members, is_held }
    }

    fn len(&self) -> usize {
        self.starts.len() - 1
    }

    fn members(&self, cluster: u32) -> &[u32] {
        let c = cluster as usize;
        &self.members[self.starts[c] as usize..self.starts[c + 1] as usize]
    }

    /// Where the vertex of each cluster goes.
    fn places(&self, mesh: &Mesh, edges: &Edges<'_>, side: f64) -> Vec<Vec3> {
        let vertex = |&v: &u32| mesh.vertices[v as usize];
        let mean = |c: u32| match self.members(c) {
            [only] => vertex(only),
            all => vec3::scale(all.iter().map(vertex).fold([0.0; 3], vec3::add), 1.0 / all.len() as f64),
        };
        let means: Vec<Vec3> = (0..self.len() as u32).into_par_iter().map(mean).collect();
        let quadrics = self.quadrics(mesh, edges, &means);
        let place = |c: u32| {
            let mean = means[c as usize];
            match self.members(c) {
                [_] => mean,
                [first, ..] => towards(mean, quadrics[c as usize].least(), cell(vertex(first), side), side),
                [] => mean,
            }
        };
        (0..self.len() as u32).into_par_iter().map(place).collect()
    }

    /// The planes around each cluster, seen from its mean.
    fn quadrics(&self, mesh: &Mesh, edges: &Edges<'_>, means: &[Vec3]) -> Vec<Quadric> {
        let mut quadrics = vec![Quadric::default(); self.len()];
        let mut add = |v: u32, normal: Vec3, on: Vec3, weight: f64| {
            let c = self.of[v as usize];
            if self.members(c).len() > 1 {
                let height = vec3::dot(normal, vec3::sub(means[c as usize], on));
                quadrics[c as usize].add_plane(normal, height, weight);
            }
        };
        for &triangle in &mesh.triangles {
            let [p, q, r] = triangle.map(|v| mesh.vertices[v as usize]);
            let normal = vec3::cross(vec3::sub(q, p), vec3::sub(r, p));
            let double_area = vec3::norm(normal);
            if double_area > 0.0 {
                let normal = vec3::scale(normal, 1.0 / double_area);
                triangle.into_iter().for_each(|v| add(v, normal, p, 0.5 * double_area));
            }
        }
        for edge in edges.iter().filter(|edge| edge.count() == 1) {
            let ends = [edge.low, edge.high];
            let [low, high] = ends.map(|v| mesh.vertices[v as usize]);
            let along = vec3::sub(high, low);
            let triangle = edge.corners().next().map(|corner| mesh.triangles[corner as usize / 3]);
            let Some([p, q, r]) = triangle.map(|t| t.map(|v| mesh.vertices[v as usize])) else { continue };
            let normal = vec3::cross(vec3::sub(q, p), vec3::sub(r, p));
            let Some(across) = vec3::normalized(vec3::cross(normal, along)) else { continue };
            ends.into_iter().for_each(|v| add(v, across, low, BORDER_WEIGHT * vec3::norm_squared(along)));
        }
        quadrics
    }

    /// The triangles whose corners stay apart, as clusters, each way round once.
    fn triangles(&self, mesh: &Mesh) -> Vec<[u32; 3]> {
        let mut left: Vec<[u32; 3]> = Vec::new();
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|v| self.of[v as usize]);
            if a != b && b != c && c != a {
                let least = a.min(b).min(c);
                left.push(if a == least {
                    [a, b, c]
                } else if b == least {
                    [b, c, a]
                } else {
                    [c, a, b]
                });
            }
        }
        left.par_sort_unstable();
        left.dedup();
        left
    }

    /// Folds flaps onto the edges that they hang from, unless a vertex would go farther than `most`. Whether there were any: then others may have become some.
    fn fold(&self, mesh: &Mesh, most: f64, triangles: &mut Vec<[u32; 3]>, places: &mut [Vec3]) -> bool {
        let mut degrees = vec![0_u32; self.len()];
        triangles.iter().flatten().for_each(|&c| degrees[c as usize] += 1);
        let is_tip = |c: u32| degrees[c as usize] == 2 && !self.members(c).iter().any(|&v| self.is_held[v as usize]);
        let mut flaps: Vec<Flap> = Vec::new();
        for &[a, b, c] in triangles.iter().filter(|[_, b, c]| b < c) {
            let corners = [(a, [b, c]), (b, [a, c]), (c, [a, b])];
            let tips = corners.into_iter().filter(|(tip, _)| is_tip(*tip));
            let own = tips.map(|(tip, edge)| Flap { triangle: [a, b, c], tip, edge });
            if triangles.binary_search(&[a, c, b]).is_ok() {
                flaps.extend(own);
            }
        }
        // How many triangles other than flaps there are at their edges.
        let mut others: FxHashMap<[u32; 2], i64> = FxHashMap::default();
        flaps.iter().for_each(|flap| *others.entry(flap.edge).or_default() -= 2);
        for &[a, b, c] in triangles.iter().filter(|_| !flaps.is_empty()) {
            for [a, b] in [[a, b], [b, c], [c, a]] {
                if let Some(count) = others.get_mut(&[a.min(b), a.max(b)]) {
                    *count += 1;
                }
            }
        }
        let mut gone: FxHashSet<[u32; 3]> = FxHashSet::default();
        for Flap { triangle: [a, b, c], tip, edge } in flaps.into_iter().filter(|flap| others[&flap.edge] > 0) {
            let foot = closest_on_segment(edge.map(|end| places[end as usize]), places[tip as usize]);
            let near = |&v: &u32| vec3::distance(mesh.vertices[v as usize], foot) <= most;
            if self.members(tip).iter().all(near) {
                places[tip as usize] = foot;
                gone.extend([[a, b, c], [a, c, b]]);
            }
        }
        triangles.retain(|triangle| !gone.contains(triangle));
        !gone.is_empty()
    }

    fn moved(&self, mesh: &Mesh, places: &[Vec3]) -> f64 {
        let squared = |(v, &c): (&Vec3, &u32)| vec3::distance_squared(*v, places[c as usize]);
        mesh.vertices.par_iter().zip(&self.of).map(squared).reduce(|| 0.0, f64::max).sqrt()
    }

    /// The values of some clusters.
    fn attributes(&self, from: &Attributes, clusters: &[u32]) -> Attributes {
        fn each<T: Send>(clusters: &[u32], value: impl Fn(u32) -> T + Sync) -> Vec<T> {
            clusters.par_iter().map(|&c| value(c)).collect()
        }
        let mean = |c: u32, value: &dyn Fn(usize) -> f64| {
            let all = self.members(c);
            all.iter().map(|&v| value(v as usize)).sum::<f64>() / all.len() as f64
        };
        Attributes {
            colors: from
                .colors
                .as_ref()
                .map(|all| each(clusters, |c| [0, 1, 2].map(|i| mean(c, &|v| f64::from(all[v][i])).round() as u8))),
            intensities: from
                .intensities
                .as_ref()
                .map(|all| each(clusters, |c| mean(c, &|v| f64::from(all[v])) as f32)),
            classes: from.classes.as_ref().map(|all| {
                each(clusters, |c| most_frequent(self.members(c).iter().map(|&v| all[v as usize]).collect()))
            }),
        }
    }
}

/// The cell of a position: whole numbers.
fn cell(v: Vec3, side: f64) -> Vec3 {
    v.map(|c| (c / side).floor())
}

/// The way from a position in a cell by a step, as far as it stays in the cell.
fn towards(from: Vec3, step: Vec3, cell: Vec3, side: f64) -> Vec3 {
    let mut share = 1.0_f64;
    for a in 0..3 {
        let (low, high) = (cell[a] * side, (cell[a] + 1.0) * side);
        let room = if step[a] > 0.0 { high - from[a] } else { from[a] - low };
        if step[a].abs() > room {
            share = share.min((room / step[a].abs()).max(0.0));
        }
    }
    vec3::add_scaled(from, step, share)
}

/// The place on a segment that is nearest to a position.
fn closest_on_segment([from, to]: [Vec3; 2], p: Vec3) -> Vec3 {
    let along = vec3::sub(to, from);
    let length_squared = vec3::norm_squared(along);
    let share = if length_squared > 0.0 { vec3::dot(vec3::sub(p, from), along) / length_squared } else { 0.0 };
    vec3::add_scaled(from, along, share.clamp(0.0, 1.0))
}

/// The value that comes most often, of equals the lowest; 0 if there is none.
fn most_frequent(mut values: Vec<u8>) -> u8 {
    values.sort_unstable();
    let mut best: &[u8] = &[];
    for run in values.chunk_by(u8::eq) {
        if run.len() > best.len() {
            best = run;
        }
    }
    best.first().copied().unwrap_or_default()
}
