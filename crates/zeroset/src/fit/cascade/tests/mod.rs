//! What the mathematics promises: transposes, symmetry, exact prolongation, whole bands, and an R that never rises.

mod reference;

use super::eigen_seed::eigenvectors;
use super::free::turn_outward;
use super::gradient::linearise;
use super::level::{FixedFaces, Level, LevelParams, Nodes};
use super::operator::{apply, energy};
use super::prior::{AIR, GAMMA};
use super::prolong::{Solved, band, complete, prolong};
use super::solve::{SolveParams, conjugate_gradients};
use super::{FitParams, LevelReport, Scene, fit};
use crate::domain::{Blocks, Cells, Lattice, LatticePoints, TETRAHEDRA, barycentric, dilate, mask_get, tetrahedron_of};
use crate::fit::Gradient;
use crate::sample::{Chance, Scene as Sample, SceneKind};

const ALPHA: f32 = 4.0;

/// Points of a scene on their lattices.
struct Placed {
    lattice: Lattice,
    points: LatticePoints,
}

impl Placed {
    fn new(kind: SceneKind, n: usize, resolution: f64) -> Self {
        let cloud = Sample::new(kind, 1).points(n, 0.002, 1);
        let mut corners = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
        for p in &cloud.points {
            for a in 0..3 {
                corners[0][a] = corners[0][a].min(p[a]);
                corners[1][a] = corners[1][a].max(p[a]);
            }
        }
        let lattice = Lattice::around(corners[0], corners[1], resolution, 0.1).unwrap();
        let points = LatticePoints::new(&lattice, &cloud.points);
        Self { lattice, points }
    }

    fn dense(&self, index: u32, faces: FixedFaces, alpha: f32, column_prior: bool) -> Level {
        let cells = Cells::new(&self.lattice, &self.points, index);
        let params = LevelParams { alpha, faces, column_prior };
        let nodes = Nodes::dense(&self.lattice, cells, index, &params);
        Level::new(&self.lattice, &self.points, index, nodes, &params)
    }

    /// The band above a dense level that holds `coarse`.
    fn band(&self, coarse: &Solved, faces: FixedFaces, column_prior: bool) -> Level {
        let index = coarse.index + 1;
        let cells = Cells::new(&self.lattice, &self.points, index);
        let params = LevelParams { alpha: ALPHA, faces, column_prior };
        let nodes = band(&self.lattice, &self.points, cells, coarse, &params, None);
        Level::new(&self.lattice, &self.points, index, nodes, &params)
    }

    /// F at every point, evaluated from the definition of P1.
    fn at_points(&self, index: u32, blocks: &Blocks, f: &[f32]) -> Vec<f64> {
        let shift = self.lattice.shift_at(index);
        (0..self.points.coordinates.len())
            .map(|i| {
                let cell = self.points.coordinates[i].map(|c| c >> shift);
                let fractions = self.points.fractions(i, shift);
                let t = tetrahedron_of(fractions);
                let weights = barycentric(t, fractions);
                (0..4).map(|v| f64::from(weights[v]) * value(blocks, f, corner(cell, t, v))).sum()
            })
            .collect()
    }
}

/// Corner `v` of tetrahedron `t` of a cell, as a node.
fn corner(cell: [u32; 3], t: usize, v: usize) -> [i64; 3] {
    std::array::from_fn(|a| i64::from(cell[a]) + (TETRAHEDRA[t].corners[v] >> a & 1) as i64)
}

/// Where a node is stored.
fn place(blocks: &Blocks, node: [i64; 3]) -> Option<(usize, usize)> {
    if (0..3).any(|a| node[a] < 0 || node[a] >= 8 * i64::from(blocks.extent[a])) {
        return None;
    }
    let b = blocks.find(node.map(|c| (c >> 3) as u32))?;
    Some((b, (node[0] & 7 | (node[1] & 7) << 3 | (node[2] & 7) << 6) as usize))
}

fn value(blocks: &Blocks, f: &[f32], node: [i64; 3]) -> f64 {
    place(blocks, node).map_or(0.0, |(b, local)| f64::from(f[b * 512 + local]))
}

