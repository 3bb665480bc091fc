//! Sheets of curved parts: beside a crease each is carried on from where F is not rounded.

use nalgebra::{Matrix6, Vector6};
use rayon::prelude::*;

use super::Known;
use super::sheets::{CREASE, Candidate, FACING, Sheet};
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
const REACH: f64 = 3.0;
/// Vertices of one side have normals within this cosine: 30 degrees.
const ALIKE: f64 = 0.866;
/// The farthest that a vertex goes to its sheet, in cells.
const HIGHEST: f64 = 1.7;
/// The most curved sides that a vertex chooses from.
const MOST: usize = 2;
/// The fewest vertices that carry a sheet.
const LEAST: usize = 12;

/// The smooth parts beside the creases.
pub(super) struct Sides<'a> {
    mesh: &'a Mesh,
    known: &'a Known<'a>,
    /// The normals of the vertices, averaged along the surface but not across creases.
    pub(super) normals: Vec<Vec3>,
    /// Whether a crease is near.
    near: Vec<bool>,
    /// Vertices on curved parts where F is not rounded.
    clean: Vec<u32>,
    tree: PointTree,
}

impl<'a> Sides<'a> {
    pub(super) fn new(
        mesh: &'a Mesh,
        stars: &Stars,
        normals: &[Vec3],
        planes: &[Option<u32>],
        known: &'a Known<'a>,
    ) -> Self {
        let normals = filtered(stars, normals, planes, known);
        let vertices = &mesh.vertices;
        let normals_of = &normals;
        let middles: Vec<Vec3> = (0..vertices.len())
            .into_par_iter()
            .flat_map_iter(|v| {
                stars
                    .around(v)
                    .iter()
                    .filter(|_| known.curved_creases)
                    .filter(move |&&u| vec3::dot(normals_of[v], normals_of[u as usize]) < CREASE)
                    .filter(move |&&u| planes[v].is_none() || planes[u as usize].is_none())
                    .map(move |&u| vec3::lerp(vertices[v], vertices[u as usize], 0.5))
            })
            .collect();
        let creases = PointTree::new(&middles);
        let distance: Vec<Option<f64>> = vertices
            .par_iter()
            .map(|&p| creases.nearest_within(p, NEAR * known.cell).map(|n| n.distance_squared.sqrt() / known.cell))
            .collect();
        let is_clean = |v: &u32| planes[*v as usize].is_none() && distance[*v as usize].is_none_or(|d| d > ROUNDED);
        let clean: Vec<u32> = (0..vertices.len() as u32).filter(is_clean).collect();
        let tree = PointTree::new(&clean.iter().map(|&v| vertices[v as usize]).collect::<Vec<_>>());
        let near = distance.iter().map(Option::is_some).collect();
        Self { mesh, known, normals, near, clean, tree }
    }

    /// The nearest sheet of a vertex that has a crease with a curved part near: one of its planes, or a curved side.
    pub(super) fn best(&self, v: usize, candidates: &[Candidate], plane: Option<u32>) -> Option<Sheet> {
        if !self.near[v] {
            return None;
        }
        let (p, cell) = (self.mesh.vertices[v], self.known.cell);
        let on_planes = candidates.iter().filter_map(|candidate| {
            let flat = self.known.facets.flats[candidate.plane? as usize];
            Some((candidate.cost, Sheet { plane: candidate.plane, flat, position: flat.foot(p), creased: true }))
        });
        let curved = self.around(v).into_iter().map(|(flat, position, beyond)| {
            let cost = vec3::distance_squared(p, position) / (cell * cell) + beyond * beyond;
            (cost, Sheet { plane: None, flat, position, creased: true })
        });
        // Of equals the plane, and the one that the neighbours agreed on.
        let mut all: Vec<(f64, Sheet)> = on_planes.chain(curved).collect();
        all.sort_by(|a, b| a.0.total_cmp(&b.0).then((b.1.plane == plane).cmp(&(a.1.plane == plane))));
        all.first().map(|(_, sheet)| *sheet)
    }

