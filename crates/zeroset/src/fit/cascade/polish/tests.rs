//! The polish on surfaces that are known.

use super::pieces::Pieces;
use super::start::start;
use super::{Held, OrientedTriangle, PolishParams, polish};
use crate::domain::{Blocks, Lattice, TETRAHEDRA};
use crate::field::LatticeField;
use crate::sample::Chance;
use crate::vec3::{self, Vec3};

const PARAMS: PolishParams = PolishParams { screening: 2.0, smoothness: 3.0, rounds: 3 };

fn held(facets: &[OrientedTriangle]) -> Held<'_> {
    Held { facets, ..Held::default() }
}

/// F at every node of a lattice with `cells` cells over the cube -1..1.
fn field_of(cells: f64, f: impl Fn(Vec3) -> f64) -> LatticeField {
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

/// A sphere as the cascade leaves it: a blurred step with a ripple.
fn rippled(p: Vec3) -> f64 {
    let ripple = 0.01 * (40.0 * p[0]).sin() * (37.0 * p[1]).sin() * (43.0 * p[2]).cos();
    (8.0 * (vec3::norm(p) - 0.6 + ripple)).tanh()
}

fn on_sphere(n: usize, noise: f64) -> Vec<Vec3> {
    let mut chance = Chance::new(11, 0, 0);
    (0..n).map(|_| vec3::add(vec3::scale(chance.direction(), 0.6), chance.normal3(noise))).collect()
}

#[test]
fn a_blurred_step_becomes_a_distance() {
    let cell = 2.0 / 40.0;
    let points = on_sphere(6000, 0.2 * cell);
    let (field, report) = polish(&field_of(40.0, rippled), &points, Held::default(), PARAMS, &()).unwrap();
    // What design section 2 asks for: |grad F| = 1 within a tenth at the data.
    let [low, middle, high] = report.gradient_quantiles;
    assert!(low > 0.9 && high < 1.1, "{low} {middle} {high}");
    let mut chance = Chance::new(5, 0, 0);
    let worst = (0..500)
        .map(|_| {
            let p = vec3::scale(chance.direction(), chance.between(0.6 - cell, 0.6 + cell));
            let node = std::array::from_fn(|a| ((p[a] - field.lattice.origin[a]) / cell).round() as u32);
            let at = field.lattice.position(field.lattice.finest, node.map(f64::from));
            (f64::from(field.node(node).unwrap()) - (vec3::norm(at) - 0.6)).abs()
        })
        .fold(0.0, f64::max);
    // The ripple was a fifth of a cell high, and the noise a fifth of a cell.
    assert!(worst < 0.15 * cell, "{} cells", worst / cell);
}

#[test]
fn the_solver_takes_as_many_steps_at_every_size() {
    let steps = |cells: f64| {
        let points = on_sphere((6000.0 * (cells / 40.0).powi(2)) as usize, 0.2 * 2.0 / cells);
        let (_, report) = polish(&field_of(cells, rippled), &points, Held::default(), PARAMS, &()).unwrap();
        (report.free_nodes, *report.solver_steps.iter().max().unwrap())
    };
    let (small, large) = (steps(24.0), steps(96.0));
    assert!(large.0 > 8 * small.0);
    assert!(large.1 <= small.1 + 5 && large.1 < 40, "{small:?} {large:?}");
}

#[test]
fn facets_hold_f_to_their_planes_into_the_corner() {
    let cell = 2.0 / 30.0;
    // A wedge whose edge F has rounded with a radius of a cell: the ground z = 0.03 to one side, a wall x = 0.04 to the other.
    let (wall, ground) = (0.04, 0.03);
    let f = |p: Vec3| {
        let (a, b) = (p[0] - wall + cell, p[2] - ground + cell);
        if a > 0.0 && b > 0.0 { a.hypot(b) - cell } else { a.max(b) - cell }
    };
    let quadrangle = |corners: [Vec3; 4], normal: Vec3| {
        [[0, 1, 2], [0, 2, 3]].map(|t| OrientedTriangle { corners: t.map(|i| corners[i]), normal })
    };
    let top = quadrangle(
        [[-0.9, -0.9, ground], [wall, -0.9, ground], [wall, 0.9, ground], [-0.9, 0.9, ground]],
        [0.0, 0.0, 1.0],
    );
    let side =
        quadrangle([[wall, -0.9, -0.9], [wall, 0.9, -0.9], [wall, 0.9, ground], [wall, -0.9, ground]], [1.0, 0.0, 0.0]);
    let (field, _) = polish(&field_of(30.0, f), &[], held(&[top, side].concat()), PARAMS, &()).unwrap();
    // Nodes beside the edge are off by up to (sqrt 2 - 1) cells before, and by half of that after.
    let exact = |p: Vec3| (p[0] - wall).max(p[2] - ground);
    let (mut before, mut after) = (0.0_f64, 0.0_f64);
    let lattice = &field.lattice;
    let around = |p: f64, a: usize| ((p - lattice.origin[a]) / cell).floor() as u32;
    for x in around(wall, 0) - 1..=around(wall, 0) + 1 {
        for z in around(ground, 2) - 1..=around(ground, 2) + 1 {
            let node = [x, around(0.0, 1), z];
            let p = lattice.position(lattice.finest, node.map(f64::from));
            before = before.max((f(p) - exact(p)).abs());
            after = after.max((f64::from(field.node(node).unwrap()) - exact(p)).abs());
        }
    }
    assert!(before > 0.3 * cell && after < 0.6 * before, "{} {}", before / cell, after / cell);
}

#[test]
fn pieces_integrate_squares_exactly() {
    // F linear, a slanted triangle that many cells cut: the integral of the square of a linear function over a triangle in closed form.
    let f = |p: Vec3| 0.3 * p[0] - 0.2 * p[1] + 0.5 * p[2] + 0.02;
    let field = field_of(20.0, f);
    let corners = [[-0.71, -0.53, 0.31], [0.63, -0.41, -0.37], [0.11, 0.77, 0.23]];
    let normal = vec3::normalized(vec3::cross(vec3::sub(corners[1], corners[0]), vec3::sub(corners[2], corners[0])));
    let facet = OrientedTriangle { corners, normal: normal.unwrap() };
    // Everything counts as near: a start in which F vanishes everywhere and points along the facet.
    let mut begin = start(&field, &[], held(&[facet]));
    begin.d.fill(0.0);
    for (component, n) in begin.directions.0.iter_mut().zip(facet.normal) {
        component.fill(n as f32);
    }
    let known = vec![[u64::MAX; 8]; field.blocks.len()];
    let pieces = Pieces::new(&field, held(&[facet]), &begin.directions, &begin.d, &known);
    let mut sum = 0.0;
    for (b, of_block) in pieces.of_block.iter().enumerate() {
        for piece in of_block {
            let cell: [u32; 3] =
                std::array::from_fn(|a| 8 * field.blocks.coordinates[b][a] + u32::from(piece.local >> (3 * a) & 7));
            let values = TETRAHEDRA[usize::from(piece.tetrahedron)].corners.map(|corner| {
                let node = std::array::from_fn(|a| cell[a] + (corner >> a & 1) as u32);
                f64::from(field.node(node).unwrap())
            });
            for i in 0..4 {
                for j in 0..4 {
                    sum += values[i] * f64::from(piece.moments[i][j]) * values[j];
                }
            }
        }
    }
    let area = 0.5 * vec3::norm(vec3::cross(vec3::sub(corners[1], corners[0]), vec3::sub(corners[2], corners[0])));
    let [a, b, c] = corners.map(f);
    let exact = area / 6.0 * (a * a + b * b + c * c + a * b + b * c + c * a) / 0.01;
    // Barycentric weights are f32.
    assert!((sum - exact).abs() < 1e-5 * exact, "{sum} is not {exact}");
}