/// Every stored place with its node.
fn nodes(blocks: &Blocks) -> impl Iterator<Item = (usize, usize, [i64; 3])> + '_ {
    blocks.coordinates.iter().enumerate().flat_map(|(b, c)| {
        (0..512_usize).map(move |local| {
            let place = [local & 7, local >> 3 & 7, local >> 6];
            (b, local, std::array::from_fn(|a| i64::from(8 * c[a]) + place[a] as i64))
        })
    })
}

/// Normal numbers on the nodes of a set, zero elsewhere.
fn random_on(masks: &[crate::domain::Mask], seed: u64) -> Vec<f32> {
    let mut chance = Chance::new(seed, 200, 0);
    let mut values = vec![0.0; masks.len() * 512];
    for (i, v) in values.iter_mut().enumerate() {
        if mask_get(&masks[i / 512], i % 512) {
            *v = chance.normal() as f32;
        }
    }
    values
}

fn dot(a: &[f32], b: &[f32]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| f64::from(a) * f64::from(b)).sum()
}

fn norm(a: &[f32]) -> f64 {
    dot(a, a).sqrt()
}

/// |x|-like distance to a sphere about the middle of the scenes' boxes, in cells of the level; rough enough to have curvature.
fn ball(placed: &Placed, index: u32, blocks: &Blocks, radius: f64) -> Vec<f32> {
    let mut f = vec![0.0; blocks.len() * 512];
    let h = placed.lattice.spacing_at(index);
    for (b, local, node) in nodes(blocks) {
        let p = placed.lattice.position(index, node.map(|c| c as f64));
        f[b * 512 + local] = ((p.iter().map(|c| c * c).sum::<f64>().sqrt() - radius) / h) as f32;
    }
    f
}

/// Levels of every make: dense with all faces fixed, dense with prior, dense and free, and a band.
fn levels() -> Vec<(&'static str, Level)> {
    let torus = Placed::new(SceneKind::Torus, 3000, 1.0 / 40.0);
    let city = Placed::new(SceneKind::AirborneCity, 3000, 1.0 / 24.0);
    let coarse = torus.dense(0, FixedFaces::All, ALPHA, false);
    let f = ball(&torus, 0, &coarse.blocks, 0.3);
    let solved = coarse.into_solved(f);
    vec![
        ("all faces", torus.dense(0, FixedFaces::All, ALPHA, false)),
        ("free", torus.dense(0, FixedFaces::None, ALPHA, false)),
        ("prior", city.dense(0, FixedFaces::TopBottom, ALPHA, true)),
        ("band", torus.band(&solved, FixedFaces::All, false)),
    ]
}

