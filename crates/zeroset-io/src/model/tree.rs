//! Solids as lists of operands.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

use zeroset::field::Placement;
use zeroset::mesh::Mesh;
use zeroset::model::{Fitted, Solid};

use super::container::{Reader, Writer};
use super::header::{MeshHeader, Node};
use super::is_possible;
use crate::MAX_COORDINATE;

/// The deepest that operands are nested.
const DEEPEST: usize = 200;

/// What a tree of operands becomes.
#[derive(Debug, Default)]
pub(super) struct Table {
    pub(super) nodes: Vec<Node>,
    pub(super) meshes: Vec<MeshHeader>,
    pub(super) fitted: Vec<Arc<Fitted>>,
    known_meshes: Vec<Arc<Mesh>>,
    known_heights: Vec<Arc<Vec<f64>>>,
}

pub(super) fn write(solid: &Solid, arrays: &mut Writer) -> Result<Table, String> {
    let mut table = Table::default();
    table.add(solid, 1, arrays)?;
    Ok(table)
}

impl Table {
    /// Adds an operand after those that it is made of; its place.
    fn add(&mut self, solid: &Solid, depth: usize, arrays: &mut Writer) -> Result<usize, String> {
        if depth > DEEPEST {
            return Err(too_deep());
        }
        if !has_possible_numbers(solid) {
            return Err("a number of an operand is infinite, NaN or too large".to_owned());
        }
        let mut below = |solid: &Solid| self.add(solid, depth + 1, arrays);
        let node = match solid {
            Solid::HalfSpace { point, normal } => Node::HalfSpace { point: *point, normal: *normal },
            Solid::Cuboid { corners } => Node::Box { corners: *corners },
            Solid::Ball { center, radius } => Node::Ball { center: *center, radius: *radius },
            Solid::Frustum { ends, radii } => Node::Frustum { ends: *ends, radii: *radii },
            Solid::Prism { rings, heights } => Node::Prism { rings: rings.clone(), heights: *heights },
            Solid::HeightField { origin, step, count, heights } => {
                let (place, is_new) = place_of(&mut self.known_heights, heights);
                if is_new {
                    arrays.add(format!("heights/{place}"), heights);
                }
                Node::HeightField { origin: *origin, step: *step, count: *count, heights: place }
            }
            Solid::Mesh(mesh) => Node::Mesh { mesh: self.mesh(mesh, arrays)? },
            Solid::Fitted(fitted) => Node::Fitted { model: place_of(&mut self.fitted, fitted).0 },
            Solid::Union(of) => Node::Union { of: of.iter().map(below).collect::<Result<_, _>>()? },
            Solid::Intersection(of) => Node::Intersection { of: of.iter().map(below).collect::<Result<_, _>>()? },
            Solid::Difference(of) => Node::Difference { of: [below(&of[0])?, below(&of[1])?] },
            Solid::Complement(of) => Node::Complement { of: below(of)? },
            Solid::SmoothUnion { of, radius } => {
                Node::SmoothUnion { of: [below(&of[0])?, below(&of[1])?], radius: *radius }
            }
            Solid::Offset { of, distance } => Node::Offset { of: below(of)?, distance: *distance },
            Solid::Shell { of, thickness } => Node::Shell { of: below(of)?, thickness: *thickness },
            Solid::Placed { of, placement } => Node::Placed {
                of: below(of)?,
                rotation: placement.rotation(),
                scale: placement.scale(),
                shift: placement.shift(),
            },
        };
        self.nodes.push(node);
        Ok(self.nodes.len() - 1)
    }

    fn mesh(&mut self, mesh: &Arc<Mesh>, arrays: &mut Writer) -> Result<usize, String> {
        let (place, is_new) = place_of(&mut self.known_meshes, mesh);
        if is_new {
            check_mesh(place, mesh)?;
            self.meshes.push(MeshHeader { world_from_local: mesh.world_from_local });
            arrays.add(format!("meshes/{place}/vertices"), &mesh.vertices);
            arrays.add(format!("meshes/{place}/triangles"), &mesh.triangles);
        }
        Ok(place)
    }
}

/// The place of a shared value among others, and whether it is new there.
fn place_of<T>(all: &mut Vec<Arc<T>>, value: &Arc<T>) -> (usize, bool) {
    if let Some(place) = all.iter().position(|other| Arc::ptr_eq(other, value)) {
        return (place, false);
    }
    all.push(Arc::clone(value));
    (all.len() - 1, true)
}

fn too_deep() -> String {
    format!("operands are nested more than {DEEPEST} deep")
}

