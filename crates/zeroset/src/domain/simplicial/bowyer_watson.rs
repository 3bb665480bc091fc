//! The Delaunay mesh of sites in space, one site after the other.
//!
//! # What
//! A new site takes away all tetrahedra whose spheres hold it, and is joined to the faces of the hole (Bowyer 1981, Watson 1981). Ghost
//! tetrahedra join each face of the hull to a vertex at infinity; the sphere of a ghost is the half-space beyond its face, with the
//! inside of the face's circle. So sites outside the hull are no special case.
//!
//! # Guaranteed
//! A site on a sphere is not in it. With exact signs the new site then sees every face of the hole strictly from inside: were it
//! on the plane of the face, or beyond, it would lie in the sphere across the face too, and that tetrahedron would be in the
//! hole. So no tetrahedron is flat and no site is lost, also where many sites lie on one sphere.
//!
//! # Cost
//! Sites enter along the Morton curve, so that each is found in a few steps from the last: n log n in practice, n^2 at worst (sites
//! on two curves).

use super::predicates::{in_line, in_sphere, orientation, side};
use crate::domain::morton;
use rustc_hash::FxHashMap;

/// The vertex at infinity.
const GHOST: u32 = u32::MAX;

/// The corners of all tetrahedra, positively oriented; `None` if the sites lie in one plane. Sites differ from each other.
pub(super) fn tetrahedra(sites: &[[f64; 3]]) -> Option<Vec<u32>> {
    let order = along_curve(sites);
    let first = first_tetrahedron(sites, &order)?;
    let mut complex = Complex::new(sites, first);
    for site in order.into_iter().filter(|site| !first.contains(site)) {
        complex.insert(site);
    }
    Some(complex.finite())
}

/// The sites in the order of the Morton curve.
fn along_curve(sites: &[[f64; 3]]) -> Vec<u32> {
    let (low, high) = crate::domain::bounds(sites.iter().copied());
    let longest = (0..3).map(|a| high[a] - low[a]).fold(0.0, f64::max);
    let scale = if longest > 0.0 { f64::from((1_u32 << 21) - 1) / longest } else { 0.0 };
    let code = |site: [f64; 3]| morton::encode(std::array::from_fn(|a| ((site[a] - low[a]) * scale) as u32));
    let mut coded: Vec<_> = sites.iter().zip(0..).map(|(&site, index)| (code(site), index)).collect();
    coded.sort_unstable();
    coded.into_iter().map(|(_, index)| index).collect()
}

/// The first sites that span space, positively oriented.
fn first_tetrahedron(sites: &[[f64; 3]], order: &[u32]) -> Option<[u32; 4]> {
    let at = |v: u32| sites[v as usize];
    let (&a, rest) = order.split_first()?;
    let &b = rest.first()?;
    let c = *rest.iter().find(|&&c| !in_line([at(a), at(b), at(c)]))?;
    let d = *rest.iter().find(|&&d| orientation(&[a, b, c, d].map(at)) != 0.0)?;
    let positive = orientation(&[a, b, c, d].map(at)) > 0.0;
    Some(if positive { [a, b, c, d] } else { [a, b, d, c] })
}

/// Tetrahedra and ghosts, which together close space. Numbers of tetrahedra that were taken away are used again.
struct Complex<'a> {
    sites: &'a [[f64; 3]],
    corners: Vec<[u32; 4]>,
    /// For each corner the tetrahedron across the opposite face.
    neighbors: Vec<[u32; 4]>,
    /// Numbers that are free.
    free: Vec<u32>,
    /// In which insertion a tetrahedron was last looked at, and what was found.
    seen: Vec<(u32, bool)>,
    insertions: u32,
    /// Where the next search begins; not a ghost.
    last: u32,
    hole: Hole,
}

/// Lists that each insertion fills anew.
#[derive(Default)]
struct Hole {
    /// The tetrahedra that are taken away.
    tetrahedra: Vec<u32>,
    /// The faces of the hole: a tetrahedron that is taken away, and the corner opposite to the face.
    faces: Vec<(u32, usize)>,
    /// For an edge of the hole, the new tetrahedron at one of its sides with the corner opposite to the face that it waits at.
    waiting: FxHashMap<[u32; 2], (u32, usize)>,
}

impl<'a> Complex<'a> {
    fn new(sites: &'a [[f64; 3]], first: [u32; 4]) -> Self {
        let mut corners = vec![first];
        for corner in 0..4 {
            let mut ghost = first;
            ghost[corner] = GHOST;
            // The other side of the face sees it turned.
            ghost.swap((corner + 1) % 4, (corner + 2) % 4);
            corners.push(ghost);
        }
        let neighbors = (0..5)
            .map(|t: usize| {
                corners[t].map(|v| {
                    let face = |u: usize| corners[t].iter().all(|w| *w == v || corners[u].contains(w));
                    (0..5).find(|&u| u != t && face(u)).map_or(0, |u| u as u32)
                })
            })
            .collect();
        let seen = vec![(0, false); 5];
        Self { sites, corners, neighbors, free: Vec::new(), seen, insertions: 0, last: 0, hole: Hole::default() }
    }

    fn positions(&self, tetrahedron: u32, ghost: [f64; 3]) -> [[f64; 3]; 4] {
        self.corners[tetrahedron as usize].map(|v| if v == GHOST { ghost } else { self.sites[v as usize] })
    }

