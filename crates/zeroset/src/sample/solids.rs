//! Solids of bricks: faces parallel to the axes, closed and welded by construction.

use crate::mesh::Mesh;
use std::collections::BTreeMap;

/// The surface of a union of bricks of an uneven grid.
///
/// `planes[a]` are the increasing grid coordinates along axis a; `solid` tells whether the brick between planes (i,
/// i+1), (j, j+1), (k, k+1) is full. Every face between a full and an empty brick becomes two triangles over the grid's
/// own vertices, so neighbours always share whole edges. Two full bricks that touch along an edge or at a corner only
/// would make that edge or corner non-manifold; none of the shapes here has such a pair.
fn bricks(planes: [&[f64]; 3], solid: impl Fn([usize; 3]) -> bool) -> Mesh {
    let counts = planes.map(|p| p.len() - 1);
    let full = |cell: [isize; 3]| {
        (0..3).all(|a| cell[a] >= 0 && (cell[a] as usize) < counts[a]) && solid(cell.map(|c| c as usize))
    };
    let mut mesh = Mesh::default();
    let mut numbers = BTreeMap::new();
    for k in 0..counts[2] as isize {
        for j in 0..counts[1] as isize {
            for i in 0..counts[0] as isize {
                let cell = [i, j, k];
                if !full(cell) {
                    continue;
                }
                for axis in 0..3 {
                    for side in [0, 1] {
                        let mut beyond = cell;
                        beyond[axis] += 2 * side - 1;
                        if full(beyond) {
                            continue;
                        }
                        // Going round (u, v) is counter-clockwise seen from the positive end of the axis.
                        let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                        let mut corners = [(0, 0), (1, 0), (1, 1), (0, 1)];
                        if side == 0 {
                            corners.reverse();
                        }
                        let face = corners.map(|(du, dv)| {
                            let mut at = cell.map(|c| c as usize);
                            at[axis] += side as usize;
                            at[u] += du;
                            at[v] += dv;
                            *numbers.entry(at).or_insert_with(|| {
                                mesh.vertices.push([planes[0][at[0]], planes[1][at[1]], planes[2][at[2]]]);
                                mesh.vertices.len() as u32 - 1
                            })
                        });
                        mesh.triangles.extend([[face[0], face[1], face[2]], [face[0], face[2], face[3]]]);
                    }
                }
            }
        }
    }
    mesh
}

/// A box of 1 x 0.8 x 0.6 from the origin.
pub(super) fn brick() -> Mesh {
    bricks([&[0.0, 1.0], &[0.0, 0.8], &[0.0, 0.6]], |_| true)
}

/// An L of 1 x 0.8, arms 0.4 and 0.3 wide, 0.5 high: one concave edge, 0.25 in volume.
pub(super) fn l_block() -> Mesh {
    bricks([&[0.0, 0.4, 1.0], &[0.0, 0.3, 0.8], &[0.0, 0.5]], |[i, j, _]| i == 0 || j == 0)
}

/// Five steps of 0.2 tread and 0.1 rise, 0.6 wide: 1 long, 0.5 high, 0.18 in volume.
pub(super) fn stairs() -> Mesh {
    let treads: Vec<f64> = (0..=5).map(|i| f64::from(i) / 5.0).collect();
    let rises: Vec<f64> = (0..=5).map(|i| f64::from(i) / 10.0).collect();
    bricks([&treads, &[0.0, 0.6], &rises], |[i, _, k]| k <= i)
}

/// A plate of 1 x 0.7 x 0.15 with four pockets from above, one of them L-shaped; floor and walls are 0.01 thick.
pub(super) fn pocket_plate() -> Mesh {
    const WALL: f64 = 0.01;
    // Even intervals are walls, odd ones pockets.
    let x = [0.0, WALL, 0.29, 0.29 + WALL, 0.66, 0.66 + WALL, 1.0 - WALL, 1.0];
    let y = [0.0, WALL, 0.38, 0.38 + WALL, 0.7 - WALL, 0.7];
    let z = [0.0, WALL, 0.15];
    bricks([&x, &y, &z], |[i, j, k]| {
        let wall = i % 2 == 0 || j % 2 == 0;
        // Two pieces of wall are left out, which joins three pockets to an L.
        let opened = matches!((i, j), (1, 2) | (2, 3));
        k == 0 || (wall && !opened)
    })
}
