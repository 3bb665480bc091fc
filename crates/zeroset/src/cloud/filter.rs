//! Which points of a cloud to use.

use rayon::prelude::*;
use serde::Serialize;

use super::{Attributes, Cloud};

/// ASPRS classes that hold noise: 7 low point, 18 high noise. Left out unless asked for.
pub const NOISE_CLASSES: [u8; 2] = [7, 18];

/// Which points to keep.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Filter {
    /// Only these classes, where the cloud has classes.
    pub only_classes: Option<Vec<u8>>,
    /// None of these classes.
    pub exclude_classes: Vec<u8>,
    /// Only points in this box of world coordinates; an axis may be unbounded.
    pub bounds: Option<[[f64; 2]; 3]>,
}

/// How many points a [`Filter`] left out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
pub struct FilterReport {
    /// By class.
    pub by_class: usize,
    /// By the box.
    pub by_bounds: usize,
}

impl Filter {
    /// The classes that are left out where the user names none: noise, unless it is asked for.
    #[must_use]
    pub fn excluded_by_default(only_classes: Option<&[u8]>) -> Vec<u8> {
        let asked_for = |class: &u8| only_classes.is_some_and(|only| only.contains(class));
        NOISE_CLASSES.into_iter().filter(|class| !asked_for(class)).collect()
    }

    /// Drops the points that the filter leaves out. Points keep their order.
    #[must_use]
    pub fn apply(&self, cloud: &mut Cloud) -> FilterReport {
        let mut report = FilterReport::default();
        if let Some(classes) = &cloud.attributes.classes {
            let wanted: [bool; 256] = std::array::from_fn(|c| {
                let c = c as u8;
                self.only_classes.as_ref().is_none_or(|only| only.contains(&c)) && !self.exclude_classes.contains(&c)
            });
            let keep: Vec<bool> = classes.par_iter().map(|&c| wanted[usize::from(c)]).collect();
            report.by_class = retain(cloud, &keep);
        }
        if let Some(bounds) = self.bounds {
            let offset = cloud.world_from_local;
            let inside = |p: &[f64; 3]| (0..3).all(|a| (bounds[a][0]..=bounds[a][1]).contains(&(p[a] + offset[a])));
            let keep: Vec<bool> = cloud.points.par_iter().map(inside).collect();
            report.by_bounds = retain(cloud, &keep);
        }
        report
    }
}

/// Keeps the points that `keep` says, with what was measured beside them; returns how many went.
pub fn retain(cloud: &mut Cloud, keep: &[bool]) -> usize {
    let gone = keep.iter().filter(|k| !**k).count();
    if gone > 0 {
        retain_items(&mut cloud.points, keep);
        cloud.attributes.retain(keep);
    }
    gone
}

impl Attributes {
    /// Adds further values to those of `count` points. Lists stay where both have them; where there are no points yet, those of the other are taken.
    pub(crate) fn append(&mut self, other: Self, count: usize) {
        if count == 0 {
            *self = other;
            return;
        }
        fn join<T>(own: &mut Option<Vec<T>>, other: Option<Vec<T>>) {
            match (own.as_mut(), other) {
                (Some(own), Some(other)) => own.extend(other),
                _ => *own = None,
            }
        }
        join(&mut self.colors, other.colors);
        join(&mut self.intensities, other.intensities);
        join(&mut self.classes, other.classes);
    }

    /// The values of some entries.
    pub(crate) fn picked(&self, entries: &[u32]) -> Self {
        fn pick<T: Copy>(values: Option<&Vec<T>>, entries: &[u32]) -> Option<Vec<T>> {
            values.map(|values| entries.iter().map(|&i| values[i as usize]).collect())
        }
        Self {
            colors: pick(self.colors.as_ref(), entries),
            intensities: pick(self.intensities.as_ref(), entries),
            classes: pick(self.classes.as_ref(), entries),
        }
    }

    /// Keeps the values that `keep` says.
    pub fn retain(&mut self, keep: &[bool]) {
        if let Some(colors) = &mut self.colors {
            retain_items(colors, keep);
        }
        if let Some(intensities) = &mut self.intensities {
            retain_items(intensities, keep);
        }
        if let Some(classes) = &mut self.classes {
            retain_items(classes, keep);
        }
    }
}

/// Keeps the items that `keep` says.
pub(crate) fn retain_items<T>(items: &mut Vec<T>, keep: &[bool]) {
    let mut keep = keep.iter();
    items.retain(|_| *keep.next().unwrap_or(&true));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cloud() -> Cloud {
        Cloud {
            world_from_local: [100.0, 0.0, 0.0],
            points: (0..6).map(|i| [f64::from(i), 0.0, 0.0]).collect(),
            attributes: Attributes { classes: Some(vec![2, 6, 7, 18, 2, 9]), ..Attributes::default() },
            crs: None,
        }
    }

    #[test]
    fn classes_are_kept_and_left_out() {
        let mut c = cloud();
        let filter = Filter { exclude_classes: NOISE_CLASSES.to_vec(), ..Filter::default() };
        assert_eq!(filter.apply(&mut c).by_class, 2);
        assert_eq!(c.attributes.classes, Some(vec![2, 6, 2, 9]));
        let filter = Filter { only_classes: Some(vec![2]), ..Filter::default() };
        assert_eq!(filter.apply(&mut c).by_class, 2);
        assert_eq!(c.points, vec![[0.0; 3], [4.0, 0.0, 0.0]]);
    }

    #[test]
    fn bounds_are_world_coordinates() {
        let mut c = cloud();
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let filter = Filter { bounds: Some([[101.0, 103.0], all, all]), ..Filter::default() };
        assert_eq!(filter.apply(&mut c), FilterReport { by_class: 0, by_bounds: 3 });
        assert_eq!(c.points.len(), 3);
    }
}
