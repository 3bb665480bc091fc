//! Whether the points bear out that the surface is sharp where F is round.
//!
//! One decision for a stretch of a crease, not for each vertex: with noise of a third of a cell some dozens of points are needed to tell an
//! edge from a fillet.

use rayon::prelude::*;

use super::Known;
use super::creases::{Crossing, crossings};
use super::insert;
use super::sheets::Sheets;
use super::stars::Stars;
use crate::mesh::Mesh;
use crate::spatial::PointTree;
use crate::vec3::{self, Vec3};

/// Vertices that their sheet moves by more than this, in cells, are asked.
const ASKED: f64 = 0.1;
/// Vertices away from all creases go to their sheet if that is nearer than the first, in cells, stay if it is farther than the
/// second, and go part of the way between.
const FAR: [f64; 2] = [0.2, 0.5];
/// Rings of vertices around a crease that belong to it.
const RINGS: usize = 8;
/// Of the way from the sheets to F the share from which on the points speak for F.
const SHARE: f64 = 0.35;
/// The same where planes meet, of which many points have spoken already.
const SHARE_OF_PLANES: f64 = 0.6;
/// How many standard deviations more than that they must say.
const SURE: f64 = 0.5;
/// Half the length of a stretch, in cells.
const STRETCH: f64 = 20.0;
/// Points farther from the crease than this, in cells, have nothing to say of it.
const WIDTH: f64 = 1.5;
/// The side of the cubes in which points are summed before, in cells.
const CUBE: f64 = 2.0;
/// Curved sheets that turn by more do not meet in a crease: they come from the two sides of a narrow valley, or of a thin part. The cosine of
/// 120 degrees.
const ACUTE: f64 = -0.5;
/// Where curved parts take part, this share of the length of a crease must go along the lines in which its sheets meet. Sheets that were carried on
/// from too few vertices leave teeth: on a scanned part with rims two cells wide 0.5 to 0.8, on fandisk above 0.95.
const STRAIGHT: f64 = 0.9;
/// What a link without a place counts for, in cells.
const MISSING: f64 = 0.5;
/// No crossing.
const NONE: u32 = u32::MAX;

/// The vertices whose points lie nearer to F than to the sheets, a rounded edge, not a sharp one, with the share of the way to their sheet
/// that is right: none. And vertices away from creases that are too far from their sheet.
///
/// Each point speaks for the vertex nearest to it, and is held against the sheets that meet there: their farthest outside of a convex edge,
/// their nearest at a concave one. Noise at the edge itself then moves points away from F, never towards it. What is asked is how
/// far on the way from the sheets to F the points lie, by least squares over a stretch of a crease.
pub(super) fn unproven(mesh: &Mesh, stars: &Stars, known: &Known, sheets: &Sheets) -> Vec<(u32, f64)> {
    let offset = |v: u32| sheets.of(v).flat.distance(mesh.vertices[v as usize]) / known.cell;
    let crossings = crossings(mesh, sheets);
    let (owner, zone) = owners(mesh, stars, &crossings, |v| offset(v).abs() > ASKED);
    let away = (0..mesh.vertices.len() as u32).into_par_iter().filter(|&v| owner[v as usize] == NONE);
    let share = |v: u32| ((FAR[1] - offset(v).abs()) / (FAR[1] - FAR[0])).clamp(0.0, 1.0);
    let mut unproven: Vec<(u32, f64)> = away.map(|v| (v, share(v))).filter(|(_, share)| *share < 1.0).collect();

    let said = what_points_say(mesh, known, sheets, &crossings, &owner, &zone);
    let (roots, links) = chains(sheets, &crossings);
    let runs = how_they_run(mesh, sheets, known.cell, &crossings, &links);
    let is_acute = |crossing: &Crossing| {
        let [a, b] = crossing.ends.map(|v| sheets.of(v));
        let curved = a.plane.is_none() || b.plane.is_none();
        curved && vec3::dot(a.flat.normal, b.flat.normal) < ACUTE
    };
    let (bin_of, bins) = bins(mesh, sheets, known.cell, &crossings, &roots, &said, &runs);
    let tree = PointTree::new(&bins.iter().map(|bin| bin.middle).collect::<Vec<_>>());
    let round: Vec<bool> = bins
        .par_iter()
        .map(|bin| {
            let (mut sum, mut run) = (Said::default(), Run::default());
            let mut near: Vec<usize> = Vec::new();
            tree.visit_within(bin.middle, STRETCH * known.cell, |i| near.push(i));
            near.sort_unstable();
            for other in near.into_iter().map(|i| &bins[i]).filter(|other| other.root == bin.root) {
                sum.add(&other.said);
                run.add(&other.run);
            }
            let share = if bin.of_planes { SHARE_OF_PLANES } else { SHARE };
            let doubt = SURE * known.noise / known.cell * sum.weight.sqrt();
            !bin.of_planes && run.along < STRAIGHT * run.length
                || sum.field > 0.0 && sum.points > share * sum.field + doubt
        })
        .collect();
    let is_round = |v: &u32| {
        let crossing = owner[*v as usize] as usize;
        round[bin_of[crossing] as usize] || is_acute(&crossings[crossing])
    };
    unproven.extend(zone.into_iter().filter(is_round).map(|v| (v, 0.0)));
    unproven
}

