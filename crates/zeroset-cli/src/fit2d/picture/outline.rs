//! The outline of many polygons that share edges.

use std::collections::BTreeMap;

use super::Pixel;

/// Directed edges of polygons that run the same way round. An edge that two polygons share cancels out, so what is left is the outline
/// of all of them. This keeps pictures small, and lets no gaps shine through between neighbours.
#[derive(Debug, Default)]
pub(super) struct Outline {
    /// From the lesser to the greater end: how often this way, less how often the other.
    edges: BTreeMap<[Pixel; 2], i32>,
}

impl Outline {
    /// Adds a polygon.
    pub(super) fn add(&mut self, polygon: &[Pixel]) {
        for (i, &from) in polygon.iter().enumerate() {
            let to = polygon[(i + 1) % polygon.len()];
            // Edges without length leave the sum of all ways closed.
            if from != to {
                let (edge, way) = if from < to { ([from, to], 1) } else { ([to, from], -1) };
                *self.edges.entry(edge).or_default() += way;
            }
        }
    }

    /// The commands of a path.
    pub(super) fn commands(&self) -> String {
        let mut next: BTreeMap<Pixel, Vec<Pixel>> = BTreeMap::new();
        for (&[low, high], &ways) in &self.edges {
            let [from, to] = if ways > 0 { [low, high] } else { [high, low] };
            for _ in 0..ways.unsigned_abs() {
                next.entry(from).or_default().push(to);
            }
        }
        let mut commands = String::new();
        while let Some((&start, _)) = next.first_key_value() {
            let mut ring = Vec::new();
            let mut at = start;
            // As many edges lead to a place as from it, so each way ends where it began.
            while let Some(ends) = next.get_mut(&at) {
                ring.push(at);
                let to = ends.pop();
                if ends.is_empty() {
                    next.remove(&at);
                }
                let Some(to) = to else { break };
                at = to;
                if at == start {
                    break;
                }
            }
            commands += &closed(&ring);
        }
        commands
    }
}

/// A ring without the places at which it does not turn.
fn closed(ring: &[Pixel]) -> String {
    let count = ring.len();
    let turns = |&i: &usize| {
        let [p, q, r] = [ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count]];
        let side = |from: Pixel, to: Pixel| [0, 1].map(|a| i64::from(to[a]) - i64::from(from[a]));
        let (u, v) = (side(p, q), side(q, r));
        u[0] * v[1] != u[1] * v[0]
    };
    let kept: Vec<Pixel> = (0..count).filter(turns).map(|i| ring[i]).collect();
    // Fewer corners have no area.
    if kept.len() < 3 { String::new() } else { super::polyline(&kept, true) }
}

#[cfg(test)]
mod tests {
    use super::super::canvas::place;
    use super::*;

    #[test]
    fn shared_edges_cancel() {
        let mut outline = Outline::default();
        outline.add(&[[0, 0], [100, 0], [100, 100], [0, 100]]);
        outline.add(&[[100, 0], [200, 0], [200, 100], [100, 100]]);
        assert_eq!(outline.commands(), format!("M{}L{}L{}L{}Z", place([0, 0]), "2 0", "2 1", "0 1"));
    }
}
