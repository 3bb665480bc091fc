//! Sheets of curved parts: beside a crease each is carried on from where F is not rounded.

use nalgebra::{Matrix6, Vector6};
use rayon::prelude::*;

use super::Known;
use super::sheets::{CREASE, Candidate, DISAGREEMENT, FACING, Sheet};
use super::stars::Stars;
use crate::feature::Flat;
use crate::mesh::Mesh;
use crate::spatial::PointTree;
use crate::vec3::{self, Vec3};

/// Rounds in which normals are averaged.
const ROUNDS: usize = 12;
/// Neighbours whose normals differ by more than this, in radians, are of two sides.
const EDGE: f64 = 0.25;
/// F is rounded so near a crease, in cells.
const ROUNDED: f64 = 1.0;
/// Vertices so near a crease choose their sheet anew, in cells.
const NEAR: f64 = 1.8;
/// How far a sheet looks for vertices of its side, in cells.
const REACH: f64 = 5.0;
/// Points this near to a vertex, in cells, belong to it.
const HOSTED: f64 = 1.5;
/// How far a sheet looks for points of its side, in cells.
const POINTS: f64 = 4.0;
/// Vertices of one side have normals within this cosine: 30 degrees.
const ALIKE: f64 = 0.866;
/// The farthest that a vertex goes to its sheet, in cells.
const HIGHEST: f64 = 1.7;
/// The most curved sides that a vertex chooses from.
const MOST: usize = 2;
/// Rounds in which vertices near creases look at the choice of their neighbours.
const ROUNDS_OF_CHOICE: usize = 3;
/// The fewest vertices that carry a sheet.
const LEAST: usize = 12;

/// The sheets of all vertices, where curved parts may have creases.
///
/// `planes` is what the vertices agreed on; `own` gives the planes that a vertex chooses from.
pub(super) fn sheets(
    mesh: &Mesh,
    stars: &Stars,
    normals: &[Vec3],
    planes: &[Option<u32>],
    own: impl Fn(u32) -> Vec<Candidate> + Sync,
    known: &Known,
) -> Vec<Sheet> {
    let sides = Sides::new(mesh, stars, normals, planes, known);
    let flat_of = |i: u32| known.facets.flats[i as usize];
    let mut sheets: Vec<Sheet> = (0..planes.len())
        .into_par_iter()
        .map(|v| match planes[v] {
            Some(i) => Sheet { plane: Some(i), is_flat: true, flat: flat_of(i) },
            None => Sheet { plane: None, is_flat: false, flat: Flat::through(sides.normals[v], mesh.vertices[v]) },
        })
        .collect();
    let choices: Vec<(u32, Vec<Choice>)> = sides
        .near
        .par_iter()
        .map(|&v| {
            let on_planes = own(v).into_iter().filter_map(|candidate| {
                let sheet = Sheet { plane: candidate.plane, is_flat: true, flat: flat_of(candidate.plane?) };
                Some(Choice { sheet, cost: candidate.cost })
            });
            (v, on_planes.chain(sides.around(v)).collect())
        })
        .collect();
    for round in 0..=ROUNDS_OF_CHOICE {
        let chosen: Vec<Option<Sheet>> = choices
            .par_iter()
            .map(|(v, choices)| {
                let around = stars.around(*v);
                let cost = |choice: &Choice| {
                    let others = around.iter().filter(|&&u| choice.sheet.meets(&sheets[u as usize])).count();
                    // At first neighbours are where F is, and say nothing.
                    let weight = if round == 0 { 0.0 } else { DISAGREEMENT };
                    choice.cost + weight * others as f64 / around.len().max(1) as f64
                };
                choices.iter().min_by(|a, b| cost(a).total_cmp(&cost(b))).map(|choice| choice.sheet)
            })
            .collect();
        for ((v, _), sheet) in choices.iter().zip(chosen) {
            if let Some(sheet) = sheet {
                sheets[*v as usize] = sheet;
            }
        }
    }
    sheets
}

/// A sheet that a vertex near a crease may belong to, and what that costs, in squared cells.
struct Choice {
    sheet: Sheet,
    cost: f64,
}