#[test]
fn the_right_hand_side_is_the_transpose_of_the_gradient() {
    for (what, mut level) in levels() {
        let f = random_on(&level.known, 1);
        let g = random_on(&level.free, 2);
        for gradient in [Gradient::Element, Gradient::Recovered] {
            level.gradient = gradient;
            let mut scratch = [vec![0.0; f.len()], vec![0.0; f.len()], vec![0.0; f.len()]];
            let mut rhs = vec![0.0; f.len()];
            let [x, y, z] = &mut scratch;
            let found = linearise(&level, &f, [x, y, z], &mut rhs);
            let (mut expected_norm, mut expected, mut size) = (0.0, 0.0, 0.0);
            for (d, samples) in level.samples.of_block.iter().enumerate() {
                let block = crate::domain::block_of_key(level.cells.block_keys[d]);
                for s in samples {
                    let local = u32::from(s.local);
                    let cell = [local & 7, local >> 3 & 7, local >> 6];
                    let cell: [u32; 3] = std::array::from_fn(|a| 8 * block[a] + cell[a]);
                    let gradient_of = |values: &[f32]| {
                        gradient_at(&level.blocks, values, cell, s.tetrahedron.into(), s.barycentric, gradient)
                    };
                    let (gf, gg) = (gradient_of(&f), gradient_of(&g));
                    let length = gf.iter().map(|c| c * c).sum::<f64>().sqrt();
                    let along: f64 = (0..3).map(|a| gf[a] * gg[a]).sum::<f64>() / length;
                    let weight = f64::from(s.weight);
                    expected_norm += weight * length;
                    expected += weight * along;
                    size += weight * gg.iter().map(|c| c * c).sum::<f64>().sqrt();
                }
            }
            if let Some(prior) = &level.prior {
                let mut told = 0;
                for (b, local, _) in nodes(&level.blocks) {
                    let sign = f64::from(i8::from(mask_get(&prior.air[b], local)))
                        - f64::from(i8::from(mask_get(&prior.solid[b], local)));
                    let target = sign * f64::from(GAMMA * AIR);
                    told += usize::from(sign != 0.0);
                    expected_norm += target * f64::from(f[b * 512 + local]);
                    expected += target * f64::from(g[b * 512 + local]);
                    size += (target * f64::from(g[b * 512 + local])).abs();
                }
                assert!(told > 1000, "the prior says something");
            }
            // f32 sums of some tens of terms: 1e-6 of the terms' size, and randomly signed.
            let error = (dot(&rhs, &g) - expected).abs();
            assert!(error < 2e-6 * size, "{what}, {gradient:?}: <rhs, G> errs by {error} of {size}");
            assert!((found / expected_norm - 1.0).abs() < 1e-5, "{what}, {gradient:?}: N {found} {expected_norm}");
            // Euler: N is homogeneous, so its linearisation at F gives N(F) back, if F moves only where it is free.
            let free: Vec<f32> = f
                .iter()
                .enumerate()
                .map(|(i, &v)| if mask_get(&level.free[i / 512], i % 512) { v } else { 0.0 })
                .collect();
            if what == "free" {
                assert!((dot(&rhs, &free) / found - 1.0).abs() < 1e-5, "{what}, {gradient:?}");
            }
            assert!(
                nodes(&level.blocks)
                    .all(|(b, local, _)| mask_get(&level.free[b], local) || rhs[b * 512 + local] == 0.0)
            );
        }
    }
}

/// The gradient of a sample from its definition, in f64.
fn gradient_at(blocks: &Blocks, f: &[f32], cell: [u32; 3], t: usize, weights: [f32; 4], kind: Gradient) -> [f64; 3] {
    let mut g = [0.0; 3];
    match kind {
        Gradient::Element => {
            for (s, &axis) in TETRAHEDRA[t].axes.iter().enumerate() {
                g[axis] = value(blocks, f, corner(cell, t, s + 1)) - value(blocks, f, corner(cell, t, s));
            }
        }
        Gradient::Recovered => {
            for (v, weight) in weights.into_iter().enumerate() {
                let node = corner(cell, t, v);
                for (axis, g) in g.iter_mut().enumerate() {
                    let (mut ahead, mut behind) = (node, node);
                    ahead[axis] += 1;
                    behind[axis] -= 1;
                    *g += 0.5 * f64::from(weight) * (value(blocks, f, ahead) - value(blocks, f, behind));
                }
            }
        }
    }
    g
}

#[test]
fn the_operator_is_symmetric_and_its_quadratic_form_is_the_energy() {
    for (what, level) in levels() {
        let (x, y) = (random_on(&level.free, 3), random_on(&level.free, 4));
        let (mut ax, mut ay) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let xax = apply(&level, &x, &mut ax);
        apply(&level, &y, &mut ay);
        let (xay, yax) = (dot(&x, &ay), dot(&y, &ax));
        // Rounding of f32, 6e-8 an operation, in sums of up to 22 terms.
        assert!((xay - yax).abs() < 2e-6 * norm(&x) * norm(&ay), "{what}: {xay} {yax}");
        assert!((xax / dot(&x, &ax) - 1.0).abs() < 1e-5, "{what}");
        // x vanishes where nothing is free, and all neighbours of free nodes are known: no edge is missed.
        let e = energy(&level, &x);
        assert!((xax / e - 1.0).abs() < 1e-5, "{what}: x'Ax {xax}, E {e}");
    }
}

