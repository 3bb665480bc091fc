use super::{mapped, mesh, sheet, together};
use crate::mesh::{Mesh, SelfIntersections, self_intersections};
use crate::sample::{Chance, Scene, SceneKind};
use crate::vec3::{self, Vec3};

/// A whole number below `n`.
fn below(chance: &mut Chance, n: u32) -> u32 {
    (chance.uniform() * f64::from(n)) as u32
}

fn found(mesh: &Mesh) -> SelfIntersections {
    self_intersections(mesh, 100, &()).expect("a sound mesh")
}

fn pairs(vertices: &[Vec3], triangles: &[[u32; 3]]) -> u64 {
    found(&mesh(vertices, triangles)).pairs
}

const FLOOR: [Vec3; 3] = [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];

/// Pairs of [`FLOOR`] with a triangle of three places of its own.
fn with_floor(other: [Vec3; 3]) -> u64 {
    let vertices = [FLOOR, other].concat();
    pairs(&vertices, &[[0, 1, 2], [3, 4, 5]])
}

#[test]
fn triangles_without_a_common_corner() {
    // Through the middle; beside; above; touching with a corner, with an edge, along an edge.
    assert_eq!(with_floor([[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [3.0, 3.0, 0.0]]), 1);
    assert_eq!(with_floor([[1.5, 1.5, -1.0], [1.5, 1.5, 1.0], [3.0, 3.0, 0.0]]), 0);
    assert_eq!(with_floor(FLOOR.map(|p| vec3::add(p, [0.0, 0.0, 1e-300]))), 0);
    assert_eq!(with_floor([[0.5, 0.5, 0.0], [0.5, 0.5, 1.0], [3.0, 3.0, 1.0]]), 1);
    assert_eq!(with_floor([[0.1, 0.1, 0.0], [0.5, 0.5, 0.0], [3.0, 3.0, 1.0]]), 1);
    assert_eq!(with_floor([[0.5, 0.0, 0.0], [1.5, 0.0, 0.0], [1.0, -1.0, 1.0]]), 1);
    // In one plane: inside, across, beside.
    assert_eq!(with_floor([[0.2, 0.2, 0.0], [0.4, 0.2, 0.0], [0.2, 0.4, 0.0]]), 1);
    assert_eq!(with_floor([[-1.0, 0.5, 0.0], [3.0, 0.5, 0.0], [3.0, 0.6, 0.0]]), 1);
    assert_eq!(with_floor([[2.0, 2.0, 0.0], [1.1, 1.1, 0.0], [2.0, 1.0, 0.0]]), 0);
}

#[test]
fn triangles_with_a_common_corner_or_edge() {
    let vertices =
        [FLOOR[0], FLOOR[1], FLOOR[2], [-1.0, -1.0, 0.0], [-1.0, -2.0, 0.0], [1.0, 1.0, 0.0], [0.5, 0.5, 1.0]];
    let with = |other: [u32; 3]| pairs(&vertices, &[[0, 1, 2], other]);
    // At a corner: apart, in one plane and across, standing on the other.
    assert_eq!(with([0, 3, 4]), 0);
    assert_eq!(with([0, 5, 4]), 1);
    assert_eq!(with([0, 6, 5]), 1);
    assert_eq!(with([0, 6, 3]), 0);
    // At an edge: flat, upright, folded over, whichever way round.
    assert_eq!((with([1, 0, 4]), with([1, 0, 6]), with([1, 0, 5]), with([0, 1, 5])), (0, 0, 1, 1));
    // Twice the same, turned over or not.
    assert_eq!((with([0, 1, 2]), with([1, 0, 2])), (1, 1));
}

#[test]
fn places_count_and_not_numbers() {
    let soup = together(&[mesh(&FLOOR, &[[0, 1, 2]]), mesh(&[FLOOR[1], FLOOR[0], [0.0, -1.0, 0.0]], &[[0, 1, 2]])]);
    assert_eq!(found(&soup).pairs, 0);
    // Zero has two signs and is one place.
    let minus = mesh(&[FLOOR[1], [-0.0, 0.0, -0.0], [0.0, -1.0, 0.0]], &[[0, 1, 2]]);
    assert_eq!(found(&together(&[mesh(&FLOOR, &[[0, 1, 2]]), minus])).pairs, 0);
}

#[test]
fn sound_surfaces_have_none_and_needles_are_passed_over() {
    for kind in SceneKind::ALL {
        assert_eq!(found(&Scene::new(kind, 1).truth), SelfIntersections::default(), "{kind}");
    }
    let bent = mapped(&sheet(30), |[x, y, _]| [x, y, (9.0 * x).sin() * (7.0 * y).cos()]);
    assert_eq!(found(&bent).pairs, 0);
    let needle = [[0.5, 0.5, -1.0], [0.5, 0.5, 1.0], [0.5, 0.5, 0.0]];
    assert_eq!(with_floor(needle), 0);
    assert_eq!(found(&Mesh::default()), SelfIntersections::default());
}

#[test]
fn crossing_sheets_are_listed_up_to_the_number_wanted_whatever_the_threads() {
    let upright = mapped(&sheet(40), |[x, y, _]| [x, 0.487, y - 0.513]);
    let crossing = together(&[sheet(40), upright]);
    let all = self_intersections(&crossing, usize::MAX, &()).unwrap();
    // The upright sheet cuts a row of 80 triangles, each of 1/40 at most, in pieces of the same kind.
    assert_eq!(all.pairs, all.listed.len() as u64);
    assert!(all.pairs >= 80 && all.listed.is_sorted(), "{}", all.pairs);
    assert!(all.listed.iter().all(|&[a, b]| a < 3200 && b >= 3200));
    let few = self_intersections(&crossing, 7, &()).unwrap();
    assert_eq!((few.pairs, few.triangles, &few.listed[..]), (all.pairs, all.triangles, &all.listed[..7]));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| self_intersections(&crossing, 7, &()).unwrap()), few);
}

