//! The extraction on functions that are known, and on signs that no surface ever had.

mod placement;
mod tetrahedra;

use super::contour;
use crate::domain::{Blocks, Lattice, mask_get};
use crate::field::LatticeField;
use crate::mesh::{Mesh, Topology, topology};
use crate::sample::Chance;
use crate::vec3;

/// F sampled at every node of the lattice with `cells` cells over the cube -1..1 and its padding.
pub(in crate::contour) fn field_of(cells: f64, f: impl Fn([f64; 3]) -> f64) -> LatticeField {
    let lattice = Lattice::around([-1.0; 3], [1.0; 3], 2.0 / cells, 0.1).unwrap();
    let blocks = Blocks::dense(lattice.blocks_at(lattice.finest));
    let mut values = Vec::with_capacity(blocks.len() * 512);
    for c in &blocks.coordinates {
        for local in 0..512_u32 {
            let node = [local & 7, local >> 3 & 7, local >> 6];
            let node = std::array::from_fn(|a| f64::from(8 * c[a] + node[a]));
            values.push(f(lattice.position(lattice.finest, node)) as f32);
        }
    }
    let known = vec![[u64::MAX; 8]; blocks.len()];
    LatticeField::new(lattice, blocks, known, values)
}

/// The values of a field replaced, node by node, but for the outermost two layers, which become 1.
fn replaced(field: &mut LatticeField, mut value: impl FnMut() -> f32) {
    let extent = field.blocks.extent.map(|e| 8 * e);
    for (b, c) in field.blocks.coordinates.iter().enumerate() {
        for local in 0..512_u32 {
            let place = [local & 7, local >> 3 & 7, local >> 6];
            let inner = (0..3).all(|a| (2..extent[a] - 2).contains(&(8 * c[a] + place[a])));
            field.values[b * 512 + local as usize] = if inner { value() } else { 1.0 };
        }
    }
}

/// What the module page guarantees of every mesh; the topology for further questions.
fn sound(mesh: &Mesh, what: &str) -> Topology {
    let t = topology(mesh).unwrap();
    assert_eq!(
        (t.nonmanifold_edges, t.nonmanifold_vertices, t.inconsistent_edges),
        (0, 0, 0),
        "{what}: edges, vertices, orientation"
    );
    assert_eq!((t.duplicate_triangles, t.degenerate_triangles, t.unused_vertices), (0, 0, 0), "{what}");
    t
}

fn coincident(mesh: &Mesh) -> usize {
    let mut places: Vec<[u64; 3]> = mesh.vertices.iter().map(|v| v.map(f64::to_bits)).collect();
    places.sort_unstable();
    places.windows(2).filter(|w| w[0] == w[1]).count()
}

type Function = fn([f64; 3]) -> f64;

fn sphere(p: [f64; 3]) -> f64 {
    vec3::norm(vec3::sub(p, [0.013, -0.027, 0.041])) - 0.8
}

fn torus(p: [f64; 3]) -> f64 {
    ((p[0].hypot(p[1]) - 0.6).powi(2) + p[2] * p[2]).sqrt() - 0.25
}

#[test]
fn spheres_and_tori_are_closed_and_have_their_genus_and_volume() {
    let pi = std::f64::consts::PI;
    let cases: [(&str, Function, u64, f64); 2] =
        [("sphere", sphere, 0, 4.0 / 3.0 * pi * 0.512), ("torus", torus, 1, 2.0 * pi * pi * 0.6 * 0.0625)];
    for (what, f, genus, volume) in cases {
        let (mesh, report) = contour(&field_of(40.0, f), |_| true);
        let t = sound(&mesh, what);
        assert!(t.closed && t.components.len() == 1, "{what}");
        assert_eq!(t.genus, Some(genus), "{what}");
        // Positive only if triangles face outward, where F > 0. Chords lie inside the arcs: relative to the radius r the
        // volume errs by some (h / r)^2 = 0.04 at most.
        let found = t.volume.unwrap();
        assert!((found / volume - 1.0).abs() < 0.04, "{what}: volume {found}, not {volume}");
        assert_eq!(coincident(&mesh), 0, "{what}");
        assert_eq!((report.trimmed_polygons, report.split_vertices), (0, 0));
        assert_eq!(report.active_tetrahedra, mesh.vertices.len(), "one vertex in each active tetrahedron");
    }
}

#[test]
fn the_distance_to_a_sphere_falls_with_the_square_of_the_cell() {
    let errors = [12.0, 24.0, 48.0].map(|cells| {
        let (mesh, _) = contour(&field_of(cells, sphere), |_| true);
        let square: f64 = mesh.vertices.iter().map(|&v| sphere(v).powi(2)).sum();
        (square / mesh.vertices.len() as f64).sqrt()
    });
    for pair in errors.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((1.8..2.2).contains(&order), "order {order}: {errors:?}");
    }
}

