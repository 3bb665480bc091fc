//! Which surface stays.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

use super::{Fitted, SAMPLES_REL};
use crate::contour::ColumnOutline;
use crate::monitor::{Monitor, Steps};
use crate::spatial::PointTree;

/// Polygons for each node that is known, about.
const POLYGONS_A_NODE: f64 = 0.36;

/// Counts the polygons of the extraction for a monitor.
pub(super) struct Watch<'a> {
    steps: Steps<'a>,
    polygons: AtomicUsize,
    cancelled: AtomicBool,
}

impl<'a> Watch<'a> {
    /// Polygons between two looks at the monitor.
    const STRIDE: usize = 1 << 14;

    /// Of the surface of a fitted model.
    pub(super) fn of(fitted: &Fitted, monitor: &'a dyn Monitor, shares: Range<f64>) -> Self {
        let nodes = fitted.lattice().known_nodes() as f64;
        let steps = Steps::new(monitor, shares, (POLYGONS_A_NODE * nodes) as usize);
        Self { steps, polygons: AtomicUsize::new(0), cancelled: AtomicBool::new(false) }
    }

    /// Counts a polygon. Once this is `false` the mesh is not wanted any more, and emptying it ends the work soonest.
    pub(super) fn goes_on(&self) -> bool {
        if self.polygons.fetch_add(1, Ordering::Relaxed) % Self::STRIDE == Self::STRIDE - 1
            && self.steps.advance(Self::STRIDE).is_err()
        {
            self.cancelled.store(true, Ordering::Relaxed);
        }
        !self.cancelled.load(Ordering::Relaxed)
    }
}

/// Where the surface of a fitted model is kept, in the frame of the fit.
pub(super) enum Keep {
    /// Within the outline seen from above.
    Outline(ColumnOutline),
    /// Within a distance of the points.
    Near { tree: PointTree, radius: f64 },
}

impl Keep {
    /// What the user knows counts like points. `None` if all is kept.
    pub(super) fn new(fitted: &Fitted) -> Option<Self> {
        let radius = fitted.parts().trim?;
        let (frame, cell) = (fitted.frame(), fitted.cell());
        let mut points = fitted.positions();
        points.extend(fitted.held().samples(SAMPLES_REL * cell));
        points.par_iter_mut().for_each(|p| *p = frame.enter(*p));
        Some(if fitted.is_ground() {
            Self::Outline(ColumnOutline::new(&points, cell, radius))
        } else {
            Self::Near { tree: PointTree::new(&points), radius }
        })
    }

    pub(super) fn contains(&self, p: [f64; 3]) -> bool {
        match self {
            Self::Outline(outline) => outline.contains(p[0], p[1]),
            Self::Near { tree, radius } => tree.nearest_within(p, *radius).is_some(),
        }
    }
}
