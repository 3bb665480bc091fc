//! Which vertices are neighbours.

use crate::mesh::Mesh;

/// For each vertex those that follow it around a triangle: all its neighbours, but for the last one on a rim.
pub(super) struct Stars {
    starts: Vec<u32>,
    neighbours: Vec<u32>,
}

impl Stars {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let mut starts = vec![0_u32; mesh.vertices.len() + 1];
        mesh.triangles.iter().flatten().for_each(|&v| starts[v as usize] += 1);
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        let mut places = starts.clone();
        let mut neighbours = vec![0_u32; total as usize];
        for &[a, b, c] in &mesh.triangles {
            for (from, to) in [(a, b), (b, c), (c, a)] {
                neighbours[places[from as usize] as usize] = to;
                places[from as usize] += 1;
            }
        }
        Self { starts, neighbours }
    }

    pub(super) fn around(&self, v: usize) -> &[u32] {
        &self.neighbours[self.starts[v] as usize..self.starts[v + 1] as usize]
    }
}
