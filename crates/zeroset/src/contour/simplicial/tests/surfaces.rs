//! Surfaces in space.

use super::interpolated;
use crate::basis::{Basis, Expansion, Kernel, P1, P2, Radial, Tail};
use crate::contour::{Branches, zero_surface};
use crate::domain::{Place, SimplicialMesh};
use crate::mesh::{Mesh, topology};
use crate::sample::Chance;
use crate::vec3;

fn cube(cells: u32) -> SimplicialMesh<3> {
    SimplicialMesh::<3>::lattice([-1.0; 3], [1.0; 3], [cells; 3]).expect("a lattice")
}

fn surface_of(
    basis: &dyn Basis<3>,
    function: impl Fn([f64; 3]) -> f64,
    subdivisions: u32,
    branches: Branches<'_, 3>,
) -> Mesh {
    let coefficients = interpolated(basis, function);
    zero_surface(&Expansion::new(basis, &coefficients), subdivisions, branches)
}

/// Not at a node of any lattice, so that no value is zero.
const CENTRE: [f64; 3] = [0.013, -0.021, 0.017];

fn sphere(p: [f64; 3]) -> f64 {
    vec3::distance_squared(p, CENTRE) - 0.49
}

#[test]
fn a_quadratic_sphere_is_a_closed_manifold_and_converges_at_second_order() {
    let basis = P2::new(cube(2));
    let mut errors = Vec::new();
    for subdivisions in 0..4 {
        let mesh = surface_of(&basis, sphere, subdivisions, Branches::All);
        assert!(mesh.vertices.iter().all(|&v| sphere(v).abs() < 1e-14));
        let topology = topology(&mesh).expect("a mesh");
        assert!(topology.closed && topology.genus == Some(0) && topology.nonmanifold_vertices == 0);
        assert_eq!((topology.unused_vertices, topology.degenerate_triangles, topology.components.len()), (0, 0, 1));
        let exact = 4.0 / 3.0 * std::f64::consts::PI * 0.343;
        errors.push(1.0 - topology.volume.expect("a closed mesh has a volume") / exact);
        if subdivisions > 0 {
            assert!(mesh.triangles.len() > 100);
        }
    }
    assert!(errors.iter().all(|e| *e > 0.0));
    // Each subdivision halves the cells, so it quarters the error.
    for pair in errors[1..].windows(2) {
        assert!((3.0..5.0).contains(&(pair[0] / pair[1])), "{errors:?}");
    }
}

#[test]
fn a_linear_function_gives_its_plane_whatever_the_subdivision() {
    let basis = P1::new(cube(3));
    let plane = |[x, y, z]: [f64; 3]| 0.3 * x + 0.2 * y - z + 0.05;
    let mesh = surface_of(&basis, plane, 0, Branches::All);
    assert_eq!(mesh, surface_of(&basis, plane, 2, Branches::All));
    let topology = topology(&mesh).expect("a mesh");
    assert!((topology.area - 4.0 * (1.0_f64 + 0.09 + 0.04).sqrt()).abs() < 1e-13);
    assert!(topology.nonmanifold_edges == 0 && topology.inconsistent_edges == 0 && topology.components.len() == 1);
    for [a, b, c] in mesh.triangles.iter().map(|t| t.map(|v| mesh.vertices[v as usize])) {
        let normal = vec3::cross(vec3::sub(b, a), vec3::sub(c, a));
        assert!(vec3::dot(normal, [0.3, 0.2, -1.0]) > 0.0);
    }
}

#[test]
fn a_gaussian_ball_lies_on_its_sphere() {
    let kernel = Kernel::Gaussian { width: 1.0 };
    let basis = Radial::new(cube(3), kernel, vec![CENTRE], Tail::Constant).expect("a centre");
    let coefficients = [-1.0, (-0.49_f64).exp()];
    let mesh = zero_surface(&Expansion::new(&basis, &coefficients), 1, Branches::All);
    assert!(mesh.vertices.iter().all(|&v| (vec3::distance(v, CENTRE) - 0.7).abs() < 1e-13));
    let topology = topology(&mesh).expect("a mesh");
    assert!(topology.closed && topology.genus == Some(0) && topology.volume.expect("closed") > 1.2);
}

