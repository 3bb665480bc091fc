//! The fit moves, grows and is renumbered with its data and its domain.

use std::collections::HashMap;

use super::{curve, random, sites, surface};
use crate::basis::{Basis, P1, P2};
use crate::domain::SimplicialMesh;
use crate::fit::normalized::{
    Coefficients, Data, Fitted, MeanGradient, Normalization, NormalizedFit, Order1, Order2, Smoothness,
    SquaredGradient, Warning,
};
use crate::sample::Chance;

#[derive(Debug, Clone, Copy, PartialEq)]
enum Datum<const D: usize> {
    Point([f64; D]),
    Segment([[f64; D]; 2]),
    Triangle([[f64; D]; 3]),
}

/// Makes a mesh of vertices and simplices.
type MakeMesh<const D: usize> = fn(Vec<[f64; D]>, &[Vec<u32>]) -> SimplicialMesh<D>;

/// All that a fit is made of.
#[derive(Clone)]
struct Scene<const D: usize> {
    vertices: Vec<[f64; D]>,
    simplices: Vec<Vec<u32>>,
    data: Vec<Datum<D>>,
    /// Of a point, for each unit of length, and of area.
    weights: [f64; 3],
    /// Of order 1 and 2.
    smoothness: [f64; 2],
    mesh: MakeMesh<D>,
}

/// Which functions, order of smoothness and normalisation.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Way {
    degree: usize,
    order: usize,
    norm: Norm,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Norm {
    Coefficients,
    Squared,
    Mean,
}

fn ways() -> impl Iterator<Item = Way> {
    let norms = [Norm::Coefficients, Norm::Squared, Norm::Mean];
    (0..12).map(move |k| Way { degree: 1 + k % 2, order: 1 + k / 2 % 2, norm: norms[k / 4] })
}

impl<const D: usize> Scene<D> {
    fn of(mesh: &SimplicialMesh<D>, data: Vec<Datum<D>>, make: MakeMesh<D>) -> Self {
        Self {
            vertices: mesh.vertices().to_vec(),
            simplices: (0..mesh.len()).map(|s| mesh.simplex(s).to_vec()).collect(),
            data,
            weights: [1.0, 20.0, 30.0],
            smoothness: [0.02, 1e-3],
            mesh: make,
        }
    }

    /// With all positions mapped.
    fn moved(&self, map: impl Fn([f64; D]) -> [f64; D]) -> Self {
        let data = self.data.iter().map(|datum| match *datum {
            Datum::Point(p) => Datum::Point(map(p)),
            Datum::Segment(ends) => Datum::Segment(ends.map(&map)),
            Datum::Triangle(corners) => Datum::Triangle(corners.map(&map)),
        });
        Self { vertices: self.vertices.iter().map(|&v| map(v)).collect(), data: data.collect(), ..self.clone() }
    }

    fn basis(&self, degree: usize) -> Box<dyn Basis<D>> {
        let mesh = (self.mesh)(self.vertices.clone(), &self.simplices);
        if degree == 1 { Box::new(P1::new(mesh)) } else { Box::new(P2::new(mesh)) }
    }

    fn fitted(&self, way: Way) -> Fitted {
        let mut data = Data::new();
        for datum in &self.data {
            match *datum {
                Datum::Point(p) => data.point(p, self.weights[0]),
                Datum::Segment(ends) => data.segment(ends, self.weights[1]),
                Datum::Triangle(corners) => data.triangle(corners, self.weights[2]),
            }
            .unwrap();
        }
        let basis = self.basis(way.degree);
        let orders: [&dyn Smoothness<D>; 2] =
            [&Order1 { weight: self.smoothness[0] }, &Order2 { weight: self.smoothness[1] }];
        let mean = MeanGradient { tolerance: 1e-13, max_steps: 100_000, ..MeanGradient::default() };
        let normalization: &dyn Normalization<D> = match way.norm {
            Norm::Coefficients => &Coefficients,
            Norm::Squared => &SquaredGradient::default(),
            Norm::Mean => &mean,
        };
        let fit = NormalizedFit::new(&*basis, &data).smoothness(orders[way.order - 1]).normalization(normalization);
        let fitted = fit.run().unwrap();
        assert!(!fitted.diagnosis.warnings.contains(&Warning::NotAtRest), "{way:?}");
        if let Some(gap) = fitted.gap() {
            assert!(gap > 0.01 * fitted.rayleigh_quotient, "{way:?}: the gap is too small for a comparison");
        }
        fitted
    }
}

/// Rounding, over the gap; 3e-10 is the most that was found, at a scale of 1000.
const SAME: f64 = 1e-9;