#[test]
fn the_data_term_is_the_weighted_sum_over_the_points() {
    let placed = Placed::new(SceneKind::LBlock, 4000, 1.0 / 40.0);
    for index in 0..=placed.lattice.finest {
        let level = placed.dense(index, FixedFaces::None, ALPHA, false);
        let bare = placed.dense(index, FixedFaces::None, 0.0, false);
        let f = random_on(&level.known, 5);
        let found = energy(&level, &f) - energy(&bare, &f);
        let mut counts = std::collections::BTreeMap::<[i64; 3], f64>::new();
        let shift = placed.lattice.shift_at(index);
        let cell = |i: usize| placed.points.coordinates[i].map(|c| i64::from(c >> shift));
        for i in 0..placed.points.coordinates.len() {
            *counts.entry(cell(i)).or_default() += 1.0;
        }
        let weight = |c: [i64; 3]| {
            let around =
                (0..27).filter_map(|k| counts.get(&[c[0] + k % 3 - 1, c[1] + k / 3 % 3 - 1, c[2] + k / 9 - 1]));
            let (n, sum) = around.fold((0.0, 0.0), |(n, sum), count| (n + 1.0, sum + count));
            n / sum
        };
        let values = placed.at_points(index, &level.blocks, &f);
        let expected: f64 = values.iter().enumerate().map(|(i, v)| f64::from(ALPHA) * weight(cell(i)) * v * v).sum();
        assert!((found / expected - 1.0).abs() < 1e-4, "level {index}: {found} {expected}");
        // All cells together weigh about as much as there are occupied ones.
        let total: f64 = (0..values.len()).map(|i| weight(cell(i))).sum();
        assert!((total / counts.len() as f64 - 1.0).abs() < 0.1, "level {index}: {total} of {}", counts.len());
    }
}

#[test]
fn prolongation_is_exact() {
    let placed = Placed::new(SceneKind::Torus, 4000, 1.0 / 50.0);
    let (coarse, fine) = (placed.dense(0, FixedFaces::None, 0.0, false), placed.dense(1, FixedFaces::None, 0.0, false));
    // A linear function, at all nodes that lie between coarse ones.
    let linear = |index: u32, blocks: &Blocks| -> Vec<f32> {
        let mut f = vec![0.0; blocks.len() * 512];
        for (b, local, node) in nodes(blocks) {
            let p = placed.lattice.position(index, node.map(|c| c as f64));
            f[b * 512 + local] = (0.3 * p[0] - 1.2 * p[1] + 0.7 * p[2] + 0.1) as f32;
        }
        f
    };
    let solved = |f: Vec<f32>| Solved { index: 0, blocks: coarse.blocks.clone(), known: coarse.known.clone(), f };
    let last = coarse.blocks.extent.map(|e| 2 * (8 * i64::from(e) - 1));
    let expected = linear(1, &fine.blocks);
    let found = prolong(&solved(linear(0, &coarse.blocks)), &fine.blocks, &fine.known);
    for (b, local, node) in nodes(&fine.blocks) {
        let (f, e) = (found[b * 512 + local], expected[b * 512 + local]);
        assert!((f - e).abs() < 1e-6 || (0..3).any(|a| node[a] > last[a]), "{node:?}: {f} {e}");
    }
    // Random values: the same function, so the same values at the points ...
    let mut f = random_on(&coarse.known, 6);
    for (b, local, node) in nodes(&coarse.blocks) {
        if (0..3).any(|a| node[a] == 0 || node[a] == 8 * i64::from(coarse.blocks.extent[a]) - 1) {
            f[b * 512 + local] = 0.0;
        }
    }
    let prolonged = prolong(&solved(f.clone()), &fine.blocks, &fine.known);
    let (before, after) = (placed.at_points(0, &coarse.blocks, &f), placed.at_points(1, &fine.blocks, &prolonged));
    for (b, a) in before.iter().zip(&after) {
        assert!((b - a).abs() < 2e-6, "{b} {a}");
    }
    // ... and the same integral of |grad F|^2, which in cells doubles (h times a sum over edges, with h halved).
    let (before, after) = (energy(&coarse, &f), energy(&fine, &prolonged));
    assert!((after / before - 2.0).abs() < 1e-5, "{before} {after}");
}

