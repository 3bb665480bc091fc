//! Polylines in the plane: linear and radial functions, holes in what is known, branches.

use super::{distance_to_segment, doubled_area, interpolated, length, segments, square};
use crate::basis::{Basis, Expansion, Kernel, P1, P2, Radial, Tail};
use crate::contour::{Branches, Polyline, zero_lines};
use crate::domain::{Place, SimplicialMesh};
use crate::sample::Chance;
use std::f64::consts::PI;

fn lines_of(basis: &dyn Basis<2>, function: impl Fn([f64; 2]) -> f64, branches: Branches<'_, 2>) -> Vec<Polyline> {
    let coefficients = interpolated(basis, function);
    zero_lines(&Expansion::new(basis, &coefficients), 1e-5, branches)
}

fn places(mesh: &SimplicialMesh<2>, positions: impl IntoIterator<Item = [f64; 2]>) -> Vec<Place<2>> {
    positions.into_iter().map(|p| mesh.locate(p).expect("the data lie in the mesh")).collect()
}

#[test]
fn a_linear_function_gives_its_line() {
    for mesh in [square(5), SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2]).expect("a square")] {
        let basis = P1::new(mesh);
        let lines = lines_of(&basis, |[x, y]| 0.3 * x - y + 0.1, Branches::All);
        assert_eq!(lines.len(), 1);
        assert!(!lines[0].closed);
        assert!((length(&lines[0]) - 2.0 * 1.0_f64.hypot(0.3)).abs() < 1e-14);
        // F < 0 above the line and on the left, so it runs to the right.
        assert!(lines[0].points[0][0] == -1.0);
        assert!(lines[0].points.iter().all(|[x, y]| (0.3 * x - y + 0.1).abs() < 1e-15));
    }
}

#[test]
fn a_circle_is_closed_and_runs_counter_clockwise() {
    let circle = |[x, y]: [f64; 2]| x.hypot(y) - 0.7;
    let basis = P1::new(square(40));
    let lines = lines_of(&basis, circle, Branches::All);
    assert!(lines.len() == 1 && lines[0].closed);
    assert!((0.5 * doubled_area(&lines[0]) - 0.49 * PI).abs() < 5e-3);
    let hole = lines_of(&basis, |p| -circle(p), Branches::All);
    assert!(hole.len() == 1 && doubled_area(&hole[0]) < 0.0);
    // The exact circle as a quadratic: its length is off by the square of the tolerance over the radius.
    for mesh in [square(3), SimplicialMesh::four_triangles([-1.0; 2], [1.0; 2]).expect("a square")] {
        let basis = P2::new(mesh);
        let lines = lines_of(&basis, |[x, y]| x * x + y * y - 0.49, Branches::All);
        assert!(lines.len() == 1 && lines[0].closed);
        assert!((length(&lines[0]) - 1.4 * PI).abs() < 1e-4);
        assert!((0.5 * doubled_area(&lines[0]) - 0.49 * PI).abs() < 1e-4);
    }
}

#[test]
fn a_radial_function_is_followed_to_the_tolerance() {
    let kernel = Kernel::Gaussian { width: 0.8 };
    let basis = Radial::new(square(8), kernel, vec![[0.0; 2]], Tail::Constant).expect("a centre");
    let radius = 0.6_f64;
    let coefficients = [-1.0, (-(radius / 0.8).powi(2)).exp()];
    for tolerance in [1e-2, 1e-4, 1e-6] {
        let lines = zero_lines(&Expansion::new(&basis, &coefficients), tolerance, Branches::All);
        assert!(lines.len() == 1 && lines[0].closed);
        assert!(lines[0].points.iter().all(|[x, y]| (x.hypot(*y) - radius).abs() < 1e-14));
        for [a, b] in segments(&lines[0]) {
            assert!(radius - (0.5 * (a[0] + b[0])).hypot(0.5 * (a[1] + b[1])) <= tolerance);
        }
        assert!(doubled_area(&lines[0]) > 0.0);
    }
}

#[test]
fn one_sign_gives_nothing_and_what_is_not_known_is_left_out() {
    let basis = P2::new(square(4));
    assert!(lines_of(&basis, |[x, y]| x * x + y * y + 0.1, Branches::All).is_empty());
    assert!(lines_of(&basis, |_| 0.0, Branches::All).is_empty());
    assert!(lines_of(&basis, |[x, y]| -x * x - y * y, Branches::All).is_empty());
    let coefficients = interpolated(&basis, |[_, y]| y - 0.1);
    let undefined: Vec<bool> = (0..basis.len()).map(|j| basis.node(j).expect("a node")[0] > 0.6).collect();
    let lines = zero_lines(&Expansion::new(&basis, &coefficients).without(&undefined), 1e-5, Branches::All);
    assert!(lines.len() == 1 && (length(&lines[0]) - 1.5).abs() < 1e-14);
}

/// Two lines through a point along the axes, and data on the arms towards `arms`.
const CROSSING: [f64; 2] = [0.13, -0.07];

fn corner_data(mesh: &SimplicialMesh<2>, arms: [f64; 2]) -> Vec<Place<2>> {
    let [x, y] = CROSSING;
    places(mesh, (0..20).map(|i| 0.03 * f64::from(i)).flat_map(|t| [[x + arms[0] * t, y], [x, y + arms[1] * t]]))
}