fn assert_same(label: &str, way: Way, found: (f64, &[f64]), expected: (f64, &[f64])) {
    let off = (found.0 / expected.0 - 1.0).abs();
    assert!(off < SAME, "{label}, {way:?}: the quotient is off by {off}");
    let largest = expected.1.iter().fold(0.0_f64, |m, c| m.max(c.abs()));
    let off = found.1.iter().zip(expected.1).map(|(f, e)| (f - e).abs()).fold(0.0, f64::max) / largest;
    assert!(off < SAME, "{label}, {way:?}: F is off by {off}");
}

fn scenes_2d() -> Vec<Scene<2>> {
    let make = |vertices: Vec<[f64; 2]>, simplices: &[Vec<u32>]| {
        let triangles: Vec<[u32; 3]> = simplices.iter().map(|s| [s[0], s[1], s[2]]).collect();
        SimplicialMesh::from_triangles(vertices, &triangles).unwrap()
    };
    let mut data: Vec<Datum<2>> = curve(40).into_iter().map(Datum::Point).collect();
    data.insert(20, Datum::Segment([[0.31, 0.22], [0.6, 0.23]]));
    data.push(Datum::Triangle([[0.84, 0.45], [0.86, 0.45], [0.85, 0.55]]));
    (0..2)
        .map(|seed| SimplicialMesh::<2>::delaunay(&sites(40 + seed, 12)).unwrap())
        .map(|mesh| Scene::of(&mesh, data.clone(), make))
        .collect()
}

fn scenes_3d() -> Vec<Scene<3>> {
    let make = |vertices: Vec<[f64; 3]>, simplices: &[Vec<u32>]| {
        let tetrahedra: Vec<[u32; 4]> = simplices.iter().map(|s| [s[0], s[1], s[2], s[3]]).collect();
        SimplicialMesh::from_tetrahedra(vertices, &tetrahedra).unwrap()
    };
    let mut data: Vec<Datum<3>> = surface(150).into_iter().map(Datum::Point).collect();
    data.insert(7, Datum::Segment([[0.4, 0.45, 0.82], [0.6, 0.5, 0.82]]));
    data.push(Datum::Triangle([[0.45, 0.75, 0.5], [0.6, 0.76, 0.45], [0.5, 0.75, 0.6]]));
    (0..2)
        .map(|seed| SimplicialMesh::<3>::delaunay(&sites(50 + seed, 6)).unwrap())
        .map(|mesh| Scene::of(&mesh, data.clone(), make))
        .collect()
}

/// A random orthonormal basis, by Gram and Schmidt; right-handed or left-handed.
fn frame<const D: usize>(seed: u64) -> [[f64; D]; D] {
    let mut frame: [[f64; D]; D] = random(seed, D, -1.0, 1.0).try_into().unwrap();
    for i in 0..D {
        for _twice in 0..2 {
            for j in 0..i {
                let along: f64 = (0..D).map(|a| frame[i][a] * frame[j][a]).sum();
                frame[i] = std::array::from_fn(|a| frame[i][a] - along * frame[j][a]);
            }
        }
        let length = frame[i].iter().map(|c| c * c).sum::<f64>().sqrt();
        frame[i] = frame[i].map(|c| c / length);
    }
    frame
}

#[test]
fn f_moves_with_the_data_and_the_domain() {
    fn check<const D: usize>(scene: &Scene<D>, seed: u64) {
        let (frame, offset) = (frame::<D>(60 + seed), random::<D>(70 + seed, 1, -3.0, 3.0)[0]);
        let moved =
            scene.moved(|p| std::array::from_fn(|a| (0..D).map(|b| frame[a][b] * p[b]).sum::<f64>() + offset[a]));
        for way in ways() {
            let (found, expected) = (moved.fitted(way), scene.fitted(way));
            assert_same(
                "moved",
                way,
                (found.rayleigh_quotient, &found.coefficients),
                (expected.rayleigh_quotient, &expected.coefficients),
            );
        }
    }
    scenes_2d().iter().zip(0..).for_each(|(s, seed)| check(s, seed));
    scenes_3d().iter().zip(0..).for_each(|(s, seed)| check(s, seed));
}