/// The smooth parts beside the creases.
struct Sides<'a> {
    mesh: &'a Mesh,
    known: &'a Known<'a>,
    /// The normals of the vertices, averaged along the surface but not across creases.
    normals: Vec<Vec3>,
    /// The vertices that have a crease with a curved part near.
    near: Vec<u32>,
    /// Vertices on curved parts where F is not rounded.
    clean: Vec<u32>,
    tree: PointTree,
    /// Points nearest to these vertices.
    points: PointTree,
    /// The vertices that they are nearest to.
    hosts: Vec<u32>,
    positions: Vec<Vec3>,
}

impl<'a> Sides<'a> {
    fn new(mesh: &'a Mesh, stars: &Stars, normals: &[Vec3], planes: &[Option<u32>], known: &'a Known<'a>) -> Self {
        let normals = filtered(stars, normals, planes, known);
        let vertices = &mesh.vertices;
        let normals_of = &normals;
        let middles: Vec<Vec3> = (0..vertices.len() as u32)
            .into_par_iter()
            .flat_map_iter(|v| {
                let (own, on_plane) = (normals_of[v as usize], planes[v as usize].is_some());
                let around = stars.around(v).iter().copied();
                around
                    .filter(move |&u| !(on_plane && planes[u as usize].is_some()))
                    .filter(move |&u| vec3::dot(own, normals_of[u as usize]) < CREASE)
                    .map(move |u| vec3::lerp(vertices[v as usize], vertices[u as usize], 0.5))
            })
            .collect();
        let creases = PointTree::new(&middles);
        let distance: Vec<f64> = vertices
            .par_iter()
            .map(|&p| creases.nearest_within(p, NEAR * known.cell))
            .map(|nearest| nearest.map_or(f64::INFINITY, |n| n.distance_squared.sqrt() / known.cell))
            .collect();
        let all = 0..vertices.len() as u32;
        let near = all.clone().filter(|&v| distance[v as usize] <= NEAR).collect();
        let clean: Vec<u32> = all.filter(|&v| planes[v as usize].is_none() && distance[v as usize] > ROUNDED).collect();
        let tree = PointTree::new(&clean.iter().map(|&v| vertices[v as usize]).collect::<Vec<_>>());
        let host = |&q: &Vec3| tree.nearest_within(q, HOSTED * known.cell).map(|n| (q, clean[n.index]));
        let hosted: Vec<Option<(Vec3, u32)>> = known.positions.par_iter().map(host).collect();
        let (positions, hosts): (Vec<Vec3>, Vec<u32>) = hosted.into_iter().flatten().unzip();
        Self { mesh, known, normals, near, clean, tree, points: PointTree::new(&positions), hosts, positions }
    }

    /// The curved sides around a vertex.
    fn around(&self, v: u32) -> Vec<Choice> {
        let (p, cell) = (self.mesh.vertices[v as usize], self.known.cell);
        let mut rest: Vec<(f64, u32)> = Vec::new();
        self.tree.visit_within(p, REACH * cell, |i| {
            let u = self.clean[i];
            rest.push((vec3::distance_squared(self.mesh.vertices[u as usize], p), u));
        });
        rest.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let mut sides = Vec::new();
        for _ in 0..MOST {
            let Some(&(distance_squared, first)) = rest.first() else { break };
            let normal = self.normals[first as usize];
            let (own, others): (Vec<_>, Vec<_>) =
                rest.iter().partition(|(_, u)| vec3::dot(self.normals[*u as usize], normal) > ALIKE);
            rest = others;
            if own.len() < LEAST || vec3::dot(normal, self.normals[v as usize]) < FACING {
                continue;
            }
            let mean = own.iter().fold([0.0; 3], |sum, (_, u)| vec3::add(sum, self.normals[*u as usize]));
            let Some(mean) = vec3::normalized(mean) else { continue };
            let positions: Vec<Vec3> = own.iter().map(|(_, u)| self.mesh.vertices[*u as usize]).collect();
            let Some(quadric) = Quadric::new(p, mean, &positions, cell) else { continue };
            let flat = quadric.shifted(self.mean_offset(&quadric, normal));
            if let Some(flat) = flat {
                let beyond = (distance_squared.sqrt() / cell - NEAR).max(0.0);
                let cost = (flat.distance(p) / cell).powi(2) + beyond * beyond;
                sides.push(Choice { sheet: Sheet { plane: None, is_flat: false, flat }, cost });
            }
        }
        sides
    }