#[test]
fn a_scrambled_mesh_lists_no_more_than_asked_for() {
    let mut chance = Chance::new(3, 0, 0);
    let vertices: Vec<Vec3> = (0..300).map(|_| [(); 3].map(|()| chance.uniform())).collect();
    let scrambled = mesh(&vertices, &(0..2000).map(|_| [(); 3].map(|()| below(&mut chance, 300))).collect::<Vec<_>>());
    let few = self_intersections(&scrambled, 3, &()).unwrap();
    assert!(few.pairs > 100_000 && few.listed.len() == 3, "{few:?}");
}

#[test]
fn broken_meshes_are_refused_and_the_monitor_stops() {
    assert!(self_intersections(&mesh(&FLOOR, &[[0, 1, 3]]), 1, &()).is_err());
    let log = crate::monitor::tests::Log(std::sync::Mutex::default(), 0);
    assert!(self_intersections(&sheet(3), 1, &log).is_err());
}

/// A position as whole numbers over a positive whole number.
type Rational = ([i128; 3], i128);
type Whole = [i128; 3];

fn minus(a: Whole, b: Whole) -> Whole {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Whole, b: Whole) -> i128 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Whole, b: Whole) -> Whole {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn normal([a, b, c]: [Whole; 3]) -> Whole {
    cross(minus(b, a), minus(c, a))
}

/// `p - a`, times the denominator of `p`.
fn from(a: Whole, (p, over): Rational) -> Whole {
    [p[0] - over * a[0], p[1] - over * a[1], p[2] - over * a[2]]
}

/// Whether a position in the plane of a triangle lies in it.
fn holds(triangle: [Whole; 3], p: Rational) -> bool {
    (0..3).all(|i| {
        let (a, b) = (triangle[i], triangle[(i + 1) % 3]);
        dot(normal(triangle), cross(minus(b, a), from(a, p))) >= 0
    })
}

/// Where the line along a segment passes a plane, given the values of its ends, if it does so between them.
fn crossing([p, q]: [Whole; 2], [at_p, at_q]: [i128; 2]) -> Option<Rational> {
    let (apart, sign) = ((at_p - at_q).abs(), (at_p - at_q).signum());
    let along = at_p * sign;
    let between = apart > 0 && (0..=apart).contains(&along);
    between.then(|| (std::array::from_fn(|a| p[a] * apart + along * (q[a] - p[a])), apart))
}

/// The extreme positions of what two triangles have in common, by way of fractions.
fn common(s: [Whole; 3], t: [Whole; 3]) -> Vec<Rational> {
    let mut all = Vec::new();
    for (one, two) in [(s, t), (t, s)] {
        let across = normal(two);
        let heights = one.map(|p| dot(across, minus(p, two[0])));
        for i in 0..3 {
            let edge = [one[i], one[(i + 1) % 3]];
            all.extend(crossing(edge, [heights[i], heights[(i + 1) % 3]]));
            if heights == [0; 3] {
                all.push((one[i], 1));
                // Where it passes upright planes through the edges of the other.
                for j in 0..3 {
                    let wall = cross(across, minus(two[(j + 1) % 3], two[j]));
                    all.extend(crossing(edge, edge.map(|p| dot(wall, minus(p, two[j])))));
                }
            }
        }
    }
    let in_plane = |of: [Whole; 3], p: Rational| dot(normal(of), from(of[0], p)) == 0;
    all.retain(|&p| [s, t].iter().all(|&of| in_plane(of, p) && holds(of, p)));
    all
}

/// The answer by way of fractions; `None` for triangles without area.
fn oracle(s: [Whole; 3], t: [Whole; 3]) -> Option<bool> {
    if normal(s) == [0; 3] || normal(t) == [0; 3] {
        return None;
    }
    let shared: Vec<Whole> = s.into_iter().filter(|p| t.contains(p)).collect();
    let is_shared = |p: Rational| match shared[..] {
        [a] => from(a, p) == [0; 3],
        [a, b] => cross(minus(b, a), from(a, p)) == [0; 3] && dot(from(a, p), from(b, p)) <= 0,
        _ => false,
    };
    Some(shared.len() == 3 || common(s, t).into_iter().any(|p| !is_shared(p)))
}

#[test]
fn random_pairs_agree_with_fractions() {
    let mut chance = Chance::new(5, 0, 0);
    let mut seen = [[0; 2]; 4];
    // Whole numbers of a small range make every special position frequent.
    for round in 0..60_000 {
        let range = [2, 3, 9][round % 3];
        let mut triangle = || [(); 3].map(|()| [(); 3].map(|()| i128::from(below(&mut chance, range))));
        let (s, mut t) = (triangle(), triangle());
        let shared = round % 4;
        t[..shared].copy_from_slice(&s[..shared]);
        t.rotate_left(round % 5 % 3);
        let Some(expected) = oracle(s, t) else { continue };
        let vertices: Vec<Vec3> = [s, t].concat().iter().map(|p| p.map(|c| c as f64)).collect();
        assert_eq!(pairs(&vertices, &[[0, 1, 2], [3, 4, 5]]), u64::from(expected), "{s:?} {t:?}");
        seen[shared][usize::from(expected)] += 1;
    }
    assert!(seen[..3].iter().flatten().all(|&count| count > 500), "{seen:?}");
}
