//! Surfaces in meshes of tetrahedra, which need not come from a lattice.

use super::{coincident, field_of, replaced, sound, sphere, torus};
use crate::contour::{
    Candidates, ContourError, ContourParams, LeastCurvature, Nodes, Norm, Placement, contour, contour_tetrahedra,
};
use crate::domain::SimplicialMesh;
use crate::field::LatticeField;
use crate::mesh::Mesh;
use crate::sample::Chance;
use std::collections::BTreeSet;

const LEAST_CURVATURE: ContourParams = ContourParams {
    placement: Placement::LeastCurvature(LeastCurvature {
        candidates: Candidates::Tetrahedron,
        norm: Norm::TimesArea,
        divisions: 7,
        most_sweeps: 4,
        halvings: 2,
    }),
};

/// The Delaunay mesh of the corners of the cube -1..1 and of random sites in it.
fn delaunay(seed: u64, sites: usize) -> SimplicialMesh<3> {
    let mut chance = Chance::new(seed, 104, 0);
    let corner = |bits: usize| std::array::from_fn(|a| if bits >> a & 1 == 1 { 1.0 } else { -1.0 });
    let mut random = || std::array::from_fn(|_| chance.between(-1.0, 1.0));
    let sites: Vec<[f64; 3]> = (0..8).map(corner).chain((0..sites).map(|_| random())).collect();
    SimplicialMesh::<3>::delaunay(&sites).unwrap()
}

/// Asserts that the vertices lie inside the active tetrahedra, one in each, in their order.
fn assert_inside(mesh: &SimplicialMesh<3>, marks: &[bool], surface: &Mesh) {
    let mut vertices = surface.vertices.iter();
    for s in 0..mesh.len() {
        let inside = mesh.simplex(s).iter().filter(|&&n| marks[n as usize]).count();
        if inside % 4 != 0 {
            let weights = mesh.barycentric(s, *vertices.next().unwrap());
            assert!(weights.iter().all(|&w| w > 0.0), "{weights:?}");
        }
    }
    assert!(vertices.next().is_none());
}

#[test]
fn random_marks_on_random_meshes_make_manifolds() {
    for seed in 0..12 {
        let mesh = delaunay(seed, 20 + 40 * seed as usize);
        let mut chance = Chance::new(seed, 105, 0);
        let share = chance.between(0.2, 0.8);
        let mut marks: Vec<bool> = mesh.vertices().iter().map(|_| chance.uniform() < share).collect();
        for params in [ContourParams::default(), LEAST_CURVATURE] {
            let (surface, _) = contour_tetrahedra(&mesh, Nodes::Marks(&marks), &params).unwrap();
            sound(&surface, "marks up to the boundary");
        }
        mesh.rim().iter().for_each(|&n| marks[n as usize] = false);
        for params in [ContourParams::default(), LEAST_CURVATURE] {
            let (surface, report) = contour_tetrahedra(&mesh, Nodes::Marks(&marks), &params).unwrap();
            let t = sound(&surface, "unmarked boundary");
            assert!(t.closed, "seed {seed}");
            assert!(t.volume.is_none_or(|v| v > 0.0), "what is marked lies inside");
            assert_eq!((report.split_vertices, report.active_tetrahedra), (0, surface.vertices.len()));
            assert_eq!(coincident(&surface), 0);
            assert_inside(&mesh, &marks, &surface);
        }
    }
}

#[test]
fn shapes_in_a_random_mesh_have_their_genus() {
    let mesh = delaunay(5, 6000);
    for (what, f, genus) in [("sphere", sphere as super::Function, 0), ("torus", torus, 1)] {
        let values: Vec<f64> = mesh.vertices().iter().map(|&p| f(p)).collect();
        let marks: Vec<bool> = values.iter().map(|&v| v < 0.0).collect();
        for nodes in [Nodes::Values(&values), Nodes::Marks(&marks)] {
            let (surface, _) = contour_tetrahedra(&mesh, nodes, &ContourParams::default()).unwrap();
            let t = sound(&surface, what);
            assert!(t.closed && t.components.len() == 1, "{what}");
            assert_eq!(t.genus, Some(genus), "{what}");
        }
    }
}

