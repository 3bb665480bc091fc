//! A corner inside a cell: quadratic functions hold it, linear ones cannot (figure 8 of the paper).

use crate::basis::{Basis, P1, P2};
use crate::contour::{Branches, zero_lines, zero_surface};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{Data, NormalizedFit};
use crate::sample::Chance;

fn dot<const D: usize>(a: [f64; D], b: [f64; D]) -> f64 {
    (0..D).map(|k| a[k] * b[k]).sum()
}

fn minus<const D: usize>(a: [f64; D], b: [f64; D]) -> [f64; D] {
    std::array::from_fn(|k| a[k] - b[k])
}

/// How far the zero set strays from two lines or planes, and how near it comes to where they meet.
#[derive(Debug)]
struct Errors {
    farthest: f64,
    at_corner: f64,
}

/// Measures positions on a zero set against lines or planes through `corner` with these normals. `meets` is the distance from the place,
/// point or line, where they meet.
fn measured<const D: usize>(
    positions: impl Iterator<Item = [f64; D]>,
    corner: [f64; D],
    normals: &[[f64; D]; 2],
    meets: impl Fn([f64; D]) -> f64,
) -> Errors {
    let start = Errors { farthest: 0.0, at_corner: f64::INFINITY };
    positions.fold(start, |errors, p| {
        let off = normals.map(|n| dot(minus(p, corner), n).abs());
        Errors { farthest: errors.farthest.max(off[0].min(off[1])), at_corner: errors.at_corner.min(meets(p)) }
    })
}

/// A square of two triangles. The L lies in the lower one: its corner at (0.72, 0.22), its arms to the left and upwards, turned a little.
#[test]
fn two_noisy_lines_meet_in_a_corner_that_quadratics_hold_and_linears_cut() {
    const NOISE: f64 = 0.005;
    let corner = [0.72, 0.22];
    for seed in 0..10 {
        for turn in [-0.07_f64, 0.0, 0.08] {
            let arms = [[-turn.cos(), -turn.sin()], [-turn.sin(), turn.cos()]];
            let normals = [[-turn.sin(), turn.cos()], [turn.cos(), turn.sin()]];
            let mut chance = Chance::new(seed, 307, 0);
            let mut points = Vec::new();
            for arm in arms {
                for _ in 0..400 {
                    let t = 0.42 * chance.uniform();
                    points.push(std::array::from_fn(|a| corner[a] + t * arm[a] + NOISE * chance.normal()));
                }
            }
            let largest_noise = measured(points.iter().copied(), corner, &normals, |_| 0.0).farthest;
            let domain = SimplicialMesh::lattice([0.0; 2], [1.0; 2], [1; 2]).unwrap();
            let errors = |basis: &dyn Basis<2>| {
                let mut data = Data::new();
                data.points(&points, 1.0).unwrap();
                let fitted = NormalizedFit::new(basis, &data).run().unwrap();
                let places: Vec<_> = data.samples(basis).unwrap().iter().map(|s| s.place).collect();
                let curves = zero_lines(&fitted.function(basis), 1e-5, Branches::WithData(&places));
                let pieces = curves.iter().flat_map(|c| c.points.windows(2)).map(|w| [w[0], w[1]]);
                let dense = pieces.flat_map(|[p, q]| {
                    (0..=20).map(move |t| std::array::from_fn(|a| p[a] + f64::from(t) / 20.0 * (q[a] - p[a])))
                });
                measured(dense, corner, &normals, |p| dot(minus(p, corner), minus(p, corner)).sqrt())
            };
            let (linear, quadratic) = (errors(&P1::new(domain.clone())), errors(&P2::new(domain)));
            let what = format!("seed {seed}, turned {turn}: noise {largest_noise}, {linear:?}, {quadratic:?}");
            assert!(quadratic.farthest <= 1.5 * largest_noise, "{what}");
            assert!(linear.at_corner >= 5.0 * quadratic.at_corner, "{what}");
        }
    }
}

/// Positions on the zero set of the fit to points, of the parts with data: the vertices of its surface, and where F is linear all over
/// its triangles, some hundredths apart.
fn positions(basis: &dyn Basis<3>, points: &[[f64; 3]]) -> Vec<[f64; 3]> {
    let mut data = Data::new();
    data.points(points, 1.0).unwrap();
    let fitted = NormalizedFit::new(basis, &data).run().unwrap();
    let places: Vec<_> = data.samples(basis).unwrap().iter().map(|s| s.place).collect();
    let surface = zero_surface(&fitted.function(basis), 5, Branches::WithData(&places));
    if basis.degree() != Some(1) {
        return surface.vertices;
    }
    let dense = surface.triangles.iter().map(|t| t.map(|v| surface.vertices[v as usize])).flat_map(|[p, q, r]| {
        let longest = [minus(p, q), minus(q, r), minus(r, p)].map(|d| dot(d, d).sqrt()).into_iter().fold(0.0, f64::max);
        let parts = (longest / 0.02).ceil().max(1.0) as usize;
        let place = move |i: usize, j: usize| {
            let (u, v) = (i as f64 / parts as f64, j as f64 / parts as f64);
            std::array::from_fn(|a| p[a] + u * (q[a] - p[a]) + v * (r[a] - p[a]))
        };
        (0..=parts).flat_map(move |i| (0..=parts - i).map(move |j| place(i, j)))
    });
    dense.collect()
}

