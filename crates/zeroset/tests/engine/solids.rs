//! Solids made of others, as meshes: exact volumes, sharp edges, closed surfaces.

use std::f64::consts::PI;
use std::sync::Arc;

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use zeroset::contour::{FieldContourError, FieldContourParams, FieldContourReport, contour_field};
use zeroset::field::{
    Ball, Complement, Cuboid, Difference, Field, Frustum, HalfSpace, Intersection, MeshSolid, Offset, Placed,
    Placement, Prism, Shell, SmoothUnion, Union,
};
use zeroset::mesh::{Mesh, self_intersections, topology};
use zeroset::spatial::TriangleTree;

type Vec3 = [f64; 3];
type Any = Arc<dyn Field>;

fn add(a: Vec3, b: Vec3, t: f64) -> Vec3 {
    std::array::from_fn(|i| a[i] + t * b[i])
}

fn dot(a: Vec3, b: Vec3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vec3, b: Vec3) -> Vec3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn norm(a: Vec3) -> f64 {
    dot(a, a).sqrt()
}

/// The mesh of a field, which must be closed, embedded and manifold, with this genus and, to a thousandth, this volume.
fn extracted(field: &dyn Field, cell: f64, genus: u64, volume: f64) -> Mesh {
    let params = FieldContourParams { cell, bounds: None };
    let (mesh, report) = contour_field(field, &params, &()).unwrap();
    let t = topology(&mesh).unwrap();
    assert!(t.closed && t.nonmanifold_edges + t.nonmanifold_vertices + t.degenerate_triangles == 0, "{t:?}");
    assert_eq!((t.genus, report.intersections), (Some(genus), 0), "{report:?} {t:?}");
    let cuts = self_intersections(&mesh, 3, &()).unwrap();
    assert_eq!(cuts.pairs, 0, "{:?}", cuts.listed);
    let error = t.volume.unwrap() / volume - 1.0;
    assert!(error.abs() < 0.001, "volume {} of {volume}", t.volume.unwrap());
    mesh
}

/// The edges of a mesh that turn by more than 30 degrees.
fn creases(mesh: &Mesh) -> Vec<[Vec3; 2]> {
    let normal = |t: usize| {
        let [a, b, c] = mesh.triangles[t].map(|v| mesh.vertices[v as usize]);
        cross(add(b, a, -1.0), add(c, a, -1.0))
    };
    let mut sides: Vec<([u32; 2], usize)> = Vec::new();
    for (t, corners) in mesh.triangles.iter().enumerate() {
        sides.extend((0..3).map(|i| [corners[i], corners[(i + 1) % 3]]).map(|[a, b]| ([a.min(b), a.max(b)], t)));
    }
    sides.sort_unstable();
    let sharp = sides.chunk_by(|a, b| a.0 == b.0).filter(|pair| {
        let [m, n] = [normal(pair[0].1), normal(pair[1].1)];
        dot(m, n) < (PI / 6.0).cos() * norm(m) * norm(n)
    });
    sharp.map(|pair| pair[0].0.map(|v| mesh.vertices[v as usize])).collect()
}

/// Checks that creases lie where two sheets of the field meet, and that places of true edges have a crease near: on average within
/// a twentieth of a cell, and everywhere within two: features may be nearer to each other than a cell.
fn assert_creases(mesh: &Mesh, field: &dyn Field, cell: f64, edges: &[Vec3]) {
    let found = creases(mesh);
    let off = found.iter().map(|&[a, b]| {
        let middle = add(a, add(b, a, -1.0), 0.5);
        let mut distances: Vec<f64> = (0..field.sheets()).map(|s| field.on_sheet(s, middle).0.abs()).collect();
        distances.sort_by(f64::total_cmp);
        (distances[1].max(field.value(middle).abs()) / cell, norm(add(b, a, -1.0)))
    });
    let (worst, sum, length) = off.fold((0.0_f64, 0.0, 0.0), |(w, s, l), (d, own)| (w.max(d), s + d * own, l + own));
    assert!(sum < 0.05 * length && worst < 2.0, "creases are {} cells off, {worst} at most", sum / length);
    let tree = TriangleTree::from_segments(&found);
    let distances: Vec<f64> = edges.iter().map(|&p| tree.closest(p).unwrap().distance_squared.sqrt() / cell).collect();
    let (mean, worst) =
        (distances.iter().sum::<f64>() / edges.len().max(1) as f64, distances.iter().fold(0.0, |w: f64, d| w.max(*d)));
    assert!(mean < 0.05 && worst < 2.0, "edges are {mean} cells off, {worst} at most");
}

