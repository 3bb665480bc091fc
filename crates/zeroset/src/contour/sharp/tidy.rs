//! Mends the triangles that were folded over or flattened when vertices moved to their sheets.
//!
//! A triangle's quality is its area, negative where it faces away from its sheet, over that of the equilateral triangle with the same sum of
//! squared sides. Around each bad triangle an edge is collapsed or flipped or a vertex is moved within its seat, if that makes the
//! worst triangle there better.

use rayon::prelude::*;
use rustc_hash::FxHashMap;

use super::Seat;
use super::insert::Inserted;
use super::stars::Fans;
use crate::mesh::{Facet, Mesh};
use crate::vec3::{self, Vec3};

/// Triangles below this quality are mended.
const BAD: f64 = 0.08;
/// Passes over the bad triangles.
const PASSES: usize = 8;
/// A vertex this close to a plane or a line lies on it, in cells.
const ON: f64 = 1e-3;
/// Triangles that were changed face the way they did on the surface of F, within this cosine: 60 degrees.
const TURN: f64 = 0.5;
/// Sheets that differ by less have no crease between them: the cosine of 15 degrees.
const FLAT: f64 = 0.966;

/// Mends bad triangles; the number of those left.
pub(super) fn tidy(mesh: &mut Mesh, fans: Fans, inserted: &mut Inserted, cell: f64) -> usize {
    let mut patchwork = Patchwork {
        vertices: std::mem::take(&mut mesh.vertices),
        triangles: std::mem::take(&mut mesh.triangles),
        origins: &inserted.origins,
        first_areas: FxHashMap::default(),
        seats: &inserted.seats,
        facing: &inserted.facing,
        fans,
        changed: FxHashMap::default(),
        cell,
    };
    let all = 0..patchwork.triangles.len() as u32;
    let mut bad: Vec<u32> = all.into_par_iter().filter(|&t| patchwork.is_bad(t)).collect();
    let mut waiting = bad.clone();
    for _ in 0..PASSES {
        let mut touched = Vec::new();
        for &t in &waiting {
            if patchwork.is_bad(t) {
                patchwork.mend(t, &mut touched);
            }
        }
        // Only where something changed another attempt can succeed.
        let around =
            |&t: &u32| patchwork.corners(t).into_iter().flatten().flat_map(|v| patchwork.fan(v).iter().copied());
        waiting = touched.iter().flat_map(around).collect();
        waiting.sort_unstable();
        waiting.dedup();
        waiting.retain(|&t| patchwork.is_bad(t));
        bad.extend(&waiting);
        if waiting.is_empty() {
            break;
        }
    }
    bad.sort_unstable();
    bad.dedup();
    bad.retain(|&t| patchwork.is_bad(t));
    mesh.vertices = patchwork.vertices;
    mesh.triangles = patchwork.triangles;
    let mut triangles = mesh.triangles.iter();
    inserted.own.retain(|_| triangles.next().is_some_and(|corners| *corners != DEAD));
    mesh.triangles.retain(|corners| *corners != DEAD);
    bad.len()
}

/// The corners of a triangle that was taken away.
const DEAD: [u32; 3] = [u32::MAX; 3];

/// A mesh whose triangles can be changed.
struct Patchwork<'a> {
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Where the vertices are on the surface of F.
    origins: &'a [Vec3],
    /// The area on the surface of F of the triangles that have changed, as a vector, before they did.
    first_areas: FxHashMap<u32, Vec3>,
    seats: &'a [Seat],
    /// The normal of each triangle's sheet.
    facing: &'a [[f32; 3]],
    /// The triangles around each vertex, as they were at first.
    fans: Fans,
    /// The fans that have changed.
    changed: FxHashMap<u32, Vec<u32>>,
    cell: f64,
}

