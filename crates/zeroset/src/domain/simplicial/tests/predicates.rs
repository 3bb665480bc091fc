//! Signs against whole numbers.

use super::super::predicates::{LEAST, MOST, in_range, in_sphere, orientation};
use crate::sample::Chance;

fn determinant<const N: usize>(rows: [[i128; N]; N]) -> i128 {
    fn minor(rows: &[Vec<i128>]) -> i128 {
        if rows.len() == 1 {
            return rows[0][0];
        }
        (0..rows.len())
            .map(|k| {
                let rest: Vec<Vec<_>> = rows[1..].iter().map(|r| [&r[..k], &r[k + 1..]].concat()).collect();
                (if k % 2 == 0 { 1 } else { -1 }) * rows[0][k] * minor(&rest)
            })
            .sum()
    }
    minor(&rows.map(|r| r.to_vec()))
}

#[test]
fn signs_agree_with_whole_numbers() {
    let mut chance = Chance::new(1, 94, 0);
    let mut zeros = 0;
    for round in 0..20_000 {
        // Points near a sphere about the origin, so that many signs are close or zero.
        let radius = [3.0, 30.0, 3e5][round % 3];
        let points: [[f64; 3]; 5] = std::array::from_fn(|_| chance.direction().map(|c| (radius * c).round()));
        let whole = points.map(|p| p.map(|c| c as i128));
        let from = |k: usize, origin: usize| std::array::from_fn::<_, 3, _>(|a| whole[k][a] - whole[origin][a]);
        let volume = determinant([from(1, 0), from(2, 0), from(3, 0)]);
        let corners = [points[0], points[1], points[2], points[3]];
        assert_eq!(orientation(&corners).partial_cmp(&0.0), Some(volume.cmp(&0)));
        let lifted = |k: usize| {
            let [x, y, z] = from(k, 4);
            [x, y, z, x * x + y * y + z * z]
        };
        // Inside is positive for positive tetrahedra: the rows are in the order that `robust` defines.
        let sphere = determinant([lifted(1), lifted(0), lifted(2), lifted(3)]);
        if volume > 0 {
            assert_eq!(in_sphere(&corners, points[4]).partial_cmp(&0.0), Some(sphere.cmp(&0)));
            zeros += usize::from(sphere == 0);
        }
    }
    assert!(zeros > 50, "some lie on the sphere exactly");
    let unit = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    assert!(orientation(&unit) > 0.0 && in_sphere(&unit, [0.3; 3]) > 0.0 && in_sphere(&unit, [2.0; 3]) < 0.0);
}

#[test]
fn the_range_is_that_of_the_proof() {
    assert_eq!((LEAST, MOST), (2.0_f64.powi(-142), 2.0_f64.powi(201)));
    assert_eq!(in_range(&[[0.0, -LEAST], [MOST, -0.0]]), Ok(()));
}