#[test]
fn conjugate_gradients_lower_the_quadratic_and_reach_the_residual() {
    for (what, level) in levels() {
        let truth = random_on(&level.free, 7);
        let mut rhs = vec![0.0; truth.len()];
        apply(&level, &truth, &mut rhs);
        let rhs: Vec<f64> = rhs.into_iter().map(f64::from).collect();
        let scale = rhs.iter().map(|r| r * r).sum::<f64>().sqrt();
        let solve = |max_steps: usize| {
            let n = rhs.len();
            let [mut f, mut p, mut q, mut s] = std::array::from_fn(|_| vec![0.0; n]);
            let mut r = rhs.clone();
            let params = SolveParams { tolerance: 1e-8, max_steps };
            let steps = conjugate_gradients(&level, &mut f, &mut r, [&mut p, &mut q, &mut s], scale, params);
            apply(&level, &f, &mut q);
            let residual = q.iter().zip(&rhs).map(|(q, b)| (b - q).powi(2)).sum::<f64>().sqrt();
            let quadratic = f.iter().zip(q.iter().zip(&rhs)).map(|(f, (q, b))| f * (0.5 * q - b)).sum::<f64>();
            (steps, residual, quadratic)
        };
        let mut last = 0.0;
        for max_steps in 1..8 {
            let (steps, _, quadratic) = solve(max_steps);
            assert_eq!(steps, max_steps, "{what}");
            assert!(quadratic < last, "{what}: {quadratic} after {last}");
            last = quadratic;
        }
        let (steps, residual, _) = solve(1000);
        assert!(steps < 1000 && residual < 1.01e-8 * scale, "{what}: {residual} of {scale} after {steps}");
    }
}

/// The known corners of the cells around a change of sign: how many such cells there are, and how many lack a corner.
fn crossed_cells(level: &Solved) -> (usize, usize) {
    let extent = level.blocks.extent.map(|e| 8 * i64::from(e));
    let (mut crossed, mut cut) = (0, 0);
    let mut first: Vec<[i64; 3]> = nodes(&level.blocks).map(|n| n.2).collect();
    // Cells whose first corner lies in a block that is not stored.
    first.extend(nodes(&level.blocks).filter(|n| n.1 & 7 == 0).map(|n| [n.2[0] - 1, n.2[1], n.2[2]]));
    first.extend(nodes(&level.blocks).filter(|n| n.1 >> 3 & 7 == 0).map(|n| [n.2[0], n.2[1] - 1, n.2[2]]));
    first.extend(nodes(&level.blocks).filter(|n| n.1 >> 6 == 0).map(|n| [n.2[0], n.2[1], n.2[2] - 1]));
    first.sort_unstable();
    first.dedup();
    for n in first {
        if (0..3).any(|a| n[a] < 0 || n[a] + 1 >= extent[a]) {
            continue;
        }
        let corners = (0..8_i64).filter_map(|c| {
            let (b, local) = place(&level.blocks, [n[0] + (c & 1), n[1] + (c >> 1 & 1), n[2] + (c >> 2)])?;
            mask_get(&level.known[b], local).then(|| level.f[b * 512 + local] < 0.0)
        });
        let (known, inside) = corners.fold((0, 0), |(k, i), inside| (k + 1, i + usize::from(inside)));
        if inside > 0 && inside < known {
            crossed += 1;
            cut += usize::from(known < 8);
        }
    }
    (crossed, cut)
}

/// Points of a torus, and a coarse level on which F is a ball instead.
fn torus_with_ball(radius: f64) -> (Placed, Solved) {
    let placed = Placed::new(SceneKind::Torus, 3000, 1.0 / 40.0);
    let coarse = placed.dense(0, FixedFaces::All, ALPHA, false);
    let f = ball(&placed, 0, &coarse.blocks, radius);
    (placed, coarse.into_solved(f))
}