/// A turned box: its field, its faces as polygons, and the planes of its faces.
struct Turned {
    field: Any,
    faces: Vec<Vec<Vec3>>,
    corners: [Vec3; 8],
}

fn turned(rng: &mut Pcg64Mcg, half: Vec3, middle: Vec3) -> Turned {
    let axis: Vec3 = std::array::from_fn(|_| rng.random::<f64>() - 0.5);
    let (angle, length) = (PI * rng.random::<f64>(), norm(axis));
    let axis = axis.map(|c| c / length);
    let rotate = |p: Vec3| {
        let (s, c) = angle.sin_cos();
        let part = add(add(p.map(|x| c * x), cross(axis, p), s), axis, dot(axis, p) * (1.0 - c));
        add(part, middle, 1.0)
    };
    let brick: Any = Arc::new(Cuboid::new(half.map(|h| -h), half).unwrap());
    let placement = Placement::default().turned(axis, angle, [0.0; 3]).unwrap().moved(middle).unwrap();
    let field = Arc::new(Placed::new(brick, placement));
    let corners: [Vec3; 8] =
        std::array::from_fn(|k| rotate(std::array::from_fn(|a| if k >> a & 1 == 1 { half[a] } else { -half[a] })));
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Turned { field, faces: faces.map(|face| face.map(|k| corners[k]).to_vec()).to_vec(), corners }
}

/// The part of a polygon on the inner side of a face.
fn clipped(polygon: &[Vec3], face: &[Vec3]) -> Vec<Vec3> {
    let normal = cross(add(face[1], face[0], -1.0), add(face[2], face[0], -1.0));
    let side = |p: Vec3| dot(normal, add(p, face[0], -1.0));
    let mut out = Vec::new();
    for (i, &p) in polygon.iter().enumerate() {
        let q = polygon[(i + 1) % polygon.len()];
        let (s, t) = (side(p), side(q));
        if s <= 0.0 {
            out.push(p);
        }
        if (s < 0.0) != (t < 0.0) {
            out.push(add(p, add(q, p, -1.0), s / (s - t)));
        }
    }
    out
}

/// The volume that two convex solids share: a sixth of the cones over the faces, each cut by the other solid.
fn shared_volume(a: &Turned, b: &Turned) -> f64 {
    let cone = |face: &Vec<Vec3>, other: &Turned| -> f64 {
        let part = other.faces.iter().fold(face.clone(), |part, cut| clipped(&part, cut));
        (2..part.len()).map(|i| dot(part[0], cross(part[i - 1], part[i])) / 6.0).sum()
    };
    a.faces.iter().map(|face| cone(face, b)).sum::<f64>() + b.faces.iter().map(|face| cone(face, a)).sum::<f64>()
}

/// Places along the edges of a box that lie well outside of another solid.
fn edges_outside(own: &Turned, other: &dyn Field, margin: f64) -> Vec<Vec3> {
    let pairs = (0..8).flat_map(|k| (0..3).filter(move |a| k >> a & 1 == 0).map(move |a| (k, k | 1 << a)));
    let places = pairs.flat_map(|(i, j)| {
        (0..=40).map(move |s| add(own.corners[i], add(own.corners[j], own.corners[i], -1.0), f64::from(s) / 40.0))
    });
    places.filter(|&p| other.value(p) > margin).collect()
}

#[test]
fn a_box_with_a_bore() {
    let block: Any = Arc::new(Cuboid::new([-1.0, -0.8, -0.5], [1.0, 0.8, 0.5]).unwrap());
    let bore: Any = Arc::new(Frustum::cylinder([[0.1, 0.0, -1.0], [0.1, 0.0, 1.0]], 0.45).unwrap());
    let part = Difference::new(block, bore);
    for cell in [0.1, 0.05] {
        let mesh = extracted(&part, cell, 1, 2.0 * 1.6 - PI * 0.45 * 0.45);
        let rims = (0..200)
            .map(|i| f64::from(i) / 100.0 * PI)
            .flat_map(|t| [-0.5, 0.5].map(|z| [0.1 + 0.45 * t.cos(), 0.45 * t.sin(), z]));
        // A chord is off its arc by an eighth of its square over the radius.
        let mut edges: Vec<Vec3> = rims.collect();
        edges.extend((0..=40).map(|i| [1.0, 0.8, f64::from(i) / 40.0 - 0.5]));
        assert_creases(&mesh, &part, cell, &edges);
    }
}