    /// The curved sides around a vertex that has a crease with one near.
    pub(super) fn flats(&self, v: usize) -> Vec<Flat> {
        if self.near[v] { self.around(v).into_iter().map(|(flat, ..)| flat).collect() } else { Vec::new() }
    }

    /// The curved sides around a vertex: tangent plane, position, and how far beyond their reach it is, in cells.
    fn around(&self, v: usize) -> Vec<(Flat, Vec3, f64)> {
        let (p, cell) = (self.mesh.vertices[v], self.known.cell);
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
            if own.len() < LEAST || vec3::dot(normal, self.normals[v]) < FACING {
                continue;
            }
            let mean = own.iter().fold([0.0; 3], |sum, (_, u)| vec3::add(sum, self.normals[*u as usize]));
            let Some(mean) = vec3::normalized(mean) else { continue };
            let positions: Vec<Vec3> = own.iter().map(|(_, u)| self.mesh.vertices[*u as usize]).collect();
            if let Some((position, flat)) = carried_on(p, mean, &positions, cell) {
                let beyond = (distance_squared.sqrt() / cell - NEAR).max(0.0);
                sides.push((flat, position, beyond));
            }
        }
        sides
    }
}

/// The normals of the vertices, averaged along the surface but not across creases. Those of planes are given.
fn filtered(stars: &Stars, start: &[Vec3], planes: &[Option<u32>], known: &Known) -> Vec<Vec3> {
    let given = |v: usize| planes[v].map(|i| known.facets.flats[i as usize].normal);
    let mut normals: Vec<Vec3> = (0..start.len()).map(|v| given(v).unwrap_or(start[v])).collect();
    for _ in 0..ROUNDS {
        normals = (0..start.len())
            .into_par_iter()
            .map(|v| {
                let own = normals[v];
                if planes[v].is_some() {
                    return own;
                }
                let sum = stars.around(v).iter().fold(own, |sum, &u| {
                    let other = normals[u as usize];
                    let excess = 1.0 + vec3::distance_squared(own, other) / (EDGE * EDGE);
                    vec3::add_scaled(sum, other, 1.0 / (excess * excess))
                });
                vec3::normalized(sum).unwrap_or(own)
            })
            .collect();
    }
    normals
}

/// The quadric of some positions near `p`, as a height over the plane across `normal`: its position beside p, and its tangent plane there.
fn carried_on(p: Vec3, normal: Vec3, side: &[Vec3], cell: f64) -> Option<(Vec3, Flat)> {
    let axes = vec3::axes_across(normal);
    let (mut a, mut b) = (Matrix6::zeros(), Vector6::zeros());
    for q in side {
        let step = vec3::scale(vec3::sub(*q, p), 1.0 / cell);
        let [x, y] = axes.map(|axis| vec3::dot(axis, step));
        let z = vec3::dot(normal, step);
        let weight = 1.0 / (1.0 + vec3::norm_squared(step));
        let row = Vector6::new(1.0, x, y, x * x, x * y, y * y);
        a += weight * row * row.transpose();
        b += weight * z * row;
    }
    // Curvature is held back, so that a narrow strip of vertices does not bend its sheet at will.
    let trace = a[(0, 0)];
    (3..6).for_each(|k| a[(k, k)] += 0.02 * trace);
    (1..3).for_each(|k| a[(k, k)] += 0.001 * trace);
    let solution = a.cholesky()?.solve(&b);
    let (height, slope) = (solution[0], [solution[1], solution[2]]);
    if height.abs() > HIGHEST || slope[0].hypot(slope[1]) > 0.7 {
        return None;
    }
    let tilted = vec3::sub(normal, vec3::add(vec3::scale(axes[0], slope[0]), vec3::scale(axes[1], slope[1])));
    let position = vec3::add_scaled(p, normal, height * cell);
    Some((position, Flat::through(vec3::normalized(tilted)?, position)))
}
