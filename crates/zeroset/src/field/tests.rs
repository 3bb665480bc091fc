//! What every field keeps, and the laws of Boolean operations.

use std::sync::{Arc, OnceLock};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;

use super::*;
use crate::basis::{Basis, Kernel, P1, P2, Radial, Tail, farthest_points};
use crate::contour::{FieldContourParams, contour_field};
use crate::domain::SimplicialMesh;
use crate::fit::cascade::{self, FitParams};
use crate::fit::normalized::{Data, NormalizedFit, Order2, SquaredGradient};
use crate::mesh::topology;
use crate::sample::{Scene, SceneKind};
use crate::vec3;

type Any = Arc<dyn Field>;

fn position(rng: &mut Pcg64Mcg, reach: f64) -> [f64; 3] {
    std::array::from_fn(|_| reach * (2.0 * rng.random::<f64>() - 1.0))
}

fn ring(sides: usize, radius: f64, center: [f64; 2], phase: f64) -> Vec<[f64; 2]> {
    let angle = |k: usize| phase + k as f64 / sides as f64 * std::f64::consts::TAU;
    (0..sides).map(|k| [center[0] + radius * angle(k).cos(), center[1] + radius * angle(k).sin()]).collect()
}

/// An L with a hole, whose rings run either way.
fn prism() -> Prism {
    let l = vec![[-0.8, -0.8], [0.9, -0.8], [0.9, 0.1], [0.0, 0.1], [0.0, 0.9], [-0.8, 0.9]];
    Prism::new(&[l, ring(5, 0.25, [-0.35, -0.3], 0.3)], [0.5, -0.4]).unwrap()
}

fn heights() -> HeightField {
    let height = |i: usize| 0.2 * ((i % 9) as f64 * 0.9).sin() + 0.3 * ((i / 9) as f64 * 0.7).cos();
    HeightField::new([-0.9, -0.8], [0.25, 0.2], [9, 8], (0..72).map(height).collect()).unwrap()
}

fn solid() -> MeshSolid {
    let mut mesh = Scene::new(SceneKind::Box, 3).truth;
    // Triangles may face either way.
    mesh.triangles.iter_mut().for_each(|t| t.swap(0, 1));
    MeshSolid::new(&mesh).unwrap()
}

/// A model fitted to a scene, moved to about the origin; fitted once.
fn fitted(kind: SceneKind) -> Any {
    static FITTED: [OnceLock<Arc<LatticeSolid>>; 2] = [const { OnceLock::new() }; 2];
    let is_object = kind == SceneKind::Torus;
    let fit = || {
        let points: Vec<[f64; 3]> = Scene::new(kind, 1).points(4000, 0.001, 1).points;
        let middle = points.iter().fold([0.0; 3], |sum, &p| vec3::add_scaled(sum, p, 1.0 / points.len() as f64));
        let points: Vec<[f64; 3]> = points.iter().map(|&p| vec3::sub(p, middle)).collect();
        let scene = if is_object { cascade::Scene::Object } else { cascade::Scene::Terrain };
        let (field, _) = cascade::fit(&points, &FitParams::new(scene, 1.0 / 30.0), &()).unwrap();
        Arc::new(LatticeSolid::new(field, Metric::Sign))
    };
    Arc::clone(FITTED[usize::from(is_object)].get_or_init(fit)) as Any
}

