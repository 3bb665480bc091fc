//! Rules for integrals over segments, triangles and tetrahedra, exact for polynomials of a degree.
//!
//! Up to the degrees that squares of linear functions need these are the classical rules: Simpson's on segments, the midpoints of the
//! edges on triangles, four points in tetrahedra. Beyond, products of Gauss-Legendre rules on a cube, collapsed onto the simplex (Duffy 1982): all weights are
//! positive, all points lie inside, and any degree can be had.

/// A point of a rule on a simplex of dimension K.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Node<const K: usize> {
    /// Barycentric weights of corners 1 to K; corner 0 has the rest.
    pub coordinates: [f64; K],
    /// Share of the simplex's length, area or volume. The shares of a rule sum to 1.
    pub weight: f64,
}

impl<const K: usize> Node<K> {
    /// The position in a simplex with the given corners, of which there are K + 1.
    #[must_use]
    pub fn position<const D: usize>(&self, corners: &[[f64; D]]) -> [f64; D] {
        let origin = corners[0];
        std::array::from_fn(|a| {
            origin[a] + (0..K).map(|k| self.coordinates[k] * (corners[k + 1][a] - origin[a])).sum::<f64>()
        })
    }
}

/// A rule on the simplex of dimension K (a segment, triangle or tetrahedron) that is exact for polynomials of a degree.
#[must_use]
pub fn rule<const K: usize>(degree: usize) -> Vec<Node<K>> {
    let at = |coordinates: &[f64], weight| Node { coordinates: std::array::from_fn(|k| coordinates[k]), weight };
    match (K, degree) {
        (_, 0 | 1) => vec![at(&[1.0 / (K + 1) as f64; K], 1.0)],
        (1, 2 | 3) => vec![at(&[0.0], 1.0 / 6.0), at(&[0.5], 4.0 / 6.0), at(&[1.0], 1.0 / 6.0)],
        (2, 2) => [[0.5, 0.0], [0.5, 0.5], [0.0, 0.5]].iter().map(|c| at(c, 1.0 / 3.0)).collect(),
        (3, 2) => {
            // Four points, each on the line from a corner to the opposite face's middle.
            let (near, far) = ((5.0 + 3.0 * 5.0_f64.sqrt()) / 20.0, (5.0 - 5.0_f64.sqrt()) / 20.0);
            let corners = [[far, far, far], [near, far, far], [far, near, far], [far, far, near]];
            corners.iter().map(|c| at(c, 0.25)).collect()
        }
        _ => collapsed(degree),
    }
}

/// Gauss-Legendre points on the cube, mapped to the simplex by x_k = u_k (1 - u_0) ... (1 - u_(k-1)).
fn collapsed<const K: usize>(degree: usize) -> Vec<Node<K>> {
    // The Jacobian is a polynomial of degree K - 1 in the first coordinate.
    let line = gauss_legendre((degree + K).div_ceil(2));
    let factorial: f64 = (1..=K).map(|k| k as f64).product();
    (0..line.len().pow(K as u32))
        .map(|mut index| {
            let mut node = Node { coordinates: [0.0; K], weight: factorial };
            let mut rest = 1.0;
            for k in 0..K {
                let (u, w) = line[index % line.len()];
                index /= line.len();
                node.coordinates[k] = rest * u;
                // One column of the Jacobian: d x_k / d u_k.
                node.weight *= w * rest;
                rest *= 1.0 - u;
            }
            node
        })
        .collect()
}

/// The n points of Gauss-Legendre on 0..1 with their weights, by Newton's method on the Legendre polynomial. Exact to degree 2n - 1.
fn gauss_legendre(n: usize) -> Vec<(f64, f64)> {
    (0..n)
        .map(|i| {
            let mut x = (std::f64::consts::PI * (i as f64 + 0.75) / (n as f64 + 0.5)).cos();
            let mut slope = 1.0;
            for _ in 0..50 {
                let (mut before, mut value) = (1.0, x);
                for k in 2..=n {
                    let k = k as f64;
                    (before, value) = (value, ((2.0 * k - 1.0) * x * value - (k - 1.0) * before) / k);
                }
                slope = n as f64 * (x * value - before) / (x * x - 1.0);
                let step = value / slope;
                x -= step;
                if step.abs() < 1e-16 {
                    break;
                }
            }
            (0.5 * (1.0 - x), 1.0 / ((1.0 - x * x) * slope * slope))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The mean of x^a y^b z^c over the simplex of dimension K: K! a! b! c! / (K + a + b + c)!.
    fn mean(powers: &[usize]) -> f64 {
        let factorial = |n: usize| (1..=n).map(|k| k as f64).product::<f64>();
        let k = powers.len();
        factorial(k) * powers.iter().map(|&p| factorial(p)).product::<f64>()
            / factorial(k + powers.iter().sum::<usize>())
    }

    fn is_exact<const K: usize>() {
        for degree in 0..=8 {
            let rule = rule::<K>(degree);
            assert!(rule.iter().all(|n| n.weight > 0.0 && n.coordinates.iter().all(|&c| (0.0..=1.0).contains(&c))));
            for index in 0..(degree + 1).pow(K as u32) {
                let powers: [usize; K] = std::array::from_fn(|k| index / (degree + 1).pow(k as u32) % (degree + 1));
                if powers.iter().sum::<usize>() > degree {
                    continue;
                }
                let monomial = |n: &Node<K>| (0..K).map(|k| n.coordinates[k].powi(powers[k] as i32)).product::<f64>();
                let found: f64 = rule.iter().map(|n| n.weight * monomial(n)).sum();
                assert!((found - mean(&powers)).abs() < 1e-14, "{K} {degree} {powers:?}: {found} {}", mean(&powers));
            }
        }
    }

    #[test]
    fn rules_integrate_polynomials_of_their_degree() {
        is_exact::<1>();
        is_exact::<2>();
        is_exact::<3>();
    }
}