#[test]
fn zeros_at_nodes_leave_a_manifold() {
    let basis = P2::new(cube(2));
    let mesh = surface_of(&basis, |[x, y, z]| x * x + y * y + z * z - 0.25, 1, Branches::All);
    let topology = topology(&mesh).expect("a mesh");
    assert!(topology.closed && topology.genus == Some(0) && topology.nonmanifold_vertices == 0);
}

#[test]
fn surfaces_are_manifolds_whatever_the_values() {
    let basis = P2::new(cube(2));
    let mut chance = Chance::new(10, 72, 0);
    for round in 0..60 {
        let coefficients: Vec<f64> = (0..basis.len()).map(|_| chance.between(-2.5, 2.5).round()).collect();
        let mesh = zero_surface(&Expansion::new(&basis, &coefficients), round % 3, Branches::All);
        let topology = topology(&mesh).expect("a mesh");
        assert_eq!((topology.nonmanifold_edges, topology.nonmanifold_vertices, topology.inconsistent_edges), (0, 0, 0));
        let mut used = std::collections::BTreeMap::new();
        for [a, b] in mesh.triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]) {
            *used.entry([a.min(b), a.max(b)]).or_insert(0) += 1;
        }
        for (edge, _) in used.iter().filter(|(_, count)| **count == 1) {
            let [a, b] = edge.map(|v| mesh.vertices[v as usize]);
            assert!((0..3).any(|k| a[k].abs() == 1.0 && a[k] == b[k]), "the boundary lies on the rim");
        }
    }
}

#[test]
fn what_is_not_known_is_left_out_and_one_sign_gives_nothing() {
    let basis = P2::new(cube(2));
    assert_eq!(surface_of(&basis, |p| sphere(p) + 1.0, 1, Branches::All), Mesh::default());
    assert_eq!(surface_of(&basis, |_| 0.0, 1, Branches::All), Mesh::default());
    let coefficients = interpolated(&basis, |[_, _, z]| z - 0.3);
    let undefined: Vec<bool> = (0..basis.len()).map(|j| basis.node(j).expect("a node")[0] > 0.6).collect();
    let mesh = zero_surface(&Expansion::new(&basis, &coefficients).without(&undefined), 1, Branches::All);
    assert!((topology(&mesh).expect("a mesh").area - 2.0).abs() < 1e-13);
}

#[test]
fn the_sheet_without_data_goes() {
    let mesh = cube(3);
    let basis = P2::new(mesh.clone());
    // Two sheets of a hyperboloid, close to a double cone, with data on the upper one.
    let cone = |[x, y, z]: [f64; 3]| x * x + y * y - (z - 0.1).powi(2) + 0.01;
    // And two parallel planes, with data on one.
    let planes = |[_, _, z]: [f64; 3]| (z - 0.55) * (z + 0.3);
    let around = (0..200).map(|i| {
        let (sin, cos) = (2.4 * f64::from(i)).sin_cos();
        let r = 0.7 * (f64::from(i) / 200.0).sqrt();
        [r * cos, r * sin, r]
    });
    let place = |p: [f64; 3]| -> Place<3> { mesh.locate(p).expect("the data lie in the mesh") };
    let on_cone: Vec<_> = around.clone().map(|[x, y, r]| place([x, y, 0.1 + r.hypot(0.1)])).collect();
    let on_plane: Vec<_> = around.map(|[x, y, _]| place([x, y, 0.55])).collect();
    type Function = fn([f64; 3]) -> f64;
    for (function, data) in [(cone as Function, on_cone), (planes as Function, on_plane)] {
        let all = surface_of(&basis, function, 2, Branches::All);
        assert_eq!(topology(&all).expect("a mesh").components.len(), 2);
        let kept = surface_of(&basis, function, 2, Branches::WithData(&data));
        assert_eq!(topology(&kept).expect("a mesh").components.len(), 1);
        assert!(kept.vertices.iter().all(|v| v[2] > 0.1));
    }
}