/// The crossing that each vertex belongs to, as far as its sheet moves it, and these vertices.
fn owners(mesh: &Mesh, stars: &Stars, crossings: &[Crossing], is_asked: impl Fn(u32) -> bool) -> (Vec<u32>, Vec<u32>) {
    let mut owner = vec![NONE; mesh.vertices.len()];
    let mut zone: Vec<u32> = Vec::new();
    for (i, crossing) in crossings.iter().enumerate() {
        for v in crossing.ends {
            if owner[v as usize] == NONE {
                owner[v as usize] = i as u32;
                zone.push(v);
            }
        }
    }
    let mut start = 0;
    for _ in 0..RINGS {
        let ring = start..zone.len();
        start = zone.len();
        for k in ring {
            let from = zone[k];
            for &v in stars.around(from) {
                if owner[v as usize] == NONE && is_asked(v) {
                    owner[v as usize] = owner[from as usize];
                    zone.push(v);
                }
            }
        }
    }
    (owner, zone)
}

/// What the points near a crease say: sums over them of z r, z u and z z. How far F is from the sheet at the vertex nearest to the point is
/// u, how far the point is from the sheets that meet there is r, both towards F; z falls with the distance from the crease.
///
/// F follows the noise of its points in part. So the weight z must not depend on F: by least squares, with u as the weight, noise would
/// speak for F.
#[derive(Debug, Clone, Copy, Default)]
struct Said {
    points: f64,
    field: f64,
    weight: f64,
}

impl Said {
    fn add(&mut self, other: &Self) {
        self.points += other.points;
        self.field += other.field;
        self.weight += other.weight;
    }
}

fn what_points_say(
    mesh: &Mesh,
    known: &Known,
    sheets: &Sheets,
    crossings: &[Crossing],
    owner: &[u32],
    zone: &[u32],
) -> Vec<Said> {
    let position = |v: u32| mesh.vertices[v as usize];
    let tree = PointTree::new(&zone.iter().map(|&v| position(v)).collect::<Vec<_>>());
    let said: Vec<Option<(u32, Said)>> = known
        .positions
        .par_iter()
        .map(|&q| {
            let v = zone[tree.nearest_within(q, known.cell)?.index];
            let crossing = owner[v as usize];
            let ends = crossings[crossing as usize].ends;
            let away = vec3::distance(position(v), vec3::lerp(position(ends[0]), position(ends[1]), 0.5)) / known.cell;
            if away > WIDTH {
                return None;
            }
            let own = sheets.of(v);
            let [a, b] = ends.map(|end| sheets.of(end).flat);
            // F lies within a convex edge and outside of a concave one.
            let side = (a.distance(position(ends[1])) + b.distance(position(ends[0]))).signum();
            let others = ends.map(|end| sheets.of(end)).into_iter().filter(|other| other.meets(own));
            let outermost = others.chain([own]).map(|sheet| -side * sheet.flat.distance(q)).fold(f64::MIN, f64::max);
            let z = 1.0 - away / WIDTH;
            let towards = side * own.flat.distance(position(v)) / known.cell;
            Some((crossing, Said { points: -z * outermost / known.cell, field: z * towards, weight: z * z }))
        })
        .collect();
    let mut sums = vec![Said::default(); crossings.len()];
    said.iter().flatten().for_each(|(crossing, said)| sums[*crossing as usize].add(said));
    sums
}

/// How a crease runs: the length of its links, and what of it goes along the lines in which its sheets meet.
#[derive(Debug, Clone, Copy, Default)]
struct Run {
    length: f64,
    along: f64,
}

impl Run {
    fn add(&mut self, other: &Self) {
        self.length += other.length;
        self.along += other.along;
    }
}