/// The mesh of the lattice of a field, and that of the same lattice as tetrahedra, each as triangles of places; a place is in 1e-7 of a
/// cell. Positions differ by rounding, of sums taken in another order: far less than that, and vertices lie farther apart.
fn both_ways(field: &LatticeField) -> [BTreeSet<[[i64; 3]; 3]>; 2] {
    let (implicit, report) = contour(field, |_| true);
    let lattice = &field.lattice;
    let nodes = lattice.nodes_at(lattice.finest);
    let far = lattice.position(lattice.finest, nodes.map(|n| f64::from(n - 1)));
    let mesh = SimplicialMesh::<3>::lattice(lattice.origin, far, nodes.map(|n| n - 1)).unwrap();
    let place = |i: u32| [i % nodes[0], i / nodes[0] % nodes[1], i / nodes[0] / nodes[1]];
    let count = nodes.iter().product();
    let values: Vec<f64> = (0..count).map(|i| f64::from(field.node(place(i)).unwrap())).collect();
    let (explicit, same) = contour_tetrahedra(&mesh, Nodes::Values(&values), &ContourParams::default()).unwrap();
    assert_eq!(same, report);
    [implicit, explicit].map(|mesh| {
        let key = |v: u32| mesh.vertices[v as usize].map(|c| (c / lattice.spacing * 1e7).round() as i64);
        let turned = |[a, b, c]: [[i64; 3]; 3]| [[a, b, c], [b, c, a], [c, a, b]].into_iter().min().unwrap();
        let triangles: BTreeSet<_> = mesh.triangles.iter().map(|t| turned(t.map(key))).collect();
        assert_eq!(triangles.len(), mesh.triangles.len());
        triangles
    })
}

#[test]
fn a_lattice_gives_the_same_mesh_as_the_tetrahedra_it_stands_for() {
    let waves = |[x, y, z]: [f64; 3]| (4.1 * x).sin() * (3.7 * y).cos() + (4.3 * y).sin() * (3.9 * z).cos() + 0.1 * x;
    let smooth = field_of(16.0, |p| waves(p) + 0.0173);
    let mut random = field_of(10.0, sphere);
    let mut chance = Chance::new(3, 106, 0);
    replaced(&mut random, || chance.normal() as f32);
    for field in [smooth, random] {
        let [implicit, explicit] = both_ways(&field);
        assert!(implicit.len() > 3000 && implicit.len() == explicit.len(), "{}", implicit.len());
        let vertices = [&implicit, &explicit].map(|mesh| mesh.iter().flatten().collect::<BTreeSet<_>>());
        assert_eq!(vertices[0].symmetric_difference(&vertices[1]).count(), 0);
        // Some polygons have two cuts that are equally good but for rounding.
        let apart = implicit.difference(&explicit).count();
        assert!(apart * 200 < implicit.len(), "{apart} of {}", implicit.len());
    }
}

#[test]
fn what_is_not_valid_is_refused() {
    let mesh = delaunay(1, 10);
    let none = ContourParams::default();
    let nodes = mesh.vertices().len();
    let refused = contour_tetrahedra(&mesh, Nodes::Marks(&[true]), &none).unwrap_err();
    assert_eq!(refused, ContourError::Count { given: 1, nodes });
    let mut values = vec![1.0; nodes];
    values[7] = f64::INFINITY;
    let refused = contour_tetrahedra(&mesh, Nodes::Values(&values), &none).unwrap_err();
    assert_eq!(refused, ContourError::NotFinite { node: 7, value: f64::INFINITY });

    // Two tetrahedra that share an edge and nothing else.
    let vertices =
        vec![[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, -1.0, 0.0]];
    let pinched = SimplicialMesh::<3>::from_tetrahedra(vertices, &[[0, 1, 2, 3], [0, 1, 4, 5]]).unwrap();
    let refused = contour_tetrahedra(&pinched, Nodes::Marks(&[false; 6]), &none).unwrap_err();
    assert_eq!(refused, ContourError::PinchedEdge { edge: [0, 1] });
}

#[test]
fn marks_of_one_kind_make_nothing() {
    let mesh = delaunay(2, 10);
    let marks = vec![true; mesh.vertices().len()];
    let (surface, report) = contour_tetrahedra(&mesh, Nodes::Marks(&marks), &LEAST_CURVATURE).unwrap();
    assert!(surface.vertices.is_empty() && surface.triangles.is_empty());
    assert_eq!(report.active_tetrahedra, 0);
}