/// One tetrahedron, and two planes that meet in an edge inside it.
#[test]
fn two_noisy_planes_meet_in_an_edge_that_quadratics_hold_and_linears_cut() {
    const NOISE: f64 = 0.003;
    let vertices = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let corner = [0.8, 0.8, 0.6];
    // Two half planes, at right angles, from an edge that runs mostly along z.
    let edge = crate::vec3::normalized([0.1, -0.15, 1.0]).unwrap();
    let first = crate::vec3::normalized(crate::vec3::cross([0.1, 1.0, 0.0], edge)).unwrap();
    let arms = [first, crate::vec3::cross(edge, first)];
    let normals = [arms[1], arms[0]];
    for seed in 0..4 {
        let mut chance = Chance::new(seed, 308, 0);
        let mut points = Vec::new();
        for arm in arms {
            for _ in 0..3000 {
                let (t, along) = (0.5 * chance.uniform(), chance.between(-0.3, 0.7));
                points
                    .push(std::array::from_fn(|a| corner[a] + t * arm[a] + along * edge[a] + NOISE * chance.normal()));
            }
        }
        let largest_noise = measured(points.iter().copied(), corner, &normals, |_| 0.0).farthest;
        let domain = SimplicialMesh::from_tetrahedra(vertices.clone(), &[[0, 1, 2, 3]]).unwrap();
        let errors = |basis: &dyn Basis<3>| {
            // Where there are data: far from them planes are extrapolated.
            let near = positions(basis, &points).into_iter().filter(|&p| {
                let along = dot(minus(p, corner), edge);
                let out = arms.map(|arm| dot(minus(p, corner), arm));
                (-0.3..0.7).contains(&along) && out.iter().all(|&o| o < 0.5)
            });
            measured(near, corner, &normals, |p| {
                let d = minus(p, corner);
                (dot(d, d) - dot(d, edge).powi(2)).max(0.0).sqrt()
            })
        };
        let (linear, quadratic) = (errors(&P1::new(domain.clone())), errors(&P2::new(domain)));
        let what = format!("seed {seed}: noise {largest_noise}, {linear:?}, {quadratic:?}");
        assert!(quadratic.farthest <= 1.5 * largest_noise, "{what}");
        assert!(linear.at_corner >= 5.0 * quadratic.at_corner, "{what}");
    }
}

/// The same tetrahedron, and three planes that meet in a corner. Their surface is the zero set of a cubic: no quadratic vanishes on all
/// three, so the corner is rounded. What can be had is told here as it is: nearer than linear functions, but not within the noise.
#[test]
fn three_noisy_planes_meet_in_a_corner_that_quadratics_only_near() {
    const NOISE: f64 = 0.003;
    let vertices = vec![[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 4.0, 0.0], [0.0, 0.0, 4.0]];
    let corner = [0.7, 0.7, 0.7];
    let first = crate::vec3::normalized([1.0, 0.1, -0.1]).unwrap();
    let second = crate::vec3::normalized(crate::vec3::cross([0.1, 0.0, 1.0], first)).unwrap();
    let arms = [first, second, crate::vec3::cross(first, second)];
    let mut chance = Chance::new(0, 309, 0);
    let mut points: Vec<[f64; 3]> = Vec::new();
    for (u, v) in [(0, 1), (1, 2), (2, 0)] {
        for _ in 0..3000 {
            let (s, t) = (0.5 * chance.uniform(), 0.5 * chance.uniform());
            points.push(std::array::from_fn(|a| corner[a] + s * arms[u][a] + t * arms[v][a] + NOISE * chance.normal()));
        }
    }
    let off = |p: [f64; 3]| arms.map(|arm| dot(minus(p, corner), arm).abs()).into_iter().fold(f64::INFINITY, f64::min);
    let largest_noise = points.iter().map(|&p| off(p)).fold(0.0, f64::max);
    let domain = SimplicialMesh::from_tetrahedra(vertices, &[[0, 1, 2, 3]]).unwrap();
    let errors = |basis: &dyn Basis<3>| {
        let near = |p: &[f64; 3]| arms.iter().all(|&arm| (-0.1..0.5).contains(&dot(minus(*p, corner), arm)));
        let start = Errors { farthest: 0.0, at_corner: f64::INFINITY };
        positions(basis, &points).into_iter().filter(near).fold(start, |errors, p| {
            let d = minus(p, corner);
            Errors { farthest: errors.farthest.max(off(p)), at_corner: errors.at_corner.min(dot(d, d).sqrt()) }
        })
    };
    let (linear, quadratic) = (errors(&P1::new(domain.clone())), errors(&P2::new(domain)));
    let what = format!("noise {largest_noise}, {linear:?}, {quadratic:?}");
    assert!(quadratic.farthest > 1.5 * largest_noise, "better than was thought possible: {what}");
    assert!(quadratic.farthest < 0.5 * linear.farthest, "{what}");
}
