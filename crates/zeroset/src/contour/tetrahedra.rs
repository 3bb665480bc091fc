//! The same extraction on any mesh of tetrahedra whose nodes are marked, or bear values of F.

use super::ContourParams;
use super::cells::{Cell, Cells};
use super::chain::{Chain, chain};
use super::dual::ContourReport;
use super::placement::{Placement, Sector, place, sectors};
use super::split::split_fans;
use super::triangulate::triangulate;
use crate::domain::SimplicialMesh;
use crate::mesh::Mesh;
use crate::vec3::{self, Vec3};

/// What is known at the nodes of a mesh of tetrahedra: one entry for each of its vertices.
#[derive(Debug, Clone, Copy)]
pub enum Nodes<'a> {
    /// Which nodes are marked: a segmentation. Marked is inside.
    Marks(&'a [bool]),
    /// The values of F, negative inside.
    Values(&'a [f64]),
}

/// Why no surface can be extracted from a mesh of tetrahedra.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ContourError {
    /// Not one mark or value for each node.
    #[error("{given} marks or values are given for {nodes} nodes; give one for each")]
    Count {
        /// Marks or values given.
        given: usize,
        /// Nodes of the mesh.
        nodes: usize,
    },
    /// A value that is infinite or no number.
    #[error("F is {value} at node {node}; give finite values")]
    NotFinite {
        /// The node.
        node: usize,
        /// Its value.
        value: f64,
    },
    /// The tetrahedra around an edge are not connected through faces.
    #[error(
        "the tetrahedra around the edge of nodes {edge:?} do not hang together by faces; fill the gap between them, or give each group an edge of its own"
    )]
    PinchedEdge {
        /// The nodes of the edge.
        edge: [u32; 2],
    },
}

/// Extracts the surface between nodes that are marked and nodes that are not, or the zero set of F.
///
/// Vertices are numbered by their tetrahedra. `world_from_local` is zero.
///
/// # The three conditions
/// A tetrahedron with nodes of both kinds bears a vertex; a face with both kinds an edge of the mesh, as exactly two of its three edges are
/// crossed; and a crossed edge a polygon. That is a manifold if
///
/// 1. tetrahedra have a volume, and two of them meet in a whole face, edge or node, or not at all. Then two that share a crossed edge
///    and no face of it share no other crossed edge, and a diagonal that cuts a polygon is no edge elsewhere;
/// 2. at most two tetrahedra share a face. Then an edge of the mesh has at most two polygons;
/// 3. the tetrahedra around an edge hang together by faces: a ring, or a fan if the edge lies on the boundary. A ring gives a closed
///    polygon. A fan gives none, and so leaves a boundary where the surface meets that of the tetrahedra.
///
/// A [`SimplicialMesh`] meets the first by its examination, and the second follows from it in space: of three tetrahedra at a face two
/// overlap. The third is checked here, at all edges, whatever the marks. The mesh is closed if no edge on the boundary is crossed.
///
/// # Errors
/// If marks or values do not suit the mesh, or the third condition is not met.
pub fn contour_tetrahedra(
    mesh: &SimplicialMesh<3>,
    nodes: Nodes<'_>,
    params: &ContourParams,
) -> Result<(Mesh, ContourReport), ContourError> {
    let values = nodes.values(mesh.vertices().len())?;
    let active = Active::new(mesh, values);
    let (polygons, rim) = active.polygons()?;
    let mut vertices: Vec<Vec3> = (0..active.simplices.len()).map(|v| active.cell(v).mean_of_crossings()).collect();
    let placement = match &params.placement {
        Placement::MeanOfCrossings => None,
        Placement::LeastCurvature(least) => {
            let sectors: Vec<Sector> = polygons.iter().flat_map(|p| sectors(&p.vertices)).collect();
            Some(place(&mut vertices, &sectors, &active, least))
        }
    };
    let mut triangles = Vec::new();
    for polygon in &polygons {
        let corners: Vec<Vec3> = polygon.vertices.iter().map(|&v| vertices[v as usize]).collect();
        triangulate(&corners, polygon.normal, |t| triangles.push(t.map(|k| polygon.vertices[k])));
    }
    let mut surface = Mesh { vertices, triangles, ..Mesh::default() };
    let (split_vertices, _) = split_fans(&mut surface, &rim);
    let active_tetrahedra = active.simplices.len();
    Ok((surface, ContourReport { active_tetrahedra, trimmed_polygons: 0, split_vertices, placement }))
}

impl Nodes<'_> {
    /// Values of F: -1 and 1 for marks.
    fn values(self, nodes: usize) -> Result<Vec<f64>, ContourError> {
        let values: Vec<f64> = match self {
            Nodes::Marks(marks) => marks.iter().map(|&marked| if marked { -1.0 } else { 1.0 }).collect(),
            Nodes::Values(values) => values.to_vec(),
        };
        if values.len() != nodes {
            return Err(ContourError::Count { given: values.len(), nodes });
        }
        match values.iter().position(|v| !v.is_finite()) {
            Some(node) => Err(ContourError::NotFinite { node, value: values[node] }),
            None => Ok(values),
        }
    }
}

