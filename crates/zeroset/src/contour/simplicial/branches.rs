//! Which parts of the zero set stay: those that hold data, and those that continue them.
//!
//! Parts that continue one another stay or go together, so the question is asked of whole curves and surfaces, here called sheets.

use super::Branches;
use crate::domain::{Place, SimplicialMesh};
use crate::spatial::TriangleTree;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// A sample farther from the zero set than this share of the longest edge of its cell tells nothing.
///
/// A fit that misses its data by so much says nothing about them, and such a sample is most likely an outlier.
const REACH_REL: f64 = 0.25;

/// A sample tells for the nearest sheet only if every other one is farther by this factor.
///
/// Where two branches of a hyperbola nearly meet, the data of one are about as near to the other.
const CLEARLY: f64 = 2.0;

/// The least share that a sheet must have of the samples in the cells that it passes, so that a few outliers revive nothing.
const LEAST_SHARE: f64 = 0.05;

/// A connected component of the zero set in one cell.
pub(super) trait Component {
    /// The cell.
    fn cell(&self) -> usize;
    /// Where it leaves the cell: components that have a link in common continue one another.
    fn links(&self) -> &[u64];
    /// Its points, to measure distances from.
    fn tree(&self) -> TriangleTree;
}

/// Marks the components that stay. They come in ascending order of their cells.
pub(super) fn kept<const D: usize, C: Component>(
    domain: &SimplicialMesh<D>,
    components: &[C],
    branches: Branches<'_, D>,
) -> Vec<bool> {
    let Branches::WithData(places) = branches else { return vec![true; components.len()] };
    let sheets = Sheets::new(components);
    let samples = sheets.samples(domain, components, places);
    let hold_data = sheets.hold_data(components, &samples);
    sheets.of.iter().map(|&sheet| hold_data[sheet]).collect()
}

/// Components sorted into sheets.
struct Sheets {
    /// For each component its sheet.
    of: Vec<usize>,
    count: usize,
}

impl Sheets {
    fn new<C: Component>(components: &[C]) -> Self {
        let mut linked: FxHashMap<u64, Vec<usize>> = FxHashMap::default();
        for (c, component) in components.iter().enumerate() {
            for &link in component.links() {
                linked.entry(link).or_default().push(c);
            }
        }
        let mut of: Vec<Option<usize>> = vec![None; components.len()];
        let mut count = 0;
        for first in 0..components.len() {
            if of[first].is_some() {
                continue;
            }
            of[first] = Some(count);
            let mut open = vec![first];
            while let Some(component) = open.pop() {
                for &next in components[component].links().iter().flat_map(|link| &linked[link]) {
                    if of[next].is_none() {
                        of[next] = Some(count);
                        open.push(next);
                    }
                }
            }
            count += 1;
        }
        Self { of: of.into_iter().flatten().collect(), count }
    }

    /// How many samples each component holds.
    fn samples<const D: usize, C: Component>(
        &self,
        domain: &SimplicialMesh<D>,
        components: &[C],
        places: &[Place<D>],
    ) -> Vec<usize> {
        let trees: Vec<_> = components.iter().map(Component::tree).collect();
        let mut samples = vec![0; components.len()];
        for place in places {
            let mut position = [0.0; 3];
            position[..D].copy_from_slice(&place.position);
            // Data on a face, or the zero set beside it, can belong to either side, so neighbours compete.
            let neighbors = (0..=D).filter_map(|corner| domain.neighbor(place.simplex, corner));
            let mut distances: Vec<(f64, usize)> = std::iter::once(place.simplex)
                .chain(neighbors)
                .flat_map(|cell| of_cell(components, cell))
                .filter_map(|c| Some((trees[c].closest(position)?.distance_squared.sqrt(), c)))
                .collect();
            distances.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            let Some(&(least, nearest)) = distances.first() else { continue };
            let rival = distances.iter().find(|&&(_, c)| self.of[c] != self.of[nearest]);
            let clear = rival.is_none_or(|&(distance, _)| CLEARLY * least < distance);
            if clear && least <= REACH_REL * longest_edge(domain, place.simplex) {
                samples[nearest] += 1;
            }
        }
        samples
    }

    /// Which sheets hold data.
    fn hold_data<C: Component>(&self, components: &[C], samples: &[usize]) -> Vec<bool> {
        let (mut own, mut all) = (vec![0; self.count], vec![0; self.count]);
        let mut counted = vec![None; self.count];
        for (c, component) in components.iter().enumerate() {
            let sheet = self.of[c];
            own[sheet] += samples[c];
            // A sheet can pass a cell more than once, but components come cell by cell.
            if counted[sheet].replace(component.cell()) != Some(component.cell()) {
                all[sheet] += samples[of_cell(components, component.cell())].iter().sum::<usize>();
            }
        }
        (0..self.count).map(|s| own[s] > 0 && own[s] as f64 >= LEAST_SHARE * all[s] as f64).collect()
    }
}

/// The components of a cell.
fn of_cell<C: Component>(components: &[C], cell: usize) -> Range<usize> {
    components.partition_point(|c| c.cell() < cell)..components.partition_point(|c| c.cell() <= cell)
}

fn longest_edge<const D: usize>(domain: &SimplicialMesh<D>, simplex: usize) -> f64 {
    let edges = domain.edges_of(simplex).iter().map(|&e| domain.edges()[e as usize]);
    let squared = |[p, q]: [u32; 2]| {
        let (p, q) = (domain.vertices()[p as usize], domain.vertices()[q as usize]);
        (0..D).map(|a| (p[a] - q[a]).powi(2)).sum::<f64>()
    };
    edges.map(squared).fold(0.0, f64::max).sqrt()
}