#[test]
fn a_branch_without_data_goes_and_what_continues_a_kept_one_stays() {
    // A corner of two lines, held by one hyperbola over all cells; the sign of the disturbance tells where its branches are.
    for (cells, disturbance) in [1, 2, 5].into_iter().flat_map(|c| [(c, 1e-3), (c, -1e-3)]) {
        let mesh = square(cells);
        let basis = P2::new(mesh.clone());
        let corner = |[x, y]: [f64; 2]| (x - CROSSING[0]) * (y - CROSSING[1]) - disturbance;
        let all = lines_of(&basis, corner, Branches::All);
        assert_eq!(all.len(), 2);
        let arms = [1.0, f64::signum(disturbance)];
        let kept = lines_of(&basis, corner, Branches::WithData(&corner_data(&mesh, arms)));
        assert_eq!(kept.len(), 1, "{cells} cells");
        // It is followed beyond the data, to the rim.
        assert!(all.contains(&kept[0]));
        assert!(kept[0].points.iter().all(|p| (0..2).all(|a| arms[a] * (p[a] - CROSSING[a]) > 0.0)));
        // Where the branches join each arm with data to one without, nothing can go.
        let torn = corner_data(&mesh, [1.0, -arms[1]]);
        assert_eq!(lines_of(&basis, corner, Branches::WithData(&torn)), all);
    }
}

#[test]
fn pieces_fit_together_whatever_the_values() {
    let mesh = square(3);
    let basis = P2::new(mesh.clone());
    let mut chance = Chance::new(9, 72, 0);
    for _ in 0..300 {
        // Small whole numbers: zeros at nodes, along edges and on whole triangles, and degenerate conics of all kinds.
        let coefficients: Vec<f64> = (0..basis.len()).map(|_| chance.between(-2.5, 2.5).round()).collect();
        let f = Expansion::new(&basis, &coefficients);
        let lines = zero_lines(&f, 1e-4, Branches::All);
        for line in &lines {
            for &p in &line.points {
                assert!(
                    f.value(p).expect("curves stay in the mesh").abs() < 1e-12,
                    "{p:?} {:e} {:?}",
                    f.value(p).expect("a value"),
                    nodes(&basis, &coefficients, p)
                );
            }
            let ends = [line.points[0], line.points[line.points.len() - 1]];
            let on_rim = |p: [f64; 2]| p.iter().any(|c| (c.abs() - 1.0).abs() < 1e-15);
            assert!(line.closed || ends.into_iter().all(on_rim), "{ends:?}");
        }
        let all: Vec<_> = lines.iter().flat_map(segments).collect();
        let value = |p: [f64; 2]| f.value(p).expect("the point lies in the mesh");
        for _ in 0..200 {
            let random = |chance: &mut Chance| [chance.between(-1.0, 1.0), chance.between(-1.0, 1.0)];
            let (mut p, mut q) = (random(&mut chance), random(&mut chance));
            if (value(p) < 0.0) == (value(q) < 0.0) {
                continue;
            }
            let below = value(p) < 0.0;
            for _ in 0..60 {
                let middle = [0, 1].map(|a| 0.5 * (p[a] + q[a]));
                *(if (value(middle) < 0.0) == below { &mut p } else { &mut q }) = middle;
            }
            let distance = all.iter().map(|&s| distance_to_segment(p, s)).fold(f64::INFINITY, f64::min);
            assert!(distance <= 1e-4 + 1e-7, "{p:?} is missed by {distance}: {:?}", nodes(&basis, &coefficients, p));
        }
    }
}

#[test]
fn a_chord_right_under_the_crossing_of_two_lines_is_halved() {
    // The crossing lies in the middle of the edge 01, and on the normal of the chord between the other two edges.
    let corners = vec![[1.0 / 3.0, -1.0], [1.0, -1.0 / 3.0], [1.0 / 3.0, -1.0 / 3.0]];
    let crossing = [2.0 / 3.0, -2.0 / 3.0];
    let basis = P2::new(SimplicialMesh::from_triangles(corners, &[[0, 1, 2]]).expect("a triangle"));
    let f = [1.0, 1.0, -1.0, 0.0, -2.0, 2.0];
    let lines = zero_lines(&Expansion::new(&basis, &f), 1e-5, Branches::All);
    let distance = lines.iter().flat_map(segments).map(|s| distance_to_segment(crossing, s)).fold(1.0, f64::min);
    assert!(distance < 1e-5);
}

#[test]
fn an_outlier_revives_nothing() {
    let mesh = square(2);
    let basis = P2::new(mesh.clone());
    let lines = |[x, _]: [f64; 2]| (x - 0.2) * (x - 0.8);
    let mut positions: Vec<_> = (0..40).map(|i| [0.2, -0.95 + 0.04875 * f64::from(i)]).collect();
    positions.push([0.75, 0.3]);
    let kept = lines_of(&basis, lines, Branches::WithData(&places(&mesh, positions)));
    assert!(kept.len() == 1 && kept[0].points.iter().all(|p| (p[0] - 0.2).abs() < 1e-12));
    assert!(lines_of(&basis, lines, Branches::WithData(&[])).is_empty());
}

#[test]
fn data_on_an_edge_keep_the_line_on_it() {
    let mesh = square(4);
    let basis = P1::new(mesh.clone());
    for sign in [1.0, -1.0] {
        let data = places(&mesh, (0..30).map(|i| [0.5, -0.97 + 0.06 * f64::from(i)]));
        let lines = lines_of(&basis, |[x, _]| sign * (x - 0.5), Branches::WithData(&data));
        assert!(lines.len() == 1 && (length(&lines[0]) - 2.0).abs() < 1e-14);
    }
}

/// The values that F is made of around a position.
fn nodes(basis: &P2<2>, coefficients: &[f64], p: [f64; 2]) -> Vec<f64> {
    let mut terms = crate::basis::Terms::new();
    let place = basis.domain().locate(p).expect("the point lies in the mesh");
    basis.evaluate(&place, crate::basis::Derivatives::None, &mut terms);
    terms.indices.iter().map(|&j| coefficients[j as usize]).collect()
}
