//! Which simplices are near a point: a regular grid of buckets over the mesh, where those that are full are split further.

use std::collections::VecDeque;

use crate::domain::bounds;

/// Simplices by where they are.
#[derive(Debug, Clone)]
pub(super) struct Locator<const D: usize> {
    low: [f64; D],
    /// Buckets over length, by axis.
    scale: [f64; D],
    size: [usize; D],
    /// By how much boxes are grown against rounding of positions.
    margin: f64,
    /// First the buckets of the grid, then those that others are split into.
    buckets: Vec<Bucket>,
    /// The simplices that touch each bucket, ascending.
    simplices: Vec<u32>,
}

/// A box, as part of space.
#[derive(Debug, Clone, Copy)]
enum Bucket {
    /// Its simplices, as a range of the list of all.
    Whole { first: u32, end: u32 },
    /// It is cut in half along each axis. The parts begin here; the first axis is fastest.
    Split { parts: u32 },
}

/// Most buckets along an axis of the grid.
const MOST: f64 = 512.0;

/// By what share of a bucket's side boxes are grown against rounding.
const GROWN: f64 = 1e-6;

/// A bucket with more simplices than this is split. In a regular mesh a few tens touch one.
const FULL: usize = 64;

/// How often a bucket of the grid is split at most: where very many simplices share a vertex, no split parts them.
const DEEPEST: u32 = 24;

/// Most entries of all buckets, for each simplex.
const ENTRIES: usize = 64;

/// What a simplex covers: its box and the gradients of its coordinates.
struct Cover<'a, const D: usize> {
    low: [f64; D],
    high: [f64; D],
    origin: [f64; D],
    gradients: &'a [[f64; D]; 4],
}

/// The box of a bucket by its middle and half its sides.
#[derive(Clone, Copy)]
struct Extent<const D: usize> {
    middle: [f64; D],
    half: [f64; D],
}

impl<const D: usize> Extent<D> {
    /// The part with the upper half along the axes whose bits are set.
    fn part(&self, bits: usize) -> Self {
        let half = self.half.map(|h| 0.5 * h);
        let middle = std::array::from_fn(|a| self.middle[a] + if bits >> a & 1 == 1 { half[a] } else { -half[a] });
        Self { middle, half }
    }

    /// The part that holds a position.
    fn part_of(&self, position: [f64; D]) -> usize {
        (0..D).map(|a| usize::from(position[a] >= self.middle[a]) << a).sum()
    }

    fn touches(&self, low: [f64; D], high: [f64; D], margin: f64) -> bool {
        (0..D).all(|a| {
            let reach = (1.0 + GROWN) * self.half[a] + margin;
            low[a] <= self.middle[a] + reach && high[a] >= self.middle[a] - reach
        })
    }

    /// Whether the box may hold a point of a simplex: no face has all of the box beyond it. A thin simplex across the mesh would
    /// otherwise be in all buckets of its box.
    fn may_hold(&self, simplex: &Cover<'_, D>, margin: f64) -> bool {
        if !self.touches(simplex.low, simplex.high, margin) {
            return false;
        }
        (0..=D).all(|corner| {
            let (mut weight, mut reach, mut size) = (if corner == 0 { 1.0 } else { 0.0 }, 0.0, 1.0);
            for (a, gradient) in simplex.gradients[corner].into_iter().enumerate() {
                let offset = self.middle[a] - simplex.origin[a];
                let half = (1.0 + GROWN) * self.half[a] + margin;
                weight += gradient * offset;
                reach += gradient.abs() * half;
                size += gradient.abs() * (offset.abs() + half);
            }
            // Flat simplices have gradients with few digits, so the sizes of all terms count, and half of the digits are kept.
            weight + reach >= -1e-8 * size * size
        })
    }
}

impl<const D: usize> Locator<D> {
    pub(super) fn new(vertices: &[[f64; D]], corners: &[u32], gradients: &[[[f64; D]; 4]]) -> Self {
        let (low, high) = bounds(corners.iter().map(|&v| vertices[v as usize]));
        let count = (corners.len() / (D + 1)) as f64;
        let longest = (0..D).map(|a| high[a] - low[a]).fold(0.0, f64::max);
        let volume: f64 = (0..D).map(|a| (high[a] - low[a]).max(1e-3 * longest)).product();
        // About two simplices a bucket.
        let side = (2.0 * volume / count).powf(1.0 / D as f64);
        let size: [usize; D] = std::array::from_fn(|a| ((high[a] - low[a]) / side).ceil().clamp(1.0, MOST) as usize);
        let scale = std::array::from_fn(|a| size[a] as f64 / (high[a] - low[a]));
        let margin = 32.0 * f64::EPSILON * low.iter().chain(&high).fold(0.0_f64, |m, c| m.max(c.abs()));
        let mut grid = Self { low, scale, size, margin, buckets: Vec::new(), simplices: Vec::new() };
        let covers: Vec<_> = corners
            .chunks_exact(D + 1)
            .zip(gradients)
            .map(|(simplex, gradients)| {
                let (low, high) = bounds(simplex.iter().map(|&v| vertices[v as usize]));
                Cover { low, high, origin: vertices[simplex[0] as usize], gradients }
            })
            .collect();
        grid.fill(&covers);
        grid.split(&covers);
        grid
    }