/// Small fits to a ball, linear, quadratic and radial; fitted once.
fn small_fits() -> Vec<Any> {
    static FITTED: OnceLock<Vec<Arc<ExpansionField>>> = OnceLock::new();
    let fit = || {
        let points: Vec<[f64; 3]> =
            Scene::new(SceneKind::Sphere, 1).points(600, 0.0, 1).points.iter().map(|&p| vec3::scale(p, 1.4)).collect();
        let mut data = Data::new();
        data.points(&points, 1.0).unwrap();
        let lattice = |n: u32| SimplicialMesh::<3>::lattice([-1.0, -1.1, -1.0], [1.0; 3], [n; 3]).unwrap();
        let centres = || farthest_points(&points, 40).into_iter().map(|i| points[i]).collect::<Vec<_>>();
        let radial = |kernel, tail| -> Arc<dyn Basis<3> + Send> {
            let centres = centres().into_iter().chain([[0.0; 3]]).collect();
            Arc::new(Radial::new(lattice(8), kernel, centres, tail).unwrap())
        };
        let bases: Vec<Arc<dyn Basis<3> + Send>> = vec![
            Arc::new(P1::new(lattice(6))),
            Arc::new(P2::new(lattice(3))),
            radial(Kernel::Gaussian { width: 0.6 }, Tail::Constant),
            radial(Kernel::Multiquadric { width: 0.4 }, Tail::Linear),
            radial(Kernel::InverseMultiquadric { width: 0.4 }, Tail::Constant),
            radial(Kernel::ThinPlate { width: 1.0 }, Tail::Linear),
            radial(Kernel::WendlandC2 { width: 1.2 }, Tail::Constant),
            radial(Kernel::WendlandC4 { width: 1.2 }, Tail::Constant),
        ];
        let one = |basis: Arc<dyn Basis<3> + Send>| {
            let (smoothness, normalization) = (Order2 { weight: 1e-4 }, SquaredGradient::default());
            let fit = NormalizedFit::new(&*basis, &data).smoothness(&smoothness).normalization(&normalization);
            let fit = fit.run().unwrap();
            // Gradients of about 1, as the tests compare them with differences.
            let f = fit.function(&*basis);
            let steepness: f64 = points.iter().map(|&p| vec3::norm(f.gradient(p).unwrap())).sum::<f64>() / 600.0;
            let coefficients = fit.coefficients.iter().map(|c| c / steepness).collect();
            Arc::new(ExpansionField::new(Arc::clone(&basis), coefficients).unwrap())
        };
        bases.into_iter().map(one).collect()
    };
    FITTED.get_or_init(fit).iter().map(|field| Arc::clone(field) as Any).collect()
}

fn primitives() -> Vec<Any> {
    vec![
        fitted(SceneKind::Torus),
        fitted(SceneKind::City),
        Arc::new(HalfSpace::new([0.1, 0.2, 0.0], [1.0, -2.0, 0.5]).unwrap()),
        Arc::new(Cuboid::new([0.7, -0.5, -0.3], [-0.6, 0.6, 0.8]).unwrap()),
        Arc::new(Ball::new([0.1, -0.2, 0.3], 0.6).unwrap()),
        Arc::new(Frustum::cylinder([[-0.4, 0.3, -0.5], [0.4, -0.2, 0.6]], 0.4).unwrap()),
        Arc::new(Frustum::new([[0.0, 0.1, -0.6], [0.2, 0.0, 0.7]], [0.7, 0.0]).unwrap()),
        Arc::new(Frustum::new([[0.0, 0.1, -0.6], [0.2, 0.0, 0.7]], [0.2, 0.6]).unwrap()),
        Arc::new(prism()),
        Arc::new(heights()),
        Arc::new(solid()),
    ]
}

fn placed(field: Any) -> Any {
    let turned = Placement::default().turned([1.0, 2.0, -0.5], 0.8, [0.0; 3]).unwrap();
    let scaled = turned.scaled(0.9, [0.0; 3]).unwrap();
    Arc::new(Placed::new(field, scaled.moved([0.1, -0.1, 0.05]).unwrap()))
}

/// A random tree over the primitives.
fn tree(rng: &mut Pcg64Mcg, depth: usize) -> Any {
    if depth == 0 {
        let mut all = primitives();
        return all.swap_remove(rng.random_range(0..all.len()));
    }
    let mut below = || tree(rng, depth - 1);
    let (a, b) = (below(), below());
    match rng.random_range(0..8) {
        0 => Arc::new(Union::new(vec![a, b]).unwrap()),
        1 => Arc::new(Intersection::new(vec![a, b]).unwrap()),
        2 => Arc::new(Difference::new(a, b)),
        3 => Arc::new(Complement::new(a)),
        4 => Arc::new(SmoothUnion::new(a, b, 0.2).unwrap()),
        5 => Arc::new(Offset::new(a, 0.1).unwrap()),
        6 => Arc::new(Shell::new(a, 0.15).unwrap()),
        _ => placed(a),
    }
}

fn every_field() -> Vec<Any> {
    let mut rng = Pcg64Mcg::seed_from_u64(5);
    let trees: Vec<Any> = (0..24).map(|i| tree(&mut rng, 1 + i % 3)).collect();
    let one_each = || primitives().into_iter().chain(small_fits());
    one_each().chain(one_each().map(placed)).chain(trees).collect()
}

