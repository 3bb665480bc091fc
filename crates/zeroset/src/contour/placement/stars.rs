//! Who is around each vertex, and which vertices may move at once.

use crate::contour::chain::{Chain, chain};

/// What one polygon covers around one of its vertices: the vertex, the one after it and the one before it, counter-clockwise.
pub(in crate::contour) type Sector = [u32; 3];

/// The sectors of a polygon.
pub(in crate::contour) fn sectors(polygon: &[u32]) -> impl Iterator<Item = Sector> {
    let n = polygon.len();
    (0..n).map(move |i| [polygon[i], polygon[(i + 1) % n], polygon[(i + n - 1) % n]])
}

/// The closed rings of neighbours around the vertices of a mesh of polygons.
pub(super) struct Stars {
    /// Where the ring of each vertex begins in `neighbors`, and the end of the last.
    first: Vec<u32>,
    neighbors: Vec<u32>,
}

impl Stars {
    /// The rings of a mesh whose edges have at most two polygons each, given by all its sectors.
    pub(super) fn new(vertices: usize, sectors: &[Sector]) -> Self {
        let mut first = vec![0_u32; vertices + 1];
        sectors.iter().for_each(|sector| first[sector[0] as usize + 1] += 1);
        for v in 0..vertices {
            first[v + 1] += first[v];
        }
        let mut sides = vec![[0_u32; 2]; sectors.len()];
        let mut next = first.clone();
        for &[v, from, to] in sectors {
            let place = &mut next[v as usize];
            sides[*place as usize] = [from, to];
            *place += 1;
        }
        let (mut kept, mut neighbors) = (vec![0_u32; vertices + 1], Vec::with_capacity(sides.len()));
        for v in 0..vertices {
            let star = &mut sides[first[v] as usize..first[v + 1] as usize];
            if chain(star, |side| *side) == Chain::Closed {
                neighbors.extend(star.iter().map(|side| side[0]));
            }
            kept[v + 1] = neighbors.len() as u32;
        }
        Self { first: kept, neighbors }
    }

    /// The neighbours of a vertex in order around it; empty unless they make one closed ring.
    pub(super) fn ring(&self, vertex: usize) -> &[u32] {
        &self.neighbors[self.first[vertex] as usize..self.first[vertex + 1] as usize]
    }

    /// The vertices with a ring in classes of which none holds two neighbours, each in ascending order: each vertex takes the first class
    /// that none of its neighbours before it has.
    pub(super) fn classes(&self) -> Vec<Vec<u32>> {
        let vertices = self.first.len() - 1;
        let mut class_of: Vec<Option<usize>> = vec![None; vertices];
        let mut classes: Vec<Vec<u32>> = Vec::new();
        for v in (0..vertices).filter(|&v| !self.ring(v).is_empty()) {
            let taken = |class: usize| self.ring(v).iter().any(|&n| class_of[n as usize] == Some(class));
            let class = (0..).find(|&class| !taken(class)).unwrap_or(classes.len());
            if class == classes.len() {
                classes.push(Vec::new());
            }
            class_of[v] = Some(class);
            classes[class].push(v as u32);
        }
        classes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octahedron_has_rings_of_four_and_three_classes() {
        // Opposite vertices differ by 3.
        let faces = [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]];
        let all: Vec<Sector> = faces.iter().flat_map(|face| sectors(face)).collect();
        let stars = Stars::new(6, &all);
        for v in 0..6 {
            let ring = stars.ring(v);
            assert_eq!(ring.len(), 4);
            assert_eq!((ring[0] + 3) % 6, ring[2]);
            assert!(!ring.contains(&(v as u32)));
        }
        assert_eq!(stars.classes(), [[0, 3], [1, 4], [2, 5]]);
    }

    #[test]
    fn vertices_on_a_boundary_have_no_ring() {
        let all: Vec<Sector> = [[0, 1, 2], [0, 2, 3], [0, 3, 1]].iter().flat_map(|face| sectors(face)).collect();
        let stars = Stars::new(4, &all);
        assert_eq!(stars.ring(0), [1, 2, 3]);
        assert!((1..4).all(|v| stars.ring(v).is_empty()));
        assert_eq!(stars.classes(), [[0]]);
    }
}
