//! The faces, creases and corners of a truth.

use rustc_hash::FxHashMap;

use super::super::FeatureKind;
use super::{CompareFeaturesError, CompareFeaturesParams};
use crate::mesh::{Crease, Edges, Mesh, MeshError, crease_edges};
use crate::vec3::{self, Vec3};

/// Triangles of one face agree within this angle: 0.1 degree.
const SAME_FACE: f64 = std::f64::consts::PI / 1800.0;
/// Two creases that meet at a larger turn than this make a corner: 30 degrees.
const CORNER_TURN: f64 = std::f64::consts::PI / 6.0;
/// Found edges and corners may lie at creases of this share of the sharp angle.
const LENIENCE: f64 = 0.8;

/// A truth made ready.
pub(super) struct Truth {
    /// Welded, without attributes.
    pub(super) mesh: Mesh,
    /// Unit normals of the triangles; `None` without area.
    pub(super) normals: Vec<Option<Vec3>>,
    pub(super) diagonal: f64,
    pub(super) faces: Vec<Face>,
    /// The face of each triangle; `None` without area.
    pub(super) face_of: Vec<Option<usize>>,
    pub(super) sharp: Creases,
    /// Creases that need not be quite as sharp.
    pub(super) nearly_sharp: Creases,
}

/// A flat part of the surface.
pub(super) struct Face {
    pub(super) triangles: Vec<usize>,
    pub(super) normal: Vec3,
    pub(super) area: f64,
    pub(super) centre: Vec3,
    /// The box around it.
    pub(super) bounds: [Vec3; 2],
}

/// Creases, and the corners that they make.
pub(super) struct Creases {
    pub(super) edges: Vec<Crease>,
    pub(super) segments: Vec<[Vec3; 2]>,
    pub(super) corners: Vec<TrueCorner>,
}

/// A corner with the creases that meet in it.
pub(super) struct TrueCorner {
    pub(super) vertex: u32,
    pub(super) position: Vec3,
    pub(super) creases: Vec<usize>,
    pub(super) kind: FeatureKind,
}

impl Truth {
    pub(super) fn new(mesh: &Mesh, params: &CompareFeaturesParams) -> Result<Self, CompareFeaturesError> {
        mesh.check()?;
        let mesh = welded(mesh);
        let areas: Vec<Vec3> = mesh
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|v| mesh.vertices[v as usize]);
                vec3::scale(vec3::cross(vec3::sub(b, a), vec3::sub(c, a)), 0.5)
            })
            .collect();
        let normals: Vec<Option<Vec3>> = areas.iter().map(|&area| vec3::normalized(area)).collect();
        let used = mesh.triangles.iter().flatten().map(|&v| mesh.vertices[v as usize]);
        let bounds = bounds(used).filter(|_| normals.iter().any(Option::is_some));
        let Some([low, high]) = bounds else {
            return Err(CompareFeaturesError::NoSurface { faces: mesh.triangles.len() });
        };
        let (faces, face_of) = faces(&mesh, &areas, &normals)?;
        let sharp = Creases::new(&mesh, params.sharp_angle)?;
        let nearly_sharp = Creases::new(&mesh, LENIENCE * params.sharp_angle)?;
        Ok(Self { diagonal: vec3::distance(low, high), mesh, normals, faces, face_of, sharp, nearly_sharp })
    }
}

/// The mesh with vertices at equal positions made one.
fn welded(mesh: &Mesh) -> Mesh {
    let mut numbers: FxHashMap<[u64; 3], u32> = FxHashMap::default();
    let mut vertices = Vec::new();
    let mut number_of = Vec::with_capacity(mesh.vertices.len());
    for vertex in &mesh.vertices {
        // Adding zero makes -0 the same as 0.
        let number = *numbers.entry(vertex.map(|c| (c + 0.0).to_bits())).or_insert_with(|| {
            vertices.push(*vertex);
            vertices.len() as u32 - 1
        });
        number_of.push(number);
    }
    let triangles = mesh.triangles.iter().map(|t| t.map(|v| number_of[v as usize])).collect();
    Mesh { vertices, triangles, ..Mesh::default() }
}

/// The box around positions.
pub(super) fn bounds(mut positions: impl Iterator<Item = Vec3>) -> Option<[Vec3; 2]> {
    let first = positions.next()?;
    Some(positions.fold([first; 2], |[low, high], p| [vec3::min(low, p), vec3::max(high, p)]))
}

/// The angle between two directions, in radians. Accurate where the cosine is flat.
pub(super) fn angle_between(a: Vec3, b: Vec3) -> f64 {
    vec3::norm(vec3::cross(a, b)).atan2(vec3::dot(a, b))
}

