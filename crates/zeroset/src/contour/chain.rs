//! Links put in order around a vertex or an edge.

/// What links make, once in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Chain {
    /// One ring: the last link ends where the first begins.
    Closed,
    /// One chain with two ends.
    Open,
    /// Several chains or rings, or none; the order means nothing.
    Broken,
}

/// Puts links in order, so that each begins where the one before ends. At most one link may begin, and one end, in each place.
pub(super) fn chain<T>(links: &mut [T], ends: impl Fn(&T) -> [u32; 2]) -> Chain {
    if links.is_empty() {
        return Chain::Broken;
    }
    // An open chain begins where no link ends.
    let is_first = |link: &T| links.iter().all(|other| ends(other)[1] != ends(link)[0]);
    let first = links.iter().position(is_first);
    links.swap(0, first.unwrap_or(0));
    for i in 1..links.len() {
        let end = ends(&links[i - 1])[1];
        let Some(next) = (i..links.len()).find(|&j| ends(&links[j])[0] == end) else { return Chain::Broken };
        links.swap(i, next);
    }
    if first.is_none() { Chain::Closed } else { Chain::Open }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_chains_and_several() {
        let mut ring = [[3, 1], [2, 3], [1, 2]];
        assert_eq!(chain(&mut ring, |l| *l), Chain::Closed);
        assert_eq!(ring, [[3, 1], [1, 2], [2, 3]]);
        let mut open = [[2, 3], [1, 2], [3, 4]];
        assert_eq!(chain(&mut open, |l| *l), Chain::Open);
        assert_eq!(open, [[1, 2], [2, 3], [3, 4]]);
        assert_eq!(chain(&mut [[1, 2], [3, 4]], |l| *l), Chain::Broken);
        assert_eq!(chain(&mut [[1, 2], [2, 1], [3, 4], [4, 3]], |l| *l), Chain::Broken);
        assert_eq!(chain(&mut [[1, 2], [2, 3], [5, 4], [4, 5]], |l| *l), Chain::Broken);
        assert_eq!(chain(&mut [] as &mut [[u32; 2]], |l| *l), Chain::Broken);
    }
}