#[test]
fn bounds_hold_every_value() {
    every_field().into_par_iter().for_each(|field| {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for _ in 0..100_000 {
            let (a, size) = (position(&mut rng, 1.5), 10.0_f64.powf(-3.0 * rng.random::<f64>()));
            let b = vec3::add_scaled(a, position(&mut rng, 1.0).map(f64::abs), size);
            let bounds = field.bounds(a, b);
            // Corners and faces as often as the inside.
            let t: [f64; 3] = std::array::from_fn(|_| [0.0, 1.0, rng.random::<f64>()][rng.random_range(0..3)]);
            let p = std::array::from_fn(|i| (a[i] + t[i] * (b[i] - a[i])).clamp(a[i], b[i]));
            assert!(bounds.contains(field.value(p)), "{} in {bounds:?} at {p:?} of {field:?}", field.value(p));
        }
    });
}

#[test]
fn values_are_the_same_one_by_one_and_all_at_once() {
    let mut rng = Pcg64Mcg::seed_from_u64(6);
    for field in every_field() {
        let points: Vec<[f64; 3]> = (0..3000).map(|_| position(&mut rng, 1.5)).collect();
        let mut found = vec![(f64::NAN, [f64::NAN; 3]); points.len()];
        field.evaluate(&points, &mut found);
        for (&p, found) in points.iter().zip(found) {
            assert_eq!(found, (field.value(p), field.gradient(p)), "{p:?} of {field:?}");
            assert_eq!(found, field.value_and_gradient(p), "{p:?} of {field:?}");
        }
    }
}

#[test]
fn gradients_are_central_differences_away_from_creases() {
    let (mut rng, step) = (Pcg64Mcg::seed_from_u64(2), 1e-6);
    for field in every_field() {
        let mut compared = 0;
        for _ in 0..600 {
            let p = position(&mut rng, 1.3);
            let at = |q: [f64; 3]| (field.sheet(q), field.gradient(q));
            let around: Vec<_> = (0..6)
                .map(|k| {
                    let mut q = p;
                    q[k / 2] += if k % 2 == 0 { step } else { -step };
                    (field.value(q), at(q))
                })
                .collect();
            let own = at(p);
            let is_smooth = |(sheet, g): &(u32, [f64; 3])| *sheet == own.0 && vec3::distance(*g, own.1) < 1e-4;
            if !around.iter().all(|(_, at)| is_smooth(at)) {
                continue;
            }
            compared += 1;
            let difference: [f64; 3] = std::array::from_fn(|a| (around[2 * a].0 - around[2 * a + 1].0) / (2.0 * step));
            assert!(vec3::distance(difference, own.1) < 1e-4, "{difference:?}, {:?} at {p:?} of {field:?}", own.1);
        }
        assert!(compared > 300, "{compared} of {field:?}");
    }
}

#[test]
fn sheets_carry_the_value_at_the_surface() {
    let mut rng = Pcg64Mcg::seed_from_u64(3);
    for field in every_field() {
        let (mut near, mut same) = (0, 0);
        for _ in 0..3000 {
            // Down to the surface, as far as it is smooth.
            let mut p = position(&mut rng, 1.2);
            for _ in 0..30 {
                let (value, g) = (field.value(p), field.gradient(p));
                p = vec3::add_scaled(p, g, -value / vec3::norm_squared(g).max(1e-9));
            }
            if field.value(p).abs() > 1e-9 {
                continue;
            }
            near += 1;
            let sheet = field.sheet(p);
            assert!(sheet < field.sheets(), "{field:?}");
            let (value, gradient) = field.on_sheet(sheet, p);
            same +=
                usize::from(value.abs() < 1e-6 && (vec3::norm(gradient) - vec3::norm(field.gradient(p))).abs() < 0.5);
        }
        // Newton's steps may end on an edge, which is of either side.
        assert!(same as f64 >= 0.99 * f64::from(near), "{same} of {near} of {field:?}");
    }
}

#[test]
fn distances_are_those_to_the_surface() {
    let mut rng = Pcg64Mcg::seed_from_u64(4);
    let mut close = |field: &dyn Field| {
        let mut surface: Vec<[f64; 3]> = Vec::new();
        while surface.len() < 20_000 {
            let mut p = position(&mut rng, 1.1);
            for _ in 0..12 {
                p = vec3::add_scaled(p, field.gradient(p), -field.value(p));
            }
            if field.value(p).abs() < 1e-12 {
                surface.push(p);
            }
        }
        crate::spatial::PointTree::new(&surface)
    };
    let mut fields = primitives();
    fields.retain(|field| field.metric() == Metric::Distance && field.extent().is_some());
    assert_eq!(fields.len(), 7);
    for field in fields {
        let tree = close(&*field);
        let mut rng = Pcg64Mcg::seed_from_u64(6);
        for _ in 0..300 {
            let p = position(&mut rng, 1.2);
            let nearest = tree.nearest(p).unwrap().distance_squared.sqrt();
            let value = field.value(p).abs();
            // Never nearer than |F|; and as near as a sample of the surface lets one see.
            assert!(value <= nearest + 1e-9, "{value} {nearest} at {p:?} of {field:?}");
            assert!(nearest < value + 0.12, "{value} {nearest} at {p:?} of {field:?}");
        }
    }
}