/// How the creases would run, at each crossing. A link without a place, as the sheets do not meet near, goes nowhere.
fn how_they_run(mesh: &Mesh, sheets: &Sheets, cell: f64, crossings: &[Crossing], links: &[[u32; 2]]) -> Vec<Run> {
    let places: Vec<Option<(Vec3, Vec3)>> = crossings
        .par_iter()
        .map(|crossing| {
            let ends = crossing.ends.map(|v| mesh.vertices[v as usize]);
            let (_, place, direction) =
                insert::crossing(ends, crossing.ends.map(|v| sheets.of(v).flat), insert::REACH * cell)?;
            Some((place, direction))
        })
        .collect();
    let mut runs = vec![Run::default(); crossings.len()];
    for &[i, j] in links {
        let run = match (places[i as usize], places[j as usize]) {
            (Some((p, along)), Some((q, other))) => {
                let step = vec3::sub(q, p);
                let share = vec3::dot(step, along).abs().min(vec3::dot(step, other).abs());
                Run { length: vec3::norm(step), along: share }
            }
            _ => Run { length: MISSING * cell, along: 0.0 },
        };
        runs[i as usize].add(&run);
    }
    runs
}

/// The crossings of one crease have the same root: they follow each other through triangles, and the same planes meet there.
/// Also the pairs that follow each other.
fn chains(sheets: &Sheets, crossings: &[Crossing]) -> (Vec<u32>, Vec<[u32; 2]>) {
    let planes = |crossing: &Crossing| {
        let [a, b] = crossing.ends.map(|v| sheets.of(v).plane);
        (a.min(b), a.max(b))
    };
    let mut sides: Vec<(u32, u32)> = crossings
        .iter()
        .enumerate()
        .flat_map(|(i, crossing)| crossing.sides.map(|side| (side / 3, i as u32)))
        .collect();
    sides.par_sort_unstable();
    let mut roots: Vec<u32> = (0..crossings.len() as u32).collect();
    let mut links = Vec::new();
    for pair in sides.windows(2) {
        let [(s, i), (t, j)] = [pair[0], pair[1]];
        if s == t && planes(&crossings[i as usize]) == planes(&crossings[j as usize]) {
            links.push([i, j]);
            let (a, b) = (root(&mut roots, i), root(&mut roots, j));
            roots[a.max(b) as usize] = a.min(b);
        }
    }
    ((0..crossings.len() as u32).map(|i| root(&mut roots, i)).collect(), links)
}

/// The root of a crossing; paths are halved on the way.
fn root(roots: &mut [u32], mut i: u32) -> u32 {
    while roots[i as usize] != i {
        roots[i as usize] = roots[roots[i as usize] as usize];
        i = roots[i as usize];
    }
    i
}

/// What the points say at the crossings of one crease in a cube.
struct Bin {
    root: u32,
    /// Whether planes meet there.
    of_planes: bool,
    middle: Vec3,
    said: Said,
    run: Run,
}

/// The bin of each crossing, and the bins.
fn bins(
    mesh: &Mesh,
    sheets: &Sheets,
    cell: f64,
    crossings: &[Crossing],
    roots: &[u32],
    said: &[Said],
    runs: &[Run],
) -> (Vec<u32>, Vec<Bin>) {
    let middle = |i: u32| {
        let [a, b] = crossings[i as usize].ends.map(|v| mesh.vertices[v as usize]);
        vec3::lerp(a, b, 0.5)
    };
    let cube = |i: u32| middle(i).map(|c| (c / (CUBE * cell)).floor() as i64);
    let mut order: Vec<(u32, [i64; 3], u32)> =
        (0..crossings.len() as u32).map(|i| (roots[i as usize], cube(i), i)).collect();
    order.par_sort_unstable();
    let mut bin_of = vec![0; crossings.len()];
    let mut bins = Vec::new();
    for own in order.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let (mut sum, mut run, mut place) = (Said::default(), Run::default(), [0.0; 3]);
        for &(.., i) in own {
            bin_of[i as usize] = bins.len() as u32;
            sum.add(&said[i as usize]);
            run.add(&runs[i as usize]);
            place = vec3::add(place, middle(i));
        }
        let of_planes = crossings[own[0].2 as usize].ends.iter().all(|&v| sheets.of(v).plane.is_some());
        let middle = vec3::scale(place, 1.0 / own.len() as f64);
        bins.push(Bin { root: own[0].0, of_planes, middle, said: sum, run });
    }
    (bin_of, bins)
}