/// The solid of a list of operands.
pub(super) fn read(
    nodes: Vec<Node>,
    meshes: &[MeshHeader],
    fitted: &[Arc<Fitted>],
    arrays: &Reader<'_>,
) -> Result<Solid, String> {
    let meshes: Vec<Arc<Mesh>> = meshes
        .iter()
        .enumerate()
        .map(|(i, header)| read_mesh(i, header, arrays).map(Arc::new))
        .collect::<Result<_, _>>()?;
    let mut known_heights: BTreeMap<usize, Arc<Vec<f64>>> = BTreeMap::new();
    let last = nodes.len().checked_sub(1).ok_or("it has no operand")?;
    // Each operand is taken once, by a later one: so there are no cycles, and the tree is no larger than the list.
    let mut made: Vec<Option<(Solid, usize)>> = Vec::with_capacity(nodes.len());
    for (own, node) in nodes.into_iter().enumerate() {
        let mut depth = 0;
        for place in node.operands() {
            let below = made.get(place).ok_or_else(|| {
                format!("operand {own} is made of operand {place}, which does not come before it: a cycle")
            })?;
            depth = depth.max(below.as_ref().map_or(0, |(_, depth)| *depth));
        }
        if depth >= DEEPEST {
            return Err(too_deep());
        }
        let mut take = |place: usize| {
            let taken = made[place].take().ok_or_else(|| format!("operand {place} is used twice"))?;
            Ok::<Solid, String>(taken.0)
        };
        let solid = match node {
            Node::HalfSpace { point, normal } => Solid::HalfSpace { point, normal },
            Node::Box { corners } => Solid::Cuboid { corners },
            Node::Ball { center, radius } => Solid::Ball { center, radius },
            Node::Frustum { ends, radii } => Solid::Frustum { ends, radii },
            Node::Prism { rings, heights } => Solid::Prism { rings, heights },
            Node::HeightField { origin, step, count, heights } => {
                let heights = match known_heights.entry(heights) {
                    Entry::Occupied(known) => Arc::clone(known.get()),
                    Entry::Vacant(new) => {
                        Arc::clone(new.insert(Arc::new(arrays.array(&format!("heights/{heights}"))?)))
                    }
                };
                Solid::HeightField { origin, step, count, heights }
            }
            Node::Mesh { mesh } => {
                Solid::Mesh(Arc::clone(meshes.get(mesh).ok_or_else(|| format!("it has no mesh {mesh}"))?))
            }
            Node::Fitted { model } => {
                Solid::Fitted(Arc::clone(fitted.get(model).ok_or_else(|| format!("it has no model {model}"))?))
            }
            Node::Union { of } => Solid::Union(of.into_iter().map(take).collect::<Result<_, _>>()?),
            Node::Intersection { of } => Solid::Intersection(of.into_iter().map(take).collect::<Result<_, _>>()?),
            Node::Difference { of: [a, b] } => Solid::Difference(Box::new([take(a)?, take(b)?])),
            Node::Complement { of } => Solid::Complement(Box::new(take(of)?)),
            Node::SmoothUnion { of: [a, b], radius } => {
                Solid::SmoothUnion { of: Box::new([take(a)?, take(b)?]), radius }
            }
            Node::Offset { of, distance } => Solid::Offset { of: Box::new(take(of)?), distance },
            Node::Shell { of, thickness } => Solid::Shell { of: Box::new(take(of)?), thickness },
            Node::Placed { of, rotation, scale, shift } => {
                let placement = Placement::new(rotation, scale, shift);
                let placement = placement.map_err(|error| format!("operand {own}: {error}"))?;
                Solid::Placed { of: Box::new(take(of)?), placement }
            }
        };
        if !has_possible_numbers(&solid) {
            return Err(format!("a number of operand {own} is not possible"));
        }
        made.push(Some((solid, depth + 1)));
    }
    if let Some(idle) = made[..last].iter().position(Option::is_some) {
        return Err(format!("operand {idle} is used by none"));
    }
    made.pop().flatten().map(|(solid, _)| solid).ok_or_else(|| "it has no operand".to_owned())
}

fn read_mesh(i: usize, header: &MeshHeader, arrays: &Reader<'_>) -> Result<Mesh, String> {
    let vertices = arrays.array(&format!("meshes/{i}/vertices"))?;
    let triangles = arrays.array(&format!("meshes/{i}/triangles"))?;
    let mesh = Mesh { world_from_local: header.world_from_local, vertices, triangles, ..Mesh::default() };
    check_mesh(i, &mesh)?;
    Ok(mesh)
}

fn check_mesh(i: usize, mesh: &Mesh) -> Result<(), String> {
    if !mesh.vertices.iter().all(is_possible) || !is_possible(&mesh.world_from_local) {
        return Err(format!("a coordinate of mesh {i} is not possible"));
    }
    if mesh.triangles.as_flattened().iter().any(|&v| v as usize >= mesh.vertices.len()) {
        return Err(format!("a triangle of mesh {i} names a vertex that is not there"));
    }
    Ok(())
}

/// Whether the numbers of an operand itself are neither infinite, NaN, nor beyond all grids. Meshes and models are checked on their own.
fn has_possible_numbers(solid: &Solid) -> bool {
    let are = |numbers: &[f64]| numbers.iter().all(|c| c.abs() <= MAX_COORDINATE);
    match solid {
        Solid::HalfSpace { point, normal } => are(point) && are(normal),
        Solid::Cuboid { corners } => are(corners.as_flattened()),
        Solid::Ball { center, radius } => are(center) && are(&[*radius]),
        Solid::Frustum { ends, radii } => are(ends.as_flattened()) && are(radii),
        Solid::Prism { rings, heights } => rings.iter().flatten().all(|p| are(p)) && are(heights),
        Solid::HeightField { origin, step, heights, .. } => are(origin) && are(step) && are(heights),
        Solid::SmoothUnion { radius: length, .. }
        | Solid::Offset { distance: length, .. }
        | Solid::Shell { thickness: length, .. } => are(&[*length]),
        Solid::Placed { placement, .. } => are(&placement.shift()) && are(&[placement.scale()]),
        Solid::Mesh(_)
        | Solid::Fitted(_)
        | Solid::Union(_)
        | Solid::Intersection(_)
        | Solid::Difference(_)
        | Solid::Complement(_) => true,
    }
}