/// The tetrahedra with nodes of both kinds.
struct Active<'a> {
    mesh: &'a SimplicialMesh<3>,
    values: Vec<f64>,
    /// The tetrahedron of each vertex.
    simplices: Vec<u32>,
    /// The vertex of each tetrahedron that has one.
    vertex_of: Vec<Option<u32>>,
}

/// A closed ring of tetrahedra around a crossed edge.
struct Polygon {
    /// The vertices, counter-clockwise seen from outside.
    vertices: Vec<u32>,
    /// The direction of the edge, from inside to outside.
    normal: Vec3,
}

/// A tetrahedron at an edge: counter-clockwise around it, seen from its higher node, it reaches from one of its other nodes to the last.
#[derive(Debug, Clone, Copy, Default)]
struct Wedge {
    from: u32,
    to: u32,
    simplex: u32,
}

/// The corners at each edge of a tetrahedron, in the order of [`SimplicialMesh::edges_of`], then the two others, so that all four are an even
/// order.
const EDGES: [[usize; 4]; 6] = [[0, 1, 2, 3], [0, 2, 3, 1], [0, 3, 1, 2], [1, 2, 0, 3], [1, 3, 2, 0], [2, 3, 0, 1]];

impl<'a> Active<'a> {
    fn new(mesh: &'a SimplicialMesh<3>, values: Vec<f64>) -> Self {
        let mut simplices = Vec::new();
        let mut vertex_of = vec![None; mesh.len()];
        for (simplex, vertex) in vertex_of.iter_mut().enumerate() {
            let inside = mesh.simplex(simplex).iter().filter(|&&node| values[node as usize] < 0.0).count();
            if inside % 4 != 0 {
                *vertex = Some(simplices.len() as u32);
                simplices.push(simplex as u32);
            }
        }
        Self { mesh, values, simplices, vertex_of }
    }

    fn is_inside(&self, node: u32) -> bool {
        self.values[node as usize] < 0.0
    }

    /// The polygons of all crossed edges in the inside of the mesh, and for each vertex whether one is missing.
    fn polygons(&self) -> Result<(Vec<Polygon>, Vec<bool>), ContourError> {
        let (mut polygons, mut rim) = (Vec::new(), vec![false; self.simplices.len()]);
        let (first, mut wedges) = wedges(self.mesh);
        for (e, &edge) in self.mesh.edges().iter().enumerate() {
            let around = &mut wedges[first[e]..first[e + 1]];
            let chain = chain(around, |wedge| [wedge.from, wedge.to]);
            if chain == Chain::Broken {
                return Err(ContourError::PinchedEdge { edge });
            }
            let [low, high] = edge;
            if self.is_inside(low) == self.is_inside(high) {
                continue;
            }
            // Around a crossed edge all tetrahedra have a vertex.
            let ring = around.iter().filter_map(|wedge| self.vertex_of[wedge.simplex as usize]);
            if chain == Chain::Closed {
                polygons.push(self.polygon(edge, ring.collect()));
            } else {
                ring.for_each(|v| rim[v as usize] = true);
            }
        }
        Ok((polygons, rim))
    }

    /// The polygon of a ring that is counter-clockwise seen from the higher node.
    fn polygon(&self, [low, high]: [u32; 2], mut vertices: Vec<u32>) -> Polygon {
        let nodes = self.mesh.vertices();
        let along = vec3::sub(nodes[high as usize], nodes[low as usize]);
        let along = vec3::normalized(along).unwrap_or([0.0; 3]);
        if self.is_inside(low) {
            Polygon { vertices, normal: along }
        } else {
            vertices.reverse();
            Polygon { vertices, normal: vec3::scale(along, -1.0) }
        }
    }
}

impl Cells for Active<'_> {
    fn cell(&self, vertex: usize) -> Cell {
        let corners = self.mesh.simplex(self.simplices[vertex] as usize);
        let at = |c: usize| corners[c] as usize;
        Cell {
            corners: std::array::from_fn(|c| self.mesh.vertices()[at(c)]),
            values: std::array::from_fn(|c| self.values[at(c)]),
        }
    }
}

/// The wedges at all edges, edge after edge, and where those of each edge begin.
fn wedges(mesh: &SimplicialMesh<3>) -> (Vec<usize>, Vec<Wedge>) {
    let mut first = vec![0; mesh.edges().len() + 1];
    let edges = || (0..mesh.len()).flat_map(|s| mesh.edges_of(s).iter().map(|&e| e as usize));
    edges().for_each(|e| first[e + 1] += 1);
    for e in 1..first.len() {
        first[e] += first[e - 1];
    }
    let (mut next, mut wedges) = (first.clone(), vec![Wedge::default(); 6 * mesh.len()]);
    for simplex in 0..mesh.len() {
        let corners = mesh.simplex(simplex);
        for (&e, order) in mesh.edges_of(simplex).iter().zip(EDGES) {
            let [a, b, from, to] = order.map(|c| corners[c]);
            let (from, to) = if a < b { (from, to) } else { (to, from) };
            let place = &mut next[e as usize];
            wedges[*place] = Wedge { from, to, simplex: simplex as u32 };
            *place += 1;
        }
    }
    (first, wedges)
}
