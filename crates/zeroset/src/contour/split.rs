//! Makes every vertex one fan, and drops vertices without triangles.

use rayon::prelude::*;

use crate::mesh::Mesh;

/// Splits each vertex in which several fans of triangles meet, one copy a fan, and drops unused vertices. Returns the number of
/// copies made, and the number that each vertex had. Triangles keep their order; vertices keep theirs, copies next to each other.
///
/// `rim` tells the vertices around which a polygon is missing: all others are one fan.
pub(crate) fn split_fans(mesh: &mut Mesh, rim: &[bool]) -> (usize, Vec<u32>) {
    // Triangles around each vertex on the rim, star after star.
    let mut corners: Vec<(u32, u32)> = mesh
        .triangles
        .par_iter()
        .enumerate()
        .flat_map_iter(|(t, corners)| corners.iter().filter(|&&v| rim[v as usize]).map(move |&v| (v, t as u32)))
        .collect();
    corners.par_sort_unstable();
    let (mut copies, mut moved) = (Vec::new(), Vec::new());
    let mut fan: Vec<u32> = Vec::new();
    for star in corners.chunk_by(|a, b| a.0 == b.0) {
        let v = star[0].0;
        let fans = label_fans(&mesh.triangles, star, &mut fan);
        copies.extend((1..fans).map(|_| v));
        moved.extend(star.iter().zip(&fan).filter(|(_, f)| **f > 0).map(|(&(v, t), &f)| (v, t, f)));
    }
    drop(corners);

    let mut used = vec![false; mesh.vertices.len()];
    mesh.triangles.iter().flatten().for_each(|&v| used[v as usize] = true);
    let (mut number, mut old) = (vec![0_u32; used.len()], Vec::with_capacity(used.len()));
    let mut next_copy = copies.iter().peekable();
    for v in (0..used.len()).filter(|&v| used[v]) {
        number[v] = old.len() as u32;
        old.push(v as u32);
        while next_copy.next_if(|copy| **copy as usize == v).is_some() {
            old.push(v as u32);
        }
    }
    mesh.vertices = old.iter().map(|&v| mesh.vertices[v as usize]).collect();
    mesh.triangles.par_iter_mut().for_each(|corners| *corners = corners.map(|v| number[v as usize]));
    for (v, t, fan) in moved {
        for corner in mesh.triangles[t as usize].iter_mut().filter(|corner| **corner == number[v as usize]) {
            *corner += fan;
        }
    }
    (copies.len(), old)
}

/// Numbers the fans of a star, given as its vertex with each of the triangles: triangles that share an edge at the vertex belong
/// together. Returns the number of fans.
fn label_fans(triangles: &[[u32; 3]], star: &[(u32, u32)], fan: &mut Vec<u32>) -> u32 {
    const UNSEEN: u32 = u32::MAX;
    fan.clear();
    fan.resize(star.len(), UNSEEN);
    // The other two corners of a triangle.
    let rim = |(v, t): (u32, u32)| {
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
        assert_eq!(
            split_fans(&mut mesh, &[false, true, false, false, false, false]),
            (1, vec![0, 1, 1, 2, 3, 4, 5][1..].to_vec())
        );
        assert_eq!(mesh.vertices.len(), 6);
        assert_ne!(mesh.triangles[0][0], mesh.triangles[1][0]);
        assert_eq!(mesh.vertices[mesh.triangles[1][0] as usize], [0.0; 3]);
    }
}