impl Patchwork<'_> {
    /// The triangles around a vertex.
    fn fan(&self, v: u32) -> &[u32] {
        self.changed.get(&v).map_or_else(|| self.fans.of(v), Vec::as_slice)
    }

    /// The same, to change them.
    fn fan_mut(&mut self, v: u32) -> &mut Vec<u32> {
        self.changed.entry(v).or_insert_with(|| self.fans.of(v).to_vec())
    }

    /// The corners of a triangle that is there.
    fn corners(&self, t: u32) -> Option<[u32; 3]> {
        Some(self.triangles[t as usize]).filter(|corners| *corners != DEAD)
    }

    fn quality_of(&self, corners: [u32; 3], t: u32) -> f64 {
        quality(corners.map(|v| self.vertices[v as usize]), self.facing[t as usize].map(f64::from))
    }

    /// The area of a triangle as it is on the surface of F, as a vector.
    fn on_field(&self, corners: [u32; 3]) -> Vec3 {
        let [a, b, c] = corners.map(|v| self.origins[v as usize]);
        vec3::cross(vec3::sub(b, a), vec3::sub(c, a))
    }

    /// Whether triangles with new corners have no area on the surface of F, or cut through each other or those around them there. The mesh is
    /// to stay embedded there.
    fn cuts(&self, new: &[(u32, [u32; 3])], gone: &[u32]) -> bool {
        let placed = |corners: [u32; 3]| corners.map(|v| self.origins[v as usize]);
        let facet = |corners: [u32; 3]| Some((Facet::new(placed(corners))?, bounds(placed(corners))));
        let Some(facets) = new.iter().map(|&(_, corners)| facet(corners)).collect::<Option<Vec<_>>>() else {
            return true;
        };
        if (1..facets.len()).any(|i| facets[..i].iter().any(|(other, _)| other.overlaps(&facets[i].0))) {
            return true;
        }
        let mut around: Vec<u32> =
            new.iter().flat_map(|(_, corners)| corners).flat_map(|&v| self.fan(v)).copied().collect();
        around.sort_unstable();
        around.dedup();
        around.retain(|t| !gone.contains(t) && !new.iter().any(|(own, _)| own == t));
        around.into_iter().any(|t| {
            let [low, high] = bounds(placed(self.triangles[t as usize]));
            let meets = |b: &[Vec3; 2]| (0..3).all(|a| low[a] <= b[1][a] && b[0][a] <= high[a]);
            let near: Vec<&Facet> = facets.iter().filter(|(_, b)| meets(b)).map(|(facet, _)| facet).collect();
            let other = if near.is_empty() { None } else { Facet::new(placed(self.triangles[t as usize])) };
            other.is_some_and(|other| near.iter().any(|own| own.overlaps(&other)))
        })
    }

    /// Whether a triangle with new corners faces another way on the surface of F than it did at first.
    fn turns(&self, t: u32, corners: [u32; 3]) -> bool {
        let first = self.first_areas.get(&t).copied().unwrap_or_else(|| self.on_field(self.triangles[t as usize]));
        let new = self.on_field(corners);
        vec3::dot(first, new) <= TURN * vec3::norm(first) * vec3::norm(new)
    }

    fn remember(&mut self, t: u32) {
        let area = self.on_field(self.triangles[t as usize]);
        self.first_areas.entry(t).or_insert(area);
    }

    fn quality(&self, t: u32) -> f64 {
        self.corners(t).map_or(1.0, |corners| self.quality_of(corners, t))
    }

    fn is_bad(&self, t: u32) -> bool {
        self.quality(t) < BAD
    }

    /// Tries every change around a bad triangle until one helps.
    fn mend(&mut self, t: u32, touched: &mut Vec<u32>) {
        let Some(corners) = self.corners(t) else { return };
        let mut sides: Vec<(f64, [u32; 2])> = (0..3)
            .map(|i| {
                let ends = [corners[i], corners[(i + 1) % 3]];
                (vec3::distance(self.vertices[ends[0] as usize], self.vertices[ends[1] as usize]), ends)
            })
            .collect();
        sides.sort_by(|a, b| a.0.total_cmp(&b.0));
        for &(_, [a, b]) in &sides {
            if self.collapse(a, b, touched) || self.collapse(b, a, touched) {
                return;
            }
        }
        for &(_, [a, b]) in sides.iter().rev() {
            if self.flip(a, b, touched) {
                return;
            }
        }
        for v in corners {
            if self.relax(v, touched) {
                return;
            }
        }
    }

    /// The triangles at the edge from a to b.
    fn at_edge(&self, a: u32, b: u32) -> Vec<u32> {
        let has = |t: &u32| self.triangles[*t as usize].contains(&b);
        self.fan(a).iter().copied().filter(has).collect()
    }

    fn around(&self, v: u32) -> Vec<u32> {
        let corners = self.fan(v).iter().flat_map(|&t| self.triangles[t as usize]);
        let mut around: Vec<u32> = corners.filter(|&u| u != v).collect();
        around.sort_unstable();
        around.dedup();
        around
    }

    /// Whether a vertex may give up its place for that of another.
    fn may_go_to(&self, from: u32, to: u32) -> bool {
        let p = self.vertices[to as usize];
        let near = ON * self.cell;
        match self.seats[from as usize] {
            // Two triangles may have found the same corner.
            Seat::At => {
                matches!(self.seats[to as usize], Seat::At) && vec3::distance(p, self.vertices[from as usize]) < near
            }
            Seat::Along(origin, direction) => {
                matches!(self.seats[to as usize], Seat::Along(..) | Seat::At)
                    && vec3::norm(vec3::cross(vec3::sub(p, origin), direction)) < near
            }
            Seat::On(flat) => flat.distance(p).abs() < near,
            Seat::Loose => true,
            Seat::Held => false,
        }
    }

    fn is_rim(&self, v: u32) -> bool {
        self.around(v).len() != self.fan(v).len()
    }

    /// Moves `from` to `to`, where the two become one.
    fn collapse(&mut self, from: u32, to: u32, touched: &mut Vec<u32>) -> bool {
        if !self.may_go_to(from, to) || self.is_rim(from) {
            return false;
        }
        let gone = self.at_edge(from, to);
        let (mine, others) = (self.around(from), self.around(to));
        let common = mine.iter().filter(|v| others.binary_search(v).is_ok()).count();
        if gone.len() != 2 || common != 2 || mine.len() < 4 {
            return false;
        }
        let star = self.fan(from).to_vec();
        let before = star.iter().map(|&t| self.quality(t)).fold(1.0, f64::min);
        let moved = |corners: [u32; 3]| corners.map(|v| if v == from { to } else { v });
        let kept: Vec<u32> = star.iter().copied().filter(|t| !gone.contains(t)).collect();
        let new: Vec<(u32, [u32; 3])> = kept.iter().map(|&t| (t, moved(self.triangles[t as usize]))).collect();
        let after = new.iter().map(|&(t, corners)| self.quality_of(corners, t)).fold(1.0, f64::min);
        if after <= before || new.iter().any(|&(t, corners)| self.turns(t, corners)) || self.cuts(&new, &gone) {
            return false;
        }
        kept.iter().for_each(|&t| self.remember(t));
        for &t in &gone {
            let corners = std::mem::replace(&mut self.triangles[t as usize], DEAD);
            corners.iter().for_each(|&v| self.fan_mut(v).retain(|&u| u != t));
        }
        for (t, corners) in new {
            self.triangles[t as usize] = corners;
            self.fan_mut(to).push(t);
        }
        self.fan_mut(from).clear();
        touched.extend(kept);
        true
    }

    /// Turns the edge between two triangles of one sheet.
    fn flip(&mut self, a: u32, b: u32, touched: &mut Vec<u32>) -> bool {
        let pair = self.at_edge(a, b);
        let &[s, t] = pair.as_slice() else { return false };
        if [a, b].iter().all(|&v| self.seats[v as usize] == Seat::Held) {
            return false;
        }
        let facing = [s, t].map(|t| self.facing[t as usize].map(f64::from));
        if vec3::dot(facing[0], facing[1]) < FLAT {
            return false;
        }
        let (first, second) = (self.triangles[s as usize], self.triangles[t as usize]);
        // Make a -> b the direction in which the first triangle runs along the edge.
        let runs =
            |corners: [u32; 3], from: u32, to: u32| (0..3).any(|i| corners[i] == from && corners[(i + 1) % 3] == to);
        let (a, b) = if runs(first, a, b) { (a, b) } else { (b, a) };
        let apex = |corners: [u32; 3]| corners.into_iter().find(|&v| v != a && v != b);
        let (Some(c), Some(d)) = (apex(first), apex(second)) else { return false };
        if c == d || !runs(second, b, a) || !self.at_edge(c, d).is_empty() {
            return false;
        }
        let before = self.quality(s).min(self.quality(t));
        let new = [(s, [c, a, d]), (t, [d, b, c])];
        let after = new.iter().map(|&(t, corners)| self.quality_of(corners, t)).fold(1.0, f64::min);
        if after <= before || new.iter().any(|&(t, corners)| self.turns(t, corners)) || self.cuts(&new, &[]) {
            return false;
        }
        pair.iter().for_each(|&t| self.remember(t));
        for (t, corners) in new {
            self.triangles[t as usize] = corners;
        }
        self.fan_mut(a).retain(|&u| u != t);
        self.fan_mut(b).retain(|&u| u != s);
        self.fan_mut(c).push(t);
        self.fan_mut(d).push(s);
        touched.extend(pair);
        true
    }

    /// Moves a vertex towards the middle of its neighbours, as far as its seat lets it.
    fn relax(&mut self, v: u32, touched: &mut Vec<u32>) -> bool {
        if self.is_rim(v) {
            return false;
        }
        let p = self.vertices[v as usize];
        let around = self.around(v);
        let mean = |of: &[u32]| {
            let sum = of.iter().fold([0.0; 3], |sum, &u| vec3::add(sum, self.vertices[u as usize]));
            vec3::scale(sum, 1.0 / of.len() as f64)
        };
        let target = match self.seats[v as usize] {
            Seat::At | Seat::Held => return false,
            Seat::Along(origin, direction) => {
                let middle = mean(&around);
                vec3::add_scaled(origin, direction, vec3::dot(vec3::sub(middle, origin), direction))
            }
            Seat::On(flat) => flat.foot(mean(&around)),
            Seat::Loose => mean(&around),
        };
        let star = self.fan(v).to_vec();
        let worst = |this: &Self| star.iter().map(|&t| this.quality(t)).fold(1.0, f64::min);
        let before = worst(self);
        for step in [1.0, 0.5, 0.25] {
            self.vertices[v as usize] = vec3::lerp(p, target, step);
            if worst(self) > before {
                touched.extend(star);
                return true;
            }
        }
        self.vertices[v as usize] = p;
        false
    }
}

fn bounds([a, b, c]: [Vec3; 3]) -> [Vec3; 2] {
    [vec3::min(vec3::min(a, b), c), vec3::max(vec3::max(a, b), c)]
}

/// The area over that of the equilateral triangle with the same sum of squared sides; negative for one that faces away.
fn quality([a, b, c]: [Vec3; 3], facing: Vec3) -> f64 {
    let (u, v, w) = (vec3::sub(b, a), vec3::sub(c, a), vec3::sub(c, b));
    let sides = vec3::norm_squared(u) + vec3::norm_squared(v) + vec3::norm_squared(w);
    if sides == 0.0 {
        return -1.0;
    }
    2.0 * 3.0_f64.sqrt() * vec3::dot(vec3::cross(u, v), facing) / sides
}
