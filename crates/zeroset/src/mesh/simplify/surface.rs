//! A mesh whose edges can be collapsed.

use crate::mesh::Mesh;
use crate::mesh::edges::{Edges, repeats};
use crate::vec3::{self, Vec3};

/// Triangles that know each other through the vertices.
#[derive(Debug, Clone)]
pub(super) struct Surface {
    pub(super) vertices: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
    /// The triangles at each vertex; empty once the vertex is gone.
    stars: Vec<Vec<u32>>,
    alive: Vec<bool>,
    live: usize,
    /// Vertices that must stay as they are: they are held, or the surface is no manifold there.
    fixed: Vec<bool>,
}

/// A collapse: the edge shrinks to a point, which takes the number of its first vertex.
#[derive(Debug, Clone)]
pub(super) struct Change {
    /// Who stays, and who goes.
    pub(super) edge: [u32; 2],
    /// Triangles that lose their area.
    pub(super) dying: Vec<u32>,
    /// The other triangles at the edge's ends.
    pub(super) changing: Vec<u32>,
}

impl Surface {
    /// The surface of a sound mesh, given its edges and the vertices that stay as they are. Triangles that repeat a vertex are left out.
    pub(super) fn new(mesh: &Mesh, edges: &Edges, held: &[u32]) -> Self {
        let mut stars = vec![Vec::new(); mesh.vertices.len()];
        let alive: Vec<bool> = mesh.triangles.iter().map(|t| !repeats(t)).collect();
        for (t, triangle) in mesh.triangles.iter().enumerate().filter(|(t, _)| alive[*t]) {
            for &v in triangle {
                stars[v as usize].push(t as u32);
            }
        }
        let live = alive.iter().filter(|alive| **alive).count();
        let (vertices, triangles) = (mesh.vertices.clone(), mesh.triangles.clone());
        let mut surface = Self { vertices, triangles, stars, alive, live, fixed: vec![false; mesh.vertices.len()] };
        for edge in edges.iter().filter(|edge| edge.count() > 2) {
            surface.fixed[edge.low as usize] = true;
            surface.fixed[edge.high as usize] = true;
        }
        for &v in held.iter().filter(|v| (**v as usize) < mesh.vertices.len()) {
            surface.fixed[v as usize] = true;
        }
        for v in 0..surface.fixed.len() as u32 {
            surface.fixed[v as usize] |= !surface.is_one_fan(v);
        }
        surface
    }

