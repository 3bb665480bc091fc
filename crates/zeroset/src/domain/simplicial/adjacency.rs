//! What belongs together in a mesh: edges, and simplices that share a face.

/// Edges and neighbours.
#[derive(Debug, Clone)]
pub(super) struct Adjacency {
    /// All edges, lower vertex first, ascending.
    pub(super) edges: Vec<[u32; 2]>,
    /// For each simplex its edges.
    pub(super) edges_of: Vec<u32>,
    /// For each corner of each simplex the simplex across the opposite face.
    pub(super) neighbors: Vec<Option<u32>>,
}

impl Adjacency {
    /// Finds edges and neighbours by sorting.
    pub(super) fn new(corners: &[u32], corners_each: usize) -> Self {
        let simplices = corners.chunks_exact(corners_each);
        let pairs = || (0..corners_each).flat_map(move |i| (i + 1..corners_each).map(move |j| [i, j]));
        let edge = |simplex: &[u32], [i, j]: [usize; 2]| {
            let (a, b) = (simplex[i], simplex[j]);
            [a.min(b), a.max(b)]
        };
        let mut edges: Vec<_> = simplices.clone().flat_map(|s| pairs().map(move |p| edge(s, p))).collect();
        edges.sort_unstable();
        edges.dedup();
        let edges_of = simplices
            .clone()
            .flat_map(|s| pairs().map(move |p| edge(s, p)))
            .map(|e| edges.binary_search(&e).expect("every edge is listed") as u32)
            .collect();
        // The vertices of each face in ascending order, with the place that it lies opposite to.
        let mut faces: Vec<([u32; 3], u32)> = simplices
            .enumerate()
            .flat_map(|(s, simplex)| {
                (0..corners_each).map(move |opposite| {
                    let mut face = [u32::MAX; 3];
                    let others = (0..corners_each).filter(|&c| c != opposite);
                    for (entry, c) in face.iter_mut().zip(others) {
                        *entry = simplex[c];
                    }
                    face.sort_unstable();
                    (face, (s * corners_each + opposite) as u32)
                })
            })
            .collect();
        faces.sort_unstable();
        let mut neighbors = vec![None; corners.len()];
        for pair in faces.windows(2).filter(|pair| pair[0].0 == pair[1].0) {
            let [a, b] = [pair[0].1, pair[1].1];
            neighbors[a as usize] = Some(b / corners_each as u32);
            neighbors[b as usize] = Some(a / corners_each as u32);
        }
        Self { edges, edges_of, neighbors }
    }
}