    /// Puts simplices into the buckets of the grid.
    fn fill(&mut self, covers: &[Cover<'_, D>]) {
        let mut entries = Vec::new();
        for (s, cover) in covers.iter().enumerate() {
            self.for_each_cell(cover.low, cover.high, |cell| {
                if self.extent(cell).may_hold(cover, self.margin) {
                    entries.push((self.index(cell) as u32, s as u32));
                }
            });
        }
        entries.sort_unstable();
        let mut first = 0;
        for bucket in 0..self.size.iter().product::<usize>() {
            let end = first + entries[first..].iter().take_while(|(b, _)| *b as usize == bucket).count();
            self.buckets.push(Bucket::Whole { first: first as u32, end: end as u32 });
            first = end;
        }
        self.simplices = entries.into_iter().map(|(_, s)| s).collect();
    }

    /// Splits buckets that are full, the largest first, as long as that parts their simplices.
    fn split(&mut self, covers: &[Cover<'_, D>]) {
        let mut queue: VecDeque<(usize, Extent<D>, u32)> = VecDeque::new();
        self.for_each_cell(self.low, self.low.map(|_| f64::INFINITY), |cell| {
            queue.push_back((self.index(cell), self.extent(cell), 0));
        });
        while let Some((bucket, extent, depth)) = queue.pop_front() {
            let Bucket::Whole { first, end } = self.buckets[bucket] else { continue };
            let inside = first as usize..end as usize;
            let (held, spent) = (inside.len(), self.simplices.len());
            if held <= FULL || depth == DEEPEST || spent > ENTRIES * covers.len() {
                continue;
            }
            let parts = self.buckets.len();
            for bits in 0..1 << D {
                let (part, first) = (extent.part(bits), self.simplices.len());
                for k in inside.clone() {
                    let simplex = self.simplices[k];
                    if part.may_hold(&covers[simplex as usize], self.margin) {
                        self.simplices.push(simplex);
                    }
                }
                self.buckets.push(Bucket::Whole { first: first as u32, end: self.simplices.len() as u32 });
                queue.push_back((parts + bits, part, depth + 1));
            }
            // Sheets that cross the bucket are in half of its parts. If more are, they are not parted.
            if self.simplices.len() - spent > (held << D) / 2 {
                self.simplices.truncate(spent);
                self.buckets.truncate(parts);
                queue.truncate(queue.len() - (1 << D));
            } else {
                self.buckets[bucket] = Bucket::Split { parts: parts as u32 };
            }
        }
    }

    fn cell(&self, position: [f64; D]) -> [usize; D] {
        std::array::from_fn(|a| {
            (((position[a] - self.low[a]) * self.scale[a]).floor().max(0.0) as usize).min(self.size[a] - 1)
        })
    }

    fn index(&self, cell: [usize; D]) -> usize {
        (0..D).rev().fold(0, |index, a| index * self.size[a] + cell[a])
    }

    fn extent(&self, cell: [usize; D]) -> Extent<D> {
        Extent {
            middle: std::array::from_fn(|a| self.low[a] + (cell[a] as f64 + 0.5) / self.scale[a]),
            half: std::array::from_fn(|a| 0.5 / self.scale[a]),
        }
    }

    /// The cells of the grid that a box touches, grown a little against rounding.
    fn for_each_cell(&self, low: [f64; D], high: [f64; D], mut visit: impl FnMut([usize; D])) {
        let first = self.cell(std::array::from_fn(|a| low[a] - GROWN / self.scale[a] - self.margin));
        let last = self.cell(std::array::from_fn(|a| high[a] + GROWN / self.scale[a] + self.margin));
        let mut cell = first;
        loop {
            visit(cell);
            let Some(axis) = (0..D).find(|&a| cell[a] < last[a]) else { return };
            cell[axis] += 1;
            cell[..axis].copy_from_slice(&first[..axis]);
        }
    }

    /// All simplices that a position can lie in, ascending.
    pub(super) fn near(&self, position: [f64; D]) -> &[u32] {
        let cell = self.cell(position);
        let (mut bucket, mut extent) = (self.index(cell), self.extent(cell));
        loop {
            match self.buckets[bucket] {
                Bucket::Whole { first, end } => return &self.simplices[first as usize..end as usize],
                Bucket::Split { parts } => {
                    let bits = extent.part_of(position);
                    (bucket, extent) = (parts as usize + bits, extent.part(bits));
                }
            }
        }
    }

    /// Adds the simplices of all buckets that touch a box, in no order and with repeats.
    pub(super) fn collect(&self, low: [f64; D], high: [f64; D], found: &mut Vec<u32>) {
        let mut stack = Vec::new();
        self.for_each_cell(low, high, |cell| stack.push((self.index(cell), self.extent(cell))));
        while let Some((bucket, extent)) = stack.pop() {
            match self.buckets[bucket] {
                Bucket::Whole { first, end } => {
                    found.extend_from_slice(&self.simplices[first as usize..end as usize]);
                }
                Bucket::Split { parts } => stack.extend(
                    (0..1 << D)
                        .map(|bits| (parts as usize + bits, extent.part(bits)))
                        .filter(|(_, part)| part.touches(low, high, self.margin)),
                ),
            }
        }
    }

    /// Into how many parts a segment is to be cut so that none has a box much larger than a bucket of the grid.
    pub(super) fn buckets_along(&self, from: [f64; D], to: [f64; D]) -> usize {
        let crossed = (0..D).map(|a| (to[a] - from[a]).abs() * self.scale[a]).fold(1.0, f64::max);
        crossed.min(2.0 * MOST).ceil() as usize
    }
}