#[test]
fn a_plane_is_met_exactly_and_ends_at_the_domain() {
    let normal = vec3::normalized([0.31, -0.52, 0.8]).unwrap();
    let plane = |p: [f64; 3]| vec3::dot(normal, p) - 0.0123;
    let field = field_of(20.0, plane);
    let (mesh, _) = contour(&field, |_| true);
    let t = sound(&mesh, "plane");
    assert!(!t.closed);
    assert_eq!((t.components.len(), t.boundary_loops, t.euler_characteristic), (1, 1, 1), "a disc");
    // Crossings are kept a hundredth of an edge (at most sqrt 3 cells) from its ends.
    let far = mesh.vertices.iter().map(|&v| plane(v).abs()).fold(0.0, f64::max);
    assert!(far <= 0.018 * field.lattice.spacing, "{far}");
    for triangle in &mesh.triangles {
        let [a, b, c] = triangle.map(|v| mesh.vertices[v as usize]);
        let n = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
        assert!(vec3::dot(n, normal) > 0.0, "triangles face where F > 0");
    }
}

#[test]
fn zeros_at_nodes_leave_no_holes_and_no_coincident_vertices() {
    // At 16 cells the nodes lie at odd multiples of 1/16 (or even ones): both planes of faces are met by nodes.
    for at in [0.5, 0.5625] {
        for f in [
            |p: [f64; 3], at: f64| p.into_iter().map(f64::abs).fold(0.0, f64::max) - at,
            |p: [f64; 3], at: f64| p.into_iter().map(f64::abs).sum::<f64>() - 2.0 * at,
        ] {
            let field = field_of(16.0, |p| f(p, at));
            let (mesh, _) = contour(&field, |_| true);
            let t = sound(&mesh, "zeros");
            assert!(t.closed && t.genus == Some(0) && t.components.len() == 1, "{at}");
            assert!(t.volume.unwrap() > 0.0);
            assert_eq!(coincident(&mesh), 0);
        }
    }
    let mut field = field_of(12.0, sphere);
    for seed in 0..3 {
        let mut chance = Chance::new(seed, 100, 0);
        replaced(&mut field, || [-1.0, 0.0, -0.0, 1.0][(4.0 * chance.uniform()) as usize % 4]);
        let (mesh, _) = contour(&field, |_| true);
        assert!(sound(&mesh, "random zeros").closed);
        assert_eq!(coincident(&mesh), 0);
    }
}

#[test]
fn random_values_make_a_closed_manifold() {
    let mut field = field_of(20.0, sphere);
    for seed in 0..4 {
        let mut chance = Chance::new(seed, 101, 0);
        // Values of very different size push vertices against the faces of their tetrahedra.
        replaced(&mut field, || (chance.normal() * 10.0_f64.powf(6.0 * chance.normal())) as f32);
        let (mesh, report) = contour(&field, |_| true);
        let t = sound(&mesh, "random");
        assert!(t.closed && t.faces > 50_000, "{}", t.faces);
        assert_eq!(report.split_vertices, 0, "only a trim leaves two fans");
        assert_eq!(coincident(&mesh), 0);
    }
}

#[test]
fn trims_and_unknown_nodes_leave_a_manifold_with_boundary() {
    let mut field = field_of(16.0, sphere);
    for seed in 0..3 {
        let mut chance = Chance::new(seed, 102, 0);
        replaced(&mut field, || chance.normal() as f32);
        let keep = |p: [f64; 3]| (p[0] * 91.7).sin() + (p[1] * 57.3).sin() + (p[2] * 73.9).sin() > 0.0;
        let (mesh, report) = contour(&field, keep);
        let t = sound(&mesh, "trimmed");
        assert!(!t.closed && report.trimmed_polygons > 0 && report.split_vertices > 0, "{report:?}");

        let mut holey = field.clone();
        for word in holey.known.iter_mut().flatten() {
            // One node in sixteen is unknown.
            let draw = |chance: &mut Chance| (chance.uniform() * 2.0_f64.powi(32)) as u64;
            let mut bits = || draw(&mut chance) << 32 | draw(&mut chance);
            *word = !(bits() & bits() & bits() & bits());
        }
        let (mesh, _) = contour(&holey, |_| true);
        assert!(!sound(&mesh, "unknown nodes").closed);
    }
}

#[test]
fn nothing_is_made_of_one_sign() {
    let (mesh, report) = contour(&field_of(12.0, |_| 1.0), |_| true);
    assert!(mesh.vertices.is_empty() && mesh.triangles.is_empty());
    assert_eq!(report, super::ContourReport::default());
    let field = field_of(12.0, sphere);
    assert!(mask_get(&field.known[0], 0));
    let (mesh, _) = contour(&field, |_| false);
    assert!(mesh.vertices.is_empty() && mesh.triangles.is_empty(), "all trimmed");
}