    /// Sum of the triangles' areas.
    pub(super) fn area(&self) -> f64 {
        let live = (0..self.triangles.len() as u32).filter(|&t| self.is_alive(t));
        live.map(|t| {
            let [a, b, c] = self.corners(t);
            0.5 * vec3::norm(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)))
        })
        .sum()
    }

    /// The diagonal of the box around it.
    pub(super) fn extent(&self) -> f64 {
        let live = (0..self.triangles.len() as u32).filter(|&t| self.is_alive(t)).flat_map(|t| self.corners(t));
        let corners = live.fold(None, |bounds, v| {
            let [low, high] = bounds.unwrap_or([v, v]);
            Some([vec3::min(low, v), vec3::max(high, v)])
        });
        corners.map_or(0.0, |[low, high]| vec3::distance(low, high))
    }

    /// Number of triangles left.
    pub(super) fn live(&self) -> usize {
        self.live
    }

    pub(super) fn is_alive(&self, triangle: u32) -> bool {
        self.alive[triangle as usize]
    }

    /// The triangles at a vertex.
    pub(super) fn star(&self, vertex: u32) -> &[u32] {
        &self.stars[vertex as usize]
    }

    pub(super) fn corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|v| self.vertices[v as usize])
    }

    /// Whether a triangle is the first of those at one of its sides; side i runs from its corner i to the next.
    pub(super) fn is_first_at(&self, triangle: u32, side: usize) -> bool {
        let corners = self.triangles[triangle as usize];
        let (from, to) = (corners[side], corners[(side + 1) % 3]);
        let first = self.star(from).iter().find(|&&t| self.triangles[t as usize].contains(&to));
        first == Some(&triangle)
    }

    /// The neighbours of a vertex in rising order, each as often as it has triangles with the vertex.
    fn ring(&self, vertex: u32) -> Vec<u32> {
        let corners = self.star(vertex).iter().flat_map(|&t| self.triangles[t as usize]);
        let mut ring: Vec<u32> = corners.filter(|&v| v != vertex).collect();
        ring.sort_unstable();
        ring
    }

    /// The neighbours of a vertex in rising order.
    pub(super) fn neighbours(&self, vertex: u32) -> Vec<u32> {
        let mut ring = self.ring(vertex);
        ring.dedup();
        ring
    }

    /// Whether the triangles at a vertex hang together through edges at it.
    fn is_one_fan(&self, vertex: u32) -> bool {
        let star = self.star(vertex);
        let Some((&first, rest)) = star.split_first() else { return true };
        let mut reached: Vec<u32> = self.triangles[first as usize].to_vec();
        let mut rest = rest.to_vec();
        while !rest.is_empty() {
            let before = rest.len();
            rest.retain(|&t| {
                let triangle = self.triangles[t as usize];
                let joins = triangle.iter().any(|v| *v != vertex && reached.contains(v));
                if joins {
                    reached.extend(triangle);
                }
                !joins
            });
            if rest.len() == before {
                return false;
            }
        }
        true
    }

    /// What a collapse would change; `None` if the surface would be no manifold any more, or have another shape.
    ///
    /// That is the link condition: the neighbours that both ends have in common are the apexes of the edge's triangles and no
    /// others, where a border counts as a neighbour of all vertices on it (Dey, Edelsbrunner, Guha and Nekhayev 1999).
    pub(super) fn change(&self, edge: [u32; 2]) -> Option<Change> {
        let [keep, gone] = edge;
        if self.fixed[keep as usize] || self.fixed[gone as usize] {
            return None;
        }
        let (dying, mut changing): (Vec<u32>, Vec<u32>) =
            self.star(keep).iter().partition(|&&t| self.triangles[t as usize].contains(&gone));
        changing.extend(self.star(gone).iter().filter(|t| !dying.contains(t)));
        let apexes: Vec<u32> =
            dying.iter().filter_map(|&t| self.triangles[t as usize].into_iter().find(|v| !edge.contains(v))).collect();
        let rings = edge.map(|v| self.ring(v));
        let on_border = rings.each_ref().map(|ring| ring.chunk_by(u32::eq).any(|same| same.len() == 1));
        let common = |v: &u32| rings[1].binary_search(v).is_ok();
        let shared = rings[0].chunk_by(u32::eq).filter(|same| common(&same[0])).count();
        let sound = match apexes[..] {
            [_] => shared == 1,
            [a, b] => {
                let closes = |v: u32| {
                    self.star(v).iter().any(|&t| {
                        let triangle = self.triangles[t as usize];
                        triangle.contains(&a) && triangle.contains(&b)
                    })
                };
                a != b && shared == 2 && on_border != [true; 2] && !(closes(keep) && closes(gone))
            }
            _ => false,
        };
        (sound && !changing.is_empty()).then_some(Change { edge, dying, changing })
    }

    /// The corners of a triangle after a change that puts the vertex somewhere.
    pub(super) fn corners_after(&self, triangle: u32, change: &Change, position: Vec3) -> [Vec3; 3] {
        self.triangles[triangle as usize]
            .map(|v| if change.edge.contains(&v) { position } else { self.vertices[v as usize] })
    }

    /// Collapses.
    pub(super) fn apply(&mut self, change: &Change, position: Vec3) {
        let [keep, gone] = change.edge;
        for &t in &change.dying {
            self.alive[t as usize] = false;
            for v in self.triangles[t as usize] {
                self.stars[v as usize].retain(|&other| other != t);
            }
        }
        self.live -= change.dying.len();
        for t in std::mem::take(&mut self.stars[gone as usize]) {
            for v in &mut self.triangles[t as usize] {
                if *v == gone {
                    *v = keep;
                }
            }
            self.stars[keep as usize].push(t);
        }
        self.vertices[keep as usize] = position;
    }

    /// What is left, as a mesh without unused vertices, and the number of each vertex in it; both keep their order. The attributes are still to be found.
    pub(super) fn to_mesh(&self) -> (Mesh, Vec<Option<u32>>) {
        let mut number = vec![None; self.vertices.len()];
        let mut mesh = Mesh::default();
        for (v, _) in self.stars.iter().enumerate().filter(|(_, star)| !star.is_empty()) {
            number[v] = Some(mesh.vertices.len() as u32);
            mesh.vertices.push(self.vertices[v]);
        }
        let live = self.triangles.iter().zip(&self.alive).filter(|(_, alive)| **alive);
        mesh.triangles = live.map(|(t, _)| t.map(|v| number[v as usize].unwrap_or_default())).collect();
        (mesh, number)
    }
}
