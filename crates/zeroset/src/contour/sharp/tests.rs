//! Boxes whose edges F has rounded, and bodies that are round in truth.

use super::{Known, SharpReport, sharpen};
use crate::contour::contour;
use crate::contour::tests::field_of;
use crate::feature::{Facets, Features, Plane};
use crate::mesh::{Mesh, self_intersections, topology};
use crate::sample::{Chance, sample_surface};
use crate::spatial::{PointTree, TriangleTree};
use crate::vec3::{self, Vec3};

/// Half the sides of the box, and its middle: no face lies along a layer of nodes.
const HALF: Vec3 = [0.61, 0.47, 0.53];
const MIDDLE: Vec3 = [0.013, -0.021, 0.017];

/// Cells over the cube -1..1.
const CELLS: f64 = 40.0;
const CELL: f64 = 2.0 / CELLS;

/// The distance from a box whose edges are rounded with a radius.
fn rounded_box(p: Vec3, radius: f64) -> f64 {
    let q: Vec3 = std::array::from_fn(|a| (p[a] - MIDDLE[a]).abs() - HALF[a] + radius);
    let outside = vec3::norm(q.map(|c| c.max(0.0)));
    outside + q[0].max(q[1]).max(q[2]).min(0.0) - radius
}

/// The corners of the face of the box across an axis, drawn in from its edges.
fn face(axis: usize, side: f64, inset: f64) -> Vec<Vec3> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let mut ring: Vec<Vec3> = corners
        .into_iter()
        .map(|(s, t)| {
            let mut p = MIDDLE;
            p[axis] += side * HALF[axis];
            p[u] += s * (HALF[u] - inset);
            p[v] += t * (HALF[v] - inset);
            p
        })
        .collect();
    if side < 0.0 {
        ring.reverse();
    }
    ring
}

/// The planes of the box, as detection gives them.
fn faces(inset: f64) -> Features {
    let planes = (0..6).map(|i| {
        let (axis, side) = (i / 2, if i % 2 == 0 { -1.0 } else { 1.0 });
        let mut normal = [0.0; 3];
        normal[axis] = side;
        let ring = face(axis, side, inset);
        let offset = vec3::dot(normal, ring[0]);
        Plane { normal, offset, oriented: true, points: 1000, rings: vec![ring], ..Plane::default() }
    });
    Features { planes: planes.collect(), ..Features::default() }
}

/// The exact box.
fn truth() -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..6 {
        let first = mesh.vertices.len() as u32;
        mesh.vertices.extend(face(i / 2, if i % 2 == 0 { -1.0 } else { 1.0 }, 0.0));
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}

/// Extracts F and makes it sharp with what is known of it.
fn sharpened(f: impl Fn(Vec3) -> f64, features: &Features, points: &[Vec3]) -> (Mesh, SharpReport) {
    let (mut mesh, _) = contour(&field_of(CELLS, f), |_| true);
    let facets = Facets::new(features);
    let plane_of: Vec<Option<u32>> = points
        .iter()
        .map(|&p| facets.flats.iter().position(|flat| flat.distance(p).abs() < 1e-9).map(|i| i as u32))
        .collect();
    let tree = PointTree::new(points);
    let known = Known {
        facets: &facets,
        positions: points,
        points: &tree,
        plane_of: &plane_of,
        curved_creases: true,
        noise: 0.0,
        cell: CELL,
    };
    let report = sharpen(&mut mesh, &known, None);
    (mesh, report)
}

fn sound(mesh: &Mesh) {
    let t = topology(mesh).unwrap();
    assert!(t.closed && t.components.len() == 1 && t.genus == Some(0));
    assert_eq!((t.nonmanifold_edges, t.nonmanifold_vertices, t.inconsistent_edges), (0, 0, 0));
    assert_eq!(t.degenerate_triangles, 0);
    assert_eq!(self_intersections(mesh, 1, &()).unwrap().pairs, 0);
}

#[test]
fn a_box_that_f_has_rounded_gets_its_edges_and_corners_back() {
    let points = sample_surface(&truth(), 8000, 3).unwrap().points;
    // Half a cell is what F rounds; polygons end as far before their edges as they do in practice.
    let (mesh, report) = sharpened(|p| rounded_box(p, 0.5 * CELL), &faces(0.4 * CELL), &points);
    sound(&mesh);
    assert_eq!((report.at_corners >= 8, report.folded), (true, 0), "{report:?}");
    let [a, b, c] = HALF.map(|h| 2.0 * h);
    assert!((report.crease_length - 4.0 * (a + b + c)).abs() < 1e-5, "{report:?}");
    assert!((report.crease_angle.unwrap() - 90.0).abs() < 1e-3, "{report:?}");
    let exact = TriangleTree::new(&truth());
    // Half a step of single precision at 1, along each axis.
    let rounding = 3.0_f64.sqrt() * 2.0_f64.powi(-24);
    for &v in &mesh.vertices {
        assert_eq!(v, v.map(|c| f64::from(c as f32)), "files hold it as it is");
        assert!(exact.closest(v).unwrap().distance_squared.sqrt() <= rounding, "{v:?}");
    }
    // Edges and corners are there, not cut off: volume and area are the box's to rounding.
    let t = topology(&mesh).unwrap();
    let area = 2.0 * (a * b + b * c + c * a);
    assert!((t.volume.unwrap() - a * b * c).abs() < rounding * area, "{:?}", t.volume);
    assert!((t.area - area).abs() < rounding * 4.0 * (a + b + c), "{}", t.area);
}

#[test]
fn a_fillet_that_points_bear_out_stays_round() {
    let radius = 3.0 * CELL;
    let f = |p: Vec3| rounded_box(p, radius);
    // Points on the rounded box: those of a larger box, brought down along the gradient.
    let outer = sample_surface(&truth(), 20_000, 5).unwrap().points;
    let points: Vec<Vec3> = outer
        .into_iter()
        .map(|mut p| {
            for _ in 0..20 {
                let g: Vec3 = std::array::from_fn(|a| {
                    let mut q = p;
                    q[a] += 1e-6;
                    (f(q) - f(p)) / 1e-6
                });
                p = vec3::add_scaled(p, g, -f(p));
            }
            p
        })
        .collect();
    let (mesh, _) = sharpened(f, &faces(radius), &points);
    sound(&mesh);
    let worst = mesh.vertices.iter().map(|&v| f(v).abs()).fold(0.0, f64::max);
    // A sharp edge would lie (sqrt 2 - 1) radii, 1.2 cells, off. A third of a cell is what needs no evidence.
    assert!(worst < 0.4 * CELL, "{} cells", worst / CELL);
}

#[test]
fn a_sphere_has_no_creases() {
    let f = |p: Vec3| vec3::norm(vec3::sub(p, MIDDLE)) - 0.6;
    let mut chance = Chance::new(7, 0, 0);
    let points: Vec<Vec3> = (0..8000).map(|_| vec3::add_scaled(MIDDLE, chance.direction(), 0.6)).collect();
    let (mesh, report) = sharpened(f, &Features::default(), &points);
    sound(&mesh);
    assert_eq!((report.on_creases, report.at_corners, report.on_planes), (0, 0, 0));
    // Settling smooths the chords of the cells, a hundredth of a cell here, and shrinks the sphere by less.
    let worst = mesh.vertices.iter().map(|&v| f(v).abs()).fold(0.0, f64::max);
    assert!(worst < 0.05 * CELL, "{} cells", worst / CELL);
}
