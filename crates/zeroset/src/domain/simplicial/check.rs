//! The examination of a mesh that is given.
//!
//! Two simplices conform if they meet in the hull of the vertices that they share, and in no more. Where they meet in more, the part
//! has a corner that is no shared vertex. Such a corner is a vertex of one in the other, an edge of one through an edge of the
//! other, or an edge through a face: dimensions of faces that meet in one point sum to at most that of space. All three are decided
//! by signs that [`predicates`](super::predicates) gives exactly.

use super::predicates::{PROJECTIONS, in_range, orientation, project, side};
use super::{DomainError, SimplicialMesh};
use rayon::prelude::*;
use std::cmp::Ordering;

/// Swaps the last two corners of each simplex that is negatively oriented. Refuses what is no simplex, and vertices of none.
pub(super) fn orient<const D: usize>(vertices: &[[f64; D]], corners: &mut [u32]) -> Result<(), DomainError> {
    if corners.is_empty() {
        return Err(DomainError::Empty);
    }
    in_range(vertices)?;
    let count = vertices.len();
    let mut used = vec![false; count];
    for (simplex, corners) in corners.chunks_exact_mut(D + 1).enumerate() {
        if let Some(&vertex) = corners.iter().find(|v| **v as usize >= count) {
            return Err(DomainError::VertexMissing { simplex, vertex, count });
        }
        match sign(orientation(&super::positions(vertices, corners)[..=D])) {
            Ordering::Greater => {}
            Ordering::Less => corners.swap(D - 1, D),
            Ordering::Equal => return Err(DomainError::Degenerate { simplex, corners: corners.to_vec() }),
        }
        corners.iter().for_each(|&v| used[v as usize] = true);
    }
    match used.iter().position(|used| !used) {
        Some(vertex) => Err(DomainError::VertexUnused { vertex }),
        None => Ok(()),
    }
}

/// Finds overlaps and faces that are not shared whole. Of all pairs that offend it names the lowest.
pub(super) fn conforming<const D: usize>(mesh: &SimplicialMesh<D>) -> Result<(), DomainError> {
    let offenders = (0..mesh.len()).into_par_iter().with_min_len(256).find_map_first(|first| {
        let a = Corners::of(mesh, first);
        let (low, high) = a.bounds();
        mesh.candidates(low, high).into_iter().map(|s| s as usize).filter(|&second| second > first).find_map(|second| {
            let b = Corners::of(mesh, second);
            (!conform(&a, &b)).then(|| ([first, second], separated(&a, &b)))
        })
    });
    match offenders {
        None => Ok(()),
        Some((simplices, true)) => Err(DomainError::HangingFace { simplices }),
        Some((simplices, false)) => Err(DomainError::Overlap { simplices }),
    }
}

/// A simplex with all that a comparison needs.
struct Corners<'a, const D: usize> {
    vertices: &'a [u32],
    positions: [[f64; D]; 4],
}

/// For each face of one simplex and each corner of another the side that the corner lies on; positive is inside.
type Sides = [[Ordering; 4]; 4];

impl<'a, const D: usize> Corners<'a, D> {
    fn of(mesh: &'a SimplicialMesh<D>, simplex: usize) -> Self {
        Self { vertices: mesh.simplex(simplex), positions: mesh.corner_positions(simplex) }
    }

    fn bounds(&self) -> ([f64; D], [f64; D]) {
        crate::domain::bounds(self.positions[..=D].iter().copied())
    }

    /// Whether a corner of another simplex is one of this.
    fn shares(&self, other: &Self, corner: usize) -> bool {
        self.vertices.contains(&other.vertices[corner])
    }

    /// The sides that the other's corners lie on; `None` if a face parts the two, but for the vertices that they share.
    fn sides(&self, other: &Self) -> Option<Sides> {
        let mut sides = [[Ordering::Equal; 4]; 4];
        for (face, row) in sides.iter_mut().enumerate().take(D + 1) {
            let mut parted = true;
            for (corner, found) in row.iter_mut().enumerate().take(D + 1) {
                let own = self.vertices.iter().position(|&v| v == other.vertices[corner]);
                *found = match own {
                    Some(own) if own == face => Ordering::Greater,
                    Some(_) => Ordering::Equal,
                    None => sign(side(&self.positions, face, other.positions[corner])),
                };
                parted &= *found == Ordering::Less || *found == Ordering::Equal && own.is_some();
            }
            if parted {
                return None;
            }
        }
        Some(sides)
    }

    /// Whether a corner of the other that is not shared lies in this simplex.
    fn holds_corner(&self, other: &Self, sides: &Sides) -> bool {
        (0..=D).any(|c| !self.shares(other, c) && (0..=D).all(|face| sides[face][c] != Ordering::Less))
    }

