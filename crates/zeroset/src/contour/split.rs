//! Makes every vertex one fan, and drops vertices without triangles.

use crate::mesh::Mesh;

/// Splits each vertex in which several fans of triangles meet, one copy a fan, and drops unused vertices. Returns the number of
/// copies made. Triangles keep their order; vertices are numbered by first use of the old numbers.
pub(super) fn split_fans(mesh: &mut Mesh) -> usize {
    let n = mesh.vertices.len();
    // Triangles around each vertex.
    let mut first = vec![0_u32; n + 1];
    for &v in mesh.triangles.iter().flatten() {
        first[v as usize + 1] += 1;
    }
    for v in 0..n {
        first[v + 1] += first[v];
    }
    let mut cursor = first.clone();
    let mut around = vec![0_u32; mesh.triangles.len() * 3];
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        for &v in triangle {
            around[cursor[v as usize] as usize] = t as u32;
            cursor[v as usize] += 1;
        }
    }
    drop(cursor);
    let mut vertices = Vec::with_capacity(n);
    let mut splits = 0;
    let mut fan: Vec<usize> = Vec::new();
    let old = mesh.triangles.clone();
    for v in 0..n {
        let star = &around[first[v] as usize..first[v + 1] as usize];
        if star.is_empty() {
            continue;
        }
        let fans = label_fans(&old, star, v as u32, &mut fan);
        for (&t, &f) in star.iter().zip(&fan) {
            for (corner, &was) in mesh.triangles[t as usize].iter_mut().zip(&old[t as usize]) {
                if was == v as u32 {
                    *corner = (vertices.len() + f) as u32;
                }
            }
        }
        for _ in 0..fans {
            vertices.push(mesh.vertices[v]);
        }
        splits += fans - 1;
    }
    mesh.vertices = vertices;
    splits
}

/// Numbers the fans of a star: triangles that share an edge at `v` belong together. Returns the number of fans.
fn label_fans(triangles: &[[u32; 3]], star: &[u32], v: u32, fan: &mut Vec<usize>) -> usize {
    const UNSEEN: usize = usize::MAX;
    fan.clear();
    fan.resize(star.len(), UNSEEN);
    // The other two corners of a triangle.
    let rim = |t: u32| {
        let [a, b, c] = triangles[t as usize];
        if a == v {
            [b, c]
        } else if b == v {
            [c, a]
        } else {
            [a, b]
        }
    };
    let mut fans = 0;
    for start in 0..star.len() {
        if fan[start] != UNSEEN {
            continue;
        }
        fan[start] = fans;
        let mut stack = vec![start];
        while let Some(i) = stack.pop() {
            let mine = rim(star[i]);
            for j in 0..star.len() {
                if fan[j] == UNSEEN && rim(star[j]).iter().any(|r| mine.contains(r)) {
                    fan[j] = fans;
                    stack.push(j);
                }
            }
        }
        fans += 1;
    }
    fans
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bow_tie_becomes_two_fans_and_unused_vertices_go() {
        let mut mesh = Mesh {
            vertices: vec![[9.0; 3], [0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [-1.0, -1.0, 0.0]],
            triangles: vec![[1, 2, 3], [1, 4, 5]],
            ..Mesh::default()
        };
        assert_eq!(split_fans(&mut mesh), 1);
        assert_eq!(mesh.vertices.len(), 6);
        assert_ne!(mesh.triangles[0][0], mesh.triangles[1][0]);
        assert_eq!(mesh.vertices[mesh.triangles[1][0] as usize], [0.0; 3]);
    }
}