#[test]
fn extents_hold_the_surface() {
    for field in every_field() {
        let Some([low, high]) = field.extent() else { continue };
        let mut rng = Pcg64Mcg::seed_from_u64(9);
        for _ in 0..20_000 {
            let p = position(&mut rng, 2.5);
            if (0..3).all(|a| low[a] <= p[a] && p[a] <= high[a]) {
                continue;
            }
            // Outside the sign is the same on the whole way to far away.
            let q = p.map(|c| 10.0 * c);
            let is_beyond = (0..3).any(|a| (p[a] < low[a] && p[a] < 0.0) || (p[a] > high[a] && p[a] > 0.0));
            assert!(!is_beyond || (field.value(p) < 0.0) == (field.value(q) < 0.0), "{p:?} of {field:?}");
        }
    }
}

#[test]
fn signs_are_right() {
    let inside: Vec<(Any, [f64; 3], bool)> = vec![
        (Arc::new(prism()), [-0.7, 0.8, 0.0], true),
        (Arc::new(prism()), [0.5, 0.5, 0.0], false),
        (Arc::new(prism()), [-0.35, -0.3, 0.0], false),
        (Arc::new(prism()), [-0.35, -0.7, 0.6], false),
        (Arc::new(heights()), [0.0, 0.0, -2.0], true),
        (Arc::new(heights()), [5.0, 5.0, 2.0], false),
        // Far from what is known, within the lattice and beyond it.
        (fitted(SceneKind::City), [0.0, 0.0, 0.4], false),
        (fitted(SceneKind::City), [0.2, -0.1, -0.3], true),
        (fitted(SceneKind::City), [9.0, -9.0, -9.0], true),
        (fitted(SceneKind::City), [9.0, -9.0, 9.0], false),
        (fitted(SceneKind::Torus), [0.0, 0.0, 0.0], false),
        (fitted(SceneKind::Torus), [0.0, 4.0, 0.0], false),
        (primitives().remove(6), [0.2, 0.0, 0.75], false),
        (primitives().remove(6), [0.19, 0.0, 0.6], true),
    ];
    for (field, p, is_inside) in inside {
        assert_eq!(field.value(p) < 0.0, is_inside, "{p:?} of {field:?}");
    }
}

#[test]
fn laws_of_boolean_operations_hold() {
    let mut rng = Pcg64Mcg::seed_from_u64(7);
    let or = |a: &Any, b: &Any| -> Any { Arc::new(Union::new(vec![Arc::clone(a), Arc::clone(b)]).unwrap()) };
    let and = |a: &Any, b: &Any| -> Any { Arc::new(Intersection::new(vec![Arc::clone(a), Arc::clone(b)]).unwrap()) };
    let not = |a: &Any| -> Any { Arc::new(Complement::new(Arc::clone(a))) };
    let minus = |a: &Any, b: &Any| -> Any { Arc::new(Difference::new(Arc::clone(a), Arc::clone(b))) };
    for _ in 0..40 {
        let [a, b, c] = std::array::from_fn(|_| {
            let depth = rng.random_range(0..3);
            tree(&mut rng, depth)
        });
        let same: [(Any, Any); 12] = [
            (not(&or(&a, &b)), and(&not(&a), &not(&b))),
            (not(&and(&a, &b)), or(&not(&a), &not(&b))),
            (or(&a, &a), Arc::clone(&a)),
            (and(&a, &a), Arc::clone(&a)),
            (or(&a, &and(&a, &b)), Arc::clone(&a)),
            (and(&a, &or(&a, &b)), Arc::clone(&a)),
            (or(&a, &b), or(&b, &a)),
            (and(&a, &b), and(&b, &a)),
            (or(&a, &or(&b, &c)), or(&or(&a, &b), &c)),
            (and(&a, &and(&b, &c)), and(&and(&a, &b), &c)),
            (not(&not(&a)), Arc::clone(&a)),
            (minus(&a, &b), and(&a, &not(&b))),
        ];
        for (k, (left, right)) in same.iter().enumerate() {
            for _ in 0..60 {
                let p = position(&mut rng, 1.5);
                assert_eq!(left.value(p), right.value(p), "law {k} at {p:?}");
            }
        }
    }
}

