//! The outline of open terrain: where the data bear a surface, seen from above.

use rayon::prelude::*;

/// The columns that hold data, closed by a radius: gaps narrower than twice the radius are bridged, and nothing lies beyond the
/// data's own outline.
///
/// A wall far below its roof's edge is kept although no point is near it, because the distance is measured in the ground
/// plane. Formula: dilation of the occupied columns by a disc, then erosion by the same disc (a morphological closing).
#[derive(Debug, Clone)]
pub struct ColumnOutline {
    low: [f64; 2],
    cell: f64,
    size: [usize; 2],
    inside: Vec<bool>,
}

/// Most columns of the raster; a larger area is seen in coarser columns.
const MAX_COLUMNS: f64 = 6.4e7;
/// Most columns along a side: a strip is not all rim.
const MOST_ALONG: f64 = 1e6;

impl ColumnOutline {
    /// The outline of points, in columns of width `cell`, closed by `radius`. Both in the unit of the points.
    #[must_use]
    pub fn new(points: &[[f64; 3]], cell: f64, radius: f64) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in points {
            for a in 0..2 {
                low[a] = low[a].min(p[a]);
                high[a] = high[a].max(p[a]);
            }
        }
        let side = [high[0] - low[0] + 2.0 * radius, high[1] - low[1] + 2.0 * radius];
        let cell = cell.max((side[0] * side[1] / MAX_COLUMNS).sqrt()).max(side[0].max(side[1]) / MOST_ALONG);
        let margin = (radius / cell).ceil() + 2.0;
        // Columns are the same whatever part of the points is seen.
        let low = low.map(|l| ((l / cell).floor() - margin) * cell);
        let size: [usize; 2] = std::array::from_fn(|a| ((high[a] - low[a]) / cell + margin + 3.0) as usize);
        let mut occupied = vec![false; size[0] * size[1]];
        for p in points {
            let [x, y] = [0, 1].map(|a| ((p[a] - low[a]) / cell) as usize);
            occupied[x + size[0] * y] = true;
        }
        let reach = (radius / cell).powi(2) as f32;
        let near: Vec<bool> = squared_distances(&occupied, size).into_par_iter().map(|d| d <= reach).collect();
        let outside: Vec<bool> = near.par_iter().map(|n| !n).collect();
        let mut inside: Vec<bool> = squared_distances(&outside, size).into_par_iter().map(|d| d > reach).collect();
        // Rounding at the raster must not lose a column that holds data.
        inside.par_iter_mut().zip(&occupied).for_each(|(i, &o)| *i |= o);
        Self { low, cell, size, inside }
    }

    /// Whether the column over (x, y) belongs to the outline.
    #[must_use]
    pub fn contains(&self, x: f64, y: f64) -> bool {
        let [i, j] = [(x - self.low[0]) / self.cell, (y - self.low[1]) / self.cell];
        let whole = |c: f64, n: usize| (c >= 0.0 && c < n as f64).then_some(c as usize);
        match (whole(i, self.size[0]), whole(j, self.size[1])) {
            (Some(i), Some(j)) => self.inside[i + self.size[0] * j],
            _ => false,
        }
    }
}

/// Squared distance, in cells, from each cell to the nearest one of the set (exact; lower envelope of parabolas per line, after
/// Felzenszwalb and Huttenlocher 2012).
fn squared_distances(set: &[bool], size: [usize; 2]) -> Vec<f32> {
    let far = (size[0] * size[0] + size[1] * size[1]) as f32;
    let mut rows: Vec<f32> = vec![far; set.len()];
    rows.par_chunks_exact_mut(size[0]).zip(set.par_chunks_exact(size[0])).for_each(|(row, set)| {
        let mut last: Option<usize> = None;
        for x in 0..size[0] {
            if set[x] {
                last = Some(x);
            }
            if let Some(l) = last {
                row[x] = ((x - l) * (x - l)) as f32;
            }
        }
        last = None;
        for x in (0..size[0]).rev() {
            if set[x] {
                last = Some(x);
            }
            if let Some(l) = last {
                row[x] = row[x].min(((l - x) * (l - x)) as f32);
            }
        }
    });
    let columns: Vec<Vec<f32>> = (0..size[0])
        .into_par_iter()
        .map(|x| {
            let line: Vec<f32> = (0..size[1]).map(|y| rows[x + size[0] * y]).collect();
            lower_envelope(&line)
        })
        .collect();
    rows.par_chunks_exact_mut(size[0]).enumerate().for_each(|(y, row)| {
        for (x, value) in row.iter_mut().enumerate() {
            *value = columns[x][y];
        }
    });
    rows
}

/// min over q of (p - q)^2 + line[q], for every p.
fn lower_envelope(line: &[f32]) -> Vec<f32> {
    let n = line.len();
    let value = |q: usize| f64::from(line[q]) + (q * q) as f64;
    let mut parabolas: Vec<(usize, f64)> = Vec::with_capacity(n);
    for q in 0..n {
        let mut from = f64::NEG_INFINITY;
        while let Some(&(p, start)) = parabolas.last() {
            from = (value(q) - value(p)) / (2.0 * (q - p) as f64);
            if from > start {
                break;
            }
            parabolas.pop();
            from = f64::NEG_INFINITY;
        }
        parabolas.push((q, from));
    }
    let mut at = 0;
    (0..n)
        .map(|p| {
            while at + 1 < parabolas.len() && parabolas[at + 1].1 <= p as f64 {
                at += 1;
            }
            let q = parabolas[at].0;
            let d = p as f64 - q as f64;
            (d * d) as f32 + line[q]
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_match_brute_force() {
        let size = [37, 23];
        let set: Vec<bool> = (0..size[0] * size[1]).map(|i| i * 7919 % 53 == 0).collect();
        let fast = squared_distances(&set, size);
        for (i, &d) in fast.iter().enumerate() {
            let (x, y) = ((i % size[0]) as i64, (i / size[0]) as i64);
            let brute = (0..set.len())
                .filter(|&j| set[j])
                .map(|j| (x - (j % size[0]) as i64).pow(2) + (y - (j / size[0]) as i64).pow(2))
                .min()
                .unwrap();
            assert_eq!(d, brute as f32, "cell {i}");
        }
    }

    #[test]
    fn gaps_are_bridged_and_the_outline_is_kept() {
        // A square of 20 with a slit of width 4 and a bay of width 12.
        let mut points = Vec::new();
        for x in 0..200 {
            for y in 0..200 {
                let (x, y) = (f64::from(x) / 10.0, f64::from(y) / 10.0);
                let slit = (8.0..12.0).contains(&x) && y < 3.0;
                let bay = (4.0..16.0).contains(&x) && y > 14.0;
                if !slit && !bay {
                    points.push([x, y, 0.0]);
                }
            }
        }
        let outline = ColumnOutline::new(&points, 0.1, 3.0);
        assert!(outline.contains(10.0, 2.5), "the slit is bridged");
        assert!(!outline.contains(10.0, 19.0), "the bay stays open");
        assert!(!outline.contains(-0.5, 10.0) && !outline.contains(20.5, 10.0), "nothing beyond the outline");
        assert!(outline.contains(0.05, 0.05), "corners with data stay");
    }
}
