//! The six Freudenthal tetrahedra of a cube.

/// One of the six tetrahedra of a cube: a path of three axis steps from corner 000 to corner 111.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tetrahedron {
    /// The axes in the order in which the path steps along them: the axis of the largest fraction first.
    pub axes: [usize; 3],
    /// The four corners of the cube on the path; bit 0 is x, bit 1 is y, bit 2 is z.
    pub corners: [usize; 4],
}

const fn tetrahedron(a: usize, b: usize, c: usize) -> Tetrahedron {
    Tetrahedron { axes: [a, b, c], corners: [0, 1 << a, (1 << a) | (1 << b), 7] }
}

/// All six, indexed by [`tetrahedron_of`].
pub const TETRAHEDRA: [Tetrahedron; 6] = [
    tetrahedron(0, 1, 2),
    tetrahedron(0, 2, 1),
    tetrahedron(1, 0, 2),
    tetrahedron(1, 2, 0),
    tetrahedron(2, 0, 1),
    tetrahedron(2, 1, 0),
];

/// Index into [`TETRAHEDRA`] of a tetrahedron that holds the point with these fractions (each in 0..=1).
///
/// On a shared face the lower axis goes first, so the answer is unique.
#[inline]
#[must_use]
pub fn tetrahedron_of<T: PartialOrd + Copy>(f: [T; 3]) -> usize {
    // A table, as a branch would go either way as often.
    const OF: [u8; 8] = [5, 4, 2, 1, 3, 4, 2, 0];
    let (xy, xz, yz) = (f[0] >= f[1], f[0] >= f[2], f[1] >= f[2]);
    OF[usize::from(xy) | usize::from(xz) << 1 | usize::from(yz) << 2].into()
}

/// The barycentric weights of a point in tetrahedron `t`, in the order of its corners. They sum to one.
#[inline]
#[must_use]
pub fn barycentric(t: usize, f: [f32; 3]) -> [f32; 4] {
    let [a, b, c] = TETRAHEDRA[t].axes;
    [1.0 - f[a], f[a] - f[b], f[b] - f[c], f[c]]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_a_partition_of_unity_and_reproduce_linear_functions() {
        for i in 0..=10 {
            for j in 0..=10 {
                for k in 0..=10 {
                    let f = [i as f32 / 10.0, j as f32 / 10.0, k as f32 / 10.0];
                    let t = tetrahedron_of(f);
                    let b = barycentric(t, f);
                    assert!(b.iter().all(|&w| (0.0..=1.0).contains(&w)), "{f:?} {b:?}");
                    assert!((b.iter().sum::<f32>() - 1.0).abs() < 1e-6);
                    for (axis, fraction) in f.into_iter().enumerate() {
                        let x: f32 = (0..4).map(|v| b[v] * ((TETRAHEDRA[t].corners[v] >> axis) & 1) as f32).sum();
                        assert!((x - fraction).abs() < 1e-6);
                    }
                }
            }
        }
    }

    #[test]
    fn stiffness_is_the_seven_point_stencil() {
        // Sum over all tetrahedra of the lattice around one node of |T| grad b_0 . grad b_n. On a Kuhn tetrahedron the
        // gradient is one difference per axis between consecutive corners of the path.
        let mut row = std::collections::BTreeMap::new();
        for cube in 0..8_usize {
            for tetrahedron in TETRAHEDRA {
                let Some(me) = tetrahedron.corners.iter().position(|&c| c == cube) else { continue };
                for (other, &corner) in tetrahedron.corners.iter().enumerate() {
                    let mut dot = 0.0;
                    for step in 0..3 {
                        let d = |v: usize| {
                            if v == step + 1 {
                                1.0
                            } else if v == step {
                                -1.0
                            } else {
                                0.0
                            }
                        };
                        dot += d(me) * d(other) / 6.0;
                    }
                    let offset: [i32; 3] =
                        std::array::from_fn(|a| ((corner >> a) & 1) as i32 - ((cube >> a) & 1) as i32);
                    *row.entry(offset).or_insert(0.0) += dot;
                }
            }
        }
        for (offset, value) in row {
            let expected: f64 = match offset.iter().map(|o| o.abs()).sum::<i32>() {
                0 => 6.0,
                1 => -1.0,
                _ => 0.0,
            };
            assert!((value - expected).abs() < 1e-12, "{offset:?}: {value}");
        }
    }
}
