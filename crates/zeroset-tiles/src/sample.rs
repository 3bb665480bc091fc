//! The points that everything is measured on.
//!
//! Spacing, noise and planes need points at their full density, and a city differs from place to place: where strips of a flight overlap there are twice as
//! many. So the sample is made of small squares from all over, each with all its points.

use zeroset::cloud::{Cloud, retain};
use zeroset::reconstruct::Up;
use zeroset::tile::TileId;

use crate::{Folder, Sorted, TilesError};

/// Points of a sample, about.
const POINTS: u64 = 2_000_000;
/// Squares that they lie in, about, and most tiles that are read.
const SQUARES: usize = 64;

impl Folder {
    /// All points where there are few; otherwise those in squares of up to 64 tiles from all over, two million in all, about.
    pub(crate) fn sample(&self, sorted: &Sorted, up: Up) -> Result<Cloud, TilesError> {
        let mut sample = Cloud { world_from_local: sorted.offset(), crs: sorted.crs.clone(), ..Cloud::default() };
        let is_small = sorted.points <= POINTS;
        let n = sorted.tiles.len();
        let read = if is_small { n } else { n.min(SQUARES) };
        // Every so many, round and round.
        let step = (1..n).find(|&s| s * 1000 > n * 618 && common_divisor(s, n) == 1).unwrap_or(1);
        let chosen: Vec<_> = (0..read).map(|i| &sorted.tiles[i * step % n]).collect();
        let there: u64 = chosen.iter().map(|tile| tile.points).sum();
        let share = if is_small { 1.0 } else { POINTS as f64 / there as f64 };
        for (i, tile) in chosen.into_iter().enumerate() {
            let mut points = self.load(sorted, tile.id, 0)?;
            if share < 1.0 {
                let squares = Squares { count: SQUARES.div_ceil(read), first: i, share };
                let offset = up.upright(points.world_from_local);
                let keep: Vec<bool> = points
                    .points
                    .iter()
                    .map(|&p| squares.contain(within(tile.id, up.upright(p), offset, sorted.side)))
                    .collect();
                retain(&mut points, &keep);
            }
            sample.append(points);
        }
        Ok(sample)
    }
}

/// Where a tile a position lies, from 0 to 1 along either side.
fn within(tile: TileId, p: [f64; 3], offset: [f64; 3], side: f64) -> [f64; 2] {
    let at = |a: usize, corner: i32| (p[a] + offset[a]) / side - f64::from(corner);
    [at(0, tile.x), at(1, tile.y)]
}

/// Equal squares in a tile whose sides are 1, which together have a share of it. They lie somewhere else in each tile.
#[derive(Debug, Clone, Copy)]
struct Squares {
    count: usize,
    first: usize,
    share: f64,
}

impl Squares {
    /// One for each cell of a grid with at least so many; its place in the cell follows a sequence that fills it evenly.
    fn contain(self, p: [f64; 2]) -> bool {
        let across = (self.count as f64).sqrt().ceil();
        let side = self.share.sqrt();
        let [column, row] = p.map(|c| (c * across).floor().clamp(0.0, across - 1.0));
        let number = self.first as f64 * across * across + row * across + column;
        // Powers of the inverse of the plastic number, the root of x^3 = x + 1: the golden ratio of the plane.
        let low =
            [0.754_877_666_246_693, 0.569_840_290_998_053].map(|step| (0.5 + step * number).fract() * (1.0 - side));
        let [x, y] = [p[0] * across - column, p[1] * across - row];
        (low[0]..low[0] + side).contains(&x) && (low[1]..low[1] + side).contains(&y)
    }
}

fn common_divisor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_divisor(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn squares_have_their_share_of_a_tile_and_lie_elsewhere_in_the_next() {
        let inside = |squares: Squares| {
            let all = (0..400 * 400).map(|k| [k % 400, k / 400].map(|c| (f64::from(c) + 0.5) / 400.0));
            all.filter(|&p| squares.contain(p)).map(|p| p.map(f64::to_bits)).collect::<Vec<_>>()
        };
        for (count, share) in [(1, 0.25), (1, 0.01), (5, 0.04), (64, 0.09)] {
            let [one, next] = [0, 1].map(|first| inside(Squares { count, first, share }));
            assert!((one.len() as f64 / 160_000.0 / share - 1.0).abs() < 0.12, "{count}, {share}: {}", one.len());
            assert_ne!(one, next);
        }
    }

    #[test]
    fn a_position_is_told_from_the_corner_of_its_tile() {
        let found = within(TileId { x: -2, y: 3 }, [-30.0, 10.0, 5.0], [-150.0, 315.0, 0.0], 100.0);
        assert!((found[0] - 0.2).abs() < 1e-12 && (found[1] - 0.25).abs() < 1e-12, "{found:?}");
    }
}
