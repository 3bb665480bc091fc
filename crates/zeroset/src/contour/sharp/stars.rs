//! What is around each vertex.

use crate::mesh::Mesh;

/// Lists, one after the other: that of each vertex starts where that of the one before ends.
struct Lists {
    starts: Vec<u32>,
    all: Vec<u32>,
}

impl Lists {
    /// Collects pairs of a vertex and an item of its list. `each` gives all pairs whenever it is called.
    fn new(vertices: usize, each: impl Fn(&mut dyn FnMut(u32, u32))) -> Self {
        let mut starts = vec![0_u32; vertices + 1];
        each(&mut |v, _| starts[v as usize] += 1);
        let mut total = 0;
        for start in &mut starts {
            total += std::mem::replace(start, total);
        }
        let mut all = vec![0_u32; total as usize];
        // Places run up to the next start, and are put back.
        each(&mut |v, item| {
            all[starts[v as usize] as usize] = item;
            starts[v as usize] += 1;
        });
        starts.rotate_right(1);
        starts[0] = 0;
        Self { starts, all }
    }

    fn of(&self, v: u32) -> &[u32] {
        &self.all[self.starts[v as usize] as usize..self.starts[v as usize + 1] as usize]
    }
}

/// For each vertex those that follow it around a triangle: all its neighbours, but for the last one on a rim.
pub(super) struct Stars(Lists);

impl Stars {
    pub(super) fn new(mesh: &Mesh) -> Self {
        Self(Lists::new(mesh.vertices.len(), |add| {
            for &[a, b, c] in &mesh.triangles {
                add(a, b);
                add(b, c);
                add(c, a);
            }
        }))
    }

    pub(super) fn around(&self, v: u32) -> &[u32] {
        self.0.of(v)
    }
}

/// The triangles at each vertex.
pub(super) struct Fans(Lists);

impl Fans {
    pub(super) fn new(mesh: &Mesh) -> Self {
        Self(Lists::new(mesh.vertices.len(), |add| {
            for (t, corners) in mesh.triangles.iter().enumerate() {
                corners.iter().for_each(|&v| add(v, t as u32));
            }
        }))
    }

    pub(super) fn of(&self, v: u32) -> &[u32] {
        self.0.of(v)
    }
}