#[test]
fn f_grows_with_the_data_and_the_domain() {
    fn check<const D: usize>(scene: &Scene<D>, s: f64) {
        // The same F on the larger domain has gradients 1 / s as long, over a volume of s^D. Weights make all terms of E what they were.
        let mut larger = scene.moved(|p| p.map(|c| s * c));
        larger.weights = [scene.weights[0], scene.weights[1] / s, scene.weights[2] / (s * s)];
        let d = D as i32;
        larger.smoothness = [scene.smoothness[0] * s.powi(2 - d), scene.smoothness[1] * s.powi(4 - d)];
        for way in ways() {
            let (found, expected) = (larger.fitted(way), scene.fitted(way));
            // Then N = 1 asks for F s times as large, and the quotient is s^2 times the old one.
            let factor = if way.norm == Norm::Coefficients { 1.0 } else { s };
            let scaled: Vec<f64> = expected.coefficients.iter().map(|f| factor * f).collect();
            let quotient = factor * factor * expected.rayleigh_quotient;
            assert_same(
                &format!("scaled by {s}"),
                way,
                (found.rayleigh_quotient, &found.coefficients),
                (quotient, &scaled),
            );
            let distances = found.distance_rms / (s * expected.distance_rms);
            assert!((distances - 1.0).abs() < SAME, "{way:?}: distances are lengths: {distances}");
        }
    }
    scenes_2d().iter().zip([1e3, 0.07]).for_each(|(scene, s)| check(scene, s));
    scenes_3d().iter().zip([1e3, 0.07]).for_each(|(scene, s)| check(scene, s));
}

/// A random order.
fn shuffled(count: usize, seed: u64) -> Vec<usize> {
    let mut chance = Chance::new(seed, 306, 9);
    let mut order: Vec<usize> = (0..count).collect();
    for i in (1..count).rev() {
        order.swap(i, (chance.uniform() * (i + 1) as f64) as usize);
    }
    order
}

#[test]
fn the_order_of_data_does_not_matter() {
    fn check<const D: usize>(scene: &Scene<D>, seed: u64) {
        let order = shuffled(scene.data.len(), seed);
        let other = Scene { data: order.iter().map(|&i| scene.data[i]).collect(), ..scene.clone() };
        for way in ways() {
            let (found, expected) = (other.fitted(way), scene.fitted(way));
            assert_same(
                "data in another order",
                way,
                (found.rayleigh_quotient, &found.coefficients),
                (expected.rayleigh_quotient, &expected.coefficients),
            );
            let largest = expected.residuals.iter().fold(0.0_f64, |m, &r| m.max(r));
            for (&i, residual) in order.iter().zip(&found.residuals) {
                assert!(
                    (residual - expected.residuals[i]).abs() < SAME * largest,
                    "{way:?}: residuals go with the data"
                );
            }
        }
    }
    scenes_2d().iter().zip(80..).for_each(|(s, seed)| check(s, seed));
    scenes_3d().iter().zip(80..).for_each(|(s, seed)| check(s, seed));
}

#[test]
fn the_numbers_of_vertices_and_simplices_do_not_matter() {
    fn check<const D: usize>(scene: &Scene<D>, seed: u64) {
        let order = shuffled(scene.vertices.len(), seed);
        let mut new = vec![0; order.len()];
        order.iter().enumerate().for_each(|(to, &from)| new[from] = to as u32);
        let simplices = shuffled(scene.simplices.len(), seed + 1);
        let renumbered = |s: &usize| {
            let mut corners: Vec<u32> = scene.simplices[*s].iter().map(|&v| new[v as usize]).collect();
            corners.rotate_left(s % (D + 1));
            corners
        };
        let other = Scene {
            vertices: order.iter().map(|&v| scene.vertices[v]).collect(),
            simplices: simplices.iter().map(renumbered).collect(),
            ..scene.clone()
        };
        for way in ways() {
            let (found, expected) = (other.fitted(way), scene.fitted(way));
            // Functions by their nodes, which agree bit for bit for vertices, and for middles of edges to rounding.
            let key = |p: [f64; D]| p.map(|c| (c * 1e9).round() as i64);
            let basis = other.basis(way.degree);
            let by_node: HashMap<[i64; D], f64> =
                (0..basis.len()).map(|j| (key(basis.node(j).unwrap()), found.coefficients[j])).collect();
            assert_eq!(by_node.len(), basis.len());
            let basis = scene.basis(way.degree);
            let matched: Vec<f64> = (0..basis.len()).map(|j| by_node[&key(basis.node(j).unwrap())]).collect();
            assert_same(
                "renumbered",
                way,
                (found.rayleigh_quotient, &matched),
                (expected.rayleigh_quotient, &expected.coefficients),
            );
        }
    }
    scenes_2d().iter().zip(90..).for_each(|(s, seed)| check(s, seed));
    scenes_3d().iter().zip(90..).for_each(|(s, seed)| check(s, seed));
}
