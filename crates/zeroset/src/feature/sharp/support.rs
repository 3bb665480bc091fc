//! The points that bear the planes, sorted into cells, and which planes come near one another.

use rayon::prelude::*;
use rustc_hash::FxHashMap;
use std::ops::Range;

use crate::vec3::Vec3;

/// A flat region as edges and corners see it.
#[derive(Debug, Clone, Copy)]
pub(in crate::feature) struct Flat {
    /// Unit normal, outward where known.
    pub(in crate::feature) normal: Vec3,
    /// `normal . x` on the plane.
    pub(in crate::feature) offset: f64,
    /// Whether the normal is known to point outward.
    pub(in crate::feature) oriented: bool,
}

impl Flat {
    /// Signed distance from the plane.
    #[inline]
    pub(in crate::feature) fn distance(&self, p: Vec3) -> f64 {
        crate::vec3::dot(self.normal, p) - self.offset
    }
}

type Cell = [i32; 3];

/// Points with the planes that they lie on, in cells as wide as the reach.
#[derive(Debug)]
pub(in crate::feature) struct Support<'a> {
    points: &'a [Vec3],
    /// How far data may lie from a line, or a corner, to bear it.
    pub(in crate::feature) reach: f64,
    /// Plane and point, sorted by cell, plane, point.
    entries: Vec<(Cell, u32, u32)>,
    cells: FxHashMap<Cell, Range<u32>>,
}

/// The points of two planes that lie in cells next to each other.
#[derive(Debug, Default)]
pub(in crate::feature) struct Contact {
    /// The two planes, ascending.
    pub(in crate::feature) planes: [u32; 2],
    /// The points of each.
    pub(in crate::feature) points: [Vec<u32>; 2],
}

impl<'a> Support<'a> {
    /// `labels` holds the plane of each point, or none.
    pub(in crate::feature) fn new(points: &'a [Vec3], labels: &[Option<u32>], reach: f64) -> Self {
        let mut entries: Vec<(Cell, u32, u32)> = points
            .par_iter()
            .zip(labels)
            .enumerate()
            .filter_map(|(i, (&p, label))| Some((cell(p, reach), (*label)?, i as u32)))
            .collect();
        entries.par_sort_unstable();
        let mut cells = FxHashMap::default();
        let mut first = 0;
        for run in entries.chunk_by(|a, b| a.0 == b.0) {
            let last = first + run.len() as u32;
            cells.insert(run[0].0, first..last);
            first = last;
        }
        Self { points, reach, entries, cells }
    }

    pub(in crate::feature) fn point(&self, i: u32) -> Vec3 {
        self.points[i as usize]
    }

    fn of_cell(&self, cell: Cell) -> &[(Cell, u32, u32)] {
        self.cells.get(&cell).map_or(&[], |range| &self.entries[range.start as usize..range.end as usize])
    }

    /// Every pair of planes that have points in cells next to each other, ascending.
    pub(in crate::feature) fn contacts(&self) -> Vec<Contact> {
        let runs: Vec<&[(Cell, u32, u32)]> = self.entries.chunk_by(|a, b| a.0 == b.0).collect();
        let mut found: Vec<([u32; 2], u8, u32)> = runs
            .into_par_iter()
            .flat_map_iter(|run| {
                let near = self.labels_near(run[0].0);
                let mut found = Vec::new();
                if near.len() > 1 {
                    for &(_, label, point) in run {
                        for &other in near.iter().filter(|&&other| other != label) {
                            found.push(([label.min(other), label.max(other)], u8::from(label > other), point));
                        }
                    }
                }
                found
            })
            .collect();
        found.par_sort_unstable();
        found
            .chunk_by(|a, b| a.0 == b.0)
            .map(|pair| {
                let mut contact = Contact { planes: pair[0].0, ..Contact::default() };
                for &(_, side, point) in pair {
                    contact.points[usize::from(side)].push(point);
                }
                contact
            })
            .filter(|contact| contact.points.iter().all(|side| !side.is_empty()))
            .collect()
    }

    /// The planes with points in the cell and those around it, ascending.
    fn labels_near(&self, centre: Cell) -> Vec<u32> {
        let mut labels: Vec<u32> = around(centre)
            .flat_map(|cell| self.of_cell(cell).chunk_by(|a, b| a.1 == b.1).map(|run| run[0].1))
            .collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    }

    /// The planes with points within the reach of a position, ascending.
    pub(in crate::feature) fn planes_within(&self, p: Vec3) -> Vec<u32> {
        let squared = self.reach * self.reach;
        let near = |&&(_, _, i): &&(Cell, u32, u32)| crate::vec3::distance_squared(self.point(i), p) <= squared;
        let mut labels: Vec<u32> = around(cell(p, self.reach))
            .flat_map(|cell| self.of_cell(cell).iter().filter(near).map(|entry| entry.1))
            .collect();
        labels.sort_unstable();
        labels.dedup();
        labels
    }
}

fn cell(p: Vec3, side: f64) -> Cell {
    p.map(|c| (c / side).floor() as i32)
}

/// A cell and the 26 around it.
fn around(centre: Cell) -> impl Iterator<Item = Cell> {
    (0..27).map(move |code| [centre[0] + code % 3 - 1, centre[1] + code / 3 % 3 - 1, centre[2] + code / 9 - 1])
}