#[test]
fn two_boxes_at_random_angles() {
    let mut rng = Pcg64Mcg::seed_from_u64(1);
    let (mut tried, cell) = (0, 0.03);
    while tried < 8 {
        let half = |rng: &mut Pcg64Mcg| std::array::from_fn(|_| 0.4 + 0.5 * rng.random::<f64>());
        let (h, k) = (half(&mut rng), half(&mut rng));
        let a = turned(&mut rng, h, [0.0; 3]);
        let b = turned(&mut rng, k, [0.5, 0.3, 0.2]);
        // Where faces meet at less than a lattice can see, the tip of the wedge is ragged (the docs tell).
        let normals =
            [&a, &b].map(|t| [1, 2, 4].map(|k| add(t.corners[k], t.corners[0], -1.0)).map(|e| e.map(|c| c / norm(e))));
        if normals[0].iter().any(|&m| normals[1].iter().any(|&n| dot(m, n).abs() > (PI / 6.0).cos())) {
            continue;
        }
        // Nor does it see features that are nearer to each other than some cells.
        let clear = |own: &Turned, other: &Turned| own.corners.iter().all(|&c| other.field.value(c).abs() > 3.0 * cell);
        let near = |p: Vec3| edges_outside(&b, &*a.field, -9.0).iter().any(|&q| norm(add(p, q, -1.0)) < 3.0 * cell);
        if !clear(&a, &b) || !clear(&b, &a) || edges_outside(&a, &*b.field, -9.0).into_iter().any(near) {
            continue;
        }
        tried += 1;
        let both = shared_volume(&a, &b);
        let volumes = [h, k].map(|half: Vec3| 8.0 * half[0] * half[1] * half[2]);
        let union = Union::new(vec![Arc::clone(&a.field), Arc::clone(&b.field)]).unwrap();
        let mesh = extracted(&union, cell, 0, volumes[0] + volumes[1] - both);
        let mut edges = edges_outside(&a, &*b.field, 2.0 * cell);
        edges.extend(edges_outside(&b, &*a.field, 2.0 * cell));
        assert_creases(&mesh, &union, cell, &edges);
        let common = Intersection::new(vec![Arc::clone(&a.field), Arc::clone(&b.field)]).unwrap();
        let mesh = extracted(&common, cell, 0, both);
        assert_creases(&mesh, &common, cell, &[]);
    }
}

/// A brick turned about x, y and z by degrees, and moved.
fn turned_by(half: Vec3, degrees: Vec3, middle: Vec3) -> Any {
    let mut placement = Placement::default();
    for (axis, angle) in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].into_iter().zip(degrees) {
        placement = placement.turned(axis, angle.to_radians(), [0.0; 3]).unwrap();
    }
    let brick: Any = Arc::new(Cuboid::new(half.map(|h| -h), half).unwrap());
    Arc::new(Placed::new(brick, placement.moved(middle).unwrap()))
}

#[test]
fn walls_that_taper_to_nothing_have_no_handles() {
    // Angles, and from exact meshes (manifold3d) the genus of each piece, the greatest first, and the volume.
    let cases: [(Vec3, Vec3, &[u64], f64); 2] = [
        (
            [-10.983215349600158, -54.56697673170658, -54.14907471273983],
            [59.90113380780858, 18.28429339055853, -31.858775799621128],
            &[1, 0],
            1.947687539813416,
        ),
        (
            [-7.806293732982958, 56.902343191110646, 47.72131297302586],
            [41.30772451304891, -12.911440279826621, -0.8372377521908874],
            &[0],
            1.8595256575007821,
        ),
    ];
    for (first, second, genus, volume) in cases {
        let base = turned_by([1.0, 0.8, 0.6], first, [0.0; 3]);
        let field = Difference::new(base, turned_by([0.5, 0.5, 1.4], second, [0.1, 0.05, 0.0]));
        let (mesh, report) = contour_field(&field, &FieldContourParams { cell: 0.02, bounds: None }, &()).unwrap();
        let t = topology(&mesh).unwrap();
        assert!(t.closed && report.intersections == 0, "{report:?} {t:?}");
        let found: Vec<u64> = t.components.iter().map(|component| component.genus.unwrap()).collect();
        assert_eq!(found, genus, "{t:?}");
        assert!((t.volume.unwrap() / volume - 1.0).abs() < 1e-4, "{t:?}");
    }
}