    /// How far the points of a side lie outside of its quadric, on average, in cells.
    fn mean_offset(&self, quadric: &Quadric, normal: Vec3) -> f64 {
        let mut own: Vec<usize> = Vec::new();
        self.points.visit_within(quadric.origin, POINTS * self.known.cell, |i| own.push(i));
        own.retain(|&i| vec3::dot(self.normals[self.hosts[i] as usize], normal) > ALIKE);
        own.sort_unstable();
        if own.len() < LEAST {
            return 0.0;
        }
        let sum: f64 = own.iter().map(|&i| quadric.offset(self.positions[i]).clamp(-1.0, 1.0)).sum();
        sum / own.len() as f64
    }
}

/// The normals of the vertices, averaged along the surface but not across creases. Those of planes are given.
fn filtered(stars: &Stars, start: &[Vec3], planes: &[Option<u32>], known: &Known) -> Vec<Vec3> {
    let given = |v: usize| planes[v].map_or(start[v], |i| known.facets.flats[i as usize].normal);
    let mut normals: Vec<Vec3> = (0..start.len()).map(given).collect();
    let loose: Vec<u32> = (0..start.len() as u32).filter(|&v| planes[v as usize].is_none()).collect();
    for _ in 0..ROUNDS {
        let next: Vec<Vec3> = loose
            .par_iter()
            .map(|&v| {
                let own = normals[v as usize];
                let sum = stars.around(v).iter().fold(own, |sum, &u| {
                    let other = normals[u as usize];
                    let excess = 1.0 + vec3::distance_squared(own, other) / (EDGE * EDGE);
                    vec3::add_scaled(sum, other, 1.0 / (excess * excess))
                });
                vec3::normalized(sum).unwrap_or(own)
            })
            .collect();
        loose.iter().zip(next).for_each(|(&v, normal)| normals[v as usize] = normal);
    }
    normals
}

/// A quadric as a height over a plane.
struct Quadric {
    origin: Vec3,
    axes: [Vec3; 2],
    normal: Vec3,
    cell: f64,
    /// Of 1, x, y, x x, x y, y y, in cells.
    coefficients: Vector6<f64>,
}

impl Quadric {
    /// The quadric of some positions near `p`, as a height over the plane across `normal`.
    fn new(p: Vec3, normal: Vec3, side: &[Vec3], cell: f64) -> Option<Self> {
        let mut quadric =
            Self { origin: p, axes: vec3::axes_across(normal), normal, cell, coefficients: Vector6::zeros() };
        let (mut a, mut b) = (Matrix6::zeros(), Vector6::zeros());
        for q in side {
            let (row, height) = quadric.row(*q);
            let weight = 1.0 / (1.0 + row[1] * row[1] + row[2] * row[2] + height * height);
            a += weight * row * row.transpose();
            b += weight * height * row;
        }
        // Curvature is held back, so that a narrow strip of vertices does not bend its sheet at will.
        let trace = a[(0, 0)];
        (3..6).for_each(|k| a[(k, k)] += 0.02 * trace);
        (1..3).for_each(|k| a[(k, k)] += 0.001 * trace);
        quadric.coefficients = a.cholesky()?.solve(&b);
        Some(quadric)
    }

    /// The terms at a position, and its height.
    fn row(&self, q: Vec3) -> (Vector6<f64>, f64) {
        let step = vec3::scale(vec3::sub(q, self.origin), 1.0 / self.cell);
        let [x, y] = self.axes.map(|axis| vec3::dot(axis, step));
        (Vector6::new(1.0, x, y, x * x, x * y, y * y), vec3::dot(self.normal, step))
    }

    /// How far a position is above the quadric, in cells.
    fn offset(&self, q: Vec3) -> f64 {
        let (row, height) = self.row(q);
        height - row.dot(&self.coefficients)
    }

    /// The tangent plane beside the origin of the quadric moved up by some cells, unless that is far off.
    fn shifted(&self, offset: f64) -> Option<Flat> {
        let (height, slope) = (self.coefficients[0] + offset, [self.coefficients[1], self.coefficients[2]]);
        if height.abs() > HIGHEST || slope[0].hypot(slope[1]) > 0.7 {
            return None;
        }
        let lean = vec3::add(vec3::scale(self.axes[0], slope[0]), vec3::scale(self.axes[1], slope[1]));
        let position = vec3::add_scaled(self.origin, self.normal, height * self.cell);
        Some(Flat::through(vec3::normalized(vec3::sub(self.normal, lean))?, position))
    }
}