#[test]
fn the_band_holds_all_that_the_level_needs() {
    let (placed, solved) = torus_with_ball(0.2);
    let level = placed.band(&solved, FixedFaces::All, false);
    let all: u32 = level.known.iter().flatten().map(|w| w.count_ones()).sum();
    let nodes_at = placed.lattice.nodes_at(1);
    assert!(all < nodes_at.into_iter().product::<u32>() / 2, "a band, not the box: {all}");
    let known = |node| place(&level.blocks, node).is_some_and(|(b, local)| mask_get(&level.known[b], local));
    let free = |node| place(&level.blocks, node).is_some_and(|(b, local)| mask_get(&level.free[b], local));
    for (b, local, node) in nodes(&level.blocks).filter(|n| mask_get(&level.free[n.0], n.1)) {
        assert!(mask_get(&level.known[b], local));
        for side in 0..6 {
            let mut next = node;
            next[side / 2] += if side & 1 == 1 { 1 } else { -1 };
            let inside = (0..3).all(|a| next[a] >= 0 && next[a] < i64::from(nodes_at[a]));
            assert!(!inside || known(next), "{node:?}");
        }
    }
    // The recovered gradient reaches one step beyond the nodes of the data: these are free, too.
    let shift = placed.lattice.shift_at(1);
    for i in 0..placed.points.coordinates.len() {
        let cell = placed.points.coordinates[i].map(|c| c >> shift);
        let t = tetrahedron_of(placed.points.fractions(i, shift));
        for v in 0..4 {
            let node = corner(cell, t, v);
            for axis in 0..3 {
                for step in [-1, 0, 1] {
                    let mut next = node;
                    next[axis] += step;
                    assert!(free(next), "{next:?} near point {i}");
                }
            }
        }
    }
    // Both ends of every crossed edge of the prolonged F, and so its zero set, lie three steps from the rim.
    let every = Blocks::dense(placed.lattice.blocks_at(1));
    let whole = vec![[u64::MAX; 8]; every.len()];
    let prolonged = prolong(&solved, &every, &whole);
    for (b, local, node) in nodes(&every) {
        for axis in 0..3 {
            let mut next = node;
            next[axis] += 1;
            let Some((nb, nl)) = place(&every, next) else { continue };
            if (prolonged[b * 512 + local] < 0.0) != (prolonged[nb * 512 + nl] < 0.0) {
                for step in -3..=4 {
                    let mut near = node;
                    near[axis] += step;
                    assert!(free(near), "{near:?}");
                }
            }
        }
    }
    assert_eq!(dilate(&level.blocks, &level.free), level.known, "known is free and one step further");
}

#[test]
fn completed_levels_cut_no_cell_around_the_surface() {
    let (placed, solved) = torus_with_ball(0.3);
    // The zero set where it was, and moved by up to the width of the band, in both directions.
    for moved in [0.0, 1.5, -1.5, 2.5, -2.5, 3.0, -3.0, 3.5, -3.5] {
        let level = placed.band(&solved, FixedFaces::All, false);
        let mut f = prolong(&solved, &level.blocks, &level.known);
        for (v, mask) in f.chunks_exact_mut(512).zip(&level.free) {
            for (local, v) in v.iter_mut().enumerate() {
                // The prolonged F is in cells of the coarse level.
                *v += if mask_get(mask, local) { 0.5 * moved as f32 } else { 0.0 };
            }
        }
        let done = complete(level.into_solved(f), &solved, None);
        assert_eq!(done.index, 1);
        let (crossed, cut) = crossed_cells(&done);
        assert!(crossed > 1000);
        assert_eq!(cut, 0, "moved by {moved}: {cut} of {crossed} cells are cut");
    }
}

/// R step by step in stretches with one gradient. The quotient at the end belongs to the last stretch.
fn stretches(level: &LevelReport) -> Vec<Vec<f64>> {
    let mut stretches: Vec<Vec<f64>> = level
        .iterations
        .chunk_by(|a, b| a.gradient == b.gradient)
        .map(|c| c.iter().map(|i| i.rayleigh_quotient).collect())
        .collect();
    if let Some(last) = stretches.last_mut() {
        last.push(level.rayleigh_quotient);
    }
    stretches
}