#[test]
fn walls_of_two_cells_keep_their_handle() {
    // All of this pipe of twelve sides is thinner than what is taken off on the way.
    let prism = |radius: f64, height: f64| {
        let corner = |k: u32| (f64::from(k) * PI / 6.0).sin_cos();
        let ring = (0..12).map(corner).map(|(sin, cos)| [radius * cos, radius * sin]).collect();
        Arc::new(Prism::new(&[ring], [-height, height]).unwrap())
    };
    let (cell, apothem) = (0.05, (PI / 12.0).cos());
    let inner = 1.0 - 2.0 * cell / apothem;
    let pipe = Difference::new(prism(1.0, 0.5), prism(inner, 2.0));
    extracted(&pipe, cell, 1, 3.0 - 3.0 * inner * inner);
}

#[test]
fn eight_boxes() {
    // Overlapping bricks around a hole; the faces of neighbours meet at 45 degrees or more.
    let brick = |k: usize| -> Any {
        let middle = [(k as f64 * PI / 4.0).cos(), (k as f64 * PI / 4.0).sin(), 0.0];
        let own: Any =
            Arc::new(Cuboid::new([-0.18, -0.62, -0.2 - 0.05 * k as f64], [0.18, 0.62, 0.2 + 0.06 * k as f64]).unwrap());
        let placement = Placement::default().turned([0.0, 0.0, 1.0], k as f64 * PI / 4.0, [0.0; 3]).unwrap();
        Arc::new(Placed::new(own, placement.moved(middle).unwrap()))
    };
    let ring = Union::new((0..8).map(brick).collect()).unwrap();
    // By layers: the areas of the plan, counted finely, times their heights.
    let plan = |z: f64| {
        let n = 2000;
        let inside = (0..n * n).filter(|i| {
            let p = [(i % n) as f64 + 0.5, (i / n) as f64 + 0.5].map(|c| 3.4 * c / n as f64 - 1.7);
            ring.value([p[0], p[1], z]) < 0.0
        });
        inside.count() as f64 * (3.4 / n as f64).powi(2)
    };
    let mut levels: Vec<f64> = (0..8).flat_map(|k| [-0.2 - 0.05 * f64::from(k), 0.2 + 0.06 * f64::from(k)]).collect();
    levels.sort_by(f64::total_cmp);
    let volume: f64 = levels.windows(2).map(|l| (l[1] - l[0]) * plan(0.5 * (l[0] + l[1]))).sum();
    let mesh = extracted(&ring, 0.04, 1, volume);
    assert_creases(&mesh, &ring, 0.04, &[]);
}

#[test]
fn round_things() {
    let ball: Any = Arc::new(Ball::new([0.1, 0.2, 0.3], 0.7).unwrap());
    let mesh = extracted(&*ball, 0.05, 0, 4.0 / 3.0 * PI * 0.343);
    assert!(creases(&mesh).is_empty());
    let cone: Any = Arc::new(Frustum::new([[0.0; 3], [0.3, 0.0, 1.2]], [0.8, 0.0]).unwrap());
    let length = norm([0.3, 0.0, 1.2]);
    extracted(&*cone, 0.04, 0, PI * 0.64 * length / 3.0);
    let shell = Shell::new(Arc::clone(&ball), 0.2).unwrap();
    let (mesh, _) = contour_field(&shell, &FieldContourParams { cell: 0.05, bounds: None }, &()).unwrap();
    let t = topology(&mesh).unwrap();
    assert_eq!((t.components.len(), t.closed), (2, true));
    let exact = 4.0 / 3.0 * PI * (0.8_f64.powi(3) - 0.6_f64.powi(3));
    assert!((t.volume.unwrap() / exact - 1.0).abs() < 0.001, "{:?}", t.volume);
    // A box grown by a ball: faces, quarter cylinders, eighths of balls.
    let brick: Any = Arc::new(Cuboid::new([0.0; 3], [1.0, 0.8, 0.6]).unwrap());
    let r: f64 = 0.2;
    let exact = 0.48 + 2.0 * r * (0.8 + 0.6 + 0.48) + PI * r * r * 2.4 + 4.0 / 3.0 * PI * r.powi(3);
    let mesh = extracted(&Offset::new(Arc::clone(&brick), r).unwrap(), 0.04, 0, exact);
    assert!(creases(&mesh).is_empty());
    let smooth = SmoothUnion::new(brick, Arc::new(Ball::new([0.5, 0.4, 0.7], 0.3).unwrap()), 0.1).unwrap();
    let (mesh, _) = contour_field(&smooth, &FieldContourParams { cell: 0.03, bounds: None }, &()).unwrap();
    assert!(topology(&mesh).unwrap().closed);
}