    /// Whether an edge of the other passes through the inside of a face of this tetrahedron.
    fn pierced(&self, other: &Self, sides: &Sides) -> bool {
        edges(D).any(|[i, j]| {
            (0..=D).any(|face| {
                let [a, b, c] = [1, 2, 3].map(|k| (face + k) % 4);
                let apart = ![i, j].iter().any(|&k| [a, b, c].iter().any(|&l| self.vertices[l] == other.vertices[k]));
                if !apart || !opposite(sides[face][i], sides[face][j]) {
                    return false;
                }
                let (p, q) = (other.positions[i], other.positions[j]);
                let turn = |k: usize, l: usize| sign(orientation(&[p, q, self.positions[k], self.positions[l]]));
                let turns = [turn(a, b), turn(b, c), turn(c, a)];
                turns[0] != Ordering::Equal && turns.iter().all(|t| *t == turns[0])
            })
        })
    }
}

fn sign(value: f64) -> Ordering {
    value.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}

fn opposite(a: Ordering, b: Ordering) -> bool {
    a != Ordering::Equal && a == b.reverse()
}

/// The edges of a simplex, as pairs of its corners.
fn edges(dimensions: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..dimensions).flat_map(move |i| (i + 1..=dimensions).map(move |j| [i, j]))
}

/// Whether two simplices meet in the vertices that they share, and what these span.
fn conform<const D: usize>(a: &Corners<'_, D>, b: &Corners<'_, D>) -> bool {
    let (low_a, high_a) = a.bounds();
    let (low_b, high_b) = b.bounds();
    if (0..D).any(|axis| high_a[axis] < low_b[axis] || high_b[axis] < low_a[axis]) {
        return true;
    }
    if (0..=D).all(|c| a.shares(b, c)) {
        return false;
    }
    let Some(b_at_a) = a.sides(b) else { return true };
    let Some(a_at_b) = b.sides(a) else { return true };
    let offends = a.holds_corner(b, &b_at_a)
        || b.holds_corner(a, &a_at_b)
        || edges_cross(a, b, &b_at_a, &a_at_b)
        || D == 3 && (a.pierced(b, &b_at_a) || b.pierced(a, &a_at_b));
    !offends
}

/// Whether an edge of one simplex crosses an edge of the other, away from the ends of both.
fn edges_cross<const D: usize>(a: &Corners<'_, D>, b: &Corners<'_, D>, b_at_a: &Sides, a_at_b: &Sides) -> bool {
    // The faces that meet in an edge are those opposite to the other corners.
    let reaches = |sides: &Sides, [i, j]: [usize; 2], [k, l]: [usize; 2]| {
        (0..=D).filter(|&face| face != i && face != j).all(|face| {
            let (k, l) = (sides[face][k], sides[face][l]);
            k != l || k == Ordering::Equal
        })
    };
    edges(D).any(|e| {
        edges(D).any(|f| {
            reaches(b_at_a, e, f)
                && reaches(a_at_b, f, e)
                && !e.iter().any(|&k| f.iter().any(|&l| a.vertices[k] == b.vertices[l]))
                && segments_cross(e.map(|k| a.positions[k]), f.map(|k| b.positions[k]))
        })
    })
}

/// Whether two segments of different lines meet away from their ends.
fn segments_cross<const D: usize>([a, b]: [[f64; D]; 2], [c, d]: [[f64; D]; 2]) -> bool {
    // In space they lie in one plane. A projection that keeps the plane keeps the crossing, and one that does not shows none.
    if D == 3 && orientation(&[a, b, c, d]) != 0.0 {
        return false;
    }
    let projections = if D == 2 { &PROJECTIONS[..1] } else { &PROJECTIONS[..] };
    projections.iter().any(|&axes| {
        let [a, b, c, d] = [a, b, c, d].map(|p| project(p, axes));
        let turn = |p, q, r| sign(orientation(&[p, q, r]));
        opposite(turn(a, b, c), turn(a, b, d)) && opposite(turn(c, d, a), turn(c, d, b))
    })
}

/// Whether the insides of two simplices that meet are disjoint.
///
/// If they are, a plane parts them. Around a point where they meet it is held by what meets there: a face, an edge with another corner,
/// two edges that cross, or a vertex with two corners. So some plane through D of the corners parts them.
fn separated<const D: usize>(a: &Corners<'_, D>, b: &Corners<'_, D>) -> bool {
    let all: Vec<_> = a.positions[..=D].iter().chain(&b.positions[..=D]).copied().collect();
    let parts = |plane: &[usize]| {
        let mut points = [[0.0; D]; 4];
        for (point, &k) in points.iter_mut().zip(plane) {
            *point = all[k];
        }
        let signs: Vec<_> = all.iter().map(|&p| sign(side(&points, D, p))).collect();
        let (of_a, of_b) = signs.split_at(D + 1);
        // A plane that is none has all corners on it.
        let on = |side: Ordering| of_a.contains(&side) && !of_a.contains(&side.reverse()) && !of_b.contains(&side);
        on(Ordering::Less) || on(Ordering::Greater)
    };
    let count = all.len();
    (0..count).any(|i| {
        (i + 1..count).any(|j| if D == 2 { parts(&[i, j]) } else { (j + 1..count).any(|k| parts(&[i, j, k])) })
    })
}