#[test]
fn the_rayleigh_quotient_never_rises_within_a_level_and_no_cell_around_the_surface_is_cut() {
    let cases = [
        (SceneKind::Sphere, Scene::Object, 8000, 0.01),
        (SceneKind::Torus, Scene::Object, 8000, 0.01),
        (SceneKind::LBlock, Scene::Object, 8000, 0.01),
        (SceneKind::City, Scene::Terrain, 20_000, 0.01),
        (SceneKind::AirborneCity, Scene::Airborne, 20_000, 0.01),
    ];
    for (kind, scene, n, resolution) in cases {
        let cloud = Sample::new(kind, 1).points(n, 0.001, 1);
        let (field, report) = fit(&cloud.points, &FitParams::new(scene, resolution), &()).unwrap();
        assert!(report.levels.len() >= 3, "{kind}");
        let mut falls = 0.0_f64;
        for level in &report.levels {
            for stretch in stretches(level) {
                for pair in stretch.windows(2) {
                    // R is summed from f32: 1e-5 of it is rounding.
                    assert!(pair[1] <= pair[0] * (1.0 + 1e-5), "{kind}, level {}: {stretch:?}", level.level);
                }
                falls = falls.max(1.0 - stretch[stretch.len() - 1] / stretch[0]);
            }
        }
        assert!(falls > 0.1, "{kind}: a test that sees R fall by {falls} only says nothing");
        let finest = field.lattice.finest;
        let level = Solved { index: finest, blocks: field.blocks, known: field.known, f: field.values };
        let (crossed, cut) = crossed_cells(&level);
        assert!(crossed > 5000 && cut == 0, "{kind}: {cut} of {crossed} cells are cut");
    }
}

#[test]
fn the_seed_of_free_scenes_does_not_depend_on_threads_and_crosses_zero_at_the_data() {
    let placed = Placed::new(SceneKind::Torus, 4000, 1.0 / 50.0);
    let level = placed.dense(0, FixedFaces::None, ALPHA, false);
    let seeds = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| eigenvectors(&level, f64::from(ALPHA), &()).unwrap())
    };
    let (one, three) = (seeds(1), seeds(3));
    assert_eq!(one.len(), 4);
    assert!(one == three);
    let square = |values: &[f64]| values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64;
    let at_points = square(&placed.at_points(0, &level.blocks, &one[0]));
    let all: Vec<f64> = one[0].iter().map(|&v| f64::from(v)).collect();
    assert!(at_points < 0.05 * square(&all), "{at_points} at the points, {} in the box", square(&all));
    // The middle of the tube and the middle of the ring lie on different sides.
    let near = |p: [f64; 3]| {
        let h = placed.lattice.spacing_at(0);
        let node = std::array::from_fn(|a| ((p[a] - placed.lattice.origin[a]) / h).round() as i64);
        value(&level.blocks, &one[0], node)
    };
    assert!(near([0.35, 0.0, 0.0]) * near([0.0; 3]) < 0.0);
}

#[test]
fn the_side_of_a_body_is_outside_and_of_a_sheet_the_upper_one() {
    let placed = Placed::new(SceneKind::Torus, 4000, 1.0 / 50.0);
    let level = placed.dense(0, FixedFaces::None, ALPHA, false);
    let h = placed.lattice.spacing_at(0);
    let body = ball(&placed, 0, &level.blocks, 2.0 * h);
    let sheet: Vec<f32> = nodes(&level.blocks)
        .map(|(_, _, node)| placed.lattice.position(0, node.map(|c| c as f64)))
        .map(|p| (p[2] - 0.3 * p[0] + 0.1) as f32)
        .collect();
    for (f, shares) in [(body, 1.0..=1.0), (sheet, 0.5..=0.9)] {
        for sign in [1.0, -1.0] {
            let mut turned: Vec<f32> = f.iter().map(|v| sign * v).collect();
            let share = turn_outward(&level, &mut turned);
            assert!(shares.contains(&share), "{share}");
            assert!(turned == f);
        }
    }
}