#[test]
fn a_footprint_with_a_court_and_a_mesh_keep_their_edges() {
    let outer = vec![[0.0, 0.0], [2.0, 0.3], [2.2, 1.9], [1.2, 1.3], [-0.1, 1.7]];
    let court = vec![[0.6, 0.6], [1.2, 0.6], [1.2, 1.0], [0.6, 1.0]];
    let area = |ring: &[[f64; 2]]| -> f64 {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
    };
    let volume = 0.9 * (area(&outer) - area(&court));
    let walls: Vec<Vec3> = outer
        .iter()
        .chain(&court)
        .flat_map(|&[x, y]| (0..=20).map(move |i| [x, y, 0.1 + 0.045 * f64::from(i)]))
        .collect();
    let house = Prism::new(&[outer, court], [0.1, 1.0]).unwrap();
    let mesh = extracted(&house, 0.05, 1, volume);
    assert_creases(&mesh, &house, 0.05, &walls);
    // Its mesh is a solid again.
    let solid = MeshSolid::new(&mesh).unwrap();
    let again = extracted(&solid, 0.06, 1, volume);
    assert_creases(&again, &solid, 0.06, &walls);
}

#[test]
fn surfaces_without_end_are_cut_at_the_box() {
    let ground: Any = Arc::new(HalfSpace::new([0.0; 3], [0.1, 0.0, 1.0]).unwrap());
    let params = FieldContourParams { cell: 0.1, bounds: None };
    assert_eq!(contour_field(&*ground, &params, &()).unwrap_err(), FieldContourError::NoBounds);
    let pit = Difference::new(Arc::clone(&ground), Arc::new(Ball::new([0.0; 3], 0.5).unwrap()));
    let params = FieldContourParams { cell: 0.1, bounds: Some([[-1.0; 3], [1.0; 3]]) };
    let (mesh, _): (Mesh, FieldContourReport) = contour_field(&pit, &params, &()).unwrap();
    let t = topology(&mesh).unwrap();
    assert_eq!((t.boundary_loops, t.components.len(), t.nonmanifold_edges), (1, 1, 0));
    let [low, high] = t.bounds.unwrap();
    assert!((0..2).all(|a| (low[a] + 1.0).abs() < 1e-6 && (high[a] - 1.0).abs() < 1e-6), "{low:?} {high:?}");
    let missing = contour_field(
        &*ground,
        &FieldContourParams { cell: 0.1, bounds: Some([[0.0, 0.0, 5.0], [1.0, 1.0, 6.0]]) },
        &(),
    );
    assert_eq!(missing.unwrap_err(), FieldContourError::NoSurface);
    let empty = contour_field(&*ground, &FieldContourParams { cell: 0.1, bounds: Some([[0.0; 3]; 2]) }, &());
    assert_eq!(empty.unwrap_err(), FieldContourError::EmptyBounds);
    let inside = Complement::new(Arc::new(Ball::new([0.0; 3], 0.5).unwrap()));
    let (mesh, _) = contour_field(&inside, &FieldContourParams { cell: 0.1, bounds: None }, &()).unwrap();
    assert!(topology(&mesh).unwrap().volume.unwrap() < 0.0);
}

#[test]
fn the_same_on_any_number_of_threads() {
    let a: Any = Arc::new(Cuboid::new([0.0; 3], [1.0; 3]).unwrap());
    let b: Any = Arc::new(Ball::new([1.0; 3], 0.6).unwrap());
    let part = Difference::new(a, b);
    let made = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| contour_field(&part, &FieldContourParams { cell: 0.03, bounds: None }, &()).unwrap().0)
    };
    let (one, three) = (made(1), made(3));
    assert!(one.vertices == three.vertices && one.triangles == three.triangles);
}