/// The faces, by falling area of their seeds, and the face of each triangle.
fn faces(mesh: &Mesh, areas: &[Vec3], normals: &[Option<Vec3>]) -> Result<(Vec<Face>, Vec<Option<usize>>), MeshError> {
    let mut neighbours = vec![Vec::new(); mesh.triangles.len()];
    for edge in Edges::new(mesh)?.iter() {
        let around: Vec<usize> = edge.corners().map(|corner| corner as usize / 3).collect();
        for &t in &around {
            neighbours[t].extend(around.iter().copied().filter(|&other| other != t));
        }
    }
    let mut seeds: Vec<usize> = (0..mesh.triangles.len()).filter(|&t| normals[t].is_some()).collect();
    seeds.sort_by(|&a, &b| vec3::norm(areas[b]).total_cmp(&vec3::norm(areas[a])).then(a.cmp(&b)));
    let mut face_of: Vec<Option<usize>> = vec![None; mesh.triangles.len()];
    let mut faces = Vec::new();
    for seed in seeds {
        let Some(normal) = normals[seed].filter(|_| face_of[seed].is_none()) else {
            continue;
        };
        face_of[seed] = Some(faces.len());
        let (mut triangles, mut next) = (vec![seed], 0);
        while let Some(&t) = triangles.get(next) {
            next += 1;
            for &beside in &neighbours[t] {
                let same = normals[beside].is_some_and(|n| angle_between(normal, n) <= SAME_FACE);
                if same && face_of[beside].is_none() {
                    face_of[beside] = Some(faces.len());
                    triangles.push(beside);
                }
            }
        }
        triangles.sort_unstable();
        faces.push(Face::new(mesh, areas, normal, triangles));
    }
    Ok((faces, face_of))
}

impl Face {
    fn new(mesh: &Mesh, areas: &[Vec3], seed_normal: Vec3, triangles: Vec<usize>) -> Self {
        let corners = |t: usize| mesh.triangles[t].map(|v| mesh.vertices[v as usize]);
        let (mut area, mut weighted, mut sum) = (0.0, [0.0; 3], [0.0; 3]);
        let first = corners(triangles[0])[0];
        for &t in &triangles {
            let size = vec3::norm(areas[t]);
            area += size;
            sum = vec3::add(sum, areas[t]);
            for corner in corners(t) {
                weighted = vec3::add_scaled(weighted, vec3::sub(corner, first), size / 3.0);
            }
        }
        let centre = vec3::add_scaled(first, weighted, 1.0 / area);
        let bounds = bounds(triangles.iter().flat_map(|&t| corners(t))).unwrap_or([first; 2]);
        Self { triangles, normal: vec3::normalized(sum).unwrap_or(seed_normal), area, centre, bounds }
    }
}

impl Creases {
    fn new(mesh: &Mesh, angle: f64) -> Result<Self, MeshError> {
        let edges = crease_edges(mesh, angle)?;
        let segments = edges.iter().map(|c| c.vertices.map(|v| mesh.vertices[v as usize])).collect();
        let mut at_vertex: Vec<Vec<usize>> = vec![Vec::new(); mesh.vertices.len()];
        for (i, crease) in edges.iter().enumerate() {
            crease.vertices.iter().for_each(|&v| at_vertex[v as usize].push(i));
        }
        let corners = (0..).zip(at_vertex).filter_map(|(vertex, creases)| {
            let position = mesh.vertices[vertex as usize];
            let away = |crease: usize| {
                let [low, high] = edges[crease].vertices;
                vec3::sub(mesh.vertices[if low == vertex { high } else { low } as usize], position)
            };
            let turns = |a: usize, b: usize| angle_between(vec3::scale(away(a), -1.0), away(b)) > CORNER_TURN;
            let is_corner = match creases[..] {
                [] | [_] => false,
                [a, b] => turns(a, b),
                _ => true,
            };
            let kind = kind_of(creases.iter().map(|&i| edges[i].kind()));
            is_corner.then_some(TrueCorner { vertex, position, creases, kind })
        });
        let corners = corners.collect();
        Ok(Self { corners, segments, edges })
    }
}

/// The kind of a corner where edges of these kinds meet.
fn kind_of(mut kinds: impl Iterator<Item = FeatureKind>) -> FeatureKind {
    let first = kinds.next().unwrap_or(FeatureKind::Unknown);
    kinds.fold(first, |all, kind| match (all, kind) {
        (FeatureKind::Unknown, _) | (_, FeatureKind::Unknown) => FeatureKind::Unknown,
        (all, kind) if all == kind => all,
        _ => FeatureKind::Mixed,
    })
}

impl Crease {
    /// Which way the surface bends.
    pub(super) fn kind(&self) -> FeatureKind {
        match self.sides.and_then(|sides| sides.convex) {
            Some(true) => FeatureKind::Convex,
            Some(false) => FeatureKind::Concave,
            None => FeatureKind::Unknown,
        }
    }
}