#[test]
fn a_smooth_union_is_a_union_away_from_the_seam() {
    let (a, b) = (primitives().remove(3), primitives().remove(4));
    let sharp = Union::new(vec![Arc::clone(&a), Arc::clone(&b)]).unwrap();
    let smooth = SmoothUnion::new(Arc::clone(&a), Arc::clone(&b), 0.1).unwrap();
    let mut rng = Pcg64Mcg::seed_from_u64(8);
    for _ in 0..2000 {
        let p = position(&mut rng, 1.2);
        let (s, t) = (sharp.value(p), smooth.value(p));
        assert!(t <= s && s - t <= 0.025 + 1e-12);
        assert!((a.value(p) - b.value(p)).abs() < 0.1 || s == t);
    }
}

#[test]
fn bad_shapes_are_refused() {
    let message = |error: Result<(), FieldError>| error.unwrap_err().to_string();
    assert_eq!(message(Ball::new([0.0; 3], -1.0).map(drop)), "a radius of -1 is not possible: give a positive length");
    assert_eq!(
        message(Ball::new([f64::NAN; 3], 1.0).map(drop)),
        "a coordinate of NaN is not possible: give a finite number"
    );
    for error in [
        Cuboid::new([0.0; 3], [1.0, 0.0, 1.0]).map(drop),
        HalfSpace::new([0.0; 3], [0.0; 3]).map(drop),
        Frustum::cylinder([[0.0; 3]; 2], 1.0).map(drop),
        Frustum::new([[0.0; 3], [1.0; 3]], [0.0; 2]).map(drop),
        Prism::new(&[vec![[0.0, 0.0], [1.0, 1.0]]], [0.0, 1.0]).map(drop),
        Prism::new(&[ring(4, 1.0, [0.0; 2], 0.0)], [1.0, 1.0]).map(drop),
        HeightField::new([0.0; 2], [1.0; 2], [2, 2], vec![0.0; 3]).map(drop),
        Union::new(Vec::new()).map(drop),
        Shell::new(Arc::new(prism()), 0.0).map(drop),
    ] {
        assert!(!message(error).is_empty());
    }
    let mut open = Scene::new(SceneKind::Box, 3).truth;
    open.triangles.pop();
    assert!(message(MeshSolid::new(&open).map(drop)).contains("not closed"));
}

#[test]
fn small_fits_of_a_ball_are_balls() {
    let ball = Ball::new([0.0; 3], 0.7).unwrap();
    for (k, field) in small_fits().iter().enumerate() {
        assert!(field.extent().is_some(), "{k}");
        let (mesh, _) = contour_field(&**field, &FieldContourParams { cell: 0.06, bounds: None }, &()).unwrap();
        let topology = topology(&mesh).unwrap();
        assert!(topology.closed && topology.components.len() == 1 && topology.genus == Some(0), "{k}: {topology:?}");
        let off = mesh.vertices.iter().map(|&v| ball.value(v).abs()).fold(0.0, f64::max);
        // Linear functions on six cells across can do no better.
        let most = if k == 0 { 0.045 } else { 0.02 };
        assert!(off < most, "{k}: {off}");
    }
    let turned = Placed::new(small_fits().remove(2), Placement::default().moved([2.0, 0.0, 0.0]).unwrap());
    let both = Union::new(vec![Arc::new(turned), small_fits().remove(1)]).unwrap();
    assert!(both.value([2.0, 0.0, 0.0]) < 0.0 && both.value([0.0; 3]) < 0.0 && both.value([1.0, 0.0, 0.0]) > 0.0);
}

#[test]
fn expansions_that_are_not_known_everywhere_are_refused() {
    let tetrahedron = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let domain = SimplicialMesh::from_tetrahedra(tetrahedron, &[[0, 1, 2, 3]]).unwrap();
    assert!(ExpansionField::new(Arc::new(P1::new(domain)), vec![1.0; 4]).is_err());
    let basis = || Arc::new(P1::new(SimplicialMesh::<3>::lattice([0.0; 3], [1.0; 3], [1; 3]).unwrap()));
    assert!(ExpansionField::new(basis(), vec![1.0; 7]).is_err());
    assert!(ExpansionField::new(basis(), vec![f64::NAN; 8]).is_err());
    assert!(ExpansionField::new(basis(), vec![1.0; 8]).is_ok());
}