    fn ghost_corner(&self, tetrahedron: u32) -> Option<usize> {
        self.corners[tetrahedron as usize].iter().position(|&v| v == GHOST)
    }

    /// Whether a position lies inside the sphere of a tetrahedron.
    fn conflicts(&self, tetrahedron: u32, position: [f64; 3]) -> bool {
        let positions = self.positions(tetrahedron, position);
        let Some(ghost) = self.ghost_corner(tetrahedron) else { return in_sphere(&positions, position) > 0.0 };
        let beyond = orientation(&positions);
        // On the plane of the face, the circle of the face is where the sphere across it cuts the plane.
        beyond > 0.0
            || beyond == 0.0 && {
                let across = self.neighbors[tetrahedron as usize][ghost];
                in_sphere(&self.positions(across, position), position) > 0.0
            }
    }

    /// A tetrahedron or ghost whose sphere holds a position.
    fn find(&self, position: [f64; 3]) -> Option<u32> {
        let mut at = self.last;
        // The walk towards the site cannot return to where it was in a Delaunay mesh. The limit is there all the same.
        for step in 0..self.corners.len() {
            if self.ghost_corner(at).is_some() {
                return self.conflicts(at, position).then_some(at);
            }
            let positions = self.positions(at, position);
            let crossed = (0..4).map(|c| (c + step) % 4).find(|&c| side(&positions, c, position) < 0.0);
            match crossed {
                Some(corner) => at = self.neighbors[at as usize][corner],
                None => return Some(at),
            }
        }
        None
    }

    fn insert(&mut self, site: u32) {
        let position = self.sites[site as usize];
        let anywhere =
            || (0..self.corners.len() as u32).find(|t| !self.free.contains(t) && self.conflicts(*t, position));
        let start = self.find(position).or_else(anywhere);
        let start = start.expect("with exact signs every site that is new lies in some sphere");
        self.dig(start, position);
        self.fill(site);
    }

    /// Finds the tetrahedra whose spheres hold a position, and the faces around them.
    fn dig(&mut self, start: u32, position: [f64; 3]) {
        self.insertions += 1;
        let mut hole = std::mem::take(&mut self.hole);
        hole.tetrahedra.clear();
        hole.faces.clear();
        hole.tetrahedra.push(start);
        self.seen[start as usize] = (self.insertions, true);
        let mut next = 0;
        while let Some(&t) = hole.tetrahedra.get(next) {
            next += 1;
            for corner in 0..4 {
                let across = self.neighbors[t as usize][corner];
                let (when, found) = self.seen[across as usize];
                let conflict = if when == self.insertions {
                    found
                } else {
                    let conflict = self.conflicts(across, position);
                    self.seen[across as usize] = (self.insertions, conflict);
                    if conflict {
                        hole.tetrahedra.push(across);
                    }
                    conflict
                };
                if !conflict {
                    hole.faces.push((t, corner));
                }
            }
        }
        self.hole = hole;
    }

    /// Joins a site to the faces of the hole.
    fn fill(&mut self, site: u32) {
        let mut hole = std::mem::take(&mut self.hole);
        hole.waiting.clear();
        for &(old, corner) in &hole.faces {
            let outside = self.neighbors[old as usize][corner];
            let mut corners = self.corners[old as usize];
            corners[corner] = site;
            let new = self.add(corners);
            self.neighbors[new as usize][corner] = outside;
            for back in &mut self.neighbors[outside as usize] {
                // Only one face joins the two: were there more, the new site would make a flat tetrahedron.
                if *back == old {
                    *back = new;
                }
            }
            for other in (0..4).filter(|&c| c != corner) {
                let [a, b] = edge_without(corners, corner, other);
                let edge = [a.min(b), a.max(b)];
                if let Some((partner, facing)) = hole.waiting.remove(&edge) {
                    self.neighbors[new as usize][other] = partner;
                    self.neighbors[partner as usize][facing] = new;
                } else {
                    hole.waiting.insert(edge, (new, other));
                }
            }
            if !corners.contains(&GHOST) {
                self.last = new;
            }
        }
        self.free.append(&mut hole.tetrahedra);
        self.hole = hole;
    }

    /// Adds a tetrahedron whose neighbours are not known yet.
    fn add(&mut self, corners: [u32; 4]) -> u32 {
        if let Some(number) = self.free.pop() {
            self.corners[number as usize] = corners;
            return number;
        }
        self.corners.push(corners);
        self.neighbors.push([0; 4]);
        self.seen.push((0, false));
        self.corners.len() as u32 - 1
    }

    /// The corners of all tetrahedra that are no ghosts.
    fn finite(self) -> Vec<u32> {
        let mut kept = vec![true; self.corners.len()];
        self.free.iter().for_each(|&number| kept[number as usize] = false);
        let finite = self.corners.into_iter().zip(kept).filter(|(corners, kept)| *kept && !corners.contains(&GHOST));
        finite.flat_map(|(corners, _)| corners).collect()
    }
}

/// The two corners of a tetrahedron that are neither of two given ones.
fn edge_without(corners: [u32; 4], one: usize, other: usize) -> [u32; 2] {
    let first = (0..4).find(|&c| c != one && c != other).unwrap_or(0);
    [corners[first], corners[6 - one - other - first]]
}
